// The size of a state, and the mixed residual measured against it.
#include "discretization/assembly/assembler.hpp"
#include "kernels/element/kinematics.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

double largest_component(const Vec& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

/// Largest magnitudes of two kinds, each of several components.
struct LargestPair {
  double first, second;
};

/// Largest of each kind among the values that Values(index, pair) raises.
template <class Values>
struct PairLoop {
  using value_type = LargestPair;
  Values values;
  KOKKOS_INLINE_FUNCTION void init(LargestPair& pair) const { pair = {0.0, 0.0}; }
  KOKKOS_INLINE_FUNCTION void join(volatile LargestPair& pair, const volatile LargestPair& other) const {
    if (other.first > pair.first) pair.first = other.first;
    if (other.second > pair.second) pair.second = other.second;
  }
  KOKKOS_INLINE_FUNCTION void operator()(int i, LargestPair& pair) const { values(i, pair); }
};
template <class Values>
LargestPair largest_of(const char* label, int count, const Values& values) {
  LargestPair pair{0.0, 0.0};
  Kokkos::parallel_reduce(label, Range(0, count), PairLoop<Values>{values}, pair);
  return pair;
}

KOKKOS_INLINE_FUNCTION void raise(double& largest, const double* x, int count) {
  for (int i = 0; i < count; ++i) {
    const double a = x[i] < 0.0 ? -x[i] : x[i];
    if (a > largest) largest = a;
  }
}

/// Forces and moments of all elements of a block.
LargestPair largest_stresses(const ElementBlock& block, const KernelView<const double*>& interior) {
  const InteriorLayout layout = block.interior;
  const size_t offset = block.interior_offset;
  return largest_of(
      "mixbeam::magnitude::stresses", block.count, KOKKOS_LAMBDA(int e, LargestPair& pair) {
        const double* x = interior.data() + offset + static_cast<size_t>(e) * layout.unknowns();
        raise(pair.first, x, layout.moment(0));
        raise(pair.second, x + layout.moment(0), 3 * (layout.order + 1));
      });
}

}  // namespace

StateMagnitude Assembler::magnitude(const State& state) const {
  StateMagnitude m;
  for (const ElementBlock& block : structure_.blocks) {
    const LargestPair stresses = largest_stresses(block, state.views.interior);
    m.force = std::max(m.force, stresses.first);
    m.moment = std::max(m.moment, stresses.second);
  }
  const KernelView<const double* [3]> u = state.views.vertex_displacement;
  const KernelView<const double* [4]> q = state.views.vertex_rotation;
  const LargestPair motions = largest_of(
      "mixbeam::magnitude::motions", structure_.owned_vertices, KOKKOS_LAMBDA(int v, LargestPair& pair) {
        raise(pair.first, &u(v, 0), 3);
        const double square = q(v, 1) * q(v, 1) + q(v, 2) * q(v, 2) + q(v, 3) * q(v, 3);
        if (square > pair.second) pair.second = square;
      });
  m.displacement = motions.first;
  m.rotation = 2.0 * std::sqrt(motions.second);
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

/// Theory (40).
void Assembler::scale_vertex_rows(const KernelView<double*>& rows, bool inverse) const {
  const auto factor = [inverse](double scale) { return inverse ? scale : 1.0 / scale; };
  const double force = factor(scales_.force), moment = factor(scales_.moment), length = factor(scales_.length);
  const auto fixed = fixed_;
  Kokkos::parallel_for(
      "mixbeam::scale::vertex", Range(0, structure_.owned_vertices), KOKKOS_LAMBDA(int v) {
        double* row = &rows(static_cast<size_t>(kVertexDofs) * v);
        const unsigned char* held = &fixed(static_cast<size_t>(kVertexDofs) * v);
        for (int c = 0; c < 3; ++c) {
          row[c] *= held[c] != 0 ? length : force;
          row[3 + c] *= held[3 + c] != 0 ? 1.0 : moment;
        }
      });
}

void Assembler::scale_rows(MixedVector& v, bool inverse) const {
  scale_vertex_rows(v.vertex(), inverse);
  const ResidualScales scales = scales_;
  const KernelView<double*> interior = v.writable_interior(true);
  for (const ElementBlock& block : structure_.blocks) {
    const InteriorLayout layout = block.interior;
    const size_t offset = block.increment_offset;
    const KernelView<const double**> reference = block.reference;
    Kokkos::parallel_for(
        "mixbeam::scale::interior", Range(0, block.count), KOKKOS_LAMBDA(int e) {
          double* row = interior.data() + offset + static_cast<size_t>(e) * layout.increments();
          scale_interior_rows(layout, scales, reference(e, 0), inverse, row);
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
