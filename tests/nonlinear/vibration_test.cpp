// Natural frequencies against closed forms and against each other.
#include "nonlinear/stability/vibration.hpp"

#include "discretization/geometry/isometry.hpp"
#include "discretization/scene/section_law.hpp"
#include "kernels/execution/execution_space.hpp"
#include "tests/nonlinear/stability_fixture.hpp"
#include "tests/support/buckling_scenes.hpp"
#include "tests/support/same_bits.hpp"

namespace mixbeam::test {
namespace {

/// Twice the discretization errors of omega^2 that a prototype with dense eigenvalues has, k = 4.
constexpr double kColumn = 1e-10, kBent = 2e-9;
/// The same of the second mode of a column, which has twice the waves: 2^8 times as much.
constexpr double kSecondOfColumn = 5e-8;
/// Flexibility of stiffnesses of 1e10 and 1e12 beside bending ones of 1, and of 1e8 beside torsion.
constexpr double kNearlyRigid = 1e-9, kNearlyStraight = 1e-6;
/// Rounding of omega^2 in tangents with a cap, of the same structure elsewhere or in other units.
constexpr double kSame = 1e-10;

std::vector<double> squares(const std::vector<VibrationMode>& modes) {
  std::vector<double> values;
  for (const VibrationMode& mode : modes) {
    EXPECT_TRUE(mode.pair.converged) << "not confirmed by the inertia";
    values.push_back(mode.pair.eigenvalue);
  }
  return values;
}

/// About the equilibrium at a load factor.
std::vector<double> squares_at(const Scene& scene, double load_factor, int count, bool in_plane = true,
                               const Communicator& communicator = this_rank()) {
  constexpr int kSteps = 20;
  StabilityFixture at(scene, communicator);
  for (int i = 1; i < kSteps; ++i) at.equilibrium(load_factor * i / kSteps);
  return squares(vibration_modes(at.problem(), at.equilibrium(load_factor), load_factor, count, in_plane));
}

Scene with_mass(Scene scene) {
  for (Section& section : scene.sections) section.mass = 1.0;
  return scene;
}

void expect_squares(const std::vector<double>& found, const std::vector<double>& expected, double tolerance) {
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], tolerance * std::abs(expected[i])) << i;
}

/// Where each of Euler's columns buckles, by its own law of load and frequency, omega is zero.
TEST(Vibration, FrequenciesVanishWhereColumnsBuckle) {
  constexpr double kVanishes = 1e-8;  // of omega^2 without load
  for (const ColumnEnds& ends : euler_columns()) {
    const Scene scene = with_mass(column(4, 16, ends.supports));
    const double still = squares_at(scene, 0.0, 1)[0];
    EXPECT_NEAR(squares_at(scene, ends.critical, 1)[0], 0.0, kVanishes * still) << ends.name;
    EXPECT_GT(std::abs(squares_at(scene, (1.0 - 1e-6) * ends.critical, 1)[0]), 10.0 * kVanishes * still) << ends.name;
  }
}

/// Beyond its critical load the column has one negative omega^2.
TEST(Vibration, UnstableStatesHaveNegativeSquares) {
  const Scene scene = with_mass(column(4, 8, euler_columns()[2].supports));
  expect_squares(squares_at(scene, 2.0 * kPi * kPi, 2), {-std::pow(kPi, 4), 8.0 * std::pow(kPi, 4)}, kSecondOfColumn);
}

/// A cantilever bent by a dead force of 10 EI/L^2 across; by shooting.
TEST(Vibration, BentCantilever) {
  Scene scene = with_mass(elastica(10.0, 4, 16));
  const std::vector<double> found = squares_at(scene, 1.0, 3);
  expect_squares(found, {7.20499191 * 7.20499191, 23.43330185 * 23.43330185, 57.21045629 * 57.21045629}, kBent);
}

TEST(Vibration, CapOfRigidSectionsIsTakenOut) {
  Scene scene = with_mass(elastica(10.0, 3, 4));
  const std::vector<double> rigid = squares_at(scene, 1.0, 3);
  scene.sections[0].axial_stiffness = 1e12;
  scene.sections[0].shear_stiffness = {1e12, 1e12};
  expect_squares(squares_at(scene, 1.0, 3), rigid, kNearlyRigid);
}

/// A mass that shares the load with stiff members by their stiffness: two rods in a row clamped at their far ends, EA
/// far above the cap; omega^2 = 2 EA / (L/2) / m, and 192 EI / L^3 / m across.
TEST(Vibration, ForcesSharedByStiffness) {
  constexpr double kAxial = 1e10;
  Scene scene = jointed_column(1.0, 2, 2);
  scene.joints.clear();
  scene.point_loads.clear();
  scene.sections[0].axial_stiffness = kAxial;
  scene.supports = {clamp("clamp"), clamp("tip")};
  scene.point_masses = {{"middle", 1.0}};
  expect_squares(squares_at(scene, 0.0, 2), {192.0, 4.0 * kAxial}, kNearlyRigid);
}

TEST(Vibration, AMassThatCannotMoveHasNoMode) {
  Scene scene = column(2, 3);
  scene.point_masses = {{"clamp", 1.0}};
  EXPECT_TRUE(squares_at(scene, 0.0, 2, false).empty());
}

/// Turned about an arbitrary axis, shifted, and in other units.
TEST(Vibration, SameInAnyPlaceAndUnits) {
  Scene scene = with_mass(column(3, 5));
  scene.sections[0].rotary_inertia = {0.02, 0.01, 0.01};
  scene.sections[0].mass_offset = {0.03, -0.02};
  scene.sections[0].axial_stiffness = 1e3;
  scene.sections[0].shear_stiffness = {5e2, 4e2};
  scene.point_loads = {dead_load("tip", {-0.5, 3.0, 1.0})};
  scene.point_masses = {{"tip", 0.2, {0.01, 0.02, 0.025}}};
  const std::vector<double> here = squares_at(scene, 1.0, 6, false);
  Scene turned = scene;
  const Isometry motion = Isometry::rotation({0.3, 0.1, -0.2}, {1, -2, 0.5}, 1.1);
  for (Point& point : turned.points) point.position = motion.position(point.position);
  for (Member& member : turned.members) member.second_axis = motion.direction(member.second_axis);
  for (PointLoad& load : turned.point_loads) load.force = motion.direction(load.force);
  for (PointMass& body : turned.point_masses)
    for (Vector3& axis : body.axes) axis = motion.direction(axis);
  expect_squares(squares_at(turned, 1.0, 6, false), here, kSame);
  constexpr double kLength = 1e3, kForce = 1e-2;  // and the unit of time as it was
  Scene scaled = scene;
  for (Point& point : scaled.points) scene_change::scale(point.position, kLength);
  for (Section& section : scaled.sections) {
    scene_change::scale_section(section, kLength, kForce);
    section.mass *= kForce / (kLength * kLength);
    for (double& inertia : section.rotary_inertia) inertia *= kForce;
    for (double& offset : section.mass_offset) offset *= kLength;
  }
  for (PointLoad& load : scaled.point_loads) scene_change::scale(load.force, kForce);
  for (PointMass& body : scaled.point_masses) {
    body.mass *= kForce / kLength;
    scene_change::scale(body.inertia, kForce * kLength);
  }
  expect_squares(squares_at(scaled, 1.0, 6, false), here, kSame);
}

/// Twist of a rod whose centre of mass is off its axis: J + m c^2 turns.
TEST(Vibration, CentreOfMassBesideTheAxis) {
  Scene scene = with_mass(column(4, 8));
  scene.sections[0].bending_stiffness = {1e8, 1e8};
  scene.sections[0].rotary_inertia = {0.3, 0.2, 0.1};
  scene.sections[0].mass_offset = {0.4, 0.5};
  const double inertia = 0.3 + 0.16 + 0.25;
  EXPECT_NEAR(squares_at(scene, 0.0, 1, false)[0], 0.25 * kPi * kPi / inertia, kNearlyStraight);
}

/// All modes together take part with all of the mass, along every axis; a free structure has six rigid ones.
TEST(Vibration, AllModesTakeAllOfTheMass) {
  Scene scene = with_mass(column(1, 2));
  scene.supports.clear();
  scene.sections[0].axial_stiffness = 1e3;
  scene.sections[0].shear_stiffness = {5e2, 4e2};
  scene.sections[0].rotary_inertia = {0.02, 0.01, 0.01};
  scene.sections[0].mass_offset = {0.1, 0.2};
  scene.point_masses = {{"tip", 0.5}};
  BeamProblem problem(scene, this_rank(), {});
  const std::vector<VibrationMode> modes = vibration_modes(problem, problem.model.reference_state(), 0.0, 100);
  EXPECT_EQ(modes.size(), 15u);  // three vertices that move, two elements that turn
  Vector3 sum{};
  for (const VibrationMode& mode : modes)
    for (int i = 0; i < 3; ++i) sum[i] += mode.participation[i] * mode.participation[i] * mode.modal_mass;
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(sum[i], 1.5, kSame);
  for (int i = 0; i < 6; ++i) EXPECT_LT(std::abs(modes[i].pair.eigenvalue), 1e-12 * modes[6].pair.eigenvalue);
}

/// One half has momenta of spins, of nothing that counts; momenta that the other does not have are none of its own.
TEST(Vibration, MembersWithAndWithoutRotaryInertia) {
  Scene scene = with_mass(jointed_column(2.0, 4, 4));
  scene.point_loads.clear();
  const std::vector<double> plain = squares_at(scene, 0.0, 6, false);
  scene.sections.push_back(scene.sections[0]);
  scene.sections[1].name = scene.members[1].section = "turning";
  scene.sections[1].rotary_inertia = {2e-30, 1e-30, 1e-30};
  expect_squares(squares_at(scene, 0.0, 6, false), plain, kSame);
  scene.members[1].order = 5;
  expect_squares(squares_at(scene, 0.0, 2, false), {plain[0], plain[1]}, kNearlyStraight);
}

/// A body between two joined halves, and elements with a matrix in place of six stiffnesses.
TEST(Vibration, JointsAndGeneralSections) {
  Scene scene = with_mass(jointed_column(2.0, 4, 4));
  scene.point_loads.clear();
  const std::vector<double> plain = squares_at(scene, 0.0, 4, false);
  Section& section = scene.sections[0];
  section.matrix.emplace();
  const auto values = diagonal(section);
  for (int i = 0; i < 6; ++i) (*section.matrix)[i][i] = i < 3 ? 1.0 : values[i];  // rigid ones do not count
  expect_squares(squares_at(scene, 0.0, 4, false), plain, kSame);
}

/// Hinge with a spring c in the middle of a hinged beam that carries a body there: a force F there bends the halves and
/// turns the joint by M/c, M = F/4, which moves it by M/(4 c).
TEST(Vibration, BodyOnAJoint) {
  constexpr double kSpring = 2.0, kMass = 3.0;
  Scene scene = jointed_column(kSpring, 4, 4);
  scene.point_loads.clear();
  scene.point_masses = {{"middle", kMass}};
  const double compliance = 1.0 / 48.0 + 1.0 / (16.0 * kSpring);
  EXPECT_NEAR(squares_at(scene, 0.0, 1)[0], 1.0 / (kMass * compliance), kNearlyRigid);
}

TEST(Vibration, SameBitsWithAnyNumberOfThreads) {
  Scene scene = with_mass(elastica(3.0, 2, 40));
  scene.sections[0].rotary_inertia = {0.02, 0.01, 0.01};
  const int before = number_of_threads();
  std::vector<std::vector<double>> found;
  for (int threads : {1, 2, 4}) {
    set_number_of_threads(threads);
    found.push_back(squares_at(scene, 1.0, 5, false));
  }
  set_number_of_threads(before);
  EXPECT_TRUE(same_bits(found[0], found[1]));
  EXPECT_TRUE(same_bits(found[0], found[2]));
}

/// K + s C + s^2 M = 0 with C = alpha M + beta K about a state without stress: s^2 + (alpha + beta omega^2) s + omega^2
/// = 0 for each frequency without damping.
TEST(Vibration, RayleighDampingOfAStraightColumn) {
  constexpr double kAlpha = 0.3, kBeta = 1e-3;
  Scene scene = with_mass(column(4, 8, euler_columns()[2].supports));
  scene.point_loads.clear();
  BeamProblem free(scene, this_rank(), {});
  const std::vector<double> squared = squares(vibration_modes(free, free.model.reference_state(), 0.0, 2, true));
  scene.sections[0].mass_damping = kAlpha;
  scene.sections[0].stiffness_damping = kBeta;
  BeamProblem damped(scene, this_rank(), {});
  const std::vector<VibrationMode> modes = vibration_modes(damped, damped.model.reference_state(), 0.0, 2, true);
  ASSERT_EQ(modes.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    const double decay = 0.5 * (kAlpha + kBeta * squared[i]);
    EXPECT_NEAR(modes[i].rate.real(), -decay, kSame * decay);
    EXPECT_NEAR(modes[i].rate.imag(), std::sqrt(squared[i] - decay * decay), kSame * std::sqrt(squared[i]));
    EXPECT_GT(std::abs(modes[i].rate.imag() - std::sqrt(squared[i])), 1e3 * kSame * std::sqrt(squared[i]));
  }
}

/// In a frame that turns about e3, its root at a distance from the axis.
Scene rotating(Scene scene, double velocity, double hub = 0.0) {
  scene.point_loads.clear();
  scene.rotating_frames = {{{-hub, 0, 0}, {0, 0, velocity}}};
  return scene;
}
Scene rotating_cantilever(double velocity, double hub = 0.0) {
  Scene scene = rotating(with_mass(column(4, 16)), velocity, hub);
  scene.sections[0].bending_stiffness = {1.0, 1.0};
  return scene;
}

/// An inextensible blade, EI = m = L = 1, by power series to 13 digits: flap 1 to 3 and the first lag. Of lag and flap
/// modes omega^2 differs by Omega^2.
TEST(Vibration, RotatingCantilever) {
  constexpr double kTable = 2e-9;  // of omega^2
  struct Row {
    double velocity, hub;
    std::array<double, 3> flap;
    double lag;
  };
  for (const Row& row : {Row{1, 0, {3.681646813958, 22.181011150583, 61.84176258716}, 3.5432362696731},
                         Row{4, 0, {5.5850014208848, 24.273349394449, 63.966760493115}, 3.8977225236393},
                         Row{4, 1, {7.4750477921146, 26.95726167155, 66.986772300623}, 6.3147715314489}}) {
    const std::vector<double> found = squares_at(rotating_cantilever(row.velocity, row.hub), 1.0, 6, false);
    ASSERT_EQ(found.size(), 6u);
    for (size_t i = 0; i < 3; ++i) {
      const double flap = row.flap[i] * row.flap[i];
      EXPECT_NEAR(found[2 * i + 1], flap, kTable * flap);
      EXPECT_NEAR(found[2 * i], flap - row.velocity * row.velocity, kTable * flap);
    }
    EXPECT_NEAR(found[0], row.lag * row.lag, kTable * row.lag * row.lag);
  }
}

/// Inertia turns cross sections into the plane of the motion: omega^2 J1 = GIt (pi / 2)^2 + Omega^2 (J3 - J2), of a rod
/// without mass on a body with such inertia GIt + Omega^2 (J3 - J2).
TEST(Vibration, CentrifugalCouplesOnRotaryInertia) {
  constexpr double kVelocity = 2.0, kTwist = 0.3, kMore = 0.5 * kTwist * kVelocity * kVelocity;
  Scene scene = rotating(with_mass(column(4, 8)), kVelocity);
  scene.sections[0].bending_stiffness = {kRigid, kRigid};  // else Coriolis forces couple twist and bending
  scene.sections[0].torsional_stiffness = kTwist;
  scene.sections[0].rotary_inertia = {1.0, 0.25 * (1.0 - kTwist) + 0.25, 0.25 * (1.0 + kTwist) + 0.25};
  const double expected = kTwist * 0.25 * kPi * kPi + kMore;
  EXPECT_NEAR(squares_at(scene, 1.0, 1, false)[0], expected, kSame * expected);
  scene.point_masses = {{"tip", 1.0, scene.sections[0].rotary_inertia}};
  scene.sections[0].mass = 0.0;
  scene.sections[0].rotary_inertia = {};
  EXPECT_NEAR(squares_at(scene, 1.0, 1, false)[0], kTwist + kMore, kSame);
}

/// A body on a rod without mass, which its force T = m Omega^2 L makes stiffer: T / (1 - tanh(mu) / mu), mu^2 = T / EI.
TEST(Vibration, RotatingBody) {
  constexpr double kVelocity = 3.0, kBody = 0.7;
  Scene scene = rotating(column(4, 16), kVelocity);
  scene.sections[0].bending_stiffness = {1.0, 1.0};
  scene.point_masses = {{"tip", kBody}};
  const double force = kBody * kVelocity * kVelocity, mu = std::sqrt(force);
  const double flap = force / (1.0 - std::tanh(mu) / mu) / kBody;
  expect_squares(squares_at(scene, 1.0, 2, false), {flap - kVelocity * kVelocity, flap}, kColumn);
}

/// A thin rod as a body, whose moments of inertia across rounding keeps apart: as without it.
TEST(Vibration, RotatingRodAsABody) {
  std::vector<VibrationMode> modes;
  for (const double rounded : {1.0, 1.0 + 5e-10}) {
    Scene scene = rotating_cantilever(1.0);
    scene.point_masses = {{"tip", 0.7, {0.0, 0.01, 0.01 * rounded}}};
    StabilityFixture at(scene);
    modes.push_back(vibration_modes(at.problem(), at.equilibrium(1.0), 1.0, 1)[0]);
  }
  EXPECT_NEAR(modes[1].rate.imag(), modes[0].rate.imag(), kNearlyRigid);
}

/// Coriolis forces move the lag mode of a blade that stretches; first lag at Omega = 4 by shooting, without them
/// 3.879841178, 3.895935284, 3.897704651.
TEST(Vibration, CoriolisForcesOnBladesThatStretch) {
  constexpr double kDigits = 1e-9;  // of the values
  for (const auto& [stiffness, lag, without] : {std::array<double, 3>{1e3, 3.832944802, 3.879841178},
                                                {1e4, 3.891203607, 3.895935284},
                                                {1e6, 3.897657289, 3.897704651}}) {
    Scene scene = rotating_cantilever(4.0);
    scene.sections[0].axial_stiffness = stiffness;
    StabilityFixture at(scene);
    const std::vector<VibrationMode> modes = vibration_modes(at.problem(), at.equilibrium(1.0), 1.0, 1);
    EXPECT_NEAR(modes[0].rate.imag(), lag, kDigits);
    EXPECT_GT(std::abs(modes[0].rate.imag() - without), 1e3 * kDigits);
    EXPECT_LT(std::abs(modes[0].rate.real()), kDigits);
  }
}

/// A heavy spot on a shaft without mass, alike in all directions across, in the frame of the shaft: omega_0 -+ Omega,
/// which Coriolis forces hold where the stiffness omega_0^2 - Omega^2 of both motions is negative (de Laval).
TEST(Vibration, CoriolisForcesHoldAShaftBeyondItsCriticalSpeed) {
  constexpr double kDigits = 1e-8;
  for (const double ratio : {0.5, 2.5}) {
    Scene scene = column(4, 8, euler_columns()[4].supports);
    scene.points.push_back({"middle", {0.5, 0, 0}});
    scene.members = {line("left", "clamp", "middle", 4, 4), line("right", "middle", "tip", 4, 4)};
    scene.sections[0].bending_stiffness = {1.0, 1.0};
    scene.point_masses = {{"middle", 1.0}};
    scene.point_loads.clear();
    const double still = std::sqrt(192.0);
    scene.rotating_frames = {{{0, 0, 0}, {ratio * still, 0, 0}}};
    StabilityFixture at(scene);
    const std::vector<VibrationMode> modes = vibration_modes(at.problem(), at.equilibrium(1.0), 1.0, 2);
    ASSERT_EQ(modes.size(), 2u);
    EXPECT_NEAR(modes[0].rate.imag(), std::abs(1.0 - ratio) * still, kDigits * still);
    EXPECT_NEAR(modes[1].rate.imag(), (1.0 + ratio) * still, kDigits * still);
    EXPECT_EQ(at.count(1.0).negative, ratio > 1.0 ? 2 : 0);
    for (const VibrationMode& mode : modes) EXPECT_LT(std::abs(mode.rate.real()), kDigits * still);
  }
}

TEST(Vibration, RefusesWhatHasNoMass) {
  BeamProblem massless(column(2, 2), this_rank(), {});
  EXPECT_THROW(vibration_modes(massless, massless.model.reference_state(), 0.0, 1), InputError);
}

/// A bent cantilever in space with a body at its tip.
TEST(MpiVibration, TheSameOnAnyNumberOfRanks) {
  Scene scene = with_mass(elastica(10.0, 3, 7));
  scene.point_masses = {{"tip", 0.2, {0.01, 0.02, 0.025}}};
  expect_squares(squares_at(scene, 1.0, 6, false, all_ranks()), squares_at(scene, 1.0, 6, false), kSame);
}

TEST(MpiVibration, DampedTheSameOnAnyNumberOfRanks) {
  Scene scene = with_mass(column(4, 8, euler_columns()[2].supports));
  scene.sections[0].mass_damping = 0.3;
  scene.sections[0].stiffness_damping = 1e-3;
  BeamProblem together(scene, all_ranks(), {}), alone(scene, this_rank(), {});
  const std::vector<VibrationMode> here = vibration_modes(together, together.model.reference_state(), 0.0, 2),
                                   there = vibration_modes(alone, alone.model.reference_state(), 0.0, 2);
  ASSERT_EQ(here.size(), there.size());
  for (size_t i = 0; i < there.size(); ++i)
    EXPECT_LT(std::abs(here[i].rate - there[i].rate), kSame * std::abs(there[i].rate)) << i;
}

}  // namespace
}  // namespace mixbeam::test
