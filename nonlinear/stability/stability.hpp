/// Stability of an equilibrium: the signs of the eigenvalues of the tangent in the motions admitted by supports and
/// joints, and the modes whose eigenvalues are nearest to zero.
///
/// K phi = mu S phi with the reduced tangent K, and S from the units of IndependentUnknowns: EI/L times l_v/L for
/// rotations, that over L^2 for displacements. Eigenvalues are dimensionless.
///
/// Under loads with a potential K is symmetric, and an equilibrium is stable if no eigenvalue is negative. The count is
/// complete: it includes condensed unknowns, interiors of elements and chains, theory (47). An eigenvalue that is zero
/// within its error is counted separately: such a state is neutral.
///
/// Under follower loads and spatial moments K is not symmetric: negative real eigenvalues mean divergence, and the sign
/// of the determinant is their parity. Flutter needs dynamics and is not detected here, so that a state that has not
/// diverged is unknown, even if the symmetric part of K is positive (which excludes only divergence).
///
/// The tangent caps the stiffness of forces (Cap), which lowers critical loads by a share of about 1e-5, or 1e-7 where
/// eigenvalues are only counted. Modes are corrected to the true stiffness, to second order in the cap, and near zero
/// the corrected eigenvalues are counted: theory (49).
///
/// If members differ much in stiffness, the rounding of stiff entries spoils the small eigenvalues of the condensed
/// tangent, but not its modes. Eigenvalues are then computed from the second variation of the mixed potential in these
/// modes, theory (50), which contains compliances and no stiffness.
#pragma once

#include "discretization/assembly/condensed_system.hpp"
#include "nonlinear/newton/step.hpp"
#include "nonlinear/stability/block_krylov.hpp"
#include "nonlinear/stability/independent_unknowns.hpp"

#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace mixbeam {

/// Stability of an equilibrium as far as it is known. Neutral: no eigenvalue is negative, but one is zero.
enum class Verdict { stable, unstable, neutral, unknown };

/// "true", "false", "neutral" or "unknown": the value of `stable` in files and messages.
const char* text_of(Verdict verdict);

struct StabilityResult {
  int negative = 0;        ///< eigenvalues below zero; unsymmetric: known real ones, at least with their parity
  int null = 0;            ///< eigenvalues that are zero within their errors; not included in `negative`
  bool symmetric = true;   ///< the tangent was treated as symmetric
  double asymmetry = 0.0;  ///< largest |K_ij - K_ji| / sqrt(K_ii K_jj); How::factors: unknown
  int sign = 0;            ///< of det K: -1, 0 or 1; symmetric: (-1)^negative, 0 if an eigenvalue is zero
  double cap_ratio = 0.0;  ///< Cap::least_ratio of the tangent that was examined
  double end_angle =
      0.0;             ///< largest relative rotation between an element and its vertices; How::inertia, How::factors
  long inside = 0;     ///< share of `negative` inside elements, with fixed vertices
  double shift = 0.0;  ///< the solver holds factors of K + shift I, and `negative` counts eigenvalues below -shift

  /// Judges the counts. Unsymmetric: an equilibrium that has not diverged is unknown, for it may flutter.
  Verdict verdict() const;
};

struct Spectrum {
  StabilityResult stability;     ///< `negative` agrees with the corrected eigenvalues
  std::vector<EigenMode> modes;  ///< nearest to zero first; unsymmetric: real ones alone
};

/// A few vectors B of the unknowns, close to the modes whose eigenvalues pass zero on a segment of a path.
struct CriticalSpace {
  int size = 0;
  std::vector<std::vector<double>> vectors{};  ///< rank 0
};

/// Ritz values of a tangent K in the space K^-p B, with a small p. They vanish where those of K do, as many at a time,
/// and need no eigenvalue solver. By Haynsworth the number of negative eigenvalues of K that the space does not have
/// changes only where K^(2p-1), bordered by B, is singular: while it is constant, the space sees all that pass zero.
struct SpaceValues {
  std::vector<EigenMode> modes;  ///< in the order of their eigenvalues; none: K is unsymmetric
  int unseen = 0;                ///< negative eigenvalues of K minus those of the space

  int negative() const;  ///< number of negative eigenvalues of the space
};

/// Larger one of N L^2/EI and M L/EI, with the largest EI of the structure: eigenvalues are not far below minus that.
double stress_of(const Model& model, const StateMagnitude& size);

/// Equilibrium whose tangent's negative eigenvalues are counted.
struct Asked {
  const State& state;
  double load_factor;
  Linearization* newton = nullptr;    ///< How::factors: linearised there with TangentKind::counts_interior
  const MixedVector* held = nullptr;  ///< How::held: rows of vertices, as an increment; interior rows are ignored
};

/// Method of counting.
enum class How {
  /// One factorisation, mostly of chains, in parallel. If an eigenvalue may be zero the nearest ones are computed by
  /// spectrum(). Unsymmetric: only the sign of the determinant.
  inertia,
  /// Newton's own tangent, if it suffices and no eigenvalue may be zero: its factors or, with joints, inclined supports
  /// and loads without potential, as How::inertia. If the cap cuts off some stiffness, only factors without a negative
  /// eigenvalue count.
  factors,
  /// Conjugate gradients from an arbitrary vector, which meet negative curvature or converge: for tangents too large
  /// for factors. `negative` is 0 or a lower bound of 1.
  iteration,
  /// Count while the motion of a controlled displacement is held, <motion, dx> = 0: theory (48). Factorises the whole
  /// tangent once.
  held
};

/// Counts negative eigenvalues, and finds those nearest to zero. All functions are collective, return the same on every
/// rank and throw LinearSolverError.
class Stability {
 public:
  explicit Stability(BeamProblem& problem) : problem_(problem) {}

  /// Counts negative eigenvalues; none if the method cannot decide, which How::inertia and How::held always can.
  std::optional<StabilityResult> ask(const Asked& at, How how);
  /// Does so; returns none also if the linear solver fails.
  std::optional<StabilityResult> try_ask(const Asked& at, How how);

  /// Finds the `count` eigenvalues nearest to zero (or all there are), with modes and errors, and the number of
  /// negative ones. The work is bounded: see EigenMode::converged.
  Spectrum spectrum(const State& state, double load_factor, int count);
  std::vector<EigenMode> modes_near_zero(const State& state, double load_factor, int count) {
    return spectrum(state, load_factor, count).modes;
  }

  /// Returns approximate modes of eigenvalues number first .. first + count - 1, counted from one, lowest first. Empty
  /// if they are not among those nearest to zero, or the tangent is unsymmetric.
  CriticalSpace space_of(const State& state, double load_factor, int first, int count);
  /// Evaluates the Ritz values of a space, by one factorisation and a few solves for each of its vectors.
  SpaceValues in_space(const State& state, double load_factor, const CriticalSpace& space);

 private:
  /// An eigenvalue of the reduced matrix; vectors on rank 0.
  struct Pair {
    double value = 0.0, error = 0.0;
    bool converged = true;
    std::vector<double> vector{}, left{};  ///< left: unsymmetric only
  };
  using Pairs = std::vector<Pair>;
  /// Solvers on rank 0; the structure of the matrix is analysed once.
  struct Solvers {
    std::unique_ptr<InertiaSolver> symmetric, general;
  };
  struct RootResult {
    StabilityResult result;
    double nearest = 0.0;  ///< upper bound of the magnitude of the eigenvalue nearest to zero; rank 0
    bool is_near_zero = false;
    bool is_reliable = true;
    int of_symmetric_part = 0;  ///< unsymmetric: negative eigenvalues of (K + K^T) / 2
  };

  /// A tangent with data that are known before any factorisation.
  struct Seen {
    const Tangent& tangent;
    Tangent::InteriorCount interior;
    double zero = 0.0;                  ///< magnitude up to which eigenvalues count as zero
    CondensedSystem* chains = nullptr;  ///< condensed chains of this tangent; null: not condensed yet
  };
  struct Look {
    Tangent tangent;
    Tangent::InteriorCount interior;
    double zero = 0.0;
    Seen seen() const { return {tangent, interior, zero, nullptr}; }
    const State& state() const { return tangent.point().state; }
    double load_factor() const { return tangent.point().load_factor; }
  };

  Look evaluate_tangent(const State& state, double load_factor, double raise);
  Look assemble(const State& state, double load_factor);
  double share_of_cap(double stress, const Seen* unloaded = nullptr);
  double least_stiffness(const Seen* unloaded);
  StabilityResult stable(const EvaluationPoint& point, double share_of_cap) const;
  RootResult factorized(const SparseMatrix& matrix, Solvers& solvers, double asymmetry_beside = 0.0) const;
  static int negative_of_symmetric_part(const SparseMatrix& matrix, Solvers& solvers);
  static void look_for_zero(const SparseMatrix& matrix, const Solvers& solvers, double zero, RootResult& root);
  static RootResult completed(RootResult root, const RootCopy& copy, const Seen& look, long of_chains);
  void take_chains(CondensedSystem* chains);
  RootResult factorized_beside_chains(const Seen& look);
  RootResult factorized_beside_chains(const Seen& look, bool symmetric_part, double asymmetry);
  std::optional<StabilityResult> inertia_with_chains(const Seen& look);
  StabilityResult inertia(const Look& look, double shift = 0.0);
  InertiaSolver& solver(const StabilityResult& result);
  StabilityResult count(const State& state, double load_factor);
  std::optional<StabilityResult> count_by(Linearization& at);
  std::optional<StabilityResult> count_without_stress(const State& state, double load_factor);
  std::optional<StabilityResult> count_by_iteration(const State& state, double load_factor);
  StabilityResult count_held(const State& state, double load_factor, const MixedVector& motion);
  void share(Pairs& pairs) const;
  Pairs ritz_values(const StabilityResult& stability, const CriticalSpace& space);
  Pairs nearest(const StabilityResult& stability, int count, double tolerance);
  std::vector<double> second_variations(const Tangent& tangent, const std::vector<MixedVector>& motions,
                                        const Pairs& pairs) const;
  std::vector<EigenMode> corrected_modes(const Look& look, const StabilityResult& stability, const Pairs& pairs);

  BeamProblem& problem_;
  /// The structure without loads: see least_stiffness(), and whether all eigenvalues are known to be positive.
  struct Unloaded {
    double stiffness = 0.0;
    bool is_stable = false;
  };
  std::optional<Unloaded> unloaded_;
  // Made when first needed:
  std::unique_ptr<IndependentUnknowns> unknowns_, unknowns_beside_chains_;
  Solvers all_, beside_chains_;
  CondensedSystem* chains_ = nullptr;  ///< of the tangent that is being counted; owned by a solver, or own_chains_
  std::unique_ptr<CondensedSystem> own_chains_;  ///< if solvers have none
};

// Critical points: the tangent is singular, or motions begin to grow.

enum class CriticalKind {
  limit_point,  ///< the load factor is stationary along the path
  bifurcation,  ///< another path crosses this one
  flutter       ///< frequencies meet, and motions begin to grow
};

/// "limit point", "bifurcation", "flutter".
const char* name_of(CriticalKind kind);

struct CriticalPoint {
  CriticalKind kind = CriticalKind::limit_point;
  double load_factor = 0.0;
  /// Negative eigenvalues on either side, in the direction of the path; flutter: number of growing motions.
  int negative_before = 0, negative_after = 0;
  State state{};     ///< at the point
  MixedVector mode;  ///< as EigenMode::mode
  int modes = 1;     ///< number of eigenvalues that vanish, or meet, here together; `mode` belongs to one of them
  /// Error of the load factor. If only the first of many points of a step is located, one entry represents the others:
  /// `modes` eigenvalues change sign within load_factor +- error, state is that of its far end, and mode is zero.
  double error = 0.0;
  bool located = true;
  double omega = std::numeric_limits<double>::quiet_NaN();  ///< flutter: circular frequency [radian/time]
  std::vector<MixedVector> eigenspace{};                    ///< all `modes` of them
};

}  // namespace mixbeam
