// The size of a state, and the mixed residual measured against it.
#include "discretization/assembler.hpp"
#include "kernels/element_kinematics.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

double largest_component(const Vec& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

/// Largest magnitude among entries [first, first + count) of every element of a block.
double largest_interior(const ElementBlock& block, const KernelView<const double*>& interior, int first, int count) {
  const size_t offset = block.interior_offset + first, stride = block.interior.unknowns();
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::magnitude", Range(0, block.count),
      KOKKOS_LAMBDA(int e, double& m) {
        for (int i = 0; i < count; ++i) {
          const double x = interior(offset + e * stride + i), a = x < 0.0 ? -x : x;
          if (a > m) m = a;
        }
      },
      Kokkos::Max<double>(largest));
  return largest;
}

}  // namespace

StateMagnitude Assembler::magnitude(const State& state) const {
  StateMagnitude m;
  for (const ElementBlock& block : structure_.blocks) {
    const int forces = 3 * block.interior.force_points, moments = 3 * (block.order + 1);
    m.force = std::max(m.force, largest_interior(block, state.views.interior, 0, forces));
    m.moment = std::max(m.moment, largest_interior(block, state.views.interior, forces, moments));
  }
  const auto u = state.views.vertex_displacement;
  const auto q = state.views.vertex_rotation;
  double half_sine = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::magnitude::displacement", Range(0, structure_.owned_vertices),
      KOKKOS_LAMBDA(int v, double& largest) {
        for (int i = 0; i < 3; ++i) {
          const double a = u(v, i) < 0.0 ? -u(v, i) : u(v, i);
          if (a > largest) largest = a;
        }
      },
      Kokkos::Max<double>(m.displacement));
  Kokkos::parallel_reduce(
      "mixbeam::magnitude::rotation", Range(0, structure_.owned_vertices),
      KOKKOS_LAMBDA(int v, double& largest) {
        const double square = q(v, 1) * q(v, 1) + q(v, 2) * q(v, 2) + q(v, 3) * q(v, 3);
        if (square > largest) largest = square;
      },
      Kokkos::Max<double>(half_sine));
  m.rotation = 2.0 * std::sqrt(half_sine);
  for (const VertexLoad& load : conditions_.loads) {
    const double amplitude = std::abs(load.amplitude(load_factor_));
    m.load_force = std::max(m.load_force, amplitude * largest_component(load.force));
    m.load_moment = std::max(m.load_moment, amplitude * largest_component(load.moment));
  }
  const LineFieldMagnitude& fields = line_fields_.magnitude();
  m.load_force = std::max(m.load_force, fields.force);
  // what would bend the structure as the eigencurvature does: else a free member, in equilibrium without any force,
  // would be measured against its own rounding errors
  m.load_moment = std::max({m.load_moment, fields.couple, structure_.bending_reference * fields.curvature});
  m.eigenstrain = std::max(fields.strain, fields.turn);
  if (!maps_.import.is_null()) {
    double mine[7] = {m.force, m.moment, m.displacement, m.rotation, m.load_force, m.load_moment, m.eigenstrain};
    double all[7];
    Teuchos::reduceAll(*maps_.rows->getComm(), Teuchos::REDUCE_MAX, 7, mine, all);
    m = {all[0], all[1], all[2], all[3], all[4], all[5], all[6]};
  }
  return m;
}

void Assembler::scale_rows(MixedVector& v, bool inverse) const {
  const auto factor = [inverse](double scale) { return inverse ? scale : 1.0 / scale; };
  const double force = factor(scales_.force), moment = factor(scales_.moment), length = factor(scales_.length);
  const auto rows = v.vertex();
  const auto fixed = fixed_;
  Kokkos::parallel_for(
      "mixbeam::scale::vertex", Range(0, rows.extent(0)), KOKKOS_LAMBDA(size_t i) {
        const bool is_force = i % kVertexDofs < 3;
        rows(i) *= fixed(i) ? (is_force ? length : 1.0) : (is_force ? force : moment);
      });
  const double rotation = factor(scales_.rotation);
  const ResidualScales scales = scales_;
  const KernelView<double*> interior = v.writable_interior(true);
  for (const ElementBlock& block : structure_.blocks) {
    const InteriorLayout layout = block.interior;
    const size_t offset = block.increment_offset;
    const KernelView<const double**> reference = block.reference;
    Kokkos::parallel_for(
        "mixbeam::scale::interior", Range(0, block.count), KOKKOS_LAMBDA(int e) {
          const double h = reference(e, 0);
          const double strain = factor(scales.element_strain(h)), spin = factor(scales.element_moment(h)),
                       bubble = factor(scales.element_bubble(h));
          double* row = interior.data() + offset + static_cast<size_t>(e) * layout.increments();
          for (int i = 0; i < layout.moment(0); ++i) row[i] *= strain;
          for (int i = layout.moment(0); i < layout.relative_rotation(1); ++i) row[i] *= rotation;
          for (int i = layout.relative_rotation(1); i < layout.bubble(1); ++i) row[i] *= spin;
          for (int i = layout.bubble(1); i < layout.spin(); ++i) row[i] *= bubble;
          for (int i = layout.spin(); i < layout.increments(); ++i) row[i] *= spin;
        });
  }
}

void Assembler::rescale(MixedVector& rows, const ResidualScales& from, const ResidualScales& to) {
  use_scales(from);
  scale_rows(rows, true);
  use_scales(to);
  scale_rows(rows, false);
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

double Assembler::compatibility_norm(const MixedVector& scaled_residual) const {
  double largest = 0.0;
  for (const ElementBlock& block : structure_.blocks)
    largest = std::max(largest, largest_row(block, scaled_residual.interior(), 0, block.interior.relative_rotation(1)));
  return maximum_over_ranks(*maps_.rows->getComm(), largest);
}

double Assembler::equilibrium_norm(const MixedVector& scaled_residual) const {
  const KernelView<const double*> rows = scaled_residual.vertex(), interior = scaled_residual.interior();
  const auto fixed = fixed_;
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::equilibrium::vertex", Range(0, rows.extent(0)),
      KOKKOS_LAMBDA(size_t i, double& m) {
        const double a = rows(i) < 0.0 ? -rows(i) : rows(i);
        if (!fixed(i) && !(a <= m)) m = a == a ? a : HUGE_VAL;
      },
      Kokkos::Max<double>(largest));
  for (const ElementBlock& block : structure_.blocks)
    largest = std::max(largest,
                       largest_row(block, interior, block.interior.relative_rotation(1), block.interior.increments()));
  return maximum_over_ranks(*maps_.rows->getComm(), largest);
}

}  // namespace mixbeam
