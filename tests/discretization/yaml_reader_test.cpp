/// Scenes in YAML: the list that an XML file gives, with the place of every entry; what is refused, and hostile files.

#include "discretization/parameters/parameter_file.hpp"
#include "input_text.hpp"

#include <limits>

namespace mixbeam::yaml_reader_test {
namespace {

ListSpec root_of_scenes() {
  ListSpec root("file");
  root.add_list("Scene", scene_spec(), Presence::required);
  root.add_list("Study", ListSpec("anything").without_checks());
  return root;
}

XmlParameters parsed(const std::string& text) { return parse_yaml(text, "folder/scene.yaml", root_of_scenes()); }

std::string refusal_of(const std::string& text) {
  return message_of([&] {
    const XmlParameters yaml = parsed(text);
    validate(*yaml.list, root_of_scenes(), yaml.source);
  });
}

const std::string kScene = R"yaml(Scene:
  Sections:
    rod: {EA: 1e3, GA2: inf, GA3: .inf, GIt: 1, EI2: +2., EI3: .5}
  Points:
    no: [0, 0, 0]
    1: [1, 0, 0]
    null: [2, 0, 0]
  Members:
    m: {Start: no, End: 1, Section: rod, Elements: 4}
    n:
      Start: 1
      End: null
      Section: !!str rod
  Supports:
    clamp: {Point: no}
  Point Loads:
    pull: {Point: null, Force: [1, 0, 0], Amplitude: 3}
  Distributed Loads:
    wind: {Member: "*", Force Formula: [0, -3*(1 - x), "max(s, 1)"]}
)yaml";

TEST(YamlReader, DeclarationsSayWhatAScalarIs) {
  const XmlParameters yaml = parsed(kScene);
  const Scene scene = described_by(yaml);
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.sections[0].axial_stiffness, 1000.0);
  EXPECT_EQ(scene.sections[0].shear_stiffness[0], std::numeric_limits<double>::infinity());
  EXPECT_EQ(scene.sections[0].shear_stiffness[1], std::numeric_limits<double>::infinity());
  EXPECT_EQ(scene.members[0].start_point, "no");
  EXPECT_EQ(scene.members[0].end_point, "1");
  EXPECT_EQ(scene.members[1].end_point, "null");
  const auto& loads = yaml.list->sublist("Scene").sublist("Point Loads");
  EXPECT_EQ(loads.sublist("pull").get<std::string>("Amplitude"), "3");
  const auto& wind = yaml.list->sublist("Scene").sublist("Distributed Loads").sublist("wind");
  EXPECT_EQ(wind.get<Teuchos::Array<std::string>>("Force Formula").toVector(),
            (std::vector<std::string>{"0", "-3*(1 - x)", "max(s, 1)"}));
}

TEST(YamlReader, GivesTheListOfTheXmlFile) {
  const XmlParameters xml = parse_xml(xml_text(*parsed(kBowScene).list), "bow.xml");
  const std::string text = yaml_text(xml, root_of_scenes(), "bow.yaml");
  expect_in(text, {"    steel: {EA: 10000, GA2: 5000, GA3: 5000, GIt: 2, EI2: 2, EI3: 2.5}\n"});
  const XmlParameters yaml = parse_yaml(text, "bow.yaml", root_of_scenes());
  validate(*xml.list, root_of_scenes(), xml.source);
  validate(*yaml.list, root_of_scenes(), yaml.source);
  EXPECT_TRUE(Teuchos::haveSameValues(*xml.list, *yaml.list));
  const XmlParameters other = parse_yaml(changed(text, "EA: 10000", "EA: 10001"), "bow.yaml", root_of_scenes());
  validate(*other.list, root_of_scenes(), other.source);
  EXPECT_FALSE(Teuchos::haveSameValues(*xml.list, *other.list));
}

TEST(YamlReader, ValuesWithoutDeclarationKeepTheTypeTheyShow) {
  const XmlParameters yaml =
      parsed("Study: {a: 1, b: 1.0, c: true, d: x, e: \"1\", f: [1, 2], g: [1, 2.5], h: [a, 1]}\n");
  const auto& study = yaml.list->sublist("Study");
  EXPECT_EQ(study.get<int>("a"), 1);
  EXPECT_EQ(study.get<double>("b"), 1.0);
  EXPECT_EQ(study.get<bool>("c"), true);
  EXPECT_EQ(study.get<std::string>("d"), "x");
  EXPECT_EQ(study.get<std::string>("e"), "1");
  EXPECT_EQ(study.get<Teuchos::Array<int>>("f").size(), 2);
  EXPECT_EQ(study.get<Teuchos::Array<double>>("g").size(), 2);
  EXPECT_EQ(study.get<Teuchos::Array<std::string>>("h").toVector(), (std::vector<std::string>{"a", "1"}));
}

TEST(YamlReader, KnowsLineAndColumnOfEveryEntry) {
  const XmlParameters yaml = parsed(kScene);
  EXPECT_EQ(yaml.source.where({"Scene", "Members", "n", "End"}), "folder/scene.yaml:12:7");
  EXPECT_EQ(yaml.source.where({"Scene", "Members", "m", "Missing"}), "folder/scene.yaml:9:5");
  EXPECT_EQ(yaml.text, kScene);
  expect_in(refusal_of(changed(kScene, "Elements: 4", "Elments: 4")),
            {"folder/scene.yaml:9:42: YAML path \"Scene / Members / m / Elments\": unknown name",
             "did you mean \"Elements\"?"});
  expect_in(refusal_of(changed(kScene, "Elements: 4", "Elements: \"4\"")), {"9:42: ", "\"4\" of type string", "int"});
  expect_in(refusal_of(changed(kScene, "EA: 1e3", "EA: abc")), {"3:11: ", "\"abc\" of type string; allowed: double"});
}

TEST(YamlReader, RefusesWithAPlace) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> wrong = {
      {changed(kScene, "\"*\"", "*"), {"scene.yaml:19:", "alias not found", "stands in quotes, like \"*\""}},
      {changed(kScene, "\"*\"", "*m"), {"scene.yaml:19:20: ", "anchor is not defined", "stands in quotes"}},
      {changed(kScene, "End: null\n", "End:\n"), {"12:7: YAML path \"Scene / Members / n / End\": no value"}},
      {changed(kScene, "no: [0, 0, 0]", "no:"), {"5:5: YAML path \"Scene / Points / no\": no value"}},
      {changed(kScene, "Elements: 4", "Start: 4"), {"9:42: ", "given twice", "in line 9 and again in line 9"}},
      {changed(kScene, "Elements: 4", "<<: 4"), {"9:42: YAML path \"Scene / Members / m\"", "merge key"}},
      {changed(kScene, "Elements: 4", "\"\": 4"), {"9:42: ", "empty name"}},
      {changed(kScene, "Elements: 4", "[a]: 4"), {"9:42: ", "a sequence as a name"}},
      {changed(kScene, "Elements: 4", "Elements: !x 4"), {"9:52: tag \"!x\""}},
      {changed(kScene, "Elements: 4", "Elements: [[4]]"), {"9:53: ", "a sequence in a sequence"}},
      {changed(kScene, "[0, 0, 0]", "{0, 0, 0}"), {"5:10: YAML path \"Scene / Points / no / 0\": no value"}},
      {changed(kScene, "Elements: 4", "Elements: \"\\x01\""), {"9:52: ", "control character"}},
      {kScene + "---\na: 1\n", {"scene.yaml:20:1: a second document"}},
      {kScene + "\tx: 1\n", {"scene.yaml:20:", "not well-formed YAML"}},
      {kScene + "\xff: 1\n", {"scene.yaml:20: not a text in UTF-8"}},
      {kScene + std::string("a: \0\n", 5), {"scene.yaml:20: not a text in UTF-8"}},
      {"", {"scene.yaml:1: the file is empty"}},
      {"- a\n", {"scene.yaml:1:1: a sequence; allowed: lists by their names"}},
      {"Name: [a]\n", {"scene.yaml:1:1: ", "unknown name"}},
      {"Name:\n", {"scene.yaml:1:1: YAML path \"Name\": no value"}}};
  for (const auto& [text, parts] : wrong) expect_in(refusal_of(text), parts);
}

TEST(YamlReader, AliasesRepeatWholeLists) {
  const XmlParameters yaml = parsed("Study: {a: &list {x: 1, y: [2, 3]}, b: *list, c: &word yes, d: *word}\n");
  const auto& study = yaml.list->sublist("Study");
  EXPECT_EQ(study.sublist("b").get<int>("x"), 1);
  EXPECT_EQ(study.get<std::string>("d"), "yes");
}

TEST(YamlReader, HostileFilesAreRefused) {
  std::string bomb = "a0: &a0 {x: 1, y: 1}\n";
  for (int i = 1; i < 40; ++i) {
    const std::string one = std::to_string(i), before = std::to_string(i - 1);
    bomb += "a" + one + ": &a" + one + " {x: *a" + before + ", y: *a" + before + "}\n";
  }
  expect_in(refusal_of(bomb), {"aliases unfold to more than 100000 entries"});
  expect_in(refusal_of("a: &a {x: *a}\n"), {"nested deeper than 64 by an alias"});
  const auto repeated = [](const std::string& piece, std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += piece;
    return text;
  };
  constexpr std::size_t kMany = 200'000;
  for (const std::string piece : {"[", "{a: ", "- ", "? "})
    expect_in(refusal_of(repeated(piece, kMany)), {"scene.yaml:1:", "nested deeper than 64"});
  for (const std::string piece : {"a", "\"", "&a ", "!a ", "*", "a: ", "|", "%", "[],"})
    refusal_of(repeated(piece, kMany));
}

TEST(YamlReader, TheFormatFollowsFromTheNameOrElseFromTheText) {
  EXPECT_EQ(format_of("a.xml"), FileFormat::xml);
  EXPECT_EQ(format_of("a.YML"), FileFormat::yaml);
  EXPECT_EQ(format_of("a.yaml", "Scene:"), FileFormat::yaml);
  EXPECT_EQ(format_of("a.yaml", "<?xml"), FileFormat::xml);  // what Python makes of the scene in that file
  EXPECT_EQ(format_of("run.h5 (scene)", "\n<ParameterList"), FileFormat::xml);
  EXPECT_EQ(format_of("run.h5 (scene)", "# a\nScene:"), FileFormat::yaml);
  expect_in(message_of([] { parse_parameters("Scene: {}", "a.xml", root_of_scenes()); }), {"a.xml:1: ", "XML"});
}

}  // namespace
}  // namespace mixbeam::yaml_reader_test
