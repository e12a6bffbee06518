#include "nonlinear/stability/vibration.hpp"

#include "discretization/assembly/masses.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/linear/krylov.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/stability/block_krylov.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace mixbeam {

namespace {

/// Modes beyond those asked for: the count needs a gap behind them.
constexpr int kModesBehind = 2;
/// Columns of a block at least: six rigid motions share one eigenvalue.
constexpr int kLeastBlock = 6, kBlocksOfModes = 4;
/// The shift over the lowest omega^2 that is not zero: within these rigid motions and elastic modes keep their digits
/// (rigid omega^2 at 1e-18 of the first elastic one).
constexpr double kLeastShift = 1e-3, kMostShift = 1.0, kShift = 0.03;
constexpr int kMostShifts = 4;
/// omega^2 over the shift below which a motion is rigid: rounding leaves 1e-20.
constexpr double kRigid = 1e-12;
/// Eigenvalues 1 / (omega^2 + shift) below this share of the largest one are those of motions without mass.
constexpr double kMassless = 1e-13;
/// The cap is taken out of each solution, so that a low one, which leaves less of rounding, serves best: 3e-12 times cap
/// times elements of a mode, whose square is the error of omega^2. Counts keep the cap: it lowers omega^2 by 3e-5 there.
constexpr double kCapOfVibration = 1e-2, kGap = 2e-4;
/// What is left of the cap in a solution, and solves that may take: two as a rule.
constexpr double kCapLeft = 1e-14;
constexpr int kMostCapSolves = 12;
/// Rounding of a solve beyond which it is refined, and refused: share of the sum of the terms of a row.
constexpr double kRefined = 1e-14, kRefused = 1e-9;

class Vibration {
 public:
  Vibration(BeamProblem& problem, const State& state, double load_factor, bool in_plane)
      : model_(problem.model),
        state_(state),
        in_plane_(in_plane && problem.model.plane().has_value()),
        residual_(model_.create_vector()),
        point_(mixed_residual(model_, state, load_factor, residual_)),
        unknowns_(model_),
        masses_(model_, in_plane_) {}

  std::vector<VibrationMode> modes(int count) {
    require_potential();
    const int wanted = count + kModesBehind;
    double shift = first_shift();
    std::vector<VibrationMode> found;
    for (int i = 0; i < kMostShifts; ++i) {
      factorize(shift, kCapOfVibration, false);
      found.clear();
      for (const RitzPair& pair : ritz_pairs(wanted)) found.push_back(completed(pair));
      const double lowest = lowest_elastic(found, shift);
      if (lowest == 0.0 || (shift >= kLeastShift * lowest && shift <= kMostShift * lowest)) break;
      shift = kShift * lowest;
    }
    std::stable_sort(found.begin(), found.end(), [](const VibrationMode& a, const VibrationMode& b) {
      return a.pair.eigenvalue < b.pair.eigenvalue;
    });
    confirm(found, count, wanted);
    if (static_cast<int>(found.size()) > count) found.resize(count, found.front());
    return found;
  }

 private:
  void require_potential() const {
    for (const ElementBlock& block : model_.structure().blocks)
      for (int e = 0; e < block.count; ++e)
        if (block.is_unsymmetric(e)) refuse_loads();
  }
  [[noreturn]] static void refuse_loads() {
    throw LinearSolverError("modes need loads with a potential: dead forces, prescribed motions, no follower loads");
  }

  /// EI/(m L^4) of the largest stiffness and the mean mass.
  double first_shift() {
    linearize(0.0, kCapOfVibration, false);
    double mass = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      translation_[axis] = masses_.translation(state_, axis);
      mass = std::max(mass, dot_product(translation_[axis], translation_[axis]));
    }
    outside_ =
        unknowns_.reduce(*tangent_, [&](const VertexMatrix& matrix) { masses_.gather_outside(*tangent_, matrix); });
    if (!(mass > 0.0)) throw LinearSolverError("modes need a mass: no section and no point has any");
    const double L = model_.structure().length;
    return model_.structure().bending_reference / (mass * L * L * L);
  }

  static double lowest_elastic(const std::vector<VibrationMode>& found, double shift) {
    double lowest = 0.0;
    for (const VibrationMode& mode : found) {
      const double size = std::abs(mode.pair.eigenvalue);
      if (size > kRigid * shift && (lowest == 0.0 || size < lowest)) lowest = size;
    }
    return lowest;
  }

  void linearize(double shift, double raise, bool counts) {
    tangent_.reset();
    tangent_.emplace(model_, point_, cap_for(model_, point_.scales, raise), TangentKind{true, false});
    masses_.condense(*tangent_, shift, counts);
  }

  /// K + shift M with what is inside of elements condensed; its negative eigenvalues, -1 where they are uncertain.
  long factorize(double shift, double raise, bool counts) {
    linearize(shift, raise, counts);
    unknowns_.reduce(*tangent_, [&](const VertexMatrix& matrix) { masses_.gather(*tangent_, shift, matrix); });
    double negative = number_of_root(unknowns_.root(), [&] {
      const SparseMatrix& matrix = unknowns_.matrix();
      if (matrix.rows() == 0) return 0.0;
      if (asymmetry(matrix) > stability_limit.symmetric) return -2.0;
      if (solver_ == nullptr) solver_ = std::make_unique<InertiaSolver>(InertiaSolver::Kind::symmetric, matrix);
      return static_cast<double>(solver_->factorize(matrix).negative);
    });
    if (negative == -2.0) refuse_loads();
    if (!counts) return static_cast<long>(negative);
    const Tangent::InteriorCount interior = masses_.interior_count();
    return interior.uncertain ? -1 : static_cast<long>(negative) + interior.negative;
  }

  /// A motion, and its independent unknowns (rank 0).
  struct Response {
    MixedVector motion;
    std::vector<double> y{};

    void add(double factor, const Response& other) {
      motion.update(factor, other.motion, 1.0);
      add_multiple(factor, other.y, y);
    }
  };

  /// Under rows that condense_momenta() or condense_interior() gathered, of the capped stiffness.
  Response solve(const MixedVector& rows) {
    const MixedVector& projected = rows;
    tangent_->project_on_free_motions(projected.vertex());
    std::vector<double> y = unknowns_.reduced_rows(projected.vertex_dofs());
    on_root(unknowns_.root(), [&] { solve_reduced(y); });
    Response response{model_.create_vector(), std::move(y)};
    unknowns_.expand(response.y.data(), response.motion.vertex_dofs());
    masses_.recover(rows, response.motion);
    return response;
  }

  void solve_reduced(std::vector<double>& y) {
    if (y.empty()) return;
    const std::vector<double> given = y;
    solver_->solve(y.data(), 1);
    for (int pass = 0;; ++pass) {
      std::vector<double> left = given;
      const double error = rest(y, left);
      if (error <= kRefined) return;
      if (pass > 0 && !(error <= kRefused))
        throw LinearSolverError("the equations of vibration were not solved: backward error " + shortest(error));
      if (pass > 0) return;
      solver_->solve(left.data(), 1);
      add_multiple(1.0, left, y);
    }
  }
  /// given - K y; its size, over the largest sum of the terms of a row.
  double rest(const std::vector<double>& y, std::vector<double>& given) const {
    const SparseMatrix& matrix = unknowns_.matrix();
    double largest = 0.0, size = 0.0;
    for (int i = 0; i < matrix.rows(); ++i) {
      double sum = std::abs(given[i]);
      for (int k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k) {
        const double term = matrix.value[k] * y[matrix.column[k]];
        given[i] -= term;
        sum += std::abs(term);
      }
      largest = std::max(largest, std::abs(given[i]));
      size = std::max(size, sum);
    }
    return largest == 0.0 ? 0.0 : largest / size;
  }

  /// (K + shift M)^-1 G^T times momenta, of the true stiffness: what the cap leaves out is solved for as in theory
  /// (38), g = E x with x = x_0 + S g.
  Response respond(const double* momenta) {
    MixedVector rows = model_.create_vector();
    masses_.condense_momenta(state_, momenta, rows);
    Response found = solve(rows);
    if (!tangent_->cap().cuts_off) return found;
    std::vector<MixedVector> basis;
    std::vector<Response> responses;
    basis.push_back(found.motion.clone(false));
    masses_.excess_rows(found.motion, basis.front());
    const double beta = norm_of(basis.front());
    if (!(beta > 0.0) || !std::isfinite(beta)) return found;
    const GmresResult left_out =
        gmres(basis, beta, kCapLeft, kMostCapSolves, [&](const MixedVector& of, MixedVector& next) {
          MixedVector given = of.clone(true);
          masses_.condense_interior(given);
          responses.push_back(solve(given));
          masses_.excess_rows(responses.back().motion, next);
          next.update(1.0, of, -1.0);
          return true;
        });
    for (size_t k = 0; k < left_out.y.size(); ++k) found.add(left_out.y[k], responses[k]);
    return found;
  }

  std::vector<RitzPair> ritz_pairs(int wanted) {
    KrylovProblem eigen;
    eigen.unknowns = masses_.momenta();
    eigen.width = std::max(kLeastBlock, (wanted + kBlocksOfModes - 1) / kBlocksOfModes);
    eigen.apply = [&](double* block, int columns) {
      for (int j = 0; j < columns; ++j) {
        double* own = block + static_cast<size_t>(j) * masses_.momenta();
        const std::vector<double> image = masses_.momenta_of(state_, respond(own).motion);
        std::copy(image.begin(), image.end(), own);
      }
    };
    std::vector<RitzPair> pairs = largest_eigenpairs(eigen, wanted);
    double largest = 0.0;
    for (const RitzPair& pair : pairs) largest = std::max(largest, std::abs(pair.value));
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                               [&](const RitzPair& pair) { return !(std::abs(pair.value) > kMassless * largest); }),
                pairs.end());
    return pairs;
  }

  /// One more solution makes the mode, and its Rayleigh quotient the eigenvalue: with compliances in place of
  /// stiffnesses, in whose rounding small eigenvalues would be lost.
  VibrationMode completed(const RitzPair& pair) {
    Response found = respond(pair.vector.data());
    VibrationMode mode{{0.0, std::move(found.motion)}, 0.0, {}};
    std::vector<double> momenta = masses_.momenta_of(state_, mode.pair.mode);
    const double outside = number_of_root(unknowns_.root(), [&] {
      std::vector<double> force(found.y.size());
      outside_.multiply(found.y.data(), force.data());
      return dot_product(found.y, force);
    });
    mode.pair.eigenvalue = (masses_.stiffness_form(mode.pair.mode) + outside) / dot_product(momenta, momenta);
    mode.pair.error = pair.residual;
    normalize_mode(model_, mode.pair.mode);
    momenta = masses_.momenta_of(state_, mode.pair.mode);
    mode.modal_mass = dot_product(momenta, momenta);
    for (int axis = 0; axis < 3; ++axis)
      mode.participation[axis] = dot_product(momenta, translation_[axis]) / mode.modal_mass;
    return mode;
  }

  /// Counts what lies below a gap behind the modes asked for.
  void confirm(std::vector<VibrationMode>& found, int count, int wanted) {
    const auto value = [&](int i) { return found[i].pair.eigenvalue; };
    const int have = static_cast<int>(found.size());
    int below = have;
    double place = 0.0;
    for (int i = std::min(count, have); i < have; ++i)
      if (value(i) - value(i - 1) > kGap * std::abs(value(i))) {
        below = i;
        place = 0.5 * (value(i) + value(i - 1));
        break;
      }
    if (below == have && (have == 0 || have == wanted)) place = have == 0 ? 0.0 : value(have - 1) * (1.0 + kGap);
    if (have < wanted && below == have) place = 2.0 * std::abs(value(have - 1));
    const bool agrees = have > 0 && factorize(-place, stability_limit.cap_of_count, true) == below;
    for (VibrationMode& mode : found) mode.pair.converged = agrees;
  }

  const Model& model_;
  State state_;
  bool in_plane_;
  MixedVector residual_;
  EvaluationPoint point_;
  IndependentUnknowns unknowns_;
  Masses masses_;
  std::optional<Tangent> tangent_;
  std::array<std::vector<double>, 3> translation_{};  ///< momenta of velocity one along each axis
  SparseMatrix outside_{};                            ///< what springs, loads and constraints add to K; rank 0
  std::unique_ptr<InertiaSolver> solver_;
};

}  // namespace

std::vector<VibrationMode> vibration_modes(BeamProblem& problem, const State& state, double load_factor, int count,
                                           bool in_plane) {
  return Vibration(problem, state, load_factor, in_plane).modes(count);
}

}  // namespace mixbeam
