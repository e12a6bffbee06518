#include "apps/thread_scaling/separate_process.hpp"

#include "apps/common/session/machine_room.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <iostream>
#include <stdexcept>

namespace mixbeam {

namespace {

constexpr char kDone = '+', kFailed = '-';  ///< first character sent through the pipe

void write_all(int file, const std::string& text) {
  for (size_t done = 0; done < text.size();) {
    const ssize_t count = write(file, text.data() + done, text.size() - done);
    if (count <= 0) return;  // the reader detects the truncated text
    done += static_cast<size_t>(count);
  }
}

std::string read_all(int file) {
  std::string text;
  std::array<char, 4096> part{};
  for (ssize_t count = 0; (count = read(file, part.data(), part.size())) > 0;)
    text.append(part.data(), static_cast<size_t>(count));
  return text;
}

[[noreturn]] void work_and_end(int file, const std::function<std::string()>& work) {
  std::string text;
  try {
    text = kDone + work();
  } catch (const std::exception& error) {
    text = kFailed + std::string(error.what());
  }
  write_all(file, text);
  std::cout.flush();
  _exit(0);  // MPI belongs to the first process, which ends it
}

}  // namespace

std::string in_separate_process(const std::function<std::string()>& work) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error(std::string("no pipe: ") + std::strerror(errno));
  std::cout.flush();
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error(std::string("no second process: ") + std::strerror(errno));
  if (process == 0) {
    close(ends[0]);
    work_and_end(ends[1], work);
  }
  close(ends[1]);
  const std::string text = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  waitpid(process, &status, 0);
  if (text.empty() || !WIFEXITED(status))
    throw std::runtime_error(WIFSIGNALED(status)
                                 ? std::string("the measuring process ended: ") + strsignal(WTERMSIG(status))
                                 : std::string("the measuring process ended without a word"));
  if (text[0] == kFailed) throw std::runtime_error(text.substr(1));
  return text.substr(1);
}

double resident_memory() { return memory_of_process("VmRSS:"); }
double peak_resident_memory() { return memory_of_process("VmHWM:"); }

}  // namespace mixbeam
