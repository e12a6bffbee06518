// Rules of the house that no compiler checks: equations cited in the sources stand in apps/docs/theory.md, and includes
// keep the order of folders and rooms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace mixbeam::house_test {
namespace {

/// A file: its path from the root of the repository, and what it holds.
struct Text {
  std::string path, text;
};
using Faults = std::vector<std::string>;

bool starts_with(const std::string& text, const std::string& start) {
  return text.compare(0, start.size(), start) == 0;
}
bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// The number in "(7)" at a place of a text.
std::optional<int> number_at(const std::string& text, size_t at) {
  size_t end = at + 1;
  while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end])) != 0) ++end;
  if (at >= text.size() || text[at] != '(' || end == at + 1 || end >= text.size() || text[end] != ')')
    return std::nullopt;
  return std::stoi(text.substr(at + 1, end - at - 1));
}

/// All "(7)" behind a word, or all of them where it is empty.
std::vector<int> numbers_behind(const std::string& word, const std::string& text) {
  std::vector<int> numbers;
  for (size_t at = text.find(word + "("); at != std::string::npos; at = text.find(word + "(", at + 1))
    if (const auto number = number_at(text, at + word.size())) numbers.push_back(*number);
  return numbers;
}

/// Comments of several lines as one line each: a citation may be broken anywhere.
std::string joined_lines(const std::string& source) {
  std::string joined, line;
  for (std::istringstream lines(source); std::getline(lines, line);) {
    const size_t first = line.find_first_not_of(" \t/");
    if (first != std::string::npos) joined += line.substr(first) + " ";
  }
  return joined;
}

/// Text of a page without its formulas.
std::string prose_of(const std::string& page) {
  std::string prose;
  bool in_formula = false;
  for (char c : page) {
    if (c == '$')
      in_formula = !in_formula;
    else if (!in_formula)
      prose += c;
  }
  return prose;
}

/// An equation of the page begins a line with its number, **(7)**. What is wrong with the numbers and their citations.
Faults citation_faults(const std::string& page, const std::vector<Text>& sources) {
  Faults faults;
  std::set<int> equations, cited;
  std::string line;
  for (std::istringstream lines(page); std::getline(lines, line);) {
    const auto number = starts_with(line, "**(") ? number_at(line, 2) : std::nullopt;
    if (!number) continue;
    if (*number != static_cast<int>(equations.size()) + 1)
      faults.push_back("equation (" + std::to_string(*number) + ") is out of order");
    equations.insert(*number);
  }
  for (int number : numbers_behind("", prose_of(page)))
    if (equations.count(number) == 0) faults.push_back("the page refers to (" + std::to_string(number) + ")");
  for (const Text& source : sources)
    for (int number : numbers_behind("heory ", joined_lines(source.text))) {  // at the start of a sentence too
      cited.insert(number);
      if (equations.count(number) == 0) faults.push_back(source.path + " cites (" + std::to_string(number) + ")");
    }
  for (int number : equations)
    if (cited.count(number) == 0) faults.push_back("nobody cites (" + std::to_string(number) + ")");
  return faults;
}

/// A top-level folder and its rooms. Includes point to the same room or to what stands before it.
struct Folder {
  std::string name;
  std::vector<std::string> rooms;
};
const std::vector<Folder>& folders() {
  static const std::vector<Folder> all = {
      {"kernels", {"execution", "math", "element", "condensation", "planar", "loops", "chains"}},
      {"discretization",
       {"text", "parameters", "geometry", "scene", "stresses", "mesh", "checks", "reading", "constraints",
        "linear_system", "assembly", "state", "quantities", "results"}},
      {"nonlinear",
       {"parameters", "linear", "multilevel", "newton", "stability", "diagnosis", "path", "accuracy", "run"}},
      {"apps/common", {"tables", "session", "run", "studies"}}};
  return all;
}
/// Plain structs that every room of its folder may include.
const char* const kPlainStructs = "discretization/scene/scene.hpp";
/// Headers that the build writes.
const char* const kGenerated = "mixbeam/";

/// Where a file stands: places in folders() and in its rooms; room -1: in the root of the folder, or in none of them.
struct Place {
  int folder = -1, room = -1;
};
Place place_of(const std::string& path) {
  for (size_t f = 0; f < folders().size(); ++f) {
    const std::string root = folders()[f].name + "/";
    if (!starts_with(path, root)) continue;
    const std::string room = path.substr(root.size(), path.find('/', root.size()) - root.size());
    const std::vector<std::string>& rooms = folders()[f].rooms;
    const auto found = std::find(rooms.begin(), rooms.end(), room);
    return {static_cast<int>(f), found == rooms.end() ? -1 : static_cast<int>(found - rooms.begin())};
  }
  return {};
}

std::vector<std::string> quoted_includes(const std::string& text) {
  const std::string start = "#include \"";
  std::vector<std::string> includes;
  std::string line;
  for (std::istringstream lines(text); std::getline(lines, line);)
    if (starts_with(line, start))
      includes.push_back(line.substr(start.size(), line.find('"', start.size()) - start.size()));
  return includes;
}

bool may_include(const Place& from, const std::string& include) {
  if (starts_with(include, kGenerated)) return true;
  const Place to = place_of(include);
  if (to.room < 0 || to.folder > from.folder) return false;
  return to.folder < from.folder || to.room <= from.room || include == kPlainStructs;
}

Faults room_faults(const std::vector<Text>& sources) {
  Faults faults;
  for (const Text& source : sources) {
    const Place here = place_of(source.path);
    if (here.folder < 0) continue;  // programs are free
    if (here.room < 0) faults.push_back(source.path + " is in no room");
    for (const std::string& include : quoted_includes(source.text))
      if (here.room >= 0 && !may_include(here, include)) faults.push_back(source.path + " includes " + include);
  }
  return faults;
}

/// Host code that computes the place of an element's numbers in an array by itself.
Faults offset_faults(const std::vector<Text>& sources) {
  const std::string kMaker = "discretization/mesh/structure.cpp";  // numbers the elements
  Faults faults;
  for (const Text& source : sources)
    for (const char* offset : {"interior_offset", "increment_offset"})
      if (!starts_with(source.path, "kernels/") && source.path != kMaker &&
          source.text.find(offset) != std::string::npos)
        faults.push_back(source.path + " uses " + offset);
  return faults;
}

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream content;
  content << file.rdbuf();
  return content.str();
}

/// Sources of some top-level folders of the repository, but for this file, which cites what does not exist.
std::vector<Text> sources_of(const std::vector<std::string>& top_level) {
  namespace fs = std::filesystem;
  const fs::path root = MIXBEAM_SOURCE_DIR;
  std::vector<Text> sources;
  for (const std::string& folder : top_level)
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string path = entry.path().lexically_relative(root).generic_string();
      const bool is_source = ends_with(path, ".hpp") || ends_with(path, ".cpp") || ends_with(path, ".cpp.in");
      if (entry.is_regular_file() && is_source && entry.path().filename() != "house_test.cpp")
        sources.push_back({path, content_of(entry.path())});
    }
  return sources;
}

const std::vector<std::string> kProduct = {"kernels", "discretization", "nonlinear", "apps"};

TEST(House, EquationsCitedStandOnThePage) {
  std::vector<std::string> all = kProduct;
  all.emplace_back("tests");
  const std::string page = content_of(std::string(MIXBEAM_SOURCE_DIR) + "/apps/docs/theory.md");
  ASSERT_NE(page.find("**(1)**"), std::string::npos);
  EXPECT_EQ(citation_faults(page, sources_of(all)), Faults{});
}

TEST(House, WrongCitationsAreFound) {
  const std::string page = "By (2), not $f(9)$:\n\n**(1)** $a = b$\n\n**(2)** $c = d$\n";
  const Text good{"good.hpp", "/// Theory (1) and theory\n  /// (2), but no theory of (3)\n"};
  EXPECT_EQ(citation_faults(page, {good}), Faults{});
  EXPECT_EQ(citation_faults(page, {good, {"bad.hpp", "// theory (3)\n"}}), Faults{"bad.hpp cites (3)"});
  EXPECT_EQ(citation_faults(page, {{"half.hpp", "// theory (1)\n"}}), Faults{"nobody cites (2)"});
  const std::string gap = "See (4).\n\n**(1)** $a = b$\n\n**(3)** $c = d$\n";
  EXPECT_EQ(citation_faults(gap, {{"all.hpp", "// theory (1), theory (3)\n"}}),
            (Faults{"equation (3) is out of order", "the page refers to (4)"}));
}

TEST(House, IncludesKeepTheOrderOfRooms) {
  const std::vector<Text> sources = sources_of(kProduct);
  for (const Folder& folder : folders())
    for (const std::string& room : folder.rooms)
      EXPECT_TRUE(std::any_of(sources.begin(), sources.end(),
                              [&](const Text& s) { return starts_with(s.path, folder.name + "/" + room + "/"); }))
          << folder.name << "/" << room << " is empty";
  EXPECT_EQ(room_faults(sources), Faults{});
}

TEST(House, WrongIncludesAreFound) {
  const auto fault_of = [](const std::string& path, const std::string& include) {
    return room_faults({{path, "#include <vector>\n#include \"" + include + "\"\n"}});
  };
  const auto is_fault = [&](const std::string& path, const std::string& include) {
    return fault_of(path, include) == Faults{path + " includes " + include};
  };
  EXPECT_EQ(fault_of("kernels/planar/a.hpp", "kernels/element/b.hpp"), Faults{});
  EXPECT_EQ(fault_of("nonlinear/linear/a.cpp", "discretization/results/b.hpp"), Faults{});
  EXPECT_EQ(fault_of("discretization/text/a.hpp", kPlainStructs), Faults{});
  EXPECT_EQ(fault_of("apps/common/run/a.cpp", "mixbeam/version.hpp"), Faults{});
  EXPECT_EQ(fault_of("apps/trade/a.cpp", "apps/fork/b.hpp"), Faults{});
  EXPECT_TRUE(is_fault("kernels/element/a.hpp", "kernels/planar/b.hpp"));
  EXPECT_TRUE(is_fault("discretization/text/a.hpp", "discretization/scene/names.hpp"));
  EXPECT_TRUE(is_fault("discretization/results/a.cpp", "nonlinear/parameters/b.hpp"));
  EXPECT_TRUE(is_fault("kernels/math/a.hpp", kPlainStructs));
  EXPECT_TRUE(is_fault("apps/common/run/a.cpp", "apps/trade/b.hpp"));
  EXPECT_TRUE(is_fault("kernels/math/a.hpp", "small_algebra.hpp"));
  EXPECT_EQ(fault_of("kernels/a.hpp", "kernels/math/b.hpp"), Faults{"kernels/a.hpp is in no room"});
  EXPECT_EQ(fault_of("nonlinear/attic/a.hpp", "kernels/math/b.hpp"), Faults{"nonlinear/attic/a.hpp is in no room"});
}

TEST(House, NumbersOfElementsAreReachedThroughTheElementView) {
  EXPECT_EQ(offset_faults(sources_of(kProduct)), Faults{});
  EXPECT_EQ(
      offset_faults({{"nonlinear/run/a.cpp", "x = block.interior_offset + e;"}, {"kernels/a.cpp", "interior_offset"}}),
      Faults{"nonlinear/run/a.cpp uses interior_offset"});
}

}  // namespace
}  // namespace mixbeam::house_test
