#include "discretization/parameters/binding.hpp"

#include "discretization/parameters/validate.hpp"
#include "discretization/reading/scene_parts.hpp"
#include "input_text.hpp"
#include "tests/support/text.hpp"

namespace mixbeam {
namespace {

enum class Finish { plain, painted };

struct Grip {
  double length = 0.25;
};

struct Tool {
  int teeth = 7;
  double weight = 1.5;
  Finish finish = Finish::painted;
  std::array<double, 3> axis{0, 0, 1};
  std::array<bool, 2> sharp{};
  std::vector<std::string> owners{};
  std::optional<double> price{};
  Grip grip{};
  bool keeps_teeth = false;
};

BoundList<Tool> tool_parameters() {
  BoundList<Tool> tool("A tool.");
  tool.bind(&Tool::teeth, integer("Teeth").at_least(1).by_default(), "How many.").marks(&Tool::keeps_teeth);
  tool.bind(&Tool::weight, real("Weight").by_default(), "How heavy.").compared_within(0.1);
  tool.bind(&Tool::finish, text("Finish").by_default(), "What covers it.",
            {{"plain", Finish::plain}, {"painted", Finish::painted}});
  tool.bind(&Tool::axis, vector3("Axis").longer_than(1e-3), "Where it points.");
  tool.bind(&Tool::sharp, subset("Sharp", {"left", "right"}), "Sides.");
  tool.bind(&Tool::owners, array("Owners", ParameterType::text_array), "Whose it is.").not_compared();
  tool.bind(&Tool::price, real("Price"), "What it costs.");
  BoundList<Grip> grip("Where it is held.");
  grip.bind(&Grip::length, real("Length").by_default(), "How long.");
  tool.bind_list(&Tool::grip, "Grip", grip);
  tool.spec.with_forms("Finish", {{"plain", {Form{}}}, {"painted", {Form{{}, {"Price"}}}}});
  return tool;
}

std::string entry(const std::string& name, const std::string& type, const std::string& value) {
  return "<Parameter name=\"" + name + "\" type=\"" + type + "\" value=\"" + value + "\"/>";
}

Tool tool_with(const std::string& entries) {
  XmlParameters xml = parse_xml("<ParameterList name=\"tool\">" + entries + "</ParameterList>", "file.xml");
  validate(*xml.list, tool_parameters().spec, xml.source);
  return tool_parameters().read(*xml.list);
}

TEST(Binding, TakesDefaultsFromTheStruct) {
  const BoundList<Tool> tool = tool_parameters();
  EXPECT_EQ(to_text(tool.spec.find_parameter("Teeth")->default_value), "7");
  EXPECT_EQ(to_text(tool.spec.find_parameter("Finish")->default_value), "\"painted\"");
  const Tool read = tool_with("");
  EXPECT_EQ(tool.difference(read, Tool{}), "");
  EXPECT_EQ(read.grip.length, 0.25);
  EXPECT_FALSE(read.keeps_teeth);
}

TEST(Binding, FillsFieldsOfEveryKind) {
  const Tool read = tool_with(entry("Teeth", "int", "7") + entry("Weight", "int", "2") +
                              entry("Axis", "Array(double)", "{1, 2, 3}") + entry("Price", "double", "9.5") +
                              entry("Sharp", "Array(string)", "{right}") + entry("Owners", "Array(string)", "{a, b}") +
                              "<ParameterList name=\"Grip\">" + entry("Length", "double", "3") + "</ParameterList>");
  EXPECT_TRUE(read.keeps_teeth) << "given, though equal to the default";
  EXPECT_EQ(read.weight, 2.0);
  EXPECT_EQ(read.axis, (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(read.sharp, (std::array<bool, 2>{false, true}));
  EXPECT_EQ(read.owners, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(read.price, 9.5);
  EXPECT_EQ(read.grip.length, 3.0);
  EXPECT_EQ(tool_with(entry("Finish", "string", "plain")).finish, Finish::plain);
}

TEST(Binding, ComparesWhatIsDeclared) {
  const BoundList<Tool> tool = tool_parameters();
  Tool other;
  other.weight += 0.09;
  other.owners = {"c"};
  EXPECT_EQ(tool.difference(Tool{}, other), "");
  other.weight += 0.02;
  EXPECT_EQ(tool.difference(Tool{}, other), "Weight");
  other.teeth = 8;
  EXPECT_EQ(tool.difference(Tool{}, other), "Teeth");
  Tool blunt;
  blunt.sharp[0] = true;
  EXPECT_EQ(tool.difference(Tool{}, blunt), "Sharp");
}

TEST(Binding, WordsDecideWhichParametersAreAllowed) {
  const auto refusal = [](const std::string& entries) { return message_of([&] { tool_with(entries); }); };
  const std::string price = entry("Price", "double", "1");
  EXPECT_NO_THROW(tool_with(price));
  expect_in(refusal(price + entry("Finish", "string", "plain")),
            {"Price\": given, but has no meaning for \"Finish\" = \"plain\"", "none of \"Price\""});
  expect_in(refusal(entry("Axis", "Array(double)", "{0, 0, 0}")), {"Axis\": value {0, 0, 0} has no direction"});
}

/// Whoever binds a property of members gets its comparison without asking for it.
TEST(Binding, MembersAreComparedUnlessGeometrySaysIt) {
  std::vector<std::string> not_compared;
  for (const BoundParameter<Member>& parameter : member_parameters().parameters)
    if (!parameter.is_compared) not_compared.push_back(parameter.spec.name);
  EXPECT_EQ(not_compared, (std::vector<std::string>{"Start", "End", "Stations", "Second Axis", "Second Axis From"}));
}

/// The parser would compare each of them with each: 40 s for 200,000.
TEST(XmlReader, RefusesATagWithManyAttributesAtOnce) {
  const auto with = [](int attributes) {
    std::string tag = "<!-- \"quotes\" -->\n<ParameterList name=\"s\"><Parameter";
    for (int i = 0; i < attributes; ++i) tag += " a" + std::to_string(i) + "=\"1\"";
    return tag + "/></ParameterList>";
  };
  expect_in(message_of([&] { parse_xml(with(200'000), "s.xml"); }),
            {"s.xml:2: a tag with more than 100", "allowed: \"name\""});
  expect_in(message_of([&] { parse_xml(with(50), "s.xml"); }), {"s.xml:2", "unknown attribute \"a0\""});
}

}  // namespace
}  // namespace mixbeam
