/// Hostile input: a scene that uses everything, damaged ten thousand times. Every damaged file is read or refused with
/// a place; nothing crashes, hangs or fills the memory. The same test runs under the sanitizers.
#include "discretization/checks/expected_values.hpp"
#include "discretization/checks/scene_warnings.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/scene/load_cases.hpp"
#include "input_text.hpp"
#include "rich_scene.hpp"

#include <algorithm>
#include <chrono>
#include <random>

namespace mixbeam {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One random change of a text.
class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::size_t below(std::size_t bound) { return random_() % bound; }

  std::string mutated(const std::string& text) {
    switch (below(10)) {
      case 0:
        return with_piece_lost(text);
      case 1:
        return with_piece_copied(text);
      case 2:
        return with_other_byte(text);
      case 3:
        return with_line_lost_or_doubled(text);
      case 4:
        return with_lines_swapped(text);
      case 5:
        return with_words_swapped(text);
      case 6:
        return with_deeper_list(text);
      case 7:
        return with_other_encoding(text);
      default:
        return with_other_word(text);
    }
  }

 private:
  static constexpr std::size_t kLongestPiece = 40;

  std::string with_piece_lost(std::string text) {
    const std::size_t place = below(text.size());
    return text.erase(place, below(kLongestPiece) + 1);
  }

  std::string with_piece_copied(std::string text) {
    const std::string piece = text.substr(below(text.size()), below(kLongestPiece) + 1);
    return text.insert(below(text.size()), piece);
  }

  std::string with_other_byte(std::string text) {
    text[below(text.size())] = static_cast<char>(below(256));
    return text;
  }

  /// Begin and end of a random line, its line break included.
  std::pair<std::size_t, std::size_t> line_of(const std::string& text) {
    const std::size_t place = below(text.size());
    const std::size_t before = place == 0 ? std::string::npos : text.rfind('\n', place - 1);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    const std::size_t end = text.find('\n', begin);
    return {begin, end == std::string::npos ? text.size() : end + 1};
  }

  std::string with_line_lost_or_doubled(std::string text) {
    const auto [begin, end] = line_of(text);
    const std::string line = text.substr(begin, end - begin);
    return below(2) == 0 ? text.erase(begin, line.size()) : text.insert(begin, line);
  }

  std::string with_lines_swapped(std::string text) {
    const auto [begin, end] = line_of(text);
    const std::string line = text.substr(begin, end - begin);
    text.erase(begin, line.size());
    return text.empty() ? line : text.insert(line_of(text).first, line);
  }

  /// Begin and length of what stands between the quotes of a random attribute.
  std::pair<std::size_t, std::size_t> word_of(const std::string& text) {
    const std::size_t opening = text.find("=\"", below(text.size()));
    const std::size_t closing = opening == std::string::npos ? opening : text.find('"', opening + 2);
    if (closing == std::string::npos) return {0, 0};
    return {opening + 2, closing - opening - 2};
  }

  std::string with_words_swapped(std::string text) {
    const auto [begin, length] = word_of(text);
    const std::string first = text.substr(begin, length);
    const auto [other_begin, other_length] = word_of(text);
    const std::string second = text.substr(other_begin, other_length);
    if (other_begin <= begin) return text.replace(begin, length, second);
    text.replace(other_begin, other_length, first);
    return text.replace(begin, length, second);
  }

  std::string with_deeper_list(std::string text) {
    static const std::vector<std::string> lists = {"Scene", "Members", "Curve", "shaft", "Supports", "x"};
    const std::size_t depth = below(8) == 0 ? 100 : below(3) + 1;
    std::string nested;
    for (std::size_t i = 0; i < depth; ++i) nested += "<ParameterList name=\"" + lists[below(lists.size())] + "\">\n";
    if (below(4) > 0)
      for (std::size_t i = 0; i < depth; ++i) nested += "</ParameterList>\n";
    return text.insert(line_of(text).first, nested);
  }

  std::string with_other_encoding(std::string text) {
    static const std::vector<std::string> encodings = {"UTF-16", "ISO-8859-1", "US-ASCII", "UTF-7", "EBCDIC", "", "x"};
    static const std::vector<std::string> bytes = {"\xEF\xBB\xBF",
                                                   "\xFF\xFE",
                                                   "\xC3\xA9",
                                                   "\xC3\x28",
                                                   "\xF0\x9F\x98\x80",
                                                   "\xED\xA0\x80",
                                                   "\xC0\x80",
                                                   std::string(1, '\0'),
                                                   "\r\n",
                                                   "\x1B",
                                                   "&#x1F600;",
                                                   "&undeclared;",
                                                   "<![CDATA[",
                                                   "<!--",
                                                   "<?php ?>",
                                                   "<!DOCTYPE a [<!ENTITY b \"c\">]>"};
    const std::size_t declared = text.find("UTF-8");
    if (below(3) == 0 && declared != std::string::npos)
      return text.replace(declared, 5, encodings[below(encodings.size())]);
    const std::size_t place = below(4) == 0 ? 0 : below(text.size());
    return text.insert(place, bytes[below(bytes.size())]);
  }

  std::string with_other_word(std::string text) {
    static const std::vector<std::string> words = {"0",
                                                   "-1",
                                                   "1",
                                                   "2",
                                                   "0.5",
                                                   "1e308",
                                                   "-1e308",
                                                   "1e-308",
                                                   "1e100",
                                                   "1e-100",
                                                   "nan",
                                                   "inf",
                                                   "-inf",
                                                   "2147483647",
                                                   "-2147483648",
                                                   "99999999999",
                                                   "10000000",
                                                   "1000",
                                                   "abc",
                                                   "",
                                                   " ",
                                                   "{}",
                                                   "{0}",
                                                   "{1, 0, 0}",
                                                   "{0, 0, 0}",
                                                   "{1e99, 1e99, 1e99}",
                                                   "{1e100, -1e100, 0}",
                                                   "{1e-99, 0, 0}",
                                                   "{nan, 0, 0}",
                                                   "{1,,2}",
                                                   "{{1, 2}, {3}}",
                                                   "{0, 0, 0, 0, 0, 0}",
                                                   "{x}",
                                                   "{x, y, z}",
                                                   "{x, x}",
                                                   "{*}",
                                                   "*",
                                                   "**",
                                                   "s*",
                                                   "foot",
                                                   "top",
                                                   "tip",
                                                   "middle",
                                                   "left",
                                                   "shaft",
                                                   "arch",
                                                   "coil",
                                                   "strut 1",
                                                   "steel",
                                                   "coupled",
                                                   "true",
                                                   "false",
                                                   "arc",
                                                   "line",
                                                   "helix",
                                                   "spline",
                                                   "parametric",
                                                   "polyline",
                                                   "hinge",
                                                   "slider",
                                                   "ball",
                                                   "follower",
                                                   "wind",
                                                   "snow",
                                                   "{t, t^2, 0}",
                                                   "{1/t, 0, 0}",
                                                   "{s, x, 1/s}",
                                                   "1/t",
                                                   "t",
                                                   "x",
                                                   "t = 5",
                                                   "sin(",
                                                   "((((((((((((((((((((1))))))))))))))))))))",
                                                   "t,t",
                                                   "e^e^e^e^e",
                                                   "sqrt(-1)",
                                                   "&amp;",
                                                   "&lt;",
                                                   "&#0;",
                                                   "int",
                                                   "double",
                                                   "string",
                                                   "bool",
                                                   "Array(double)",
                                                   "Array(string)",
                                                   "Array(int)",
                                                   "Array(Array(int))",
                                                   "Order",
                                                   "Elements",
                                                   "Curve",
                                                   "Member",
                                                   "Point",
                                                   "Stage"};
    const auto [begin, length] = word_of(text);
    if (begin == 0) return text;
    return text.replace(begin, length, words[below(words.size())]);
  }

  std::mt19937 random_;
};

ListSpec root_of_scenes() {
  ListSpec root("file");
  root.add_list("Scene", scene_spec(), Presence::required);
  root.add_list("Expected", expected_values_spec(), Presence::defaulted);
  return root;
}

/// Everything that happens to a scene file before it is solved.
void read_everything(const std::string& text, const std::string& file = "scene.xml") {
  XmlParameters xml = parse_parameters(text, file, root_of_scenes());
  if (!xml.list->isSublist("Scene")) throw InputError("scene.xml: no list Scene");  // applications say it by themselves
  const Scene scene = read_scene(xml.list->sublist("Scene"), xml.source);
  if (xml.list->isSublist("Expected"))
    check_expected_values(read_expected_values(xml.list->sublist("Expected"), xml.source), scene, xml.source);
  for (const std::string& name : scene.load_cases) scene_of_case(scene, name);
  warnings(scene);
}

/// Whether a refusal names a line or, for what is missing, a list.
bool names_a_place(const std::string& message) { return message.rfind("scene.", 0) == 0; }

TEST(Mutations, TheSceneItselfIsRead) {
  EXPECT_NO_THROW(read_everything(kRichScene));
  const Scene scene = scene_from(kRichScene);
  EXPECT_EQ(scene.joints.size(), 2U);
  EXPECT_GE(scene.supports.size(), 4U);
  EXPECT_GT(scene.members.size(), 9U);  // patterns and the polyline make more than are written
  EXPECT_EQ(scene.eigenstrains.size(), 1U);
  EXPECT_EQ(scene.load_cases.size(), 2U);
  EXPECT_EQ(scene.stages, 2);
}

void expect_read_or_refused(const std::string& whole, const std::string& file) {
  const unsigned seed =
      20261121U + static_cast<unsigned>(GTEST_FLAG_GET(random_seed));  // others: --gtest_random_seed=1
  constexpr int kMutations = 10000;
  constexpr double kMostSeconds = 5.0;  // for one scene, of which milliseconds are needed: more is a hang
  Mutator mutator(seed);
  int read = 0;
  double slowest = 0.0;
  for (int i = 0; i < kMutations; ++i) {
    std::string text = whole;
    for (std::size_t changes = 1 + (i % 4 == 0 ? mutator.below(4) : 0); changes > 0; --changes)
      if (!text.empty()) text = mutator.mutated(text);
    const auto start = Clock::now();
    try {
      read_everything(text, file);
      ++read;
    } catch (const InputError& error) {
      EXPECT_TRUE(names_a_place(error.what())) << "seed " << seed << ", mutation " << i << ": " << error.what();
    } catch (const std::exception& error) {
      FAIL() << "seed " << seed << ", mutation " << i << ", not an InputError: " << error.what() << "\n" << text;
    }
    slowest = std::max(slowest, seconds_since(start));
    ASSERT_LT(slowest, kMostSeconds) << "seed " << seed << ", mutation " << i << ":\n" << text;
  }
  EXPECT_GT(read, kMutations / 50);  // mutations must not all be trivial syntax errors ...
  EXPECT_LT(read, kMutations / 2);   // ... nor harmless
  testing::Test::RecordProperty("read", read);
  testing::Test::RecordProperty("slowest_in_milliseconds", static_cast<int>(1e3 * slowest));
}

TEST(Mutations, AreReadOrRefusedWithAPlace) { expect_read_or_refused(kRichScene, "scene.xml"); }

TEST(Mutations, InYamlAreReadOrRefusedWithAPlace) {
  const std::string yaml = yaml_text(parse_xml(kRichScene, "scene.xml"), root_of_scenes(), "scene.yaml");
  EXPECT_NO_THROW(read_everything(yaml, "scene.yaml"));
  expect_read_or_refused(yaml, "scene.yaml");
}

/// Parts of the file, each alone enough to fill the memory if it were believed.
TEST(Mutations, RequestsForMemoryAreRefused) {
  const auto refusal = [](const std::string& from, const std::string& to) {
    const auto start = Clock::now();
    const std::string message = message_of([&] { read_everything(changed(kRichScene, from, to)); });
    EXPECT_LT(seconds_since(start), 5.0);
    EXPECT_TRUE(names_a_place(message)) << message;
    return message;
  };
  expect_in(
      refusal("name=\"Elements\" type=\"int\" value=\"4\"", "name=\"Elements\" type=\"int\" value=\"1000000000\""),
      {"Members / shaft / Elements", "1000000000"});
  expect_in(refusal("name=\"Stage\" type=\"int\" value=\"2\"", "name=\"Stage\" type=\"int\" value=\"1000000000\""),
            {"Stage", "<= 1000"});
  const std::string count = "name=\"Count\" type=\"int\" value=\"";
  refusal(count + "3", count + "1000000000");
  refusal(count + "2", count + "1000000000");
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<ParameterList name=\"x\">";
  expect_in(refusal("<ParameterList name=\"Joints\">", deep), {"nested deeper"});
  const std::string open(9000, '(');
  refusal("value=\"x^2\"", "value=\"" + open + "\"");
  refusal("value=\"x^2\"", "value=\"" + open + "x" + std::string(9000, ')') + "\"");
  refusal("value=\"x^2\"", "value=\"" + std::string(1000000, 'x') + "\"");
  refusal("name=\"Joints\"", "name=\"" + std::string(1000000, 'J') + "\"");
}

}  // namespace
}  // namespace mixbeam
