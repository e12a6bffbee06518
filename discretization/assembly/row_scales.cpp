#include "discretization/assembly/row_scales.hpp"

#include "kernels/element/kinematics.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Strains and relative rotations are differences of numbers of size one (and of u/h): a few roundings each.
constexpr double kRoundings = 16.0;

/// Without any load the internal forces must vanish; a force of this fraction of EI/L^2 times the tolerance moves
/// nothing by more than a rounding error of the length.
constexpr double kUnloadedForce = 1e-6;

/// Of the structure's length: beyond it a path has gone astray, and rounding would excuse any strain.
constexpr double kLargestDisplacement = 1e6;

}  // namespace

ResidualScales residual_scales(const StateMagnitude& state, double length, double shortest_element,
                               double bending_stiffness, double tolerance) {
  ResidualScales scales;
  const bool loaded = state.load_force > 0.0 || state.load_moment > 0.0;
  const double floor = loaded ? 0.0 : kUnloadedForce * bending_stiffness / (length * length);
  const double moment = std::max(state.moment, state.load_moment);
  scales.force = std::max({state.force, state.load_force, moment / length, floor});
  scales.moment = std::max(moment, scales.force * shortest_element);
  const double noise = kRoundings * std::numeric_limits<double>::epsilon() / tolerance;
  const double amplitude = std::min(1.0, std::max({state.rotation, state.displacement / length, state.eigenstrain}));
  scales.rotation = std::max(amplitude, noise);
  scales.strain = std::max(amplitude, noise);
  scales.displacement_noise = noise * std::min(state.displacement, kLargestDisplacement * length);
  scales.length = length;
  scales.amplitude = amplitude;
  return scales;
}

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

double largest_component(const Vec& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

/// Without what is not a number.
KOKKOS_INLINE_FUNCTION void raise(double& largest, const double* x, int count) {
  for (int i = 0; i < count; ++i) {
    const double a = x[i] < 0.0 ? -x[i] : x[i];
    if (a > largest) largest = a;
  }
}

/// Forces and moments of all elements of a block.
Largest<2> largest_stresses(const ElementBlock& block, const KernelView<const double*>& interior) {
  const InteriorLayout layout = block.interior;
  const size_t offset = block.interior_offset;
  return largest_of<2>(
      "mixbeam::magnitude::stresses", block.count, KOKKOS_LAMBDA(int e, Largest<2>& pair) {
        const double* x = interior.data() + offset + static_cast<size_t>(e) * layout.unknowns();
        raise(pair.of[0], x, layout.moment(0));
        raise(pair.of[1], x + layout.moment(0), 3 * (layout.order + 1));
      });
}

}  // namespace

StateMagnitude magnitude_of(const Model& model, const State& state, double load_factor) {
  const Structure& structure = model.structure();
  StateMagnitude m;
  for (const ElementBlock& block : structure.blocks) {
    const Largest<2> stresses = largest_stresses(block, state.views.interior);
    m.force = std::max(m.force, stresses.of[0]);
    m.moment = std::max(m.moment, stresses.of[1]);
  }
  const KernelView<const double* [3]> u = state.views.vertex_displacement;
  const KernelView<const double* [4]> q = state.views.vertex_rotation;
  const Largest<2> motions = largest_of<2>(
      "mixbeam::magnitude::motions", structure.owned_vertices, KOKKOS_LAMBDA(int v, Largest<2>& pair) {
        raise(pair.of[0], &u(v, 0), 3);
        const double square = q(v, 1) * q(v, 1) + q(v, 2) * q(v, 2) + q(v, 3) * q(v, 3);
        if (square > pair.of[1]) pair.of[1] = square;
      });
  m.displacement = motions.of[0];
  m.rotation = 2.0 * std::sqrt(motions.of[1]);
  for (const VertexLoad& load : model.conditions().loads) {
    const double amplitude = std::abs(load.amplitude(load_factor));
    m.load_force = std::max(m.load_force, amplitude * largest_component(load.force));
    m.load_moment = std::max(m.load_moment, amplitude * largest_component(load.moment));
  }
  const LineFieldMagnitude fields = model.line_fields().magnitude(load_factor);
  m.load_force = std::max(m.load_force, fields.force);
  // what would bend the structure as the eigencurvature does: else a free member, in equilibrium without any force,
  // would be measured against its own rounding errors
  m.load_moment = std::max({m.load_moment, fields.couple, structure.bending_reference * fields.curvature});
  m.eigenstrain = std::max(fields.strain, fields.turn);
  if (!model.vertex_maps().import.is_null()) {
    double mine[7] = {m.force, m.moment, m.displacement, m.rotation, m.load_force, m.load_moment, m.eigenstrain};
    double all[7];
    Teuchos::reduceAll(*model.map()->getComm(), Teuchos::REDUCE_MAX, 7, mine, all);
    m = {all[0], all[1], all[2], all[3], all[4], all[5], all[6]};
  }
  return m;
}

ResidualScales scales_of(const Model& model, const State& state, double load_factor) {
  const Structure& structure = model.structure();
  return residual_scales(magnitude_of(model, state, load_factor), structure.length, structure.shortest_element,
                         structure.bending_reference, model.options().residual_tolerance);
}

RowKind kind_of_vertex_row(int component, bool fixed) {
  if (component < 3) return fixed ? RowKind::held_displacement : RowKind::vertex_displacement;
  return fixed ? RowKind::held_rotation : RowKind::vertex_rotation;
}

RowKind kind_of_interior_row(const InteriorLayout& layout, int row) {
  if (row < layout.moment(0)) return RowKind::element_force;
  if (row < layout.relative_rotation(1)) return RowKind::element_moment;
  if (row < layout.bubble(1)) return RowKind::element_rotation;
  return row < layout.spin() ? RowKind::element_displacement : RowKind::element_rotation;
}

double scale_of(RowKind kind, const ResidualScales& scales, double h) {
  switch (kind) {
    case RowKind::vertex_displacement:
      return scales.force;
    case RowKind::vertex_rotation:
      return scales.moment;
    case RowKind::element_rotation:
      return scales.element_moment(h);
    case RowKind::held_displacement:
      return scales.length;
    case RowKind::held_rotation:
      return 1.0;
    case RowKind::element_force:
      return scales.element_strain(h);
    case RowKind::element_moment:
      return scales.rotation;
    case RowKind::element_displacement:
      return scales.element_bubble(h);
  }
  return 1.0;
}

namespace {

void scale_vertex_rows(const Model& model, const ResidualScales& scales, bool inverse,
                       const KernelView<double*>& rows) {
  const auto factor = [inverse](double scale) { return inverse ? scale : 1.0 / scale; };
  const double force = factor(scales.force), moment = factor(scales.moment), length = factor(scales.length);
  const auto fixed = model.fixed_rows();
  Kokkos::parallel_for(
      "mixbeam::scale::vertex", Range(0, model.structure().owned_vertices), KOKKOS_LAMBDA(int v) {
        double* row = &rows(static_cast<size_t>(kVertexDofs) * v);
        const unsigned char* held = &fixed(static_cast<size_t>(kVertexDofs) * v);
        for (int c = 0; c < 3; ++c) {
          row[c] *= held[c] != 0 ? length : force;
          row[3 + c] *= held[3 + c] != 0 ? 1.0 : moment;
        }
      });
}

void scale_rows(const Model& model, const ResidualScales& scales, bool inverse, MixedVector& rows) {
  scale_vertex_rows(model, scales, inverse, rows.vertex());
  if (rows.shares_zeros()) return;
  const ResidualScales by = scales;
  const KernelView<double*> interior = rows.writable_interior(true);
  for (const ElementBlock& block : model.structure().blocks) {
    const InteriorLayout layout = block.interior;
    const size_t offset = block.increment_offset;
    const KernelView<const double**> reference = block.reference;
    Kokkos::parallel_for(
        "mixbeam::scale::interior", Range(0, block.count), KOKKOS_LAMBDA(int e) {
          double* row = interior.data() + offset + static_cast<size_t>(e) * layout.increments();
          scale_interior_rows(layout, by, reference(e, 0), inverse, row);
        });
  }
}

}  // namespace

void scale_rows(const Model& model, const ResidualScales& scales, MixedVector& rows) {
  scale_rows(model, scales, false, rows);
}
void unscale_rows(const Model& model, const ResidualScales& scales, MixedVector& rows) {
  scale_rows(model, scales, true, rows);
}
void scale_vertex_rows(const Model& model, const ResidualScales& scales, const KernelView<double*>& rows) {
  scale_vertex_rows(model, scales, false, rows);
}

namespace {

/// Largest magnitude among entries [first, end) of the increments of every element of a block; infinity for
/// not-a-number.
double largest_row(const ElementBlock& block, const KernelView<const double*>& interior, int first, int end) {
  const size_t offset = block.increment_offset, stride = block.interior.increments();
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::scaled::interior", Range(0, block.count),
      KOKKOS_LAMBDA(int e, double& m) {
        for (int i = first; i < end; ++i) {
          const double x = interior(offset + e * stride + i), a = x < 0.0 ? -x : x;
          if (!(a <= m)) m = a == a ? a : HUGE_VAL;
        }
      },
      Kokkos::Max<double>(largest));
  return largest;
}

}  // namespace

double compatibility_norm(const Model& model, const MixedVector& scaled_residual) {
  double largest = 0.0;
  for (const ElementBlock& block : model.structure().blocks)
    largest = std::max(largest, largest_row(block, scaled_residual.interior(), 0, block.interior.relative_rotation(1)));
  return maximum_over_ranks(*model.map()->getComm(), largest);
}

double equilibrium_norm(const Model& model, const MixedVector& scaled_residual) {
  const KernelView<const double*> rows = scaled_residual.vertex(), interior = scaled_residual.interior();
  const auto fixed = model.fixed_rows();
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::equilibrium::vertex", Range(0, rows.extent(0)),
      KOKKOS_LAMBDA(size_t i, double& m) {
        const double a = rows(i) < 0.0 ? -rows(i) : rows(i);
        if (!fixed(i) && !(a <= m)) m = a == a ? a : HUGE_VAL;
      },
      Kokkos::Max<double>(largest));
  for (const ElementBlock& block : model.structure().blocks)
    largest = std::max(largest,
                       largest_row(block, interior, block.interior.relative_rotation(1), block.interior.increments()));
  return maximum_over_ranks(*model.map()->getComm(), largest);
}

}  // namespace mixbeam
