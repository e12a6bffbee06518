// Gradients of natural frequencies against closed forms, and against differences of whole runs.
#include "discretization/state/reactions.hpp"
#include "kernels/math/constants.hpp"
#include "nonlinear/sensitivity/lasting_modes.hpp"
#include "tests/support/buckling_scenes.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/scene_numbers.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test::frequency_gradients_test {
namespace {

constexpr int kModes = 3;
constexpr double kClosedForm = 1e-9;
/// Differences of whole runs of eighth order with steps of two percent.
constexpr double kOfDifferences = 1e-8, kStep = 0.02;
/// Error of the gradient without the motion of a state that is bent, at least.
constexpr double kNotMoved = 1e-2;

SolverParameters with_modes(bool in_plane = false) {
  SolverParameters parameters;
  parameters.analysis.stability = false;
  parameters.analysis.modes.number = kModes;
  parameters.analysis.modes.in_plane = in_plane;
  return parameters;
}

Simulation vibrating(const Scene& scene, bool in_plane = false) {
  Simulation simulation = solved(scene, with_modes(in_plane));
  simulation.polish();
  return simulation;
}

QuantitySet frequencies(const Scene& scene) {
  std::vector<Quantity> quantities;
  for (int mode = 1; mode <= kModes; ++mode)
    quantities.push_back(quantity("f" + std::to_string(mode), "natural frequency", {{"Mode", std::to_string(mode)}}));
  const ParameterSource source("scene.xml");
  return QuantitySet(quantities, scene, {source, {"Quantities"}});
}

std::vector<RecordedGradient> gradients(const Simulation& simulation, const std::vector<Parameter>& parameters,
                                        const std::vector<std::size_t>& columns = {0, 1, 2}) {
  const QuantitySet set = frequencies(simulation.scene());
  GradientRequest request{set, columns};
  for (const Parameter& parameter : parameters) request.numbers.push_back(number_of(simulation.scene(), parameter));
  return simulation.gradients(request);
}

Parameter of_mass(double mass) {
  return {"mass", mass, kStep * mass, [](Scene& changed, double value) { changed.sections[0].mass = value; }};
}
void expect_as_differences(const Scene& scene, const std::vector<Parameter>& parameters, bool in_plane = false) {
  constexpr double kFactors[4] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  const std::vector<RecordedGradient> found = gradients(vibrating(scene, in_plane), parameters);
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const double step = parameters[p].step;
    std::vector<double> wanted(kModes, 0.0);
    for (int k = 0; k < 4; ++k)
      for (const double sign : {1.0, -1.0}) {
        const Simulation there = vibrating(with(scene, parameters[p], sign * (k + 1) * step), in_plane);
        const std::vector<RecordedVibrationMode> modes = there.vibration_modes(kModes, in_plane, 1);
        for (int mode = 0; mode < kModes; ++mode) wanted[mode] += sign * kFactors[k] / step * modes[mode].frequency;
      }
    for (int mode = 0; mode < kModes; ++mode)
      EXPECT_NEAR(found[mode].derivative[p] * step, wanted[mode] * step,
                  kOfDifferences * std::max(std::abs(wanted[mode]) * step, kStep * found[mode].value))
          << scene.name << ", mode " << mode + 1 << " by " << parameters[p].name << ": " << found[mode].derivative[p];
  }
}

/// f goes with sqrt(EI / m) / L^2.
TEST(FrequencyGradients, OfACantilever) {
  Scene scene = column(4, 4);
  scene.sections[0].mass = 2.0;
  scene.sections[0].bending_stiffness[0] *= 3.0;
  scene.point_loads.clear();
  const Simulation simulation = vibrating(scene, true);
  const double stiffness = scene.sections[0].bending_stiffness[1];
  for (const RecordedGradient& found :
       gradients(simulation, {of_stiffness(scene, 5, kStep), of_mass(2.0), of_place(scene, 1, 0, kStep)})) {
    EXPECT_NEAR(found.derivative[0] * stiffness / found.value, 0.5, kClosedForm);
    EXPECT_NEAR(found.derivative[1] * 2.0 / found.value, -0.5, kClosedForm);
    EXPECT_NEAR(found.derivative[2] * scene.points[1].position[0] / found.value, -2.0, kClosedForm);
  }
}

/// omega^2 = pi^4 EI + pi^2 T of a beam that is held by hinges, in compression and as a string.
TEST(FrequencyGradients, UnderTension) {
  for (const double tension : {-0.6 * kPi * kPi, 40.0}) {
    Scene scene = column(4, 8, euler_columns()[2].supports);
    scene.sections[0].mass = 1.0;
    scene.point_loads[0].force[0] = tension;
    const RecordedGradient found =
        gradients(vibrating(scene, true),
                  {of_force(scene, 0, 0, kStep * std::abs(tension)), of_stiffness(scene, 5, kStep)}, {0})
            .front();
    const double slope = 1.0 / (8.0 * kPi * kPi * found.value);
    EXPECT_NEAR(found.derivative[0] / slope, kPi * kPi, kClosedForm * kPi * kPi) << tension;
    EXPECT_NEAR(found.derivative[1] / slope, std::pow(kPi, 4), kClosedForm * std::pow(kPi, 4)) << tension;
  }
}

Scene bent_cantilever() {
  Scene scene = elastica(6.0, 4, 3);
  scene.sections[0].mass = 1.0;
  scene.sections[0].mass_offset = {0.02, -0.03};
  scene.sections[0].rotary_inertia = {0.02, 0.03};
  scene.point_masses = {{"tip", 0.3, {0.01, 0.02, 0.025}}};
  return scene;
}

TEST(FrequencyGradients, OfABentCantilever) {
  const Scene scene = bent_cantilever();
  const std::vector<Parameter> parameters = {of_force(scene, 0, 1, 0.06),
                                             of_stiffness(scene, 5, kStep),
                                             of_place(scene, 1, 0, 0.01),
                                             of_mass(1.0),
                                             {"masses", 1.0, kStep, [](Scene& changed, double value) {
                                                changed.point_masses[0].mass *= value;
                                                changed.point_masses[0].inertia[1] *= value;
                                                changed.sections[0].rotary_inertia[1] *= value;
                                              }}};
  expect_as_differences(scene, parameters);
}

/// Its stiffness alone, without what bends more.
TEST(FrequencyGradients, FailWithoutTheMotionOfTheState) {
  const Scene scene = bent_cantilever();
  const Simulation simulation = vibrating(scene);
  const Parameter force = of_force(scene, 0, 1, 0.001);
  const double wanted = gradients(simulation, {force}, {0}).front().derivative[0];
  BeamProblem problem(scene, this_rank(), with_modes());
  LastingModes modes(problem, simulation.state(), 1.0, with_modes().analysis.modes);
  const auto change = [&](double more) {
    const BeamProblem there(with(scene, force, more), this_rank(), with_modes());
    return modes.changes(1, there.model, simulation.state())[0];
  };
  const double still = (change(force.step) - change(-force.step)) / (2.0 * force.step);
  EXPECT_GT(std::abs(still - wanted), kNotMoved * std::abs(wanted)) << still << " " << wanted;
}

TEST(FrequencyGradients, OfAPortalOfJoints) {
  Scene scene = portal_of_joints(2, 2);
  for (Section& section : scene.sections) section.mass = 0.1;
  scene.point_loads.pop_back();  // it follows, and moments about axes of space have no potential
  for (PointLoad& load : scene.point_loads) load.moment = {};
  const std::vector<Parameter> parameters = {of_force(scene, 0, 1, 0.05),
                                             of_place(scene, 2, 1, 0.02),
                                             of_stiffness(scene, 3, kStep),
                                             {"springs of joints", 1.0, kStep,
                                              [](Scene& changed, double value) {
                                                changed.joints[0].stiffness *= value;
                                                changed.joints[3].stiffness *= value;
                                              }},
                                             {"spring of a support", 200.0, 4.0, [](Scene& changed, double value) {
                                                changed.supports[1].displacement_stiffness[1] = value;
                                              }}};
  expect_as_differences(scene, parameters);
}

/// Pulled by a support.
TEST(FrequencyGradients, OfAFork) {
  Scene scene = fork(3, 1);
  scene.sections[0].mass = 1.0;
  scene.point_loads[0].force = {3, 20, 90};
  scene.supports[0].prescribed_rotation = {0.1, 0.3, -0.2};
  const Parameter turn = {"turn", 0.3, 0.006,
                          [](Scene& changed, double value) { changed.supports[0].prescribed_rotation[1] = value; }};
  expect_as_differences(scene, {of_force(scene, 0, 2, 1.0), turn, of_stiffness(scene, 3, kStep)});
}

/// One of two directions feels one of two stiffnesses; both feel the mass.
TEST(FrequencyGradients, OfADoubleFrequencyAreOneForEachDirection) {
  Scene scene = column(4, 4);
  scene.sections[0].mass = 1.0;
  scene.sections[0].bending_stiffness[0] = scene.sections[0].bending_stiffness[1];
  scene.point_loads.clear();
  const std::vector<RecordedGradient> found =
      gradients(vibrating(scene), {of_stiffness(scene, 4, kStep), of_mass(1.0)}, {0});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_TRUE(std::isnan(found[0].derivative[0]) && std::isnan(found[0].derivative[1]));
  EXPECT_FALSE(found[0].note.empty());
  const double slope = 0.5 * found[0].value / scene.sections[0].bending_stiffness[0];
  EXPECT_NEAR(found[1].derivative[0] / slope, 0.0, kClosedForm);
  EXPECT_NEAR(found[2].derivative[0] / slope, 1.0, kClosedForm);
  for (const int k : {1, 2}) EXPECT_NEAR(found[k].derivative[1] / found[0].value, -0.5, kClosedForm);
}

std::string refusal(const Scene& scene) {
  try {
    gradients(vibrating(scene), {of_stiffness(scene, 5, kStep)}, {0});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FrequencyGradients, AreRefusedWithoutSymmetry) {
  Scene scene = column(4, 4);
  scene.sections[0].mass = 1.0;
  scene.point_loads = {follower_load("tip", "beam", {-1.0, 0.5, 0})};
  EXPECT_NE(refusal(scene).find("without a potential"), std::string::npos) << refusal(scene);
  scene.point_loads.clear();
  scene.sections[0].mass_damping = 0.1;
  EXPECT_NE(refusal(scene).find("damping"), std::string::npos) << refusal(scene);
}

}  // namespace
}  // namespace mixbeam::test::frequency_gradients_test
