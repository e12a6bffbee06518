/// Every scene of the gallery runs with the program and reproduces its expected values; every whole scene in the pages
/// for users is accepted.
#include "process.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <regex>
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

/// Pages for users, README included.
std::vector<fs::path> pages() {
  std::vector<fs::path> files = files_in(fs::path(MIXBEAM_SOURCE_DIR) / "apps" / "docs", ".md");
  files.push_back(fs::path(MIXBEAM_SOURCE_DIR) / "README.md");
  return files;
}

fs::path apps() { return fs::path(MIXBEAM_SOURCE_DIR) / "apps"; }

class Gallery : public ::testing::TestWithParam<fs::path> {};

TEST_P(Gallery, RunsAndReproducesItsValues) {
  const TemporaryFolder folder;
  const fs::path scene = GetParam();
  const Ended ended =
      run_process(program("mixbeam"),
                  {"run", scene.string(), "--quiet", "--threads", "1", "--output", folder.path().string()}, folder);
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  EXPECT_TRUE(fs::exists(folder / (scene.stem().string() + ".h5")));
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

/// Blocks ```xml of a page that are whole scenes.
std::vector<std::string> whole_scenes(const std::string& page) {
  std::vector<std::string> scenes;
  const std::string begin = "```xml\n", end = "```";
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    const std::string block = page.substr(at, page.find(end, at) - at);
    if (block.find("<ParameterList name=\"Scene\">") != std::string::npos) scenes.push_back(block);
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
      const Ended ended = run_process(program("mixbeam"), {"check", file.string()}, folder);
      EXPECT_EQ(ended.exit_code, 0) << page << "\n" << ended.out << ended.err << scene;
      ++checked;
    }
  }
  EXPECT_GE(checked, 5U);  // scenes.md has four or more, the README one
}

/// What keeps the test above from passing whatever the program says.
TEST(Documentation, AWrongSceneWouldBeNoticed) {
  const TemporaryFolder folder;
  const std::vector<std::string> scenes = whole_scenes(text_of(apps() / "docs" / "scenes.md"));
  ASSERT_FALSE(scenes.empty());
  write_text(folder / "scene.xml", changed(scenes.front(), "\"Diameter\"", "\"Diametre\""));
  EXPECT_EQ(run_process(program("mixbeam"), {"check", (folder / "scene.xml").string()}, folder).exit_code, 2);
}

TEST(Documentation, ItsPicturesAndPagesExist) {
  const std::regex link(R"(\]\(([^)#:]+)\))");
  for (const fs::path& page : pages()) {
    const std::string text = text_of(page);
    for (std::sregex_iterator it(text.begin(), text.end(), link), end; it != end; ++it)
      EXPECT_TRUE(fs::exists(page.parent_path() / (*it)[1].str())) << page << " refers to " << (*it)[1];
  }
}

/// Words of `name=(...)` in a shell script.
std::vector<std::string> words_of(const std::string& script, const std::string& name) {
  const auto begin = script.find(name + "=(");
  if (begin == std::string::npos) return {};
  const auto first = begin + name.size() + 2;
  std::istringstream words(script.substr(first, script.find(')', first) - first));
  return {std::istream_iterator<std::string>(words), {}};
}

TEST(RunScript, DrawsTheFiguresOfEveryBenchmarkThatHasSome) {
  const std::string script = text_of(fs::path(MIXBEAM_SOURCE_DIR) / "run.sh");
  const std::string plots = text_of(apps() / "plots" / "plot_all.py");
  std::vector<std::string> benchmarks = words_of(script, "default_benchmarks");
  const std::vector<std::string> named = words_of(script, "when_named"), without = words_of(script, "tables_only");
  EXPECT_FALSE(benchmarks.empty());
  EXPECT_FALSE(named.empty());
  benchmarks.insert(benchmarks.end(), named.begin(), named.end());
  EXPECT_FALSE(without.empty());
  for (const std::string& name : benchmarks) {
    const bool has_figures = plots.find('"' + name + '"') != std::string::npos;
    EXPECT_EQ(has_figures, std::find(without.begin(), without.end(), name) == without.end()) << name;
  }
}

}  // namespace
}  // namespace mixbeam
