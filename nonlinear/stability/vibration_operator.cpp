#include "nonlinear/stability/vibration_operator.hpp"

#include "nonlinear/linear/krylov.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/stability/block_krylov.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

/// Share of the cap's effect that may be left in a solution, and limit of solves for that, usually one or two.
/// It affects omega^2 by its square, times the ratio of the largest omega^2 to the lowest; if unsymmetric, to first
/// order.
constexpr double kCapLeft = 1e-6, kCapLeftWithoutSymmetry = 1e-12;
constexpr int kMostCapSolves = 12;
/// Reduction by a correction, usually 1e-6, above which GMRES is faster.
constexpr double kFastCorrection = 1e-3;
/// Residual of a solve above which it is refined, over the sum of |terms| of a row.
constexpr double kRefined = 1e-14;

}  // namespace

VibrationOperator::VibrationOperator(const Model& model, const State& state, double load_factor, bool in_plane)
    : model_(model),
      state_(state),
      residual_(model_.create_vector()),
      point_(mixed_residual(model_, state, load_factor, residual_)),
      masses_(model_, in_plane),
      system_(model_, masses_.body_vertices()),
      unknowns_(model_, system_.remaining()),
      remaining_(system_.matrix()->getRowMap()) {}

void VibrationOperator::Response::add(double factor, const Response& other) {
  motion.update(factor, other.motion, 1.0);
  add_multiple(factor, other.y, y);
}

void VibrationOperator::linearize(double shift, double raise, VibrationUse use) {
  tangent_.reset();
  corrects_slowly_ = false;
  tangent_.emplace(model_, point_, cap_for(model_, point_.scales, raise), TangentKind{true, false});
  masses_.condense(*tangent_, shift, use);
}

long VibrationOperator::factorize(double shift, double raise, VibrationUse use) {
  const bool counts = use == VibrationUse::counted;
  linearize(shift, raise, use);
  const bool reliable = system_.condense(*tangent_, masses_.condensed(),
                                         [&](const MatrixRows& rows) { masses_.add_bodies(*tangent_, shift, rows); });
  const Teuchos::Comm<int>& comm = *model_.map()->getComm();
  if (maximum_over_ranks(comm, reliable ? 0.0 : 1.0) != 0.0) {
    if (counts) return -1;
    throw LinearSolverError("the equations of vibration have a chain without stiffness");
  }
  unknowns_.reduce(*tangent_);
  constexpr double kNotSymmetric = -1.0;
  const double negative = number_of_root(unknowns_.root(), [&] {
    const SparseMatrix& matrix = unknowns_.matrix();
    if (matrix.rows() == 0) return system_.is_unsymmetric() ? kNotSymmetric : 0.0;
    const bool symmetric = !system_.is_unsymmetric() && asymmetry(matrix) <= stability_limit.symmetric;
    std::unique_ptr<InertiaSolver>& solver = symmetric ? of_symmetric_ : of_general_;
    const auto kind = symmetric ? InertiaSolver::Kind::symmetric : InertiaSolver::Kind::general;
    if (solver == nullptr) solver = std::make_unique<InertiaSolver>(kind, matrix);
    const InertiaSolver::Signs signs = solver->factorize(matrix);
    return symmetric ? static_cast<double>(signs.negative) : kNotSymmetric;
  });
  symmetric_ = negative != kNotSymmetric;
  if (!symmetric_) return -1;
  const long of_chains = system_.negative_pivots();
  long below = 0;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, 1, &of_chains, &below);
  below += static_cast<long>(negative);
  if (!counts) return below;
  const Tangent::InteriorCount interior = masses_.interior_count();
  return interior.uncertain ? -1 : below + interior.negative;
}

SparseMatrix VibrationOperator::outside() {
  Kokkos::deep_copy(masses_.condensed(), 0.0);
  system_.gather_outside(*tangent_, masses_.condensed());
  return unknowns_.reduce(*tangent_);
}

std::vector<double> VibrationOperator::forms(const VibrationOperator& of, const std::vector<Response>& motions,
                                             double square) {
  unknowns_.measure_as(of.unknowns_);
  linearize(0.0, 1.0, VibrationUse::matrices);
  const SparseMatrix more = outside();
  const KernelView<int*> vertices = system_.remaining().vertices();
  const KernelView<const double*> free = MixedVector::view_of(remaining_);
  std::vector<double> found;
  for (const Response& one : motions) {
    MixedVector motion = one.motion.clone(true);
    unknowns_.expand(one.y.data(), remaining_);
    for (size_t i = 0; i < free.extent(0); ++i)
      motion.vertex()(vertex_row(vertices(i / kVertexDofs), i % kVertexDofs)) = free(i);
    std::vector<double> force(one.y.size());
    more.multiply(one.y.data(), force.data());
    const std::vector<double> momenta = momenta_of(motion);
    found.push_back(masses_.stiffness_form(motion) + dot_product(one.y, force) -
                    square * dot_product(momenta, momenta));
  }
  return found;
}

/// Solves with the capped stiffness for rows gathered by condense_momenta() or condense_interior().
VibrationOperator::Response VibrationOperator::solve(MixedVector& rows) {
  Response response{model_.create_vector()};
  response.y = condense(rows, response.motion.vertex_dofs());
  on_root(unknowns_.root(), [&] { solve_reduced(response.y, 1); });
  expand(response.y.data(), response.motion.vertex_dofs());
  masses_.recover(rows, response.motion);
  return response;
}

/// Condenses rows of the vertices to those of the unknowns (rank 0); `motion` holds intermediate values for expand().
std::vector<double> VibrationOperator::condense(MixedVector& rows, DofVector& motion) {
  tangent_->project_on_free_motions(rows.vertex());
  system_.condense_rows(rows.vertex_dofs(), remaining_, motion);
  return unknowns_.reduced_remaining_rows(remaining_);
}

void VibrationOperator::expand(const double* y, DofVector& motion) {
  unknowns_.expand(y, remaining_);
  system_.expand(remaining_, motion);
}

/// Replaces columns of momenta by those of the motions that they cause.
void VibrationOperator::solve(MomentumColumns& of) {
  std::vector<MixedVector> rows, motions;
  for (int j = 0; j < of.columns; ++j) {
    rows.push_back(model_.create_vector());
    motions.push_back(model_.create_vector());
  }
  masses_.condense_columns(state_, of, rows);
  std::vector<double> y;
  for (int j = 0; j < of.columns; ++j) {
    const std::vector<double> own = condense(rows[j], motions[j].vertex_dofs());
    y.insert(y.end(), own.begin(), own.end());
  }
  on_root(unknowns_.root(), [&] { solve_reduced(y, of.columns); });
  for (int j = 0; j < of.columns; ++j) expand(y.data() + y.size() / of.columns * j, motions[j].vertex_dofs());
  masses_.recover_columns(state_, of, motions);
}

void VibrationOperator::apply(double* momenta, int columns) {
  const size_t count = masses_.momenta();
  const bool corrects = tangent_->cap().cuts_off;
  const std::vector<double> given(momenta, momenta + (corrects ? count * columns : 0));
  if (!corrects_slowly_) {
    MomentumColumns of = masses_.columns_of(momenta, columns, corrects);
    solve(of);
    if (corrects) corrects_slowly_ = !correct(of);
  }
  if (!corrects_slowly_) return;
  for (int j = 0; j < columns; ++j) {
    const std::vector<double> image = momenta_of(respond(&given[count * j]).motion);
    std::copy(image.begin(), image.end(), momenta + count * j);
  }
}

/// Corrects solved columns for the cap; false if corrections converge slowly.
bool VibrationOperator::correct(MomentumColumns& of) {
  std::vector<double> left = masses_.excess_norms(of), allowed = left;
  for (double& norm : allowed) norm *= cap_left();
  std::vector<double>& more = correction_;
  more.assign(of.momenta_of_column * of.columns, 0.0);  // not all of it is written if orders differ
  double* const sum = std::exchange(of.momenta, more.data());
  of.forces = nullptr;
  const auto is_left = [&](int j) { return left[j] > allowed[j]; };
  const auto any_is_left = [&] {
    bool any = false;
    for (int j = 0; j < of.columns; ++j) any = any || (is_left(j) && std::isfinite(left[j]));
    return any;
  };
  while (any_is_left()) {
    solve(of);
    const std::vector<double> now = masses_.excess_norms(of);
    for (int j = 0; j < of.columns; ++j)
      if (is_left(j) && !(now[j] <= kFastCorrection * left[j])) return false;
    for (size_t i = 0; i < more.size(); ++i) sum[i] += more[i];
    left = now;
  }
  return true;
}

void VibrationOperator::solve_reduced(std::vector<double>& y, int columns) {
  if (y.empty()) return;
  solve_refined(symmetric_ ? *of_symmetric_ : *of_general_, unknowns_.matrix(), y, columns, false, kRefined,
                "equations of vibration");
}

/// Share of the cap's effect that may be left in a solution.
double VibrationOperator::cap_left() const {
  return symmetric_ && !has_forces_of_velocity() ? kCapLeft : kCapLeftWithoutSymmetry;
}

VibrationOperator::Response VibrationOperator::respond(const double* momenta, const double* strains) {
  MixedVector rows = model_.create_vector();
  masses_.condense_momenta(state_, momenta, rows, strains);
  Response found = solve(rows);
  if (!tangent_->cap().cuts_off) return found;
  MixedVector excess = found.motion.clone(false);
  masses_.excess_rows(found.motion, excess);
  const double first = norm_of(excess);
  if (!(first > 0.0) || !std::isfinite(first)) return found;
  const double allowed = cap_left() * first;
  double left = first;
  while (!corrects_slowly_ && left > allowed) {
    Response more = solve_interior(excess);
    MixedVector next = excess.clone(false);
    masses_.excess_rows(more.motion, next);
    const double now = norm_of(next);
    corrects_slowly_ = !(now <= kFastCorrection * left);
    if (corrects_slowly_) break;
    found.add(1.0, more);
    excess = std::move(next);
    left = now;
  }
  if (corrects_slowly_) correct_by_gmres(std::move(excess), left, allowed / left, found);
  return found;
}

VibrationOperator::Response VibrationOperator::solve_interior(const MixedVector& rows) {
  MixedVector given = rows.clone(true);
  masses_.condense_interior(given);
  return solve(given);
}

/// Corrects a response by GMRES, if forces are distributed by stiffness.
void VibrationOperator::correct_by_gmres(MixedVector excess, double norm, double reduction, Response& found) {
  std::vector<MixedVector> basis;
  std::vector<Response> responses;
  basis.push_back(std::move(excess));
  const GmresResult left_out =
      gmres(basis, norm, reduction, kMostCapSolves, [&](const MixedVector& of, MixedVector& next) {
        responses.push_back(solve_interior(of));
        masses_.excess_rows(responses.back().motion, next);
        next.update(1.0, of, -1.0);
        return true;
      });
  for (size_t k = 0; k < left_out.y.size(); ++k) found.add(left_out.y[k], responses[k]);
}

}  // namespace mixbeam
