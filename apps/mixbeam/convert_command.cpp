#include "apps/common/session/command_line.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/reading/blade_file.hpp"
#include "discretization/results/disk_file.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/text_file.hpp"

#include <iostream>

namespace mixbeam {

namespace {

using List = Teuchos::ParameterList;

struct Conversion {
  std::vector<std::string> from;
  std::string to;
  bool may_replace = false;
};

Conversion read_arguments(const Arguments& arguments) {
  std::vector<std::string> files;
  std::vector<const char*> others;
  for (const char* argument : arguments.values) {
    const std::string before = others.empty() ? "-o" : others.back();
    if (argument[0] == '-' || before == "-o" || before == "--output")
      others.push_back(argument);
    else
      files.emplace_back(argument);
  }
  const CommandLine line =
      read_command_line(static_cast<int>(others.size()), others.data(), {"--output", "--force", "--help"}, "scene");
  if (line.output) files.push_back(*line.output);
  if (files.size() < 2)
    throw InputError(std::to_string(files.size()) +
                     " files given to \"convert\"; allowed: two, mixbeam convert FROM TO");
  const std::string to = files.back(), ending = lower_case(std::filesystem::path(to).extension().string());
  if (ending != ".xml" && ending != ".yaml" && ending != ".yml")
    throw InputError("\"" + excerpt(to) + "\": unknown ending; allowed: .xml, .yaml, .yml");
  files.pop_back();
  return {files, to, line.force};
}

/// Path of the first entry that differs, in name, order or value; empty if none does.
ParameterPath difference(const List& a, const List& b, const ParameterPath& path = {}) {
  auto other = b.begin();
  for (auto entry = a.begin(); entry != a.end(); ++entry, ++other) {
    const ParameterPath here = child(path, a.name(entry));
    if (other == b.end() || a.name(entry) != b.name(other)) return here;
    if (a.entry(entry).isList() != b.entry(other).isList()) return here;
    if (a.entry(entry).isList()) {
      const ParameterPath inside = difference(a.sublist(a.name(entry)), b.sublist(b.name(other)), here);
      if (!inside.empty()) return inside;
    } else if (value_of(a.entry(entry)) != value_of(b.entry(other))) {
      return here;
    }
  }
  return other == b.end() ? ParameterPath{} : child(path, b.name(other));
}

void require_equal(const XmlParameters& from, XmlParameters to, const ListSpec& spec) {
  List before(*from.list);
  for (const std::string& warning : validate(before, spec, from.source, {}, true))
    std::cout << "warning: " << warning << "\n";
  validate(*to.list, spec, to.source, {}, true);
  const ParameterPath path = difference(before, *to.list);
  if (!path.empty() || from.list->name() != to.list->name())
    throw from.source.error(path, "cannot be written to " + to.source.file() +
                                      " without a change; allowed in XML: texts in arrays without braces, and without "
                                      "commas outside of parentheses");
}

bool has_comment(const std::string& yaml) {
  for (std::size_t at = yaml.find('#'); at != std::string::npos; at = yaml.find('#', at + 1))
    if (at == 0 || yaml[at - 1] == '\n' || yaml[at - 1] == ' ' || yaml[at - 1] == '\t') return true;
  return false;
}

/// Writes the scene as `to`, after reading the text again and comparing it.
void write_scene(const XmlParameters& scene, const std::string& to) {
  const ListSpec& root = mixbeam_root_spec();
  const std::string text = format_of(to) == FileFormat::yaml ? yaml_text(scene, root, to) : xml_text(*scene.list);
  require_equal(scene, parse_parameters(text, to, root), root);
  try {
    replace_file(to, text, false);
  } catch (const FileError& error) {
    throw InputError(error.what());
  }
}

/// Converts sections of other programs to a scene.
void convert_blade(const std::vector<std::string>& from, const std::string& to) {
  std::vector<std::string> remarks;
  write_scene(parse_parameters(xml_text(scene_of_blades(from, remarks)), "blade.xml", mixbeam_root_spec()), to);
  std::cout << to << ": a blade with the sections of " << from.front() << (from.size() > 1 ? ", ..." : "") << "\n";
  for (const std::string& remark : remarks) std::cout << "note: " << remark << "\n";
}

}  // namespace

int convert_command(const Arguments& arguments) {
  const auto [files, to, may_replace] = read_arguments(arguments);
  if (!may_replace && std::filesystem::exists(to))
    throw InputError("\"" + excerpt(to) + "\" is there already; allowed: another name, or --force to replace it");
  const std::string& from = files.front();
  if (files.size() > 1 || blade_format(text_of_file(from, "a scene")) != BladeFormat::none) {
    convert_blade(files, to);
    return 0;
  }
  const XmlParameters scene = read_parameters(from, mixbeam_root_spec());
  write_scene(scene, to);
  const bool is_from_xml = format_of(from, scene.text) == FileFormat::xml;
  const bool is_to_yaml = format_of(to) == FileFormat::yaml;
  std::cout << to << ": the scene of " << from << "\n";
  const bool keeps_comments = is_from_xml && is_to_yaml;
  if (!keeps_comments && (is_from_xml ? !scene.comments.empty() : has_comment(scene.text)))
    std::cout << "warning: the comments of " << from << " are not in " << to << "\n";
  return 0;
}

}  // namespace mixbeam
