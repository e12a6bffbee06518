// Gradients against closed forms, and against differences of whole runs.
#include "discretization/state/reactions.hpp"
#include "nonlinear/sensitivity/gradient.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/scene_numbers.hpp"
#include "tests/support/solve.hpp"

#include <array>
#include <complex>

namespace mixbeam::test {
namespace {

/// Elastica of 16 elements of order 4 under a dead force, alpha = P L^2 / EI = 1, 2, 10: derivatives of deflection,
/// shortening and angle of the tip by alpha, from elliptic integrals; the discretization leaves 2e-13.
constexpr double kElasticaSlopes[3][4] = {{1.0, 0.248876443127961, 0.0962778480847484, 0.395682566689845},
                                          {2.0, 0.142546214828556, 0.102876897296855, 0.253014804550978},
                                          {10.0, 0.0105359712168047, 0.0215494661654688, 0.0222664098396707}};
constexpr double kOfElastica = 1e-12;
/// Of a helix of a turn with as many elements: what the discretization leaves.
constexpr double kOfHelix = 1e-10;
/// The same rod under a force across its tip that follows it, alpha = 1, 3: of position x, y and angle of the tip, from
/// the elliptic functions of a pendulum that starts at a quarter turn, theta(s) = chi(1 - s) - chi(1),
/// sin(chi(u) / 2) = cd(sqrt(alpha) u, 1/2) / sqrt(2), in thirty digits.
constexpr double kFollowerSlopes[2][4] = {{1.0, -0.1242175779022972, 0.2960448767500005, 0.4877550219847669},
                                          {3.0, -0.2197448637106862, 0.1024315272148965, 0.4052201813188245}};
/// Differences of whole runs of eighth order with steps of two percent: what Newton's method leaves, over the step.
constexpr double kOfDifferences = 1e-8, kStep = 0.02;

/// Of derivatives that are zero, in the units of the scenes here.
constexpr double kNothing = 1e-11;
/// Error of the gradient with the tangent of a follower itself, or with that of a structure at rest, at least.
constexpr double kNotTransposed = 1e-3;

QuantitySet set_of(const std::vector<Quantity>& quantities, const Scene& scene) {
  const ParameterSource source("scene.xml");
  return QuantitySet(quantities, scene, {source, {"Quantities"}});
}

std::vector<double> values_in(const QuantitySet& set, const Simulation& simulation) {
  const std::vector<Reaction> reactions = simulation.reactions();
  return set.values(
      {simulation.model(), simulation.state(), simulation.load_factor(), reactions, simulation.strain_energy()});
}

Simulation polished(const Scene& scene) {
  SolverParameters parameters;
  parameters.analysis.stability = false;
  Simulation simulation = solved(scene, parameters);
  simulation.polish();
  return simulation;
}

/// Of every column, by central differences of eighth order of runs.
std::vector<double> differences(const Scene& scene, const QuantitySet& set, const Parameter& parameter) {
  constexpr double kFactors[4] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  std::vector<double> sum(set.columns().size(), 0.0);
  for (int k = 0; k < 4; ++k)
    for (const double sign : {1.0, -1.0}) {
      const std::vector<double> values =
          values_in(set, polished(with(scene, parameter, sign * (k + 1) * parameter.step)));
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += sign * kFactors[k] / parameter.step * values[i];
    }
  return sum;
}

std::vector<std::size_t> all_columns(const QuantitySet& set) {
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < set.columns().size(); ++i)
    if (set.columns()[i].is_value) columns.push_back(i);
  return columns;
}

std::vector<RecordedGradient> gradients(const Simulation& simulation, const QuantitySet& set,
                                        const std::vector<Parameter>& parameters, bool by_element = false,
                                        std::optional<bool> direct = {}) {
  GradientRequest request{set, all_columns(set), {}, by_element, direct};
  for (const Parameter& parameter : parameters) request.numbers.push_back(number_of(simulation.scene(), parameter));
  return simulation.gradients(request);
}

/// Relative to the largest derivative of the same quantity by numbers in units of themselves.
void expect_as_differences(const Scene& scene, const std::vector<Quantity>& quantities,
                           const std::vector<Parameter>& parameters) {
  const QuantitySet set = set_of(quantities, scene);
  const Simulation simulation = polished(scene);
  std::vector<std::vector<double>> wanted;
  for (const Parameter& parameter : parameters) wanted.push_back(differences(scene, set, parameter));
  for (const bool direct : {false, true}) {
    const std::vector<RecordedGradient> found = gradients(simulation, set, parameters, false, direct);
    for (size_t i = 0; i < found.size(); ++i) {
      const size_t column = all_columns(set)[i];
      double largest = 0.0;
      for (size_t p = 0; p < parameters.size(); ++p)
        largest = std::max(largest, std::abs(wanted[p][column] * parameters[p].step));
      for (size_t p = 0; p < parameters.size(); ++p)
        EXPECT_NEAR(found[i].derivative[p] * parameters[p].step, wanted[p][column] * parameters[p].step,
                    kOfDifferences * std::max(largest, kStep * std::abs(found[i].value)) + kNothing)
            << scene.name << ": " << found[i].quantity << " by " << parameters[p].name << " " << found[i].derivative[p]
            << " " << wanted[p][column] << (direct ? " directly" : " by adjoints");
    }
  }
}

Parameter of_moment(const Scene& scene, size_t load, int component, double step) {
  return of_number("moment " + std::to_string(load), scene, step,
                   [=](Scene& of) -> double& { return of.point_loads[load].moment[component]; });
}

/// What is usual at a point and in a member, and the reactions of supports, of which the first is clamped.
std::vector<Quantity> usual(const std::string& point, const std::string& member,
                            const std::vector<std::string>& supports) {
  std::vector<Quantity> all = {
      quantity("u", "displacement", {{"Point", point}}),
      quantity("theta", "rotation", {{"Point", point}}),
      quantity("place", "position", {{"Point", member + "@37%"}}),
      quantity("turn", "rotation", {{"Point", member + "@37%"}}),
      quantity("n", "material force", {{"Member", member}, {"Position", "0.6"}}),
      quantity("m", "material moment", {{"Member", member}, {"Position", "0"}}),
      quantity("f", "spatial force", {{"Member", member}, {"Position", "0.6"}}),
      quantity("kappa", "material curvature", {{"Member", member}, {"Position", "0.3"}, {"Component", "norm"}}),
      quantity("energy", "strain energy", {}),
      quantity("length", "length", {{"Member", member}})};
  all.push_back(quantity("reaction moment", "reaction moment", {{"Point", supports[0]}}));
  for (const std::string& support : supports)
    all.push_back(quantity("reaction force at " + support, "reaction force", {{"Point", support}}));
  return all;
}

std::vector<Parameter> with_stiffnesses(std::vector<Parameter> parameters, const Scene& scene) {
  for (const Parameter& stiffness : of_stiffnesses(scene, kStep)) parameters.push_back(stiffness);
  return parameters;
}

QuantitySet tip_of(const Scene& scene) {
  return set_of({quantity("u", "displacement", {{"Point", "tip"}}),
                 quantity("theta", "rotation", {{"Point", "tip"}, {"Component", "z"}})},
                scene);
}

/// The first section alone bends; the tip of a rigid, straight strip.
TEST(Gradients, OfTheElastica) {
  for (const auto& [alpha, deflection, shortening, angle] : kElasticaSlopes) {
    const Scene scene = elastica(alpha, 4, 16);
    const QuantitySet set = tip_of(scene);
    const Simulation simulation = polished(scene);
    const std::vector<Parameter> parameters = {of_force(scene, 0, 1, kStep * alpha), of_stiffness(scene, 4, kStep),
                                               of_stiffness(scene, 5, kStep)};
    const std::vector<RecordedGradient> found = gradients(simulation, set, parameters, true);
    const double wanted[] = {-shortening, deflection, 0.0, angle};
    for (size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(found[i].derivative[0], wanted[i], kOfElastica) << alpha << " " << i;
      EXPECT_NEAR(found[i].derivative[1] + found[i].derivative[2], -alpha * wanted[i], alpha * kOfElastica)
          << alpha << " " << i;
      double sum = 0.0, axial = 0.0;
      for (const std::array<double, 6>& stiffness : found[i].stiffness) {
        sum += stiffness[4] + stiffness[5];
        axial = std::max(axial, std::abs(stiffness[0]));
      }
      EXPECT_NEAR(sum, -alpha * wanted[i], alpha * kOfElastica) << alpha << " " << i;
      EXPECT_EQ(axial, 0.0);
    }
  }
}

TEST(Gradients, OfTheElasticaUnderAForceThatFollows) {
  for (const auto& [alpha, x, y, angle] : kFollowerSlopes) {
    Scene scene = cantilever(section(kRigid, kRigid, 1.0, 1.0), 1.0, 4, 16);
    scene.point_loads = {follower_load("tip", "beam", {0, alpha, 0})};
    const std::vector<RecordedGradient> found = gradients(
        polished(scene), tip_of(scene), {of_force(scene, 0, 1, kStep * alpha), of_stiffness(scene, 5, kStep)});
    const double wanted[] = {x, y, 0.0, angle};
    for (size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(found[i].derivative[0], wanted[i], kOfElastica) << alpha << " " << i;
      EXPECT_NEAR(found[i].derivative[1], -alpha * wanted[i], alpha * kOfElastica) << alpha << " " << i;
    }
  }
}

/// Tip of a rod along e1 of length one under a moment (torsion, 0, bending) that turns with it: the moment m is
/// constant in space, the axis a helix about it, r' = exp(s [m]x / EI) e1, and the triads turn about the axis by
/// torsion (1 / GIt - 1 / EI) against m. Complex numbers give derivatives to rounding.
using Complex = std::complex<double>;
std::array<Complex, 3> tip_of_helix(double torsion, double bending, Complex EI, Complex GIt) {
  const Complex turn = torsion * (1.0 / GIt - 1.0 / EI);
  const double size = std::hypot(torsion, bending);
  const std::array<Complex, 3> axis = {torsion / size, -bending / size * std::sin(turn),
                                       bending / size * std::cos(turn)};
  const Complex rate = size / EI, sine = std::sin(rate) / rate, cosine = (1.0 - std::cos(rate)) / rate;
  const std::array<Complex, 3> across = {0.0, axis[2], -axis[1]};  // axis x e1
  std::array<Complex, 3> tip;
  for (int i = 0; i < 3; ++i) tip[i] = (i == 0 ? sine : 0.0) + cosine * across[i] + (1.0 - sine) * axis[0] * axis[i];
  return tip;
}

TEST(Gradients, OfAHelix) {
  constexpr double kTorsion = 2.0, kBending = 5.0, kEI = 1.0, kGIt = 0.7, kTiny = 1e-30;
  Scene scene = cantilever(section(kRigid, kRigid, kGIt, kEI), 1.0, 4, 16);
  scene.point_loads = {follower_load("tip", "beam", {}, {kTorsion, 0, kBending})};
  const QuantitySet set = set_of({quantity("r", "position", {{"Point", "tip"}})}, scene);
  const std::vector<RecordedGradient> found =
      gradients(polished(scene), set,
                {of_stiffness(scene, 3, kStep), of_stiffness(scene, 4, kStep), of_stiffness(scene, 5, kStep)});
  const auto by_EI = tip_of_helix(kTorsion, kBending, {kEI, kTiny}, kGIt),
             by_GIt = tip_of_helix(kTorsion, kBending, kEI, {kGIt, kTiny});
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(found[i].value, by_EI[i].real(), kOfHelix) << i;
    EXPECT_NEAR(found[i].derivative[0], by_GIt[i].imag() / kTiny, kOfHelix) << i;
    EXPECT_NEAR(found[i].derivative[1] + found[i].derivative[2], by_EI[i].imag() / kTiny, kOfHelix) << i;
    EXPECT_GT(std::abs(found[i].derivative[0] - by_EI[i].imag() / kTiny), kNotTransposed) << i;
  }
}

TEST(Gradients, OfAFork) {
  Scene scene = fork(3, 3);
  scene.point_loads[0].force = {3, 20, 90};
  scene.point_loads[1].force = {-5, 30, -40};
  std::vector<Quantity> quantities = usual("tine 1", "shaft", {"clamp"});
  quantities.push_back(quantity("between", "distance", {{"Point", "tine 1"}, {"Other Point", "tine 2"}}));
  quantities.push_back(
      quantity("angle", "angle", {{"Point", "tine 1"}, {"Other Point", "tine 2"}, {"Corner", "branch"}}));
  expect_as_differences(
      scene, quantities,
      with_stiffnesses({of_force(scene, 0, 2, 1.0), of_force(scene, 1, 1, 1.0), of_place(scene, 0, 1, 0.01)}, scene));
}

/// Followers along a member and at its end, a dead couple in space: all that has no potential.
Scene cantilever_of_followers() {
  Scene scene = cantilever(section(1e3, 6e2, 80.0, 100.0), 1.0, 3, 4);
  scene.name = "followers";
  scene.points[1].position = {1.0, 0.2, -0.1};
  scene.sections[0].bending_stiffness = {70.0, 100.0};
  scene.members[0].second_axis = {0, 1, 0};
  scene.point_loads = {follower_load("tip", "beam", {10, 60, -30}, {10, 20, 30}),
                       dead_load("tip", {5, 0, 0}, {15, -20, 25})};
  scene.distributed_loads = {{"beam", {0, 40, 50}, {10, -20, 5}, 1, LoadFrame::follower}};
  return scene;
}

TEST(Gradients, UnderFollowers) {
  const Scene scene = cantilever_of_followers();
  const auto line_load = [](Scene& of) -> double& { return of.distributed_loads[0].force[1]; };
  expect_as_differences(
      scene, usual("tip", "beam", {"clamp"}),
      with_stiffnesses({of_force(scene, 0, 1, 0.6), of_moment(scene, 1, 2, 0.3), of_place(scene, 1, 0, 0.01),
                        of_place(scene, 1, 2, 0.01), of_number("line load", scene, 0.4, line_load)},
                       scene));
}

/// Points of N that carry only its axial part, or only its shear parts.
TEST(Gradients, OfSelectiveIntegration) {
  for (const ForceIntegration rule : {ForceIntegration::axial_reduced, ForceIntegration::shear_reduced}) {
    Scene scene = cantilever_of_followers();
    scene.members[0].force_integration = rule;
    expect_as_differences(scene,
                          {quantity("u", "displacement", {{"Point", "tip"}}),
                           quantity("n", "material force", {{"Member", "beam"}, {"Position", "0.6"}})},
                          {of_force(scene, 0, 1, 0.6), of_stiffness(scene, 0, kStep), of_stiffness(scene, 5, kStep)});
  }
}

/// Of the deflection of the tip by EI3, with the equations of another scene, or its tangent itself.
double slope_by_bending(const Scene& equations, const Simulation& simulation, bool transposed) {
  BeamProblem problem(equations, this_rank(), {});
  StateDerivative quantity(problem.model, simulation.state());
  quantity.add_displacement(simulation.model().structure().partition.place(vertex_of(simulation.model().mesh(), "tip")),
                            {{0, 1, 0}});
  AdjointOperator adjoint(problem, simulation.state(), simulation.load_factor(), transposed);
  RecordedGradient found;
  find_by_element(simulation.state(), quantity, adjoint.solve(quantity), found);
  double sum = 0.0;
  for (const std::array<double, 6>& stiffness : found.stiffness) sum += stiffness[5];
  return sum;
}

double difference_by_bending(const Scene& scene) {
  const QuantitySet set = set_of({quantity("u", "displacement", {{"Point", "tip"}, {"Component", "y"}})}, scene);
  return differences(scene, set, of_stiffness(scene, 5, kStep))[0];
}

/// The tangent itself in place of its transpose.
TEST(Gradients, TangentThatIsNotTransposedFails) {
  const Scene scene = cantilever_of_followers();
  const Simulation simulation = polished(scene);
  const double wanted = difference_by_bending(scene);
  EXPECT_LT(std::abs(slope_by_bending(scene, simulation, true) / wanted - 1.0), kOfDifferences);
  EXPECT_GT(std::abs(slope_by_bending(scene, simulation, false) / wanted - 1.0), kNotTransposed);
}

/// Masses beside the axis of a member and a body, in a frame that turns about an axis of space.
Scene in_rotating_frame(Scene scene) {
  scene.name += " in a frame";
  scene.sections[0].mass = 2.0;
  scene.sections[0].mass_offset = {0.02, -0.03};
  scene.sections[0].rotary_inertia = {0.05, 0.02, 0.03};
  scene.point_masses = {{"tip", 0.5, {0.03, 0.04, 0.05}}};
  scene.rotating_frames = {{{-0.3, 0.1, 0.2}, {2, -1, 4}}};
  scene.members[0].order = scene.members[0].elements = 2;
  return scene;
}

std::vector<Parameter> of_frame(const Scene& scene) {
  const auto of_section = [&](const std::string& name, double value, const auto& place) {
    return of_number(name, scene, kStep * value, place);
  };
  return {of_force(scene, 0, 1, 0.5 * kStep * scene.point_loads[0].force[1]),
          of_place(scene, 1, 0, 0.01),
          of_stiffness(scene, 4, kStep),
          of_stiffness(scene, 5, kStep),
          of_section("mass", 2.0, [](Scene& of) -> double& { return of.sections[0].mass; }),
          of_section("offset", 0.02, [](Scene& of) -> double& { return of.sections[0].mass_offset[0]; }),
          of_section("inertia", 0.02, [](Scene& of) -> double& { return of.sections[0].rotary_inertia[1]; }),
          of_section("body", 0.5, [](Scene& of) -> double& { return of.point_masses[0].mass; }),
          of_section("inertia of the body", 0.03, [](Scene& of) -> double& { return of.point_masses[0].inertia[0]; }),
          of_section("velocity", 4.0, [](Scene& of) -> double& { return of.rotating_frames[0].velocity[2]; }),
          of_section("place of the axis", 0.5, [](Scene& of) -> double& { return of.rotating_frames[0].point[1]; })};
}

/// Under followers, and of rigid sections under dead loads.
TEST(Gradients, InARotatingFrame) {
  Scene rigid = elastica(2.0, 2, 2);
  rigid.sections[0].bending_stiffness = {30.0, 20.0};
  rigid.sections[0].torsional_stiffness = 40.0;
  for (const Scene& still : {cantilever_of_followers(), rigid}) {
    const Scene scene = in_rotating_frame(still);
    expect_as_differences(scene, usual("tip", scene.members[0].name, {scene.supports[0].point}), of_frame(scene));
  }
}

/// The state of the frame that turns, with the tangent at rest.
TEST(Gradients, TangentWithoutTheFrameFails) {
  const Scene scene = in_rotating_frame(cantilever_of_followers());
  const Simulation simulation = polished(scene);
  const double wanted = difference_by_bending(scene);
  Scene at_rest = scene;
  at_rest.rotating_frames.clear();
  EXPECT_LT(std::abs(slope_by_bending(scene, simulation, true) / wanted - 1.0), kOfDifferences);
  EXPECT_GT(std::abs(slope_by_bending(at_rest, simulation, true) / wanted - 1.0), kNotTransposed);
}

/// Joints of every kind, supports and springs along general axes, a follower: numbers of all of them.
TEST(Gradients, OfAPortalOfJoints) {
  const Scene scene = portal_of_joints(2, 2);
  std::vector<Parameter> parameters = {
      of_force(scene, 1, 1, 0.05),
      of_moment(scene, 2, 2, 0.05),
      of_force(scene, 3, 1, 0.05),
      of_place(scene, 2, 1, 0.02),
      of_place(scene, 5, 2, 0.02),
      of_number("hinge", scene, 0.3, [](Scene& of) -> double& { return of.joints[0].stiffness; }),
      of_number("slider", scene, 1.2, [](Scene& of) -> double& { return of.joints[3].stiffness; }),
      of_number("support", scene, 4.0, [](Scene& of) -> double& { return of.supports[1].displacement_stiffness[1]; }),
      of_number("turning", scene, 1.4, [](Scene& of) -> double& { return of.supports[1].rotation_stiffness[2]; })};
  for (const int i : {0, 3, 5}) parameters.push_back(of_stiffness(scene, i, kStep));
  expect_as_differences(scene, usual("C", "arm", {"A", "E"}), parameters);
}

/// A frame in a plane of rigid members whose ends are moved: forces are shared by stiffness.
TEST(Gradients, OfAFrameWithRigidMembers) {
  Scene scene = angle_frame(4);
  scene.sections[0] = section(kRigid, kRigid, 2.0, 3.0);
  scene.sections.push_back(section(50.0, 40.0, 1.0, 2.0));
  scene.sections[1].name = "soft";
  scene.points.push_back({"far", {2.1, -0.8, 0}});
  scene.members.push_back(line("brace", "tip", "far", 2, 3));
  scene.members.back().section = "soft";
  scene.supports.push_back(clamp("far"));
  scene.supports[2].prescribed_displacement = {0.05, -0.1, 0};
  scene.supports[2].prescribed_rotation = {0, 0, 0.2};
  scene.eigenstrains = {{"leg", {0.01, 0, 0}, {0, 0, 0.1}}};
  expect_as_differences(
      scene, usual("tip", "leg", {"far", "foot"}),
      {of_force(scene, 0, 1, 0.02), of_place(scene, 1, 0, 0.005), of_place(scene, 2, 1, 0.005),
       of_stiffness(scene, 4, kStep), of_stiffness(scene, 5, kStep),
       of_number("soft EA", scene, 1.0, [](Scene& of) -> double& { return of.sections[1].axial_stiffness; }),
       of_number("motion", scene, 0.002,
                 [](Scene& of) -> double& { return of.supports[2].prescribed_displacement[1]; }),
       of_number("turn", scene, 0.004, [](Scene& of) -> double& { return of.supports[2].prescribed_rotation[2]; }),
       of_number("heat", scene, 0.001, [](Scene& of) -> double& { return of.eigenstrains[0].strain[0]; }),
       of_number("bow", scene, 0.002, [](Scene& of) -> double& { return of.eigenstrains[0].curvature[2]; })});
}

/// A state in a plane: its own tangent where a quantity stays in it, that in space for all others.
TEST(Gradients, OutOfThePlane) {
  Scene scene = cantilever(section(1e3, 6e2, 80.0, 100.0), 1.0, 3, 4);
  scene.name = "plane";
  scene.sections[0].bending_stiffness = {70.0, 100.0};
  scene.members[0].second_axis = {0, 1, 0};
  scene.point_loads = {dead_load("tip", {-20, 60, 0}, {0, 0, 30})};
  expect_as_differences(
      scene, usual("tip", "beam", {"clamp"}),
      with_stiffnesses({of_force(scene, 0, 1, 0.6), of_force(scene, 0, 2, 0.6), of_moment(scene, 0, 0, 0.6),
                        of_place(scene, 1, 0, 0.01), of_place(scene, 1, 2, 0.01)},
                       scene));
}

/// A taper and a coupled section in space, with a clamp that turns.
TEST(Gradients, OfCoupledAndTaperedMembers) {
  Scene scene = fork(2, 2);
  scene.name = "general sections";
  scene.point_loads[0].force = {3, 10, 30};
  scene.point_loads[1].force = {-5, 15, -20};
  scene.sections.push_back(section(5e3, 4e3, 60, 50));
  scene.sections[1].name = "thin";
  scene.sections.push_back(section(1e4, 8e3, 70, 90));
  scene.sections[2].name = "coupled";
  Matrix6 matrix{};
  for (int i = 0; i < 6; ++i) matrix[i][i] = diagonal(scene.sections[2])[i];
  matrix[0][4] = matrix[4][0] = 200.0;
  matrix[3][5] = matrix[5][3] = 20.0;
  scene.sections[2].matrix = matrix;
  scene.members[0].end_section = "thin";
  scene.members[1].section = "coupled";
  scene.supports[0].prescribed_rotation = {0.1, 0.3, -0.2};
  const Parameter coupling = {"coupling", 200.0, 4.0, [](Scene& changed, double value) {
                                (*changed.sections[2].matrix)[0][4] = (*changed.sections[2].matrix)[4][0] = value;
                              }};
  expect_as_differences(
      scene, usual("tine 1", "shaft", {"clamp"}),
      with_stiffnesses(
          {of_force(scene, 0, 2, 0.3), of_place(scene, 0, 2, 0.01), coupling,
           of_number("thin EI2", scene, 1.0, [](Scene& of) -> double& { return of.sections[1].bending_stiffness[0]; }),
           of_number("turn", scene, 0.006, [](Scene& of) -> double& { return of.supports[0].prescribed_rotation[1]; })},
          scene));
}

}  // namespace
}  // namespace mixbeam::test
