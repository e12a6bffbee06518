#include "apps/common/session/standard_output.hpp"

#include "discretization/text/errors.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <iostream>

namespace mixbeam {

namespace {

/// Opens missing standard streams. Otherwise result files would get their numbers, and output would go into the
/// results.
void occupy_standard_streams() {
  for (int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(number, F_GETFD) < 0) [[maybe_unused]]
      const int lowest_free = ::open("/dev/null", O_RDWR);
}

}  // namespace

StandardOutput::StandardOutput() {
  occupy_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  std::cout.flush();
  replaced_ = std::cout.rdbuf(this);
}

StandardOutput::~StandardOutput() {
  sync();
  std::cout.rdbuf(replaced_);
}

int StandardOutput::overflow(int character) {
  sync();
  if (character == traits_type::eof()) return traits_type::not_eof(character);
  *pptr() = static_cast<char>(character);
  pbump(1);
  return character;
}

// After an error all further output is discarded: a report with gaps is worse than its beginning.
int StandardOutput::sync() {
  const char* from = pbase();
  while (from < pptr() && error_ == 0) {
    const ssize_t written = ::write(STDOUT_FILENO, from, static_cast<std::size_t>(pptr() - from));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) error_ = errno;
    if (written > 0) from += written;
  }
  setp(buffer_.data(), buffer_.data() + buffer_.size());
  return 0;
}

int StandardOutput::exit_code(int code, const std::string& program) {
  sync();
  if (error_ == 0) return code;
  const bool is_reader_gone = error_ == EPIPE;
  std::cerr << program << ": " << (is_reader_gone ? "warning: " : "")
            << "standard output cannot be written: " << std::strerror(error_) << "\n";
  return code == 0 && !is_reader_gone ? kInputErrorExitCode : code;
}

}  // namespace mixbeam
