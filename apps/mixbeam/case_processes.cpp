#include "apps/mixbeam/case_processes.hpp"

#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/common/session/mpi_session.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "discretization/results/disk_file.hpp"
#include "discretization/results/result_file.hpp"
#include "discretization/text/errors.hpp"

#include <nlohmann/json.hpp>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <iostream>
#include <sstream>

namespace mixbeam {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MemberMesh, order, elements)

namespace {

enum class CaseEnd { arrived, interrupted, no_convergence, bad_input, not_written, no_memory, other };

/// Answer of a process: "end", "problem" of a failure, "printed" text, "report", packed "summary".
using Answer = nlohmann::json;

Answer answer_with(CaseEnd end, const std::string& problem) { return {{"end", end}, {"problem", problem}}; }

bool is_failure(const Answer& answer) { return answer["end"] > CaseEnd::interrupted; }

Answer answer_of(Application& app, const std::function<RunEnd()>& action) {
  try {
    return answer_with(action() == RunEnd::arrived ? CaseEnd::arrived : CaseEnd::interrupted, "");
  } catch (const MemberError& error) {
    return answer_with(CaseEnd::bad_input, placed(app, error).what());
  } catch (const InputError& error) {
    return answer_with(CaseEnd::bad_input, error.what());
  } catch (const ConvergenceError& error) {
    return answer_with(CaseEnd::no_convergence, error.what());
  } catch (const ResultFileError& error) {
    return answer_with(CaseEnd::not_written, error.what());
  } catch (const FileError& error) {
    return answer_with(CaseEnd::not_written, error.what());
  } catch (const std::exception& error) {
    return answer_with(is_out_of_memory(error) ? CaseEnd::no_memory : CaseEnd::other, error.what());
  } catch (const char* error) {  // NOX and LOCA throw string literals
    return answer_with(CaseEnd::other, error);
  }
}

/// Throws a failure that answer_of() has caught.
[[noreturn]] void throw_again(const Answer& failure) {
  const std::string problem = failure["problem"];
  switch (failure["end"].get<CaseEnd>()) {
    case CaseEnd::no_convergence:
      throw ConvergenceError(problem);
    case CaseEnd::bad_input:
      throw InputError(problem);
    case CaseEnd::not_written:
      throw ResultFileError(problem);
    case CaseEnd::no_memory:
      throw std::bad_alloc();
    default:
      throw std::runtime_error(problem);
  }
}

/// Sends a message; a process that has ended is noticed by its missing answer.
void send(FILE* socket, const Answer& answer) {
  const std::vector<std::uint8_t> bytes = Answer::to_cbor(answer);  // keeps all bits
  const std::size_t size = bytes.size();
  fwrite(&size, sizeof size, 1, socket);
  fwrite(bytes.data(), 1, size, socket);
  fflush(socket);
}

/// Receives a message; none if the process has ended.
std::optional<Answer> received(FILE* socket) {
  std::size_t size = 0;
  if (fread(&size, sizeof size, 1, socket) != 1) return {};
  std::vector<std::uint8_t> bytes(size);
  if (fread(bytes.data(), 1, size, socket) != size) return {};
  return Answer::from_cbor(bytes);
}

/// Index of the case and, if the scene names no mesh, the mesh chosen for all cases.
Answer question_for(const Application& app, std::size_t number) {
  Answer question = {{"case", number}};
  if (app.mesh_note.empty()) return question;
  question["note"] = app.mesh_note;
  question["mesh"] = mesh_of(app.scene);
  return question;
}

/// Main loop of a process.
void answer_questions(FILE* socket, const CaseWork& work) {
  std::optional<Answer> question = received(socket);
  if (!question) return;
  std::ostringstream printed, reports;
  std::cout.rdbuf(printed.rdbuf());
  const MpiSession session;
  Application app;
  app.communicator = session.communicator();
  app.reports = &reports;
  app.asked_to_stop = [socket] {  // during a case, only the end of the questions can arrive
    pollfd more{fileno(socket), POLLIN, 0};
    return poll(&more, 1, 0) > 0;
  };
  for (bool is_first = true; question; is_first = false, question = received(socket)) {
    Answer answer = answer_of(app, [&] {
      if (is_first) work.set_up(app);
      if (app.mesh_is_free) take_mesh(app, (*question)["mesh"], (*question)["note"]);
      reports.str("");
      printed.str("");  // the parent has already printed this
      Summary of_case;
      of_case.threads = app.summary.threads;
      app.summary = of_case;
      return work.solve(app, (*question)["case"]);
    });
    answer["printed"] = printed.str();
    answer["report"] = reports.str();
    answer["summary"] = app.summary.packed();
    send(socket, answer);
  }
}

Answer answer_of_ended(pid_t process, const std::string& load_case) {
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) continue;
  const std::string end =
      WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "exit " + std::to_string(WEXITSTATUS(status));
  return answer_with(CaseEnd::other, "case \"" + load_case + "\": the process that solved it was ended (" + end +
                                         "); every completed step is on disk");
}

void tell(Application& app, const Answer& answer) {
  if (!answer.contains("summary")) return;  // from a terminated process
  app.out() << answer["printed"].get_ref<const std::string&>() << std::flush;
  if (app.reports != nullptr) *app.reports << answer["report"].get_ref<const std::string&>();
  app.summary.append(answer["summary"]);
}

}  // namespace

CaseProcesses::CaseProcesses(int count, const CaseWork& work) {
  const pid_t parent = getpid();
  for (int i = 0; i < count; ++i) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
      throw std::runtime_error(std::string("no socket: ") + std::strerror(errno));
    const pid_t id = fork();
    if (id < 0) throw std::runtime_error(std::string("no process: ") + std::strerror(errno));
    if (id > 0) {
      close(ends[1]);
      processes_.push_back({id, fdopen(ends[0], "r+")});
      continue;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(0);
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_IGN);
    for (const Process& other : processes_) close(fileno(other.socket));  // otherwise that process would wait for ever
    close(ends[0]);
    answer_questions(fdopen(ends[1], "r+"), work);
    _exit(0);
  }
}

CaseProcesses::~CaseProcesses() {
  stop();
  for (const Process& process : processes_) {
    while (waitpid(process.id, nullptr, 0) < 0 && errno == EINTR) continue;
    fclose(process.socket);
  }
}

void CaseProcesses::stop() {
  for (const Process& process : processes_) shutdown(fileno(process.socket), SHUT_WR);
}

void CaseProcesses::ask(const Application& app, Process& process, std::size_t number) {
  process.number = number;
  process.is_busy = true;
  send(process.socket, question_for(app, number));
}

RunEnd CaseProcesses::solve(Application& app, const std::vector<std::string>& cases) {
  constexpr int kLook = 50;  // milliseconds between polls for interrupts
  std::vector<Answer> answers(cases.size());
  std::size_t asked = 0, told = 0, open = 0;
  bool goes_on = true, stopped = false;
  const auto ask_next = [&](Process& process) {
    if (!goes_on || asked == cases.size()) return;
    ask(app, process, asked++);
    ++open;
  };
  for (Process& process : processes_) ask_next(process);
  while (open > 0) {
    if (!stopped && interrupt_requested_here()) {
      stop();
      stopped = true;
      goes_on = false;
    }
    std::vector<pollfd> sockets;
    for (const Process& process : processes_)
      sockets.push_back({process.is_busy ? fileno(process.socket) : -1, POLLIN, 0});
    if (poll(sockets.data(), sockets.size(), kLook) <= 0) continue;
    for (std::size_t i = 0; i < processes_.size(); ++i) {
      if (sockets[i].revents == 0) continue;
      Process& process = processes_[i];
      const std::optional<Answer> answer = received(process.socket);
      answers[process.number] = answer ? *answer : answer_of_ended(process.id, cases[process.number]);
      goes_on = goes_on && !is_failure(answers[process.number]);
      process.is_busy = false;
      --open;
      ask_next(process);
    }
    for (; told < asked && !answers[told].is_null(); ++told) tell(app, answers[told]);
  }
  const auto failure = std::find_if(answers.begin(), answers.begin() + told, is_failure);
  if (failure != answers.begin() + told) throw_again(*failure);
  const auto is_interrupted = [](const Answer& answer) { return answer["end"] == CaseEnd::interrupted; };
  const bool all = told == cases.size() && std::none_of(answers.begin(), answers.end(), is_interrupted);
  return all ? RunEnd::arrived : RunEnd::interrupted;
}

}  // namespace mixbeam
