#include "nonlinear/linear/inertia_solver.hpp"

#include "nonlinear/linear/blas_setup.hpp"
#include "nonlinear/linear/dissection_order.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <dmumps_c.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

extern "C" {
void dsytrf_(const char*, const int*, double*, const int*, int*, double*, const int*, int*);
void dsytrs_(const char*, const int*, const int*, const double*, const int*, const int*, double*, const int*, int*);
}

namespace mixbeam {

void SparseMatrix::multiply(const double* x, double* y) const {
  for (int i = 0; i < rows(); ++i) {
    double sum = 0.0;
    for (int k = row_start[i]; k < row_start[i + 1]; ++k) sum += value[k] * x[column[k]];
    y[i] = sum;
  }
}

double asymmetry(const SparseMatrix& a) {
  const int n = a.rows();
  std::vector<int> next(n + 1, 0);  // entries of each column, its rows ascending
  for (int j : a.column) ++next[j + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::pair<int, double>> transposed(a.column.size());
  std::vector<double> diagonal(n, 1.0), row(n, 0.0);
  for (int i = 0; i < n; ++i)
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
      transposed[next[a.column[k]]++] = {i, a.value[k]};
      if (a.column[k] == i) diagonal[i] = std::max(std::abs(a.value[k]), 1.0);
    }
  double largest = 0.0;
  for (int i = 0; i < n; ++i) {  // next[i] is now the end of column i
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) row[a.column[k]] = a.value[k];
    for (int k = i > 0 ? next[i - 1] : 0; k < next[i]; ++k) {
      const auto& [j, value] = transposed[k];
      const double difference = std::abs(row[j] - value);
      if (difference > 0.0) largest = std::max(largest, difference / std::sqrt(diagonal[i] * diagonal[j]));
    }
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) row[a.column[k]] = 0.0;
  }
  return largest;
}

SparseMatrix symmetric_part(SparseMatrix a) {
  for (int i = 0; i < a.rows(); ++i)
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
      const int j = a.column[k];
      if (j >= i) continue;
      const auto end = a.column.begin() + a.row_start[j + 1];
      const auto mirrored = std::find(a.column.begin() + a.row_start[j], end, i);
      if (mirrored == end) continue;
      double& other = a.value[mirrored - a.column.begin()];
      a.value[k] = other = 0.5 * (a.value[k] + other);
    }
  return a;
}

namespace {

// Jobs and control parameters by their names in the users' guide of MUMPS 5; its arrays count from one.
enum Job { kInitialize = -1, kTerminate = -2, kAnalyse = 1, kFactorize = 2, kSolve = 3 };
enum Control {
  kErrorStream = 1,
  kDiagnosticStream = 2,
  kGlobalStream = 3,
  kPrintLevel = 4,
  kColumnPermutation = 6,
  kOrdering = 7,
  kTransposed = 9,
  kSymmetricStrategy = 12,
  kRootParallelism = 13,
  kMoreWorkspace = 14,
  kDetectNullPivots = 24,
  kAnalysisKind = 28,
  kDeterminant = 33
};
constexpr int kEntries = 29;  // of INFOG: of the factors, in millions where below zero
constexpr int kApproximateMinimumDegree = 0, kGivenOrdering = 1;
constexpr int kWorkspaceTooSmall = -9, kIntegerWorkspaceTooSmall = -8;
constexpr int kLargestWorkspace = 2000;  // per cent above the estimate: far beyond what delayed pivots need

/// So many rows are factorised by LAPACK: its n^3 / 3 are then 0.1 ms, what MUMPS takes to begin and end.
constexpr int kMostDenseRows = 60;
/// A pivot below this share of the largest entry is zero: as MUMPS has it.
constexpr double kNullPivot = 1e-5 * std::numeric_limits<double>::epsilon();
constexpr double kHeld = 1e150;  ///< in place of it: what it stands for does not move
/// Operations of a factorisation that take as long as a solve does for each entry, and solves that take as long as what
/// a factorisation does with each entry besides: measured with OpenBLAS on cubes and sheets of junctions.
constexpr double kOperationsOfSolve = 67.0, kSolvesForEntries = 5.0;

}  // namespace

struct InertiaSolver::Factors {
  Kind kind;
  int rows;
  std::vector<int> row, column;  ///< entries that count, from one; symmetric: those of the lower triangle
  std::vector<int> entry;        ///< where their values stand in the matrix
  std::vector<double> value;
  Signs signs;  ///< of the factors, while there are any
  bool has_factors = false;
  int factorizations = 0;

  Factors(Kind k, const SparseMatrix& structure) : kind(k), rows(structure.rows()) {
    set_up_blas();
    for (int i = 0; i < rows; ++i)
      for (int e = structure.row_start[i]; e < structure.row_start[i + 1]; ++e) {
        if (kind == Kind::symmetric && structure.column[e] > i) continue;
        row.push_back(i + 1);
        column.push_back(structure.column[e] + 1);
        entry.push_back(e);
      }
    value.resize(entry.size());
  }
  virtual ~Factors() = default;
  virtual void drop_matrix() {
    for (std::vector<int>* list : {&row, &column, &entry}) std::vector<int>().swap(*list);
    std::vector<double>().swap(value);
  }
  virtual Signs factorize() = 0;
  virtual void solve(double* block, int columns, bool transposed) = 0;
  /// See InertiaSolver::solves_for_factors(); 0 where factors are always cheap.
  virtual double solves_for_factors() const { return 0.0; }
};

/// Symmetric matrices of a few rows by LAPACK's dsytrf: MUMPS takes a fifth of the time of a small run to begin and
/// end.
struct InertiaSolver::Dense final : Factors {
  std::vector<double> factors, work;
  std::vector<int> pivots;

  explicit Dense(const SparseMatrix& structure)
      : Factors(Kind::symmetric, structure), factors(rows * rows), work(rows), pivots(rows) {}
  double& at(int i, int j) { return factors[static_cast<size_t>(j) * rows + i]; }

  Signs factorize() override {
    std::fill(factors.begin(), factors.end(), 0.0);
    double largest = 0.0;
    for (size_t k = 0; k < entry.size(); ++k) {
      double& here = at(row[k] - 1, column[k] - 1);
      here += value[k];
      largest = std::max(largest, std::abs(here));
    }
    int info = 0;
    dsytrf_("L", &rows, factors.data(), &rows, pivots.data(), work.data(), &rows, &info);
    if (info < 0) throw LinearSolverError("LAPACK's dsytrf stopped with code " + std::to_string(info));
    const double zero = kNullPivot * largest;
    Signs found;
    for (int i = 0; i < rows; ++i) {
      if (pivots[i] < 0) {  // a block of two, which has one eigenvalue of either sign
        if (std::abs(at(i + 1, i)) > zero) {
          ++found.negative;
        } else {
          found.null += 2;
          at(i, i) = at(i + 1, i + 1) = kHeld;
          at(i + 1, i) = 1.0;
        }
        ++i;
      } else if (std::abs(at(i, i)) <= zero) {
        ++found.null;
        at(i, i) = kHeld;
      } else if (at(i, i) < 0.0) {
        ++found.negative;
      }
    }
    found.determinant_sign = found.null > 0 ? 0 : found.negative % 2 == 0 ? 1 : -1;
    return found;
  }
  void solve(double* block, int columns, bool /*transposed*/) override {
    int info = 0;
    dsytrs_("L", &rows, &columns, factors.data(), &rows, pivots.data(), block, &rows, &info);
  }
};

struct InertiaSolver::Mumps final : Factors {
  DMUMPS_STRUC_C data{};
  std::vector<int> order;  ///< see dissection_order()

  Mumps(Kind k, const SparseMatrix& structure) : Factors(k, structure), order(dissection_order(structure)) {
    data.sym = kind == Kind::symmetric ? 2 : 0;
    data.par = 1;
    data.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(MPI_COMM_SELF));
    call(kInitialize);
    set_controls();
    data.n = rows;
    data.nnz = static_cast<MUMPS_INT8>(entry.size());
    data.irn = row.data();
    data.jcn = column.data();
    data.a = value.data();
    if (!order.empty()) {
      control(kOrdering) = kGivenOrdering;
      data.perm_in = order.data();
    }
    call(kAnalyse);
  }
  ~Mumps() override {
    data.job = kTerminate;
    dmumps_c(&data);
  }
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  void drop_matrix() override {
    Factors::drop_matrix();
    data.irn = data.jcn = nullptr;
    data.a = nullptr;
  }
  MUMPS_INT& control(Control index) { return data.icntl[index - 1]; }
  int info(int index) const { return data.infog[index - 1]; }

  int try_call(Job job) {
    data.job = job;
    dmumps_c(&data);
    return info(1);
  }
  void call(Job job) {
    const int code = try_call(job);
    if (code < 0)
      throw LinearSolverError("MUMPS stopped with code " + std::to_string(code) + ", " + std::to_string(info(2)));
  }

  Signs factorize() override {
    int code = try_call(kFactorize);
    while ((code == kWorkspaceTooSmall || code == kIntegerWorkspaceTooSmall) &&
           control(kMoreWorkspace) < kLargestWorkspace) {
      control(kMoreWorkspace) *= 2;
      code = try_call(kFactorize);
    }
    if (code < 0)
      throw LinearSolverError("MUMPS could not factorise the tangent, code " + std::to_string(code) + ", " +
                              std::to_string(info(2)));
    Signs found;
    if (kind == Kind::symmetric) found.negative = info(12);
    found.null = info(28);
    const double mantissa = data.rinfog[12 - 1];
    found.determinant_sign = found.null > 0 || mantissa == 0.0 ? 0 : (mantissa > 0.0 ? 1 : -1);
    return found;
  }
  void solve(double* block, int columns, bool transposed) override {
    control(kTransposed) = transposed ? 0 : 1;
    data.rhs = block;
    data.nrhs = columns;
    data.lrhs = rows;
    call(kSolve);
  }
  double solves_for_factors() const override {
    const int count = info(kEntries);
    const double entries = count > 0 ? count : -1e6 * count;
    return entries == 0.0 ? 0.0 : kSolvesForEntries + data.rinfog[0] / (kOperationsOfSolve * entries);
  }

 private:
  void set_controls() {
    control(kErrorStream) = control(kDiagnosticStream) = control(kGlobalStream) = -1;
    control(kPrintLevel) = 0;
    // the analysis comes before any values, so nothing may depend on them
    control(kColumnPermutation) = 0;
    control(kSymmetricStrategy) = 1;
    control(kAnalysisKind) = 1;
    control(kOrdering) = kApproximateMinimumDegree;
    control(kRootParallelism) = 1;  // else pivots of the last front may not be counted
    control(kDetectNullPivots) = 1;
    control(kDeterminant) = 1;
  }
};

InertiaSolver::InertiaSolver(Kind kind, const SparseMatrix& structure) {
  if (kind == Kind::symmetric && structure.rows() <= kMostDenseRows)
    factors_ = std::make_unique<Dense>(structure);
  else
    factors_ = std::make_unique<Mumps>(kind, structure);
}

InertiaSolver::~InertiaSolver() = default;

InertiaSolver::Signs InertiaSolver::factorize(const SparseMatrix& matrix) {
  Factors& f = *factors_;
  bool same = f.has_factors;
  for (size_t k = 0; k < f.entry.size(); ++k) {
    const double value = matrix.value[f.entry[k]];
    same = same && value == f.value[k];
    f.value[k] = value;
  }
  if (same) return f.signs;
  f.has_factors = false;
  if (!std::all_of(f.value.begin(), f.value.end(), [](double a) { return std::isfinite(a); }))
    throw LinearSolverError("the tangent holds numbers that are not finite");
  ++f.factorizations;
  f.signs = f.factorize();
  f.has_factors = true;
  return f.signs;
}

void InertiaSolver::drop_matrix() { factors_->drop_matrix(); }

int InertiaSolver::factorizations() const { return factors_->factorizations; }

double InertiaSolver::solves_for_factors() const { return factors_->solves_for_factors(); }

void InertiaSolver::solve(double* block, int columns, bool transposed) { factors_->solve(block, columns, transposed); }

}  // namespace mixbeam
