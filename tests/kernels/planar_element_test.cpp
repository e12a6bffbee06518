/// Elements that move in a plane against the spatial kernels and the derivatives of the energy.
#include "kernels/loops/planar_block.hpp"
#include "tests/kernels/element_comparison.hpp"
#include "tests/support/numbers.hpp"

#include <gtest/gtest.h>

namespace mixbeam::element_test {
namespace {

/// As kTangentTolerance, for random states that may be nearly singular; the others differ by some hundred roundings.
constexpr double kPlanarTolerance = 2e-11;
using test::kPi;

PlaneAxes plane_of(const Quaternion<double>& turn) {
  const Mat3<double> m = rotation_matrix(turn);
  const auto column = [&](int j) { return Vec{{m(0, j), m(1, j), m(2, j)}}; };
  return {column(0), column(1), column(2)};
}

/// How the material axes lie in the plane: quarter turns about g1 from g2 in the plane and g3 = n.
struct PlanarRecipe {
  int order;
  std::uint64_t seed;
  int quarter_turns;
  Quaternion<double> plane;
  double psi = 0.8, end_angle = 2.5;
};

/// Everything but its size is dropped that would leave the plane.
ElementSample planar_sample(const PlanarRecipe& recipe) {
  ElementSample sample = random_sample({recipe.order, ForceIntegration::both_reduced, recipe.seed});
  RandomNumbers random(recipe.seed + 1000);
  const int normal = recipe.quarter_turns % 2 == 0 ? 2 : 1;
  const Vec3<double> along = rotation_matrix(recipe.plane) * Vec3<double>{{0.0, 0.0, 1.0}};
  const auto about_normal = [&](double angle) { return exp_quaternion(angle * along); };
  const auto keep_normal = [&](Vec3<double>& v) { v[0] = v[3 - normal] = 0.0; };
  const auto keep_in_plane = [&](Vec3<double>& v) { v += (-dot(v, along)) * along; };
  EnergyCurve& curve = sample.element.curve;
  const Quaternion<double> lying =
      recipe.plane * exp_quaternion(Vec3<double>{{0.5 * kPi * recipe.quarter_turns, 0.0, 0.0}});
  curve.start = normalized(about_normal(random.between(-3.0, 3.0)) * lying);
  keep_normal(curve.turn);
  keep_normal(curve.bend);
  EnergyState<double>& state = sample.state;
  for (auto& force : state.force) force[normal] = 0.0;
  for (auto& moment : state.moment) keep_normal(moment);
  double ends[2] = {0.0, 0.0};
  for (size_t j = 0; j < state.relative_rotation.size(); ++j) {
    keep_normal(state.relative_rotation[j]);
    ends[0] += (j % 2 == 0 ? -1.0 : 1.0) * state.relative_rotation[j][normal];
    ends[1] += state.relative_rotation[j][normal];
  }
  const double largest = std::max(std::fabs(ends[0]), std::fabs(ends[1]));
  for (auto& psi : state.relative_rotation) psi = (recipe.psi / largest) * psi;
  for (auto& slope : state.slope) keep_in_plane(slope);
  state.element_triad = normalized(about_normal(random.between(-3.0, 3.0)) * lying);
  for (int end = 0; end < 2; ++end) {
    const double xi = end == 0 ? -1.0 : 1.0;
    const Quaternion<double> phi = about_normal(recipe.end_angle * random.between(-1.0, 1.0));
    state.vertex_rotation[end] =
        normalized(phi * element_rotation_at(state, xi) * conjugate(sample.element.curve.triad(xi)));
    keep_in_plane(state.displacement[end]);
  }
  return sample;
}

/// A block with every way to lie in the plane; no number of lanes divides its count.
std::vector<ElementSample> planar_samples(int order, const Quaternion<double>& plane, double psi, double end_angle) {
  std::vector<ElementSample> samples;
  for (int e = 0; e < 13; ++e)
    samples.push_back(planar_sample({order, 300 + static_cast<std::uint64_t>(e), e % 4, plane, psi, end_angle}));
  return samples;
}

/// Rows of both vertices of every element in space, from those in the plane.
void expand_rows(const SampleBlock& samples, const PlaneAxes& axes, const KernelView<double* [12]>& out) {
  for (int e = 0; e < samples.block.count; ++e) {
    const double* row = &samples.equations.planar_rows(samples.element_row(e), 0);
    Vec on_each_end{{0.0, 0.0, 0.0}};
    if (samples.equations.planar_loads.extent(0) > 0) {
      const double* load = &samples.equations.planar_loads(samples.element_row(e), 0);
      on_each_end = load[0] * axes.p + load[1] * axes.q;
    }
    for (int end = 0; end < 2; ++end) {
      const Vec force = (end == 0 ? -1.0 : 1.0) * (row[0] * axes.p + row[1] * axes.q) + on_each_end;
      store_vector(force, &out(samples.element_row(e), 6 * end));
      store_vector(row[2 + end] * axes.n, &out(samples.element_row(e), 6 * end + 3));
    }
  }
}
void residual_in_plane(const SampleBlock& samples, const PlanarBlock& block) {
  evaluate_planar_residual(samples.block, block, samples.structure, samples.state, samples.equations);
  expand_rows(samples, block.axes, samples.equations.residual);
}

/// Results of the same block by both paths.
struct BothPaths {
  SampleBlock spatial, planar;
  PlanarBlock block;
  PlanarTangents tangents;
  PlaneAxes axes;

  BothPaths(const std::vector<ElementSample>& samples, const Quaternion<double>& plane, bool with_fields = false)
      : spatial(samples, with_fields),
        planar(samples, with_fields),
        block(make_planar_block(planar.block, plane_of(plane))),
        tangents("tangents", planar.element_row(planar.block.count)),
        axes(plane_of(plane)) {}

  void evaluate() {
    evaluate_residual(spatial.block, spatial.structure, spatial.state, spatial.equations);
    residual_in_plane(planar, block);
    evaluate_tangent(spatial.block, spatial.structure, spatial.state, spatial.equations);
    evaluate_planar_tangent(planar.block, block, planar.structure, planar.state, tangents, planar.equations);
    expand_rows(planar, axes, planar.equations.condensed_residual);
  }

  double residual_difference() const {
    Difference d;
    const std::vector<Kind> kinds = kinds_of(spatial.state_of(0));
    for (int e = 0; e < spatial.block.count; ++e) {
      for (int i = 0; i < kVertexIncrements; ++i)
        d.add(kinds[i], planar.equations.residual(planar.element_row(e), i),
              spatial.equations.residual(spatial.element_row(e), i));
      for (int i = 0; i < spatial.increments(); ++i)
        d.add(kinds[kVertexIncrements + i], planar.equations.interior_residual(planar.interior_row(e) + i),
              spatial.equations.interior_residual(spatial.interior_row(e) + i));
      // against one radian
      d.add(kKinds, 1.0 + planar.equations.largest_end_angle(planar.element_row(e)),
            1.0 + spatial.equations.largest_end_angle(spatial.element_row(e)));
    }
    return d.relative();
  }

  /// Spatial tangent seen in the plane, element by element: states differ in size.
  double tangent_difference() const {
    double worst = 0.0;
    for (int e = 0; e < spatial.block.count; ++e) {
      Difference d;
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j)
          d.add((i % 3 == 2 ? 1 : 0) + (j % 3 == 2 ? 1 : 0),
                symmetric_tangent_entry<kPlanarDofs>(&tangents(planar.element_row(e), 0), i, j),
                in_plane(&spatial.equations.condensed_tangent(spatial.element_row(e), 0), i, j));
      for (int i = 0; i < kVertexIncrements; ++i)
        d.add(3 + i / 3 % 2, planar.equations.condensed_residual(planar.element_row(e), i),
              spatial.equations.condensed_residual(spatial.element_row(e), i));
      worst = std::isnan(d.relative()) ? HUGE_VAL : std::max(worst, d.relative());
    }
    return worst;
  }

  /// Interior increments for random motions in the plane.
  double recovery_difference() const {
    const int vertices = 2 * spatial.block.count;
    const KernelView<double* [6]> motion("motion", vertices);
    RandomNumbers random(7);
    for (int v = 0; v < vertices; ++v) {
      const Vec u = random.between(-1.0, 1.0) * axes.p + random.between(-1.0, 1.0) * axes.q;
      const Vec turn = random.between(-1.0, 1.0) * axes.n;
      for (int i = 0; i < 3; ++i) {
        motion(v, i) = u[i];
        motion(v, 3 + i) = turn[i];
      }
    }
    const KernelView<double*> a = spatial.constants(), b("b", a.extent(0));
    recover_interior(spatial.block, spatial.structure, spatial.state, spatial.equations, motion, a);
    recover_planar_interior(planar.block, block, motion, b);
    const std::vector<Kind> kinds = kinds_of(spatial.state_of(0));
    double worst = 0.0;
    for (int e = 0; e < spatial.block.count; ++e) {
      Difference d;
      for (int i = 0; i < spatial.increments(); ++i)
        d.add(kinds[kVertexIncrements + i], b(planar.interior_row(e) + i), a(spatial.interior_row(e) + i));
      worst = std::isnan(d.relative()) ? HUGE_VAL : std::max(worst, d.relative());
    }
    return worst;
  }

 private:
  /// Entry (i, j) of (u_p, u_q, theta)_a (..)_b.
  double in_plane(const double* matrix, int i, int j) const {
    const Vec directions[3] = {axes.p, axes.q, axes.n};
    const auto first = [](int k) { return 6 * (k / 3) + (k % 3 == 2 ? 3 : 0); };
    double sum = 0.0;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c)
        sum += directions[i % 3][r] * matrix[12 * (first(i) + r) + first(j) + c] * directions[j % 3][c];
    return sum;
  }
};

const Quaternion<double> kPlanes[] = {identity_quaternion<double>(), exp_quaternion(Vec3<double>{{0.4, -1.1, 2.0}}),
                                      exp_quaternion(Vec3<double>{{0.5 * kPi, 0.0, 0.0}})};

class PlanarElement : public testing::TestWithParam<int> {};

TEST_P(PlanarElement, SameAsInSpace) {
  for (const auto& plane : kPlanes)
    for (const double psi : {1e-9, 0.05, 0.8, 3.5})
      for (const double end_angle : {0.0, 1e-6, 0.3, kPi - 1e-6}) {
        BothPaths paths(planar_samples(GetParam(), plane, psi, end_angle), plane);
        paths.evaluate();
        EXPECT_LE(paths.residual_difference(), kGradientTolerance) << "psi " << psi << ", end angle " << end_angle;
        EXPECT_LE(paths.tangent_difference(), kPlanarTolerance) << "psi " << psi << ", end angle " << end_angle;
        EXPECT_LE(paths.recovery_difference(), kPlanarTolerance) << "psi " << psi << ", end angle " << end_angle;
      }
}

/// The comparison above sees an angle that is off by 1e-9.
TEST_P(PlanarElement, ComparisonSeesOneAngle) {
  BothPaths paths(planar_samples(GetParam(), kPlanes[1], 0.3, 0.5), kPlanes[1]);
  const int v = paths.planar.vertex(5, 1);
  const Quaternion<double> before{paths.planar.state.vertex_rotation(v, 0), paths.planar.state.vertex_rotation(v, 1),
                                  paths.planar.state.vertex_rotation(v, 2), paths.planar.state.vertex_rotation(v, 3)};
  paths.planar.set_vertex_rotation(v, exp_quaternion(1e-9 * paths.axes.n) * before);
  paths.evaluate();
  EXPECT_GT(paths.residual_difference(), 100.0 * kGradientTolerance);
  EXPECT_GT(paths.recovery_difference(), kPlanarTolerance);
}

TEST_P(PlanarElement, GradientOfTheEnergy) {
  for (int quarter_turns = 0; quarter_turns < 4; ++quarter_turns) {
    const ElementSample sample = planar_sample({GetParam(), 41, quarter_turns, kPlanes[1]});
    const SampleBlock samples({sample});
    const PlanarBlock block = make_planar_block(samples.block, plane_of(kPlanes[1]));
    residual_in_plane(samples, block);
    EXPECT_LE(difference(weighted_rows(samples, 0, sample.element), energy_gradient(sample.element, sample.state),
                         kinds_of(sample.state)),
              kGradientTolerance)
        << quarter_turns << " quarter turns";
  }
}

/// Dead forces and eigenstrains; some elements have none, or one of them.
std::vector<ElementSample> samples_with_fields(int order, const Quaternion<double>& plane) {
  std::vector<ElementSample> samples = planar_samples(order, plane, 0.8, 0.5);
  const unsigned kinds[] = {bit(LineField::dead_force), bit(LineField::eigenstrain), bit(LineField::eigencurvature)};
  const Vec along = rotation_matrix(plane) * Vec{{0.0, 0.0, 1.0}};
  for (size_t e = 0; e < samples.size(); ++e) {
    EnergyElement& element = samples[e].element;
    unsigned some = 0;
    for (int i = 0; i < 3; ++i)
      if ((e >> i) % 2 == 1) some |= kinds[i];
    add_fields(element, some, 70 + e);
    const int normal = e % 2 == 0 ? 2 : 1;  // as planar_samples() turns them
    for (Vec* v : {&element.line_force.middle, &element.line_force.slope}) *v += (-dot(*v, along)) * along;
    for (Vec* v : {&element.eigenstrain.middle, &element.eigenstrain.slope}) (*v)[normal] = 0.0;
    for (Vec* v : {&element.eigencurvature.middle, &element.eigencurvature.slope}) (*v)[0] = (*v)[3 - normal] = 0.0;
  }
  return samples;
}

TEST_P(PlanarElement, LineFieldsAreThoseInSpace) {
  for (const auto& plane : kPlanes) {
    BothPaths paths(samples_with_fields(GetParam(), plane), plane, true);
    paths.evaluate();
    EXPECT_LE(paths.residual_difference(), kGradientTolerance);
    EXPECT_LE(paths.tangent_difference(), kPlanarTolerance);
    EXPECT_LE(paths.recovery_difference(), kPlanarTolerance);
  }
}

/// The comparison above sees a load, a strain and a curvature that are off by 1e-6.
TEST_P(PlanarElement, ComparisonSeesLineFields) {
  for (const LineField kind : {LineField::dead_force, LineField::eigenstrain, LineField::eigencurvature}) {
    BothPaths paths(samples_with_fields(GetParam(), kPlanes[1]), kPlanes[1], true);
    const int row = paths.planar.block.field_row(7, static_cast<int>(kind));  // that element has all of them
    for (int i = 0; i < 3; ++i) paths.planar.structure.field_value(row, i) *= 1.0 + 1e-6;
    paths.evaluate();
    EXPECT_GT(paths.residual_difference(), 10.0 * kGradientTolerance);
    EXPECT_GT(paths.tangent_difference(), kPlanarTolerance);
  }
}

/// The own residual of another state given as right-hand side.
TEST_P(PlanarElement, GivenRightHandSide) {
  BothPaths paths(planar_samples(GetParam(), kPlanes[1], 0.8, 1.0), kPlanes[1]);
  const SampleBlock other(planar_samples(GetParam(), kPlanes[1], 0.5, 0.7));
  evaluate_residual(other.block, other.structure, other.state, other.equations);
  const auto& rhs = other.equations.interior_residual;
  condense_right_hand_side(paths.spatial.block, paths.spatial.structure, paths.spatial.state, rhs,
                           paths.spatial.equations);
  condense_planar_right_hand_side(paths.planar.block, paths.block, paths.planar.structure, paths.planar.state, rhs,
                                  paths.tangents, paths.planar.equations);
  expand_rows(paths.planar, paths.axes, paths.planar.equations.condensed_residual);
  EXPECT_LE(paths.tangent_difference(), kPlanarTolerance);
  EXPECT_LE(paths.recovery_difference(), kPlanarTolerance);
}

/// Rigid sections: compliance zero in the residual, the capped one in the tangent.
TEST_P(PlanarElement, CappedStiffness) {
  std::vector<ElementSample> samples = planar_samples(GetParam(), kPlanes[0], 0.3, 0.2);
  for (ElementSample& sample : samples) {
    sample.element.force_compliance = Vec3<double>{{0.0, 0.0, 1e-3}};
    sample.tangent_force_stiffness = Vec3<double>{{1e5, 2e5, 1e3}};
  }
  constexpr double loss_of_stiff_elimination = 1e-9;  // the spatial path eliminates the stiffness, not the compliance
  BothPaths paths(samples, kPlanes[0]);
  paths.evaluate();
  EXPECT_LE(paths.residual_difference(), kGradientTolerance);
  EXPECT_LE(paths.tangent_difference(), loss_of_stiff_elimination);
  EXPECT_LE(paths.recovery_difference(), loss_of_stiff_elimination);
}

INSTANTIATE_TEST_SUITE_P(Orders, PlanarElement, testing::Range(1, kMaximumOrder + 1));

/// A compressive force at which the first pivot (order 1: 12 EI/h + h (N - N^2/GA)) is zero, although the element is
/// regular: such lanes are eliminated with exchange of rows.
TEST(PlanarElementPivots, ZeroPivot) {
  std::vector<ElementSample> samples = planar_samples(1, kPlanes[0], 0.0, 0.2);
  for (size_t e = 0; e < samples.size(); e += 2) {
    ElementSample& sample = samples[e];
    const EnergyCurve curve{1.0, kPlanes[0], {}, {}};
    sample.element.curve = curve;
    sample.state.element_triad = curve.start;
    for (int end = 0; end < 2; ++end) {
      sample.state.vertex_rotation[end] = exp_quaternion(Vec3<double>{{0.0, 0.0, 0.1 * end}});
      sample.state.displacement[end] = Vec3<double>{{0.0, 0.0, 0.0}};
    }
    const double f = sample.element.force_compliance[1], bending = 1.0 / sample.element.moment_compliance[2];
    sample.state.force[0] = Vec3<double>{{(1.0 - std::sqrt(1.0 + 48.0 * f * bending)) / (2.0 * f), 0.0, 0.0}};
  }
  BothPaths paths(samples, kPlanes[0]);
  paths.evaluate();
  EXPECT_LE(paths.tangent_difference(), kPlanarTolerance);
  EXPECT_LE(paths.recovery_difference(), kPlanarTolerance);
}

}  // namespace
}  // namespace mixbeam::element_test
