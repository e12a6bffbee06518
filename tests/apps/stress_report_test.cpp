/// What `mixbeam run` says of stresses and strains, and what the result file holds of them.
#include "mixbeam_files.hpp"

namespace mixbeam::stress_report_test {
namespace {

const std::string kMaterial = "E: 210e9, nu: 0.3, ";
const std::string kCircle = "Shape: circle, Diameter: 0.02, ";

std::string with_material(const std::string& shape, const std::string& more = "") {
  return shape + "Material: {" + kMaterial + more + "}, ";
}

/// A cantilever of length 1 along x with a force at its tip.
std::string cantilever(const std::string& section, const std::string& force, const std::string& analysis = "",
                       const std::string& more = "") {
  return "Scene:\n  Sections: {rod: {" + section + R"yaml(}}
  Points: {wall: [0, 0, 0], tip: [1, 0, 0]}
  Supports: {clamp: {Point: wall}}
  Members: {beam: {Start: wall, End: tip, Section: rod, Second Axis: [0, 1, 0], Elements: 10, )yaml" +
         more + "}}\n  Point Loads: {load: {Point: tip, " + force + "}}\n" + analysis;
}

std::string force_z(const std::string& value) { return "Force: [0, 0, " + value + "]"; }

std::string stresses(const std::string& choice) { return "Analysis: {Stresses: '" + choice + "'}\n"; }

class StressReport : public MixbeamTest {
 protected:
  FileContents contents() const { return contents_of(folder_ / "results/scene.h5"); }
};

/// Numbers of a dataset as `contents_of` gives it: count, colon, bytes.
std::vector<double> numbers(const std::string& bytes) {
  const std::size_t colon = bytes.find(':');
  std::vector<double> values((bytes.size() - colon - 1) / sizeof(double));
  std::memcpy(values.data(), bytes.data() + colon + 1, values.size() * sizeof(double));
  return values;
}

TEST_F(StressReport, NamesTheMostStressedMembers) {
  const Ended ended = expect_code(kOk, run_scene(cantilever(with_material(kCircle, "Strength: 1e8"), force_z("-10"))));
  // M c / I = 32 * 10 / (pi d^3) = 1.27324e7 at the clamp, tension on the upper side
  expect_in(ended.out, {"largest stress in", "beam", "1.27324e+07", "0.01", "utilisation", "0.127"});
  EXPECT_EQ(ended.out.find("warning"), std::string::npos);
  const FileContents file = contents();
  const auto last = file.find("steps/000001/von_mises_stress");
  ASSERT_NE(last, file.end());
  const std::vector<double> von_mises = numbers(last->second);
  EXPECT_NEAR(von_mises.front(), 32.0 * 10.0 / (3.14159265358979324 * 8e-6), 1e-5 * von_mises.front());
  // at the tip Q alone: (3 + 2 nu) / (8 (1 + nu)) Q a^2 / I in the middle, by sqrt(3)
  const double shear = 3.6 / 10.4 * 10.0 * 4.0 / (3.14159265358979324 * 1e-4);
  EXPECT_NEAR(numbers(file.at("steps/000001/largest_shear_stress")).back(), shear, 1e-4 * shear);
  EXPECT_EQ(file.count("steps/000000/von_mises_stress"), 0u);  // of the end of the path only
}

/// What ParaView shows: stresses where the file has them, of runs that are gone on with too.
TEST_F(StressReport, StandInTheXdmfFile) {
  const std::string strong = "Strength: 1e8, ";
  ASSERT_EQ(run_scene(cantilever(with_material(kCircle, strong), force_z("-10"))).exit_code, 0);
  const std::vector<double> von_mises = numbers(contents().at("steps/000001/von_mises_stress"));
  const std::vector<double> utilisation = numbers(contents().at("steps/000001/utilisation"));
  ASSERT_EQ(utilisation.size(), von_mises.size());
  for (std::size_t i = 0; i < von_mises.size(); ++i) EXPECT_DOUBLE_EQ(utilisation[i], von_mises[i] / 1e8);
  const fs::path xdmf = folder_ / "results/scene.xdmf";
  const std::string text = text_of(xdmf);
  expect_in(text, {"scene.h5:/steps/000001/utilisation", "scene.h5:/steps/000001/von_mises_stress"});
  EXPECT_EQ(text.find("/steps/000000/von_mises_stress"), std::string::npos);  // of the end of the path only
  fs::remove(xdmf);
  ASSERT_EQ(mixbeam({"resume", "results/scene.h5"}).exit_code, 0);
  EXPECT_EQ(text_of(xdmf), text);
  ASSERT_EQ(run_scene(cantilever(with_material(kCircle), force_z("-10"), stresses("every step"))).exit_code, 0);
  expect_in(text_of(xdmf), {"/steps/000000/von_mises_stress", "/steps/000001/von_mises_stress"});
  EXPECT_EQ(text_of(xdmf).find("utilisation"), std::string::npos);  // no strength is given
}

TEST_F(StressReport, EveryStepOrNone) {
  EXPECT_EQ(run_scene(cantilever(with_material(kCircle), force_z("-10"), stresses("every step"))).exit_code, 0);
  EXPECT_EQ(contents().count("steps/000000/von_mises_stress"), 1u);
  const Ended off = expect_code(kOk, run_scene(cantilever(with_material(kCircle), force_z("-10"), stresses("off"))));
  EXPECT_EQ(off.out.find("largest stress"), std::string::npos);
  EXPECT_EQ(contents().count("steps/000001/von_mises_stress"), 0u);
  expect_refused(run_scene(cantilever(with_material(kCircle), force_z("-10"), stresses("evry step"))),
                 {"Stresses", "evry step", "every step"});
}

TEST_F(StressReport, NothingForSectionsWithoutShape) {
  std::string stiffnesses;
  for (const char* name : {"EA", "GA2", "GA3", "GIt", "EI2", "EI3"}) stiffnesses += name + std::string(": 1e3, ");
  const Ended ended = expect_code(kOk, run_scene(cantilever(stiffnesses, force_z("-10"))));
  EXPECT_EQ(ended.out.find("largest stress"), std::string::npos);
  EXPECT_EQ(contents().count("steps/000001/von_mises_stress"), 0u);
}

TEST_F(StressReport, WarnsOfStrainsAndOfThickCurvedMembers) {
  const std::string thick = "Shape: circle, Diameter: 0.2, ";
  const std::string arc = "Curve: {Shape: arc, Center: [0.5, 0, 0], Axis: [0, 1, 0], Angle: 3.141592653589793}, ";
  const Ended curved = expect_code(kOk, run_scene(cantilever(with_material(thick), force_z("-10"), "", arc)));
  expect_in(curved.out, {"warning: member \"beam\" is curved", "15 %"});  // 3 d / (8 R)
  EXPECT_EQ(curved.out.find("is strained by"), std::string::npos);
  const std::string roll = "Moment: [0, 16493.361431346415, 0], ";  // EI2 * 10: radius 0.1
  expect_in(expect_code(kOk, run_scene(cantilever(with_material(kCircle), roll))).out,
            {"warning: member \"beam\" is strained by 10 %", "more than 5 %", "Largest Strain"});
  const Ended allowed = run_scene(cantilever(with_material(kCircle) + "Largest Strain: 0.2, ", roll));
  EXPECT_EQ(allowed.out.find("is strained by"), std::string::npos);
}

TEST_F(StressReport, WarnsOfUtilisationAboveOne) {
  const auto with_strength = [this](const std::string& strength) {  // 1.27324e7 is the largest stress, at the clamp
    return run_scene(cantilever(with_material(kCircle, "Strength: " + strength), force_z("-10"))).out;
  };
  expect_in(with_strength("1.25e7"),
            {"warning: member \"beam\" is stressed beyond the \"Strength\"", "utilisation 1.02 at s = 0", "1 warning"});
  EXPECT_EQ(with_strength("1.3e7").find("warning"), std::string::npos);
}

TEST_F(StressReport, NotesTorsionOfOpenSections) {
  const std::string profile = "Shape: I, Width: 0.1, Height: 0.2, Flange: 0.0085, Web: 0.0056, ";
  expect_in(expect_code(kOk, run_scene(cantilever(with_material(profile), "Moment: [100, 0, 0]"))).out,
            {"torsion makes 100 %", "warping"});
  EXPECT_EQ(run_scene(cantilever(with_material(profile), force_z("-10"))).out.find("warping"), std::string::npos);
}

}  // namespace
}  // namespace mixbeam::stress_report_test
