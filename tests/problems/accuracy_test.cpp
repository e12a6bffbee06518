// What "Accuracy" promises: true errors below it, against closed forms and solutions on far finer meshes.
#include "discretization/scene_parameters.hpp"
#include "discretization/xml_reader.hpp"
#include "nonlinear/accurate_run.hpp"
#include "tests/problems/scenes.hpp"
#include "tests/problems/solve.hpp"

#include <algorithm>

namespace mixbeam::test {
namespace {

constexpr double kAccuracies[] = {1e-3, 1e-6, 1e-9};

Scene with_accuracy(Scene scene, double accuracy) {
  scene.accuracy = accuracy;
  return scene;
}

AccurateRun solved_accurately(const Scene& scene, bool keeps_path = false) {
  AccurateRun run = run_accurately(scene, {}, this_rank(), keeps_path);
  EXPECT_TRUE(run.simulation.result().finished) << run.simulation.result().failure;
  return run;
}

Scene bent_cantilever() {
  Scene scene = cantilever(section(kRigid, kRigid, 1.0, 1.0), 1.0, 1, 1);
  scene.point_loads = {dead_load("tip", {0, 10, 0})};
  return scene;
}

/// Elliptic integrals, F L^2 / EI = 10.
const Vector3 kElasticaTip = {-0.5549955977538, 0.8106090248803, 0.0};

double length(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }

/// Of the tip of the elastica, which moves furthest.
double elastica_error(const Simulation& beam) {
  return distance(beam.displacement("tip"), kElasticaTip) / length(kElasticaTip);
}

TEST(Accuracy, OfTheElastica) {
  for (const double accuracy : kAccuracies) {
    const AccurateRun run = solved_accurately(with_accuracy(bent_cantilever(), accuracy));
    EXPECT_EQ(run.end, AccuracyEnd::reached);
    EXPECT_LT(elastica_error(run.simulation), accuracy);
  }
}

/// Largest and root mean square distance of two solutions over the largest and root mean square displacement.
double error_against(const Simulation& fine, const Simulation& beam, const std::vector<std::string>& points) {
  constexpr int kPoints = 12;
  const auto there = [&](const PointSample& sample, int member) {
    const double length = fine.assembler().mesh().members[member].curve.length;
    return sample_member(fine.assembler(), fine.state(), member, sample.arc_length / length);
  };
  double largest = 0.0, error = 0.0;
  for (const std::string& point : points) {
    largest = std::max(largest, length(fine.displacement(point)));
    error = std::max(error, distance(fine.displacement(point), beam.displacement(point)));
  }
  const double mean = beam.l2_norm(kPoints, [&](const PointSample& sample, int member) {
    return sample.displacement - there(sample, member).displacement;
  });
  const double size = fine.l2_norm(kPoints, [](const PointSample& sample, int) { return sample.displacement; });
  return std::max(error / largest, mean / size);
}

TEST(Accuracy, OfTheArc) {
  const Simulation fine = solved(arc_segment(100.0, 8, 32));
  for (const double accuracy : kAccuracies) {
    const AccurateRun run = solved_accurately(with_accuracy(arc_segment(100.0, 1, 1), accuracy));
    EXPECT_EQ(run.end, AccuracyEnd::reached);
    EXPECT_LT(error_against(fine, run.simulation, {"tip"}), accuracy);
  }
}

// The twin: the mesh that is chosen where the estimate is made 1e4 times too small is not accurate enough.
TEST(Accuracy, NeedsAnHonestEstimate) {
  const Simulation fine = solved(arc_segment(100.0, 8, 32));
  const double accuracy = 1e-9, lie = 1e4;
  const AccurateRun run = solved_accurately(with_accuracy(arc_segment(100.0, 1, 1), lie * accuracy));
  EXPECT_GT(error_against(fine, run.simulation, {"tip"}), accuracy);
}

TEST(Accuracy, OfAKinkedFrame) {
  const Simulation fine = solved(slope_discontinuity(8, 24));
  for (const double accuracy : kAccuracies) {
    const AccurateRun run = solved_accurately(with_accuracy(slope_discontinuity(1, 1), accuracy));
    EXPECT_EQ(run.end, AccuracyEnd::reached);
    EXPECT_LT(error_against(fine, run.simulation, {"tip", "first corner", "second corner"}), accuracy);
  }
}

// The moment tells how far the rod turns.
TEST(Accuracy, OfARodThatTurnsALot) {
  const Simulation fine = solved(helical_rod(8, 48, 0.5));
  const AccurateRun run = solved_accurately(with_accuracy(helical_rod(1, 1, 0.5), 1e-5));
  EXPECT_EQ(run.end, AccuracyEnd::reached);
  EXPECT_LT(error_against(fine, run.simulation, {"tip"}), 1e-5);
}

// No load tells how far it turns, but the first step along the path does.
TEST(Accuracy, OfARodThatIsTwistedByItsSupport) {
  Scene rod = cantilever(section(1e4, 1e4, 1.0, 4.0), 1.0, 8, 32);
  rod.point_loads = {dead_load("tip", {0, 0.5, 0})};
  rod.supports.push_back(clamp("tip"));
  rod.supports.back().displacement_fixed = {};
  rod.supports.back().prescribed_rotation = {20.0, 0, 0};
  const Simulation fine = solved(rod);
  const AccurateRun run = solved_accurately(with_accuracy(rod, 1e-6));
  EXPECT_EQ(run.end, AccuracyEnd::reached);
  EXPECT_LT(error_against(fine, run.simulation, {"tip"}), 1e-6);
  EXPECT_EQ(run.rounds.front().remark, "elements turn too far");
  EXPECT_LT(run.rounds.front().steps, run.rounds.back().steps);
}

// Behind its limit points the load is small and the frame turned far: neither tells that elements would turn further.
TEST(Accuracy, OfAFrameThatSnapsBack) {
  const XmlParameters xml = read_xml(MIXBEAM_SOURCE_DIR "/apps/gallery/snap_back.xml");
  const Scene frame = read_scene(xml.list->sublist("Scene"), xml.source);
  SolverParameters solver;
  solver.analysis.stability = true;
  const AccurateRun run = run_accurately(with_accuracy(frame, 1e-6), solver, this_rank(), true);
  EXPECT_EQ(run.end, AccuracyEnd::reached);
  EXPECT_EQ(run.rounds.size(), 1u);  // its twin is OfARodThatIsTwistedByItsSupport, which takes two
}

TEST(Accuracy, MembersKeepTheirMesh) {
  Scene scene = with_accuracy(slope_discontinuity(2, 3), 1e-6);
  scene.members[0].keeps_order = scene.members[0].keeps_elements = true;
  scene.members[1].keeps_order = true;
  scene.members[2].keeps_elements = true;
  const AccurateRun run = solved_accurately(scene);
  const std::vector<Member>& members = run.simulation.scene().members;
  EXPECT_EQ(members[0].order, 2);
  EXPECT_EQ(members[0].elements, 3);
  EXPECT_EQ(members[1].order, 2);
  EXPECT_EQ(members[2].elements, 3);
  EXPECT_EQ(run.end, AccuracyEnd::kept_meshes);
  EXPECT_GT(run.rounds.back().error, 1e-6);
}

TEST(Accuracy, IsSaidToBeMissedWhereAllMembersKeepTheirMesh) {
  Scene scene = with_accuracy(bent_cantilever(), 1e-6);
  scene.members[0].keeps_order = scene.members[0].keeps_elements = true;
  const AccurateRun run = solved_accurately(scene);
  EXPECT_EQ(run.end, AccuracyEnd::kept_meshes);
  EXPECT_EQ(run.rounds.size(), 1u);
}

/// Rolls up without any load, which no start mesh can know.
Scene growing_cantilever(int order, int elements) {
  Scene scene = cantilever(section(1e4, 1e4, 1.0, 1.0), 1.0, order, elements);
  Eigenstrain growth;
  growth.member = "beam";
  growth.curvature_formula = {"0", "0", "12 * x"};
  scene.eigenstrains = {growth};
  return scene;
}

TEST(Accuracy, NeedsMoreThanOneMesh) {
  const Simulation fine = solved(growing_cantilever(8, 48));
  for (const double accuracy : kAccuracies) {
    const AccurateRun run = solved_accurately(with_accuracy(growing_cantilever(1, 1), accuracy));
    EXPECT_EQ(run.end, AccuracyEnd::reached);
    EXPECT_GT(run.rounds.size(), 1u);
    EXPECT_FALSE(run.rounds.back().followed);
    EXPECT_LT(error_against(fine, run.simulation, {"tip"}), accuracy);
  }
}

TEST(Accuracy, FollowsThePathOnTheLastMesh) {
  const AccurateRun run = solved_accurately(with_accuracy(growing_cantilever(1, 1), 1e-6), true);
  EXPECT_EQ(run.end, AccuracyEnd::reached);
  EXPECT_GT(run.rounds.size(), 1u);
  EXPECT_TRUE(run.rounds.back().followed);
}

TEST(Accuracy, IsReachedByElementsWhereTheOrderIsKept) {
  const Simulation fine = solved(growing_cantilever(8, 48));
  Scene scene = with_accuracy(growing_cantilever(2, 1), 1e-5);
  scene.members[0].keeps_order = true;
  const AccurateRun run = solved_accurately(scene);
  EXPECT_EQ(run.end, AccuracyEnd::reached);
  EXPECT_EQ(run.simulation.scene().members[0].order, 2);
  EXPECT_LT(error_against(fine, run.simulation, {"tip"}), 1e-5);
}

}  // namespace
}  // namespace mixbeam::test
