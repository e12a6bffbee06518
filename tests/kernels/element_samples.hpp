/// Random elements, as plain values for the energy and as a block of the kernels, from the same numbers.
#pragma once

#include "kernels/loops/block.hpp"
#include "tests/kernels/element_energy.hpp"

#include <array>
#include <cstdint>
#include <ostream>
#include <random>
#include <vector>

namespace mixbeam::element_test {

class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : generator_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(generator_() >> 11);
  }
  Vec3<double> vector(double size) { return {{between(-size, size), between(-size, size), between(-size, size)}}; }
  Vec3<double> direction() {
    Vec3<double> v = vector(1.0);
    while (norm(v) < 0.1 || norm(v) > 1.0) v = vector(1.0);
    return (1.0 / norm(v)) * v;
  }
  Quaternion<double> rotation() { return exp_quaternion(between(0.0, 3.1) * direction()); }

 private:
  std::mt19937_64 generator_;
};

/// A random element and its state.
struct ElementSample {
  EnergyElement element;
  EnergyState<double> state;
  Vec3<double> tangent_force_stiffness;
};

/// Which element to draw. Everything else follows from the seed.
struct SampleRecipe {
  int order;
  ForceIntegration rule;
  std::uint64_t seed;
  double psi = 0.8;              ///< size of psi_ho at its larger end, radians
  double end_angle = 2.5;        ///< relative rotation between element and vertex, radians
  bool exact_end_angle = false;  ///< else drawn between zero and end_angle
  bool curved = true;            ///< reference curve
};

inline std::ostream& operator<<(std::ostream& out, const SampleRecipe& recipe) {
  return out << "order " << recipe.order << ", integration rule " << static_cast<int>(recipe.rule) << ", seed "
             << recipe.seed << ", |psi| " << recipe.psi << ", end angle " << recipe.end_angle
             << (recipe.curved ? ", curved" : ", straight");
}

constexpr ForceIntegration kAllRules[] = {ForceIntegration::full, ForceIntegration::axial_reduced,
                                          ForceIntegration::shear_reduced, ForceIntegration::both_reduced};

inline EnergyElement random_element(const SampleRecipe& recipe, RandomNumbers& random) {
  EnergyElement element;
  element.order = recipe.order;
  element.rule = recipe.rule;
  const double size = recipe.curved ? 0.6 : 0.0;
  element.curve = {random.between(0.7, 1.5), random.rotation(), random.vector(size), random.vector(size)};
  for (int i = 0; i < 3; ++i) {
    element.force_compliance[i] = 1.0 / random.between(200.0, 1000.0);
    element.moment_compliance[i] = 1.0 / random.between(1.0, 10.0);
  }
  return element;
}

/// Random N, M, psi, u'. Components of N whose part of the energy is integrated elsewhere are zero.
inline void draw_interior(const SampleRecipe& recipe, RandomNumbers& random, EnergyState<double>& state) {
  const int k = recipe.order, axial = axial_points(k, recipe.rule), shear = shear_points(k, recipe.rule);
  for (int q = 0; q < (axial == shear ? axial : axial + shear); ++q) {
    Vec3<double> force = random.vector(20.0);
    if (axial != shear && q < axial) force[1] = force[2] = 0.0;
    if (axial != shear && q >= axial) force[0] = 0.0;
    state.force.push_back(force);
  }
  for (int j = 0; j <= k; ++j) state.moment.push_back(random.vector(3.0 / (1 + j)));
  for (int j = 1; j < k; ++j) {
    state.relative_rotation.push_back(random.vector(1.0 / j));
    state.slope.push_back(random.vector(0.3 / j));
  }
  if (k > 1) {
    const double left = norm(relative_rotation_at(state, -1.0)), right = norm(relative_rotation_at(state, 1.0));
    for (auto& psi : state.relative_rotation) psi = (recipe.psi / std::max(left, right)) * psi;
  }
}

inline ElementSample random_sample(const SampleRecipe& recipe) {
  RandomNumbers random(recipe.seed);
  ElementSample sample;
  sample.element = random_element(recipe, random);
  EnergyState<double>& state = sample.state;
  draw_interior(recipe, random, state);
  state.element_triad = random.rotation();
  for (int end = 0; end < 2; ++end) {
    const double xi = end == 0 ? -1.0 : 1.0;
    const double angle = recipe.end_angle * (recipe.exact_end_angle ? 1.0 : random.between(0.0, 1.0));
    const Quaternion<double> phi = exp_quaternion(angle * random.direction());
    state.vertex_rotation[end] =
        normalized(element_rotation_at(state, xi) * phi * conjugate(sample.element.curve.triad(xi)));
    state.displacement[end] = random.vector(0.5);
  }
  for (int i = 0; i < 3; ++i) sample.tangent_force_stiffness[i] = 1.0 / sample.element.force_compliance[i];
  return sample;
}

/// Kinds of line fields, as bits.
constexpr unsigned bit(LineField kind) { return 1u << static_cast<int>(kind); }
constexpr unsigned kAllFields = (1u << kLineFields) - 1;

/// Random line fields of these kinds, linear along the element.
inline void add_fields(EnergyElement& element, unsigned kinds, std::uint64_t seed) {
  RandomNumbers random(seed + 1000);
  const auto add = [&](LineField kind, LinearField EnergyElement::*field, double start, double growth) {
    const LinearField drawn = {random.vector(start), random.vector(growth)};
    if ((kinds & bit(kind)) != 0) element.*field = drawn;
  };
  add(LineField::dead_force, &EnergyElement::line_force, 5.0, 3.0);
  add(LineField::dead_couple, &EnergyElement::line_couple, 5.0, 3.0);
  add(LineField::follower_force, &EnergyElement::follower_force, 5.0, 3.0);
  add(LineField::follower_couple, &EnergyElement::follower_couple, 5.0, 3.0);
  add(LineField::eigenstrain, &EnergyElement::eigenstrain, 0.5, 0.5);
  add(LineField::eigencurvature, &EnergyElement::eigencurvature, 2.0, 2.0);
}

/// Legendre coefficients of r0' as far as the element can rotate it: the interpolant of degree k - 1 at k Gauss points.
/// A straight reference is its own interpolant. A curved one integrated with k + 1 points is not: rigid rotations of
/// such an element are rigid only up to its approximation of the curve, and no exact statement holds.
inline std::vector<Vec3<double>> interpolated_tangent(const EnergyElement& element) {
  const int k = element.order;
  std::vector<double> xi(k), weight(k), p(k + 1);
  gauss_rule(k, xi.data(), weight.data());
  std::vector<Vec3<double>> coefficient(k, Vec3<double>{{0.0, 0.0, 0.0}});
  for (int q = 0; q < k; ++q) {
    legendre(k, xi[q], p.data());
    for (int j = 0; j < k; ++j) coefficient[j] += (0.5 * (2 * j + 1) * weight[q] * p[j]) * element.curve.tangent(xi[q]);
  }
  return coefficient;
}

/// The state after rotation about the origin and translation of the whole element.
inline EnergyState<double> moved(const EnergyElement& element, const EnergyState<double>& state,
                                 const Quaternion<double>& rotation, const Vec3<double>& translation) {
  const Mat3<double> turn = rotation_matrix(rotation);
  const std::vector<Vec3<double>> tangent = interpolated_tangent(element);
  const double h = element.curve.length;
  EnergyState<double> result = state;
  const Vec3<double> chord = h * tangent[0] + state.displacement[1] - state.displacement[0];
  result.displacement[0] = turn * state.displacement[0] + translation;
  result.displacement[1] = result.displacement[0] + turn * chord - h * tangent[0];
  for (size_t j = 0; j < state.slope.size(); ++j)
    result.slope[j] = turn * (tangent[j + 1] + state.slope[j]) - tangent[j + 1];
  for (int end = 0; end < 2; ++end) result.vertex_rotation[end] = normalized(rotation * state.vertex_rotation[end]);
  result.element_triad = normalized(rotation * state.element_triad);
  return result;
}

/// A stress-free element: straight, or of constant curvature, where psi_ho is linear in s and the element represents it
/// exactly. Moved by a large rigid motion.
inline ElementSample stress_free_sample(const SampleRecipe& recipe) {
  ElementSample sample = random_sample(recipe);
  EnergyElement& element = sample.element;
  EnergyState<double>& state = sample.state;
  element.curve.bend = Vec3<double>{{0.0, 0.0, 0.0}};
  for (auto* field : {&state.force, &state.moment, &state.relative_rotation, &state.slope})
    for (auto& coefficient : *field) coefficient = Vec3<double>{{0.0, 0.0, 0.0}};
  if (element.order > 1) state.relative_rotation[0] = (0.5 * element.curve.length) * element.curve.turn;
  for (int end = 0; end < 2; ++end) {
    state.displacement[end] = Vec3<double>{{0.0, 0.0, 0.0}};
    state.vertex_rotation[end] = identity_quaternion<double>();
  }
  state.element_triad = element.curve.triad(0.0);
  RandomNumbers random(recipe.seed);
  state = moved(element, state, exp_quaternion(5.0 * random.direction()), random.vector(1.0));
  return sample;
}

/// Elements of one order and rule as the kernels see them. Offsets and numbers are not those of a block alone in the
/// world.
class SampleBlock {
 public:
  explicit SampleBlock(const std::vector<ElementSample>& samples, bool with_loads = false) {
    const EnergyElement& first = samples.front().element;
    const int count = static_cast<int>(samples.size()), points = force_point_count(first.order, first.rule);
    block.order = first.order;
    block.force_integration = first.rule;
    block.first_element = 2;
    block.count = count;
    block.interior_offset = 5;
    block.increment_offset = 7;
    block.response_offset = 11;
    block.interior = InteriorLayout{first.order, points};
    block.reference_layout = ReferenceLayout{first.order, points};
    allocate(with_loads);
    for (int e = 0; e < count; ++e) {
      fill_element(e, samples[e].element);
      fill_state(e, samples[e].state);
      fill_section(e, samples[e]);
      if (with_loads) fill_fields(e, samples[e].element);
    }
  }

  ElementBlock block;
  StructureViews structure;
  StateViews state;
  ElementEquations equations;

  int increments() const { return block.interior.increments(); }
  /// Increments of the interior of what was condensed last while the vertices stand still; a copy.
  KernelView<double*> constants() const {
    const KernelView<double*> copy("constants", equations.constants.extent(0));
    Kokkos::deep_copy(copy, equations.constants);
    return copy;
  }
  int interior_row(int e) const { return static_cast<int>(block.increment_offset) + e * increments(); }
  int element_row(int e) const { return block.first_element + e; }

  /// State of element e as the views hold it.
  EnergyState<double> state_of(int e) const {
    EnergyState<double> s;
    const InteriorLayout& layout = block.interior;
    for (int end = 0; end < 2; ++end) {
      const int v = vertex(e, end);
      for (int i = 0; i < 3; ++i) s.displacement[end][i] = state.vertex_displacement(v, i);
      s.vertex_rotation[end] = quaternion(state.vertex_rotation, v);
    }
    s.element_triad = quaternion(state.element_triad, element_row(e));
    const double* x = interior(e);
    for (int q = 0; q < layout.force_points; ++q) s.force.push_back(vector(x + layout.force(q)));
    for (int j = 0; j <= layout.order; ++j) s.moment.push_back(vector(x + layout.moment(j)));
    for (int j = 1; j < layout.order; ++j) s.relative_rotation.push_back(vector(x + layout.relative_rotation(j)));
    for (int j = 1; j < layout.order; ++j) s.slope.push_back(vector(x + layout.bubble(j)));
    return s;
  }

  /// Vertices are numbered backwards: a kernel that takes element numbers for vertex numbers fails.
  int vertex(int e, int end) const { return 2 * (block.count - e) - 1 - end; }
  void set_vertex_rotation(int v, const Quaternion<double>& q) const { set(q, &state.vertex_rotation(v, 0)); }
  double* interior(int e) const {
    return state.interior.data() + block.interior_offset + static_cast<size_t>(e) * block.interior.unknowns();
  }

 private:
  static Vec3<double> vector(const double* x) { return {{x[0], x[1], x[2]}}; }
  static Quaternion<double> quaternion(const KernelView<double* [4]>& view, int row) {
    return {view(row, 0), view(row, 1), view(row, 2), view(row, 3)};
  }
  static void set(const Vec3<double>& v, double* x) {
    for (int i = 0; i < 3; ++i) x[i] = v[i];
  }
  static void set(const Quaternion<double>& q, double* x) {
    x[0] = q.w;
    x[1] = q.x;
    x[2] = q.y;
    x[3] = q.z;
  }

  void allocate(bool with_loads) {
    const int count = block.count, elements = block.first_element + count;
    const size_t rows = block.increment_offset + static_cast<size_t>(count) * increments();
    block.reference = KernelView<double**>("reference", count, block.reference_layout.size());
    block.vertices = KernelView<int* [2]>("vertices", count);
    block.section = KernelView<int*>("section", count);
    structure.sections = KernelView<SectionConstants*>("sections", count);
    if (with_loads) {
      block.field_row = KernelView<int* [kLineFields]>("field_row", count);
      structure.field_value = KernelView<double* [3]>("field_value", count * kLineFields * kMostPoints);
    }
    state.vertex_displacement = KernelView<double* [3]>("displacement", 2 * count);
    state.vertex_rotation = KernelView<double* [4]>("rotation", 2 * count);
    state.element_triad = KernelView<double* [4]>("triad", elements);
    state.interior = KernelView<double*>("interior", block.interior_offset + count * block.interior.unknowns());
    equations.residual = KernelView<double* [12]>("residual", elements);
    equations.planar_rows = KernelView<double* [4]>("planar_rows", elements);
    if (with_loads) equations.planar_loads = KernelView<double* [2]>("planar_loads", elements);
    equations.interior_residual = KernelView<double*>("interior_residual", rows);
    equations.condensed_residual = KernelView<double* [12]>("condensed_residual", elements);
    equations.condensed_tangent = KernelView<double**>("condensed_tangent", elements, kFullTangent);
    equations.response = KernelView<double*>("response", block.response_offset + count * block.response_size());
    equations.constants = KernelView<double*>("constants", rows);
    equations.largest_end_angle = KernelView<double*>("largest_end_angle", elements);
  }

  void fill_element(int e, const EnergyElement& element) {
    const int axial = axial_points(element.order, element.rule), shear = shear_points(element.order, element.rule);
    double* row = &block.reference(e, 0);
    row[block.reference_layout.length()] = element.curve.length;
    for (int end = 0; end < 2; ++end) {
      set(element.curve.triad(end == 0 ? -1.0 : 1.0), row + block.reference_layout.end_triad(end));
      block.vertices(e, end) = vertex(e, end);
    }
    fill_tangents(element, axial, 0, row);
    if (axial != shear) fill_tangents(element, shear, axial, row);
    std::vector<double> xi(element.order + 1), weight(element.order + 1);
    gauss_rule(element.order + 1, xi.data(), weight.data());
    for (int q = 0; q <= element.order; ++q)
      set(element.curve.curvature(xi[q]), row + block.reference_layout.curvature(q));
    block.section(e) = block.count - 1 - e;
  }
  void fill_tangents(const EnergyElement& element, int points, int offset, double* row) {
    std::vector<double> xi(points), weight(points);
    gauss_rule(points, xi.data(), weight.data());
    for (int q = 0; q < points; ++q)
      set(element.curve.tangent(xi[q]), row + block.reference_layout.tangent(offset + q));
  }
  void fill_state(int e, const EnergyState<double>& s) {
    const InteriorLayout& layout = block.interior;
    for (int end = 0; end < 2; ++end) {
      set(s.displacement[end], &state.vertex_displacement(vertex(e, end), 0));
      set(s.vertex_rotation[end], &state.vertex_rotation(vertex(e, end), 0));
    }
    set(s.element_triad, &state.element_triad(element_row(e), 0));
    double* x = interior(e);
    for (int q = 0; q < layout.force_points; ++q) set(s.force[q], x + layout.force(q));
    for (int j = 0; j <= layout.order; ++j) set(s.moment[j], x + layout.moment(j));
    for (int j = 1; j < layout.order; ++j) set(s.relative_rotation[j - 1], x + layout.relative_rotation(j));
    for (int j = 1; j < layout.order; ++j) set(s.slope[j - 1], x + layout.bubble(j));
  }
  void fill_section(int e, const ElementSample& sample) {
    SectionConstants& section = structure.sections(block.section(e));
    for (int i = 0; i < 3; ++i) {
      section.force_compliance[i] = sample.element.force_compliance[i];
      section.tangent_force_stiffness[i] = sample.tangent_force_stiffness[i];
      section.moment_compliance[i] = sample.element.moment_compliance[i];
      section.moment_stiffness[i] = 1.0 / sample.element.moment_compliance[i];
    }
    // only general sections read them
    section.force_stiffness_limit = section.moment_stiffness_limit = 0.0;
  }
  /// Fields that are zero have no row at all, as in a scene without them.
  void fill_fields(int e, const EnergyElement& element) {
    const int axial = axial_points(element.order, element.rule), shear = shear_points(element.order, element.rule);
    const auto fill = [&](LineField kind, const LinearField& field) {
      const int row = (e * kLineFields + static_cast<int>(kind)) * kMostPoints;
      block.field_row(e, static_cast<int>(kind)) = field.is_zero() ? -1 : row;
      block.kinds_of_fields |= field.is_zero() ? 0U : 1U << static_cast<int>(kind);
      if (kind == LineField::eigenstrain) {
        fill_values(field, axial, row);
        if (axial != shear) fill_values(field, shear, row + axial);
      } else {
        fill_values(field, element.order + 1, row);
      }
    };
    fill(LineField::dead_force, element.line_force);
    fill(LineField::dead_couple, element.line_couple);
    fill(LineField::follower_force, element.follower_force);
    fill(LineField::follower_couple, element.follower_couple);
    fill(LineField::eigenstrain, element.eigenstrain);
    fill(LineField::eigencurvature, element.eigencurvature);
  }
  void fill_values(const LinearField& field, int points, int row) {
    std::vector<double> xi(points), weight(points);
    gauss_rule(points, xi.data(), weight.data());
    for (int q = 0; q < points; ++q) set(field.at(xi[q]), &structure.field_value(row + q, 0));
  }
  static constexpr int kMostPoints = 2 * kMaximumOrder + 1;
};

}  // namespace mixbeam::element_test
