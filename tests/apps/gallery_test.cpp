/// Every scene of the gallery runs with the program and reproduces its expected values; every whole scene in the pages
/// is accepted, every link leads somewhere, and what the README quotes is what stands on the pages.
#include "process.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

namespace mixbeam {
namespace {

constexpr std::uintmax_t kLargestPicture = 150000;  // bytes, so that the pages stay light

std::vector<fs::path> files_in(const fs::path& folder, const std::string& extension) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == extension) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

fs::path root() { return fs::path(MIXBEAM_SOURCE_DIR); }
fs::path apps() { return root() / "apps"; }

/// Every page of the repository.
std::vector<fs::path> pages() {
  std::vector<fs::path> files = files_in(apps() / "docs", ".md");
  files.push_back(root() / "README.md");
  files.push_back(apps() / "plots" / "README.md");
  return files;
}

class Gallery : public ::testing::TestWithParam<fs::path> {};

TEST_P(Gallery, RunsAndReproducesItsValues) {
  const TemporaryFolder folder;
  const fs::path scene = GetParam();
  const Ended ended =
      run_process(program("mixbeam"),
                  {"run", scene.string(), "--quiet", "--threads", "1", "--output", folder.path().string()}, folder);
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  EXPECT_FALSE(files_in(folder.path(), ".h5").empty());  // one for each load case, where there are some
  if (text_of(scene).find("\"Expected\"") != std::string::npos) expect_in(ended.out, {"checks passed"});
}

TEST_P(Gallery, IsOnThePageWithASmallPicture) {
  const std::string name = GetParam().stem().string();
  expect_in(text_of(apps() / "docs" / "gallery.md"), {"gallery/" + name + ".xml", "gallery/" + name + ".png"});
  const fs::path picture = apps() / "docs" / "gallery" / (name + ".png");
  ASSERT_TRUE(fs::exists(picture));
  EXPECT_LE(fs::file_size(picture), kLargestPicture);
}

std::string test_name(const ::testing::TestParamInfo<fs::path>& info) {
  std::string name = info.param.stem().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Gallery, ::testing::ValuesIn(files_in(apps() / "gallery", ".xml")), test_name);

/// Blocks ```xml or ```yaml of a page that are whole scenes.
std::vector<std::string> whole_scenes(const std::string& page, const std::string& format = "xml") {
  std::vector<std::string> scenes;
  const std::string begin = "```" + format + "\n", end = "```";
  const std::string scene = format == "xml" ? "<ParameterList name=\"Scene\">" : "\nScene:\n";
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    const std::string block = page.substr(at, page.find(end, at) - at);
    if (block.find(scene) != std::string::npos) scenes.push_back(block);
    at += block.size();
  }
  return scenes;
}

TEST(Documentation, ItsScenesAreAccepted) {
  const TemporaryFolder folder;
  std::size_t checked = 0;
  for (const fs::path& page : pages()) {
    for (const std::string& scene : whole_scenes(text_of(page))) {
      const fs::path file = folder / "scene.xml";
      write_text(file, scene);
      const Ended ended = run_process(program("mixbeam"),
                                      {"run", file.string(), "--quiet", "--output", folder.path().string()}, folder);
      EXPECT_EQ(ended.exit_code, 0) << page << "\n" << ended.out << ended.err << scene;
      EXPECT_NE(ended.out.find("stable: true"), std::string::npos) << page << "\n" << ended.out << scene;
      ++checked;
    }
  }
  EXPECT_GE(checked, 4U);  // of scenes.md
}

/// In at most 20 lines, and the same structure as the first one in XML.
TEST(Documentation, ItsSceneInYamlIsTheFirstOneInXml) {
  constexpr int kMostLines = 20;
  const std::string page = text_of(apps() / "docs" / "scenes.md");
  const std::vector<std::string> xml = whole_scenes(page), yaml = whole_scenes(page, "yaml");
  ASSERT_EQ(yaml.size(), 1U);
  EXPECT_LE(std::count(yaml[0].begin(), yaml[0].end(), '\n'), kMostLines);
  const TemporaryFolder folder;
  const auto tip_of = [&](const std::string& file, const std::string& text) {
    write_text(folder / file, text);
    const Ended ended = run_process(program("mixbeam"), {"run", (folder / file).string(), "--quiet"}, folder);
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    const std::size_t tip = ended.out.find("  tip ");
    return tip == std::string::npos ? "" : ended.out.substr(tip, ended.out.find('\n', tip) - tip);
  };
  const std::string expected = tip_of("first.xml", xml.at(0));
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(tip_of("first.yaml", yaml[0]), expected);
  EXPECT_NE(tip_of("other.yaml", changed(yaml[0], "-10", "-11")), expected);
}

/// What keeps the test above from passing whatever the program says.
TEST(Documentation, AWrongSceneWouldBeNoticed) {
  const TemporaryFolder folder;
  const std::vector<std::string> scenes = whole_scenes(text_of(apps() / "docs" / "scenes.md"));
  ASSERT_FALSE(scenes.empty());
  write_text(folder / "scene.xml", changed(scenes.front(), "\"Diameter\"", "\"Diametre\""));
  EXPECT_EQ(run_process(program("mixbeam"), {"check", (folder / "scene.xml").string()}, folder).exit_code, 2);
}

/// What links call a heading: small letters, hyphens for blanks, no other marks.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const unsigned char c : heading)
    if (c == ' ')
      anchor += '-';
    else if (std::isalnum(c) != 0 || c == '-' || c == '_')
      anchor += static_cast<char>(std::tolower(c));
  return anchor;
}

bool has_anchor(const fs::path& page, const std::string& anchor) {
  std::istringstream lines(text_of(page));
  bool in_code = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("```", 0) == 0) in_code = !in_code;
    const std::size_t marks = line.find_first_not_of('#');
    if (in_code || marks == 0 || marks == std::string::npos || line[marks] != ' ') continue;
    if (anchor_of(line.substr(marks + 1)) == anchor) return true;
  }
  return false;
}

/// Links of a page to files or headings that are not there.
std::set<std::string> dead_links(const fs::path& page, const std::string& text) {
  static const std::regex link(R"(\]\(([^)\s#]*)#?([^)\s]*)\))");
  std::set<std::string> dead;
  for (std::sregex_iterator it(text.begin(), text.end(), link), end; it != end; ++it) {
    const std::string file = (*it)[1], anchor = (*it)[2];
    if (file.find("://") != std::string::npos) continue;
    const fs::path target = file.empty() ? page : page.parent_path() / file;
    if (!fs::exists(target) || (!anchor.empty() && !has_anchor(target, anchor))) dead.insert(file + "#" + anchor);
  }
  return dead;
}

TEST(Documentation, EveryLinkLeadsSomewhere) {
  for (const fs::path& page : pages()) EXPECT_EQ(dead_links(page, text_of(page)), std::set<std::string>()) << page;
}

TEST(Documentation, ADeadLinkWouldBeNoticed) {
  const fs::path page = apps() / "docs" / "results.md";
  const std::string text =
      "[a](nowhere.md) ![b](gallery/nothing.png) [c](scenes.md#no-such-heading) [d](#state) [e](#estate)"
      "[f](scenes.md#members-and-their-curves) [g](https://trilinos.github.io) [h](../../README.md)";
  EXPECT_EQ(dead_links(page, text),
            std::set<std::string>({"nowhere.md#", "gallery/nothing.png#", "scenes.md#no-such-heading", "#estate"}));
}

/// Rows of the README's table of verification: benchmark, quantity in words of its own, then "| values | worst |
/// allowed |".
struct QuotedRow {
  std::string benchmark, figures;
};
std::vector<QuotedRow> quoted_rows(const std::string& readme) {
  static const std::regex row(R"(\n(\| [\w/]+ \|)[^|\n]*(\| \d+ \| [^|\n]* \| [^|\n]* \|)[^|\n]*\|(?=\n))");
  std::vector<QuotedRow> rows;
  for (std::sregex_iterator it(readme.begin(), readme.end(), row), end; it != end; ++it)
    rows.push_back({(*it)[1], (*it)[2]});
  return rows;
}

bool is_on_page(const QuotedRow& row, const std::string& page) {
  std::istringstream lines(page);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind(row.benchmark, 0) == 0 && line.find(row.figures) != std::string::npos) return true;
  return false;
}

TEST(Documentation, TheReadmeQuotesThePageOfVerification) {
  const std::string readme = text_of(root() / "README.md"), page = text_of(apps() / "docs" / "verification.md");
  const std::vector<QuotedRow> rows = quoted_rows(readme);
  EXPECT_EQ(rows.size(), 10U);
  for (const QuotedRow& row : rows)
    EXPECT_TRUE(is_on_page(row, page)) << "not, or no longer, in verification.md: " << row.benchmark << row.figures;
}

TEST(Documentation, AWrongQuotationWouldBeNoticed) {
  const std::vector<QuotedRow> rows = quoted_rows("text\n| helix | angle | 4 | 1e-13 | at most 1e-11 | formula |\n\n");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_TRUE(is_on_page(rows[0], "\n| helix | tip, angle | 4 | 1e-13 | at most 1e-11 | yes | a formula |\n"));
  EXPECT_FALSE(is_on_page(rows[0], "\n| helix | tip, angle | 4 | 2e-13 | at most 1e-11 | yes | a formula |\n"));
  EXPECT_FALSE(is_on_page(rows[0], "\n| rollup | tip, angle | 4 | 1e-13 | at most 1e-11 | yes | a formula |\n"));
}

TEST(Documentation, TheReadmeIsShort) {
  constexpr int kMostLines = 150;
  const std::string readme = text_of(root() / "README.md");
  EXPECT_LE(std::count(readme.begin(), readme.end(), '\n'), kMostLines);
}

TEST(Documentation, TheCitationNamesThisVersion) {
  std::smatch version;
  const std::string build = text_of(root() / "CMakeLists.txt");
  ASSERT_TRUE(std::regex_search(build, version, std::regex(R"(project\(mixbeam VERSION ([0-9.]+))")));
  expect_in(text_of(root() / "CITATION.cff"), {"\nversion: " + version[1].str() + "\n"});
}

/// Words of `name=(...)` in a shell script.
std::vector<std::string> words_of(const std::string& script, const std::string& name) {
  const auto begin = script.find(name + "=(");
  if (begin == std::string::npos) return {};
  const auto first = begin + name.size() + 2;
  std::istringstream words(script.substr(first, script.find(')', first) - first));
  return {std::istream_iterator<std::string>(words), {}};
}

TEST(RunScript, DrawsWhatEveryBenchmarkHas) {
  const std::string script = text_of(root() / "run.sh");
  const std::string plots = text_of(apps() / "plots" / "plot_all.py");
  std::vector<std::string> benchmarks = words_of(script, "default_benchmarks");
  const std::vector<std::string> named = words_of(script, "when_named");
  EXPECT_FALSE(benchmarks.empty());
  EXPECT_FALSE(named.empty());
  benchmarks.insert(benchmarks.end(), named.begin(), named.end());
  for (const std::string& name : benchmarks) {
    const bool is_known = plots.find('"' + name + '"') != std::string::npos;
    EXPECT_TRUE(is_known) << name;
  }
  EXPECT_EQ(plots.find("\"mixbeam\""), std::string::npos) << "a name that is found whatever is looked for";
}

}  // namespace
}  // namespace mixbeam
