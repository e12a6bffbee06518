/// Processes that a test starts in its own image, to be killed or to meet limits.
#pragma once

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mixbeam {

/// Number of the process in which `action` runs, whose result is its exit code; exit handlers of libraries run.
template <class Action>
pid_t started(const Action& action) {
  const pid_t child = fork();
  EXPECT_GE(child, 0);
  if (child == 0) std::exit(action());
  return child;
}

/// Exit code of a process; -signal where one has ended it.
inline int end_of(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// Stands for a full disk: write() fails in the middle of a file that grows beyond this.
inline void limit_file_size(rlim_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
}

}  // namespace mixbeam
