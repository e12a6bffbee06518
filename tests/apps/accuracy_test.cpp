/// Scenes with an accuracy, as a user runs them.
#include "mixbeam_files.hpp"

#include <nlohmann/json.hpp>

#include <regex>

namespace mixbeam {
namespace {

class AccuracyOfAScene : public ::testing::Test {
 protected:
  enum { kFine = 0, kMissed = 1, kRefused = 2 };

  static std::string elastica() { return text_of(fs::path(MIXBEAM_SOURCE_DIR) / "apps/gallery/elastica.xml"); }
  /// The elastica with an accuracy, its member with what `division` says in place of order and elements.
  static std::string elastica_with(const std::string& accuracy, const std::string& division = "") {
    std::string text = std::regex_replace(elastica(), std::regex("<Parameter name=\"Elements\"[^>]*>"), "");
    text = std::regex_replace(text, std::regex("<Parameter name=\"Order\"[^>]*>"), division);
    const std::string scene = "<ParameterList name=\"Scene\">";
    return changed(text, scene, scene + "<Parameter name=\"Accuracy\" type=\"double\" value=\"" + accuracy + "\"/>");
  }

  Ended run(const std::string& command, const std::string& scene, std::vector<std::string> more = {}) {
    write_text(folder_ / "scene.xml", scene);
    std::vector<std::string> arguments = {command, (folder_ / "scene.xml").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_process(program("mixbeam"), arguments, folder_);
  }
  Ended run_and_sum_up(const std::string& scene) {
    return run("run", scene, {"--output", (folder_ / "results").string(), "--summary", summary_file()});
  }
  std::string summary_file() const { return (folder_ / "summary.json").string(); }
  nlohmann::json chosen_mesh() const { return nlohmann::json::parse(text_of(summary_file()))["chosen_meshes"][0]; }

  TemporaryFolder folder_;
};

TEST_F(AccuracyOfAScene, IsReachedAndReported) {
  const Ended ended = run_and_sum_up(elastica_with("1e-9"));
  EXPECT_EQ(ended.exit_code, kFine) << ended.err << ended.out;
  expect_in(ended.out, {"wanted accuracy of displacements 1.0e-09", ": reached", "load path", "order "});
  const nlohmann::json mesh = chosen_mesh();
  EXPECT_EQ(mesh["outcome"], "reached");
  EXPECT_LT(mesh["estimated"].get<double>(), 1e-9);
  EXPECT_GE(mesh["members"][0]["order"].get<int>(), 5);
  EXPECT_FALSE(mesh["meshes"].empty());
  const auto contents = contents_of(folder_ / "results" / "scene.h5");
  ASSERT_TRUE(contents);
  EXPECT_EQ(contents->count("members/order"), 1u);
}

// Three elements of order 2 are what they are; the expected values of the scene notice it, too.
TEST_F(AccuracyOfAScene, IsMissedWhereAMemberKeepsItsMesh) {
  const std::string division = R"(<Parameter name="Order" type="int" value="2"/>)"
                               R"(<Parameter name="Elements" type="int" value="3"/>)";
  const Ended ended = run_and_sum_up(elastica_with("1e-9", division));
  EXPECT_EQ(ended.exit_code, kMissed) << ended.err << ended.out;
  expect_in(ended.out, {"orders or elements that members keep prevent it", "estimated error of displacements"});
  EXPECT_EQ(chosen_mesh()["members"][0]["order"], 2);
  EXPECT_EQ(chosen_mesh()["members"][0]["elements"], 3);
}

TEST_F(AccuracyOfAScene, RefusesBadValues) {
  for (const std::string value : {"0", "-1e-6", "1e-12", "1", "nan", "small"}) {
    const Ended ended = run("run", elastica_with(value));
    EXPECT_EQ(ended.exit_code, kRefused) << value << ended.out;
    expect_in(ended.err, {"scene.xml:", "\"Scene / Accuracy\"", value == "-1e-6" ? "-1e-06" : value});
  }
}

TEST_F(AccuracyOfAScene, CheckTellsTheStartMesh) {
  const Ended ended = run("check", elastica_with("1e-6"));
  EXPECT_EQ(ended.exit_code, kFine) << ended.err;
  expect_in(ended.out, {"start mesh for an accuracy of 1.0e-06", "order ", "elements "});
}

TEST_F(AccuracyOfAScene, CannotBeResumed) {
  ASSERT_EQ(run_and_sum_up(elastica_with("1e-9")).exit_code, kFine);
  const Ended resumed =
      run_process(program("mixbeam"), {"resume", (folder_ / "results" / "scene.h5").string()}, folder_);
  EXPECT_EQ(resumed.exit_code, kRefused);
  expect_in(resumed.err, {"scene.h5", "cannot be resumed", "accuracy"});
}

// Programs with studies set the meshes themselves.
TEST_F(AccuracyOfAScene, IsForMixbeamOnly) {
  const std::string scene = "<ParameterList name=\"Scene\">";
  write_text(folder_ / "fork.xml",
             changed(scene_of("fork"), scene, scene + R"(<Parameter name="Accuracy" type="double" value="1e-6"/>)"));
  const Ended ended = run_process(program("fork"), {(folder_ / "fork.xml").string(), "--single"}, folder_);
  EXPECT_EQ(ended.exit_code, kRefused);
  expect_in(ended.err, {"fork.xml:", "\"Scene / Accuracy\"", "mixbeam run"});
}

}  // namespace
}  // namespace mixbeam
