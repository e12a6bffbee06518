/// Scenes in XML and YAML: `mixbeam convert` there and back, and runs of either.
#include "apps/mixbeam/commands.hpp"
#include "discretization/parameters/value.hpp"
#include "mixbeam_files.hpp"

namespace mixbeam::convert_test {
namespace {

class Convert : public MixbeamTest {
 protected:
  void convert(const std::string& from, const std::string& to) {
    expect_code(kOk, mixbeam({"convert", from, file(to)}));
  }
};

std::vector<fs::path> scenes_of_the_repository() {
  std::vector<fs::path> scenes;
  for (const char* folder : {"apps", "tests"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(MIXBEAM_SOURCE_DIR) / folder))
      if (entry.path().extension() == ".xml") scenes.push_back(entry.path());
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

/// Names and values of a list, with all their digits. A whole number for a real is the same in YAML.
std::string contents(const Teuchos::ParameterList& list) {
  std::string text;
  for (auto entry = list.begin(); entry != list.end(); ++entry) {
    const std::string& name = list.name(entry);
    text += name + " = ";
    text +=
        list.isSublist(name) ? "{" + contents(list.sublist(name)) + "}\n" : to_text(value_of(list.entry(entry))) + "\n";
  }
  return text;
}

std::string contents_of_xml(const std::string& text) {
  const XmlParameters xml = parse_xml(text, "scene.xml");
  return xml.list->name() + "\n" + contents(*xml.list);
}

TEST(SceneFormats, EverySceneSurvivesTheWayToYamlAndBack) {
  const ListSpec root = mixbeam_root_spec();
  const std::vector<fs::path> scenes = scenes_of_the_repository();
  EXPECT_GT(scenes.size(), 50u);
  for (const fs::path& scene : scenes) {
    const std::string text = text_of(scene), yaml = yaml_text(parse_xml(text, "scene.xml"), root, "scene.yaml");
    EXPECT_EQ(contents_of_xml(xml_text(*parse_yaml(yaml, "scene.yaml", root).list)), contents_of_xml(text)) << scene;
  }
  const std::string text = text_of(scenes[0]);
  EXPECT_NE(contents_of_xml(changed(text, "type=\"double\" value=\"", "type=\"double\" value=\"1")),
            contents_of_xml(text));
}

const std::string kCommented = R"xml(<!-- top, of
     two lines -->
<ParameterList name="rod">
  <ParameterList name="Scene">
    <!-- of the sections -->
    <ParameterList name="Sections">
      <ParameterList name="rod"> <!-- inside -->
        <Parameter name="EA" type="double" value="1e300"/>  <!-- stiff -->
        <Parameter name="Shear Rigid" type="bool" value="true"/>
        <Parameter name="GIt" type="int" value="1"/>
        <Parameter name="EI2" type="double" value="0.1"/>
        <Parameter name="EI3" type="double" value="0.30000000000000004"/>
        <!-- last -->
      </ParameterList>
    </ParameterList>
    <ParameterList name="Points">
      <Parameter name="no" type="Array(double)" value="{0, 0, 0}"/>
      <Parameter name="a: #b" type="Array(double)" value="{1, 0, -0.0}"/>
    </ParameterList>
    <ParameterList name="Members"><ParameterList name="1e3">
      <Parameter name="Start" type="string" value="no"/>
      <Parameter name="End" type="string" value="a: #b"/>
    </ParameterList></ParameterList>
    <ParameterList name="Supports"><ParameterList name="&quot;\&lt;">
      <Parameter name="Point" type="string" value="no"/>
      <Parameter name="Fixed Rotation" type="Array(string)" value="{}"/>
    </ParameterList></ParameterList>
  </ParameterList>
</ParameterList>
<!-- bottom -->
)xml";

TEST_F(Convert, CommentsNamesAndDigitsSurvive) {
  write_text(file("rod.xml"), kCommented);
  convert(file("rod.xml"), "rod.yaml");
  EXPECT_EQ(text_of(file("rod.yaml")), R"(# top, of
# two lines
Scene:
  # of the sections
  Sections:
    rod:
      # inside
      EA: 1.0e+300  # stiff
      Shear Rigid: true
      GIt: 1
      EI2: 0.1
      EI3: 0.30000000000000004
      # last
  Points:
    "no": [0, 0, 0]
    "a: #b": [1, 0, -0]
  Members:
    "1e3": {Start: "no", End: "a: #b"}
  Supports:
    "\"\\<": {Point: "no", Fixed Rotation: []}
# bottom
)");
  const Ended back = mixbeam({"convert", file("rod.yaml"), file("back.xml")});
  expect_in(back.out, {"warning: the comments of ", "rod.yaml are not in "});
  EXPECT_EQ(contents_of_xml(text("back.xml")), contents_of_xml(text("rod.xml")));
}

/// EA = 7e9 at (0.3, -0.2), where its principal axes are turned by cos = 0.8, EI = 5e7 and 6e8 about them; the
/// reference point lies in the origin.
const std::string kSectionOfVabs = R"( Timoshenko Stiffness Matrix (1-extension; 2,3-shear, 4-twist; 5,6-bending)
 ======================================

 7000000000 0 0 0 -1400000000 -2100000000
 0 2360000000 -480000000 328000000 0 0
 0 -480000000 2640000000 696000000 0 0
 0 328000000 696000000 314400000 0 0
 -1400000000 0 0 0 528000000 156000000
 -2100000000 0 0 0 156000000 1032000000
)";

/// A force along a member through the reference point bends it about both axes of its centre: the moments 0.2 and 0.3
/// of 1 N give kappa_2 = 5.32e-9, kappa_3 = 4.24e-9, linear theory to P L^2 / EI = 2e-8.
TEST_F(Convert, SectionsOfOtherProgramsBendAboutTheirCentre) {
  write_text(file("root.K"), kSectionOfVabs);
  write_text(file("tip.K"), kSectionOfVabs);
  const auto bends = [&](const std::vector<std::string>& sections, const std::string& value) {
    std::vector<std::string> arguments = {"convert"};
    for (const std::string& section : sections) arguments.push_back(file(section));
    arguments.insert(arguments.end(), {file("blade.yaml"), "--force"});
    expect_in(expect_code(kOk, mixbeam(arguments)).out, {"note: the length is not in the file: the variable L is 1"});
    write_text(file("loaded.yaml"), text_of(file("blade.yaml")) +
                                        "  Point Loads: {pull: {Point: tip, Force: [1, 0, 0]}}\nExpected:\n"
                                        "  up: {Quantity: displacement, Point: tip, Component: z, Load Factor: 1, "
                                        "Relative Tolerance: 1e-6, Source: closed form, Value: " +
                                        value + "}\n");
    return mixbeam({"run", file("loaded.yaml"), "--force"}).exit_code;
  };
  EXPECT_EQ(bends({"root.K"}, "-2.66e-9"), 0);
  EXPECT_EQ(bends({"root.K", "tip.K"}, "-2.66e-9"), 0);
  EXPECT_NE(bends({"root.K"}, "-2.12e-9"), 0);  // as if axes 2 and 3 were exchanged
}

TEST_F(Convert, SectionsOfOtherProgramsAreImported) {
  write_text(file("root.K"), kSectionOfVabs);
  write_text(file("scene.yaml"), R"(Scene:
  Import: {Sections File: root.K}
  Points: {a: [0, 0, 0], b: [1, 0, 0]}
  Members: {rod: {Start: a, End: b, Section: root, Second Axis: [0, 1, 0]}}
  Supports: {a: {Point: a}}
  Point Loads: {pull: {Point: b, Force: [1, 0, 0]}}
Expected:
  side: {Quantity: displacement, Point: b, Component: y, Load Factor: 1, Relative Tolerance: 1e-6, Source: closed form, Value: 2.12e-9}
)");
  EXPECT_EQ(mixbeam({"run", file("scene.yaml")}).exit_code, 0);
  write_text(file("root.K"), changed(kSectionOfVabs, "-2100000000 0", "2100000000 0"));
  expect_refused(mixbeam({"check", file("scene.yaml")}), {"root.K", "stiffness matrix is not symmetric"});
}

TEST_F(Convert, RefusesWhatItWouldChange) {
  write_text(file("a.xml"), kCommented);
  const auto refused = [&](const std::vector<std::string>& arguments, const std::vector<std::string>& parts) {
    expect_refused(mixbeam(arguments), parts);
  };
  convert(file("a.xml"), "a.yaml");
  refused({"convert", file("a.xml"), file("a.yaml")}, {"is there already", "--force"});
  EXPECT_EQ(mixbeam({"convert", file("a.xml"), file("a.yaml"), "--force"}).exit_code, 0);
  refused({"convert", file("a.xml")}, {"1 files given to \"convert\"; allowed: two"});
  refused({"convert", file("a.xml"), file("a.json")}, {"unknown ending; allowed: .xml, .yaml, .yml"});
  refused({"convert", file("a.xml"), file("nowhere/b.yaml")}, {"nowhere"});
  write_text(file("b.yaml"), changed(text_of(file("a.yaml")), "Fixed Rotation: []}", R"(Point Loads: 1})"));
  refused({"convert", file("b.yaml"), file("b.xml")}, {"b.yaml:21:", "Point Loads", "unknown name"});
  write_text(file("c.yaml"), changed(text_of(file("a.yaml")), "# bottom\n", "Study: {words: [\"a, b\", c]}\n"));
  refused({"convert", file("c.yaml"), file("c.xml")}, {"c.yaml:22:", "Study / words", "cannot be written to"});
  EXPECT_FALSE(fs::exists(file("c.xml")));
}

TEST_F(Convert, RunsOfEitherFileAreTheSameBits) {
  const fs::path scene = fs::path(MIXBEAM_SOURCE_DIR) / "apps" / "gallery" / "snap_back.xml";
  convert(scene.string(), "snap_back.yaml");
  ASSERT_EQ(mixbeam({"run", scene.string(), "--quiet", "--threads", "1", "--output", file("xml")}).exit_code, 0);
  expect_code(kOk, mixbeam({"run", file("snap_back.yaml"), "--quiet", "--threads", "1", "--output", file("yaml")}));
  const auto xml = contents_of(folder_ / "xml/snap_back.h5"), yaml = contents_of(folder_ / "yaml/snap_back.h5");
  EXPECT_EQ(differences(xml, yaml), "scene differs\n");
  const std::string results = file("yaml/snap_back.h5");
  expect_code(kOk, mixbeam({"resume", results, "--quiet", "--from", "1", "--threads", "1"}));
  EXPECT_EQ(differences(yaml, contents_of(results)), "");
}

const std::string kWithFormulas = R"yaml(Scene:
  Variables: {L: 2, slope: 30 deg, h: "=L*tan(slope)", n: "=5*L", F: "=1/L"}
  Sections: {strip: {EA: "=100*L", Shear Rigid: true, GIt: 1, EI2: 1, EI3: 1}}
  Points: {foot: [0, 0, 0], top: ["=L", 0, "=h"]}
  Members: {rod: {Start: foot, End: top, Section: strip, Order: 3, Elements: "=n"}}
  Supports: {clamp: {Point: foot}}
  Point Loads: {push: {Point: top, Force: [0, "=-F", "=x('top')*0.01"]}}
Quantities: {sag: {Quantity: displacement, Point: top, Component: y, Limit: "=2*L"}}
Solver: {Load Path: {Maximum Step: "=1/4"}}
)yaml";

/// Formulas are those numbers that one would type, in runs of either format, in resumed ones and in what they tell.
TEST_F(Convert, FormulasStayFormulasAndCountAsTheirNumbers) {
  write_text(file("rod.yaml"), kWithFormulas);
  convert(file("rod.yaml"), "rod.xml");
  expect_in(text_of(file("rod.xml")),
            {R"(type="int" value="=n")", R"xml(type="Array(double)" value="{0, =-F, =x('top')*0.01}")xml"});
  convert(file("rod.xml"), "back.yaml");
  expect_in(text_of(file("back.yaml")), {R"yaml(Force: [0, "=-F", "=x('top')*0.01"])yaml"});
  std::string numbers = kWithFormulas;
  for (const auto& [formula, number] : std::vector<std::pair<std::string, std::string>>{
           {"  Variables: {L: 2, slope: 30 deg, h: \"=L*tan(slope)\", n: \"=5*L\", F: \"=1/L\"}\n", ""},
           {"\"=100*L\"", "200"},
           {"\"=L\"", "2"},
           {"\"=h\"", shortest(2 * std::tan(30 * (std::acos(-1.0) / 180.0)))},
           {"\"=n\"", "10"},
           {"\"=-F\"", "-0.5"},
           {"\"=x('top')*0.01\"", "0.02"},
           {"\"=2*L\"", "4"},
           {"\"=1/4\"", "0.25"}})
    numbers = changed(numbers, formula, number);
  write_text(file("typed.yaml"), numbers);
  const auto solved = [&](const std::string& scene, const std::string& output) {
    expect_code(kOk, mixbeam({"run", file(scene), "--quiet", "--threads", "1", "--output", file(output)}));
    return contents_of(folder_ / output / (fs::path(scene).stem().string() + ".h5"));
  };
  const auto yaml = solved("rod.yaml", "yaml"), xml = solved("rod.xml", "xml"), typed = solved("typed.yaml", "typed");
  EXPECT_EQ(differences(yaml, xml), "scene differs\n");
  const std::string names = differences(yaml, typed);  // of the scene, and its text
  EXPECT_EQ(std::count(names.begin(), names.end(), '\n'), 2) << names;
  const std::string results = file("yaml/rod.h5");
  EXPECT_EQ(mixbeam({"resume", results, "--quiet", "--from", "1", "--threads", "1"}).exit_code, 0);
  EXPECT_EQ(differences(yaml, contents_of(results)), "");
  const Ended check = mixbeam({"check", file("rod.yaml")});
  expect_in(check.out,
            {"variable L = 2\n", "variable slope = 0.5235987756  (\"30 deg\")", "variable n = 10  (\"=5*L\")"});
  write_text(file("wrong.yaml"), changed(kWithFormulas, "=100*L", "=100*M"));
  const Ended wrong = expect_code(kBadInput, mixbeam({"check", file("wrong.yaml")}));
  expect_in(wrong.err,
            {"wrong.yaml:3:", "Scene / Sections / strip / EA", "=100*M", "unknown name \"M\"", "\"L\", \"slope\""});
}

TEST_F(Convert, ABatchReadsYamlAndItsTableBesideIt) {
  const fs::path folder = fs::path(MIXBEAM_SOURCE_DIR) / "apps" / "batch";
  fs::copy_file(folder / "elastica_sweep.csv", folder_ / "elastica_sweep.csv");
  convert((folder / "elastica_sweep.xml").string(), "elastica_sweep.yaml");
  const auto table = [&](const std::string& scene, const std::string& output) {
    expect_code(kOk, mixbeam({"batch", scene, "--quiet", "--threads", "1", "--output", file(output)}));
    return text_of(folder_ / output / "elastica_sweep-batch.csv");
  };
  const std::string xml = table((folder / "elastica_sweep.xml").string(), "xml");
  EXPECT_GT(xml.size(), 100u);
  EXPECT_EQ(table(file("elastica_sweep.yaml"), "yaml"), xml);
}

}  // namespace
}  // namespace mixbeam::convert_test
