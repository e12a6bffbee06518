// The estimate against the exact number, which takes a solve for every unknown; units of length and force, supports
// included, do not matter.
#include "nonlinear/linear/condition_estimate.hpp"

#include "discretization/assembly/tangent.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "tests/support/scene_units.hpp"
#include "tests/support/solve.hpp"

#include <Teuchos_CommHelpers.hpp>

namespace mixbeam::test {
namespace {

constexpr const char* kMethod = "KLU2";
constexpr double kUsable = 1e-8;

/// Matrices with condition numbers to 1e8 lose as many digits in the solves behind both numbers.
constexpr double kDigitsLeft = 1e-6;

/// Higham found the estimate within a factor of 3 of the exact number in nearly all of his experiments.
constexpr double kUnderestimate = 3.0;

/// The assembled tangent of a bent state: every vertex coupled, rows of supports.
class BentState {
 public:
  BentState(const Scene& scene, const Communicator& comm)
      : model_(scene, comm, {}), all_(whole_matrix(model_)), matrix(all_.matrix()), length(model_.structure().length) {
    bend();
  }

 private:
  void bend();

  const Model model_;
  VertexMatrix all_;

 public:
  Teuchos::RCP<DofMatrix> matrix;
  double length;
};

void BentState::bend() {
  MixedVector increment = model_.create_vector(), residual = model_.create_vector();
  const auto rows = increment.vertex();
  for (size_t i = 0; i < rows.extent(0); ++i) {
    const auto dof = model_.map()->getGlobalElement(static_cast<LocalOrdinal>(i));
    rows(i) = dof % kVertexDofs < 3 ? 0.0 : 0.3 * std::sin(1.0 + static_cast<double>(dof));
  }
  const State state = model_.apply(model_.reference_state(), increment, 1.0);
  const EvaluationPoint point = mixed_residual(model_, state, 1.0, residual);
  Tangent(model_, point, cap_for(model_, point.scales), {true}).gather(all_);
}

/// sum over columns j of |C^-1 A^-1|_ij times the sum of magnitudes in row j of A C, its largest entry.
double exact_condition(const Teuchos::RCP<DofMatrix>& matrix, double length) {
  PhaseTimes times;
  const Teuchos::RCP<const DofMap> map = matrix->getRowMap();
  const Communicator comm = matrix->getRowMap()->getComm();
  const auto solver = make_direct_solver(matrix, kMethod, kUsable, times);
  solver->factorize();
  DofVector unit(map), column(map), sum(map);
  const auto local = matrix->getLocalMatrixHost();
  const auto scale = [length](GlobalOrdinal dof) { return dof % kVertexDofs < 3 ? length : 1.0; };
  for (size_t j = 0; j < unit.getGlobalLength(); ++j) {
    const auto row = map->getLocalElement(static_cast<GlobalOrdinal>(j));
    const bool mine = row != Teuchos::OrdinalTraits<LocalOrdinal>::invalid();
    double size = 0.0, size_everywhere = 0.0;
    if (mine)
      for (size_t k = local.graph.row_map(row); k < local.graph.row_map(row + 1); ++k)
        size += std::abs(local.values(k)) * scale(matrix->getColMap()->getGlobalElement(local.graph.entries(k)));
    Teuchos::reduceAll(*comm, Teuchos::REDUCE_MAX, 1, &size, &size_everywhere);
    unit.putScalar(0.0);
    if (mine) MixedVector::view_of(unit)(row) = 1.0;
    solver->solve(unit, column);
    const auto x = MixedVector::view_of(column), s = MixedVector::view_of(sum);
    for (size_t i = 0; i < x.extent(0); ++i)
      s(i) += size_everywhere * std::abs(x(i)) / scale(map->getGlobalElement(static_cast<LocalOrdinal>(i)));
  }
  return sum.normInf();
}

TEST(MpiConditionEstimate, IsALowerBoundWithinAFactor) {
  for (const Scene& scene : {fork(2, 2), slope_discontinuity(3, 2)}) {
    const BentState bent(scene, all_ranks());
    const double length = bent.length, exact = exact_condition(bent.matrix, length);
    const double estimate = condition_estimate(bent.matrix, kMethod, length);
    EXPECT_LE(estimate, exact * (1.0 + kDigitsLeft)) << scene.name;
    EXPECT_GE(estimate, exact / kUnderestimate) << scene.name;
    // twin: another length is another number, so that the bounds are those of this one
    const double other = condition_estimate(bent.matrix, kMethod, 1e3 * length);
    EXPECT_FALSE(other <= exact * (1.0 + kDigitsLeft) && other >= exact / kUnderestimate);
  }
}

double condition_of(const Scene& scene) {
  const BentState bent(scene, this_rank());
  return condition_estimate(bent.matrix, kMethod, bent.length);
}

TEST(ConditionEstimate, DoesNotSeeUnits) {
  const Scene scene = slope_discontinuity(2, 3);
  const double one = condition_of(scene);
  for (double length : {1e-6, 1e6})
    for (double force : {1e-9, 1e9})
      EXPECT_NEAR(condition_of(in_other_units(scene, length, force)), one, kDigitsLeft * one) << length << " " << force;
  // twin: without the length of the scene the unit is seen
  const BentState bent(in_other_units(scene, 1e6, 1.0), this_rank());
  EXPECT_GT(std::abs(condition_estimate(bent.matrix, kMethod, 1.0) - one), one);
}

TEST(ConditionEstimate, SingularMatrixHasNone) {
  const BentState bent(fork(1, 1), this_rank());
  const auto local = bent.matrix->getLocalMatrixHost();
  for (size_t k = local.graph.row_map(7); k < local.graph.row_map(8); ++k) local.values(k) = 0.0;
  EXPECT_TRUE(std::isinf(condition_estimate(bent.matrix, kMethod, 1.0)));
}

}  // namespace
}  // namespace mixbeam::test
