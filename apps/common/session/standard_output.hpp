/// Standard output whose losses are noticed: a full disk behind it, or a reader that has gone.
#pragma once

#include <array>
#include <streambuf>
#include <string>

namespace mixbeam {

/// Takes the place of the buffer behind std::cout while it lives. A broken pipe and a file that grows beyond its limit
/// become errors of the calls that write, in place of signals that end the program.
class StandardOutput : private std::streambuf {
 public:
  StandardOutput();
  ~StandardOutput() override;
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  /// Exit code of a program that would end with `code`: 2 in place of 0 if its output could not be written, with a
  /// message on stderr. A reader that has gone (a pager, head) knows that it misses the rest: then only a warning is
  /// printed.
  int exit_code(int code, const std::string& program);

 private:
  int overflow(int character) override;
  int sync() override;

  std::streambuf* replaced_;
  std::array<char, 8192> buffer_{};
  int error_ = 0;  ///< errno of the first write that failed
};

}  // namespace mixbeam
