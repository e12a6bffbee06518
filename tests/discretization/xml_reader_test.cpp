#include "discretization/parameters/parameter_file.hpp"

#include "input_text.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace mixbeam {
namespace {

std::string in_list(const std::string& inside) {
  return "<ParameterList name=\"root\">\n" + inside + "\n</ParameterList>\n";
}

std::string parameter(const std::string& name, const std::string& type, const std::string& value) {
  return "<Parameter name=\"" + name + "\" type=\"" + type + "\" value=\"" + value + "\"/>";
}

std::string error_in(const std::string& inside) {
  return message_of([&] { parse_xml(in_list(inside), "file.xml"); });
}

TEST(XmlReader, ReadsEveryType) {
  const std::string text =
      in_list(parameter("yes", "bool", "true") + parameter("count", "int", "-12") + parameter("plus", "int", "+3") +
              parameter("length", "double", " 1.5e-3 ") + parameter("whole", "double", "7") +
              parameter("rigid", "double", "inf") + parameter("word", "string", "a &amp; b &lt; c") +
              parameter("ints", "Array(int)", "{1, 2,3}") + parameter("reals", "Array(double)", "{0.1, -2, 3e4}") +
              parameter("words", "Array(string)", "{x, long name}") + parameter("none", "Array(string)", "{}"));
  const auto list = parse_xml(text, "file.xml").list;
  EXPECT_EQ(list->name(), "root");
  EXPECT_TRUE(list->get<bool>("yes"));
  EXPECT_EQ(list->get<int>("count"), -12);
  EXPECT_EQ(list->get<int>("plus"), 3);
  EXPECT_EQ(list->get<double>("length"), 1.5e-3);
  EXPECT_EQ(list->get<double>("whole"), 7.0);
  EXPECT_TRUE(std::isinf(list->get<double>("rigid")));
  EXPECT_EQ(list->get<std::string>("word"), "a & b < c");
  EXPECT_EQ(list->get<Teuchos::Array<int>>("ints").toVector(), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(list->get<Teuchos::Array<double>>("reals").toVector(), (std::vector<double>{0.1, -2.0, 3e4}));
  EXPECT_EQ(list->get<Teuchos::Array<std::string>>("words").toVector(), (std::vector<std::string>{"x", "long name"}));
  EXPECT_EQ(list->get<Teuchos::Array<std::string>>("none").size(), 0);
}

TEST(XmlReader, KnowsTheLineOfEveryEntry) {
  const std::string text =
      in_list("<ParameterList name=\"Members\">\n<ParameterList name=\"shaft\">\n" + parameter("Order", "int", "3") +
              "\n" + parameter("Elements", "int", "4") + "\n</ParameterList>\n</ParameterList>");
  const XmlParameters xml = parse_xml(text, "scene.xml");
  EXPECT_EQ(xml.source.line({"Members"}), 2);
  EXPECT_EQ(xml.source.line({"Members", "shaft", "Elements"}), 5);
  EXPECT_EQ(xml.source.where({"Members", "shaft", "Missing"}), "scene.xml:3");
  EXPECT_EQ(xml.text, text);
}

TEST(XmlReader, ReportsTheFirstLineOfATagOverSeveralLines) {
  const XmlParameters xml = parse_xml(in_list("<Parameter\n name=\"a\"\n type=\"int\"\n value=\"1\"/>"), "file.xml");
  EXPECT_EQ(xml.source.line({"a"}), 2);
}

TEST(XmlReader, KnowsLinesBeyondSixteenBits) {
  constexpr int kLines = 70000;
  const XmlParameters xml = parse_xml(in_list(std::string(kLines, '\n') + parameter("a", "int", "1")), "file.xml");
  EXPECT_EQ(xml.source.line({"a"}), kLines + 2);
}

TEST(XmlReader, RefusesWhatIsNotANumber) {
  for (const std::string value : {"abc", "1.0.0", "", "1,5", "0x10", "1 2", "1e", "--1", "+-1", "2 m"}) {
    expect_in(error_in("\n" + parameter("a", "double", value)),
              {"file.xml:3: ", "XML path \"a\"", "\"" + value + "\"", "not a number", "allowed"});
    expect_in(error_in(parameter("a", "int", value)), {"file.xml:2: ", "not a whole number"});
  }
  expect_in(error_in(parameter("a", "int", "1.0")), {"\"1.0\" is not a whole number"});
}

TEST(XmlReader, RefusesNumbersThatDoNotFit) {
  expect_in(error_in(parameter("a", "int", "2147483648")), {"does not fit an int", "2147483647"});
  expect_in(error_in(parameter("a", "double", "1e999")), {"does not fit a double"});
}

TEST(XmlReader, KeepsCommasInParenthesesInTheEntry) {
  const auto words_in = [](const std::string& value) {
    return parse_xml(in_list(parameter("words", "Array(string)", value)), "file.xml")
        .list->get<Teuchos::Array<std::string>>("words")
        .toVector();
  };
  EXPECT_EQ(words_in("{max(s, min(x, 1)), 0, (s,s)}"), (std::vector<std::string>{"max(s, min(x, 1))", "0", "(s,s)"}));
  EXPECT_EQ(words_in("{a), b, (c}"), (std::vector<std::string>{"a)", "b", "(c"}));
  EXPECT_EQ(words_in("{(a, b}"), (std::vector<std::string>{"(a", "b"}));
}

TEST(XmlReader, RefusesOtherBytesThanTheEncodingAllowsInSilence) {
  const std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-16\"?>\n" + in_list(parameter("a", "int", "1\xC3\x28"));
  testing::internal::CaptureStderr();
  const std::string utf16 = message_of([&] { parse_xml(text, "file.xml"); });
  const std::string utf7 = message_of([&] { parse_xml(changed(text, "UTF-16", "UTF-7"), "file.xml"); });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  expect_in(utf16, {"file.xml:"});
  expect_in(utf7, {"file.xml:"});
}

TEST(XmlReader, RefusesBadArraysAndSwitches) {
  expect_in(error_in(parameter("a", "Array(double)", "1, 2, 3")), {"not an array", "{1, 2, 3}"});
  expect_in(error_in(parameter("a", "Array(double)", "{1, abc}")), {"in an array", "\"abc\" is not a number"});
  expect_in(error_in(parameter("a", "Array(double)", "{1,, 2}")), {"empty entry"});
  expect_in(error_in(parameter("a", "Array(int)", "{{1}, {2}}")), {"not an array"});
  expect_in(error_in(parameter("a", "bool", "yes")), {"\"yes\"", "\"true\", \"false\""});
}

TEST(XmlReader, RefusesDuplicateNamesNamingBothLines) {
  const std::string twice = parameter("a", "int", "1") + "\n" + parameter("b", "int", "1") + "\n";
  expect_in(error_in(twice + parameter("a", "int", "2")), {"file.xml:4: ", "\"a\"", "given twice", "line 2", "line 4"});
  expect_in(error_in(twice + "<ParameterList name=\"b\"/>"), {"file.xml:4: ", "\"b\"", "line 3", "line 4"});
  const std::string list = "<ParameterList name=\"inner\">\n</ParameterList>\n";
  expect_in(error_in(list + list), {"\"inner\"", "line 2", "line 4"});
}

TEST(XmlReader, RefusesUnknownTypesTagsAndAttributes) {
  expect_in(error_in(parameter("a", "real", "1")), {"unknown type \"real\"", "\"double\"", "\"Array(string)\""});
  expect_in(error_in(parameter("a", "duoble", "1")), {"did you mean \"double\"?"});
  expect_in(error_in("<Paramter name=\"a\"/>"), {"file.xml:2: ", "<Paramter>", "did you mean \"Parameter\"?"});
  expect_in(error_in("<Parameter nmae=\"a\" type=\"int\" value=\"1\"/>"), {"\"nmae\"", "did you mean \"name\"?"});
  expect_in(error_in("<Parameter name=\"a\" type=\"int\"/>"), {"without the attribute \"value\""});
  expect_in(error_in("<ParameterList/>"), {"without the attribute \"name\""});
  expect_in(error_in("<Parameter name=\" \" type=\"int\" value=\"1\"/>"), {"empty name"});
}

TEST(XmlReader, RefusesEverythingThatIsNotAList) {
  expect_in(error_in("some text"), {"file.xml:", "some text"});
  expect_in(error_in("<![CDATA[1]]>"), {"outside of tags"});
  expect_in(error_in("<Parameter name=\"a\" type=\"int\" value=\"1\"><Parameter name=\"b\" type=\"int\" value=\"1\"/>"
                     "</Parameter>"),
            {"inside a <Parameter>"});
  expect_in(message_of([] { parse_xml("<Parameter name=\"a\" type=\"int\" value=\"1\"/>", "f"); }),
            {"outside of a list"});
  expect_in(message_of([] { parse_xml("<html/>", "f"); }), {"unknown tag <html>"});
  expect_in(message_of([] { parse_xml("  \n", "empty.xml"); }), {"empty.xml:1: ", "empty"});
}

TEST(XmlReader, ReportsSyntaxErrorsWithTheirLine) {
  expect_in(error_in("\n\n<Parameter name=\"a\" type=\"int\" value=\"1\">"), {"file.xml:", "not well-formed XML"});
  expect_in(error_in("<ParameterList name=\"a\"><Parameter name=b/></ParameterList>"), {"file.xml:2: "});
  expect_in(message_of([] { parse_xml("<ParameterList name=\"a\">", "f.xml"); }), {"f.xml:1: ", "not well-formed"});
  expect_in(message_of([] { parse_xml("not xml at all", "f.xml"); }), {"f.xml:1: "});
  expect_in(error_in("<Parameter name=\"\xff\" type=\"int\" value=\"1\"/>"), {"file.xml:2: "});
}

TEST(XmlReader, LoadsNothingElse) {
  const std::string bomb =
      "<!DOCTYPE l [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\"><!ENTITY f SYSTEM \"file:///etc/passwd\">]>\n" +
      in_list(parameter("a", "string", "&b;&f;"));
  expect_in(message_of([&] { parse_xml(bomb, "file.xml"); }), {"file.xml:1: ", "DOCTYPE"});
  expect_in(error_in(parameter("a", "string", "&undefined;")), {"file.xml:2: "});
}

TEST(XmlReader, LimitsTheDepthOfLists) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "<ParameterList name=\"a\">";
  expect_in(message_of([&] { parse_xml(text, "deep.xml"); }), {"deep.xml:1: ", "nested deeper"});
}

TEST(XmlReader, ReadsAFileAndNamesTheFilesItCannotRead) {
  const std::string file = testing::TempDir() + "mixbeam_xml_reader_test.xml";
  std::ofstream(file) << in_list(parameter("a", "int", "5"));
  EXPECT_EQ(read_parameters(file, {}).list->get<int>("a"), 5);
  std::ofstream(file) << "";
  expect_in(message_of([&] { read_parameters(file, {}); }), {file, "empty"});
  std::remove(file.c_str());
  expect_in(message_of([&] { read_parameters(file, {}); }), {file, "no such file"});
  expect_in(message_of([] { read_parameters(testing::TempDir(), {}); }), {"is a directory"});
  // Linux lets this file be opened, and its first bytes are no memory: as a disk that fails.
  expect_in(message_of([] { read_parameters("/proc/self/mem", {}); }), {"/proc/self/mem", "cannot be read"});
}

}  // namespace
}  // namespace mixbeam
