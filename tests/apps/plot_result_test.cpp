/// Pictures of a result file: every kind is drawn and has content, and a file that is none is refused.
#include "discretization/results/result_file.hpp"
#include "process.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace mixbeam::plot_result_test {
namespace {

const fs::path kPython = "/usr/bin/python3";
constexpr std::uintmax_t kLeastBytes = 4000;  // an empty picture of that size takes less

/// A cantilever of one element under growing end moment, made up by hand.
MemberSamples bent_member(double load_factor) {
  MemberSamples member;
  member.name = "beam";
  constexpr std::size_t kSamples = 5;
  member.resize(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double s = static_cast<double>(i) / (kSamples - 1), sag = -0.1 * load_factor * s * s;
    member.arc_length[i] = s;
    member.reference_position[i] = {s, 0, 0};
    member.position[i] = {s, sag, 0};
    member.displacement[i] = {0, sag, 0};
    member.material_moment[i] = {0, 0, load_factor * (1 - s)};
  }
  return member;
}

class PlotResult : public ::testing::Test {
 protected:
  /// A file of three steps.
  fs::path write_result() {
    const fs::path path = folder_ / "run.h5";
    ResultFile file(path, {"cantilever", "<ParameterList name=\"cantilever\"/>", "1.0", {}});
    for (int step = 0; step < 3; ++step) {
      StepRecord record;
      record.step = step;
      record.load_factor = 0.5 * step;
      record.newton_iterations = 3 * step;
      record.residual = 1e-12;
      record.strain_energy = record.load_factor;
      record.members = {bent_member(record.load_factor)};
      record.monitored = {{"tip.displacement", {0, -0.1 * record.load_factor, 0}}};
      file.append_step(record);
    }
    file.close();
    return path;
  }

  Ended plot(const fs::path& file, const std::vector<std::string>& options = {}) {
    std::vector<std::string> arguments = {(fs::path(MIXBEAM_BIN_DIR) / "plots" / "plot_result.py").string(),
                                          file.string(), "--output", (folder_ / "pictures").string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_process(kPython, arguments, folder_);
  }

  fs::path picture(const std::string& name) const { return folder_ / "pictures" / name; }

  TemporaryFolder folder_;
};

TEST_F(PlotResult, DrawsEveryKindInBothFormats) {
  const std::vector<std::string> kinds = {"shape",     "fields",     "section_forces", "diagrams",
                                          "load_path", "iterations", "steps"};
  std::vector<std::string> options = {"--format", "png,svg", "--picture"};
  options.insert(options.end(), kinds.begin(), kinds.end());
  const Ended ended = expect_code(kOk, plot(write_result(), options));
  EXPECT_EQ(ended.err, "");
  for (std::string kind : kinds) {
    std::replace(kind.begin(), kind.end(), '_', '-');
    for (const char* ending : {".png", ".svg"}) {
      const fs::path path = picture("run-" + kind + ending);
      ASSERT_TRUE(fs::exists(path)) << path;
      EXPECT_GT(fs::file_size(path), kLeastBytes) << path;
      expect_in(ended.out, {path.filename().string()});
    }
  }
  expect_in(text_of(picture("run-shape.svg")), {"cantilever: step 2, load factor 1", "undeformed"});
  expect_in(text_of(picture("run-load-path.svg")), {"tip: displacement"});
  expect_in(text_of(picture("run-section-forces.svg")), {"zero everywhere"});  // there is a moment and nothing else
}

TEST_F(PlotResult, DrawsThreePicturesUnlessMoreAreAskedFor) {
  expect_code(kOk, plot(write_result()));
  std::set<std::string> drawn;
  for (const auto& entry : fs::directory_iterator(folder_ / "pictures")) drawn.insert(entry.path().filename().string());
  EXPECT_EQ(drawn, (std::set<std::string>{"run-shape.png", "run-diagrams.png", "run-load-path.png"}));
}

TEST_F(PlotResult, DrawsStressesOfTheStepsThatHaveThem) {
  const fs::path path = folder_ / "run.h5";
  ResultFile file(path, {"cantilever", "<ParameterList name=\"cantilever\"/>", "1.0", {}});
  for (int step = 0; step < 2; ++step) {
    StepRecord record;
    record.step = step;
    record.load_factor = step;
    MemberSamples plain = bent_member(step);  // its section has no shape
    plain.name = "plain";
    for (Vector3& position : plain.position) position[1] += 1.0;
    record.members = {bent_member(step), plain};
    if (step == 1) {
      for (MemberSamples& member : record.members) {
        const double stress = member.name == "beam" ? 3.0 : std::nan("");
        member.von_mises_stress.assign(member.size(), stress);
        member.largest_normal_stress.assign(member.size(), -stress);
        member.largest_shear_stress.assign(member.size(), 0.0);
      }
      record.stresses.emplace().members.push_back({"beam", 0.0, 1.0, {}, {}, 0.0});
    }
    file.append_step(record);
  }
  file.close();
  for (const char* field : {"von_mises", "normal_stress", "shear_stress"}) {
    const Ended ended =
        expect_code(kOk, plot(path, {"--format", "svg", "--field", field, "--picture", "shape", "fields"}));
    EXPECT_EQ(ended.err, "");
  }
  expect_in(text_of(picture("run-fields.svg")), {"von Mises stress, largest of the section"});
  expect_in(text_of(picture("run-shape.svg")), {"shear stress"});
  expect_refused(plot(path, {"--format", "svg", "--field", "von_mises", "--step", "0", "--picture", "shape"}),
                 {"step 0 has no stresses", "Stresses"});
}

TEST_F(PlotResult, DrawsPathAndModesOfCriticalPoints) {
  const fs::path path = folder_ / "run.h5";
  ResultFile file(path, {"cantilever", "<ParameterList name=\"cantilever\"/>", "1.0", {}});
  for (int step = 0; step < 4; ++step) {
    StepRecord record;
    record.step = step;
    record.load_factor = step < 3 ? 0.5 * step : 0.75;
    record.members = {bent_member(step)};
    record.monitored = {{"tip.displacement", {0, -0.1 * step, 0}}};
    record.stability.negative = step < 3 ? 0 : 1;
    record.stability.stable = step < 3 ? "true" : "false";
    if (step == 3) {
      RecordedCriticalPoint point;
      point.kind = "limit point";
      point.load_factor = 1.0625;
      point.negative_after = 1;
      point.position = bent_member(2.5).position;
      point.displacement = point.mode = bent_member(2.5).displacement;
      point.monitored = {{"tip.displacement", {0, -0.25, 0}}};
      record.critical_points = {point};
    }
    file.append_step(record);
  }
  file.close();
  const Ended ended = expect_code(kOk, plot(path, {"--format", "svg", "--picture", "load_path", "critical_modes"}));
  EXPECT_EQ(ended.err, "");
  expect_in(text_of(picture("run-load-path.svg")), {"dashed: unstable", "limit point", "1.0625"});
  expect_in(text_of(picture("run-critical-modes.svg")), {"1: limit point, load factor 1.0625"});
}

TEST_F(PlotResult, DrawsTheStepAndTheFormatAskedFor) {
  const fs::path file = write_result();
  expect_code(kOk, plot(file, {"--step", "1", "--format", "svg", "--picture", "shape", "--field", "moment"}));
  expect_in(text_of(picture("run-shape-000001.svg")), {"step 1, load factor 0.5"});
  EXPECT_FALSE(fs::exists(picture("run-shape-000001.png")));
  EXPECT_FALSE(fs::exists(picture("run-fields-000001.svg")));
}

TEST_F(PlotResult, RefusesWhatItCannotDraw) {
  const fs::path broken = folder_ / "broken.h5", good = write_result();
  write_text(broken, "\x89HDF\r\n\x1a\nand no more");
  const auto expect_refusal = [this](const fs::path& file, const std::vector<std::string>& options,
                                     const std::vector<std::string>& words) {
    const Ended ended = expect_code(kBadInput, plot(file, options));
    expect_in(ended.err, words);
    EXPECT_EQ(ended.err.find("Traceback"), std::string::npos) << ended.err;
  };
  expect_refusal(broken, {}, {"broken.h5", "damaged", "none of its steps is intact"});
  expect_refusal(folder_ / "absent.h5", {}, {"absent.h5", "no such file"});
  expect_refusal(good, {"--step", "7"}, {"no step 7", "steps 0 to 2"});
  expect_refusal(good, {"--field", "colour"}, {"--field colour", "bending", "torsion"});
  expect_refusal(good, {"--format", "gif"}, {"--format gif", "png, svg, pdf"});
  expect_refusal(good, {"--case", "wind"}, {"without load cases", "no run-wind.h5"});
}

}  // namespace
}  // namespace mixbeam::plot_result_test
