#include "nonlinear/stability/stability.hpp"

#include "nonlinear/stability/nearest_eigenvalue.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

namespace mixbeam {

namespace {

/// Rounding leaves 1e-13 in refined meshes, an unfinished Newton iteration 1e-11; asymmetry this small changes
/// eigenvalues by its square.
constexpr double kSymmetric = 1e-9;
/// Raises of the usual cap. Where eigenvalues are only counted it lowers a critical load by about 1e-7 of it; modes are
/// corrected to the true stiffness, so that the usual cap, which leaves less of rounding, serves them best.
///
/// Where the stresses, N L^2/EI or M L/EI with the largest EI of the structure, are below one and so is the stiffness
/// of the structure, as that of a stiff column on a soft spring, the cap is lower in proportion: what is 1e7 times as
/// stiff is as good as rigid, and in the rounding of stiffnesses far above the decisive ones would be lost.
constexpr double kCapOfCount = 100.0, kCapOfModes = 1.0;
/// Parts of it: the second is taken where a pivot inside an element is zero with the first; whether it is depends on
/// it.
constexpr std::array<double, 2> kCapParts = {1.0, 0.3};
/// Below this share of EI the stiffness of the unloaded structure is asked for as well.
constexpr double kSmallStress = 1e-2;
/// A cap below this share of the usual one is that of a mechanism without stress.
constexpr double kLeastCapShare = 1e-12;
/// An eigenvalue below this share of the stresses at work, N L^2/EI or M L/EI, is zero: states are equilibria to 1e-11.
constexpr double kZero = 1e-9;
/// Below this share of them an eigenvalue is looked at: the cap shifts it by 1e-7, and that of the remaining
/// system is a few dozen times larger.
constexpr double kNearZero = 1e-4;
/// The same as a multiple of rounding errors.
constexpr double kNearRounding = 100.0;
/// Modes looked at there: at first, and at most. More zero eigenvalues than this are those of a mechanism.
constexpr int kFirstNull = 4, kMostNull = 16;
/// Without symmetry up to so many real eigenvalues are counted, and so many more are looked at: negative ones need not
/// be the nearest to zero.
constexpr int kMostDivergent = 16, kMoreModes = 4;
/// They are counted where the loads have a potential but for the ends or the discretization (rings under a pressure
/// that follows them: 5e-4). Beyond (dead moments that turn a rod by a radian: 0.2), pairs of complex eigenvalues
/// become real below zero, which passes for two that went through zero.
constexpr double kNearlyConservative = 2e-2;

SparseMatrix shifted(SparseMatrix matrix, double shift) {
  for (int i = 0; i < matrix.rows(); ++i)
    for (int k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k)
      if (matrix.column[k] == i) matrix.value[k] += shift;
  return matrix;
}

}  // namespace

double stress_of(const Model& model, const StateMagnitude& size) {
  const Structure& structure = model.structure();
  return structure.length / structure.bending_reference * std::max(size.force * structure.length, size.moment);
}

const char* text_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::stable:
      return "true";
    case Verdict::unstable:
      return "false";
    case Verdict::neutral:
      return "neutral";
    case Verdict::unknown:
      break;
  }
  return "unknown";
}

Verdict StabilityResult::verdict() const {
  if (negative > 0 || (!symmetric && sign < 0)) return Verdict::unstable;
  if (!symmetric) return Verdict::unknown;
  return null > 0 ? Verdict::neutral : Verdict::stable;
}

Stability::Stability(BeamProblem& problem) : problem_(problem) {}

/// With a cap at which no pivot inside an element is zero, if there is one.
Stability::Look Stability::evaluate_tangent(const State& state, double load_factor, double raise) {
  const Model& model = problem_.model;
  const double stress = stress_of(model, magnitude_of(model, state, load_factor));
  const double share = stress >= kSmallStress ? std::min(1.0, stress) : std::max(stress, least_stiffness());
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, state, load_factor, residual);
  std::optional<Tangent> tangent;
  Tangent::InteriorCount interior;
  for (double part : kCapParts) {
    const Cap cap = cap_for(model, point.scales, part * std::min(raise, kCapOfCount * share));
    tangent.reset();  // its arrays are used again
    tangent.emplace(model, point, cap, TangentKind{true, true});
    interior = tangent->interior_count();
    if (!interior.uncertain) break;
  }
  return {std::move(*tangent), interior, kZero * stress};
}

/// The smallest eigenvalue of the unloaded structure in units of its largest EI/L, roughly, and at most one: from what
/// chains leave.
double Stability::least_stiffness() {
  if (least_stiffness_) return *least_stiffness_;
  const Model& model = problem_.model;
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, model.reference_state(), 0.0, residual);
  const RootResult root = factorized_beside_chains({Tangent(model, point, cap_for(model, point.scales), {true}), {}});
  const double size =
      number_of_root(unknowns_beside_chains_->root(), [&] { return root.is_reliable ? root.nearest : 0.0; });
  least_stiffness_ = std::clamp(size, kLeastCapShare, 1.0);
  return *least_stiffness_;
}

/// The tangent of evaluate_tangent(), all of it.
Stability::Look Stability::assemble(const State& state, double load_factor) {
  Look look = evaluate_tangent(state, load_factor, kCapOfModes);
  if (unknowns_ == nullptr) unknowns_ = std::make_unique<IndependentUnknowns>(problem_.model);
  unknowns_->reduce(look.tangent);
  return look;
}

/// Inertia, or the sign of the determinant.
Stability::RootResult Stability::factorized(const SparseMatrix& matrix, Solvers& solvers) const {
  RootResult root;
  StabilityResult& result = root.result;
  result.asymmetry = asymmetry(matrix);
  result.symmetric = result.asymmetry <= kSymmetric;
  result.sign = 1;
  if (matrix.rows() == 0) return root;
  const auto kind = result.symmetric ? InertiaSolver::Kind::symmetric : InertiaSolver::Kind::general;
  std::unique_ptr<InertiaSolver>& solver = result.symmetric ? solvers.symmetric : solvers.general;
  if (solver == nullptr) solver = std::make_unique<InertiaSolver>(kind, matrix);
  const InertiaSolver::Signs signs = solver->factorize(matrix);
  result.null = signs.null;
  result.negative = signs.negative;
  result.sign = signs.determinant_sign;
  return root;
}

/// No more real eigenvalues of a matrix are below zero, as a rule: their vectors have negative forms.
int Stability::negative_of_symmetric_part(const SparseMatrix& matrix, Solvers& solvers) {
  if (solvers.symmetric == nullptr)
    solvers.symmetric = std::make_unique<InertiaSolver>(InertiaSolver::Kind::symmetric, matrix);
  return solvers.symmetric->factorize(symmetric_part(matrix)).negative;
}

void Stability::look_for_zero(const SparseMatrix& matrix, const Solvers& solvers, double zero, RootResult& root) {
  if (matrix.rows() == 0 || root.result.null > 0 || !root.result.symmetric) return;
  const auto [size, rounding] = nearest_eigenvalue(matrix, *solvers.symmetric);
  root.nearest = size;
  root.is_near_zero = !(size > std::max(kNearZero / kZero * zero, kNearRounding * rounding));
}

/// Adds what interiors and chains have. Collective.
Stability::RootResult Stability::completed(RootResult root, MPI_Comm communicator, const Look& look, long of_chains) {
  StabilityResult& result = root.result;
  double numbers[6] = {static_cast<double>(result.negative), static_cast<double>(result.null),
                       result.symmetric ? 1.0 : 0.0,         result.asymmetry,
                       static_cast<double>(result.sign),     root.is_near_zero ? 1.0 : 0.0};
  MPI_Bcast(numbers, 6, MPI_DOUBLE, 0, communicator);
  const long eliminated = look.interior.negative + of_chains;
  result.inside = look.interior.negative;
  result.cap_ratio = look.tangent.cap().least_ratio;
  result.null = static_cast<int>(numbers[1]);
  result.symmetric = numbers[2] == 1.0;
  result.asymmetry = numbers[3];
  result.negative = static_cast<int>(numbers[0] + eliminated);
  result.sign = static_cast<int>(numbers[4]) * (eliminated % 2 == 0 ? 1 : -1);
  root.is_near_zero = numbers[5] == 1.0;
  root.of_symmetric_part = result.negative;
  if (result.symmetric)
    result.sign = sign_of(result.negative, result.null);
  else
    result.negative = result.sign < 0 ? 1 : 0;
  return root;
}

/// The tangent with its chains condensed, and whether their pivots can be relied on.
Stability::RootResult Stability::factorized_beside_chains(const Look& look) {
  if (chains_ == nullptr) {
    chains_ = std::make_unique<CondensedSystem>(problem_.model);
    unknowns_beside_chains_ = std::make_unique<IndependentUnknowns>(problem_.model, chains_->remaining());
  }
  int reliable = chains_->condense(look.tangent) ? 1 : 0;
  const SparseMatrix& matrix = unknowns_beside_chains_->reduce(look.tangent);
  const RootCopy& copy = unknowns_beside_chains_->root();
  RootResult root;
  on_root(copy, [&] {
    root = factorized(matrix, beside_chains_);
    if (!root.result.symmetric && root.result.asymmetry <= kNearlyConservative)
      root.result.negative = negative_of_symmetric_part(matrix, beside_chains_);
    look_for_zero(matrix, beside_chains_, look.zero, root);
  });
  long negative = chains_->negative_pivots();
  MPI_Allreduce(MPI_IN_PLACE, &reliable, 1, MPI_INT, MPI_MIN, copy.communicator());
  MPI_Allreduce(MPI_IN_PLACE, &negative, 1, MPI_LONG, MPI_SUM, copy.communicator());
  root = completed(root, copy.communicator(), look, negative);
  root.is_reliable = reliable == 1;
  return root;
}

/// None where the signs of pivots cannot be relied on, next to a critical point.
std::optional<StabilityResult> Stability::inertia_with_chains(const Look& look) {
  const RootResult root = factorized_beside_chains(look);
  if (!root.is_reliable || root.is_near_zero || root.result.null > 0 || look.interior.uncertain) return std::nullopt;
  if (!root.result.symmetric) {
    // The determinant tells one negative eigenvalue from none, but not two.
    if (root.result.asymmetry > kNearlyConservative || root.of_symmetric_part < 2 ||
        root.of_symmetric_part > kMostDivergent)
      return root.result;
    return spectrum(look.state(), look.load_factor(), root.of_symmetric_part + kMoreModes).stability;
  }
  DofVector remaining_b(chains_->matrix()->getRowMap()), remaining_x(chains_->matrix()->getRowMap());
  const IndependentUnknowns& remaining = *unknowns_beside_chains_;
  const auto solve = [&](const DofVector& b, DofVector& x) {
    chains_->condense_rows(b, remaining_b, x);
    std::vector<double> y = remaining.reduced_remaining_rows(remaining_b);
    on_root(remaining.root(), [&] {
      if (!y.empty()) beside_chains_.symmetric->solve(y.data(), 1);
    });
    remaining.expand(y.data(), remaining_x);
    chains_->expand(remaining_x, x);
  };
  if (!(nearest_eigenvalue(look.tangent, solve).size > kNearZero / kZero * look.zero)) return std::nullopt;
  return root.result;
}

namespace {

/// Of all members, over the length of the structure, and at least one: eigenvalues of the remaining system are that
/// much smaller in the units of IndependentUnknowns than in those of nearest_eigenvalue().
double relative_length(const Model& model) {
  return std::max(1.0, model.mesh().total_length() / model.structure().length);
}

}  // namespace

/// An eigenvalue of the remaining system is no nearer to zero than the nearest one of the whole tangent.
std::optional<StabilityResult> Stability::count_by(Linearization& at) const {
  const Tangent& tangent = at.tangent();
  const bool iterates = at.solver().iterates();  // then the signs found in the solves count
  if (tangent.is_planar() || (tangent.cap().cuts_off && !iterates) || !at.failure().empty()) return std::nullopt;
  const Tangent::InteriorCount interior = tangent.interior_count();
  if (interior.uncertain || (!iterates && !at.solver().negative_eigenvalues())) return std::nullopt;
  const EvaluationPoint& point = tangent.point();
  const double stress = stress_of(problem_.model, magnitude_of(problem_.model, point.state, point.load_factor));
  const double near_zero = kNearZero * stress * relative_length(problem_.model);
  const NearestEigenvalue nearest = nearest_eigenvalue(
      tangent, [&](const DofVector& b, DofVector& x) { at.solve_vertices(b, x); },
      [&](const DofVector& x) { return at.solver().rounding_of_form(x); });
  if (!(nearest.size > std::max(near_zero, kNearRounding * nearest.rounding))) return std::nullopt;
  const std::optional<long> negative = at.solver().negative_eigenvalues();
  if (!negative) return std::nullopt;
  StabilityResult result;
  result.negative = static_cast<int>(*negative + interior.negative);
  result.inside = interior.negative;
  result.sign = sign_of(result.negative, 0);
  result.cap_ratio = tangent.cap().least_ratio;
  result.end_angle = largest_end_angle(problem_.model, point).angle;
  return result;
}

std::optional<StabilityResult> Stability::sign_by_iteration(const State& state, double load_factor) {
  const Model& model = problem_.model;
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, state, load_factor, residual);
  Linearization at(problem_, point, cap_for(model, point.scales, kCapOfCount), TangentKind{true, true});
  if (at.failure().empty()) try {
      return count_by(at);
    } catch (const LinearSolverError&) {  // why is told below
    }
  const long negative = at.solver().negative_eigenvalues().value_or(0);
  if (negative == 0) return std::nullopt;
  StabilityResult result;
  result.negative = static_cast<int>(negative);
  result.sign = sign_of(result.negative, 0);
  return result;
}

/// Leaves the factors of the tangent, or of what lies beside it where a pivot is zero or `shift` asks for it.
StabilityResult Stability::inertia(const Look& look, double shift) {
  RootResult root;
  on_root(unknowns_->root(), [&] {
    root = factorized(unknowns_->matrix(), all_);
    if (root.result.null > 0) shift = kShiftBesideZero;
    if (shift == 0.0) return;
    const InertiaSolver::Signs beside = solver(root.result).factorize(shifted(unknowns_->matrix(), shift));
    if (root.result.symmetric) root.result.negative = beside.negative;
  });
  root.result.shift = number_of_root(unknowns_->root(), [&] { return shift; });
  return completed(root, unknowns_->root().communicator(), look, 0).result;
}

InertiaSolver& Stability::solver(const StabilityResult& result) {
  return result.symmetric ? *all_.symmetric : *all_.general;
}

StabilityResult Stability::count(const State& state, double load_factor) {
  std::optional<Look> look = evaluate_tangent(state, load_factor, kCapOfCount);
  const double end_angle = largest_end_angle(problem_.model, look->tangent.point()).angle;
  std::optional<StabilityResult> result = inertia_with_chains(*look);
  look.reset();  // its arrays are used again
  for (int modes = kFirstNull; !result; modes *= 2) {
    const StabilityResult seen = spectrum(state, load_factor, modes).stability;
    if (seen.null < modes || modes >= kMostNull) result = seen;
  }
  result->end_angle = end_angle;
  return *result;
}

/// Theory (48) with K of the tangent and the row e of the motion.
StabilityResult Stability::count_held(const State& state, double load_factor, const MixedVector& motion) {
  const Look look = assemble(state, load_factor);
  StabilityResult result = inertia(look);
  MixedVector forces = motion.clone(true);
  look.tangent.project_on_free_motions(forces.vertex());
  const std::vector<double> row = unknowns_->reduced_rows(forces.vertex_dofs());
  const double compliance = number_of_root(unknowns_->root(), [&] {
    std::vector<double> moved = row;
    solver(result).solve(moved.data(), 1);
    return dot_product(row, moved);
  });
  if (compliance == 0.0) return result;
  const int sign = compliance < 0.0 ? -1 : 1;
  if (result.null > 0) {  // beside a zero pivot, on its positive side
    --result.null;
    if (result.null == 0) result.sign = sign_of(result.negative, 0);
    return result;
  }
  result.sign *= sign;
  if (result.symmetric)
    result.negative -= sign < 0 ? 1 : 0;
  else
    result.negative = result.sign < 0 ? 1 : 0;
  return result;
}

}  // namespace mixbeam
