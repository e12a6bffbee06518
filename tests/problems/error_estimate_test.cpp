// Estimated errors beside true ones, from closed forms.
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/solve.hpp"

#include <array>

namespace mixbeam::test {
namespace {

/// What is asked of an estimate: within a factor of five of the true error.
constexpr double kFactor = 5.0;

testing::AssertionResult estimates(double estimated, double error) {
  const bool holds = error > 0.0 && estimated <= kFactor * error && error <= kFactor * estimated;
  return (holds ? testing::AssertionSuccess() : testing::AssertionFailure())
         << "estimated error " << estimated << ", true error " << error;
}

/// Orders and numbers of elements whose errors are between 1e-2 and 1e-10.
using Cells = std::vector<std::array<int, 2>>;

double length_of(const Vector3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

Vector3 difference_of(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Vector3 error_at(const Simulation& beam, const ErrorEstimate& estimate, const std::string& point) {
  return estimate.vertex_displacement[vertex_of(beam.model().mesh(), point)];
}

/// Root mean square of the distance of the centerline from a closed form.
template <class Position>
double centerline_error(const Simulation& beam, const Position& exact) {
  constexpr int kPoints = 9;
  return beam.l2_norm(kPoints,
                      [&](const PointSample& sample, int) { return sample.position - exact(sample.arc_length); });
}

TEST(ErrorEstimate, TipAndEnergyOfTheElastica) {
  // int M^2 ds = 2 EI F (sin(angle) L - v), from theta'^2 = 2 F (sin(angle) - sin(theta)) / EI
  const double energy = 10.0 * (std::sin(kElasticaAngle) - kElasticaTip[1]);
  for (const auto& [order, elements] :
       Cells{{1, 8}, {1, 64}, {2, 4}, {2, 32}, {3, 2}, {3, 8}, {4, 2}, {5, 2}, {8, 1}}) {
    const Simulation beam = solved(elastica(10.0, order, elements));
    const ErrorEstimate estimate = beam.estimate_error();
    ASSERT_TRUE(estimate.exists()) << estimate.not_estimated;
    const Vector3 error = difference_of(kElasticaTip, beam.displacement("tip"));
    EXPECT_TRUE(estimates(length_of(error_at(beam, estimate, "tip")), length_of(error))) << order << ", " << elements;
    EXPECT_TRUE(estimates(std::abs(estimate.energy.error), std::abs(energy - beam.strain_energy().moment)))
        << order << ", " << elements;
    EXPECT_FALSE(estimates(20.0 * length_of(error_at(beam, estimate, "tip")), length_of(error)));  // the twin
  }
}

// One or two elements: one order more has an error of the other sign there.
TEST(ErrorEstimate, TipOfFewElementsToATenth) {
  const auto is_near = [](double estimated, double error) { return std::abs(estimated / error - 1.0) < 0.1; };
  int within = 0;  // the twin: what the tip moves by with one order more
  const Cells cells{{3, 1}, {5, 1}, {6, 1}, {3, 2}, {5, 2}};
  for (const auto& [order, elements] : cells) {
    const Simulation beam = solved(elastica(10.0, order, elements));
    const Vector3 tip = beam.displacement("tip");
    const double error = length_of(difference_of(kElasticaTip, tip));
    EXPECT_TRUE(is_near(length_of(error_at(beam, beam.estimate_error(), "tip")), error)) << order << ", " << elements;
    const Simulation richer = solved(elastica(10.0, order + 1, elements));
    within += is_near(length_of(difference_of(richer.displacement("tip"), tip)), error);
  }
  EXPECT_LT(within, static_cast<int>(cells.size()));
}

TEST(ErrorEstimate, OfOneOrderWhereTwoDoNotConverge) {
  for (const bool is_full : {true, false}) {
    Scene arc = arc_segment(1e4, 5, 2);
    if (is_full) arc.members[0].force_integration = ForceIntegration::full;
    const ErrorEstimate estimate = solved(arc).estimate_error();
    ASSERT_TRUE(estimate.exists()) << estimate.not_estimated;
    EXPECT_EQ(estimate.richer->model.scene().members[0].order, is_full ? 6 : 7);
  }
}

// The vector is estimated, not only its length.
TEST(ErrorEstimate, SubtractedMakesTheTipBetter) {
  const Simulation beam = solved(elastica(10.0, 2, 8));
  const Vector3 exact = kElasticaTip, u = beam.displacement("tip");
  const Vector3 estimated = error_at(beam, beam.estimate_error(), "tip");
  const double error = distance(u, exact);
  const Vector3 better = {u[0] + estimated[0], u[1] + estimated[1], u[2] + estimated[2]};
  EXPECT_LT(distance(better, exact), 0.2 * error);
}

// The tip is exact at every order, what is before it is not.
TEST(ErrorEstimate, CenterlineOfTheRollUp) {
  const auto circles = [](double s) {
    const double angle = 4.0 * kPi * s;
    return Vec{{std::sin(angle) / (4.0 * kPi), (1.0 - std::cos(angle)) / (4.0 * kPi), 0.0}};
  };
  for (const auto& [order, elements] : Cells{{1, 32}, {2, 16}, {3, 8}, {3, 64}, {5, 16}, {7, 8}, {8, 6}}) {
    const Simulation beam = solved(rollup(1e3, order, elements));
    const ErrorEstimate estimate = beam.estimate_error();
    EXPECT_TRUE(estimates(estimate.displacement.error, centerline_error(beam, circles))) << order << ", " << elements;
    EXPECT_FALSE(estimates(estimate.displacement.error / 20.0, centerline_error(beam, circles)));
    constexpr double kExact = 1e-11;
    EXPECT_LT(length_of(error_at(beam, estimate, "tip")), kExact) << order << ", " << elements;
  }
}

// Bending and twisting in space.
TEST(ErrorEstimate, CenterlineOfTheHelix) {
  const auto helix = [](double s) {
    const double part = s / helix_length(), angle = 2.0 * kPi * kHelixCoils * part;
    return Vec{{kHelixRadius * std::sin(angle), -kHelixRadius * std::cos(angle), kHelixHeight * part}};
  };
  for (const auto& [order, elements] : Cells{{1, 32}, {2, 16}, {4, 8}, {6, 16}}) {
    const Simulation beam = solved(helix_experiment(order, elements));
    const double error = centerline_error(beam, helix);
    EXPECT_TRUE(estimates(beam.estimate_error().displacement.error, error)) << order << ", " << elements;
  }
}

// Two legs with a kink, a moment at the tip: each leg becomes an arc, and the kink stays.
TEST(ErrorEstimate, CenterlineOfAKinkedFrame) {
  constexpr double kMoment = 1.5;
  const auto arc = [](double s, double start_angle) {
    const double angle = start_angle + kMoment * s;
    return Vec{{(std::sin(angle) - std::sin(start_angle)) / kMoment,
                (std::cos(start_angle) - std::cos(angle)) / kMoment, 0.0}};
  };
  for (const auto& [order, elements] : Cells{{1, 8}, {2, 4}, {3, 2}, {4, 3}}) {
    Scene scene = cantilever(section(1e4, 5e3, 1.0, 1.0), 1.0, order, elements);
    scene.points.push_back({"end", {1, 1, 0}});
    scene.members.push_back(line("leg", "tip", "end", order, elements));
    scene.point_loads = {dead_load("end", {}, {0, 0, kMoment})};
    const Simulation frame = solved(scene);
    const double error = frame.l2_norm(9, [&](const PointSample& sample, int member) {
      if (member == 0) return sample.position - arc(sample.arc_length, 0.0);
      return sample.position - arc(1.0, 0.0) - arc(sample.arc_length, kMoment + 0.5 * kPi);
    });
    EXPECT_TRUE(estimates(frame.estimate_error().displacement.error, error)) << order << ", " << elements;
  }
}

// Curved in its undeformed state. Tip: shooting on the differential equations of the rod
// (apps/verification/arc_45.xml).
TEST(ErrorEstimate, TipOfTheArc) {
  const Vector3 exact = {-23.560239545026, 13.604521347307, 53.474858791825};
  for (const auto& [order, elements] : Cells{{1, 16}, {2, 8}, {3, 4}, {4, 2}, {6, 1}}) {
    const Simulation arc = solved(arc_segment(arc_section(100), arc_force(100), -1.0, order, elements));
    const Vector3 error = difference_of(exact, arc.displacement("tip"));
    EXPECT_TRUE(estimates(length_of(error_at(arc, arc.estimate_error(), "tip")), length_of(error)))
        << order << ", " << elements;
  }
}

// Statically determinate: M(s) = int_s^L c, whatever the rod does.
TEST(ErrorEstimate, MomentUnderALineCouple) {
  for (const auto& [order, elements] : Cells{{1, 8}, {2, 4}, {3, 4}, {5, 2}}) {
    Scene scene = cantilever(section(1e3, 1e3, 1.0, 1.0), 1.0, order, elements);
    scene.distributed_loads = {{"beam"}};
    scene.distributed_loads[0].couple_formula = {"0", "0", "exp(2*x)"};
    const Simulation beam = solved(scene);
    const double error = beam.l2_norm(9, [](const PointSample& sample, int) {
      return sample.moment - Vec{{0.0, 0.0, 0.5 * (std::exp(2.0) - std::exp(2.0 * sample.arc_length))}};
    });
    EXPECT_TRUE(estimates(beam.estimate_error().moment.error, error)) << order << ", " << elements;
  }
}

TEST(ErrorEstimate, ElementsAddUpToTheWhole) {
  Scene scene = slope_discontinuity(3, 2);
  scene.members[1].order = 8;
  const Simulation frame = solved(scene);
  const ErrorEstimate estimate = frame.estimate_error();
  double displacement = 0.0, moment = 0.0;
  for (double error : estimate.element_displacement) displacement += error * error;
  for (double error : estimate.element_moment) moment += error * error;
  ASSERT_EQ(estimate.element_displacement.size(), frame.model().mesh().elements.size());
  ASSERT_EQ(estimate.vertex_displacement.size(), frame.model().mesh().vertex_position.size());
  EXPECT_NEAR(std::sqrt(displacement), estimate.displacement.error, 1e-12 * estimate.displacement.error);
  EXPECT_NEAR(std::sqrt(moment), estimate.moment.error, 1e-12 * estimate.moment.error);
}

// No closed form, but errors are what refinement takes away: joints, springs, follower and line loads, couples,
// eigenstrains, coupled and tapered sections, inner points.
TEST(ErrorEstimate, SeesWhatAFinerMeshSees) {
  Scene joints = portal_of_joints(2, 2, 2.0);
  Scene composite = elastica(10.0, 3, 3);
  composite.sections = {section(1e3, 1e3, 2.0, 1.0)};
  composite.sections[0].matrix = Matrix6{};
  for (int i = 0; i < 6; ++i) (*composite.sections[0].matrix)[i][i] = i < 3 ? 1e3 : i == 3 ? 2.0 : 1.0;
  (*composite.sections[0].matrix)[3][4] = (*composite.sections[0].matrix)[4][3] = 0.5;
  Section thick = section(2e3, 2e3, 4.0, 3.0);
  thick.name = "thick";
  Scene tapered = elastica(10.0, 2, 4);
  tapered.sections = {section(1e3, 1e3, 2.0, 1.0), thick};
  tapered.members[0].end_section = "thick";
  tapered.members[0].inner_points = {{"middle", 0.4}};
  tapered.eigenstrains = {{"beam", {0.01, 0, 0}, {0.3, 0, 0.5}}};
  tapered.distributed_loads = {{"beam", {0, 2, 3}, {}, 1, LoadFrame::follower}};
  for (const Scene& scene : {joints, composite, tapered}) {
    Scene finer = scene;
    for (Member& member : finer.members) {
      member.order = 6;
      member.elements *= 4;
    }
    const Simulation coarse = solved(scene), fine = solved(finer);
    const ErrorEstimate estimate = coarse.estimate_error();
    ASSERT_TRUE(estimate.exists()) << scene.name << ": " << estimate.not_estimated;
    const auto largest = [&](const auto& error_of) {
      double value = 0.0;
      for (const auto& [point, vertex] : coarse.model().mesh().vertex_of_point)
        value = std::max(value, length_of(error_of(point)));
      return value;
    };
    const double estimated = largest([&](const std::string& point) { return error_at(coarse, estimate, point); });
    const double seen = largest(
        [&](const std::string& point) { return difference_of(fine.displacement(point), coarse.displacement(point)); });
    EXPECT_TRUE(estimates(estimated, seen)) << scene.name;
  }
}

TEST(ErrorEstimate, SameInThePlaneAndInSpace) {
  constexpr double kSame = 1e-6;  // of the error: the states differ by rounding
  for (int order : {1, 2, 5}) {
    const std::vector<Simulation> both = solved_in_plane_and_in_space(elastica(10.0, order, 4));
    const ErrorEstimate a = both[0].estimate_error(), b = both[1].estimate_error();
    EXPECT_NEAR(a.displacement.error, b.displacement.error, kSame * b.displacement.error) << order;
    EXPECT_NEAR(a.moment.error, b.moment.error, kSame * b.moment.error) << order;
    const ErrorEstimate other = solved(elastica(10.0, order, 5)).estimate_error();  // the twin
    EXPECT_GT(std::abs(other.moment.error - b.moment.error), kSame * b.moment.error) << order;
  }
}

TEST(ErrorEstimate, LeavesTheRunAsItIs) {
  const Simulation beam = solved(elastica(10.0, 3, 4));
  const StateSnapshot before = snapshot_of(beam.model(), beam.state());
  beam.estimate_error();
  const StateSnapshot after = snapshot_of(beam.model(), beam.state());
  EXPECT_EQ(before.interior, after.interior);
  EXPECT_EQ(before.vertex_displacement, after.vertex_displacement);
}

TEST(ErrorEstimate, SaysWhyThereIsNone) {
  const ErrorEstimate estimate = solved(rollup(100, 8, 1)).estimate_error();
  EXPECT_FALSE(estimate.exists());
  EXPECT_NE(estimate.not_estimated.find("turns too far"), std::string::npos) << estimate.not_estimated;
}

TEST(MpiErrorEstimate, SameOnAllRanks) {
  Scene scene = fork(2, 3);
  scene.members[1].order = 8;
  const Simulation together = solved(scene, {}, all_ranks()), alone = solved(scene);
  const ErrorEstimate a = together.estimate_error(), e = alone.estimate_error();
  constexpr double kSame = 1e-6;  // of the error: the states differ by rounding
  EXPECT_NEAR(a.displacement.error, e.displacement.error, kSame * e.displacement.error);
  EXPECT_NEAR(a.moment.error, e.moment.error, kSame * e.moment.error);
  EXPECT_NEAR(a.energy.error, e.energy.error, 1e-4 * std::abs(e.energy.error));
  ASSERT_EQ(a.vertex_displacement.size(), e.vertex_displacement.size());
  for (size_t v = 0; v < e.vertex_displacement.size(); ++v)
    EXPECT_TRUE(agrees(a.vertex_displacement[v], e.vertex_displacement[v], 1e-5 * e.largest_displacement.error));
}

}  // namespace
}  // namespace mixbeam::test
