/// The command line that all applications share.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

namespace mixbeam {

struct CommandLine {
  std::optional<std::string> scene_file, output, summary;
  std::optional<int> threads;
  bool help = false, print_parameters = false, single = false, quiet = false;
};

/// Throws InputError that names the option, what was seen and what is allowed.
CommandLine read_command_line(int argc, const char* const* argv);

void print_help(std::ostream& out, const std::string& program, const std::string& purpose);

}  // namespace mixbeam
