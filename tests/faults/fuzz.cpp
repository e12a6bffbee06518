// What reads the input, for libFuzzer: whatever the bytes, a reader ends with a result or with an InputError.
// Compiled once for each value of FUZZ_TARGET by fuzz.sh.
#include "apps/mixbeam/batch_parameters.hpp"
#include "discretization/checks/expected_values.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/parameters/yaml_reader.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/expression.hpp"

#include <unistd.h>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>

namespace {

using namespace mixbeam;

/// Parts of an input: the text of a scene, then that of a table.
const std::string kSeparator = "\n=====\n";

[[maybe_unused]] std::pair<std::string, std::string> parts(const std::string& text) {
  const std::size_t place = text.find(kSeparator);
  if (place == std::string::npos) return {text, ""};
  return {text.substr(0, place), text.substr(place + kSeparator.size())};
}

[[maybe_unused]] ListSpec spec_of_file() {
  ListSpec root("fuzz");
  root.add_list("Scene", scene_spec(), Presence::required);
  root.add_list("Expected", expected_values_spec(), Presence::defaulted);
  return root;
}

/// As `mixbeam check` reads a scene, up to the mesh.
[[maybe_unused]] void read_file(XmlParameters xml) {
  for (const char* other : {"Solver", "Analysis", "Batch", "Study"}) xml.list->remove(other, false);
  validate(*xml.list, spec_of_file(), xml.source);
  const Scene scene = read_scene(xml.list->sublist("Scene"), xml.source);
  check_expected_values(read_expected_values(xml.list->sublist("Expected"), xml.source), scene, xml.source);
}

[[maybe_unused]] void scene(const std::string& text) { read_file(parse_xml(text, "scene.xml")); }

[[maybe_unused]] void yaml(const std::string& text) { read_file(parse_yaml(text, "scene.yaml", spec_of_file())); }

/// The tables of a scene that is in order.
[[maybe_unused]] void table(const std::string& text) {
  XmlParameters xml = parse_xml(R"(<ParameterList name="t"><ParameterList name="Scene">
    <ParameterList name="Sections"><ParameterList name="s"><Parameter name="EA" type="double" value="1"/>
      <Parameter name="Shear Rigid" type="bool" value="true"/><Parameter name="GIt" type="double" value="1"/>
      <Parameter name="EI2" type="double" value="1"/><Parameter name="EI3" type="double" value="1"/></ParameterList></ParameterList>
    <ParameterList name="Import"><Parameter name="Points File" type="string" value="p"/>
      <Parameter name="Members File" type="string" value="m"/></ParameterList>
    <ParameterList name="Supports"><ParameterList name="c"><Parameter name="Point" type="string" value="*"/></ParameterList></ParameterList>
    </ParameterList></ParameterList>)",
                                "scene.xml");
  const auto [points, members] = parts(text);
  xml.source.set_files({{"p", points}, {"m", members}});
  read_file(xml);
}

[[maybe_unused]] void formula(const std::string& text) {
  try {
    const Expression expression(text, {"x", "s"});
    for (const double x : {0.0, 0.5, -1.0, 1e300, std::nan("")}) expression({x, 2.0});
  } catch (const std::invalid_argument&) {  // what readers of scenes turn into an InputError
  }
}

/// The table of a batch comes from the disk.
[[maybe_unused]] void batch(const std::string& text) {
  static const std::string folder = [] {
    std::string name = "/tmp/mixbeam_fuzz_XXXXXX";
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    return name;
  }();
  const auto [xml_text, table] = parts(text);
  std::ofstream(folder + "/table.csv", std::ios::binary) << table;
  XmlParameters xml = parse_xml(xml_text, folder + "/batch.xml");
  ListSpec root("fuzz");
  root.add_list("Batch", batch_spec(), Presence::required);
  validate(*xml.list, root, xml.source);
  const Batch batch = read_batch(xml.list->sublist("Batch"), xml.source);
  for (std::size_t i = 0; i < batch.size(); ++i) batch.name_of_case(i);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    FUZZ_TARGET(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const InputError&) {  // any other exception ends the program: libFuzzer keeps the input
  }
  return 0;
}
