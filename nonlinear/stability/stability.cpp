#include "nonlinear/stability/stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

namespace mixbeam {

namespace {

/// Rounding leaves 1e-13 in refined meshes, an unfinished Newton iteration 1e-11; asymmetry this small changes
/// eigenvalues by its square.
constexpr double kSymmetric = 1e-9;
/// A Ritz value is real when its imaginary part is rounding.
constexpr double kReal = 1e-8;
/// Where a pivot is zero the inverse is taken beside it; eigenvalues of structures are far larger.
constexpr double kShift = 1e-7;
/// Raises of the usual cap. Where eigenvalues are only counted it lowers a critical load by about 1e-7 of it; modes are
/// corrected to the true stiffness, so that the usual cap, which leaves less of rounding, serves them best.
///
/// Where the stresses, N L^2/EI or M L/EI with the largest EI of the structure, are below one and so is the stiffness
/// of the structure, as that of a stiff column on a soft spring, the cap is lower in proportion: what is 1e7 times as
/// stiff is as good as rigid, and stiffnesses far above would drown those that decide in their rounding.
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
/// Below this share of them an eigenvalue is looked at: the cap shifts it by 1e-7, and that of what chains leave is a
/// few dozen times larger.
constexpr double kNearZero = 1e-4;
/// The same as a multiple of rounding errors.
constexpr double kNearRounding = 100.0;
/// Modes looked at there: at first, and at most. More zero eigenvalues than this are those of a mechanism.
constexpr int kFirstNull = 4, kMostNull = 16;
/// Where rounding leaves less of an eigenvalue than this share of what counts as zero, its critical load is known to
/// ten digits.
constexpr double kRoundingMatters = 0.1;
/// Motion (largest rotation, or displacement over the length) of the largest of the differences below, and these: parts
/// of it and their weights, which leave an error of its sixth power over 64 * 7!. Rounding is multiplied by 200.
constexpr double kDifferenceMotion = 1.0 / 32.0;
constexpr std::array<std::array<double, 2>, 3> kDifferences = {
    {{1.0, 1.0 / 45.0}, {0.5, -20.0 / 45.0}, {0.25, 64.0 / 45.0}}};
/// What is left of an error, of what counts as zero: states are equilibria to 1e-11.
constexpr double kVariationError = 1e-2;
/// Rotations of Jacobi's method: sweeps, of which five are enough.
constexpr int kSweeps = 20;
/// Inverse iterations from an arbitrary vector: next to zero each gains many digits.
constexpr int kInverseIterations = 3;

/// Residuals of modes as results, and of those that only span a space.
constexpr double kExactModes = 1e-9, kRoughModes = 1e-2;

/// Inverse iterations with the vectors of a space before eigenvalues are taken in it.
constexpr int kSpaceIterations = 2;

bool is_real(const RitzPair& pair) { return std::abs(pair.imaginary) <= kReal * std::abs(pair.value); }

SparseMatrix shifted(SparseMatrix matrix, double shift) {
  for (int i = 0; i < matrix.rows(); ++i)
    for (int k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k)
      if (matrix.column[k] == i) matrix.value[k] += shift;
  return matrix;
}

double dot_product(const std::vector<double>& x, const std::vector<double>& y) {
  return std::inner_product(x.begin(), x.end(), y.begin(), 0.0);
}

/// What the rounding of the entries of A may change in y . A y, for y of unit length.
double rounding_level(const SparseMatrix& a, const std::vector<double>& y) {
  double sum = 0.0;
  for (int i = 0; i < a.rows(); ++i)
    for (int k = a.row_start[i]; k < a.row_start[i + 1]; ++k)
      sum += std::abs(y[i]) * std::abs(a.value[k]) * std::abs(y[a.column[k]]);
  return std::numeric_limits<double>::epsilon() * sum;
}

/// The size of the eigenvalue of A nearest to zero, not below it, and the rounding in it, by inverse iteration.
std::pair<double, double> nearest_to_zero(const SparseMatrix& a, InertiaSolver& solver) {
  std::vector<double> y(a.rows());
  for (int i = 0; i < a.rows(); ++i) y[i] = 1.0 + 0.5 * std::sin(1.0 + i);  // parallel to no mode
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

}  // namespace

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

namespace {

int sign_of(int negative, int null) { return null > 0 ? 0 : (negative % 2 == 0 ? 1 : -1); }

}  // namespace

Stability::Stability(BeamProblem& problem) : problem_(problem) {}

/// With a cap at which no pivot inside an element is zero, if there is one.
Stability::Look Stability::evaluate_tangent(const State& state, double load_factor, double raise) {
  const Model& model = problem_.model;
  const Structure& structure = model.structure();
  const StateMagnitude size = magnitude_of(model, state, load_factor);
  const double stress =
      structure.length / structure.bending_reference * std::max(size.force * structure.length, size.moment);
  const double share = stress >= kSmallStress ? std::min(1.0, stress) : std::max(stress, softness());
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
double Stability::softness() {
  if (softness_) return *softness_;
  const Model& model = problem_.model;
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, model.reference_state(), 0.0, residual);
  const RootResult root = factorized_beside_chains({Tangent(model, point, cap_for(model, point.scales), {true}), {}});
  double size = root.is_reliable ? root.nearest : 0.0;
  MPI_Bcast(&size, 1, MPI_DOUBLE, 0, unknowns_beside_chains_->root().communicator());
  softness_ = std::clamp(size, kLeastCapShare, 1.0);
  return *softness_;
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

void Stability::look_for_zero(const SparseMatrix& matrix, const Solvers& solvers, double zero, RootResult& root) {
  if (matrix.rows() == 0 || root.result.null > 0 || !root.result.symmetric) return;
  const auto [size, rounding] = nearest_to_zero(matrix, *solvers.symmetric);
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
    look_for_zero(matrix, beside_chains_, look.zero, root);
  });
  long negative = chains_->negative_pivots();
  MPI_Allreduce(MPI_IN_PLACE, &reliable, 1, MPI_INT, MPI_MIN, copy.communicator());
  MPI_Allreduce(MPI_IN_PLACE, &negative, 1, MPI_LONG, MPI_SUM, copy.communicator());
  root = completed(root, copy.communicator(), look, negative);
  root.is_reliable = reliable == 1;
  return root;
}

/// Size of the eigenvalue nearest to zero of the whole tangent, not below it, by inverse iteration with the factors of
/// chains and of what they leave: a mode may live in the chains alone.
double Stability::nearest_with_chains(const Tangent& tangent) {
  const Model& model = tangent.model();
  const Structure& structure = model.structure();
  const IndependentUnknowns& remaining = *unknowns_beside_chains_;
  DofVector x(model.map()), b(model.map());
  DofVector remaining_b(chains_->matrix()->getRowMap()), remaining_x(chains_->matrix()->getRowMap());
  const size_t rows = MixedVector::view_of(x).extent(0);
  const double L = structure.length, share = structure.bending_reference / (L * model.mesh().vertices());
  const auto weight = [&](size_t i) { return i % kVertexDofs < 3 ? share / (L * L) : share; };
  const auto length_of = [&](const DofVector& v, bool is_force) {
    const KernelView<const double*> values = MixedVector::view_of(v);
    double sum = 0.0;
    for (size_t i = 0; i < rows; ++i) sum += values(i) * values(i) * (is_force ? 1.0 / weight(i) : weight(i));
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, remaining.root().communicator());
    return std::sqrt(sum);
  };
  for (size_t i = 0; i < rows; ++i)
    MixedVector::view_of(x)(i) = 1.0 + 0.5 * std::sin(1.0 + model.map()->getGlobalElement(i));
  double size = HUGE_VAL;
  for (int step = 0; step < kInverseIterations; ++step) {
    const double scale = 1.0 / length_of(x, false);
    for (size_t i = 0; i < rows; ++i) MixedVector::view_of(b)(i) = scale * weight(i) * MixedVector::view_of(x)(i);
    tangent.project_on_free_motions(MixedVector::view_of(b));
    const double force = length_of(b, true);
    chains_->condense_rows(b, remaining_b, x);
    std::vector<double> y = remaining.reduced_remaining_rows(remaining_b);
    on_root(remaining.root(), [&] {
      if (!y.empty()) beside_chains_.symmetric->solve(y.data(), 1);
    });
    remaining.expand(y.data(), remaining_x);
    chains_->expand(remaining_x, x);
    size = force / length_of(x, false);
  }
  return size;
}

/// None where the signs of pivots cannot be relied on, next to a critical point.
std::optional<StabilityResult> Stability::inertia_with_chains(const Look& look) {
  const RootResult root = factorized_beside_chains(look);
  if (!root.is_reliable || root.is_near_zero || root.result.null > 0 || look.interior.uncertain) return std::nullopt;
  if (root.result.symmetric && !(nearest_with_chains(look.tangent) > kNearZero / kZero * look.zero))
    return std::nullopt;
  return root.result;
}

/// Leaves the factors of the tangent, or of what lies beside it where a pivot is zero.
StabilityResult Stability::inertia(const Look& look) {
  RootResult root;
  on_root(unknowns_->root(), [&] {
    root = factorized(unknowns_->matrix(), all_);
    if (root.result.null > 0) solver(root.result).factorize(shifted(unknowns_->matrix(), kShift));
  });
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
  double compliance = 0.0;
  on_root(unknowns_->root(), [&] {
    std::vector<double> moved = row;
    solver(result).solve(moved.data(), 1);
    compliance = dot_product(row, moved);
  });
  MPI_Bcast(&compliance, 1, MPI_DOUBLE, 0, unknowns_->root().communicator());
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

/// Uses the factors that inertia() left.
Stability::Reduced Stability::nearest(const StabilityResult& stability, int count, double tolerance) {
  Reduced reduced;
  on_root(unknowns_->root(), [&] {
    InertiaSolver& factors = solver(stability);
    const double shift = stability.null > 0 ? kShift : 0.0;
    KrylovProblem problem;
    problem.unknowns = unknowns_->count();
    problem.symmetric = stability.symmetric;
    problem.tolerance = tolerance;
    problem.apply = [&](double* block, int columns) { factors.solve(block, columns); };
    std::vector<RitzPair> right = largest_eigenpairs(problem, count);
    right.erase(std::remove_if(right.begin(), right.end(), [](const RitzPair& p) { return !is_real(p); }), right.end());
    for (const RitzPair& pair : right) {
      reduced.eigenvalue.push_back(1.0 / pair.value - shift);
      reduced.error.push_back(pair.error / std::abs(pair.value) + rounding_level(unknowns_->matrix(), pair.vector));
      reduced.converged.push_back(pair.converged ? 1 : 0);
      reduced.vector.push_back(pair.vector);
    }
    if (stability.symmetric) return;
    problem.apply = [&](double* block, int columns) { factors.solve(block, columns, true); };
    const std::vector<RitzPair> left = largest_eigenpairs(problem, count);
    for (const RitzPair& pair : right)
      reduced.left.push_back(std::min_element(left.begin(), left.end(), [&](const RitzPair& a, const RitzPair& b) {
                               return std::abs(a.value - pair.value) < std::abs(b.value - pair.value);
                             })->vector);
    for (size_t i = 0; i < right.size(); ++i)
      reduced.error[i] /= std::max(kReal, std::abs(dot_product(reduced.left[i], reduced.vector[i])));
  });
  MPI_Comm communicator = unknowns_->root().communicator();
  int found = static_cast<int>(reduced.eigenvalue.size());
  MPI_Bcast(&found, 1, MPI_INT, 0, communicator);
  reduced.eigenvalue.resize(found);
  reduced.error.resize(found);
  reduced.converged.resize(found);
  reduced.vector.resize(found);
  if (!stability.symmetric) reduced.left.resize(found);
  MPI_Bcast(reduced.eigenvalue.data(), found, MPI_DOUBLE, 0, communicator);
  MPI_Bcast(reduced.error.data(), found, MPI_DOUBLE, 0, communicator);
  MPI_Bcast(reduced.converged.data(), found, MPI_INT, 0, communicator);
  return reduced;
}

Spectrum Stability::spectrum(const State& state, double load_factor, int count) {
  const Look look = assemble(state, load_factor);
  Spectrum result{inertia(look), {}};
  const Reduced reduced = nearest(result.stability, count, kExactModes);
  result.modes = corrected_modes(look, result.stability, reduced);
  if (result.stability.symmetric)
    recount(reduced, look.zero, result);
  else
    recount_unsymmetric(result);
  return result;
}

/// Eigenvalues as corrected in place of those of the capped tangent, and those that are zero apart.
void Stability::recount(const Reduced& reduced, double zero, Spectrum& spectrum) {
  StabilityResult& stability = spectrum.stability;
  if (std::any_of(reduced.converged.begin(), reduced.converged.end(), [](int c) { return c == 0; })) return;
  for (double before : reduced.eigenvalue) stability.negative -= before < 0.0 ? 1 : 0;
  stability.negative = std::max(0, stability.negative);  // rounding may turn the sign of an inverse
  stability.null = 0;
  for (const EigenMode& mode : spectrum.modes) {
    if (std::abs(mode.eigenvalue) <= std::max(zero, mode.error))
      ++stability.null;
    else if (mode.eigenvalue < 0.0)
      ++stability.negative;
  }
  stability.sign = sign_of(stability.negative, stability.null);
}

/// The real eigenvalues known to be negative; the sign of the determinant tells whether one is missing.
void Stability::recount_unsymmetric(Spectrum& spectrum) {
  StabilityResult& stability = spectrum.stability;
  stability.negative = 0;
  for (const EigenMode& mode : spectrum.modes)
    if (mode.eigenvalue < -mode.error) ++stability.negative;
  const bool is_odd = stability.negative % 2 == 1;
  if (stability.sign != 0 && is_odd != (stability.sign < 0)) ++stability.negative;
}

namespace {

/// Eigenvalues (the diagonal afterwards) and eigenvectors (columns of the result) of a symmetric matrix of m rows by
/// Jacobi's rotations: small eigenvalues keep their digits beside large ones.
std::vector<double> small_eigenproblem(std::vector<double>& a, int m) {
  std::vector<double> vectors(a.size(), 0.0);
  for (int i = 0; i < m; ++i) vectors[i * (m + 1)] = 1.0;
  const auto at = [m](std::vector<double>& x, int i, int j) -> double& { return x[i + static_cast<size_t>(j) * m]; };
  bool rotated = true;
  for (int sweep = 0; rotated && sweep < kSweeps; ++sweep) {
    rotated = false;
    for (int p = 0; p < m; ++p)
      for (int q = p + 1; q < m; ++q) {
        const double beside = at(a, p, q), size = std::sqrt(std::abs(at(a, p, p) * at(a, q, q)));
        if (!(std::abs(beside) > std::numeric_limits<double>::epsilon() * size)) continue;
        rotated = true;
        const double half = 0.5 * (at(a, q, q) - at(a, p, p));
        const double t = beside / (half + std::copysign(std::hypot(half, beside), half));
        const double c = 1.0 / std::hypot(1.0, t), s = t * c;
        for (int k = 0; k < m; ++k) {
          const double x = at(a, k, p), y = at(a, k, q), v = at(vectors, k, p), w = at(vectors, k, q);
          at(a, k, p) = c * x - s * y;
          at(a, k, q) = s * x + c * y;
          at(vectors, k, p) = c * v - s * w;
          at(vectors, k, q) = s * v + c * w;
        }
        for (int k = 0; k < m; ++k) {
          const double x = at(a, p, k), y = at(a, q, k);
          at(a, p, k) = c * x - s * y;
          at(a, q, k) = s * x + c * y;
        }
        at(a, p, q) = at(a, q, p) = 0.0;
      }
  }
  return vectors;
}

/// Derivative of the equations of equilibrium, unscaled, by differences of the residual, which holds compliances and no
/// stiffness: nothing large is there to drown what is small. Rows of N and M are zero.
MixedVector derivative_along(const Model& model, const State& state, double load_factor, const MixedVector& motion) {
  const Structure& structure = model.structure();
  const LargestParts size = largest_parts(*model.map()->getComm(), motion.vertex());
  const double unit = kDifferenceMotion / std::max(size.moved / structure.length, size.turned);
  MixedVector sum = model.create_vector(), rows = model.create_vector();
  for (const auto& [part, weight] : kDifferences)
    for (double step : {part * unit, -part * unit}) {
      const EvaluationPoint point = mixed_residual(model, model.apply(state, motion, step), load_factor, rows);
      unscale_rows(model, point.scales, rows);
      sum.update(0.5 * weight / step, rows, 1.0);
    }
  const KernelView<double*> interior = sum.writable_interior(true);
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count; ++e) {
      double* first = &interior(block.increment_offset + static_cast<size_t>(e) * block.interior.increments());
      std::fill(first, first + block.interior.relative_rotation(1), 0.0);
    }
  return sum;
}

}  // namespace

/// Of the mixed potential in motions that complete_motion() made of the vectors of `reduced`, as a matrix; symmetric
/// tangents only. Their rows of N and M are solved with the compliance of the tangent, which leaves that of the cap.
std::vector<double> Stability::second_variations(const Tangent& tangent, const std::vector<MixedVector>& motions,
                                                 const Reduced& reduced) const {
  const int m = static_cast<int>(motions.size());
  const Model& model = tangent.model();
  const EvaluationPoint& point = tangent.point();
  std::vector<double> form(static_cast<size_t>(m) * m, 0.0), of_vertices(form.size(), 0.0);
  for (int j = 0; j < m; ++j) {
    const MixedVector derivative = derivative_along(model, point.state, point.load_factor, motions[j]);
    const std::vector<double> rows = unknowns_->reduced_rows(derivative.vertex_dofs());
    derivative.vertex_dofs().putScalar(0.0);
    for (int i = 0; i < m; ++i) {
      if (unknowns_->is_root()) of_vertices[i + static_cast<size_t>(j) * m] = dot_product(reduced.vector[i], rows);
      form[i + static_cast<size_t>(j) * m] =
          motions[i].inner_product(derivative) + cap_compliance_form(model, tangent.cap(), motions[i], motions[j]);
    }
  }
  MPI_Bcast(of_vertices.data(), m * m, MPI_DOUBLE, 0, unknowns_->root().communicator());
  for (size_t i = 0; i < form.size(); ++i) of_vertices[i] += form[i];
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) form[i + j * m] = 0.5 * (of_vertices[i + j * m] + of_vertices[j + i * m]);
  return form;
}

/// Rayleigh-Ritz in the modes found, with the true compliance: degenerate modes separate as they should.
std::vector<EigenMode> Stability::corrected_modes(const Look& look, const StabilityResult& stability,
                                                  const Reduced& reduced) {
  const Model& model = problem_.model;
  const Tangent& tangent = look.tangent;
  const double zero = look.zero;
  const auto of_cap = [&](const MixedVector& a, const MixedVector& b) {
    return cap_compliance_form(model, tangent.cap(), a, b);
  };
  const int m = static_cast<int>(reduced.eigenvalue.size());
  std::vector<MixedVector> found;
  for (const std::vector<double>& y : reduced.vector) found.push_back(complete_motion(tangent, *unknowns_, y));
  std::vector<double> values = reduced.eigenvalue, error = reduced.error, weights(static_cast<size_t>(m) * m, 0.0);
  if (stability.symmetric) {
    std::vector<double> form = weights;
    if (m > 0 && zero > 0.0 && error.front() > kRoundingMatters * zero) {
      form = second_variations(tangent, found, reduced);
      for (double& e : error) e = std::min(e, kVariationError * zero);
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
      double overlap = 0.0;
      if (unknowns_->is_root()) overlap = dot_product(reduced.left[i], reduced.vector[i]);
      MPI_Bcast(&overlap, 1, MPI_DOUBLE, 0, unknowns_->root().communicator());
      values[i] += of_cap(complete_motion(tangent, *unknowns_, reduced.left[i]), found[i]) / overlap;
    }
  }
  std::vector<int> order(m);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(values[a]) < std::abs(values[b]); });
  std::vector<EigenMode> modes;
  for (int k : order) {
    MixedVector mode = combination(found, &weights[static_cast<size_t>(k) * m]);
    normalize_mode(model, mode);
    modes.push_back({values[k], std::move(mode), error[k], reduced.converged[k] != 0});
  }
  return modes;
}

namespace {

int number_below_zero(const std::vector<double>& values) {
  return static_cast<int>(std::count_if(values.begin(), values.end(), [](double v) { return v < 0.0; }));
}

/// Places of the eigenvalues number first .. first + count - 1 among those found, of which `negative` lie below zero.
std::vector<int> places_of(const std::vector<double>& found, int negative, int first, int count) {
  std::vector<int> order(found.size()), places;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return found[a] < found[b]; });
  const int lowest = negative - number_below_zero(found);
  for (int k = first - 1 - lowest; k < first - 1 - lowest + count; ++k)
    if (k >= 0 && k < static_cast<int>(order.size())) places.push_back(order[k]);
  return places;
}

}  // namespace

int SpaceValues::negative() const {
  return static_cast<int>(
      std::count_if(modes.begin(), modes.end(), [](const EigenMode& mode) { return mode.eigenvalue < 0.0; }));
}

CriticalSpace Stability::space_of(const State& state, double load_factor, int first, int count) {
  constexpr int kMore = 2;  // negative ones may be nearer to zero than those that come next
  const StabilityResult result = inertia(assemble(state, load_factor));
  if (!result.symmetric) return {};
  Reduced reduced = nearest(result, count + kMore, kRoughModes);
  CriticalSpace space;
  for (int place : places_of(reduced.eigenvalue, result.negative, first, count))
    space.vectors.push_back(std::move(reduced.vector[place]));
  space.size = static_cast<int>(space.vectors.size());
  return space.size == count ? space : CriticalSpace{};
}

namespace {

/// Gram-Schmidt, twice for its rounding; `images` are those under a linear operator and stay so.
void orthonormalize(std::vector<std::vector<double>>& columns, std::vector<std::vector<double>>& images) {
  const auto add = [](double a, const std::vector<double>& x, std::vector<double>& y) {
    for (size_t i = 0; i < x.size(); ++i) y[i] += a * x[i];
  };
  for (size_t j = 0; j < columns.size(); ++j) {
    for (int pass = 0; pass < 2; ++pass) {
      const double scale = 1.0 / std::sqrt(dot_product(columns[j], columns[j]));
      for (std::vector<double>* v : {&columns[j], &images[j]})
        for (double& x : *v) x *= scale;
      for (size_t i = 0; i < j; ++i) {
        const double share = -dot_product(columns[i], columns[j]);
        add(share, columns[i], columns[j]);
        add(share, images[i], images[j]);
      }
    }
    const double scale = 1.0 / std::sqrt(dot_product(columns[j], columns[j]));
    for (std::vector<double>* v : {&columns[j], &images[j]})
      for (double& x : *v) x *= scale;
  }
}

}  // namespace

/// Rayleigh-Ritz in K^-p B, theory (60), with the factors that inertia() left.
Stability::Reduced Stability::ritz_values(const StabilityResult& stability, const CriticalSpace& space) {
  const size_t m = space.size;
  Reduced reduced;
  reduced.eigenvalue.assign(m, 0.0);
  reduced.error.assign(m, 0.0);
  reduced.converged.assign(m, 1);
  reduced.vector.resize(m);
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
    const double shift = stability.null > 0 ? kShift : 0.0;
    for (size_t k = 0; k < m; ++k) {
      reduced.eigenvalue[k] = projected[k * (m + 1)] - shift;
      reduced.vector[k].assign(n, 0.0);
      for (size_t j = 0; j < m; ++j)
        for (size_t i = 0; i < n; ++i) reduced.vector[k][i] += weights[j + k * m] * columns[j][i];
      reduced.error[k] = rounding_level(unknowns_->matrix(), reduced.vector[k]);
    }
  });
  for (std::vector<double>* values : {&reduced.eigenvalue, &reduced.error})
    MPI_Bcast(values->data(), space.size, MPI_DOUBLE, 0, unknowns_->root().communicator());
  return reduced;
}

SpaceValues Stability::in_space(const State& state, double load_factor, const CriticalSpace& space) {
  const Look look = assemble(state, load_factor);
  const StabilityResult stability = inertia(look);
  if (!stability.symmetric) return {};
  const Reduced reduced = ritz_values(stability, space);
  SpaceValues seen{corrected_modes(look, stability, reduced),
                   stability.negative - number_below_zero(reduced.eigenvalue)};
  std::stable_sort(seen.modes.begin(), seen.modes.end(),
                   [](const EigenMode& a, const EigenMode& b) { return a.eigenvalue < b.eigenvalue; });
  return seen;
}

}  // namespace mixbeam
