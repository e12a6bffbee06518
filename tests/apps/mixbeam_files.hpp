/// Scenes and result files for the tests of the program `mixbeam`.
#pragma once

#include "apps/common/run/scene_file.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "process.hpp"
#include "tests/support/hdf5.hpp"

#include <libxml/parser.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <thread>

namespace mixbeam {

/// Number of completed steps that a file holds in full: those in the time series, every one with its fields and state.
inline int complete_steps(const FileContents& contents) {
  int steps = 0;
  for (const auto& [path, bytes] : contents) {
    const std::string ending = "/state/interior";
    if (path.rfind("steps/", 0) == 0 && path.size() > ending.size() &&
        path.compare(path.size() - ending.size(), ending.size(), ending) == 0)
      ++steps;
  }
  const auto series = contents.find("monitor/step");
  const int in_series = series == contents.end() ? 0 : std::stoi(series->second);  // it stands before the bytes
  return steps == in_series ? steps : -1;
}

/// What `mixbeam` prints with these arguments.
inline std::string output_of(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const Ended ended = run_process(program("mixbeam"), arguments, folder);
  EXPECT_EQ(ended.exit_code, 0) << ended.err;
  return ended.out;
}

/// Waits until the running program has completed `steps` of its steps.
inline void wait_for_steps(const fs::path& csv, int steps) {
  const auto lines = [&] {
    const std::string text = text_of(csv);
    return std::count(text.begin(), text.end(), '\n');
  };
  for (int tries = 0; tries < 5000 && lines() <= steps; ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

/// The program in a folder of the test.
class MixbeamTest : public ::testing::Test {
 protected:
  Ended mixbeam(std::vector<std::string> words, const std::vector<std::string>& more = {}) const {
    words.insert(words.end(), more.begin(), more.end());
    return run_process(program("mixbeam"), words, folder_);
  }
  pid_t start(const std::vector<std::string>& words) const {
    return start_process(program("mixbeam"), words, folder_.path());
  }
  Ended end(pid_t process, int signal) const {
    kill(process, signal);
    return end_of(process, folder_.path());
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string text(const std::string& name) const { return text_of(folder_ / name); }
  std::string write_scene(const std::string& text) const {
    const std::string name = file(text.front() == '<' ? "scene.xml" : "scene.yaml");
    write_text(name, text);
    return name;
  }

  /// With its results in the folder "results".
  Ended run_scene(const std::string& text, const std::vector<std::string>& more = {}) const {
    return mixbeam({"run", write_scene(text), "--output", "results", "--summary", "summary.json"}, more);
  }
  Ended check_scene(const std::string& text) const { return mixbeam({"check", write_scene(text)}); }

  TemporaryFolder folder_;
};

/// A file of the repository.
inline std::string text_in_repository(const std::string& name) { return text_of(fs::path(MIXBEAM_SOURCE_DIR) / name); }

using Row = std::map<std::string, std::string>;

/// The rows of a table, by its head.
inline std::vector<Row> rows_of(const fs::path& file) {
  const auto cells_of = [](const std::string& line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (c == ',' && !quoted)
        cells.emplace_back();
      else if (c != '"')
        cells.back() += c;
    }
    return cells;
  };
  std::istringstream stream(text_of(file));
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> names = cells_of(line);
  std::vector<Row> rows;
  while (std::getline(stream, line)) {
    const std::vector<std::string> cells = cells_of(line);
    EXPECT_EQ(cells.size(), names.size()) << line;
    Row& row = rows.emplace_back();
    for (std::size_t i = 0; i < std::min(cells.size(), names.size()); ++i) row[names[i]] = cells[i];
  }
  return rows;
}

using XmlDocument = std::unique_ptr<xmlDoc, void (*)(xmlDocPtr)>;
/// Empty for a text that is no XML.
inline XmlDocument xml_document(const std::string& text) {
  return {xmlReadMemory(text.data(), static_cast<int>(text.size()), "", nullptr, XML_PARSE_NOERROR), xmlFreeDoc};
}

/// A scene file, in XML or YAML, with more in it: entries of `yaml` are added or take the place of those of the same
/// name, after the lists `removed` have gone.
inline std::string with(const std::string& scene, const std::string& yaml,
                        const std::vector<std::string>& removed = {}) {
  ApplicationDefinition definition;
  definition.study = ListSpec("anything").without_checks();
  definition.batch = definition.study;
  definition.answers_quantities = true;
  const ListSpec root = root_spec(definition);
  const XmlParameters whole = parse_parameters(scene, "scene", root), more = parse_yaml(yaml, "more.yaml", root);
  for (const std::string& list : removed) EXPECT_TRUE(whole.list->remove(list, false));
  whole.list->setParameters(*more.list);
  return xml_text(*whole.list);
}

/// A benchmark in a folder of the build for each test.
class StudyTest : public ::testing::Test {
 protected:
  void expect_study(int code, const std::string& benchmark, const std::string& arguments,
                    const std::vector<std::string>& parts = {}) const {
    EXPECT_EQ(run_program(benchmark, arguments, folder_), code) << text("output.txt");
    expect_in(text("output.txt"), parts);
  }
  std::string text(const std::string& name) const { return text_of(folder_ / name); }

  const ::testing::TestInfo* test_ = ::testing::UnitTest::GetInstance()->current_test_info();
  fs::path folder_ = folder_for(std::string(test_->test_suite_name()) + "_" + test_->name());
};

/// A file of the folder with the scene.
inline std::string scene_in(const fs::path& folder, const std::string& text) {
  write_text(folder / "scene.xml", text);
  return (folder / "scene.xml").string();
}

/// The scene of an application with more in it, as a file of the folder.
inline std::string scene_with(const std::string& application, const std::string& yaml, const fs::path& folder) {
  return scene_in(folder, with(scene_of(application), yaml));
}

}  // namespace mixbeam
