#include "discretization/mixed_vector.hpp"

#include "kernels/pack.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

using Entries = KernelView<double*>;
using ConstEntries = KernelView<const double*>;
using Range = Kokkos::RangePolicy<ExecutionSpace>;

template <class Action>
void for_each_entry(const char* label, size_t n, const Action& action) {
  Kokkos::parallel_for(label, Range(0, n), action);
}

/// Not-a-number compares false with everything, so it is carried as infinity.
KOKKOS_INLINE_FUNCTION double magnitude(double x) {
  const double a = x < 0.0 ? -x : x;
  return a == a ? a : HUGE_VAL;
}

void copy_entries(const ConstEntries& from, const Entries& to) {
  for_each_entry(
      "mixbeam::vector::copy", to.extent(0), KOKKOS_LAMBDA(size_t i) { to(i) = from(i); });
}

/// Entries that are looked at side by side before their largest is compared with the others': long enough that the
/// comparison of one number does not count.
constexpr size_t kRun = 64 * kLanes;

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
        for (; i < end; ++i) m = magnitude(x(i)) > m ? magnitude(x(i)) : m;
      },
      Kokkos::Max<double>(largest));
  return largest;
}

}  // namespace

double largest_part(const Teuchos::Comm<int>& comm, const KernelView<const double*>& entries, int first) {
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::vector::largest_part", Range(0, entries.extent(0) / kVertexDofs),
      KOKKOS_LAMBDA(int v, double& m) {
        for (int c = 0; c < 3; ++c) {
          const double a = magnitude(entries(static_cast<size_t>(kVertexDofs) * v + first + c));
          if (a > m) m = a;
        }
      },
      Kokkos::Max<double>(largest));
  return maximum_over_ranks(comm, largest);
}

double maximum_over_ranks(const Teuchos::Comm<int>& comm, double value) {
  if (std::isnan(value)) value = std::numeric_limits<double>::infinity();
  if (comm.getSize() == 1) return value;
  double result = value;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, value, Teuchos::outArg(result));
  return result;
}

namespace {

/// This vector and the pool; more hold an array that several vectors share.
constexpr int kOwnersOfUnshared = 2;

Teuchos::RCP<DofVector> zero_vertex_dofs(const Teuchos::RCP<const DofMap>& map, VectorPool& pool) {
  using Values = DofVector::dual_view_type;
  const Values::t_dev values = pool.vertex.take("mixbeam::vertex_dofs", map->getNodeNumElements());
  const Teuchos::RCP<DofVector> vector = Teuchos::rcp(new DofVector(map, Values(values, values)));
  const Entries y(values.data(), values.extent(0));
  for_each_entry(
      "mixbeam::vector::clear", y.extent(0), KOKKOS_LAMBDA(size_t i) { y(i) = 0.0; });
  return vector;
}

}  // namespace

MixedVector::MixedVector(const Teuchos::RCP<const DofMap>& map, size_t interior_size,
                         const KernelView<const unsigned char*>& owned_interior,
                         const std::shared_ptr<VectorPool>& pool)
    : MixedVector(map, pool->interior.take("mixbeam::mixed_vector", interior_size), owned_interior, pool) {
  const Entries y = interior_;
  for_each_entry(
      "mixbeam::vector::clear", y.extent(0), KOKKOS_LAMBDA(size_t i) { y(i) = 0.0; });
}

MixedVector::MixedVector(const Teuchos::RCP<const DofMap>& map, const Entries& interior,
                         const KernelView<const unsigned char*>& owned_interior,
                         const std::shared_ptr<VectorPool>& pool)
    : pool_(pool), vertex_dofs_(zero_vertex_dofs(map, *pool)), interior_(interior), owned_interior_(owned_interior) {}

MixedVector MixedVector::clone(bool copy_values) const {
  MixedVector copy(vertex_dofs_->getMap(), interior_, owned_interior_, pool_);
  if (copy_values) copy_entries(vertex(), copy.vertex());
  return copy;
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

void MixedVector::fill(double value) {
  for (const Entries& part : {vertex(), writable_interior(false)}) {
    const Entries y = part;
    for_each_entry(
        "mixbeam::vector::fill", y.extent(0), KOKKOS_LAMBDA(size_t i) { y(i) = value; });
  }
}

void MixedVector::assign(const MixedVector& other) {
  copy_entries(other.vertex(), vertex());
  interior_ = other.interior_;
}

void MixedVector::scale(double factor) {
  for (const Entries& part : {vertex(), writable_interior(true)}) {
    const Entries y = part;
    for_each_entry(
        "mixbeam::vector::scale", y.extent(0), KOKKOS_LAMBDA(size_t i) { y(i) *= factor; });
  }
}

void MixedVector::update(double a, const MixedVector& x, double gamma) { update(a, x, 0.0, x, gamma); }

void MixedVector::update(double a, const MixedVector& x, double b, const MixedVector& y, double gamma) {
  // the sources first: writing may part this vector from one of them
  const ConstEntries first[2] = {x.vertex(), x.interior_}, second[2] = {y.vertex(), y.interior_},
                     old[2] = {vertex(), interior_};
  const Entries out[2] = {vertex(), writable_interior(false)};
  for (int part = 0; part < 2; ++part) {
    const Entries z = out[part];
    const ConstEntries p = first[part], q = second[part], before = old[part];
    for_each_entry(
        "mixbeam::vector::update", z.extent(0), KOKKOS_LAMBDA(size_t i) {
          double value = gamma == 0.0 ? 0.0 : gamma * before(i);  // a zero factor must not spread a not-a-number
          if (a != 0.0) value += a * p(i);
          if (b != 0.0) value += b * q(i);
          z(i) = value;
        });
  }
}

/// this_i = action(this_i, other_i)
template <class Action>
void MixedVector::combine_with(const MixedVector& other, const Action& action) {
  const ConstEntries in[2] = {other.vertex(), other.interior_}, old[2] = {vertex(), interior_};
  const Entries out[2] = {vertex(), writable_interior(false)};
  for (int part = 0; part < 2; ++part) {
    const Entries y = out[part];
    const ConstEntries x = in[part], own = old[part];
    for_each_entry(
        "mixbeam::vector::combine", y.extent(0), KOKKOS_LAMBDA(size_t i) { y(i) = action(own(i), x(i)); });
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

namespace {

/// Sum over the entries of this rank, in a fixed order: one thread, so it does not depend on the number of threads.
template <class Term>
double ordered_sum(const Teuchos::Comm<int>& comm, size_t vertex_entries, size_t interior_entries,
                   const KernelView<const unsigned char*>& owned, const Term& term) {
  double sum = 0.0;
  for (size_t i = 0; i < vertex_entries; ++i) sum += term(0, i);
  for (size_t i = 0; i < interior_entries; ++i)
    if (owned.extent(0) == 0 || owned(i)) sum += term(1, i);
  double total = sum;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, sum, Teuchos::outArg(total));
  return total;
}

}  // namespace

double MixedVector::one_norm() const {
  const Entries x[2] = {vertex(), interior_};
  return ordered_sum(*vertex_dofs_->getMap()->getComm(), x[0].extent(0), x[1].extent(0), owned_interior_,
                     [&](int part, size_t i) { return std::abs(x[part](i)); });
}

double MixedVector::inner_product(const MixedVector& other) const {
  const Entries x[2] = {vertex(), interior_}, y[2] = {other.vertex(), other.interior_};
  return ordered_sum(*vertex_dofs_->getMap()->getComm(), x[0].extent(0), x[1].extent(0), owned_interior_,
                     [&](int part, size_t i) { return x[part](i) * y[part](i); });
}

GlobalOrdinal MixedVector::global_length() const {
  const auto one = [](int, size_t) { return 1.0; };
  return static_cast<GlobalOrdinal>(
      ordered_sum(*vertex_dofs_->getMap()->getComm(), vertex().extent(0), interior_.extent(0), owned_interior_, one));
}

bool MixedVector::same_values(const MixedVector& other) const {
  const Entries x[2] = {vertex(), interior_}, y[2] = {other.vertex(), other.interior_};
  double different = 0.0;
  for (int part = 0; part < 2; ++part) {
    const ConstEntries a = x[part], b = y[part];
    if (a.data() == b.data()) continue;
    double found = 0.0;
    Kokkos::parallel_reduce(
        "mixbeam::vector::compare", Range(0, a.extent(0)),
        KOKKOS_LAMBDA(size_t i, double& m) {
          if (!(a(i) == b(i))) m = 1.0;
        },
        Kokkos::Max<double>(found));
    different = std::max(different, found);
  }
  return maximum_over_ranks(*vertex_dofs_->getMap()->getComm(), different) == 0.0;
}

double MixedVector::largest_vertex_spin() const {
  const ConstEntries x = vertex();
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::vector::largest_spin", Range(0, x.extent(0) / kVertexDofs),
      KOKKOS_LAMBDA(size_t v, double& m) {
        const double* spin = &x(kVertexDofs * v + 3);
        const double square = magnitude(spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2]);
        if (square > m) m = square;
      },
      Kokkos::Max<double>(largest));
  return std::sqrt(maximum_over_ranks(*vertex_dofs_->getMap()->getComm(), largest));
}

}  // namespace mixbeam
