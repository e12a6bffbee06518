#include "nonlinear/linear/inertia_solver.hpp"

#include "discretization/mesh/mpi_at_need.hpp"
#include "discretization/mesh/row_lists.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/linear/blas_setup.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <dmumps_c.h>
#include <metis.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

extern "C" {
void dsytrf_(const char*, const int*, double*, const int*, int*, double*, const int*, int*);
void dsytrs_(const char*, const int*, const int*, const double*, const int*, const int*, double*, const int*, int*);
void dgetrf_(const int*, const int*, double*, const int*, int*, int*);
void dgetrs_(const char*, const int*, const int*, const double*, const int*, const int*, double*, const int*, int*);
}

namespace mixbeam {

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
  kMatrixInput = 18,
  kDetectNullPivots = 24,
  kAnalysisKind = 28,
  kDeterminant = 33
};
constexpr int kEntries = 29;  // index in INFOG: entries of the factors, in millions if negative
constexpr int kApproximateMinimumDegree = 0, kGivenOrdering = 1, kOfEachRank = 3;
/// MUMPS's errors for too small a workspace: of reals, of integers, of send and receive buffers.
constexpr int kWorkspaceTooSmall[] = {-9, -8, -17, -20};
/// KEEP(9): a front is shared among ranks if it leaves this many rows to its parent. MUMPS decides at run time which
/// ranks take part: without such sharing, two ranks took 10 % less time and 4 % less memory for 20^3 junctions.
constexpr int kLeastSharedFront = 9;
constexpr int kLargestWorkspace = 2000;  // per cent above the estimate: far more than delayed pivots need

/// Rows up to which LAPACK factorises: its n^3 / 3 operations then take 0.1 ms, as MUMPS does to start and terminate.
constexpr int kMostDenseRows = 60;
/// Share of the largest entry below which a pivot is zero, as in MUMPS.
constexpr double kNullPivot = 1e-5 * std::numeric_limits<double>::epsilon();
constexpr double kHeld = 1e150;  ///< replaces a null pivot, so that its unknown does not move
/// Operations of a factorisation that take as long as a solve does per entry, and additional cost of a factorisation
/// per entry, in solves: measured with OpenBLAS on cubes and sheets of junctions.
constexpr double kOperationsOfSolve = 67.0, kSolvesForEntries = 5.0;

/// Groups of rows below which minimum degree is as good as nested dissection, and METIS costs more than it saves.
constexpr int kLeastGroups = 50;

/// Groups of rows with the same columns, usually those of one junction. The graph of groups is ordered in a few per
/// cent of the time that the matrix would take.
struct RowGroups {
  std::vector<int> group;          ///< (row)
  std::vector<idx_t> start, next;  ///< neighbours of each group, without itself
  explicit RowGroups(const SparseMatrix& a);
  int count() const { return static_cast<int>(start.size()) - 1; }
};

RowGroups::RowGroups(const SparseMatrix& a) : group(a.rows()) {
  std::vector<int> first;
  const auto begin_of = [&a](int i) { return a.column.begin() + a.row_start[i]; };
  for (int i = 0; i < a.rows(); ++i) {
    const bool joins = i > 0 && std::equal(begin_of(i), begin_of(i + 1), begin_of(i - 1), begin_of(i)) &&
                       std::find(begin_of(i), begin_of(i + 1), i - 1) != begin_of(i + 1);
    if (!joins) first.push_back(i);
    group[i] = static_cast<int>(first.size()) - 1;
  }
  // Graph of a and its transpose.
  const Graph<int> graph = joined_links<int>(static_cast<int>(first.size()), [&](const auto& add) {
    for (size_t g = 0; g < first.size(); ++g)
      for (auto column = begin_of(first[g]); column != begin_of(first[g] + 1); ++column) {
        add(static_cast<int>(g), {group[*column], 1});
        add(group[*column], {static_cast<int>(g), 1});
      }
  });
  start.assign(graph.start.begin(), graph.start.end());
  next.assign(graph.neighbour.begin(), graph.neighbour.end());
}

/// Position of each row in the order of pivots, counted from one, by nested dissection (METIS) of groups of rows with
/// the same columns; empty if that does not pay.
std::vector<int> dissection_order(const SparseMatrix& a) {
  RowGroups groups(a);
  if (groups.count() < kLeastGroups || groups.next.empty()) return {};
  idx_t count = groups.count();
  std::vector<idx_t> weight(count, 0), order(count), place(count);
  for (int g : groups.group) ++weight[g];
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  if (METIS_NodeND(&count, groups.start.data(), groups.next.data(), weight.data(), options, order.data(),
                   place.data()) != METIS_OK)
    return {};
  std::vector<int> first(count), result(a.rows());
  for (idx_t k = 0, rows = 1; k < count; rows += weight[order[k++]]) first[order[k]] = rows;
  for (int i = 0; i < a.rows(); ++i) result[i] = first[groups.group[i]]++;
  return result;
}

}  // namespace

struct InertiaSolver::Factors {
  Kind kind;
  RowsOfRanks share;
  int rows;                      ///< of all ranks
  std::vector<int> row, column;  ///< of the entries used, from one; symmetric: the lower triangle
  std::vector<int> entry;        ///< position of their values in the matrix
  std::vector<double> value;
  Signs signs;  ///< of the factors, while there are any
  bool has_factors = false;
  int factorizations = 0;

  Factors(Kind k, const SparseMatrix& structure, RowsOfRanks s)
      : kind(k), share(std::move(s)), rows(share.rows.total()) {
    set_up_blas();
    for (int i = 0; i < structure.rows(); ++i)
      for (int e = structure.row_start[i]; e < structure.row_start[i + 1]; ++e) {
        const int r = share.first + i, c = share.column_number[structure.column[e]];
        if (kind == Kind::symmetric && c > r) continue;
        row.push_back(r + 1);
        column.push_back(c + 1);
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
  /// See InertiaSolver::solves_for_factors(); 0 if factors are always cheap.
  virtual double solves_for_factors() const { return 0.0; }
};

/// Factorises matrices of a few rows by LAPACK's dsytrf or dgetrf: MUMPS takes a fifth of the time of a small run to
/// start and terminate, and ten times as long for each solve.
struct InertiaSolver::Dense final : Factors {
  std::vector<double> factors, work;
  std::vector<int> pivots;

  Dense(Kind k, const SparseMatrix& structure, RowsOfRanks s)
      : Factors(k, structure, std::move(s)), factors(rows * rows), work(rows), pivots(rows) {}
  double& at(int i, int j) { return factors[static_cast<size_t>(j) * rows + i]; }

  Signs factorize() override {
    if (rows == 0) return {0, 0, 1};  // LAPACK takes no leading dimension of zero
    std::fill(factors.begin(), factors.end(), 0.0);
    double largest = 0.0;
    for (size_t k = 0; k < entry.size(); ++k) {
      double& here = at(row[k] - 1, column[k] - 1);
      here += value[k];
      largest = std::max(largest, std::abs(here));
    }
    return kind == Kind::symmetric ? factorize_symmetric(kNullPivot * largest)
                                   : factorize_general(kNullPivot * largest);
  }
  Signs factorize_general(double zero) {
    int info = 0;
    dgetrf_(&rows, &rows, factors.data(), &rows, pivots.data(), &info);
    if (info < 0) throw LinearSolverError("LAPACK's dgetrf stopped with code " + std::to_string(info));
    Signs found;
    found.determinant_sign = 1;
    for (int i = 0; i < rows; ++i) {
      if (pivots[i] != i + 1) found.determinant_sign = -found.determinant_sign;
      if (at(i, i) < 0.0) found.determinant_sign = -found.determinant_sign;
      if (std::abs(at(i, i)) > zero) continue;
      ++found.null;
      at(i, i) = kHeld;
    }
    if (found.null > 0) found.determinant_sign = 0;
    return found;
  }
  Signs factorize_symmetric(double zero) {
    int info = 0;
    dsytrf_("L", &rows, factors.data(), &rows, pivots.data(), work.data(), &rows, &info);
    if (info < 0) throw LinearSolverError("LAPACK's dsytrf stopped with code " + std::to_string(info));
    Signs found;
    for (int i = 0; i < rows; ++i) {
      if (pivots[i] < 0) {  // a 2 x 2 block, which has one eigenvalue of each sign
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
  void solve(double* block, int columns, bool transposed) override {
    int info = 0;
    if (rows == 0) return;
    if (kind == Kind::general) {
      dgetrs_(transposed ? "T" : "N", &rows, &columns, factors.data(), &rows, pivots.data(), block, &rows, &info);
      return;
    }
    dsytrs_("L", &rows, &columns, factors.data(), &rows, pivots.data(), block, &rows, &info);
  }
};

struct InertiaSolver::Mumps final : Factors {
  DMUMPS_STRUC_C data{};
  std::vector<int> order;  ///< see dissection_order()
  double solves = 0.0;     ///< see solves_for_factors()

  Mumps(Kind k, const SparseMatrix& structure, RowsOfRanks s) : Factors(k, structure, std::move(s)) {
    require_mpi();
    order = share.has_several_ranks() ? dissection_order(gathered_structure(structure, share))
                                      : dissection_order(structure);
    data.sym = kind == Kind::symmetric ? 2 : 0;
    data.par = 1;
    data.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(share.communicator));
    call(kInitialize);
    set_controls();
    data.n = rows;
    data.nnz = data.nnz_loc = static_cast<MUMPS_INT8>(entry.size());
    data.irn = data.irn_loc = row.data();
    data.jcn = data.jcn_loc = column.data();
    data.a = data.a_loc = value.data();
    if (!order.empty()) {
      control(kOrdering) = kGivenOrdering;
      data.perm_in = order.data();
    }
    call(kAnalyse);
  }
  ~Mumps() override {
    // Termination is collective: other ranks would wait for ever for one that failed alone, say for lack of memory.
    if (share.has_several_ranks() && std::uncaught_exceptions() > 0) return;
    data.job = kTerminate;
    dmumps_c(&data);
  }
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  void drop_matrix() override {
    Factors::drop_matrix();
    data.irn = data.jcn = data.irn_loc = data.jcn_loc = nullptr;
    data.a = data.a_loc = nullptr;
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
    while (std::count(std::begin(kWorkspaceTooSmall), std::end(kWorkspaceTooSmall), code) > 0 &&
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
    // Rank 0 alone has these.
    MPI_Bcast(data.rinfog, static_cast<int>(std::size(data.rinfog)), MPI_DOUBLE, 0, share.communicator);
    const int count = info(kEntries);
    const double entries = count > 0 ? count : -1e6 * count;
    solves = entries == 0.0 ? 0.0 : kSolvesForEntries + data.rinfog[0] / (kOperationsOfSolve * entries);
    const double mantissa = data.rinfog[12 - 1];
    found.determinant_sign = found.null > 0 || mantissa == 0.0 ? 0 : (mantissa > 0.0 ? 1 : -1);
    return found;
  }
  void solve(double* block, int columns, bool transposed) override {
    control(kTransposed) = transposed ? 0 : 1;
    data.nrhs = columns;
    data.lrhs = rows;
    if (share.has_several_ranks()) return solve_together(block);
    data.rhs = block;
    call(kSolve);
  }
  double solves_for_factors() const override { return solves; }

 private:
  void set_controls() {
    control(kErrorStream) = control(kDiagnosticStream) = control(kGlobalStream) = -1;
    control(kPrintLevel) = 0;
    // The analysis has no values yet, so nothing in it may depend on them.
    control(kColumnPermutation) = 0;
    control(kSymmetricStrategy) = 1;
    control(kAnalysisKind) = 1;
    control(kOrdering) = kApproximateMinimumDegree;
    control(kRootParallelism) = 1;  // otherwise pivots of the last front may not be counted
    control(kDetectNullPivots) = 1;
    control(kDeterminant) = 1;
    if (!share.has_several_ranks()) return;
    control(kMatrixInput) = kOfEachRank;
    data.keep[kLeastSharedFront - 1] = rows;
  }
  void solve_together(double* mine) {
    int rank = 0;
    MPI_Comm_rank(share.communicator, &rank);
    const GatherPlan& of = share.rows;
    std::vector<double> all(rank == 0 ? rows : 0);
    MPI_Gatherv(mine, of.counts[rank], MPI_DOUBLE, all.data(), of.counts.data(), of.offsets.data(), MPI_DOUBLE, 0,
                share.communicator);
    data.rhs = all.data();
    call(kSolve);
    MPI_Scatterv(all.data(), of.counts.data(), of.offsets.data(), MPI_DOUBLE, mine, of.counts[rank], MPI_DOUBLE, 0,
                 share.communicator);
  }
};

namespace {

RowsOfRanks of_one_rank(const SparseMatrix& structure) {
  RowsOfRanks share;
  share.rows = GatherPlan(share.communicator, structure.rows());
  share.column_number.resize(structure.rows());
  std::iota(share.column_number.begin(), share.column_number.end(), 0);
  return share;
}

/// Subtracts A x or A^T x from `given`; returns the largest residual over the largest sum of |terms| of a row.
double rest_of(const SparseMatrix& matrix, bool transposed, const double* x, double* given) {
  std::vector<double> sum(matrix.rows());
  for (int i = 0; i < matrix.rows(); ++i) sum[i] = std::abs(given[i]);
  for (int i = 0; i < matrix.rows(); ++i)
    for (int k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k) {
      const int row = transposed ? matrix.column[k] : i, column = transposed ? i : matrix.column[k];
      const double term = matrix.value[k] * x[column];
      given[row] -= term;
      sum[row] += std::abs(term);
    }
  double largest = 0.0;
  for (int i = 0; i < matrix.rows(); ++i) largest = std::max(largest, std::abs(given[i]));
  return largest == 0.0 ? 0.0 : largest / *std::max_element(sum.begin(), sum.end());
}

}  // namespace

InertiaSolver::InertiaSolver(Kind kind, const SparseMatrix& structure)
    : InertiaSolver(kind, structure, of_one_rank(structure)) {}

InertiaSolver::InertiaSolver(Kind kind, const SparseMatrix& structure, RowsOfRanks share) {
  if (!share.has_several_ranks() && structure.rows() <= kMostDenseRows)
    factors_ = std::make_unique<Dense>(kind, structure, std::move(share));
  else
    factors_ = std::make_unique<Mumps>(kind, structure, std::move(share));
}

InertiaSolver::~InertiaSolver() = default;

InertiaSolver::Signs InertiaSolver::factorize(const SparseMatrix& matrix) {
  Factors& f = *factors_;
  int same = f.has_factors ? 1 : 0, finite = 1;
  for (size_t k = 0; k < f.entry.size(); ++k) {
    const double value = matrix.value[f.entry[k]];
    same = same == 1 && value == f.value[k] ? 1 : 0;
    f.value[k] = value;
  }
  if (!std::all_of(f.value.begin(), f.value.end(), [](double a) { return std::isfinite(a); })) finite = 0;
  int both[2] = {same, finite};
  if (f.share.has_several_ranks()) MPI_Allreduce(MPI_IN_PLACE, both, 2, MPI_INT, MPI_MIN, f.share.communicator);
  if (both[0] == 1) return f.signs;
  f.has_factors = false;
  if (both[1] == 0) throw LinearSolverError("the tangent holds numbers that are not finite");
  ++f.factorizations;
  f.signs = f.factorize();
  f.has_factors = true;
  return f.signs;
}

void InertiaSolver::drop_matrix() { factors_->drop_matrix(); }

int InertiaSolver::factorizations() const { return factors_->factorizations; }

double InertiaSolver::solves_for_factors() const { return factors_->solves_for_factors(); }

void InertiaSolver::solve(double* block, int columns, bool transposed) { factors_->solve(block, columns, transposed); }

void solve_refined(InertiaSolver& solver, const SparseMatrix& matrix, std::vector<double>& columns, int count,
                   bool transposed, double refined, const std::string& equations) {
  constexpr double kRefused = 1e-9;
  if (columns.empty()) return;
  const std::vector<double> given = columns;
  const size_t n = columns.size() / count;
  solver.solve(columns.data(), count, transposed);
  for (int pass = 0;; ++pass) {
    std::vector<double> left = given;
    double error = 0.0;
    for (int j = 0; j < count; ++j) error = std::max(error, rest_of(matrix, transposed, &columns[n * j], &left[n * j]));
    if (error <= (pass == 0 ? refined : kRefused)) return;
    if (pass > 0) throw LinearSolverError("the " + equations + " were not solved: backward error " + shortest(error));
    solver.solve(left.data(), count, transposed);
    for (size_t i = 0; i < left.size(); ++i) columns[i] += left[i];
  }
}

}  // namespace mixbeam
