#include "apps/common/session/command_line.hpp"

#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <map>
#include <ostream>

namespace mixbeam {

namespace {

constexpr int kMostThreads = 1024, kMostJobs = 1024, kMostSteps = 999999999, kMostRows = 999999999;

/// Whether this is an option; "-1" is a value, though an invalid one.
bool is_option(const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' && (argument[1] < '0' || argument[1] > '9');
}

int number_from(const std::string& option, const std::string& text, int least, int most) {
  int number = 0;
  if (parse_number(text, number).empty() && number >= least && number <= most) return number;
  throw InputError("option " + option + ": value \"" + excerpt(text) + "\"; allowed: a whole number from " +
                   std::to_string(least) + " to " + std::to_string(most));
}

/// "3:7"
std::array<int, 2> rows_from(const std::string& option, const std::string& text) {
  const std::size_t colon = text.find(':');
  int first = 0, last = 0;
  if (colon != std::string::npos && parse_number(text.substr(0, colon), first).empty() &&
      parse_number(text.substr(colon + 1), last).empty() && first >= 1 && last >= first && last <= kMostRows)
    return {first, last};
  throw InputError("option " + option + ": value \"" + excerpt(text) +
                   "\"; allowed: first and last row, counted from 1, as in 1:100");
}

/// Returns the word after an option; another option there means that the value is missing.
std::string value_after(int& i, int argc, const char* const* argv) {
  const std::string option = argv[i];
  std::string value = i + 1 < argc ? argv[i + 1] : "";
  if (value.empty()) throw InputError("option " + option + " needs a value");
  if (is_option(value)) {
    throw InputError("option " + option + " needs a value, but \"" + excerpt(value) +
                     "\" follows; a name that starts with - is written ./" + excerpt(value));
  }
  ++i;
  return value;
}

void read_file_name(const std::string& argument, const std::string& kind, CommandLine& line) {
  if (argument.empty())
    throw InputError("an empty argument; allowed: one " + kind + " and options (--help lists them)");
  if (line.scene_file) {
    throw InputError("two " + kind + "s given: \"" + *line.scene_file + "\" and \"" + excerpt(argument) +
                     "\"; allowed: one");
  }
  line.scene_file = argument;
}

void read_option(const std::string& name, int& i, int argc, const char* const* argv, CommandLine& line) {
  static const std::map<std::string, bool CommandLine::*> kSwitches = {
      {"--help", &CommandLine::help},     {"--print-parameters", &CommandLine::print_parameters},
      {"--single", &CommandLine::single}, {"--quiet", &CommandLine::quiet},
      {"--force", &CommandLine::force},   {"--markdown", &CommandLine::markdown},
      {"--json", &CommandLine::json},     {"--durable", &CommandLine::durable},
      {"--watch", &CommandLine::watch}};
  if (const auto found = kSwitches.find(name); found != kSwitches.end()) {
    line.*found->second = true;
    return;
  }
  const std::string value = value_after(i, argc, argv);
  if (name == "--output")
    line.output = value;
  else if (name == "--summary")
    line.summary = value;
  else if (name == "--case")
    line.load_case = value;
  else if (name == "--threads")
    line.threads = number_from(name, value, 1, kMostThreads);
  else if (name == "--jobs")
    line.jobs = number_from(name, value, 1, kMostJobs);
  else if (name == "--rows")
    line.rows = rows_from(name, value);
  else if (name == "--from")
    line.last_step = number_from(name, value, 0, kMostSteps);
}

}  // namespace

const std::vector<std::string>& benchmark_options() {
  static const std::vector<std::string> options = {"--help",  "--print-parameters", "--single",  "--quiet",
                                                   "--force", "--output",           "--summary", "--threads"};
  return options;
}

CommandLine read_command_line(int argc, const char* const* argv, const std::vector<std::string>& options,
                              const std::string& kind) {
  CommandLine line;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::string name = argument == "-h" ? "--help" : argument == "-o" ? "--output" : argument;
    if (std::find(options.begin(), options.end(), name) != options.end())
      read_option(name, i, argc, argv, line);
    else if (is_option(argument))
      throw InputError("unknown option \"" + excerpt(argument) + "\"; allowed: " + quoted_list(options) +
                       did_you_mean(argument, options));
    else
      read_file_name(argument, kind, line);
  }
  return line;
}

void print_help(std::ostream& out, const std::string& program, const std::string& purpose) {
  out << program << ": " << purpose << "\n\n"
      << "usage: " << program << " [SCENE.xml] [options]\n\n"
      << "  SCENE.xml            scene, solver, study and expected answers; default: " << program
      << ".xml beside the program\n"
      << "  --single             only the scene as it stands, without the study\n"
      << "  -o, --output DIR     folder for results (HDF5 + XDMF, CSV); default: results/" << program << "\n"
      << "  --summary FILE.json  every checked quantity, steps, iterations and times, for scripts\n"
      << "  --threads N          OpenMP threads; default: \"Threads\" in the scene, else OMP_NUM_THREADS, else all\n"
      << "                       processors for scenes that are large enough to profit\n"
      << "  --quiet              no progress lines\n"
      << "  --force              run what seems not to fit into memory or onto the disk\n"
      << "  --print-parameters   all parameters of the scene file with type, default, range and meaning\n"
      << "  --help               this text\n\n"
      << "exit code: 0 all checks passed, 1 a check failed, 2 bad input, 3 no convergence\n"
      << "on several ranks: mpirun --bind-to none -np 2 " << program
      << " ...   (without --bind-to none the threads of a rank share one core)\n";
}

}  // namespace mixbeam
