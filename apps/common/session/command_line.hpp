/// The command line that all applications share.
#pragma once

#include <array>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

struct CommandLine {
  std::optional<std::string> scene_file, output, summary, load_case;
  std::optional<int> threads, last_step;
  std::optional<std::array<int, 2>> rows;  ///< first and last, counted from 1
  int jobs = 1;
  bool help = false, print_parameters = false, single = false, quiet = false, markdown = false, durable = false;
  bool force = false, json = false, watch = false;
};

/// Options of the benchmark applications.
const std::vector<std::string>& benchmark_options();

/// Reads a command line with at most one file. `options`: the allowed ones; `kind`: of that file. Throws InputError
/// with the option, its value and the allowed values.
CommandLine read_command_line(int argc, const char* const* argv,
                              const std::vector<std::string>& options = benchmark_options(),
                              const std::string& kind = "scene file");

void print_help(std::ostream& out, const std::string& program, const std::string& purpose);

}  // namespace mixbeam
