#include "nonlinear/linear/network_factors.hpp"

#include "discretization/mesh/mixed_vector.hpp"
#include "nonlinear/linear/krylov.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace mixbeam {

namespace {

/// Asymmetry that passes for rounding, for which one refinement is enough. Condensation leaves 1e-15.
constexpr double kSymmetryOfRounding = 1e-12;

/// Share of a factorisation that iterations with the factors of an earlier matrix may cost: the rest pays for attempts
/// that end in a factorisation.
constexpr double kShareOfFactorization = 0.5;
/// Smallest iteration budget worth an attempt: that of cubes of 14^3 junctions and sheets of 200^2.
constexpr int kLeastIterations = 7;
/// Energy error left by an iteration: Newton's method converges as with factors.
constexpr double kReduction = 1e-9;
/// Iterations after which the total number is extrapolated.
constexpr int kForecast = 2;

bool is_moment(int row) { return row % kVertexDofs >= 3; }

}  // namespace

NetworkFactors::NetworkFactors(const Teuchos::RCP<DofMatrix>& matrix, PhaseTimes& times)
    : matrix_(matrix), times_(times) {
  if (matrix->getRowMap()->getComm()->getSize() > 1) share_.communicator = communicator_of(*matrix);
}

bool NetworkFactors::on_all_ranks(bool here) const {
  if (matrix_->getRowMap()->getComm()->getSize() == 1) return here;
  int all = here ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_MIN, share_.communicator);
  return all == 1;
}

/// Appends to the values of the rows here those of columns that belong to other ranks.
void NetworkFactors::complete(std::vector<double>& values) const {
  if (!share_.has_several_ranks()) return;
  DofVector mine(matrix_->getRowMap());
  const KernelView<double*> own = MixedVector::view_of(mine);
  for (int r = 0; r < remaining_.rows(); ++r) own(column_[r]) = values[r];
  const DofVector all = in_columns(*matrix_, mine);
  const KernelView<const double*> known = MixedVector::view_of(all);
  values.resize(column_.size());
  for (size_t c = remaining_.rows(); c < column_.size(); ++c) values[c] = known(column_[c]);
}

/// Marks rows without entries off the diagonal.
std::vector<unsigned char> NetworkFactors::rows_alone() const {
  const auto local = matrix_->getLocalMatrixHost();
  std::vector<unsigned char> alone(local.numRows(), 1);
  for (int i = 0; i < local.numRows(); ++i)
    for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1) && alone[i] != 0; ++k)
      if ((local.graph.entries(k) == i) == (local.values(k) == 0.0)) alone[i] = 0;
  return alone;
}

void NetworkFactors::take_out(std::vector<unsigned char> alone) {
  const auto graph = matrix_->getLocalMatrixHost().graph;
  const int rows = static_cast<int>(alone.size());
  factors_.reset();
  alone_ = std::move(alone);
  number_columns();
  entry_.clear();
  remaining_ = SparseMatrix();
  remaining_.row_start = {0};
  std::vector<int> number(matrix_->getColMap()->getNodeNumElements(), -1);
  for (size_t c = 0; c < column_.size(); ++c) number[column_[c]] = static_cast<int>(c);
  std::vector<std::pair<int, size_t>> of_row;  // columns ascend
  for (int i = 0; i < rows; ++i) {
    if (alone_[i] != 0) continue;
    of_row.clear();
    for (size_t k = graph.row_map(i); k < graph.row_map(i + 1); ++k)
      if (number[graph.entries(k)] >= 0) of_row.push_back({number[graph.entries(k)], k});
    std::sort(of_row.begin(), of_row.end());
    for (const auto& [column, entry] : of_row) {
      remaining_.column.push_back(column);
      entry_.push_back(entry);
    }
    remaining_.row_start.push_back(static_cast<int>(entry_.size()));
  }
  remaining_.value.resize(entry_.size());
  find_mirrors();
  if (share_.has_several_ranks()) find_mirrors_of_others();
}

/// Numbers the remaining rows over all ranks and imports the numbers of the columns from their owners.
void NetworkFactors::number_columns() {
  const int rows = static_cast<int>(alone_.size()),
            remain = static_cast<int>(std::count(alone_.begin(), alone_.end(), 0));
  share_.rows = GatherPlan(share_.communicator, remain);
  share_.first = share_.rows.offsets[matrix_->getRowMap()->getComm()->getRank()];
  DofVector mine(matrix_->getRowMap());
  const KernelView<double*> own = MixedVector::view_of(mine);
  int next = share_.first;
  for (int i = 0; i < rows; ++i) own(i) = alone_[i] != 0 ? -1.0 : next++;
  const DofVector all = in_columns(*matrix_, mine);
  const KernelView<const double*> known = MixedVector::view_of(all);
  column_.clear();
  share_.column_number.clear();
  for (size_t c = 0; c < known.extent(0); ++c)
    if (known(c) >= 0.0) {
      column_.push_back(static_cast<int>(c));
      share_.column_number.push_back(static_cast<int>(known(c)));
    }
}

void NetworkFactors::find_mirrors() {
  mirror_.assign(entry_.size(), -1);
  const auto at = [this](int row) { return remaining_.column.begin() + remaining_.row_start[row]; };
  for (int i = 0; i < remaining_.rows(); ++i)
    for (int k = remaining_.row_start[i]; k < remaining_.row_start[i + 1]; ++k) {
      const int j = remaining_.column[k];
      if (j >= remaining_.rows()) continue;
      const auto found = std::lower_bound(at(j), at(j + 1), i);
      if (found != at(j + 1) && *found == i) mirror_[k] = static_cast<int>(found - remaining_.column.begin());
    }
}

void NetworkFactors::find_mirrors_of_others() {
  using Place = std::array<int, 2>;  // row and column
  const auto transposed = [](const Place& p) { return Place{p[1], p[0]}; };
  std::vector<Place> mine;
  border_.clear();
  for (int i = 0; i < remaining_.rows(); ++i)
    for (int k = remaining_.row_start[i]; k < remaining_.row_start[i + 1]; ++k)
      if (remaining_.column[k] >= remaining_.rows()) {
        border_.push_back(k);
        mine.push_back({share_.first + i, share_.column_number[remaining_.column[k]]});
      }
  borders_ = GatherPlan(share_.communicator, static_cast<int>(mine.size()));
  std::vector<Place> all(borders_.total());
  MPI_Allgatherv(mine.data(), static_cast<int>(mine.size()), MPI_2INT, all.data(), borders_.counts.data(),
                 borders_.offsets.data(), MPI_2INT, share_.communicator);
  std::vector<int> order(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return all[a] < all[b]; });
  for (size_t b = 0; b < border_.size(); ++b) {
    const Place wanted = transposed(mine[b]);
    const auto found =
        std::lower_bound(order.begin(), order.end(), wanted, [&](int a, const Place& place) { return all[a] < place; });
    if (found != order.end() && all[*found] == wanted) mirror_[border_[b]] = static_cast<int>(entry_.size()) + *found;
  }
}

/// Whether the matrix is symmetric, relative to the largest force-displacement or moment-rotation entries of its rows.
bool NetworkFactors::has_symmetry() const {
  std::vector<double> size(remaining_.rows(), 0.0);
  const auto each_entry = [this](const auto& action) {
    for (int i = 0; i < remaining_.rows(); ++i)
      for (int k = remaining_.row_start[i]; k < remaining_.row_start[i + 1]; ++k)
        if (!action(i, k)) return false;
    return true;
  };
  each_entry([&](int i, int k) {
    if (is_moment(column_[i]) == is_moment(column_[remaining_.column[k]]))
      size[i] = std::max(size[i], std::abs(remaining_.value[k]));
    return true;
  });
  complete(size);
  std::vector<double> mine, others(borders_.total());
  for (int k : border_) mine.push_back(remaining_.value[k]);
  if (share_.has_several_ranks())
    MPI_Allgatherv(mine.data(), static_cast<int>(mine.size()), MPI_DOUBLE, others.data(), borders_.counts.data(),
                   borders_.offsets.data(), MPI_DOUBLE, share_.communicator);
  const int entries = static_cast<int>(entry_.size());
  return on_all_ranks(each_entry([&](int i, int k) {
    const int mirror = mirror_[k];
    const double transposed = mirror < 0 ? 0.0 : mirror < entries ? remaining_.value[mirror] : others[mirror - entries];
    const double difference = std::abs(remaining_.value[k] - transposed);
    return difference <= kSymmetryOfRounding * std::sqrt(size[i] * size[remaining_.column[k]]);
  }));
}

/// Whether the rows that are eliminated first have positive diagonals.
bool NetworkFactors::diagonal_is_positive() const {
  const auto local = matrix_->getLocalMatrixHost();
  bool positive = true;
  for (size_t i = 0; i < alone_.size(); ++i)
    for (size_t k = local.graph.row_map(i); alone_[i] != 0 && k < local.graph.row_map(i + 1); ++k)
      if (local.graph.entries(k) == static_cast<int>(i) && !(local.values(k) > 0.0)) positive = false;
  return on_all_ranks(positive);
}

void NetworkFactors::factorize() {
  std::vector<unsigned char> alone = rows_alone();
  if (!on_all_ranks(alone == alone_ && !share_.rows.counts.empty())) take_out(std::move(alone));
  const auto values = matrix_->getLocalMatrixHost().values;
  for (size_t k = 0; k < entry_.size(); ++k) remaining_.value[k] = values(entry_[k]);
  negative_.reset();
  is_earlier_ = false;
  if (unknowns() == 0) return;
  const auto kind = has_symmetry() ? InertiaSolver::Kind::symmetric : InertiaSolver::Kind::general;
  if (kind != kind_) factors_.reset();
  kind_ = kind;
  iteration_budget_ = factors_ == nullptr || !reusable_ || !is_symmetric()
                          ? 0
                          : static_cast<int>(kShareOfFactorization * factors_->solves_for_factors());
  is_earlier_ = iteration_budget_ >= kLeastIterations;
  if (!is_earlier_) factorize_now();
}

void NetworkFactors::factorize_now() {
  is_earlier_ = reusable_ = false;
  if (factors_ == nullptr || factors_.use_count() > 1) {
    PhaseTimer timer(times_, "symbolic factorisation");
    factors_.reset();
    factors_ = std::make_shared<InertiaSolver>(kind_, remaining_, share_);
  }
  PhaseTimer timer(times_, "numeric factorisation");
  const InertiaSolver::Signs signs = factors_->factorize(remaining_);
  if (signs.null > 0) throw LinearSolverError("the matrix is singular");
  if (is_symmetric() && diagonal_is_positive()) negative_ = signs.negative;
  reusable_ = is_symmetric() && signs.negative == 0;
}

void NetworkFactors::adopt_factors_of(Solver& solver) {
  const auto* from = dynamic_cast<const NetworkFactors*>(&solver);
  if (from == nullptr) return;
  const NetworkFactors& other = *from;
  const auto here = matrix_->getLocalMatrixHost().graph, there = other.matrix_->getLocalMatrixHost().graph;
  const auto same = [](const auto& a, const auto& b) {
    return a.extent(0) == b.extent(0) && std::equal(a.data(), a.data() + a.extent(0), b.data());
  };
  if (!on_all_ranks(other.reusable_ && same(here.row_map, there.row_map) && same(here.entries, there.entries))) return;
  take_out(other.alone_);
  kind_ = other.kind_;
  factors_ = other.factors_;
  reusable_ = true;
}

std::optional<long> NetworkFactors::negative_eigenvalues() {
  if (is_earlier_) try {
      factorize_now();
    } catch (const LinearSolverError&) {  // a singular matrix has no count
    }
  return negative_;
}

/// Iterates with the remaining rows, preconditioned by the factors.
struct NetworkFactors::Iteration {
  using Numbers = std::vector<double>;
  const NetworkFactors& of;

  double dot(const Numbers& a, const Numbers& b) const {
    double sum = std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    if (of.share_.has_several_ranks())
      MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, of.share_.communicator);
    return sum;
  }
  static void add(double s, const Numbers& b, Numbers& a) {
    for (size_t i = 0; i < a.size(); ++i) a[i] += s * b[i];
  }
  static void extend(const Numbers& z, double beta, Numbers& p) {
    for (size_t i = 0; i < p.size(); ++i) p[i] = z[i] + beta * p[i];
  }
  void multiply(Numbers& p, Numbers& q) const {
    of.complete(p);
    of.remaining_.multiply(p.data(), q.data());
    p.resize(q.size());
  }
  void precondition(const Numbers& r, Numbers& z) const {
    z = r;
    of.factors_->solve(z.data(), 1);
  }
};

/// Conjugate gradients; false if they would need more iterations than the budget.
bool NetworkFactors::iterate(std::vector<double>& b) {
  PhaseTimer timer(times_, "iterations with earlier factors");
  std::vector<double> r = b, z, p(b.size(), 0.0), q(b.size()), x(b.size(), 0.0);
  iterations_ = 0;
  const KrylovEnd end = conjugate_gradients(
      Iteration{*this}, x, r, z, p, q, kReduction, [this](int iterations, double energy, double first) {
        iterations_ = iterations;
        const bool is_hopeless =
            iterations >= kForecast && iterations * std::log(kReduction * kReduction) <
                                           (iterations + iteration_budget_) * std::log(energy / first);
        if (iteration_budget_ <= 0 || is_hopeless) return false;
        --iteration_budget_;
        ++iterations_;
        return true;
      });
  if (end != KrylovEnd::converged) return false;
  b = std::move(x);
  return true;
}

double NetworkFactors::solve(const DofVector& b, DofVector& x, double /*energy_reduction*/) {
  const auto local = matrix_->getLocalMatrixHost();
  const KernelView<const double*> given = MixedVector::view_of(b);
  const KernelView<double*> found = MixedVector::view_of(x);
  for (size_t i = 0; i < alone_.size(); ++i) {
    found(i) = 0.0;
    for (size_t k = local.graph.row_map(i); alone_[i] != 0 && k < local.graph.row_map(i + 1); ++k)
      if (local.graph.entries(k) == static_cast<int>(i)) found(i) = given(i) / local.values(k);
  }
  const DofVector all = in_columns(*matrix_, x);
  const KernelView<const double*> known = MixedVector::view_of(all);
  std::vector<double> rhs(remaining_.rows());
  for (size_t r = 0; r < rhs.size(); ++r) {
    const int row = column_[r];
    rhs[r] = given(row);
    for (size_t k = local.graph.row_map(row); k < local.graph.row_map(row + 1); ++k)
      rhs[r] -= local.values(k) * known(local.graph.entries(k));  // zero for unknowns not yet solved for
  }
  if (is_earlier_ && !iterate(rhs)) factorize_now();
  if (unknowns() > 0 && !is_earlier_) factors_->solve(rhs.data(), 1);
  for (size_t r = 0; r < rhs.size(); ++r) found(column_[r]) = rhs[r];
  return 0.0;
}

}  // namespace mixbeam
