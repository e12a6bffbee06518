#include "kernels/execution/pack.hpp"
#include "kernels/loops/block.hpp"
#include "kernels/math/rotation.hpp"

namespace mixbeam {

namespace {

using Real = Pack<kLanes>;
using Range = Kokkos::RangePolicy<ExecutionSpace>;

enum class TurnFrom { left, right };  ///< spatial or material spins

/// Updates kLanes rotations, theory (34). Rows may repeat, and `out` may be `rotation`.
template <TurnFrom From>
KOKKOS_FORCEINLINE_FUNCTION void turn_rotations(const double* const* rotation, const double* const* spin, double scale,
                                                int active, double* const* out) {
  Real q[4], w[3];
  gather_lanes(rotation, 4, q);
  gather_lanes(spin, 3, w);
  const Quaternion<Real> turn = exp_quaternion(Real(scale) * load_vector(w)), old = load_quaternion(q);
  store_quaternion(normalized(From == TurnFrom::left ? turn * old : old * turn), q);
  scatter_lanes(q, 4, 0, active, out);
}

struct VertexLoop {
  KernelView<const double* [3]> from_displacement;
  KernelView<const double* [4]> from_rotation;
  KernelView<const double* [6]> increment;
  double scale;
  int count;
  KernelView<double* [3]> to_displacement;
  KernelView<double* [4]> to_rotation;

  KOKKOS_INLINE_FUNCTION void operator()(int pack) const {
    const LaneRows rows(pack, count);
    const double *rotation[kLanes], *spin[kLanes];
    double* out[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      const int v = rows.row[lane];
      rotation[lane] = &from_rotation(v, 0);
      spin[lane] = &increment(v, 3);
      out[lane] = &to_rotation(v, 0);
      const int next = rows.next[lane];
      fetch(&from_displacement(next, 0), 3);
      fetch(&from_rotation(next, 0), 4);
      fetch(&increment(next, 0), 6);
      fetch(&to_displacement(next, 0), 3);
      fetch(&to_rotation(next, 0), 4);
      for (int i = 0; lane < rows.active && i < 3; ++i)
        to_displacement(v, i) = from_displacement(v, i) + scale * increment(v, i);
    }
    turn_rotations<TurnFrom::left>(rotation, spin, scale, rows.active, out);
  }
};

struct ElementLoop {
  KernelView<const double* [4]> from_triad;
  KernelView<const double*> from_interior, increment;
  KernelView<double* [4]> to_triad;
  KernelView<double*> to_interior;
  double scale;
  int count, first_element, unknowns;
  size_t interior_offset, increment_offset;

  // in packs: the compiler would test every row for overlapping arrays
  KOKKOS_FORCEINLINE_FUNCTION void add_row(const double* x, const double* d, double* y) const {
    int i = 0;
    for (; i + kLanes <= unknowns; i += kLanes) (Real::loaded(x + i) + Real(scale) * Real::loaded(d + i)).store(y + i);
    for (; i < unknowns; ++i) y[i] = x[i] + scale * d[i];
  }
  KOKKOS_INLINE_FUNCTION void operator()(int pack) const {
    const LaneRows rows(pack, count);
    const double *triad[kLanes], *spin[kLanes];
    double* out[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      const int e = rows.row[lane];
      const double* d = increment.data() + increment_offset + static_cast<size_t>(e) * (unknowns + 3);
      const double* x = from_interior.data() + interior_offset + static_cast<size_t>(e) * unknowns;
      double* y = to_interior.data() + interior_offset + static_cast<size_t>(e) * unknowns;
      const int next = rows.next[lane] - e;
      fetch(d + next * (unknowns + 3), unknowns + 3);
      fetch(x + next * unknowns, unknowns);
      fetch(y + next * unknowns, unknowns);
      fetch(&from_triad(first_element + e + next, 0), 4);
      fetch(&to_triad(first_element + e + next, 0), 4);
      if (lane < rows.active) add_row(x, d, y);
      triad[lane] = &from_triad(first_element + e, 0);
      spin[lane] = d + unknowns;
      out[lane] = &to_triad(first_element + e, 0);
    }
    turn_rotations<TurnFrom::right>(triad, spin, scale, rows.active, out);
  }
};

}  // namespace

void apply_vertex_increment(int count, const StateViews& from, const KernelView<const double* [6]>& increment,
                            double scale, const StateViews& to) {
  const VertexLoop loop{from.vertex_displacement, from.vertex_rotation, increment, scale, count,
                        to.vertex_displacement,   to.vertex_rotation};
  Kokkos::parallel_for("mixbeam::vertices::apply", Range(0, LaneRows::packs(count)), loop);
}

void apply_interior_increment(const ElementBlock& block, const StateViews& from,
                              const KernelView<const double*>& increment, double scale, const StateViews& to) {
  const ElementLoop loop{from.element_triad,    from.interior,         increment,
                         to.element_triad,      to.interior,           scale,
                         block.count,           block.first_element,   block.interior.unknowns(),
                         block.interior_offset, block.increment_offset};
  Kokkos::parallel_for("mixbeam::elements::apply", Range(0, LaneRows::packs(block.count)), loop);
}

}  // namespace mixbeam
