#include "nonlinear/linear/inertia_solver.hpp"

#include "nonlinear/linear/linear_solver.hpp"

#include <dmumps_c.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace mixbeam {

void SparseMatrix::multiply(const double* x, double* y) const {
  for (int i = 0; i < rows(); ++i) {
    double sum = 0.0;
    for (int k = row_start[i]; k < row_start[i + 1]; ++k) sum += value[k] * x[column[k]];
    y[i] = sum;
  }
}

double asymmetry(const SparseMatrix& a) {
  const auto entry = [&](int i, int j) {
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k)
      if (a.column[k] == j) return a.value[k];
    return 0.0;
  };
  std::vector<double> diagonal(a.rows());
  for (int i = 0; i < a.rows(); ++i) diagonal[i] = std::max(std::abs(entry(i, i)), 1.0);
  double largest = 0.0;
  for (int i = 0; i < a.rows(); ++i)
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
      const int j = a.column[k];
      const double difference = std::abs(a.value[k] - entry(j, i));
      if (difference > 0.0) largest = std::max(largest, difference / std::sqrt(diagonal[i] * diagonal[j]));
    }
  return largest;
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
constexpr int kApproximateMinimumDegree = 0;
constexpr int kWorkspaceTooSmall = -9, kIntegerWorkspaceTooSmall = -8;
constexpr int kLargestWorkspace = 2000;  // per cent above the estimate: far beyond what delayed pivots need

}  // namespace

struct InertiaSolver::Mumps {
  DMUMPS_STRUC_C data{};
  Kind kind;
  std::vector<int> row, column;  ///< entries that MUMPS sees, counted from one
  std::vector<int> entry;        ///< where their values stand in the matrix
  std::vector<double> value;

  Mumps(Kind k, const SparseMatrix& structure) : kind(k) {
    for (int i = 0; i < structure.rows(); ++i)
      for (int e = structure.row_start[i]; e < structure.row_start[i + 1]; ++e) {
        if (kind == Kind::symmetric && structure.column[e] > i) continue;
        row.push_back(i + 1);
        column.push_back(structure.column[e] + 1);
        entry.push_back(e);
      }
    value.resize(entry.size());
    data.sym = kind == Kind::symmetric ? 2 : 0;
    data.par = 1;
    data.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(MPI_COMM_SELF));
    call(kInitialize);
    set_controls();
    data.n = structure.rows();
    data.nnz = static_cast<MUMPS_INT8>(entry.size());
    data.irn = row.data();
    data.jcn = column.data();
    data.a = value.data();
    call(kAnalyse);
  }
  ~Mumps() {
    data.job = kTerminate;
    dmumps_c(&data);
  }
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

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

InertiaSolver::InertiaSolver(Kind kind, const SparseMatrix& structure)
    : mumps_(std::make_unique<Mumps>(kind, structure)) {}

InertiaSolver::~InertiaSolver() = default;

InertiaSolver::Signs InertiaSolver::factorize(const SparseMatrix& matrix) {
  Mumps& m = *mumps_;
  for (size_t k = 0; k < m.entry.size(); ++k) m.value[k] = matrix.value[m.entry[k]];
  int code = m.try_call(kFactorize);
  while ((code == kWorkspaceTooSmall || code == kIntegerWorkspaceTooSmall) &&
         m.control(kMoreWorkspace) < kLargestWorkspace) {
    m.control(kMoreWorkspace) *= 2;
    code = m.try_call(kFactorize);
  }
  if (code < 0)
    throw LinearSolverError("MUMPS could not factorise the tangent, code " + std::to_string(code) + ", " +
                            std::to_string(m.info(2)));
  Signs signs;
  if (m.kind == Kind::symmetric) signs.negative = m.info(12);
  signs.null = m.info(28);
  const double mantissa = m.data.rinfog[12 - 1];
  signs.determinant_sign = signs.null > 0 || mantissa == 0.0 ? 0 : (mantissa > 0.0 ? 1 : -1);
  return signs;
}

void InertiaSolver::solve(double* block, int columns, bool transposed) {
  Mumps& m = *mumps_;
  m.control(kTransposed) = transposed ? 0 : 1;
  m.data.rhs = block;
  m.data.nrhs = columns;
  m.data.lrhs = m.data.n;
  m.call(kSolve);
}

}  // namespace mixbeam
