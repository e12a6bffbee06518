#include "nonlinear/stability/stability.hpp"

#include "discretization/mesh/element_view.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

namespace mixbeam {

namespace {

/// Factors on the cap: the second is used if a pivot inside an element is zero with the first.
constexpr std::array<double, 2> kCapParts = {1.0, 0.3};
/// Steps, as parts of StabilityThresholds::difference_motion, and weights of the central differences.
constexpr std::array<std::array<double, 2>, 3> kDifferences = {
    {{1.0, 1.0 / 45.0}, {0.5, -20.0 / 45.0}, {0.25, 64.0 / 45.0}}};

/// Inverse iterations with the vectors of a space before eigenvalues are taken in it.
constexpr int kSpaceIterations = 2;

SparseMatrix shifted(SparseMatrix matrix, double shift) {
  for (int i = 0; i < matrix.rows(); ++i)
    for (int k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k)
      if (matrix.column[k] == i) matrix.value[k] += shift;
  return matrix;
}

bool is_real(const RitzPair& pair) {
  return std::abs(pair.imaginary) <= stability_limit.real_value * std::abs(pair.value);
}

/// Sign of the determinant of a symmetric tangent.
int sign_of(int negative, int null) { return null > 0 ? 0 : (negative % 2 == 0 ? 1 : -1); }

/// Result for a symmetric tangent without zero eigenvalues.
StabilityResult counted(long negative) {
  StabilityResult result;
  result.negative = static_cast<int>(negative);
  result.sign = sign_of(result.negative, 0);
  return result;
}

/// Total length of members over the length of the structure, at least one: the ratio of eigenvalues of the remaining
/// system in the units of nearest_eigenvalue() to those in the units of IndependentUnknowns.
double relative_length(const Model& model) {
  return std::max(1.0, model.mesh().total_length() / model.structure().length);
}

/// Number of pairs that StabilityResult::negative includes before eigenvalues are corrected.
template <class Pairs>
int number_counted(const Pairs& pairs, const StabilityResult& stability) {
  return static_cast<int>(
      std::count_if(pairs.begin(), pairs.end(), [&](const auto& pair) { return pair.value < -stability.shift; }));
}

/// Replaces the `before` negative eigenvalues of the capped tangent in the count by the corrected ones, and counts zero
/// ones separately.
void recount(int before, double zero, Spectrum& spectrum) {
  StabilityResult& stability = spectrum.stability;
  stability.negative = std::max(0, stability.negative - before);  // rounding may change the sign of an inverse
  stability.null = 0;
  for (const EigenMode& mode : spectrum.modes) {
    if (std::abs(mode.eigenvalue) <= std::max(zero, mode.error))
      ++stability.null;
    else if (mode.eigenvalue < 0.0)
      ++stability.negative;
  }
  stability.sign = sign_of(stability.negative, stability.null);
}

/// Counts the real eigenvalues that are certainly negative; the sign of the determinant shows whether one is missing.
void recount_unsymmetric(Spectrum& spectrum) {
  StabilityResult& stability = spectrum.stability;
  stability.negative = 0;
  for (const EigenMode& mode : spectrum.modes)
    if (mode.eigenvalue < -mode.error) ++stability.negative;
  const bool is_odd = stability.negative % 2 == 1;
  if (stability.sign != 0 && is_odd != (stability.sign < 0)) ++stability.negative;
}

/// Number of inverse iterations from an arbitrary vector: near zero each gains many digits.
constexpr int kInverseIterations = 3;

/// Entry of a vector with a component in every mode: fractional part of a multiple of the golden ratio, plus 0.5.
KOKKOS_INLINE_FUNCTION double arbitrary(double number) {
  constexpr double golden = 0.6180339887498949;
  const double multiple = golden * number;
  return 0.5 + (multiple - std::floor(multiple));
}

using Rows = Kokkos::RangePolicy<ExecutionSpace>;

/// Weights of the rows of vertex motions, (6 * vertex + component).
struct VertexWeights {
  double moved, turned;
  KOKKOS_INLINE_FUNCTION double operator()(size_t row) const { return row % kVertexDofs < 3 ? moved : turned; }
};

/// Bound of the distance of an eigenvalue from zero, by inverse iteration: next to zero the signs of pivots are
/// rounding.
struct NearestEigenvalue {
  double size = HUGE_VAL;  ///< upper bound of the magnitude of the eigenvalue nearest to zero
  double rounding = 0.0;   ///< its error by rounding of the entries of the matrix, if known
};

/// Error of y . A y by rounding of the entries of A, for y of unit length.
double rounding_level(const SparseMatrix& a, const std::vector<double>& y) {
  double sum = 0.0;
  for (int i = 0; i < a.rows(); ++i)
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k)
      sum += std::abs(y[i]) * std::abs(a.value[k]) * std::abs(y[a.column[k]]);
  return std::numeric_limits<double>::epsilon() * sum;
}

/// Bounds the nearest eigenvalue of a factorised matrix.
NearestEigenvalue nearest_eigenvalue(const SparseMatrix& a, InertiaSolver& solver) {
  std::vector<double> y(a.rows());
  for (int i = 0; i < a.rows(); ++i) y[i] = arbitrary(i);
  double length = std::sqrt(dot_product(y, y)), size = HUGE_VAL;
  for (int i = 0; i < kInverseIterations; ++i) {
    for (double& x : y) x /= length;
    solver.solve(y.data(), 1);
    length = std::sqrt(dot_product(y, y));
    size = 1.0 / length;
  }
  for (double& x : y) x /= length;
  return {size, rounding_level(a, y)};
}

/// Bounds that of a whole tangent with its chains, to which a mode may be confined; eigenvalues of the remaining system
/// are no nearer to zero. `solve`: K dx = b of all vertices; `rounding_of_form`: see TangentSolver. In units of EI/L;
/// collective.
NearestEigenvalue nearest_eigenvalue(const Tangent& tangent,
                                     const std::function<void(const DofVector& b, DofVector& x)>& solve,
                                     const std::function<double(const DofVector&)>& rounding_of_form = {}) {
  const Model& model = tangent.model();
  const Structure& structure = model.structure();
  const Teuchos::Comm<int>& comm = *model.map()->getComm();
  DofVector x(model.map()), b(model.map());
  const KernelView<double*> motion = MixedVector::view_of(x), force = MixedVector::view_of(b);
  const int rows = static_cast<int>(motion.extent(0));
  const double L = structure.length, share = structure.bending_reference / (L * model.mesh().vertices());
  const VertexWeights weights{share / (L * L), share};
  const auto* global_vertex = structure.local_vertex_to_global.data();
  Kokkos::parallel_for(
      "mixbeam::nearest::start", Rows(0, rows), KOKKOS_LAMBDA(int i) {
        motion(i) = arbitrary(static_cast<double>(kVertexDofs) * global_vertex[i / kVertexDofs] + i % kVertexDofs);
      });
  NearestEigenvalue nearest;
  const auto length = [&] {
    return std::sqrt(
        sum_over_ranks(comm, ordered_sum(
                                 rows, KOKKOS_LAMBDA(size_t i) { return motion(i) * motion(i) * weights(i); })));
  };
  double moved = length();
  for (int step = 0; step < kInverseIterations; ++step) {
    const double scale = 1.0 / moved;
    Kokkos::parallel_for(
        "mixbeam::nearest::force", Rows(0, rows), KOKKOS_LAMBDA(int i) { force(i) = scale * weights(i) * motion(i); });
    tangent.project_on_free_motions(force);
    const double pushed = std::sqrt(
        sum_over_ranks(comm, ordered_sum(
                                 rows, KOKKOS_LAMBDA(size_t i) { return force(i) * force(i) / weights(i); })));
    solve(b, x);
    moved = length();
    nearest.size = pushed / moved;
  }
  if (rounding_of_form) nearest.rounding = rounding_of_form(x) / (moved * moved);
  return nearest;
}

/// Computes asymmetry() of the rows of this rank that chains eliminate, in the units of IndependentUnknowns.
double asymmetry_of_chains(const CondensedSystem& chains, const Tangent& tangent) {
  constexpr int n = kVertexDofs;
  const Structure& structure = tangent.model().structure();
  const KernelView<double**> tangents = tangent.elements().condensed_tangent;
  if (tangents.extent(1) != kFullTangent) return 0.0;
  const Adjacency adjacency = tangent.model().adjacency();
  const double bending = structure.bending_reference / structure.length;
  const std::vector<double> lengths = vertex_lengths(structure);
  std::vector<double> weights(static_cast<size_t>(n) * structure.owned_vertices);
  double largest = 0.0;
  for (int v = 0; v < structure.owned_vertices; ++v) {
    double sum[n][n] = {}, *weight = &weights[static_cast<size_t>(n) * v];
    for (int a = adjacency.start(v); a < adjacency.start(v + 1); ++a) {
      const double* block = &tangents(adjacency.element(a, 0), (2 * n + 1) * n * adjacency.element(a, 1));
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) sum[i][j] += block[2 * n * i + j];
    }
    const double unit = 1.0 / std::sqrt(bending * lengths[v] / structure.length);
    for (int i = 0; i < n; ++i) {
      const double own = i < 3 ? structure.length * unit : unit;
      weight[i] = own / std::sqrt(std::max(1.0, std::abs(sum[i][i]) * own * own));
      for (int j = 0; j < i && chains.is_eliminated(v); ++j)
        largest = std::max(largest, std::abs(sum[i][j] - sum[j][i]) * weight[i] * weight[j]);
    }
  }
  for_each_element(structure, [&](const ElementView& element) {
    const int a = element.vertex(0), b = element.vertex(1);
    if (!chains.is_eliminated(a) && !chains.is_eliminated(b)) return;
    const double *k = &tangents(element.local(), 0), *of_a = &weights[vertex_row(a, 0)],
                 *of_b = &weights[vertex_row(b, 0)];
    double most = 0.0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        most = std::max(most, std::abs(k[2 * n * i + n + j] - k[2 * n * (n + j) + i]) * of_a[i] * of_b[j]);
    largest = std::max(largest, most);
  });
  return largest;
}

/// Differentiates the unscaled equations of equilibrium along a motion by differences of the residual, which contains
/// compliances and no stiffness: no rounding of large entries hides small ones. Rows of N and M are zero.
MixedVector derivative_along(const Model& model, const State& state, double load_factor, const MixedVector& motion) {
  const Structure& structure = model.structure();
  const LargestParts size = largest_parts(*model.map()->getComm(), motion.vertex());
  const double unit = stability_limit.difference_motion / std::max(size.moved / structure.length, size.turned);
  MixedVector sum = model.create_vector(), rows = model.create_vector();
  for (const auto& [part, weight] : kDifferences)
    for (double step : {part * unit, -part * unit}) {
      const EvaluationPoint point = mixed_residual(model, model.apply(state, motion, step), load_factor, rows);
      unscale_rows(model, point.scales, rows);
      sum.update(0.5 * weight / step, rows, 1.0);
    }
  clear_rows(structure, sum.writable_interior(true), RowsOf::forces);
  return sum;
}

/// Indices of the eigenvalues number first .. first + count - 1 among those found.
template <class Pairs>
std::vector<int> places_of(const Pairs& found, const StabilityResult& stability, int first, int count) {
  std::vector<int> order(found.size()), places;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return found[a].value < found[b].value; });
  const int lowest = stability.negative - number_counted(found, stability);
  for (int k = first - 1 - lowest; k < first - 1 - lowest + count; ++k)
    if (k >= 0 && k < static_cast<int>(order.size())) places.push_back(order[k]);
  return places;
}

/// Gram-Schmidt, twice because of rounding; applies the same operations to `images` under a linear operator.
void orthonormalize(std::vector<std::vector<double>>& columns, std::vector<std::vector<double>>& images) {
  for (size_t j = 0; j < columns.size(); ++j)
    for (int pass = 0; pass <= 2; ++pass) {
      const double scale = 1.0 / std::sqrt(dot_product(columns[j], columns[j]));
      for (std::vector<double>* v : {&columns[j], &images[j]})
        for (double& x : *v) x *= scale;
      for (size_t i = 0; i < j && pass < 2; ++i) {
        const double share = -dot_product(columns[i], columns[j]);
        add_multiple(share, columns[i], columns[j]);
        add_multiple(share, images[i], images[j]);
      }
    }
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

/// Evaluates the tangent with a cap for which no pivot inside an element is zero, if possible.
Stability::Look Stability::evaluate_tangent(const State& state, double load_factor, double raise) {
  const Model& model = problem_.model;
  const double stress = stress_of(model, magnitude_of(model, state, load_factor));
  const double share = share_of_cap(stress);
  const EvaluationPoint point = take_point(problem_, state, load_factor);
  std::optional<Tangent> tangent;
  Tangent::InteriorCount interior;
  for (double part : kCapParts) {
    const Cap cap = cap_for(model, point.scales, part * std::min(raise, stability_limit.cap_of_count * share));
    tangent.reset();  // so that its arrays are reused
    tangent.emplace(model, point, cap, TangentKind{true, true});
    interior = tangent->interior_count();
    if (!interior.uncertain) break;
  }
  return {std::move(*tangent), interior, stability_limit.zero * stress};
}

/// Share of the usual cap of counts.
double Stability::share_of_cap(double stress, const Seen* unloaded) {
  if (stress >= stability_limit.small_stress) return std::min(1.0, stress);
  return std::max(stress, least_stiffness(unloaded));
}

/// Estimates the smallest eigenvalue of the unloaded structure, in units of its largest EI/L and at most one, from the
/// remaining system of chains. `unloaded`: its tangent with the usual cap, if available.
double Stability::least_stiffness(const Seen* unloaded) {
  if (unloaded_) return unloaded_->stiffness;
  const Model& model = problem_.model;
  if (unloaded == nullptr) {
    const EvaluationPoint point = take_point(problem_, model.reference_state(), 0.0);
    const Tangent own(model, point, cap_for(model, point.scales), TangentKind{true, true});
    const Seen seen{own, own.interior_count()};
    return least_stiffness(&seen);
  }
  const RootResult root = factorized_beside_chains(*unloaded);
  const StabilityResult& seen = root.result;
  const double size =
      number_of_root(unknowns_beside_chains_->root(), [&] { return root.is_reliable ? root.nearest : 0.0; });
  const bool is_stable = root.is_reliable && !root.is_near_zero && !unloaded->interior.uncertain && seen.symmetric &&
                         seen.negative == 0 && seen.null == 0;
  unloaded_ = {std::clamp(size, stability_limit.least_cap_share, 1.0), is_stable};
  return unloaded_->stiffness;
}

/// Result without negative eigenvalues: the compliance of a cap makes no tangent stiffer.
StabilityResult Stability::stable(const EvaluationPoint& point, double share_of_cap) const {
  StabilityResult result = counted(0);
  const double raise = stability_limit.cap_of_count * share_of_cap;
  result.cap_ratio = cap_for(problem_.model, point.scales, raise).least_ratio;
  result.end_angle = largest_end_angle(problem_.model, point).angle;
  return result;
}

/// Counts without a new factorisation: without stresses, and at rest, no eigenvalue is negative, and those of the
/// unloaded structure show whether one is zero.
std::optional<StabilityResult> Stability::count_without_stress(const State& state, double load_factor) {
  const Model& model = problem_.model;
  if (stress_of(model, magnitude_of(model, state, load_factor)) > 0.0) return std::nullopt;
  if (norm(model.frame().at(load_factor)) > 0.0) return std::nullopt;
  const double share = share_of_cap(0.0);
  if (!unloaded_->is_stable) return std::nullopt;
  return stable(take_point(problem_, state, load_factor), share);
}

/// Evaluates the tangent and reduces all of it to the independent unknowns.
Stability::Look Stability::assemble(const State& state, double load_factor) {
  Look look = evaluate_tangent(state, load_factor, stability_limit.cap_of_modes);
  if (unknowns_ == nullptr) unknowns_ = std::make_unique<IndependentUnknowns>(problem_.model);
  unknowns_->reduce(look.tangent);
  return look;
}

/// Determines the inertia, or the sign of the determinant. `asymmetry_beside`: that of rows already eliminated.
Stability::RootResult Stability::factorized(const SparseMatrix& matrix, Solvers& solvers,
                                            double asymmetry_beside) const {
  RootResult root;
  StabilityResult& result = root.result;
  result.asymmetry = std::max(asymmetry(matrix), asymmetry_beside);
  result.symmetric = result.asymmetry <= stability_limit.symmetric;
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

/// Negative eigenvalues of the symmetric part: usually no fewer than negative real ones, whose vectors have x.Kx < 0.
int Stability::negative_of_symmetric_part(const SparseMatrix& matrix, Solvers& solvers) {
  if (solvers.symmetric == nullptr)
    solvers.symmetric = std::make_unique<InertiaSolver>(InertiaSolver::Kind::symmetric, matrix);
  return solvers.symmetric->factorize(symmetric_part(matrix)).negative;
}

void Stability::look_for_zero(const SparseMatrix& matrix, const Solvers& solvers, double zero, RootResult& root) {
  if (matrix.rows() == 0 || root.result.null > 0 || !root.result.symmetric) return;
  const auto [size, rounding] = nearest_eigenvalue(matrix, *solvers.symmetric);
  root.nearest = size;
  root.is_near_zero = !(size > std::max(stability_limit.near_zero / stability_limit.zero * zero,
                                        stability_limit.near_rounding * rounding));
}

/// Adds the counts of interiors and chains. Collective.
Stability::RootResult Stability::completed(RootResult root, const RootCopy& copy, const Seen& look, long of_chains) {
  StabilityResult& result = root.result;
  double numbers[6] = {static_cast<double>(result.negative), static_cast<double>(result.null),
                       result.symmetric ? 1.0 : 0.0,         result.asymmetry,
                       static_cast<double>(result.sign),     root.is_near_zero ? 1.0 : 0.0};
  copy.share(numbers, 6, MPI_DOUBLE);
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

/// Takes the storage of a solver for chains, or its own. Solvers are usually the same each time.
void Stability::take_chains(CondensedSystem* chains) {
  if (chains == nullptr && own_chains_ == nullptr) own_chains_ = std::make_unique<CondensedSystem>(problem_.model);
  if (chains == nullptr) chains = own_chains_.get();
  if (chains != std::exchange(chains_, chains))
    unknowns_beside_chains_ = std::make_unique<IndependentUnknowns>(problem_.model, chains_->remaining());
}

/// Factorises the tangent with its chains condensed, and determines whether their pivots are reliable. Unsymmetric: the
/// result is that of the symmetric part, except for the determinant.
Stability::RootResult Stability::factorized_beside_chains(const Seen& look) {
  take_chains(look.chains != nullptr ? look.chains : problem_.take_solver()->chains());
  const double beside = chains_->is_unsymmetric() ? asymmetry_of_chains(*chains_, look.tangent) : 0.0;
  const double asymmetry = maximum_over_ranks(*problem_.model.map()->getComm(), beside);
  RootResult root = factorized_beside_chains(look, true, asymmetry);
  if (asymmetry <= stability_limit.symmetric) return root;
  const RootResult whole = factorized_beside_chains(look, false, root.result.asymmetry);
  root.result.sign = whole.result.sign;
  root.result.negative = whole.result.negative;
  root.result.null = whole.result.null;
  root.is_reliable = root.is_reliable && whole.is_reliable;
  return root;
}

Stability::RootResult Stability::factorized_beside_chains(const Seen& look, bool symmetric_part, double asymmetry) {
  int reliable = look.chains != nullptr || chains_->condense(look.tangent, symmetric_part) ? 1 : 0;
  const SparseMatrix& matrix = unknowns_beside_chains_->reduce(look.tangent);
  const RootCopy& copy = unknowns_beside_chains_->root();
  RootResult root;
  on_root(copy, [&] {
    root = factorized(matrix, beside_chains_, asymmetry);
    if (!symmetric_part) return;
    if (!root.result.symmetric && root.result.asymmetry <= stability_limit.nearly_conservative)
      root.result.negative = negative_of_symmetric_part(matrix, beside_chains_);
    look_for_zero(matrix, beside_chains_, look.zero, root);
  });
  long negative = chains_->negative_pivots();
  if (!copy.is_alone()) {
    MPI_Allreduce(MPI_IN_PLACE, &reliable, 1, MPI_INT, MPI_MIN, copy.communicator());
    MPI_Allreduce(MPI_IN_PLACE, &negative, 1, MPI_LONG, MPI_SUM, copy.communicator());
  }
  root = completed(root, copy, look, negative);
  root.is_reliable = reliable == 1;
  return root;
}

/// Counts with chains condensed; none if the signs of pivots are unreliable, next to a critical point.
std::optional<StabilityResult> Stability::inertia_with_chains(const Seen& look) {
  const RootResult root = factorized_beside_chains(look);
  if (!root.is_reliable || root.is_near_zero || root.result.null > 0 || look.interior.uncertain) return std::nullopt;
  if (!root.result.symmetric) {
    // The determinant distinguishes one negative eigenvalue from none, but not two.
    if (root.result.asymmetry > stability_limit.nearly_conservative || root.of_symmetric_part < 2 ||
        root.of_symmetric_part > stability_limit.most_divergent)
      return root.result;
    const EvaluationPoint& point = look.tangent.point();
    return spectrum(point.state, point.load_factor, root.of_symmetric_part + stability_limit.more_modes).stability;
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
  if (!(nearest_eigenvalue(look.tangent, solve).size > stability_limit.near_zero / stability_limit.zero * look.zero))
    return std::nullopt;
  return root.result;
}

/// Counts by Newton's own tangent, whose nearest eigenvalue is no farther from zero than those of the remaining system.
/// If the cap cuts off some stiffness, only zero is a valid count, except by solves, whose cap is that of counts.
std::optional<StabilityResult> Stability::count_by(Linearization& at) {
  const Tangent& tangent = at.tangent();
  const bool by_solves = at.solver().counts_by_solves();
  if (tangent.is_planar() || !at.failure().empty()) return std::nullopt;
  const Tangent::InteriorCount interior = tangent.interior_count();
  if (interior.uncertain) return std::nullopt;
  const EvaluationPoint& point = tangent.point();
  const double stress = stress_of(problem_.model, magnitude_of(problem_.model, point.state, point.load_factor));
  const Seen seen{tangent, interior, stability_limit.zero * stress, at.solver().condensed_chains()};
  if (!by_solves && !at.solver().negative_eigenvalues()) {
    if (tangent.cap().cuts_off || problem_.tries_iteration()) return std::nullopt;
    std::optional<StabilityResult> result = inertia_with_chains(seen);
    if (result) result->end_angle = largest_end_angle(problem_.model, point).angle;
    return result;
  }
  if (tangent.cap().cuts_off && !by_solves && *at.solver().negative_eigenvalues() + interior.negative > 0)
    return std::nullopt;
  const double near_zero = stability_limit.near_zero * stress * relative_length(problem_.model);
  const NearestEigenvalue nearest = nearest_eigenvalue(
      tangent, [&](const DofVector& b, DofVector& x) { at.solve_vertices(b, x); },
      [&](const DofVector& x) { return at.solver().rounding_of_form(x); });
  if (!(nearest.size > std::max(near_zero, stability_limit.near_rounding * nearest.rounding))) return std::nullopt;
  const std::optional<long> negative = at.solver().negative_eigenvalues();
  if (!negative) return std::nullopt;
  if (tangent.cap().cuts_off && !by_solves) {
    const bool tells_stiffness =
        stress == 0.0 && tangent.cap().stiffness == cap_for(problem_.model, point.scales).stiffness;
    return stable(point, share_of_cap(stress, tells_stiffness ? &seen : nullptr));
  }
  StabilityResult result = counted(*negative + interior.negative);
  result.inside = interior.negative;
  result.cap_ratio = tangent.cap().least_ratio;
  result.end_angle = largest_end_angle(problem_.model, point).angle;
  return result;
}

std::optional<StabilityResult> Stability::count_by_iteration(const State& state, double load_factor) {
  const Model& model = problem_.model;
  const EvaluationPoint point = take_point(problem_, state, load_factor);
  Linearization at(problem_, point, cap_for(model, point.scales, stability_limit.cap_of_count), TangentKind{true, true},
                   true);
  if (at.failure().empty()) try {
      return count_by(at);
    } catch (const LinearSolverError&) {  // negative curvature that was met is counted below
    }
  const long negative = at.solver().negative_eigenvalues().value_or(0);
  return negative == 0 ? std::nullopt : std::optional(counted(negative));
}

/// Determines the inertia and keeps the factors: those of the tangent, or shifted if a pivot is zero or `shift` is not.
StabilityResult Stability::inertia(const Look& look, double shift) {
  RootResult root;
  on_root(unknowns_->root(), [&] {
    root = factorized(unknowns_->matrix(), all_);
    if (root.result.null > 0) shift = stability_limit.shift_beside_zero;
    if (shift == 0.0) return;
    const InertiaSolver::Signs beside = solver(root.result).factorize(shifted(unknowns_->matrix(), shift));
    if (root.result.symmetric) root.result.negative = beside.negative;
  });
  root.result.shift = number_of_root(unknowns_->root(), [&] { return shift; });
  return completed(root, unknowns_->root(), look.seen(), 0).result;
}

InertiaSolver& Stability::solver(const StabilityResult& result) {
  return result.symmetric ? *all_.symmetric : *all_.general;
}

StabilityResult Stability::count(const State& state, double load_factor) {
  std::optional<StabilityResult> easy;
  if (problem_.tries_iteration()) easy = count_by_iteration(state, load_factor);
  if (easy && easy->negative == 0) return *easy;
  easy = count_without_stress(state, load_factor);
  if (easy) return *easy;
  std::optional<Look> look = evaluate_tangent(state, load_factor, stability_limit.cap_of_count);
  const double end_angle = largest_end_angle(problem_.model, look->tangent.point()).angle;
  std::optional<StabilityResult> result = inertia_with_chains(look->seen());
  look.reset();  // so that its arrays are reused
  for (int modes = stability_limit.first_null; !result; modes *= 2) {
    const StabilityResult seen = spectrum(state, load_factor, modes).stability;
    if (seen.null < modes || modes >= stability_limit.most_null) result = seen;
  }
  result->end_angle = end_angle;
  return *result;
}

/// Counts by theory (48), with K of the tangent and the row e of the motion.
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
  if (result.null > 0) {  // the shift makes a zero pivot positive
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

std::optional<StabilityResult> Stability::try_ask(const Asked& at, How how) {
  try {
    return ask(at, how);
  } catch (const LinearSolverError&) {
    return std::nullopt;
  }
}

std::optional<StabilityResult> Stability::ask(const Asked& at, How how) {
  if (how == How::factors) return count_by(*at.newton);
  if (how == How::iteration) return count_by_iteration(at.state, at.load_factor);
  if (how == How::held) return count_held(at.state, at.load_factor, *at.held);
  return count(at.state, at.load_factor);
}

/// Broadcasts the numbers of rank 0; vectors stay there.
void Stability::share(Pairs& pairs) const {
  const RootCopy& root = unknowns_->root();
  int found = static_cast<int>(pairs.size());
  root.share(&found, 1, MPI_INT);
  pairs.resize(found);
  for (Pair& pair : pairs) {
    double numbers[3] = {pair.value, pair.error, pair.converged ? 1.0 : 0.0};
    root.share(numbers, 3, MPI_DOUBLE);
    pair.value = numbers[0];
    pair.error = numbers[1];
    pair.converged = numbers[2] == 1.0;
  }
}

/// Finds the eigenvalues nearest to zero with the factors kept by inertia().
Stability::Pairs Stability::nearest(const StabilityResult& stability, int count, double tolerance) {
  Pairs pairs;
  on_root(unknowns_->root(), [&] {
    if (unknowns_->count() == 0) return;  // nothing was factorised
    InertiaSolver& factors = solver(stability);
    const double shift = stability.shift;
    KrylovProblem problem;
    problem.unknowns = unknowns_->count();
    problem.symmetric = stability.symmetric;
    problem.tolerance = tolerance;
    problem.apply = [&](double* block, int columns) { factors.solve(block, columns); };
    std::vector<RitzPair> right = largest_eigenpairs(problem, count);
    right.erase(std::remove_if(right.begin(), right.end(), [](const RitzPair& p) { return !is_real(p); }), right.end());
    for (const RitzPair& pair : right)
      pairs.push_back({1.0 / pair.value - shift,
                       pair.error / std::abs(pair.value) + rounding_level(unknowns_->matrix(), pair.vector),
                       pair.converged, pair.vector});
    if (stability.symmetric) return;
    problem.apply = [&](double* block, int columns) { factors.solve(block, columns, true); };
    const std::vector<RitzPair> left = largest_eigenpairs(problem, count);
    for (size_t i = 0; i < right.size(); ++i) {
      const auto distance = [&](const RitzPair& pair) { return std::abs(pair.value - right[i].value); };
      pairs[i].left = std::min_element(left.begin(), left.end(), [&](const RitzPair& a, const RitzPair& b) {
                        return distance(a) < distance(b);
                      })->vector;
      pairs[i].error /= std::max(stability_limit.real_value, std::abs(dot_product(pairs[i].left, pairs[i].vector)));
    }
  });
  share(pairs);
  return pairs;
}

Spectrum Stability::spectrum(const State& state, double load_factor, int count) {
  const Look look = assemble(state, load_factor);
  Spectrum result{inertia(look), {}};
  Pairs pairs = nearest(result.stability, count, stability_limit.exact_modes);
  const auto is_zero = [&](const Pair& pair) { return std::abs(pair.value) <= std::max(look.zero, pair.error); };
  if (result.stability.symmetric && !pairs.empty() && is_zero(pairs.front()) && result.stability.shift == 0.0) {
    result.stability =
        inertia(look, stability_limit.shift_beside_zero);  // the rounding of so large an inverse hides all others
    pairs = nearest(result.stability, count, stability_limit.exact_modes);
  }
  result.modes = corrected_modes(look, result.stability, pairs);
  if (!result.stability.symmetric)
    recount_unsymmetric(result);
  else if (std::all_of(pairs.begin(), pairs.end(), [](const Pair& pair) { return pair.converged; }))
    recount(number_counted(pairs, result.stability), look.zero, result);
  return result;
}

/// Computes the second variation of the mixed potential in the motions that complete_motion() made of the vectors of
/// `pairs`, as a matrix; symmetric tangents only. Their rows of N and M are solved with the compliance of the tangent,
/// from which that of the cap remains.
std::vector<double> Stability::second_variations(const Tangent& tangent, const std::vector<MixedVector>& motions,
                                                 const Pairs& pairs) const {
  const int m = static_cast<int>(motions.size());
  const Model& model = tangent.model();
  const EvaluationPoint& point = tangent.point();
  std::vector<double> form(static_cast<size_t>(m) * m, 0.0), of_vertices(form.size(), 0.0);
  for (int j = 0; j < m; ++j) {
    MixedVector derivative = derivative_along(model, point.state, point.load_factor, motions[j]);
    const std::vector<double> rows = unknowns_->reduced_rows(derivative.vertex_dofs());
    derivative.vertex_dofs().putScalar(0.0);
    for (int i = 0; i < m; ++i) {
      if (unknowns_->is_root()) of_vertices[i + static_cast<size_t>(j) * m] = dot_product(pairs[i].vector, rows);
      form[i + static_cast<size_t>(j) * m] =
          motions[i].inner_product(derivative) + cap_compliance_form(model, tangent.cap(), motions[i], motions[j]);
    }
  }
  unknowns_->root().share(of_vertices.data(), m * m, MPI_DOUBLE);
  for (size_t i = 0; i < form.size(); ++i) of_vertices[i] += form[i];
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) form[i + j * m] = 0.5 * (of_vertices[i + j * m] + of_vertices[j + i * m]);
  return form;
}

/// Corrects modes by Rayleigh-Ritz with the true compliance, which also separates degenerate modes correctly.
std::vector<EigenMode> Stability::corrected_modes(const Look& look, const StabilityResult& stability,
                                                  const Pairs& pairs) {
  const Model& model = problem_.model;
  const Tangent& tangent = look.tangent;
  const double zero = look.zero;
  const auto of_cap = [&](const MixedVector& a, const MixedVector& b) {
    return cap_compliance_form(model, tangent.cap(), a, b);
  };
  const int m = static_cast<int>(pairs.size());
  std::vector<MixedVector> found;
  std::vector<double> values, error, weights(static_cast<size_t>(m) * m, 0.0);
  for (const Pair& pair : pairs) {
    found.push_back(complete_motion(tangent, *unknowns_, pair.vector));
    values.push_back(pair.value);
    error.push_back(pair.error);
  }
  if (stability.symmetric) {
    std::vector<double> form = weights;
    if (m > 0 && zero > 0.0 && error.front() > stability_limit.rounding_matters * zero) {
      form = second_variations(tangent, found, pairs);
      for (double& e : error) e = std::min(e, stability_limit.variation_error * zero);
    } else {
      for (int i = 0; i < m; ++i) {
        for (int j = 0; j < m; ++j) form[i + j * m] = of_cap(found[i], found[j]);
        form[i * (m + 1)] += values[i];
      }
    }
    weights = small_eigenproblem(form, m);
    for (int i = 0; i < m; ++i) values[i] = form[i * (m + 1)];
  } else {
    for (int i = 0; i < m; ++i) {
      weights[i * (m + 1)] = 1.0;
      const double overlap =
          number_of_root(unknowns_->root(), [&] { return dot_product(pairs[i].left, pairs[i].vector); });
      values[i] += of_cap(complete_motion(tangent, *unknowns_, pairs[i].left), found[i]) / overlap;
    }
  }
  std::vector<int> order(m);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(values[a]) < std::abs(values[b]); });
  std::vector<EigenMode> modes;
  for (int k : order) {
    MixedVector mode = combination(found, &weights[static_cast<size_t>(k) * m]);
    normalize_mode(model, mode);
    modes.push_back({values[k], std::move(mode), error[k], pairs[k].converged});
  }
  return modes;
}

int SpaceValues::negative() const {
  return static_cast<int>(
      std::count_if(modes.begin(), modes.end(), [](const EigenMode& mode) { return mode.eigenvalue < 0.0; }));
}

CriticalSpace Stability::space_of(const State& state, double load_factor, int first, int count) {
  constexpr int kMore = 2;  // negative ones may be nearer to zero than the wanted ones
  const StabilityResult result = inertia(assemble(state, load_factor));
  if (!result.symmetric) return {};
  Pairs pairs = nearest(result, count + kMore, stability_limit.rough_modes);
  CriticalSpace space;
  for (int place : places_of(pairs, result, first, count)) space.vectors.push_back(std::move(pairs[place].vector));
  space.size = static_cast<int>(space.vectors.size());
  return space.size == count ? space : CriticalSpace{};
}

/// Rayleigh-Ritz in K^-p B, theory (60), with the factors kept by inertia().
Stability::Pairs Stability::ritz_values(const StabilityResult& stability, const CriticalSpace& space) {
  const size_t m = space.size;
  Pairs pairs;
  on_root(unknowns_->root(), [&] {
    const size_t n = unknowns_->count();
    std::vector<std::vector<double>> columns = space.vectors, images;
    for (int i = 0; i < kSpaceIterations; ++i) {
      images = columns;
      std::vector<double> block;
      for (const std::vector<double>& x : columns) block.insert(block.end(), x.begin(), x.end());
      solver(stability).solve(block.data(), space.size);
      for (size_t j = 0; j < m; ++j) columns[j].assign(&block[j * n], &block[j * n] + n);
      orthonormalize(columns, images);
    }
    std::vector<double> projected(m * m);
    for (size_t i = 0; i < m; ++i)
      for (size_t j = 0; j < m; ++j) projected[i + j * m] = dot_product(columns[i], images[j]);
    const std::vector<double> weights = small_eigenproblem(projected, space.size);
    for (size_t k = 0; k < m; ++k) {
      std::vector<double> y(n, 0.0);
      for (size_t j = 0; j < m; ++j)
        for (size_t i = 0; i < n; ++i) y[i] += weights[j + k * m] * columns[j][i];
      const double error = rounding_level(unknowns_->matrix(), y);
      pairs.push_back({projected[k * (m + 1)] - stability.shift, error, true, std::move(y)});
    }
  });
  share(pairs);
  return pairs;
}

SpaceValues Stability::in_space(const State& state, double load_factor, const CriticalSpace& space) {
  const Look look = assemble(state, load_factor);
  const StabilityResult stability = inertia(look);
  if (!stability.symmetric) return {};
  const Pairs pairs = ritz_values(stability, space);
  SpaceValues seen{corrected_modes(look, stability, pairs), stability.negative - number_counted(pairs, stability)};
  std::stable_sort(seen.modes.begin(), seen.modes.end(),
                   [](const EigenMode& a, const EigenMode& b) { return a.eigenvalue < b.eigenvalue; });
  return seen;
}

}  // namespace mixbeam
