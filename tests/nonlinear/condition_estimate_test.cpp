// The estimate against the exact number, which takes a solve for every unknown; units of length and force, supports
// included, do not matter.
#include "nonlinear/linear/condition_estimate.hpp"

#include "discretization/assembly/assembler.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "tests/problems/solve.hpp"
#include "tests/scene_units.hpp"

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
std::unique_ptr<Assembler> bent(const Scene& scene, const Communicator& comm) {
  auto assembler = std::make_unique<Assembler>(scene, comm, AssemblerOptions{});
  MixedVector increment = assembler->create_vector(), residual = assembler->create_vector();
  const auto rows = increment.vertex();
  for (size_t i = 0; i < rows.extent(0); ++i) {
    const auto dof = assembler->map()->getGlobalElement(static_cast<LocalOrdinal>(i));
    rows(i) = dof % kVertexDofs < 3 ? 0.0 : 0.3 * std::sin(1.0 + static_cast<double>(dof));
  }
  const State state = assembler->apply(assembler->reference_state(), increment, 1.0);
  assembler->residual(state, 1.0, residual);
  assembler->tangent(state, 1.0);
  return assembler;
}

/// sum over columns j of |C^-1 A^-1|_ij times the sum of magnitudes in row j of A C, its largest entry.
double exact_condition(Assembler& assembler, double length) {
  const Teuchos::RCP<DofMatrix>& matrix = assembler.matrix();
  const Communicator comm = matrix->getRowMap()->getComm();
  const auto solver = make_direct_solver(matrix, kMethod, kUsable, assembler.times());
  solver->factorize();
  DofVector unit(assembler.map()), column(assembler.map()), sum(assembler.map());
  const auto local = matrix->getLocalMatrixHost();
  const auto scale = [length](GlobalOrdinal dof) { return dof % kVertexDofs < 3 ? length : 1.0; };
  for (size_t j = 0; j < unit.getGlobalLength(); ++j) {
    const auto row = assembler.map()->getLocalElement(static_cast<GlobalOrdinal>(j));
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
      s(i) += size_everywhere * std::abs(x(i)) / scale(assembler.map()->getGlobalElement(static_cast<LocalOrdinal>(i)));
  }
  return sum.normInf();
}

void expect_bounds(const Scene& scene, const Communicator& comm) {
  const auto assembler = bent(scene, comm);
  const double length = assembler->structure().length;
  const double exact = exact_condition(*assembler, length);
  const double estimate = condition_estimate(assembler->matrix(), kMethod, length);
  EXPECT_LE(estimate, exact * (1.0 + kDigitsLeft)) << scene.name;
  EXPECT_GE(estimate, exact / kUnderestimate) << scene.name;
  // twin: another length is another number, so that the bounds are those of this one
  const double other = condition_estimate(assembler->matrix(), kMethod, 1e3 * length);
  EXPECT_FALSE(other <= exact * (1.0 + kDigitsLeft) && other >= exact / kUnderestimate);
}

TEST(ConditionEstimate, IsALowerBoundWithinAFactor) {
  expect_bounds(fork(2, 2), this_rank());
  expect_bounds(slope_discontinuity(3, 2), this_rank());
}
TEST(MpiConditionEstimate, IsALowerBoundWithinAFactor) { expect_bounds(fork(2, 2), all_ranks()); }

double condition_of(const Scene& scene) {
  const auto assembler = bent(scene, this_rank());
  return condition_estimate(assembler->matrix(), kMethod, assembler->structure().length);
}

TEST(ConditionEstimate, DoesNotSeeUnits) {
  const Scene scene = slope_discontinuity(2, 3);
  const double one = condition_of(scene);
  for (double length : {1e-6, 1e6})
    for (double force : {1e-9, 1e9})
      EXPECT_NEAR(condition_of(in_other_units(scene, length, force)), one, kDigitsLeft * one) << length << " " << force;
  // twin: without the length of the scene the unit is seen
  const auto assembler = bent(in_other_units(scene, 1e6, 1.0), this_rank());
  EXPECT_GT(std::abs(condition_estimate(assembler->matrix(), kMethod, 1.0) - one), one);
}

TEST(ConditionEstimate, SingularMatrixHasNone) {
  const auto assembler = bent(fork(1, 1), this_rank());
  const auto local = assembler->matrix()->getLocalMatrixHost();
  for (size_t k = local.graph.row_map(7); k < local.graph.row_map(8); ++k) local.values(k) = 0.0;
  EXPECT_TRUE(std::isinf(condition_estimate(assembler->matrix(), kMethod, 1.0)));
}

}  // namespace
}  // namespace mixbeam::test
