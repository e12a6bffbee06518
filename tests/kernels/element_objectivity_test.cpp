/// Rigid motions: strains stay, vertex rows turn, and the tangent of a stress-free element has exactly six zero
/// eigenvalues.
#include "tests/kernels/element_samples.hpp"

#include <gtest/gtest.h>

#include <Teuchos_LAPACK.hpp>
#include <algorithm>
#include <cmath>
#include <string>

namespace mixbeam::element_test::element_objectivity_test {
namespace {

/// Slopes and triads of order 1 lose some last digits when they are turned (at most 3e-15 for strains and
/// 2e-15 for the rest in 4000 random elements).
constexpr double kStrainTolerance = 2e-14, kForceTolerance = 2e-14;
/// The tangent of a random state eliminates an indefinite, sometimes nearly singular system (at most 1.7e-11, mostly
/// 1e-14).
constexpr double kTangentTolerance = 5e-11;
/// Residual of a stress-free element with stiffness up to 1000: the rounding of strains times that (at most 8e-13).
constexpr double kRestTolerance = 5e-12;
/// Null vectors: K x is a sum of products of order |K| (at most 5e-15).
constexpr double kNullSpaceTolerance = 1e-13;
/// The softest elastic mode of a random element of length about 1 and slenderness about 10, relative to the stiffest
/// (at least 1.1e-3).
constexpr double kSmallestElasticEigenvalue = 1e-4;

/// Vertex row block (0..3: u_a, theta_a, u_b, theta_b) of one element.
Vec3<double> vertex_row(const KernelView<double* [12]>& rows, int element, int block) {
  return {{rows(element, 3 * block), rows(element, 3 * block + 1), rows(element, 3 * block + 2)}};
}
Vec3<double> interior_row(const SampleBlock& samples, int offset) {
  const double* row = samples.equations.interior_residual.data() + samples.interior_row(0) + offset;
  return {{row[0], row[1], row[2]}};
}
Mat3<double> tangent_block(const SampleBlock& samples, int row, int column) {
  Mat3<double> block;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      block(i, j) = samples.equations.condensed_tangent(samples.element_row(0), 12 * (3 * row + i) + 3 * column + j);
  return block;
}
double largest(const Mat3<double>& m) {
  double result = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result = std::max(result, std::fabs(m(i, j)));
  return result;
}

/// Changes by a rigid motion: of the strains (rows of N and M), and of the rows of forces and moments, the spatial ones
/// turned back, relative to the largest of them.
struct RowChange {
  double strain = 0.0, force = 0.0;
};

RowChange row_change(const SampleBlock& before, const SampleBlock& after, const Mat3<double>& turn) {
  const InteriorLayout& layout = before.block.interior;
  RowChange change;
  double largest_force = 0.0;
  const auto compare = [&](const Vec3<double>& expected, const Vec3<double>& found) {
    change.force = std::max(change.force, norm(found - expected));
    largest_force = std::max(largest_force, norm(expected));
  };
  for (int i = 0; i < layout.increments(); i += 3) {
    const Vec3<double> here = interior_row(before, i), there = interior_row(after, i);
    const bool strain = i < layout.relative_rotation(1), spatial = i >= layout.bubble(1) && i < layout.spin();
    if (strain)
      change.strain = std::max(change.strain, norm(there - here));
    else
      compare(spatial ? turn * here : here, there);
  }
  for (int block = 0; block < 4; ++block)
    compare(turn * vertex_row(before.equations.residual, before.element_row(0), block),
            vertex_row(after.equations.residual, after.element_row(0), block));
  change.force /= largest_force;
  return change;
}

/// Largest change of the condensed tangent turned back, relative to its largest entry of the same unit.
double tangent_change(const SampleBlock& before, const SampleBlock& after, const Mat3<double>& turn) {
  double error[2][2] = {}, scale[2][2] = {};
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) {
      const Mat3<double> expected = turn * tangent_block(before, row, column) * transpose(turn);
      double& e = error[row % 2][column % 2];
      double& s = scale[row % 2][column % 2];
      e = std::max(e, largest(tangent_block(after, row, column) - expected));
      s = std::max(s, largest(expected));
    }
  return std::max(
      {error[0][0] / scale[0][0], error[0][1] / scale[0][1], error[1][0] / scale[1][0], error[1][1] / scale[1][1]});
}

std::vector<SampleRecipe> recipes_that_rotate_exactly(int order) {
  std::vector<SampleRecipe> recipes;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    recipes.push_back({order, ForceIntegration::both_reduced, seed});
    for (const ForceIntegration rule : kAllRules) {
      recipes.push_back({order, rule, seed});
      recipes.back().curved = false;
    }
  }
  return recipes;
}

SampleBlock evaluated(const ElementSample& sample) {
  SampleBlock samples({sample});
  evaluate_residual(samples.block, samples.structure, samples.state, samples.equations);
  evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
  return samples;
}

class ElementObjectivity : public testing::TestWithParam<int> {};

TEST_P(ElementObjectivity, RigidMotionTurnsTheRows) {
  constexpr double many_turns = 100.0;
  for (const SampleRecipe& recipe : recipes_that_rotate_exactly(GetParam()))
    for (const double angle : {0.0, 1e-12, 1.0, many_turns}) {
      RandomNumbers random(recipe.seed);
      const Quaternion<double> rotation = exp_quaternion(angle * random.direction());
      ElementSample sample = random_sample(recipe);
      const SampleBlock before = evaluated(sample);
      sample.state = moved(sample.element, sample.state, rotation, random.vector(1.0));
      const SampleBlock after = evaluated(sample);
      const RowChange change = row_change(before, after, rotation_matrix(rotation));
      EXPECT_LE(change.strain, kStrainTolerance) << recipe << ", turned by " << angle;
      EXPECT_LE(change.force, kForceTolerance) << recipe << ", turned by " << angle;
      EXPECT_LE(tangent_change(before, after, rotation_matrix(rotation)), kTangentTolerance)
          << recipe << ", turned by " << angle;
    }
}

/// Must fail: a rotation of the vertices alone strains the element.
TEST_P(ElementObjectivity, RotationOfTheVerticesAloneChangesTheStrains) {
  const Quaternion<double> rotation = exp_quaternion(Vec3<double>{{0.1, 0.0, 0.0}});
  ElementSample sample = random_sample({GetParam(), ForceIntegration::both_reduced, 1});
  const SampleBlock before = evaluated(sample);
  const Quaternion<double> triad = sample.state.element_triad;
  sample.state = moved(sample.element, sample.state, rotation, Vec3<double>{{0.0, 0.0, 0.0}});
  sample.state.element_triad = triad;
  EXPECT_GT(row_change(before, evaluated(sample), rotation_matrix(rotation)).strain, 1e-3);
}

double largest_entry(const KernelView<double* [12]>& rows, int element) {
  double result = 0.0;
  for (int i = 0; i < 12; ++i) result = std::max(result, std::fabs(rows(element, i)));
  return result;
}

/// Eigenvalues of the condensed tangent, ascending by absolute value, relative to the largest.
std::vector<double> relative_eigenvalues(const SampleBlock& samples) {
  constexpr int n = 12, work_size = 10 * n;
  std::array<double, n * n> matrix;
  for (int i = 0; i < n * n; ++i) matrix[i] = samples.equations.condensed_tangent(samples.element_row(0), i);
  std::vector<double> eigenvalues(n), work(work_size);
  int info = 0;
  Teuchos::LAPACK<int, double>().SYEV('N', 'U', n, matrix.data(), n, eigenvalues.data(), work.data(), work_size, &info);
  EXPECT_EQ(info, 0);
  std::sort(eigenvalues.begin(), eigenvalues.end(), [](double a, double b) { return std::fabs(a) < std::fabs(b); });
  const double stiffest = std::fabs(eigenvalues.back());
  for (double& eigenvalue : eigenvalues) eigenvalue /= stiffest;
  return eigenvalues;
}

/// |K x| / |K| for a vertex increment x.
double relative_force(const SampleBlock& samples, const std::array<double, 12>& x) {
  double worst = 0.0, scale = 0.0;
  for (int i = 0; i < 12; ++i) {
    double sum = 0.0;
    for (int j = 0; j < 12; ++j) {
      const double entry = samples.equations.condensed_tangent(samples.element_row(0), 12 * i + j);
      scale = std::max(scale, std::fabs(entry));
      sum += entry * x[j];
    }
    worst = std::max(worst, std::fabs(sum));
  }
  return worst / scale;
}

/// Translation along axis 0..2 or rotation about axis 3..5 (through the left vertex) of both vertices.
std::array<double, 12> rigid_mode(const ElementSample& sample, int axis) {
  std::array<double, 12> mode{};
  Vec3<double> unit{{0.0, 0.0, 0.0}};
  unit[axis % 3] = 1.0;
  const EnergyState<double>& state = sample.state;
  const Vec3<double> chord = sample.element.curve.length * interpolated_tangent(sample.element)[0] +
                             state.displacement[1] - state.displacement[0];
  const Vec3<double> far = cross(unit, chord);
  for (int i = 0; i < 3; ++i) {
    mode[i] = axis < 3 ? unit[i] : 0.0;
    mode[6 + i] = axis < 3 ? unit[i] : far[i];
    mode[3 + i] = mode[9 + i] = axis < 3 ? 0.0 : unit[i];
  }
  return mode;
}

TEST_P(ElementObjectivity, SixRigidModesAndNoMore) {
  for (const SampleRecipe& recipe : recipes_that_rotate_exactly(GetParam())) {
    const ElementSample sample = stress_free_sample(recipe);
    const SampleBlock samples = evaluated(sample);
    EXPECT_LE(largest_entry(samples.equations.condensed_residual, samples.element_row(0)), kRestTolerance) << recipe;
    for (int axis = 0; axis < 6; ++axis)
      EXPECT_LE(relative_force(samples, rigid_mode(sample, axis)), kNullSpaceTolerance) << recipe << ", mode " << axis;
    const std::vector<double> eigenvalues = relative_eigenvalues(samples);
    EXPECT_LE(std::fabs(eigenvalues[5]), kNullSpaceTolerance) << recipe;
    EXPECT_GE(eigenvalues[6], kSmallestElasticEigenvalue) << recipe;  // must-fail twin of the line above
  }
}

/// Must fail: the rotation of one vertex is not a rigid motion.
TEST_P(ElementObjectivity, RotationOfOneVertexIsNotFree) {
  const ElementSample sample = stress_free_sample({GetParam(), ForceIntegration::both_reduced, 1});
  std::array<double, 12> mode = rigid_mode(sample, 3);
  mode[9] = 0.0;
  EXPECT_GT(relative_force(evaluated(sample), mode), kSmallestElasticEigenvalue);
}

INSTANTIATE_TEST_SUITE_P(Orders, ElementObjectivity, testing::Range(1, kMaximumOrder + 1));

}  // namespace
}  // namespace mixbeam::element_test::element_objectivity_test
