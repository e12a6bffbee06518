#include "discretization/mesh/mixed_vector.hpp"

#include <sys/mman.h>
#include <unistd.h>
#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

namespace mixbeam {

namespace {

using Entries = KernelView<double*>;
using ConstEntries = KernelView<const double*>;
/// Arrays that are only read. Unmanaged: a counted view would make a vector that reads itself look shared and copy it.
using Sources = Kokkos::View<const double*, Kokkos::LayoutRight, MemorySpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;
using Range = Kokkos::RangePolicy<ExecutionSpace>;

/// Calls action(i) for every entry; entries must be independent. The action holds pointers instead of views: the
/// compiler then knows that its copy in registers does not change, and vectorises.
template <class Action>
void for_each_entry(const char* label, size_t n, const Action& action) {
  static_assert(std::is_trivially_copyable_v<Action>, "no views");
  Kokkos::parallel_for(
      label, Range(0, (n + kRun - 1) / kRun), KOKKOS_LAMBDA(size_t run) {
        const Action own = action;
        const size_t end = (run + 1) * kRun < n ? (run + 1) * kRun : n;
#pragma GCC ivdep
        for (size_t i = run * kRun; i < end; ++i) own(i);
      });
}

void copy_entries(const ConstEntries& from, const Entries& to) {
  const double* const x = from.data();
  double* const y = to.data();
  for_each_entry(
      "mixbeam::vector::copy", to.extent(0), KOKKOS_LAMBDA(size_t i) { y[i] = x[i]; });
}

double largest_magnitude(const ConstEntries& x) {
  using Real = Pack<kLanes>;
  double largest = 0.0;
  const size_t count = x.extent(0);
  Kokkos::parallel_reduce(
      "mixbeam::vector::maximum", Range(0, (count + kRun - 1) / kRun),
      KOKKOS_LAMBDA(size_t run, double& m) {
        const size_t begin = run * kRun, end = begin + kRun < count ? begin + kRun : count;
        Real side_by_side = 0.0;
        size_t i = begin;
        for (; i + kLanes <= end; i += kLanes) {
          Real a = fabs(Real::loaded(&x(i)));
          a = select(a <= Real(HUGE_VAL), a, Real(HUGE_VAL));
          side_by_side = select(a > side_by_side, a, side_by_side);
        }
        for (int lane = 0; lane < kLanes; ++lane) m = side_by_side[lane] > m ? side_by_side[lane] : m;
        for (; i < end; ++i) raise(m, x(i));
      },
      Kokkos::Max<double>(largest));
  return largest;
}

}  // namespace

LargestParts largest_parts(const Teuchos::Comm<int>& comm, const KernelView<const double*>& entries) {
  Largest<2> parts = largest_of<2>(
      "mixbeam::vector::largest_parts", static_cast<int>(entries.extent(0)) / kVertexDofs,
      KOKKOS_LAMBDA(int vertex, Largest<2>& largest) {
        const double* row = &entries(static_cast<size_t>(kVertexDofs) * vertex);
        for (int c = 0; c < kVertexDofs; ++c) raise(largest.of[c / 3], row[c]);
      });
  maxima_over_ranks(comm, parts.of, 2);
  return {parts.of[0], parts.of[1]};
}

double maximum_over_ranks(const Teuchos::Comm<int>& comm, double value) {
  maxima_over_ranks(comm, &value, 1);
  return value;
}

void maxima_over_ranks(const Teuchos::Comm<int>& comm, double* values, int count) {
  for (int i = 0; i < count; ++i)
    if (std::isnan(values[i])) values[i] = std::numeric_limits<double>::infinity();
  if (comm.getSize() == 1) return;
  const std::vector<double> mine(values, values + count);
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, count, mine.data(), values);
}

namespace {

/// this vector and the pool; shared arrays have more owners
constexpr int kOwnersOfUnshared = 2;

Teuchos::RCP<DofVector> new_vertex_dofs(const Teuchos::RCP<const DofMap>& map, VectorPool& pool) {
  using Values = DofVector::dual_view_type;
  const Values::t_dev values = pool.vertex.take("mixbeam::vertex_dofs", map->getNodeNumElements());
  return Teuchos::rcp(new DofVector(map, Values(values, values)));
}

void clear(const Entries& entries) {
  double* const y = entries.data();
  for_each_entry(
      "mixbeam::vector::clear", entries.extent(0), KOKKOS_LAMBDA(size_t i) { y[i] = 0.0; });
}

/// Up to so many pages clearing is faster than a system call, which writing pays for with a page fault for each page.
constexpr std::uintptr_t kFewPages = 16;

/// Zeros that take no memory while only read: the system maps one zero page for all untouched pages.
void clear_without_memory(const Entries& y) {
  clear(y);
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(y.data()), end = begin + y.extent(0) * sizeof(double);
  const std::uintptr_t first = (begin + page - 1) / page * page, last = end / page * page;
  if (last > first + kFewPages * page) madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED);
}

const Teuchos::RCP<DofVector>& zero_vertices_of(VectorPool& pool, const Teuchos::RCP<const DofMap>& map) {
  if (pool.zero_vertices.is_null()) {
    pool.zero_vertices = new_vertex_dofs(map, pool);
    clear_without_memory(MixedVector::view_of(*pool.zero_vertices));
  }
  return pool.zero_vertices;
}

const Entries& zeros_of(VectorPool& pool, size_t size) {
  if (pool.zeros.data() == nullptr) {
    pool.zeros = pool.interior.take("mixbeam::mixed_vector", size);
    clear_without_memory(pool.zeros);
  }
  return pool.zeros;
}

}  // namespace

MixedVector::MixedVector(const Teuchos::RCP<const DofMap>& map, size_t interior_size,
                         const KernelView<const unsigned char*>& owned_interior,
                         const std::shared_ptr<VectorPool>& pool)
    : pool_(pool),
      vertex_dofs_(zero_vertices_of(*pool, map)),
      interior_(zeros_of(*pool, interior_size)),
      owned_interior_(owned_interior) {}

MixedVector MixedVector::clone(bool copy_values) const {
  MixedVector copy(*this);
  if (!copy_values) copy.vertex_dofs_ = new_vertex_dofs(vertex_dofs_->getMap(), *pool_);
  return copy;
}

Entries MixedVector::writable_vertex(bool keep_values) {
  if (vertex_dofs_.strong_count() > 1) {
    const Teuchos::RCP<const DofVector> shared = vertex_dofs_;
    vertex_dofs_ = new_vertex_dofs(shared->getMap(), *pool_);
    if (keep_values) copy_entries(view_of(*shared), view_of(*vertex_dofs_));
  }
  return view_of(*vertex_dofs_);
}

KernelView<double*> MixedVector::writable_interior(bool keep_values) {
  if (interior_.use_count() > kOwnersOfUnshared) {
    const Entries shared = interior_;
    interior_ = pool_->interior.take("mixbeam::mixed_vector", shared.extent(0));
    if (keep_values) copy_entries(shared, interior_);
  }
  return interior_;
}

KernelView<const double*> MixedVector::view_of(const DofVector& v) {
  const auto local = v.getLocalViewHost(Tpetra::Access::ReadOnly);
  return KernelView<const double*>(local.data(), local.extent(0));
}

KernelView<double*> MixedVector::view_of(DofVector& v) {
  auto local = v.getLocalViewHost(Tpetra::Access::ReadWrite);
  return KernelView<double*>(local.data(), local.extent(0));
}

/// this_i = action(this_i, other_i)
template <class Action>
void MixedVector::combine_with(const MixedVector& other, const Action& action) {
  const Sources in[2] = {other.vertex(), other.interior_}, old[2] = {std::as_const(*this).vertex(), interior_};
  const Entries out[2] = {writable_vertex(false), writable_interior(false)};
  for (int part = 0; part < 2; ++part) {
    double* const y = out[part].data();
    const double *const x = in[part].data(), *const own = old[part].data();
    for_each_entry(
        "mixbeam::vector::combine", out[part].extent(0), KOKKOS_LAMBDA(size_t i) { y[i] = action(own[i], x[i]); });
  }
}

void MixedVector::fill(double value) {
  if (value == 0.0) {
    vertex_dofs_ = zero_vertices_of(*pool_, vertex_dofs_->getMap());
    interior_ = zeros_of(*pool_, interior_.extent(0));
    return;
  }
  combine_with(
      *this, KOKKOS_LAMBDA(double, double) { return value; });
}

void MixedVector::assign(const MixedVector& other) {
  vertex_dofs_ = other.vertex_dofs_;
  interior_ = other.interior_;
}

void MixedVector::scale(double factor) {
  combine_with(
      *this, KOKKOS_LAMBDA(double own, double) { return factor * own; });
}

void MixedVector::update(double a, const MixedVector& x, double gamma) {
  if (a == 1.0 && gamma == 0.0) return assign(x);
  update(a, x, 0.0, x, gamma);
}

void MixedVector::update(double a, const MixedVector& x, double b, const MixedVector& y, double gamma) {
  // sources first: writing may separate this vector from one of them
  const Sources first[2] = {x.vertex(), x.interior_}, second[2] = {y.vertex(), y.interior_},
                old[2] = {std::as_const(*this).vertex(), interior_};
  const Entries out[2] = {writable_vertex(false), writable_interior(false)};
  for (int part = 0; part < 2; ++part) {
    double* const z = out[part].data();
    const double *const p = first[part].data(), *const q = second[part].data(), *const before = old[part].data();
    for_each_entry(
        "mixbeam::vector::update", out[part].extent(0), KOKKOS_LAMBDA(size_t i) {
          double value = gamma == 0.0 ? 0.0 : gamma * before[i];  // a zero factor must not spread NaN
          if (a != 0.0) value += a * p[i];
          if (b != 0.0) value += b * q[i];
          z[i] = value;
        });
  }
}

void MixedVector::absolute_values_of(const MixedVector& other) {
  combine_with(
      other, KOKKOS_LAMBDA(double, double x) { return x < 0.0 ? -x : x; });
}

void MixedVector::reciprocals_of(const MixedVector& other) {
  combine_with(
      other, KOKKOS_LAMBDA(double, double x) { return 1.0 / x; });
}

void MixedVector::multiply_by(const MixedVector& other) {
  combine_with(
      other, KOKKOS_LAMBDA(double own, double x) { return own * x; });
}

double MixedVector::maximum_norm() const {
  return maximum_over_ranks(*vertex_dofs_->getMap()->getComm(),
                            std::max(largest_magnitude(vertex()), largest_magnitude(interior_)));
}

/// Sums term(entry here, entry there) over all ranks, each entry counted once.
template <class Term>
double MixedVector::sum_with(const MixedVector& other, const Term& term) const {
  const ConstEntries u = vertex(), v = other.vertex(), x = interior_, y = other.interior_;
  const KernelView<const unsigned char*> owned = owned_interior_;
  const double sum = ordered_sum(
                         u.extent(0), KOKKOS_LAMBDA(size_t i) { return term(u(i), v(i)); }) +
                     ordered_sum(
                         x.extent(0), KOKKOS_LAMBDA(size_t i) {
                           return owned.extent(0) > 0 && owned(i) == 0 ? 0.0 : term(x(i), y(i));
                         });
  return sum_over_ranks(*vertex_dofs_->getMap()->getComm(), sum);
}

double MixedVector::one_norm() const {
  return sum_with(
      *this, KOKKOS_LAMBDA(double x, double) { return x < 0.0 ? -x : x; });
}

double MixedVector::inner_product(const MixedVector& other) const {
  return sum_with(
      other, KOKKOS_LAMBDA(double x, double y) { return x * y; });
}

double MixedVector::vertex_product(const MixedVector& weights, const MixedVector& other) const {
  const ConstEntries w = weights.vertex(), u = vertex(), v = other.vertex();
  const double sum = ordered_sum(
      u.extent(0), KOKKOS_LAMBDA(size_t i) { return u(i) * w(i) * v(i); });
  return sum_over_ranks(*vertex_dofs_->getMap()->getComm(), sum);
}

GlobalOrdinal MixedVector::global_length() const {
  if (!pool_->entries) {
    GlobalOrdinal mine = static_cast<GlobalOrdinal>(vertex().extent(0) + interior_.extent(0));
    for (size_t i = 0; i < owned_interior_.extent(0); ++i) mine -= owned_interior_(i) == 0 ? 1 : 0;
    GlobalOrdinal all = mine;
    Teuchos::reduceAll(*vertex_dofs_->getMap()->getComm(), Teuchos::REDUCE_SUM, mine, Teuchos::outArg(all));
    pool_->entries = all;
  }
  return *pool_->entries;
}

bool MixedVector::same_values(const MixedVector& other) const {
  const auto differ = [](const ConstEntries& a, const ConstEntries& b) {  // usually differ at one of the first entries
    return a.data() != b.data() && !std::equal(a.data(), a.data() + a.extent(0), b.data());
  };
  const double different = differ(vertex(), other.vertex()) || differ(interior_, other.interior_) ? 1.0 : 0.0;
  return maximum_over_ranks(*vertex_dofs_->getMap()->getComm(), different) == 0.0;
}

double MixedVector::largest_vertex_spin() const {
  const ConstEntries x = vertex();
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::vector::largest_spin", Range(0, x.extent(0) / kVertexDofs),
      KOKKOS_LAMBDA(size_t v, double& m) {
        const double* spin = &x(kVertexDofs * v + 3);
        raise(m, spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2]);
      },
      Kokkos::Max<double>(largest));
  return std::sqrt(maximum_over_ranks(*vertex_dofs_->getMap()->getComm(), largest));
}

}  // namespace mixbeam
