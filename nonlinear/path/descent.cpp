#include "nonlinear/path/descent.hpp"

#include "discretization/state/potential.hpp"
#include "discretization/state/sampling.hpp"
#include "nonlinear/linear/chain_solver.hpp"
#include "nonlinear/path/branch.hpp"
#include "nonlinear/path/thresholds.hpp"
#include "nonlinear/stability/independent_unknowns.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Number of inverse iterations towards the lowest mode: any direction of negative curvature is sufficient.
constexpr int kInverseIterations = 8;
/// Count returned if the tangent could not be factorised, so that springs are stiffened.
constexpr long kSingular = 1;

}  // namespace

/// K + shift S and its factors, S the matrix to which eigenvalues refer (units of IndependentUnknowns).
class Descent::ShiftedTangent {
 public:
  ShiftedTangent(BeamProblem& problem, double residual_tolerance)
      : problem_(problem),
        solver_(make_direct_tangent_solver(problem.model, kMumps, residual_tolerance)),
        unit_(problem.model.create_vector()) {
    const Structure& structure = problem.model.structure();
    const std::vector<double> length = vertex_lengths(structure);
    const double L = structure.length;
    unit_.fill(0.0);
    const KernelView<double*> unit = unit_.vertex();
    for (size_t i = 0; i < unit.extent(0); ++i) {
      unit(i) = structure.bending_reference * length[i / kVertexDofs] / (L * L * (i % kVertexDofs < 3 ? L * L : 1.0));
    }
    springs_ = KernelView<double*>("mixbeam::descent::springs", unit.extent(0));
  }

  /// Diagonal of S.
  const MixedVector& unit_springs() const { return unit_; }
  Tangent& tangent() { return *tangent_; }

  /// Factorises; returns the number of negative eigenvalues. Throws LinearSolverError.
  long factorize(const EvaluationPoint& point, double shift) {
    const KernelView<const double*> unit = unit_.vertex();
    for (size_t i = 0; i < unit.extent(0); ++i) springs_(i) = shift * unit(i);
    tangent_.reset();  // so that its arrays are reused
    tangent_.emplace(problem_.model, point, cap_for(problem_.model, point.scales, stability_limit.cap_of_count),
                     TangentKind{true, true, springs_});
    solver_->factorize(*tangent_);
    const std::optional<long> negative = solver_->negative_eigenvalues();
    return tangent_->interior_count().negative + (negative ? *negative : negative_of_reduced());
  }

  void solve(const DofVector& b, DofVector& x) { solver_->solve(b, x); }
  /// Computes Newton's increment for the condensed rows; NaN if the solve fails.
  void solve_and_recover(MixedVector& increment) {
    DofVector& rhs = tangent_->condensed_rows();
    rhs.scale(-1.0);
    try {
      solver_->solve(rhs, increment.vertex_dofs());
      tangent_->recover(increment);
    } catch (const LinearSolverError&) {
      increment.fill(std::numeric_limits<double>::quiet_NaN());
    }
  }

 private:
  /// Counts for structures with joints and inclined supports, whose solved matrix is unsymmetric.
  long negative_of_reduced() {
    if (unknowns_ == nullptr) unknowns_ = std::make_unique<IndependentUnknowns>(problem_.model);
    const SparseMatrix& matrix = unknowns_->reduce(*tangent_);
    if (unknowns_->count() == 0) return 0;
    return std::lround(number_of_root(unknowns_->root(), [&] {
      if (inertia_ == nullptr) inertia_ = std::make_unique<InertiaSolver>(InertiaSolver::Kind::symmetric, matrix);
      return static_cast<double>(inertia_->factorize(matrix).negative);
    }));
  }

  BeamProblem& problem_;
  std::unique_ptr<TangentSolver> solver_;
  MixedVector unit_;
  KernelView<double*> springs_{};
  std::optional<Tangent> tangent_;
  std::unique_ptr<IndependentUnknowns> unknowns_;
  std::unique_ptr<InertiaSolver> inertia_;
};

Descent::Descent(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, Corrector& corrector,
                 Stability& stability, const PathMeasure& measure, const Observer& observer)
    : problem_(problem),
      parameters_(parameters),
      corrector_(corrector),
      stability_(stability),
      measure_(measure),
      observer_(observer),
      tangent_(std::make_unique<ShiftedTangent>(*problem, parameters.linear.residual_tolerance)) {}

Descent::~Descent() = default;

double Descent::potential(const State& state) const { return potential_energy(problem_->model, state, load_factor_); }

/// Factorises the tangent at a point and counts its negative eigenvalues. May throw from leave_if_asked.
long Descent::factorize(const EvaluationPoint& point, double shift) {
  if (problem_->leave_if_asked) problem_->leave_if_asked();
  ++factorizations_;
  ++problem_->work.factorizations;
  try {
    return tangent_->factorize(point, shift);
  } catch (const LinearSolverError&) {
    return kSingular;
  }
}

/// Unscaled forces and moments of the springs, projected on free motions.
MixedVector Descent::spring_forces(const State& state, const MixedVector& moved, double shift) const {
  MixedVector forces = problem_->model.create_vector();
  forces.fill(0.0);
  const KernelView<double*> force = forces.vertex();
  const KernelView<const double*> way = moved.vertex(), unit = tangent_->unit_springs().vertex();
  for (size_t i = 0; i < force.extent(0); ++i) force(i) = shift * unit(i) * way(i);
  problem_->model.project_on_free_motions(state, force);
  return forces;
}

/// Newton's method on the equations with springs from the vertices to their positions in `centre`.
Descent::Relaxed Descent::relax(const State& centre, double shift) {
  const Model& model = problem_->model;
  Relaxed result{Outcome::failed, centre};
  MixedVector rows = model.create_vector(), moved = rows.clone(false), increment = rows.clone(false);
  moved.fill(0.0);
  for (result.iterations = 0;; ++result.iterations) {
    const EvaluationPoint point = mixed_residual(model, result.state, load_factor_, rows);
    const MixedVector springs = spring_forces(result.state, moved, shift);
    MixedVector scaled_springs = springs.clone(true);
    scale_vertex_rows(model, point.scales, scaled_springs.vertex());
    rows.update(1.0, scaled_springs, 1.0);
    const double residual = rows.maximum_norm();
    if (result.iterations > 0 && residual <= path_limit.loose_residual) break;
    if (!std::isfinite(residual) || result.iterations == path_limit.most_iterations_of_easy_solve) return result;
    if (factorize(point, shift) > 0 && result.iterations == 0) return {Outcome::indefinite, centre};
    tangent_->tangent().condensed_rows().update(1.0, springs.vertex_dofs(), 1.0);
    tangent_->solve_and_recover(increment);
    ++problem_->work.newton_iterations;
    const double spin = increment.largest_vertex_spin(), limit = parameters_.newton.maximum_rotation;
    if (!std::isfinite(spin)) return result;
    const double share = spin > limit ? limit / spin : 1.0;
    result.state = model.apply(result.state, increment, share);
    moved.update(share, increment, 1.0);
  }
  result.potential = potential(result.state);
  result.outcome = Outcome::arrived;
  return result;
}

/// Applies prescribed motions; the rest follows by one increment of the tangent, with springs if it is indefinite.
/// Returns the start if there are none.
State Descent::moved_by_supports(const State& start) {
  const Model& model = problem_->model;
  MixedVector rows = model.create_vector(), increment = rows.clone(false);
  const EvaluationPoint point = mixed_residual(model, start, load_factor_, rows);
  const KernelView<const double*> row = rows.vertex();
  double largest = 0.0;
  for (size_t i = 0; i < row.extent(0); ++i)
    if (model.fixed_rows()(i) != 0) largest = std::max(largest, std::abs(row(i)));
  if (maximum_over_ranks(*model.map()->getComm(), largest) <= parameters_.newton.residual_tolerance) return start;
  double shift = 0.0;
  while (factorize(point, shift) > 0 && shift < path_limit.most_shift)
    shift = std::max(path_limit.first_shift, path_limit.springs_stiffen * shift);
  tangent_->solve_and_recover(increment);
  return std::isfinite(increment.maximum_norm()) ? model.apply(start, increment, 1.0) : start;
}

/// Finds a motion along which the tangent is negative, theory (68), with largest rotation or displacement / L of one
/// and the sign of branches. None if none is found. The tangent with these springs must have no negative eigenvalue.
std::optional<MixedVector> Descent::falling_motion(const State& state, double shift) {
  const Model& model = problem_->model;
  MixedVector rows = model.create_vector(), mode = rows.clone(false);
  if (factorize(mixed_residual(model, state, load_factor_, rows), shift) > 0) return std::nullopt;
  mode.fill(0.0);
  const KernelView<double*> entries = mode.vertex();
  for (size_t i = 0; i < entries.extent(0); ++i) {  // pseudo-random, so that the start has no symmetry
    const int vertex = model.structure().local_vertex_to_global[i / kVertexDofs];
    const double number = std::sin(1.0 + 12.9898 * vertex + 78.233 * static_cast<double>(i % kVertexDofs)) * 43758.5453;
    entries(i) = (i % kVertexDofs < 3 ? model.structure().length : 1.0) * (number - std::floor(number) - 0.5);
  }
  double curvature = 0.0;
  for (int i = 0; i < kInverseIterations; ++i) {
    const MixedVector before = mode.clone(true);
    try {
      tangent_->solve(spring_forces(state, before, 1.0).vertex_dofs(), mode.vertex_dofs());
    } catch (const LinearSolverError&) {
      return std::nullopt;
    }
    const double size = measure_.motion(mode);
    if (!(size > 0.0) || !std::isfinite(size)) return std::nullopt;
    const MixedVector& unit = tangent_->unit_springs();
    curvature = mode.vertex_product(unit, before) / mode.vertex_product(unit, mode) - shift;
    mode.vertex_dofs().scale(1.0 / size);
  }
  if (!(curvature < 0.0)) return std::nullopt;
  MixedVector none = model.create_vector();
  none.fill(0.0);
  tangent_->tangent().condense(none);
  tangent_->tangent().recover(mode);
  std::optional<MixedVector> motion = branch_direction(*problem_, parameters_.analysis, measure_, {mode});
  if (!motion) motion = mode.clone(true);
  const LargestParts parts = largest_parts(*model.map()->getComm(), motion->vertex());
  motion->scale(1.0 / std::max(parts.moved / model.structure().length, parts.turned));
  return motion;
}

/// Moves the state in the sense of the motion that lowers the potential, or along the motion if that is level.
State Descent::pushed(const State& state, const MixedVector& motion, double amplitude) const {
  const Model& model = problem_->model;
  const State along = model.apply(state, motion, amplitude), against = model.apply(state, motion, -amplitude);
  const double here = potential(state), one = potential(along), other = potential(against);
  const bool is_level =
      std::abs(one - other) <= path_limit.level_slope * std::max(std::abs(one - here), std::abs(other - here));
  return is_level || one < other ? along : against;
}

std::optional<Correction> Descent::equilibrium(const State& near) {
  Correction found = corrector_.at_load(near, load_factor_, path_limit.most_iterations_nearby);
  factorizations_ += found.iterations;
  if (!found.converged) return std::nullopt;
  return found;
}

double Descent::precision(const State& state) const {
  const StrainEnergy strain = strain_energy(problem_->model, state);
  return path_limit.potential_digits * (strain.force + strain.moment);
}

Verdict Descent::verdict_on(const State& state) {
  const auto found = stability_.try_ask({state, load_factor_}, How::inertia);
  return found ? found->verdict() : Verdict::unknown;
}

DescentResult Descent::from(const State& start, double load_factor) {
  const Model& model = problem_->model;
  load_factor_ = load_factor;
  factorizations_ = 0;
  State here = moved_by_supports(start);
  const double stress = std::max(1.0, stress_of(model, magnitude_of(model, here, load_factor)));
  if (!std::isfinite(stress)) return {std::nullopt, "the stresses are not finite", 0};
  double lowest = HUGE_VAL;  // the first potential is taken under the new loads
  double shift = path_limit.first_shift * stress, softest = path_limit.first_shift * stress,
         amplitude = path_limit.first_push;
  bool falls_aside = false;  // the tangent has a negative eigenvalue here
  while (factorizations_ < kMostFactorizationsOfDescent && shift <= path_limit.most_shift * stress) {
    if (!falls_aside && shift < softest) {
      softest = path_limit.springs_soften * shift;
      const std::optional<Correction> found = equilibrium(here);
      if (found && potential(found->state) <= lowest + precision(here)) {
        const Verdict verdict = verdict_on(found->state);
        if (verdict == Verdict::stable || verdict == Verdict::neutral) return {found, "", factorizations_};
        here = found->state;
        lowest = potential(here);
        falls_aside = true;
      }
    }
    std::optional<MixedVector> motion;
    if (falls_aside) motion = falling_motion(here, shift);
    const Relaxed next = relax(motion ? pushed(here, *motion, amplitude) : here, shift);
    if (next.outcome == Outcome::arrived && next.potential <= lowest + precision(next.state)) {
      here = next.state;
      lowest = next.potential;
      falls_aside = false;
      if (next.iterations <= path_limit.easy_iterations_of_descent) {
        shift *= path_limit.springs_soften;
        amplitude = std::min(2.0 * amplitude, path_limit.most_push);
      }
      if (observer_) observer_({load_factor, lowest, factorizations_});
      continue;
    }
    if (next.outcome == Outcome::indefinite) falls_aside = true;
    if (motion && amplitude > path_limit.least_push) amplitude *= 0.5;
    shift *= path_limit.springs_stiffen;
  }
  const bool buckles_inside = tangent_ && tangent_->tangent().interior_count().negative > 0;
  return {
      std::nullopt,
      "no stable state in " + std::to_string(factorizations_) +
          " factorisations of the descent along the total potential" +
          (buckles_inside ? ": elements buckle between their vertices (more \"Elements\", smaller load steps)" : ""),
      factorizations_};
}

}  // namespace mixbeam
