// mixbeam: any structure from one scene file.
#include "apps/common/session/interrupt.hpp"
#include "apps/common/session/standard_output.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "mixbeam/version.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>

namespace mixbeam {

namespace {

using Command = int (*)(const Arguments&);

const std::map<std::string, Command> kCommands = {{"run", run_command},       {"batch", batch_command},
                                                  {"check", check_command},   {"parameters", parameters_command},
                                                  {"resume", resume_command}, {"plot", plot_command},
                                                  {"verify", verify_command}, {"report", report_command},
                                                  {"schema", schema_command}, {"convert", convert_command},

                                                  {"view", view_command}};

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const auto& [name, command] : kCommands) names.push_back(name);
  return names;
}

std::string hint(const std::string& word) {
  const std::string ending = std::filesystem::path(word).extension().string();
  if (ending == ".xml" || ending == ".yaml" || ending == ".yml") return "; did you mean \"mixbeam run " + word + "\"?";
  return did_you_mean(word, command_names());
}

int dispatch(const std::vector<const char*>& words) {
  const std::string word = words.size() > 1 ? words[1] : "";
  if (word == "--version") {
    std::cout << "mixbeam " << kVersion << ", " << kCompiler << ", " << instructions() << "\n";
    return 0;
  }
  if (word == "--help" || word == "-h" || word == "help") {
    std::cout << help_text(words.size() > 2 ? words[2] : "");
    return 0;
  }
  const auto command = kCommands.find(word);
  if (command == kCommands.end()) {
    throw InputError((word.empty() ? "a command is missing" : "unknown command \"" + excerpt(word) + "\"") +
                     "; allowed: " + quoted_list(command_names()) + hint(word) + " (mixbeam --help explains them)");
  }
  const Arguments arguments{{words.begin() + 1, words.end()}};
  const auto asks_for_help = [](const char* argument) { return std::string(argument) == "--help"; };
  const bool runs_a_script = word == "plot" || word == "report";
  const bool own_help = !runs_a_script || words.size() < 4;
  if (own_help && std::any_of(words.begin(), words.end(), asks_for_help)) {
    std::cout << help_text(word);
    return 0;
  }
  leave_on_interrupts();
  return command->second(arguments);
}

}  // namespace

}  // namespace mixbeam

namespace {

int run(int argc, char** argv) {
  try {
    return mixbeam::dispatch({argv, argv + argc});
  } catch (const mixbeam::InputError& error) {
    std::cerr << "mixbeam: bad input: " << error.what() << "\n";
    return mixbeam::kInputErrorExitCode;
  } catch (const std::bad_alloc&) {
    std::cerr << "mixbeam: not enough memory to begin\n";
    return mixbeam::kInputErrorExitCode;
  } catch (const std::exception& error) {
    std::cerr << "mixbeam: unforeseen error: " << error.what() << "\n";
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  mixbeam::StandardOutput output;
  return output.exit_code(run(argc, argv), "mixbeam");
}
