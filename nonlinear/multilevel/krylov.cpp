#include "nonlinear/multilevel/krylov.hpp"

#include <BelosMinresIter.hpp>
#include <BelosPseudoBlockGmresSolMgr.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace mixbeam::multilevel {

namespace {

/// GMRES keeps so many vectors, each with what M^-1 makes of it, and then starts anew: 1 GB for a million unknowns.
constexpr int kVectorsOfGmres = 60;

/// Vectors v side by side, each with z = M^-1 v: all sums are done to both, and v . z' is the inner product in which
/// A M^-1 is self-adjoint where A is symmetric. Copies share their numbers.
struct Column {
  const Level* level;
  LevelVector v, z;
};
using Columns = std::vector<Column>;

/// A M^-1
struct PreconditionedMatrix {
  const LinearMap &matrix, &preconditioner;
};

Column column_like(const Column& other) {
  return {other.level, numbers(other.v.extent(0)), numbers(other.v.extent(0))};
}

double product(const Column& x, const Column& y) { return x.level->dot(x.v, y.z); }

/// to = a x + b y; `to` may be one of them.
void combine(double a, const LevelVector& x, double b, const LevelVector& y, const LevelVector& to) {
  double* sum = to.data();
  const double *first = x.data(), *second = y.data();
  for_each(to.extent(0), [=](int i) { sum[i] = a * first[i] + b * second[i]; });
}

void combine(double a, const Column& x, double b, const Column& y, const Column& to) {
  combine(a, x.v, b, y.v, to.v);
  combine(a, x.z, b, y.z, to.z);
}

/// to = a x
void scale(double a, const Column& x, const Column& to) { combine(a, x, 0.0, x, to); }

}  // namespace

}  // namespace mixbeam::multilevel

namespace Belos {

/// What Belos asks of vectors.
template <>
class MultiVecTraits<double, mixbeam::multilevel::Columns> {
  using Columns = mixbeam::multilevel::Columns;
  using Small = Teuchos::SerialDenseMatrix<int, double>;

 public:
  static Teuchos::RCP<Columns> Clone(const Columns& like, int count) {
    auto made = Teuchos::rcp(new Columns);
    for (int k = 0; k < count; ++k) made->push_back(column_like(like[0]));
    return made;
  }
  static Teuchos::RCP<Columns> CloneCopy(const Columns& from) {
    const Teuchos::RCP<Columns> made = Clone(from, GetNumberVecs(from));
    Assign(from, *made);
    return made;
  }
  static Teuchos::RCP<Columns> CloneCopy(const Columns& from, const std::vector<int>& index) {
    return CloneCopy(*CloneView(from, index));
  }
  static Teuchos::RCP<Columns> CloneViewNonConst(Columns& of, const std::vector<int>& index) {
    auto made = Teuchos::rcp(new Columns);
    for (int k : index) made->push_back(of[k]);
    return made;
  }
  static Teuchos::RCP<const Columns> CloneView(const Columns& of, const std::vector<int>& index) {
    return CloneViewNonConst(const_cast<Columns&>(of), index);
  }
  static ptrdiff_t GetGlobalLength(const Columns& of) { return static_cast<ptrdiff_t>(of[0].v.extent(0)); }
  static int GetNumberVecs(const Columns& of) { return static_cast<int>(of.size()); }

  static void MvTimesMatAddMv(double a, const Columns& from, const Small& factors, double b, Columns& to) {
    for (size_t k = 0; k < to.size(); ++k)
      for (size_t i = 0; i < from.size(); ++i) {
        const bool begins = i == 0 && b == 0.0;  // then `to` may have no values yet
        combine(a * factors(i, k), from[i], begins ? 0.0 : (i == 0 ? b : 1.0), begins ? from[i] : to[k], to[k]);
      }
  }
  static void MvAddMv(double a, const Columns& x, double b, const Columns& y, Columns& to) {
    for (size_t k = 0; k < to.size(); ++k) combine(a, x[k], b, y[k], to[k]);
  }
  static void MvScale(Columns& x, double a) {
    for (const auto& column : x) scale(a, column, column);
  }
  static void MvScale(Columns& x, const std::vector<double>& a) {
    for (size_t k = 0; k < x.size(); ++k) scale(a[k], x[k], x[k]);
  }
  static void MvTransMv(double a, const Columns& x, const Columns& y, Small& products) {
    for (size_t i = 0; i < x.size(); ++i)
      for (size_t k = 0; k < y.size(); ++k) products(i, k) = a * product(x[i], y[k]);
  }
  static void MvDot(const Columns& x, const Columns& y, std::vector<double>& products) {
    for (size_t k = 0; k < x.size(); ++k) products[k] = product(x[k], y[k]);
  }
  static void MvNorm(const Columns& x, std::vector<double>& norms, NormType = TwoNorm) {
    MvDot(x, x, norms);
    for (size_t k = 0; k < x.size(); ++k) norms[k] = std::sqrt(std::max(norms[k], 0.0));
  }
  static void SetBlock(const Columns& from, const std::vector<int>& index, Columns& to) {
    for (size_t k = 0; k < index.size(); ++k) scale(1.0, from[k], to[index[k]]);
  }
  static void Assign(const Columns& from, Columns& to) {
    for (size_t k = 0; k < from.size(); ++k) scale(1.0, from[k], to[k]);
  }
  static void MvRandom(Columns&) { throw std::logic_error("Krylov methods of networks draw no random vectors"); }
  static void MvInit(Columns& x, double value = 0.0) {
    for (const auto& column : x) {
      Kokkos::deep_copy(column.v, value);
      Kokkos::deep_copy(column.z, value);
    }
  }
  static void MvPrint(const Columns&, std::ostream&) {}
};

template <>
class OperatorTraits<double, mixbeam::multilevel::Columns, mixbeam::multilevel::PreconditionedMatrix> {
  using Columns = mixbeam::multilevel::Columns;
  using Map = mixbeam::multilevel::PreconditionedMatrix;

 public:
  static void Apply(const Map& map, const Columns& x, Columns& y, ETrans = NOTRANS) {
    for (size_t k = 0; k < x.size(); ++k) {
      map.matrix(x[k].z, y[k].v);
      map.preconditioner(y[k].v, y[k].z);
    }
  }
  static bool HasApplyTranspose(const Map&) { return false; }
};

}  // namespace Belos

namespace mixbeam::multilevel {

namespace {

using Problem = Belos::LinearProblem<double, Columns, PreconditionedMatrix>;

/// By Belos' iteration without its manager, which goes on until a residual computed anew is as small: in vain where the
/// matrix is so near to singular that rounding does not allow it.
KrylovResult minres(const Teuchos::RCP<Problem>& problem, double reduction, int most_iterations) {
  using Test = Belos::StatusTest<double, Columns, PreconditionedMatrix>;
  using Combination = Belos::StatusTestCombo<double, Columns, PreconditionedMatrix>;
  using Residual = Belos::StatusTestGenResNorm<double, Columns, PreconditionedMatrix>;
  const auto small = Teuchos::rcp(new Residual(reduction));
  small->defineResForm(Residual::Implicit, Belos::TwoNorm);
  small->defineScaleForm(Belos::NormOfInitRes, Belos::TwoNorm);
  const auto ends = Teuchos::rcp(new Combination(
      Combination::OR,
      Teuchos::rcp<Test>(new Belos::StatusTestMaxIters<double, Columns, PreconditionedMatrix>(most_iterations)),
      small));
  problem->setLSIndex({0});
  Teuchos::ParameterList none;
  Belos::MinresIter<double, Columns, PreconditionedMatrix> iteration(
      problem, Teuchos::rcp(new Belos::OutputManager<double>), ends, none);
  Belos::MinresIterationState<double, Columns> start;
  start.Y = problem->getInitResVec();
  iteration.initializeMinres(start);
  iteration.iterate();
  problem->setCurrLS();
  return {small->getStatus() == Belos::Passed, iteration.getNumIters()};
}

KrylovResult gmres(const Teuchos::RCP<Problem>& problem, double reduction, int most_iterations) {
  const Teuchos::RCP<Teuchos::ParameterList> list = Teuchos::parameterList();
  list->set("Convergence Tolerance", reduction);
  list->set("Maximum Iterations", most_iterations);
  list->set("Num Blocks", kVectorsOfGmres);
  list->set("Maximum Restarts", most_iterations / kVectorsOfGmres);
  list->set("Orthogonalization", "DGKS");
  list->set("Output Stream", Teuchos::rcp<std::ostream>(new Teuchos::oblackholestream));
  Belos::PseudoBlockGmresSolMgr<double, Columns, PreconditionedMatrix> manager(problem, list);
  const bool converged = manager.solve() == Belos::Converged;
  return {converged || manager.isLOADetected(), manager.getNumIters()};  // as far as rounding allows
}

}  // namespace

KrylovResult solve(KrylovMethod method, const Level& level, const LinearMap& matrix, const LinearMap& preconditioner,
                   const LevelVector& b, const LevelVector& x, double reduction, int most_iterations) {
  using Traits = Belos::MultiVecTraits<double, Columns>;
  const auto given = Teuchos::rcp(new Columns{{&level, b, numbers(b.extent(0))}});
  preconditioner(b, given->front().z);
  Kokkos::deep_copy(x, 0.0);
  if (product(given->front(), given->front()) == 0.0) return {true, 0};
  const Teuchos::RCP<Columns> found = Traits::Clone(*given, 1);
  Traits::MvInit(*found);
  const auto problem =
      Teuchos::rcp(new Problem(Teuchos::rcp(new PreconditionedMatrix{matrix, preconditioner}), found, given));
  problem->setInitResVec(given);
  problem->setProblem();
  KrylovResult result;
  try {
    result = (method == KrylovMethod::minres ? minres : gmres)(problem, reduction, most_iterations);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // a vector that is not a number, or rounding at the end of what can be reached
  }
  Kokkos::deep_copy(x, found->front().z);
  return result;
}

}  // namespace mixbeam::multilevel
