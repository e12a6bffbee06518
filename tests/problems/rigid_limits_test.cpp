// Every scene of the gallery with sections as slender as one likes, up to those that do not stretch or shear at all:
// the answer tends to the rigid one with the inverse square of the slenderness, in as many iterations, and balances.
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/scene/load_cases.hpp"
#include "tests/support/solve.hpp"

#include <filesystem>

namespace mixbeam::test::rigid_limits_test {
namespace {

// Two answers to a scaled residual of 1e-11, relative to the size of the structure.
constexpr double kSameSolution = 1e-10;
// Terms of the next order at a slenderness of 1000 (hanging cables stretch by percents there).
constexpr double kNextOrder = 0.1;
constexpr double kMostImbalance = 1e-10;
constexpr int kIterationsMoreOrLess = 2;
// Closed frames of exactly rigid bars find their forces by the capped tangent alone (newton/step.hpp), which
// the dome feels: 10 iterations in place of 4.
constexpr int kIterationsOfClosedRigidFrames = 6;

enum class Stiff { axial, shear, both };

struct SceneToStiffen {
  Scene scene;
  SolverParameters solver;
};

/// The first load case of a scene that has several.
SceneToStiffen read_scene_to_stiffen(const std::string& name) {
  const XmlParameters xml = read_parameters(MIXBEAM_SOURCE_DIR "/apps/gallery/" + name + ".xml", {});
  SceneToStiffen read{read_scene(xml.list->sublist("Scene"), xml.source),
                      read_solver_parameters(xml.list->sublist("Solver"), xml.source)};
  read.solver.analysis = read_analysis_parameters(xml.list->sublist("Analysis"), read.scene, xml.source);
  if (!read.scene.load_cases.empty()) read.scene = scene_of_case(read.scene, read.scene.load_cases.front());
  return read;
}

/// What a slenderness s = L/h of a solid section makes of EA and GA beside the largest EI of the section: 12 EI s^2/L^2
/// and 5 EI s^2/L^2; infinite: rigid. `rigid`: which of the two are rigid whatever s is.
Section stiffened(Section section, double length, double slenderness, Stiff rigid) {
  double bending = std::max(section.bending_stiffness[0], section.bending_stiffness[1]);
  if (section.matrix) bending = std::max((*section.matrix)[4][4], (*section.matrix)[5][5]);
  const double unit = bending * slenderness * slenderness / (length * length);
  section.shape.reset();
  section.axial_stiffness = rigid == Stiff::axial ? kRigid : 12.0 * unit;
  section.shear_stiffness.fill(rigid == Stiff::shear ? kRigid : 5.0 * unit);
  if (!section.matrix) return section;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 6; ++j) (*section.matrix)[i][j] = (*section.matrix)[j][i] = 0.0;
  const double finite = std::isinf(unit) ? bending : unit;  // beside an infinity above it says nothing
  (*section.matrix)[0][0] = 12.0 * finite;
  (*section.matrix)[1][1] = (*section.matrix)[2][2] = 5.0 * finite;
  return section;
}

Scene stiffened(Scene scene, double slenderness, Stiff rigid) {
  const double length = characteristic_length(build_mesh(scene));
  for (Section& section : scene.sections) section = stiffened(section, length, slenderness, rigid);
  return scene;
}

struct Stiffened {
  LoadPathResult result;
  std::vector<Vector3> displacement;  ///< of every point over the size of the structure
  std::vector<double> critical;       ///< load factors of critical points
  double imbalance = 0.0;
};

Stiffened solve_stiffened(const SceneToStiffen& read, double slenderness, Stiff rigid) {
  Simulation simulation(stiffened(read.scene, slenderness, rigid), read.solver, this_rank());
  Stiffened answer;
  answer.result = simulation.run([&](const StepReport& report, const State&) {
    const Balance balance = simulation.balance();
    answer.imbalance = std::max({answer.imbalance, balance.force_error, balance.moment_error});
    for (const CriticalPoint& point : report.critical_points) answer.critical.push_back(point.load_factor);
  });
  const Mesh& mesh = simulation.model().mesh();
  for (const auto& [point, vertex] : mesh.vertex_of_point) {
    answer.displacement.push_back(simulation.displacement(point));
    for (double& u : answer.displacement.back()) u /= characteristic_length(mesh);
  }
  return answer;
}

double difference(const Stiffened& a, const Stiffened& b) {
  double largest = 0.0;
  for (size_t i = 0; i < a.displacement.size(); ++i)
    largest = std::max(largest, distance(a.displacement[i], b.displacement[i]));
  return largest;
}

void expect_solved(const Stiffened& answer) {
  EXPECT_TRUE(answer.result.finished) << answer.result.failure;
  EXPECT_LE(answer.imbalance, kMostImbalance);
}

/// The path and what was found on it.
void expect_same_path(const Stiffened& answer, const Stiffened& rigid, int stages) {
  ASSERT_EQ(answer.critical.size(), rigid.critical.size());
  for (size_t i = 0; i < rigid.critical.size(); ++i)
    EXPECT_NEAR(answer.critical[i], rigid.critical[i], 1e-7 * std::abs(rigid.critical[i]));
  if (rigid.result.steps > stages) return;
  EXPECT_EQ(answer.result.steps, rigid.result.steps);
  EXPECT_LE(answer.result.newton_iterations, rigid.result.newton_iterations + kIterationsMoreOrLess);
  EXPECT_GE(answer.result.newton_iterations, rigid.result.newton_iterations - kIterationsOfClosedRigidFrames);
}

class RigidLimits : public testing::TestWithParam<const char*> {};

TEST_P(RigidLimits, AreApproachedWithTheSquareOfTheSlenderness) {
  const SceneToStiffen read = read_scene_to_stiffen(GetParam());
  const Stiffened rigid = solve_stiffened(read, kRigid, Stiff::both);
  expect_solved(rigid);
  for (const Stiff kind : {Stiff::both, Stiff::axial, Stiff::shear}) {
    double at_thousand = 0.0;
    for (const double slenderness : {1e3, 1e4, 1e8, 1e12}) {
      SCOPED_TRACE("rigid: " + std::to_string(static_cast<int>(kind)) + ", slenderness " + std::to_string(slenderness));
      const Stiffened slender = solve_stiffened(read, slenderness, kind);
      expect_solved(slender);
      if (slenderness == 1e3) at_thousand = difference(slender, rigid);
      const double expected = at_thousand * 1e6 / (slenderness * slenderness);
      EXPECT_NEAR(difference(slender, rigid), expected, kNextOrder * expected + kSameSolution);
      if (slenderness > 1e4) expect_same_path(slender, rigid, read.scene.stages);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Gallery, RigidLimits,
                         testing::Values("bistable_strip", "catenary", "coil_spring", "composite_cantilever",
                                         "deployable_ring", "elastica", "follower_cantilever", "gripper", "honeycomb",
                                         "lateral_buckling", "lees_frame", "parallel_linkage", "shallow_arch",
                                         "snap_back", "star_dome", "tree", "twisted_blade"),
                         [](const auto& scene) { return std::string(scene.param); });

// The twin that must fail: what a slenderness of 100 adds is seen, and so is the step from 1000 to 10000.
TEST(RigidLimitsTwin, SlendernessIsSeen) {
  const SceneToStiffen read = read_scene_to_stiffen("honeycomb");
  const Stiffened rigid = solve_stiffened(read, kRigid, Stiff::both);
  const double hundred = difference(solve_stiffened(read, 1e2, Stiff::both), rigid);
  const double thousand = difference(solve_stiffened(read, 1e3, Stiff::both), rigid);
  EXPECT_GT(thousand, 100.0 * kSameSolution);
  EXPECT_GT(std::abs(hundred - thousand), kNextOrder * thousand + kSameSolution);
}

// Ropes held at both ends are tightened by a strain that only stretching can take up (the net has a state of tension of
// its own, and the work of that tension in the strain is not zero): the tension grows with EA, and there is no limit.
TEST(RigidLimitsOfTheCableNet, DoNotExist) {
  const SceneToStiffen read = read_scene_to_stiffen("cable_net");
  const auto largest_reaction = [&](double slenderness) {
    const Simulation net = solved(stiffened(read.scene, slenderness, Stiff::shear), read.solver);
    double largest = 0.0;
    for (const Reaction& reaction : net.reactions()) largest = std::max(largest, largest_component(reaction.force));
    return largest;
  };
  constexpr double kOtherLoads = 0.01;  // snow, and the bending of the ropes
  EXPECT_NEAR(largest_reaction(1e7) / largest_reaction(1e6), 100.0, 100.0 * kOtherLoads);
  const Stiffened rigid = solve_stiffened(read, kRigid, Stiff::both);
  ASSERT_FALSE(rigid.result.finished);
  ASSERT_TRUE(rigid.result.report.has_value());
  EXPECT_EQ(rigid.result.report->cause, FailureCause::incompatible);
  EXPECT_EQ(rigid.result.report->next.front().kind, AdviceKind::finite_stiffness);
  EXPECT_NE(rigid.result.failure.find("\"EA\""), std::string::npos) << rigid.result.failure;
}

}  // namespace
}  // namespace mixbeam::test::rigid_limits_test
