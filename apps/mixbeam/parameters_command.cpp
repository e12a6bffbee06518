#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/command_line.hpp"
#include "apps/mixbeam/batch_cases.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/parameters/print.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"

#include <iostream>

namespace mixbeam {

const ApplicationDefinition& mixbeam_definition() {
  static const ApplicationDefinition definition = [] {
    ApplicationDefinition own;
    own.name = "mixbeam";
    own.purpose = "static equilibrium of structures of geometrically exact beams.";
    own.study = ListSpec("Of the benchmark programs; mixbeam ignores it.").without_checks();
    own.batch = batch_spec();
    own.chooses_meshes = true;
    own.answers_quantities = true;
    own.finds_rest_shapes = true;
    return own;
  }();
  return definition;
}

const ListSpec& mixbeam_root_spec() {
  static const ListSpec root = root_spec(mixbeam_definition());
  return root;
}

namespace {

constexpr const char* kIntroduction =
    "Output of `mixbeam parameters --markdown > parameters.md`. How to write a scene: [scenes.md](scenes.md).\n\n"
    "A name in angle brackets stands for names of your own. The column \"default\" has the value of an absent\n"
    "parameter, or says that there is none: *required*, or *optional* where the meaning tells when it is needed. "
    "Numbers\n"
    "are finite unless inf is mentioned. Square brackets hold the unit; [1] is none.";

}  // namespace

int parameters_command(const Arguments& arguments) {
  const CommandLine line =
      read_command_line(arguments.count(), arguments.values.data(), {"--help", "--markdown", "--json"}, "(no file)");
  if (line.scene_file)
    throw InputError("\"" + excerpt(*line.scene_file) +
                     "\" given to \"parameters\"; allowed: \"--markdown\" or \"--json\"");
  const ListSpec& root = mixbeam_root_spec();
  if (line.markdown && line.json) throw InputError("options --markdown and --json together; allowed: one of them");
  if (line.json)
    print_parameters_json(std::cout, root);
  else if (line.markdown)
    print_parameters_markdown(std::cout, root, "Parameters of a scene file", kIntroduction);
  else
    print_parameters(std::cout, root, "mixbeam");
  return 0;
}

int schema_command(const Arguments& arguments) {
  const CommandLine line =
      read_command_line(arguments.count(), arguments.values.data(), {"--help", "--json"}, "(no file)");
  if (line.scene_file)
    throw InputError("\"" + excerpt(*line.scene_file) + "\" given to \"schema\"; allowed: \"--json\"");
  const ListSpec& root = mixbeam_root_spec();
  if (line.json)
    print_json_schema(std::cout, root, "Scene of mixbeam in YAML");
  else
    print_relax_ng(std::cout, root);
  return 0;
}

}  // namespace mixbeam
