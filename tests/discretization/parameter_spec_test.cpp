#include "discretization/parameters/spec.hpp"

#include "discretization/parameters/print.hpp"
#include "discretization/parameters/validate.hpp"
#include "discretization/text/message_text.hpp"
#include "input_text.hpp"

#include <limits>
#include <sstream>

namespace mixbeam {
namespace {

ListSpec beam_spec() {
  ListSpec beam("One beam.");
  beam.add(real("Length").above(0.0).required().means("Its length [length]."));
  beam.add(real("Stiffness").above(0.0).or_infinite().by_default(2).means("Its stiffness [force]."));
  beam.add(integer("Elements").at_least(1).at_most(8).by_default(4).means("Their number."));
  beam.add(choice("Rule", {"full", "reduced"}).by_default("reduced").means("Integration."));
  beam.add(vector3("Axis").means("Its axis."));
  beam.add(subset("Fixed", {"x", "y", "z"}).means("Fixed directions."));
  beam.had_once("Width");
  return beam;
}

ListSpec root_spec() {
  ListSpec options("Options.");
  options.add(boolean("Verbose").by_default(false).means("Say more."));
  ListSpec extra("Extra.");
  extra.add(integer("Level").by_default(1).means("A level."));
  ListSpec root;
  root.add_list("Beams", ListSpec("Beams.").with_named_lists("beam", beam_spec(), 1), Presence::required);
  root.add_list("Points",
                ListSpec("Points.").with_named_parameters("point", vector3("").required().means("Coordinates.")));
  root.add_list("Options", options);
  root.add_list("Extra", extra, Presence::optional);
  root.add_list("Free", ListSpec("Free.").without_checks(), Presence::optional);
  return root;
}

/// A beam called "b" with a length and one more line; inside "Beams" at line 3, the further line is line 5.
std::string beam_with(const std::string& line, const std::string& elsewhere = "") {
  return "<ParameterList name=\"root\">\n<ParameterList name=\"Beams\">\n<ParameterList name=\"b\">\n"
         "<Parameter name=\"Length\" type=\"double\" value=\"1\"/>\n" +
         line + "\n</ParameterList>\n</ParameterList>\n" + elsewhere + "\n</ParameterList>\n";
}

XmlParameters validated(const std::string& text) {
  XmlParameters xml = parse_xml(text, "file.xml");
  validate(*xml.list, root_spec(), xml.source);
  return xml;
}

std::string error_with(const std::string& line, const std::string& elsewhere = "") {
  return message_of([&] { validated(beam_with(line, elsewhere)); });
}

std::string entry(const std::string& name, const std::string& type, const std::string& value) {
  return "<Parameter name=\"" + name + "\" type=\"" + type + "\" value=\"" + value + "\"/>";
}

TEST(ParameterSpec, FillsDefaultsAndNothingElse) {
  const auto list = validated(beam_with("")).list;
  const auto& beam = list->sublist("Beams").sublist("b");
  EXPECT_EQ(beam.get<double>("Stiffness"), 2.0);
  EXPECT_EQ(beam.get<int>("Elements"), 4);
  EXPECT_EQ(beam.get<std::string>("Rule"), "reduced");
  EXPECT_FALSE(beam.isParameter("Axis"));
  EXPECT_FALSE(list->sublist("Options").get<bool>("Verbose"));
  EXPECT_FALSE(list->isSublist("Extra"));
}

TEST(ParameterSpec, SecondValidationChangesNothing) {
  XmlParameters xml = validated(beam_with(entry("Stiffness", "int", "3")));
  const Teuchos::ParameterList once = *xml.list;
  validate(*xml.list, root_spec(), xml.source);
  EXPECT_TRUE(once == *xml.list);
}

TEST(ParameterSpec, WarnsOfRemovedParametersAndGoesOn) {
  XmlParameters xml = parse_xml(beam_with(entry("Width", "string", "any")), "file.xml");
  const std::vector<std::string> warnings = validate(*xml.list, root_spec(), xml.source);
  ASSERT_EQ(warnings.size(), 1);
  expect_in(warnings[0], {"file.xml:5: XML path \"Beams / b / Width\": ", "was removed", "the run goes on without it"});
  EXPECT_TRUE(*xml.list == *validated(beam_with("")).list);
  EXPECT_TRUE(validate(*xml.list, root_spec(), xml.source).empty());
  // its name misspelt, and a list of its name, are still errors, and it is never proposed
  const std::string misspelt = error_with(entry("Widt", "string", "any"));
  expect_in(misspelt, {"unknown name"});
  EXPECT_EQ(misspelt.find("\"Width\""), std::string::npos);
  expect_in(error_with("<ParameterList name=\"Width\"/>"), {"unknown name"});
}

TEST(ParameterSpec, TakesWholeNumbersForReals) {
  const auto list =
      validated(beam_with(entry("Stiffness", "int", "3") + entry("Axis", "Array(int)", "{0, 0, 1}"))).list;
  EXPECT_EQ(list->sublist("Beams").sublist("b").get<double>("Stiffness"), 3.0);
  EXPECT_EQ(list->sublist("Beams").sublist("b").get<Teuchos::Array<double>>("Axis")[2], 1.0);
}

TEST(ParameterSpec, RefusesUnknownNamesWithTheNearest) {
  expect_in(error_with(entry("Elments", "int", "3")), {"file.xml:5: XML path \"Beams / b / Elments\": unknown name",
                                                       "\"Length\", \"Stiffness\"", "did you mean \"Elements\"?"});
  expect_in(error_with("", "<ParameterList name=\"Option\"/>"), {"file.xml:8: ", "did you mean \"Options\"?"});
}

TEST(ParameterSpec, RefusesWrongTypes) {
  expect_in(error_with(entry("Elements", "double", "3")), {"file.xml:5: ", "value 3 of type double", "allowed: int"});
  expect_in(error_with(entry("Rule", "int", "3")), {"value 3 of type int", "allowed: string"});
  expect_in(error_with(entry("Axis", "double", "3")), {"type double", "Array(double) of 3 values"});
  expect_in(error_with("<ParameterList name=\"Elements\"/>"), {"a ParameterList; allowed: a Parameter, int"});
  expect_in(error_with("", entry("Options", "int", "3")), {"file.xml:8: ", "a Parameter; allowed: a ParameterList"});
}

TEST(ParameterSpec, RefusesValuesOutOfRange) {
  expect_in(error_with(entry("Elements", "int", "9")), {"file.xml:5: ", "value 9", "1 <= value <= 8", "Their number"});
  expect_in(error_with(entry("Elements", "int", "0")), {"value 0"});
  expect_in(error_with(entry("Stiffness", "double", "0")), {"value 0", "value > 0, or inf"});
  expect_in(error_with(entry("Stiffness", "double", "nan")), {"value nan"});
  expect_in(error_with(entry("Stiffness", "double", "-inf")), {"value -inf"});
  expect_in(error_with(entry("Axis", "Array(double)", "{0, inf, 1}")), {"value {0, inf, 1}"});
  EXPECT_NO_THROW(validated(beam_with(entry("Stiffness", "double", "inf"))));
}

TEST(ParameterSpec, RefusesBadChoicesAndLengths) {
  expect_in(error_with(entry("Rule", "string", "reducd")),
            {"\"reducd\"", "\"full\", \"reduced\"", "did you mean \"reduced\"?"});
  expect_in(error_with(entry("Axis", "Array(double)", "{1, 2}")), {"{1, 2} has 2 entries", "3 values"});
  expect_in(error_with(entry("Fixed", "Array(string)", "{x, w}")), {"\"w\"", "\"x\", \"y\", \"z\""});
  expect_in(error_with(entry("Fixed", "Array(string)", "{x, x}")), {"\"x\" twice"});
  EXPECT_NO_THROW(validated(beam_with(entry("Fixed", "Array(string)", "{}"))));
}

TEST(ParameterSpec, RefusesWhatIsMissing) {
  const std::string no_length = changed(beam_with(""), entry("Length", "double", "1"), "");
  expect_in(message_of([&] { validated(no_length); }),
            {"file.xml:3: XML path \"Beams / b / Length\": missing", "double, value > 0"});
  expect_in(message_of([] { validated("<ParameterList name=\"root\"/>"); }), {"file.xml:1: ", "\"Beams\"", "missing"});
  expect_in(
      message_of([] { validated("<ParameterList name=\"root\"><ParameterList name=\"Beams\"/></ParameterList>"); }),
      {"0 entries; allowed: at least 1, one per beam"});
}

TEST(ParameterSpec, ChecksFreeNames) {
  const auto points = [](const std::string& inside) {
    return "<ParameterList name=\"Points\">" + inside + "</ParameterList>";
  };
  EXPECT_NO_THROW(validated(beam_with("", points(entry("any name", "Array(double)", "{1, 2, 3}")))));
  expect_in(error_with("", points(entry("p", "string", "x"))), {"\"Points / p\"", "type string", "Array(double)"});
  expect_in(error_with("", points("<ParameterList name=\"p\"/>")),
            {"a ParameterList; allowed: one Parameter per point"});
}

TEST(ParameterSpec, LeavesFreeListsAlone) {
  EXPECT_NO_THROW(validated(beam_with(
      "", "<ParameterList name=\"Free\">" + entry("x", "int", "1") + "<ParameterList name=\"y\"/></ParameterList>")));
}

TEST(ParameterSpec, NamesTheProgramWhenThereIsNoFile) {
  Teuchos::ParameterList list;
  expect_in(message_of([&] { validate(list, root_spec(), ParameterSource()); }), {"set by the program", "\"Beams\""});
}

TEST(ParameterSpec, PrintsTheWholeTreeInTheWidthOfATerminal) {
  std::ostringstream out;
  print_parameters(out, root_spec(), "root");
  expect_in(out.str(), {"[root]", "[Beams] required", "[<beam>] one or more",
                        "Stiffness: double, value > 0, or inf; default 2", "Length: double, value > 0; required",
                        "<point> any number: Array(double) of 3 values", "Say more.", "[Free] optional"});
  std::istringstream lines(out.str());
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

TEST(NearestName, FindsSlipsAndNothingFarther) {
  const std::vector<std::string> names = {"Start", "End", "Section", "Elements"};
  EXPECT_EQ(nearest_name("Elments", names), "Elements");
  EXPECT_EQ(nearest_name("Strat", names), "Start");
  EXPECT_EQ(nearest_name("section", names), "Section");
  EXPECT_EQ(nearest_name("Sec", names), "Section");
  EXPECT_EQ(nearest_name("Temperature", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  const std::vector<std::string> kinds = {"force energy", "reaction force", "natural frequency", "normal stress"};
  EXPECT_EQ(nearest_name("frequency", kinds), "natural frequency");
  EXPECT_EQ(nearest_name("Stress", kinds), "normal stress");
  EXPECT_EQ(nearest_name("force", kinds), "");  // the twin: in two of them
  EXPECT_EQ(nearest_name("press", kinds), "");  // no whole word
  EXPECT_EQ(nearest_name("x", {"y", "z"}), "");
  EXPECT_EQ(nearest_name("EI", {"EA", "EI2", "EI3"}), "EI2");  // what begins so before other letters
  EXPECT_EQ(nearest_name("EX", {"EA", "EI2", "EI3"}), "EA");
}

}  // namespace
}  // namespace mixbeam
