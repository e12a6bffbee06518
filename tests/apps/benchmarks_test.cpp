/// The benchmarks as a user runs them: each study passes and leaves what its figures need, small changes are noticed,
/// and scenes that do not fit are refused.
#include "mixbeam_files.hpp"

#include <nlohmann/json.hpp>

namespace mixbeam::benchmarks_test {
namespace {

struct Question {
  std::string benchmark, name;
  std::string yaml{};        ///< entries that are added to the scene or take the place of others
  std::string from{}, to{};  ///< and a text that is replaced everywhere
  std::string arguments{};
  int exit_code = 0;
  std::size_t least_checks = 0;
  std::vector<std::string> prints{}, files{};
};

std::ostream& operator<<(std::ostream& stream, const Question& question) {
  return stream << question.benchmark << ": " << question.name;
}

std::string load(const std::string& entry) { return "Scene: {Point Loads: " + entry + "}"; }

Question study(const std::string& benchmark, std::size_t least_checks, const std::vector<std::string>& files) {
  Question question{benchmark, "StudyPasses"};
  question.least_checks = least_checks;
  question.files = files;
  return question;
}
Question changed_to(const std::string& benchmark, const std::string& name, const std::string& yaml, int exit_code,
                    const std::vector<std::string>& prints, const std::string& arguments = "") {
  Question question{benchmark, name, yaml};
  question.exit_code = exit_code;
  question.prints = prints;
  question.arguments = arguments;
  return question;
}
Question renamed(const std::string& benchmark, const std::string& name, const std::string& from, const std::string& to,
                 const std::vector<std::string>& prints) {
  Question question{benchmark, name, "", from, to};
  question.exit_code = 2;
  question.prints = prints;
  return question;
}

std::vector<Question> questions() {
  return {
      study("arc_segment", 125,  // 36 rows of the paper's tables, three components each
            {"convergence.csv", "table.csv", "single_rho10.h5", "single_rho100.h5", "single_rho1000.h5"}),
      changed_to("arc_segment", "AnotherForceMissesThePaper", load("{force: {Force: [0, 0, 600.01]}}"), 1,
                 {"<- differs"}),
      changed_to("arc_segment", "ReferenceMeshesMustFit", "Study: {Reference Elements: 100}", 2,
                 {"Reference Elements"}),
      study("fork", 70, {"table.csv", "convergence.csv", "load_displacement.csv", "single.h5"}),
      changed_to("fork", "ForcesThatAreNoCoupleAreNotMirrored", load("{force at P2: {Force: [0, 0, -200.001]}}"), 1,
                 {"FAIL  loads in reverse order: one path and the mirror image"}),
      changed_to("fork", "NeedsTwoStages", load("{force at P2: {Stage: 1}}"), 2, {}),
      changed_to("fork", "MeshesMustFit", "Study: {Convergence Elements per Member: [3, 5]}", 2,
                 {"value 5; allowed: divisors of 384"}),
      study("helical_rod", 36,
            {"load_displacement.csv", "single.h5", "strains_k1.csv", "strains_k4.csv", "shape_k1.csv", "shape_k2.csv",
             "shape_k3.csv", "shape_k4.csv"}),
      changed_to("helical_rod", "AThousandthOfTheForceIsNoticed", load("{tip: {Force: [0, 0, 50.05]}}"), 1, {},
                 " --single"),
      study("helix", 101, {"convergence.csv", "order1.h5", "order3.h5"}),
      changed_to("helix", "TheTenthDigitOfTheMomentIsNoticed",
                 load("{tip moment: {Moment: [56.41517396, 0, 141.78679683929983]}}"), 1, {}, " --single"),
      changed_to("helix", "StudyOfAnotherStructureIsRefused",
                 "Scene: {Members: {second: {Start: clamp, End: tip, Section: circle}}}", 2, {"one member"}),
      study("rollup", 1, {"convergence.csv", "single.h5"}),
      changed_to("rollup", "AnotherMomentMissesTheExpectedTip", load("{moment: {Moment: [0, 0, 12.566370615]}}"), 1, {},
                 " --single"),
      renamed("rollup", "AForceIsNoPureBending", "\"Moment\"", "\"Force\"", {"moment about z"}),
      study("modes", 200, {"convergence.csv"}),
      changed_to("modes", "AnotherMassMissesTheClosedForms", "Scene: {Sections: {strip: {Mass: 1.001}}}", 1,
                 {"FAIL  cantilever, k=4, 8 elements, bending 1"}),
      study("sensitivity", 48, {"convergence.csv", "costs.csv"}),
      changed_to("sensitivity", "AnotherStiffnessMissesTheEllipticIntegrals",
                 "Scene: {Sections: {strip: {EI3: 1.000001}}}", 1, {"FAIL  alpha 1 by force, k=4, 16 elements"}),
      study("slope_discontinuity", 45, {"table.csv", "load_displacement.csv", "single.h5"}),
      changed_to("slope_discontinuity", "AnotherForceMissesThePaper", load("{tip force: {Force: [-10, 0, -10.001]}}"),
                 1, {"<- differs"}),
      changed_to("slope_discontinuity", "AnotherMaximumOfIterationsFailsTheRows", "Study: {Most Iterations: 5}", 1,
                 {"FAIL  k=1, 3 elements: Newton iterations = 1", ", at most 5"}),
      renamed("slope_discontinuity", "StudyNeedsTheTip", "\"tip\"", "\"end\"", {"no point \"tip\""}),
      study("superimposed_rotation", 1, {"single.h5", "deviation.csv"}),
      // a small force that keeps its direction does not turn with the rod
      changed_to("superimposed_rotation", "ALoadThatDoesNotTurnIsNoticed",
                 load("{weight: {Point: tip, Force: [1e-6, 0, 0]}}"), 1,
                 {"FAIL  scene: change of u3(L) / L", "FAIL  scene: farthest vertex after turning back"}, " --single"),
  };
}

class Benchmarks : public ::testing::TestWithParam<Question> {};

TEST_P(Benchmarks, Answer) {
  const Question& question = GetParam();
  const fs::path folder = folder_for(question.benchmark + "_" + question.name), summary = folder / "summary.json";
  std::string scene = scene_of(question.benchmark);
  if (!question.yaml.empty()) scene = with(scene, question.yaml);
  for (std::size_t at = 0; !question.from.empty() && (at = scene.find(question.from, at)) != std::string::npos;)
    scene.replace(at, question.from.size(), question.to);
  write_text(folder / "scene.xml", scene);
  const std::string arguments = (folder / "scene.xml").string() + " --summary " + summary.string();
  EXPECT_EQ(run_program(question.benchmark, arguments + question.arguments, folder), question.exit_code)
      << text_of(folder / "output.txt");
  expect_in(text_of(folder / "output.txt"), question.prints);
  for (const std::string& file : question.files) EXPECT_TRUE(fs::exists(folder / file)) << file;
  if (fs::exists(folder / "deviation.csv") && question.exit_code == 0) {  // header, bent state, increments
    const std::string deviations = text_of(folder / "deviation.csv");
    EXPECT_EQ(std::count(deviations.begin(), deviations.end(), '\n'), 1 + 1 + 71);
  }
  if (question.least_checks > 0) {
    EXPECT_GE(nlohmann::json::parse(text_of(summary))["checks"].size(), question.least_checks);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Benchmarks, testing::ValuesIn(questions()),
                         [](const auto& question) { return question.param.benchmark + "_" + question.param.name; });

}  // namespace
}  // namespace mixbeam::benchmarks_test
