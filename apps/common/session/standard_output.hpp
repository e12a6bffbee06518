/// Standard output that detects lost output: a full disk, or a reader that has gone.
#pragma once

#include <array>
#include <streambuf>
#include <string>

namespace mixbeam {

/// Replaces the buffer of std::cout during its lifetime. A broken pipe and a file beyond its size limit become write
/// errors instead of signals that end the program.
class StandardOutput : private std::streambuf {
 public:
  StandardOutput();
  ~StandardOutput() override;
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

  /// Exit code of a program that would end with `code`: 2 instead of 0 if its output could not be written, with a
  /// message on stderr. Only a warning if the reader has gone (a pager, head): it knows that it misses the rest.
  int exit_code(int code, const std::string& program);

 private:
  int overflow(int character) override;
  int sync() override;

  std::streambuf* replaced_;
  std::array<char, 8192> buffer_{};
  int error_ = 0;  ///< errno of the first write that failed
};

}  // namespace mixbeam
