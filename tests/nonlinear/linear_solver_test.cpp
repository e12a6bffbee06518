// Right solutions are returned with a small backward error, wrong ones are never returned.
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/linear/inertia_solver.hpp"

#include "discretization/assembly/tangent.hpp"
#include "nonlinear/linear/blas_setup.hpp"
#include "tests/support/solve.hpp"
#include "tests/support/worst_error.hpp"

#include <dlfcn.h>
#include <Teuchos_LAPACK.hpp>

#include <atomic>
#include <thread>

namespace mixbeam::test {
namespace {

constexpr double kTolerance = 1e-8;  // of the solver's own check: its default

/// What is solved by what: a matrix without symmetry, and a symmetric one.
enum Kind { kKlu, kMumpsLu, kSymmetricMumps };
constexpr Kind kKinds[] = {kKlu, kMumpsLu, kSymmetricMumps};

/// The matrix of a scene filled with numbers that depend on row and column alone, dominated by its diagonal: well
/// conditioned, the same matrix on any number of ranks.
class Equations {
 public:
  explicit Equations(const Communicator& comm, Kind kind = kKlu)
      : kind_(kind), model_(fork(2, 3), comm, {}), all_(whole_matrix(model_)) {
    fill();
    solver = make_direct_solver(all_.matrix(), kind == kKlu ? "KLU2" : kMumps, kTolerance, model_.times());
    known = right_hand_side = solution = Teuchos::null;
    known = Teuchos::rcp(new DofVector(model_.map()));
    right_hand_side = Teuchos::rcp(new DofVector(model_.map()));
    solution = Teuchos::rcp(new DofVector(model_.map()));
    const auto x = MixedVector::view_of(*known);
    for (size_t i = 0; i < x.extent(0); ++i) x(i) = std::sin(1.0 + global_row(static_cast<int>(i)));
    matrix().apply(*known, *right_hand_side);
  }

  /// Multiplies the rows of one vertex, wherever it is.
  void scale_rows(int first, int last, double factor) {
    for_each_entry([&](int row, int, double& value) {
      if (row >= first && row < last) value *= factor;
    });
  }
  template <class Action>
  void for_each_entry(const Action& action) {
    const auto local = all_.matrix()->getLocalMatrixHost();
    const auto columns = all_.matrix()->getColMap();
    for (int i = 0; i < local.numRows(); ++i)
      for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1); ++k)
        action(global_row(i), static_cast<int>(columns->getGlobalElement(local.graph.entries(k))), local.values(k));
  }
  void solve() {
    solver->factorize();
    solver->solve(*right_hand_side, *solution);
  }
  double error() const {
    DofVector difference(*solution, Teuchos::Copy);
    difference.update(-1.0, *known, 1.0);
    return difference.normInf();
  }
  const DofMatrix& matrix() const { return *all_.matrix(); }

  std::unique_ptr<LinearSolver> solver;
  Teuchos::RCP<DofVector> known, right_hand_side, solution;

 private:
  int global_row(int local) const { return static_cast<int>(model_.map()->getGlobalElement(local)); }
  void fill() {
    for_each_entry([this](int row, int column, double& value) {
      if (kind_ == kSymmetricMumps && row < column) std::swap(row, column);
      value = std::cos(3.0 * row + 7.0 * column) + (row == column ? 30.0 : 0.0);
    });
  }

  Kind kind_;
  const Model model_;
  VertexMatrix all_;
};

// Condition below 10, systems of 60 unknowns.
constexpr double kSolutionError = 1e-13;

// Amesos2 alone returns wrong solutions here without a message (Trilinos 13.2 built with GCC 12).
TEST(MpiLinearSolver, RightSolution) {
  for (Kind kind : kKinds) {
    SCOPED_TRACE(kind);
    Equations equations(all_ranks(), kind);
    equations.solver->factorize();
    EXPECT_LE(equations.solver->solve(*equations.right_hand_side, *equations.solution), 10 * kRounding);
    EXPECT_LE(equations.error(), kSolutionError);
    // the same structure with other values
    equations.for_each_entry([](int row, int column, double& value) { value += row == column ? 5.0 : 0.0; });
    equations.matrix().apply(*equations.known, *equations.right_hand_side);
    equations.solve();
    EXPECT_LE(equations.error(), kSolutionError);
  }
}

TEST(MpiLinearSolver, SingularMatrixIsReportedOnEveryRank) {
  for (Kind kind : kKinds) {
    SCOPED_TRACE(kind);
    Equations equations(all_ranks(), kind);
    equations.scale_rows(7, 8, 0.0);
    EXPECT_THROW(equations.solve(), LinearSolverError);
  }
}

// The factors no longer belong to the matrix: what a solver with an error of its own would return.
TEST(MpiLinearSolver, CorruptedSolutionIsCaughtOnEveryRank) {
  for (Kind kind : kKinds) {
    SCOPED_TRACE(kind);
    Equations equations(all_ranks(), kind);
    equations.solver->factorize();
    equations.scale_rows(12, 18, 50.0);
    EXPECT_THROW(equations.solver->solve(*equations.right_hand_side, *equations.solution), LinearSolverError);
  }
}

TEST(LinearSolver, RecoversAfterASingularMatrix) {
  for (Kind kind : kKinds) {
    SCOPED_TRACE(kind);
    Equations equations(this_rank(), kind);
    equations.solver->factorize();
    std::vector<double> values;
    equations.for_each_entry([&](int, int, double& value) { values.push_back(value); });
    equations.scale_rows(7, 8, 0.0);
    EXPECT_THROW(equations.solve(), LinearSolverError);
    EXPECT_THROW(equations.solver->solve(*equations.right_hand_side, *equations.solution), LinearSolverError);
    size_t k = 0;
    equations.for_each_entry([&](int, int, double& value) { value = values[k++]; });
    equations.solve();
    EXPECT_LE(equations.error(), kSolutionError);
  }
}

TEST(LinearSolver, SlightlyWrongFactorsAreCuredByRefinement) {
  for (Kind kind : kKinds) {
    SCOPED_TRACE(kind);
    Equations equations(this_rank(), kind);
    equations.solver->factorize();
    equations.scale_rows(12, 18, 1.0 + 1e-5);
    equations.matrix().apply(*equations.known, *equations.right_hand_side);
    EXPECT_LE(equations.solver->solve(*equations.right_hand_side, *equations.solution), kTolerance);
    EXPECT_LE(equations.error(), 1e-9);  // two solves with factors that are wrong by 1e-5
  }
}

TEST(LinearSolver, MatrixThatIsNotANumberIsReported) {
  for (Kind kind : kKinds) {
    SCOPED_TRACE(kind);
    Equations equations(this_rank(), kind);
    equations.scale_rows(7, 8, std::numeric_limits<double>::quiet_NaN());
    EXPECT_THROW(equations.solve(), LinearSolverError);
  }
}

// Also where the processor is newer than OpenBLAS.
TEST(Blas, UsesTheVectorsOfTheProcessor) {
  const auto name = reinterpret_cast<const char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  if (name == nullptr || std::getenv("OPENBLAS_CORETYPE") != nullptr) GTEST_SKIP() << "another BLAS, or chosen by hand";
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "a processor without them";
  set_up_blas();
  EXPECT_STRNE(name(), "Prescott");
}

/// Large enough for LAPACK to work in rooms that BLAS hands out: without turns a few calls in a hundred are wrong.
TEST(Blas, CallsFromSeveralThreadsGiveTheSameBits) {
  constexpr int kRows = 300, kThreads = 4, kCalls = 10;
  set_up_blas();
  const auto eigenvalues = [&] {
    std::vector<double> matrix(kRows * kRows), values(kRows), room(3 * kRows);
    for (int i = 0; i < kRows; ++i)
      for (int j = 0; j < kRows; ++j) matrix[i + kRows * j] = std::sin(1.0 + i * j) + (i == j ? 3.0 : 0.0);
    int info = 0;
    const auto turn = turn_for_blas();
    Teuchos::LAPACK<int, double>().SYEV('V', 'L', kRows, matrix.data(), kRows, values.data(), room.data(),
                                        static_cast<int>(room.size()), &info);
    matrix.insert(matrix.end(), values.begin(), values.end());
    return matrix;
  };
  const std::vector<double> alone = eigenvalues();
  std::atomic<int> different{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t)
    threads.emplace_back([&] {
      for (int call = 0; call < kCalls; ++call)
        if (eigenvalues() != alone) ++different;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(different, 0);
}

TEST(LinearSolver, UnknownMethodIsRefused) {
  PhaseTimes times;
  const Model model(fork(1, 1), this_rank(), {});
  EXPECT_THROW(make_direct_solver(whole_matrix(model).matrix(), "no such solver", kTolerance, times),
               LinearSolverError);
}

void expect_backward_error(const Communicator& comm) {
  Equations equations(comm);
  DofVector x(*equations.known, Teuchos::Copy);
  EXPECT_LE(backward_error(equations.matrix(), x, *equations.right_hand_side), 10 * kRounding);
  x.scale(1.0 + 1e-6);
  const double small = backward_error(equations.matrix(), x, *equations.right_hand_side);
  EXPECT_GT(small, 1e-8);
  EXPECT_LT(small, 1e-6);
  x.putScalar(0.0);
  EXPECT_EQ(backward_error(equations.matrix(), x, *equations.right_hand_side), 1.0);  // |b| / |b|
  if (comm->getRank() == 0) MixedVector::view_of(x)(0) = std::nan("");
  EXPECT_FALSE(std::isfinite(backward_error(equations.matrix(), x, *equations.right_hand_side)));
}
TEST(LinearSolver, BackwardError) { expect_backward_error(this_rank()); }
TEST(MpiLinearSolver, BackwardError) { expect_backward_error(all_ranks()); }

// Rows in other units are divided by their own size.
TEST(LinearSolver, BackwardErrorIsBlindToUnitsOfRows) {
  Equations equations(this_rank());
  DofVector x(*equations.known, Teuchos::Copy);
  x.scale(1.0 + 1e-6);
  const double before = backward_error(equations.matrix(), x, *equations.right_hand_side);
  equations.scale_rows(0, 30, 0x1p60);
  const auto b = MixedVector::view_of(*equations.right_hand_side);
  for (int i = 0; i < 30; ++i) b(i) *= 0x1p60;
  EXPECT_EQ(backward_error(equations.matrix(), x, *equations.right_hand_side), before);
}

/// H D H with the eigenvalues 1, -2, 3, ..., so many of them negative, reflected at a plane: a full matrix.
SparseMatrix reflected(int rows, int negative) {
  std::vector<double> normal(rows), eigenvalue(rows);
  double square = 0.0;
  for (int i = 0; i < rows; ++i) {
    normal[i] = 1.0 + i % 3;
    eigenvalue[i] = (i < negative ? -1.0 : 1.0) * (1.0 + i);
    square += normal[i] * normal[i];
  }
  const auto reflection = [&](int i, int j) { return (i == j ? 1.0 : 0.0) - 2.0 * normal[i] * normal[j] / square; };
  SparseMatrix matrix{{0}, {}, {}};
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < rows; ++j) {
      double sum = 0.0;
      for (int k = 0; k < rows; ++k) sum += reflection(i, k) * eigenvalue[k] * reflection(k, j);
      matrix.column.push_back(j);
      matrix.value.push_back(sum);
    }
    matrix.row_start.push_back(static_cast<int>(matrix.column.size()));
  }
  return matrix;
}

/// Up to 60 rows by LAPACK, above by MUMPS.
TEST(InertiaSolver, MatricesOfAnySizeHaveTheSignsThatTheyWereMadeWith) {
  for (int rows : {1, 2, 7, 60, 61})
    for (int negative : {0, 1, rows / 2}) {
      const SparseMatrix matrix = reflected(rows, negative);
      InertiaSolver solver(InertiaSolver::Kind::symmetric, matrix);
      const InertiaSolver::Signs signs = solver.factorize(matrix);
      EXPECT_EQ(signs.negative, negative) << rows;
      EXPECT_EQ(signs.determinant_sign, negative % 2 == 0 ? 1 : -1);
      EXPECT_EQ(signs.null, 0);
      std::vector<double> x(rows, 1.0), b(rows);
      solver.solve(x.data(), 1);
      matrix.multiply(x.data(), b.data());
      for (double one : b) EXPECT_NEAR(one, 1.0, 1e-11) << rows;
      if (negative < rows) {  // another matrix is told apart
        EXPECT_EQ(solver.factorize(reflected(rows, negative + 1)).negative, negative + 1);
        EXPECT_EQ(solver.factorizations(), 2);
      }
      solver.factorize(matrix);
      solver.drop_matrix();  // the factors are enough
      std::vector<double> again(rows, 1.0);
      solver.solve(again.data(), 1);
      EXPECT_EQ(again, x) << rows;
    }
}

TEST(InertiaSolver, PivotsOfTwoRowsAndNullOnesAreCounted) {
  const SparseMatrix exchange{{0, 1, 2, 3, 4}, {1, 0, 3, 2}, {1.0, 1.0, 2.0, 2.0}};  // 1, -1, 2, -2
  InertiaSolver solver(InertiaSolver::Kind::symmetric, exchange);
  EXPECT_EQ(solver.factorize(exchange).negative, 2);
  std::vector<double> x = {1.0, 2.0, 3.0, 4.0};
  solver.solve(x.data(), 1);
  EXPECT_EQ(x, (std::vector<double>{2.0, 1.0, 2.0, 1.5}));
  SparseMatrix singular = exchange;
  singular.value[2] = singular.value[3] = 0.0;
  const InertiaSolver::Signs signs = solver.factorize(singular);
  EXPECT_EQ(signs.negative, 1);
  EXPECT_EQ(signs.null, 2);
  EXPECT_EQ(signs.determinant_sign, 0);
  x = {1.0, 2.0, 3.0, 4.0};
  solver.solve(x.data(), 1);
  EXPECT_NEAR(x[0], 2.0, 1e-15);
  for (double one : x) EXPECT_TRUE(std::isfinite(one));
}

}  // namespace
}  // namespace mixbeam::test
