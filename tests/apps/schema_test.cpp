/// Parameters as data for programs, and the schemas of scenes: every parameter is in them, and they judge as the
/// reader.
#include "mixbeam_files.hpp"

#include <functional>
#include <nlohmann/json.hpp>
#include <regex>

namespace mixbeam::schema_test {
namespace {

using Json = nlohmann::json;

const Json& parameters() {
  static const Json all = Json::parse(output_of({"parameters", "--json"}));
  return all;
}

const Json* named(const Json& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Json& one) { return one.at("name") == name; });
  return found == all.end() ? nullptr : &*found;
}

/// What `mixbeam parameters --json` says of a list, with what each schema says of it.
template <class Place>
void visit(const Json& list, const Place& place,
           const std::function<Place(const Place&, const std::string&, bool)>& step, int& count) {
  for (const Json& parameter : list.at("parameters")) step(place, parameter.at("name"), false), ++count;
  for (const Json& inner : list.at("lists")) visit(inner, step(place, inner.at("name"), true), step, count);
  const auto free = list.find("free_names");
  if (free == list.end()) return;
  if (free->contains("parameter")) step(place, "", false), ++count;
  if (free->contains("list")) visit(free->at("list"), step(place, "", true), step, count);
}

constexpr int kLeastParameters = 200;

TEST(Schema, ParametersAsJson) {
  const Json* scene = named(parameters().at("lists"), "Scene");
  ASSERT_NE(scene, nullptr);
  const Json* loads = named(scene->at("lists"), "Point Loads");
  ASSERT_NE(loads, nullptr);
  EXPECT_EQ(loads->at("path"), Json({"Scene", "Point Loads"}));
  EXPECT_EQ(loads->at("program_name"), "point_loads");
  const Json force = Json::parse(R"json({"name": "Force", "type": "Array(double)", "presence": "default", "length": 3,
      "program_name": "force", "default": [0.0, 0.0, 0.0], "unit": "force", "meaning": "Force [force]."})json");
  const Json* listed = named(loads->at("free_names").at("list").at("parameters"), "Force");
  ASSERT_NE(listed, nullptr);
  EXPECT_EQ(*listed, force);
  const TemporaryFolder folder;
  EXPECT_EQ(run_process(program("mixbeam"), {"parameters", "--json", "--markdown"}, folder).exit_code, 2);
}

/// All of the text has it, so a parameter that one of the schemas leaves out is noticed.
TEST(Schema, EveryParameterOfTheTextIsInTheJson) {
  std::istringstream text(output_of({"parameters"}));
  int lines = 0, count = 0;
  const std::regex parameter(R"re(^ +[A-Za-z<][A-Za-z0-9 <>]*: (bool|int|double|string|Array\().*)re");
  for (std::string line; std::getline(text, line);) lines += std::regex_match(line, parameter) ? 1 : 0;
  visit<int>(
      parameters(), 0, [](const int&, const std::string&, bool) { return 0; }, count);
  EXPECT_EQ(count, lines);
  EXPECT_GT(count, kLeastParameters);
}

TEST(Schema, EveryParameterIsInTheJsonSchema) {
  const Json schema = Json::parse(output_of({"schema", "--json"}));
  int count = 0;
  const auto step = [](const Json& list, const std::string& name, bool) -> Json {
    const Json& place = name.empty() ? list.at("additionalProperties") : list.at("properties").at(name);
    EXPECT_FALSE(place.at("description").get<std::string>().empty()) << name;
    return place;
  };
  visit<Json>(parameters(), schema, step, count);
  EXPECT_GT(count, kLeastParameters);
}

std::string attribute(xmlNodePtr node, const char* name) {
  const std::unique_ptr<xmlChar, void (*)(void*)> value(xmlGetProp(node, BAD_CAST name), xmlFree);
  return value ? reinterpret_cast<const char*>(value.get()) : "";
}

xmlNodePtr child_of(xmlNodePtr node, const std::string& tag) {
  for (xmlNodePtr inner = xmlFirstElementChild(node); inner != nullptr; inner = xmlNextElementSibling(inner))
    if (tag == reinterpret_cast<const char*>(inner->name)) return inner;
  return nullptr;
}

/// Of an element of the schema: what it says of its attribute "name"; empty where the user names it.
std::string name_in(xmlNodePtr element) {
  for (xmlNodePtr inner = xmlFirstElementChild(element); inner != nullptr; inner = xmlNextElementSibling(inner)) {
    if (attribute(inner, "name") != "name") continue;
    const xmlNodePtr value = child_of(inner, "value");
    if (value == nullptr) return "";
    const std::unique_ptr<xmlChar, void (*)(void*)> text(xmlNodeGetContent(value), xmlFree);
    return reinterpret_cast<const char*>(text.get());
  }
  return "none";
}

TEST(Schema, EveryParameterIsInTheRelaxNgSchema) {
  const XmlDocument schema = xml_document(output_of({"schema"}));
  ASSERT_NE(schema, nullptr);
  int count = 0;
  const auto step = [](const xmlNodePtr& list, const std::string& name, bool is_list) -> xmlNodePtr {
    const xmlNodePtr all = list == nullptr ? nullptr : child_of(list, "zeroOrMore");
    const xmlNodePtr choice = all == nullptr ? nullptr : child_of(all, "choice");
    const std::string tag = is_list ? "ParameterList" : "Parameter";
    for (xmlNodePtr one = choice == nullptr ? nullptr : xmlFirstElementChild(choice); one != nullptr;
         one = xmlNextElementSibling(one))
      if (attribute(one, "name") == tag && name_in(one) == name) return one;
    ADD_FAILURE() << tag << " \"" << name << "\" is not in the schema";
    return nullptr;
  };
  visit<xmlNodePtr>(parameters(), child_of(child_of(xmlDocGetRootElement(schema.get()), "start"), "element"), step,
                    count);
  EXPECT_GT(count, kLeastParameters);
}

TEST(Schema, TheLanguageServerCompletesExplainsAndMarks) {
  const fs::path server = fs::path(MIXBEAM_BIN_DIR).parent_path() /
                          "yaml-language-server/node_modules/yaml-language-server/bin/yaml-language-server";
  const TemporaryFolder folder;
  MIXBEAM_REQUIRE_TOOL(fs::exists(server) && std::system("node --version > /dev/null 2>&1") == 0,
                       "a language server or node (./test.sh gets both)");
  write_text(folder / "schema.json", output_of({"schema", "--json"}));
  const std::string script = std::string(MIXBEAM_SOURCE_DIR) + "/tests/apps/language_server.py";
  const Ended ended = expect_code(
      kOk, run_process("/usr/bin/python3", {script, server.string(), (folder / "schema.json").string()}, folder));
  const Json said = Json::parse(ended.out);
  const Json expected_marks = Json::parse(R"([[4, "Property Elments is not allowed."]])");
  EXPECT_EQ(said.at("marks"), expected_marks);
  expect_in(said.at("hover"), {"Name of the point where the member starts"});
  for (const std::string name : {"Frame", "Force", "Moment", "Amplitude"})
    EXPECT_EQ(std::count(said.at("names").begin(), said.at("names").end(), name), 1) << name;
  EXPECT_EQ(said.at("words"), Json({"dead", "follower"}));
}

}  // namespace
}  // namespace mixbeam::schema_test
