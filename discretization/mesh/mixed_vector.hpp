/// Vector over the whole mixed system: six entries (displacement, rotation; spatial) per owned vertex, and the interior
/// rows of every local element (InteriorLayout with spin). Increments and residuals have this shape.
#pragma once

#include "discretization/mesh/structure.hpp"
#include "discretization/mesh/tpetra_types.hpp"
#include "discretization/mesh/view_pool.hpp"
#include "kernels/execution/pack.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <utility>

namespace mixbeam {

constexpr int kVertexDofs = 6;

/// Data shared by all vectors of a model.
struct VectorPool {
  // unused arrays of vectors
  ViewPool<DofVector::dual_view_type::t_dev> vertex;
  ViewPool<KernelView<double*>> interior;
  // arrays that vectors share until they are written to
  Teuchos::RCP<DofVector> zero_vertices;
  KernelView<double*> zeros;
  std::optional<GlobalOrdinal> entries;  ///< of all ranks, each counted once
};

class MixedVector {
 public:
  /// Zero vector. `owned_interior`: entries that this rank counts in sums (elements cut by the partition are on two
  /// ranks).
  MixedVector(const Teuchos::RCP<const DofMap>& map, size_t interior_size,
              const KernelView<const unsigned char*>& owned_interior, const std::shared_ptr<VectorPool>& pool);

  /// Vector of the same shape, with the entries if `copy_values`. Copies share entries until either is written to, for
  /// solvers copy far more often than they change vectors. A writable view is valid until the next copy.
  MixedVector clone(bool copy_values) const;

  /// (6 * owned vertex + component)
  KernelView<const double*> vertex() const { return view_of(std::as_const(*vertex_dofs_)); }
  KernelView<double*> vertex() { return writable_vertex(true); }
  /// Writable view, no longer shared with any other vector; current values are kept only if `keep_values`.
  KernelView<double*> writable_vertex(bool keep_values);
  /// Local entries of a Tpetra vector, not owned.
  static KernelView<double*> view_of(DofVector& v);
  static KernelView<const double*> view_of(const DofVector& v);
  KernelView<const double*> interior() const { return interior_; }
  KernelView<double*> writable_interior(bool keep_values);
  const DofVector& vertex_dofs() const { return *vertex_dofs_; }
  DofVector& vertex_dofs() { return writable_dofs(true); }
  DofVector& writable_dofs(bool keep_values) {
    writable_vertex(keep_values);
    return *vertex_dofs_;
  }

  void fill(double value);
  /// Shares the interior of another vector (possibly zero) in place of its own.
  void share_interior(const MixedVector& from) { interior_ = from.interior_; }
  /// Shares the vertex entries of another vector; writing changes both.
  DofVector& share_vertices(const MixedVector& from) {
    vertex_dofs_ = from.vertex_dofs_;
    return *vertex_dofs_;
  }
  void take_interior(MixedVector& from) {
    interior_ = from.interior_;
    from.interior_ = pool_->zeros;
  }
  /// True: the interior is zero. False: unknown.
  bool shares_zeros() const { return interior_.data() == pool_->zeros.data(); }
  void assign(const MixedVector& other);
  bool shares_entries(const MixedVector& other) const {
    return vertex_dofs_ == other.vertex_dofs_ && interior_.data() == other.interior_.data();
  }
  void scale(double factor);
  void update(double a, const MixedVector& x, double gamma);  ///< a x + gamma this
  void update(double a, const MixedVector& x, double b, const MixedVector& y,
              double gamma);  ///< a x + b y + gamma this
  void absolute_values_of(const MixedVector& other);
  void reciprocals_of(const MixedVector& other);
  void multiply_by(const MixedVector& other);  ///< entry by entry

  double maximum_norm() const;  ///< the same for any number of threads and ranks
  double one_norm() const;
  double inner_product(const MixedVector& other) const;
  /// Product over vertex rows only, each weighted by the entry of `weights`.
  double vertex_product(const MixedVector& weights, const MixedVector& other) const;
  GlobalOrdinal global_length() const;               ///< collective on the first call
  bool same_values(const MixedVector& other) const;  ///< on every rank

  /// Largest rotation (Euclidean norm of the spin) of any vertex.
  double largest_vertex_spin() const;

 private:
  template <class Action>
  void combine_with(const MixedVector& other, const Action& action);
  template <class Term>
  double sum_with(const MixedVector& other, const Term& term) const;

  std::shared_ptr<VectorPool> pool_;
  Teuchos::RCP<DofVector> vertex_dofs_;
  KernelView<double*> interior_;
  KernelView<const unsigned char*> owned_interior_;  ///< empty: all
};

/// Keeps the larger magnitude; NaN, which compares false with everything, counts as infinity.
KOKKOS_INLINE_FUNCTION void raise(double& largest, double x) {
  const double size = x < 0.0 ? -x : x;
  if (!(size <= largest)) largest = size == size ? size : HUGE_VAL;
}

/// Largest magnitudes of several kinds.
template <int kinds>
struct Largest {
  double of[kinds] = {};
};

/// Maxima over all raise_all(i, largest), 0 <= i < count.
template <int kinds, class RaiseAll>
Largest<kinds> largest_of(const char* label, int count, const RaiseAll& raise_all) {
  struct Loop {
    using value_type = Largest<kinds>;
    RaiseAll raise_all;
    KOKKOS_INLINE_FUNCTION void init(value_type& largest) const { largest = {}; }
    KOKKOS_INLINE_FUNCTION void join(volatile value_type& largest, const volatile value_type& other) const {
      for (int k = 0; k < kinds; ++k)
        if (other.of[k] > largest.of[k]) largest.of[k] = other.of[k];
    }
    KOKKOS_INLINE_FUNCTION void operator()(int i, value_type& largest) const { raise_all(i, largest); }
  };
  Largest<kinds> largest;
  Kokkos::parallel_reduce(label, Kokkos::RangePolicy<ExecutionSpace>(0, count), Loop{raise_all}, largest);
  return largest;
}

/// Entries per call of a kernel: enough full registers to make the call itself cheap. Runs, and so the entries that
/// share a register, do not depend on the number of threads.
constexpr size_t kRun = 64 * kLanes;

/// Sum of term(i), 0 <= i < n, in an order independent of the number of threads.
template <class Term>
double ordered_sum(size_t n, const Term& term) {
  constexpr size_t side_by_side = 4;  // independent sums hide the latency of additions
  const size_t runs = (n + kRun - 1) / kRun;
  const KernelView<double*> partial(Kokkos::view_alloc("mixbeam::vector::partial_sums", Kokkos::WithoutInitializing),
                                    runs);
  Kokkos::parallel_for(
      "mixbeam::vector::sum", Kokkos::RangePolicy<ExecutionSpace>(0, runs), KOKKOS_LAMBDA(size_t run) {
        const size_t end = (run + 1) * kRun < n ? (run + 1) * kRun : n;
        double sum[side_by_side] = {};
        size_t i = run * kRun;
        for (; i + side_by_side <= end; i += side_by_side)
          for (size_t j = 0; j < side_by_side; ++j) sum[j] += term(i + j);
        for (; i < end; ++i) sum[0] += term(i);
        partial(run) = (sum[0] + sum[1]) + (sum[2] + sum[3]);
      });
  double total = 0.0;
  for (size_t run = 0; run < runs; ++run) total += partial(run);
  return total;
}

/// Largest displacement or force component, and largest rotation or moment component.
struct LargestParts {
  double moved = 0.0, turned = 0.0;
};
/// Maxima over entries (6 * vertex + component) of all ranks; NaN counts as infinity.
LargestParts largest_parts(const Teuchos::Comm<int>& comm, const KernelView<const double*>& entries);

/// Maximum of a value over all ranks; NaN counts as infinity.
double maximum_over_ranks(const Teuchos::Comm<int>& comm, double value);
/// Same for `count` values in one message.
void maxima_over_ranks(const Teuchos::Comm<int>& comm, double* values, int count);

}  // namespace mixbeam
