/// Parameters as data for programs: `mixbeam parameters --json`.
#include "mixbeam_files.hpp"

#include <nlohmann/json.hpp>

namespace mixbeam::schema_test {
namespace {

using Json = nlohmann::json;

Ended run(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  return run_process(program("mixbeam"), arguments, folder);
}

/// Names of all parameters and lists below a list of `mixbeam parameters --json`, free ones as their placeholder.
void collect_names(const Json& list, std::vector<std::string>& names) {
  for (const Json& parameter : list.at("parameters")) names.push_back(parameter.at("name"));
  for (const Json& inner : list.at("lists")) {
    names.push_back(inner.at("name"));
    collect_names(inner, names);
  }
  const auto free = list.find("free_names");
  if (free == list.end()) return;
  names.push_back("<" + free->at("placeholder").get<std::string>() + ">");
  if (free->contains("list")) collect_names(free->at("list"), names);
}

TEST(Schema, ParametersAsJson) {
  const Json root = Json::parse(run({"parameters", "--json"}).out);
  const std::string text = run({"parameters"}).out;
  std::vector<std::string> names;
  collect_names(root, names);
  EXPECT_GT(names.size(), 300u);
  for (const std::string& name : names) expect_in(text, {name});
  const Json force = Json::parse(R"({"name": "Force", "type": "Array(double)", "presence": "default", "length": 3,
      "program_name": "force", "default": [0.0, 0.0, 0.0], "unit": "force", "meaning": "Force [force]."
})");
  const Json& scene = root.at("lists").at(0).at("lists");
const auto loads = std::find_if(scene.begin(), scene.end(), [](const Json& l) { return l["name"] == "Point Loads"; });
ASSERT_NE(loads, scene.end());
EXPECT_EQ(loads->at("path"), Json({"Scene", "Point Loads"}));
EXPECT_EQ(loads->at("program_name"), "point_loads");
EXPECT_EQ(loads->at("free_names").at("list").at("parameters").at(1), force);
EXPECT_EQ(run({"parameters", "--json", "--markdown"}).exit_code, 2);
}

}  // namespace
}  // namespace mixbeam::schema_test
