// The assembled equations: row gather against the naive sum, Newton's increment against differences of the mixed
// residual, and scales that make units disappear.
#include "discretization/assembly/equation_place.hpp"

#include "kernels/element/layout.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/scene_units.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/states.hpp"
#include "tests/support/worst_error.hpp"

#include <vector>

namespace mixbeam::test {
namespace {

constexpr std::uint64_t kSeed = 20240611;

/// Far above any force stiffness of these tests: the tangent is that of the residual.
ModelOptions without_cap() {
  ModelOptions options;
  options.force_stiffness_cap = 1e12;
  return options;
}

/// Two members between the same points, three orders, two integration rules, a branch.
Scene mixed_scene() {
  Scene scene = fork(2, 2);
  scene.members[1].order = 3;
  scene.members[2].force_integration = ForceIntegration::axial_reduced;
  scene.members.push_back(line("tie", "tine 1", "tine 2", 1, 1));
  scene.members.push_back(arc("bow", "tine 2", "tine 1", {2, 0, 0}, {0, 0, 1}, kPi, 2, 1));
  scene.members.push_back(line("second tie", "tine 2", "tine 1", 3, 1));
  return scene;
}

/// Everything that acts from outside, at stage 1.
Scene loaded_scene() {
  Scene scene = mixed_scene();
  scene.stages = 1;
  scene.sections[0].bending_stiffness = {80.0, 120.0};
  scene.point_loads = {dead_load("tine 1", {3, -20, 50}, {4, 5, -6}),
                       follower_load("tine 2", "right", {-10, 30, 20}, {7, -3, 2}), dead_load("branch", {0, 0, 9})};
  scene.distributed_loads = {{"shaft", {5, -6, 7}, {2, -1, 3}, 1},
                             {"left", {1, 2, 3}, {-4, 1, 2}, 1},
                             {"shaft", {2, 8, -4}, {1, 3, -2}, 1, LoadFrame::follower}};
  scene.distributed_loads[0].force_formula = {"", "-6 * cos(3 * x)", "7 + x"};
  scene.distributed_loads[2].couple_formula = {"1 + x^2", "", ""};
  scene.eigenstrains = {{"right", {0.02, 0.01, -0.03}, {0.1, -0.2, 0.3}}};
  scene.eigenstrains[0].strain_formula[0] = "0.02 * x";
  scene.supports[0].prescribed_displacement = {0.02, -0.03, 0.01};
  scene.supports[0].prescribed_rotation = {0.1, 0.2, -0.1};
  return scene;
}

/// A configuration with no symmetry, not in equilibrium: forces of the size of the loads, strains of a tenth.
State some_state(const Model& model) {
  std::mt19937_64 generator(kSeed);
  MixedVector increment = model.create_vector();
  fill_at_random(increment, 0.1, generator);
  const auto interior = increment.writable_interior(true);
  for (const ElementBlock& block : model.structure().blocks)
    for (int e = 0; e < block.count; ++e)
      for (int i = 0; i < block.interior.relative_rotation(1); ++i)
        interior(block.increment_offset + e * block.interior.increments() + i) *= 200.0;
  return model.apply(model.reference_state(), increment, 1.0);
}

/// In space.
Tangent tangent_at(const Model& model, const EvaluationPoint& point) {
  return Tangent(model, point, cap_for(model, point.scales), {true});
}

using Dense = std::vector<std::vector<double>>;

Dense dense(const DofMatrix& matrix) {
  const auto local = matrix.getLocalMatrixHost();
  Dense result(local.numRows(), std::vector<double>(local.numCols(), 0.0));
  for (int i = 0; i < local.numRows(); ++i)
    for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1); ++k)
      result[i][local.graph.entries(k)] += local.values(k);
  return result;
}

Dense dense_matrix(const Tangent& tangent) {
  const VertexMatrix matrix = whole_matrix(tangent.model());
  tangent.gather(matrix);
  return dense(*matrix.matrix());
}

TEST(Equations, RowGatherIsTheSumOverElements) {
  Scene scene = mixed_scene();
  scene.point_loads.clear();
  const Model model(scene, this_rank(), without_cap());
  const State state = some_state(model);
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, state, 1.0, residual);
  const Tangent tangent = tangent_at(model, point);
  const int n = kVertexDofs * model.mesh().vertices();
  Dense expected(n, std::vector<double>(n, 0.0)), size = expected;
  std::vector<double> rhs(n, 0.0), rhs_size(n, 0.0);
  const auto& equations = tangent.elements();
  for (const ElementBlock& block : model.structure().blocks)
    for (int e = 0; e < block.count; ++e) {
      double room[kFullTangent];
      const double* matrix =
          LinkMatrices<kSpatialDofs>{equations.condensed_tangent, {}}.full(block.first_element + e, room);
      for (int i = 0; i < 12; ++i) {
        const int row = kVertexDofs * block.vertices(e, i / 6) + i % 6;
        const double r = equations.condensed_residual(block.first_element + e, i);
        rhs[row] += r;
        rhs_size[row] += std::abs(r);
        for (int j = 0; j < 12; ++j) {
          const int column = kVertexDofs * block.vertices(e, j / 6) + j % 6;
          const double k = matrix[12 * i + j];
          expected[row][column] += k;
          size[row][column] += std::abs(k);
        }
      }
    }
  const int clamp = kVertexDofs * vertex_of(model.mesh(), "clamp");
  for (int c = clamp; c < clamp + kVertexDofs; ++c) {
    for (int j = 0; j < n; ++j) expected[c][j] = size[c][j] = c == j ? 1.0 : 0.0;
    rhs[c] = rhs_size[c] = residual.vertex()(c) * (c - clamp < 3 ? point.scales.length : 1.0);
  }
  const Dense actual = dense_matrix(tangent);
  const auto actual_rhs = MixedVector::view_of(tangent.condensed_rows());
  WorstError worst;
  for (int i = 0; i < n; ++i) {
    worst.see(std::abs(actual_rhs(i) - rhs[i]) / (std::abs(rhs_size[i]) + 1e-300), "right-hand side ", i);
    for (int j = 0; j < n; ++j)
      worst.see(std::abs(actual[i][j] - expected[i][j]) / (size[i][j] + 1e-300), "row ", i, ", column ", j);
  }
  // up to six elements at a vertex: as many roundings in the sum, in another order
  EXPECT_TRUE(worst.at_most(8 * kRounding));
}

TEST(Equations, MatrixTimesVectorIsThatOfTheDenseMatrix) {
  const Model model(loaded_scene(), this_rank(), {});
  const State state = some_state(model);
  MixedVector residual = model.create_vector();
  const Tangent tangent = tangent_at(model, mixed_residual(model, state, 1.0, residual));
  const VertexMatrix whole = whole_matrix(model);
  tangent.gather(whole);
  std::mt19937_64 generator(kSeed);
  MixedVector x = model.create_vector(), y = model.create_vector();
  fill_at_random(x, 1.0, generator);
  whole.matrix()->apply(x.vertex_dofs(), y.vertex_dofs());
  const Dense matrix = dense(*whole.matrix());
  WorstError worst;
  for (size_t i = 0; i < matrix.size(); ++i) {
    double sum = 0.0, size = 0.0;
    for (size_t j = 0; j < matrix.size(); ++j) {
      sum += matrix[i][j] * x.vertex()(j);
      size += std::abs(matrix[i][j]);
    }
    worst.see(std::abs(y.vertex()(i) - sum) / size, "row ", i);
  }
  EXPECT_TRUE(worst.at_most(40 * kRounding));  // products of up to 36 entries
}

/// What the rows of a scaled residual were divided by.
MixedVector row_scales(const Model& model, const ResidualScales& s) {
  MixedVector scales = model.create_vector();
  const auto vertex = scales.vertex();
  for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) = i % kVertexDofs < 3 ? s.force : s.moment;
  for (const Support& support : model.scene().supports) {
    const int v = vertex_of(model.mesh(), support.point);
    for (int c = 0; c < 3; ++c) {
      if (support.displacement_fixed[c]) vertex(kVertexDofs * v + c) = s.length;
      if (support.rotation_fixed[c]) vertex(kVertexDofs * v + 3 + c) = 1.0;
    }
  }
  const auto interior = scales.writable_interior(false);
  for (const ElementBlock& block : model.structure().blocks)
    for (int e = 0; e < block.count; ++e) {
      const InteriorLayout layout = block.interior;
      const size_t first = block.increment_offset + e * layout.increments();
      const double h = block.reference(e, 0);
      for (int i = 0; i < layout.increments(); ++i)
        interior(first + i) = i < layout.moment(0)              ? s.element_strain(h)
                              : i < layout.relative_rotation(1) ? s.rotation
                              : i < layout.bubble(1)            ? s.element_moment(h)
                              : i < layout.spin()               ? s.element_bubble(h)
                                                                : s.element_moment(h);
    }
  return scales;
}

struct UnscaledResidual {
  EvaluationPoint point;
  MixedVector rows;
};

UnscaledResidual unscaled_residual(const Model& model, const State& state, double load_factor = 1.0) {
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, state, load_factor, residual);
  residual.multiply_by(row_scales(model, point.scales));
  return {point, residual};
}

/// Solves the small dense system by Gaussian elimination with row pivoting.
std::vector<double> dense_solve(Dense a, std::vector<double> b) {
  const int n = static_cast<int>(b.size());
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    for (int i = k + 1; i < n; ++i) {
      const double f = a[i][k] / a[k][k];
      for (int j = k; j < n; ++j) a[i][j] -= f * a[k][j];
      b[i] -= f * b[k];
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    for (int j = k + 1; j < n; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

/// Vertex increment from what the tangent condensed, and the interior that belongs to it.
MixedVector newton_increment(const Tangent& tangent) {
  const auto condensed = MixedVector::view_of(tangent.condensed_rows());
  std::vector<double> rhs(condensed.extent(0));
  for (size_t i = 0; i < rhs.size(); ++i) rhs[i] = -condensed(i);
  const std::vector<double> solution = dense_solve(dense_matrix(tangent), rhs);
  MixedVector increment = tangent.model().create_vector();
  for (size_t i = 0; i < rhs.size(); ++i) increment.vertex()(i) = solution[i];
  tangent.recover(increment);
  return increment;
}

Vec3<double> entries(const KernelView<const double*>& v, size_t first) {
  return {{v(first), v(first + 1), v(first + 2)}};
}

/// The moments of the residual refer to a frame that turns with the increment: their derivative is that of the second
/// variation, which the tangent holds, plus half a turn of the unbalanced moment itself (left for vertices, whose spins
/// are spatial, right for elements, whose spins are material). Zero in equilibrium.
void add_turn_of_unbalanced_moments(const Model& model, const MixedVector& residual, const MixedVector& increment,
                                    MixedVector& derivative) {
  const KernelView<const double*> r = residual.vertex(), d = increment.vertex();
  const int clamp = vertex_of(model.mesh(), "clamp");
  for (int v = 0; v < model.mesh().vertices(); ++v) {
    if (v == clamp) continue;  // its rows are rotations, not moments
    const size_t first = kVertexDofs * v + 3;
    const Vec3<double> turn = 0.5 * cross(entries(d, first), entries(r, first));
    for (int i = 0; i < 3; ++i) derivative.vertex()(first + i) += turn[i];
  }
  const auto interior = derivative.writable_interior(true);
  for (const ElementBlock& block : model.structure().blocks)
    for (int e = 0; e < block.count; ++e) {
      const size_t first = block.increment_offset + e * block.interior.increments() + block.interior.spin();
      const Vec3<double> turn = 0.5 * cross(entries(residual.interior(), first), entries(increment.interior(), first));
      for (int i = 0; i < 3; ++i) interior(first + i) += turn[i];
    }
}

/// Largest difference between the central difference of the residual along `increment` and `expected`, each row
/// relative to the largest of its kind (the rows' scales).
double derivative_error(const Model& model, const EvaluationPoint& point, const MixedVector& increment,
                        const MixedVector& expected, double step) {
  const MixedVector scales = row_scales(model, point.scales);
  MixedVector difference = unscaled_residual(model, model.apply(point.state, increment, step)).rows;
  difference.update(-1.0, unscaled_residual(model, model.apply(point.state, increment, -step)).rows, 1.0);
  difference.scale(0.5 / step);
  difference.update(-1.0, expected, 1.0);
  MixedVector inverse = model.create_vector();
  inverse.reciprocals_of(scales);
  difference.multiply_by(inverse);
  return difference.maximum_norm();
}

/// Central differences err by step^2 times the third derivative; halving the step must divide the error by four until
/// round-off takes over.
void expect_derivative(const Model& model, const EvaluationPoint& point, const MixedVector& increment,
                       const MixedVector& expected) {
  constexpr double kStep = 1e-3, kQuadratic = 0.28, kRoundoff = 1e-9;
  const double coarse = derivative_error(model, point, increment, expected, kStep);
  const double fine = derivative_error(model, point, increment, expected, 0.5 * kStep);
  EXPECT_LT(fine, 1e-4);
  EXPECT_LE(fine, std::max(kQuadratic * coarse, kRoundoff)) << "coarse " << coarse;
}

void expect_newton_solves_the_linearised_system(const Scene& scene) {
  const Model model(scene, this_rank(), without_cap());
  const State state = some_state(model);
  const auto [point, residual] = unscaled_residual(model, state);
  Tangent tangent = tangent_at(model, point);
  MixedVector increment = newton_increment(tangent);
  MixedVector derivative = residual.clone(true);
  derivative.scale(-1.0);
  // the increment is as long as the imbalance of the random state; a shorter one has smaller third derivatives
  const double shorter = 0.1 / increment.largest_vertex_spin();
  increment.scale(shorter);
  derivative.scale(shorter);
  add_turn_of_unbalanced_moments(model, residual, increment, derivative);
  expect_derivative(model, point, increment, derivative);
}

TEST(Equations, NewtonSolvesTheLinearisedMixedSystem) { expect_newton_solves_the_linearised_system(loaded_scene()); }

TEST(Equations, NewtonWithOneKindOfLoadAtATime) {
  const Scene all = loaded_scene();
  for (size_t i = 0; i < all.point_loads.size(); ++i) {
    Scene scene = all;
    scene.distributed_loads.clear();
    scene.eigenstrains.clear();
    scene.point_loads = {all.point_loads[i]};
    expect_newton_solves_the_linearised_system(scene);
  }
  for (size_t i = 0; i < all.distributed_loads.size(); ++i) {
    Scene scene = all;
    scene.point_loads.clear();
    scene.distributed_loads = {all.distributed_loads[i]};
    expect_newton_solves_the_linearised_system(scene);
  }
  Scene scene = all;
  scene.point_loads.clear();
  expect_newton_solves_the_linearised_system(scene);
}

/// Where axial and shear forces have their own Gauss points, each point has rows without meaning: they stay zero.
void clear_masked_rows(const Model& model, MixedVector& v) {
  const auto interior = v.writable_interior(true);
  for (const ElementBlock& block : model.structure().blocks) {
    const int axial = axial_points(block.order, block.force_integration);
    if (axial == shear_points(block.order, block.force_integration)) continue;
    for (int e = 0; e < block.count; ++e)
      for (int q = 0; q < block.interior.force_points; ++q)
        for (int i = 0; i < 3; ++i)
          if ((q < axial) != (i == 0))
            interior(block.increment_offset + e * block.interior.increments() + block.interior.force(q) + i) = 0.0;
  }
}

/// A random right-hand side in place of the residual: K d = -rhs, the K of the residual.
TEST(Equations, CondensedRightHandSidesSolveTheSameSystem) {
  Scene scene = loaded_scene();
  scene.supports[0].prescribed_rotation = {};
  const Model model(scene, this_rank(), without_cap());
  const State state = some_state(model);
  // Where the clamp is, its rows are the rotation itself; elsewhere that holds along the Newton direction only.
  const int clamp = vertex_of(model.mesh(), "clamp");
  store_quaternion(identity_quaternion<double>(), &state.views.vertex_rotation(clamp, 0));
  const auto [point, residual] = unscaled_residual(model, state);
  Tangent tangent = tangent_at(model, point);
  std::mt19937_64 generator(kSeed + 1);
  for (int sample = 0; sample < 3; ++sample) {
    MixedVector rhs = model.create_vector();
    fill_at_random(rhs, 1e-3, generator);  // scaled: rows of size one
    clear_masked_rows(model, rhs);
    tangent.condense(rhs);
    MixedVector increment = newton_increment(tangent);
    MixedVector derivative = rhs.clone(true);
    derivative.multiply_by(row_scales(model, point.scales));
    derivative.scale(-1.0);
    const double shorter = 0.1 / std::max(0.1, increment.largest_vertex_spin());
    increment.scale(shorter);
    derivative.scale(shorter);
    add_turn_of_unbalanced_moments(model, residual, increment, derivative);
    expect_derivative(model, point, increment, derivative);
  }
}

// The twin that must fail: a wrong entry of the increment is seen.
/// A right-hand side of construction is condensed as a later one, to the bit, and no other is taken for it.
TEST(Equations, RightHandSideOfConstruction) {
  for (const bool is_planar : {false, true}) {
    Scene scene = is_planar ? cantilever(section(1e3, 1e3, 10.0, 10.0), 1.0, 3, 4) : loaded_scene();
    if (is_planar) scene.distributed_loads = {{"beam", {0, -3, 0}, {}, 1}};
    const Model model(scene, this_rank(), without_cap());
    const State state = is_planar ? model.reference_state() : some_state(model);
    ASSERT_EQ(state.in_plane, is_planar);
    MixedVector rows = model.create_vector(), slope = rows.clone(false);
    const EvaluationPoint point = mixed_residual(model, state, 0.5, rows);
    load_derivative(model, state, 0.5, point.scales, slope);
    TangentKind kind;
    Tangent later(model, point, cap_for(model, point.scales), kind);
    kind.right_hand_side = &slope;
    Tangent first(model, point, cap_for(model, point.scales), kind);
    const auto recovered = [&](Tangent& tangent) {
      MixedVector increment = model.create_vector();
      fill_at_random(increment, 0.1, kSeed);
      if (is_planar) increment.fill(0.0);
      tangent.recover(increment);
      return increment;
    };
    EXPECT_FALSE(recovered(first).same_values(recovered(later))) << "that one still holds the residual";
    for (const MixedVector& rhs : {slope, rows}) {
      later.condense(rhs);
      first.condense(rhs);
      EXPECT_TRUE(recovered(first).same_values(recovered(later)));
      const auto a = MixedVector::view_of(first.condensed_rows()), b = MixedVector::view_of(later.condensed_rows());
      for (size_t i = 0; i < a.extent(0); ++i) EXPECT_EQ(a(i), b(i)) << i;
    }
    EXPECT_EQ(dense_matrix(first), dense_matrix(later));
  }
}

/// Loads that are the same in all elements of a member have one row for them; beside one that changes along it each
/// element has its own. What they do adds up all the same.
TEST(Equations, ElementsShareTheRowsOfConstantLineLoads) {
  Scene scene = mixed_scene();
  scene.point_loads.clear();
  DistributedLoad constant{"shaft", {5, -6, 7}, {2, -1, 3}, 1}, varying = constant;
  varying.force_formula = {"5 * x", "", ""};
  const int points = scene.members[0].order + 1, elements = scene.members[0].elements;
  int rows = 0;
  const auto rows_under = [&](const std::vector<DistributedLoad>& loads) {
    scene.distributed_loads = loads;
    const Model model(scene, this_rank(), without_cap());
    rows = model.line_fields().rows();
    MixedVector result = model.create_vector();
    element_rows(model, some_state(model), 1.0, ElementLoads::line_loads, result);
    return std::vector<double>(result.interior().data(), result.interior().data() + result.interior().extent(0));
  };
  const std::vector<double> none = rows_under({}), one = rows_under({constant});
  EXPECT_EQ(rows, 2 * points);
  const std::vector<double> other = rows_under({varying});
  EXPECT_EQ(rows, points * elements + points);
  const std::vector<double> both = rows_under({constant, varying});
  EXPECT_EQ(rows, points * elements + points);
  const auto missing = [&](double share) {
    double largest = 0.0;
    for (size_t i = 0; i < none.size(); ++i)
      largest = std::max(largest, std::abs(both[i] - none[i] - share * (one[i] - none[i]) - (other[i] - none[i])));
    return largest;
  };
  constexpr double kRoundings = 1e-11;  // of rows below a thousand
  EXPECT_LE(missing(1.0), kRoundings);
  EXPECT_GT(missing(1.0 + 1e-6), kRoundings);
}

TEST(Equations, CapCutsOffTheStiffEndOfATaper) {
  Scene scene = cantilever(section(100.0, 100.0, 1.0, 1.0), 1.0, 2, 2);
  scene.sections.push_back(section(1e9, 100.0, 1.0, 1.0));
  scene.sections[1].name = "stiff";
  for (const bool tapers : {false, true}) {
    scene.members[0].end_section = tapers ? "stiff" : "";
    const Model model(scene, this_rank(), {});
    MixedVector residual = model.create_vector();
    const Cap cap = cap_for(model, mixed_residual(model, model.reference_state(), 0.0, residual).scales);
    EXPECT_EQ(cap.cuts_off, tapers);
    EXPECT_EQ(cap.least_ratio > 0.0, tapers);
  }
}

TEST(Equations, AWrongIncrementIsSeen) {
  const Model model(loaded_scene(), this_rank(), without_cap());
  const State state = some_state(model);
  const auto [point, residual] = unscaled_residual(model, state);
  Tangent tangent = tangent_at(model, point);
  MixedVector increment = newton_increment(tangent);
  increment.vertex()(kVertexDofs * vertex_of(model.mesh(), "branch") + 4) += 1e-2;
  MixedVector derivative = residual.clone(true);
  derivative.scale(-1.0);
  const double shorter = 0.1 / increment.largest_vertex_spin();
  increment.scale(shorter);
  derivative.scale(shorter);
  add_turn_of_unbalanced_moments(model, residual, increment, derivative);
  EXPECT_GT(derivative_error(model, point, increment, derivative, 1e-3), 1e-3);
}

TEST(Equations, LoadDerivativeIsThatOfTheResidual) {
  for (double load_factor : {0.3, 0.8}) {
    const Model model(loaded_scene(), this_rank(), {});
    const State state = some_state(model);
    // The clamp where it should be, as in the converged state that LOCA asks about.
    const Vector3& turn = model.scene().supports[0].prescribed_rotation;
    store_quaternion(exp_quaternion(load_factor * Vec3<double>{{turn[0], turn[1], turn[2]}}),
                     &state.views.vertex_rotation(vertex_of(model.mesh(), "clamp"), 0));
    constexpr double kStep = 1e-4;
    const MixedVector low = unscaled_residual(model, state, load_factor - kStep).rows;
    MixedVector high = unscaled_residual(model, state, load_factor + kStep).rows, derivative = model.create_vector();
    const ResidualScales scales = scales_of(model, state, load_factor);
    load_derivative(model, state, load_factor, scales, derivative);
    derivative.multiply_by(row_scales(model, scales));
    high.update(-1.0, low, 1.0);
    high.scale(0.5 / kStep);
    WorstError worst;
    for (size_t i = 0; i < high.vertex().extent(0); ++i)
      worst.see(std::abs(high.vertex()(i) - derivative.vertex()(i)) / (1.0 + std::abs(derivative.vertex()(i))), "row ",
                i);
    const KernelView<const double*> a = high.interior(), b = derivative.interior();
    for (size_t i = 0; i < a.extent(0); ++i)
      worst.see(std::abs(a(i) - b(i)) / (1.0 + std::abs(b(i))), "interior row ", i);
    // loads are linear in the load factor: rounding of forces of size 100, divided by the step
    EXPECT_TRUE(worst.at_most(100 * 16 * kRounding / kStep)) << "load factor " << load_factor;
  }
}

/// Other units of length and force; powers of two, so that no digit changes.
constexpr double kLength = 1048576.0, kForce = 1.0 / 4194304.0;

TEST(Equations, ScaledResidualDoesNotKnowTheUnits) {
  const Scene scene = loaded_scene();
  const Model here(scene, this_rank(), {}), there(in_other_units(scene, kLength, kForce), this_rank(), {});
  const State a = some_state(here), b = there.reference_state();
  Kokkos::deep_copy(b.views.vertex_rotation, a.views.vertex_rotation);
  Kokkos::deep_copy(b.views.element_triad, a.views.element_triad);
  for (size_t v = 0; v < a.views.vertex_displacement.extent(0); ++v)
    for (int i = 0; i < 3; ++i) b.views.vertex_displacement(v, i) = kLength * a.views.vertex_displacement(v, i);
  for (const ElementBlock& block : here.structure().blocks)
    for (int e = 0; e < block.count; ++e)
      for (int i = 0; i < block.interior.unknowns(); ++i) {
        const size_t place = block.interior_offset + e * block.interior.unknowns() + i;
        const double factor = i < block.interior.moment(0)              ? kForce
                              : i < block.interior.relative_rotation(1) ? kForce * kLength
                                                                        : 1.0;
        b.views.interior(place) = factor * a.views.interior(place);
      }
  MixedVector ra = here.create_vector(), rb = there.create_vector();
  mixed_residual(here, a, 0.7, ra);
  mixed_residual(there, b, 0.7, rb);
  EXPECT_GT(ra.maximum_norm(), 1e-3);
  EXPECT_NEAR(equilibrium_norm(there, rb), equilibrium_norm(here, ra), 64 * kRounding * equilibrium_norm(here, ra));
  rb.update(-1.0, ra, 1.0);
  EXPECT_LE(rb.maximum_norm(), 64 * kRounding * ra.maximum_norm());
}

TEST(Equations, EquilibriumNormLeavesOutStrainsAndSupports) {
  const Model model(loaded_scene(), this_rank(), {});
  MixedVector v = model.create_vector();
  v.fill(0.0);
  const ElementBlock& block = model.structure().blocks.front();
  v.writable_interior(true)(block.increment_offset + block.interior.force(0)) = 3.0;
  v.writable_interior(true)(block.increment_offset + block.interior.moment(0)) = 4.0;
  v.vertex()(kVertexDofs * vertex_of(model.mesh(), "clamp") + 2) = 5.0;
  EXPECT_EQ(equilibrium_norm(model, v), 0.0);
  v.writable_interior(true)(block.increment_offset + block.interior.spin()) = -0.5;
  EXPECT_EQ(equilibrium_norm(model, v), 0.5);
  v.vertex()(kVertexDofs * vertex_of(model.mesh(), "branch") + 3) = -2.0;
  EXPECT_EQ(equilibrium_norm(model, v), 2.0);
  v.vertex()(kVertexDofs * vertex_of(model.mesh(), "branch")) = std::nan("");
  EXPECT_FALSE(std::isfinite(equilibrium_norm(model, v)));
}

TEST(Equations, LargestEndAngleNamesTheElement) {
  const Model model(loaded_scene(), this_rank(), {});
  const State state = model.reference_state();
  const int vertex = vertex_of(model.mesh(), "tine 1");
  const Quaternion<double> turn = exp_quaternion(Vec3<double>{{0.0, 1.5, 0.0}});
  store_quaternion(turn, &state.views.vertex_rotation(vertex, 0));
  MixedVector residual = model.create_vector();
  const EndAngle angle = largest_end_angle(model, mixed_residual(model, state, 0.0, residual));
  // relative to the reference, where ends of elements and vertices agree for every curve
  EXPECT_NEAR(angle.angle, 1.5, 8 * kRounding);
  const Scene& scene = model.scene();
  const Member& member = scene.members[member_index(scene, angle.member)];
  EXPECT_TRUE(member.start_point == "tine 1" || member.end_point == "tine 1") << angle.member;
  EXPECT_EQ(angle.element, member.start_point == "tine 1" ? 0 : member.elements - 1);
}

}  // namespace
}  // namespace mixbeam::test
