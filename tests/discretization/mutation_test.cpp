/// Hostile input: a scene that uses everything, damaged ten thousand times. Every damaged file is read or refused with
/// a place; nothing crashes, hangs or fills the memory. The same test runs under the sanitizers.
#include "discretization/checks/expected_values.hpp"
#include "discretization/checks/scene_warnings.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/scene/load_cases.hpp"
#include "input_text.hpp"
#include "tests/support/processor_time.hpp"

#include <algorithm>
#include <random>

namespace mixbeam {
namespace {

/// Uses everything that a scene file can say.
const std::string kRichScene = R"yaml(Name: everything
Scene:
  Units: "m, N"
  Load Cases: [wind, snow]
  Sections:
    steel: {EA: 10000, Shear Rigid: true, GIt: 2, EI2: 2, EI3: 2.5}
    tube:
      Shape: tube
      Diameter: 0.1
      Wall: 0.01
      Largest Strain: 0.1
      Material: {E: 1e6, nu: 0.3, Strength: 20000}
    thin tube: {Shape: tube, Diameter: 0.05, Wall: 0.01, Material: {E: 1e6, nu: 0.3}}
    coupled: {Matrix: [100, 0, 0, 1, 0, 0, 50, 0, 0, 0, 0, 50, 0, 0, 0, 3, 0.1, 0, 2, 0, 2]}
  Points:
    foot: [0, 0, 0]
    top: [10, 0, 0]
    left: [0, 8, 0]
    anchor: [10, 0, -6]
  Members:
    shaft:
      Start: foot
      End: top
      Section: tube
      End Section: thin tube
      Taper: x^2
      Order: 3
      Elements: 4
      Twist: 0.5
      Second Axis: [0, 1, 0]
      Inner Points: {middle: 0.5}
    arch:
      Start: top
      End: tip
      Section: steel
      Elements: 3
      Stations: [0, 0.2, 0.6, 1]
      Curve: {Shape: arc, Center: [10, 5, 0], Axis: [0, 0, 2], Angle: 1.5707963267948966}
    coil:
      Start: tip
      End: coil end
      Section: coupled
      Force Integration: full
      Curve: {Shape: helix, Center: [10, 5, 0], Axis: [0, 0, 1], Angle: 9, Rise: 2}
    strut 1:
      Start: middle
      End: left
      Section: steel
      Curve: {Shape: spline, Through: [4, 3, 1, 2, 6, 1], Start Tangent: [0, 1, 0]}
    strut 2:
      Start: foot
      End: left
      Section: steel
      Curve: {Shape: parametric, Formula: [sin(pi*t), "8*t", "max(0, t*(1 - t))"], Range: [0, 1]}
    cable: {Start: top, End: anchor, Section: steel, Curve: {Shape: polyline, Through: [10, 0.5, -2, 10, 0.5, -4]}}
    bow: {Start: left, End: coil end, Section: steel, Elements: 2}
  Patterns:
    storeys: {Members: [bow], Kind: repeat, Vector: [0, 0, 3], Count: 3}
    star: {Members: [bow], Kind: rotate, Center: [0, 8, 0], Axis: [0, 0, 1], Angle: 0.5, Count: 2}
    image: {Members: [bow], Kind: mirror, Point: [0, 9, 0], Normal: [0, 1, 0]}
  Supports:
    copies: {Point: left (*}
    clamp: {Point: foot}
    bearing:
      Point: anch*
      Axes: [1, 1, 0, 0, 0, 2]
      Fixed Displacement: [x, z]
      Fixed Rotation: [y]
      Prescribed Displacement: [0, 0, 0.5]
      Displacement Stiffness: [0, 3, 0]
      Rotation Stiffness: [1, 0, 2]
      Amplitude: sin(pi/2*t)
      Case: snow
    turned: {Point: coil end, Prescribed Rotation: [0, 0, 0.1], Stage: 2}
  Joints:
    pin: {Point: left, Members: [strut *], Kind: hinge, Axis: [0, 0, 1], Stiffness: 0.1}
    socket: {Point: tip, Members: [coil], Kind: ball}
  Point Loads:
    pull: {Point: tip, Force: [0, 1, 0], Moment: [0, 0.1, 0], Amplitude: "t > 1 ? 1 : t"}
    thrust: {Point: middle, Force: [0, 1, 0], Frame: follower, Member: strut*, Case: wind}
  Distributed Loads:
    weight: {Member: "*", Force: [0, 0, -1], Stage: 1}
    pressure:
      Member: shaft
      Force Formula: ["0", "max(s, 1)", "-2*(1 - x)"]
      Couple: [0.1, 0, 0]
      Frame: follower
      Case: wind
      Stage: 2
  Eigenstrains:
    heat:
      Member: shaft
      Temperature: 100
      Expansion Coefficient: 1.2e-05
      Curvature Formula: ["0", "0", exp(-s)]
      Start Turn: [0, 0, 0.01]
      Stage: 2
Expected:
  force at the foot:
    Quantity: reaction force
    Point: foot
    Component: norm
    Case: snow
    Value: 2.5
    Relative Tolerance: 1e-6
    Source: "none, a scene for tests of input"
  moment of the shaft:
    Quantity: material moment
    Member: shaft
    Position: 0.5
    Component: "3"
    Load Factor: 1
    Case: wind
    Value: 0.1
    Absolute Tolerance: 1
    Source: none
)yaml";

/// The same in XML, with a declared encoding.
std::string rich_xml() { return changed(xml_text(*parsed(kRichScene).list), "?>", " encoding=\"UTF-8\"?>"); }

/// What stands between bars.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> pieces(1);
  for (const char c : text)
    if (c == '|')
      pieces.emplace_back();
    else
      pieces.back() += c;
  return pieces;
}

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
    static const std::vector<std::string> words = split(
        "0|-1|1|2|0.5|1e308|-1e308|1e-308|1e100|1e-100|nan|inf|-inf|2147483647|-2147483648|99999999999|"
        "10000000|1000|abc|| |{}|{0}|{1, 0, 0}|{0, 0, 0}|{1e99, 1e99, 1e99}|{1e100, -1e100, 0}|{1e-99, 0, 0}|"
        "{nan, 0, 0}|{1,,2}|{{1, 2}, {3}}|{0, 0, 0, 0, 0, 0}|{x}|{x, y, z}|{x, x}|{*}|*|**|s*|foot|top|tip|"
        "middle|left|shaft|arch|coil|strut 1|steel|coupled|true|false|arc|line|helix|spline|parametric|"
        "polyline|hinge|slider|ball|follower|wind|snow|{t, t^2, 0}|{1/t, 0, 0}|{s, x, 1/s}|1/t|t|x|t = 5|"
        "sin(|((((((((((((((((((((1))))))))))))))))))))|t,t|e^e^e^e^e|sqrt(-1)|&amp;|&lt;|&#0;|int|double|"
        "string|bool|Array(double)|Array(string)|Array(int)|Array(Array(int))|Order|Elements|Curve|Member|"
        "Point|Stage");
    const auto [begin, length] = word_of(text);
    if (begin == 0) return text;
    return text.replace(begin, length, words[below(words.size())]);
  }

  std::mt19937 random_;
};

/// Everything that happens to a scene file before it is solved.
void read_everything(const std::string& text, const std::string& file = "scene.xml") {
  XmlParameters xml = parse_parameters(text, file, scene_file_spec());
  if (!xml.list->isSublist("Scene")) throw InputError("scene.xml: no list Scene");  // applications say it by themselves
  const Scene scene = read_scene(xml.list->sublist("Scene"), xml.source);
  if (xml.list->isSublist("Expected"))
    check_expected_values(read_expected_values(xml.list->sublist("Expected"), xml.source), scene, xml.source);
  for (const std::string& name : scene.load_cases) scene_of_case(scene, name);
  warnings(scene);
}

/// Whether a refusal names a line or, for what is missing, a list. Several mistakes stand below their number.
bool names_a_place(const std::string& message) {
  const std::size_t heading = message.find(" mistakes:\n");
  const std::size_t first = heading < message.find('\n') ? message.find('\n') + 1 : 0;
  return message.compare(first, 6, "scene.") == 0;
}

TEST(Mutations, TheSceneItselfIsRead) {
  EXPECT_NO_THROW(read_everything(rich_xml()));
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
  constexpr int kMutations = 3000;
  constexpr double kMostSeconds = 5.0;  // for one scene, of which milliseconds are needed: more is a hang
  Mutator mutator(seed);
  int read = 0;
  double slowest = 0.0;
  for (int i = 0; i < kMutations; ++i) {
    std::string text = whole;
    for (std::size_t changes = 1 + (i % 4 == 0 ? mutator.below(4) : 0); changes > 0; --changes)
      if (!text.empty()) text = mutator.mutated(text);
    const double seconds = processor_seconds([&] {
      try {
        read_everything(text, file);
        ++read;
      } catch (const InputError& error) {
        EXPECT_TRUE(names_a_place(error.what())) << "seed " << seed << ", mutation " << i << ": " << error.what();
      } catch (const std::exception& error) {
        FAIL() << "seed " << seed << ", mutation " << i << ", not an InputError: " << error.what() << "\n" << text;
      }
    });
    if (testing::Test::HasFatalFailure()) return;
    slowest = std::max(slowest, seconds);
    ASSERT_LT(slowest, kMostSeconds) << "seed " << seed << ", mutation " << i << ":\n" << text;
  }
  EXPECT_GT(read, kMutations / 50);  // mutations must not all be trivial syntax errors ...
  EXPECT_LT(read, kMutations / 2);   // ... nor harmless
  testing::Test::RecordProperty("read", read);
  testing::Test::RecordProperty("slowest_in_milliseconds", static_cast<int>(1e3 * slowest));
}

TEST(Mutations, AreReadOrRefusedWithAPlace) { expect_read_or_refused(rich_xml(), "scene.xml"); }

TEST(Mutations, InYamlAreReadOrRefusedWithAPlace) {
  EXPECT_NO_THROW(read_everything(kRichScene, "scene.yaml"));
  expect_read_or_refused(kRichScene, "scene.yaml");
}

/// Parts of the file, each alone enough to fill the memory if it were believed.
TEST(Mutations, RequestsForMemoryAreRefused) {
  const auto refusal = [](const std::string& from, const std::string& to) {
    std::string message;
    EXPECT_LT(processor_seconds([&] { message = message_of([&] { read_everything(changed(rich_xml(), from, to)); }); }),
              5.0);
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
