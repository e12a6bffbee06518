/// Whether an equilibrium is stable: the signs of the eigenvalues of the tangent in the motions that supports and
/// joints permit, and the modes whose eigenvalues are nearest to zero.
///
/// K phi = mu S phi with the reduced tangent K and S as IndependentUnknowns measures motions: EI/L times l_v/L for
/// rotations, that over L^2 for displacements. Eigenvalues have no unit.
///
/// Under loads with a potential K is symmetric and an equilibrium is stable when no eigenvalue is negative. The count
/// is complete: it counts what is condensed, interiors of elements and chains, theory (47). An eigenvalue that is zero
/// within its error is counted apart: such a state is neutral.
///
/// Under follower loads and spatial moments K is not symmetric: real eigenvalues below zero mean divergence, and their
/// parity is the sign of the determinant; flutter is a matter of dynamics and not seen here, so that a state that has
/// not diverged is unknown, also where the symmetric part of K is positive (which excludes divergence alone).
///
/// The tangent caps the stiffness of forces (Cap), which lowers critical loads by about 1e-5 of them, 1e-7 where
/// eigenvalues are only counted. Modes are corrected to the true stiffness, to second order in the cap, and next to
/// zero the corrected eigenvalues are counted: theory (49).
///
/// Where stiff members stand beside soft ones, the condensed tangent keeps of its small eigenvalues only what the
/// rounding of the stiff entries leaves, but its modes to rounding. There eigenvalues are taken from the second
/// variation of the mixed potential in these modes, theory (50), which holds compliances and no stiffness.
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

/// What is known of an equilibrium. Neutral: no eigenvalue is negative, but one is zero.
enum class Verdict { stable, unstable, neutral, unknown };

/// "true", "false", "neutral" or "unknown": the value of `stable` in files and messages.
const char* text_of(Verdict verdict);

struct StabilityResult {
  int negative = 0;        ///< eigenvalues below zero; unsymmetric: real ones that are known, at least the parity
  int null = 0;            ///< eigenvalues that are zero within their errors; not among `negative`
  bool symmetric = true;   ///< the tangent was treated as symmetric
  double asymmetry = 0.0;  ///< largest |K_ij - K_ji| / sqrt(K_ii K_jj); How::factors: unknown
  int sign = 0;            ///< of det K: -1, 0 or 1; symmetric: (-1)^negative, 0 where an eigenvalue is zero
  double cap_ratio = 0.0;  ///< Cap::least_ratio of the tangent that was examined
  double end_angle =
      0.0;             ///< largest relative rotation between an element and its vertices; How::inertia, How::factors
  long inside = 0;     ///< of `negative`: inside of elements, between vertices that stand still
  double shift = 0.0;  ///< of the factors left, those of K + shift I: `negative` counts eigenvalues below -shift

  /// Without symmetry an equilibrium that has not diverged is unknown: it may flutter.
  Verdict verdict() const;
};

struct Spectrum {
  StabilityResult stability;     ///< `negative` agrees with the corrected eigenvalues
  std::vector<EigenMode> modes;  ///< nearest to zero first; unsymmetric: real ones alone
};

/// A few vectors B of the unknowns, close to the modes whose eigenvalues pass zero on a piece of a path.
struct CriticalSpace {
  int size = 0;
  std::vector<std::vector<double>> vectors{};  ///< rank 0
};

/// What a space sees of a tangent K: the eigenvalues that Rayleigh and Ritz find in K^-p B, with a small p. They vanish
/// where those of K do and as many of them, and those of a few modes need no eigenvalue solver. By Haynsworth the
/// number of negative eigenvalues of K exceeds theirs by one that changes only where K^(2p-1), bordered by B, is
/// singular: as long as it stays the same the space sees all that passes zero.
struct SpaceValues {
  std::vector<EigenMode> modes;  ///< in the order of their eigenvalues; none: K has no symmetry
  int unseen = 0;                ///< negative eigenvalues of K less those of the space

  int negative() const;  ///< of the space
};

/// N L^2/EI or M L/EI, the larger one, with the largest EI of the structure: eigenvalues are not far below minus that.
double stress_of(const Model& model, const StateMagnitude& size);

/// A tangent whose negative eigenvalues are counted: that at an equilibrium.
struct Asked {
  const State& state;
  double load_factor;
  Linearization* newton = nullptr;    ///< How::factors: taken there, see TangentKind::counts_interior
  const MixedVector* held = nullptr;  ///< How::held: rows of vertices, as an increment; interior rows are ignored
};

/// The method by which they are counted.
enum class How {
  /// One factorisation, most of it that of chains, in parallel. Where an eigenvalue may be zero the nearest ones are
  /// computed, by spectrum(). Unsymmetric: the sign of the determinant alone.
  inertia,
  /// Newton's own tangent, if it can tell and no eigenvalue may be zero: by its factors or, with joints, slanting
  /// supports and loads without potential, as How::inertia. Where a cap cuts off some stiffness, by factors without a
  /// negative eigenvalue.
  factors,
  /// Where tangents are too large for factors: by conjugate gradients from an arbitrary vector, which meet negative
  /// curvature or converge. `negative` is zero, or at least one is negative.
  iteration,
  /// While a motion is held, that of a controlled displacement, <motion, dx> = 0: theory (48). One factorisation of the
  /// whole tangent.
  held
};

/// All functions are collective, give the same on every rank and throw LinearSolverError.
class Stability {
 public:
  explicit Stability(BeamProblem& problem) : problem_(problem) {}

  /// None where the method cannot tell; How::inertia and How::held always do.
  std::optional<StabilityResult> ask(const Asked& at, How how);

  /// The `count` eigenvalues nearest to zero (or all there are), with modes and errors, and the number of negative
  /// ones. The work is bounded: modes that did not converge say so.
  Spectrum spectrum(const State& state, double load_factor, int count);
  std::vector<EigenMode> modes_near_zero(const State& state, double load_factor, int count) {
    return spectrum(state, load_factor, count).modes;
  }

  /// The space of the eigenvalues number first .. first + count - 1, from one, in the order of their size: roughly the
  /// modes. Empty where they are not among those nearest to zero, or the tangent has no symmetry.
  CriticalSpace space_of(const State& state, double load_factor, int first, int count);
  /// One factorisation, and `size` solutions with it.
  SpaceValues in_space(const State& state, double load_factor, const CriticalSpace& space);

 private:
  /// An eigenvalue of the reduced matrix; vectors on rank 0.
  struct Pair {
    double value = 0.0, error = 0.0;
    bool converged = true;
    std::vector<double> vector{}, left{};  ///< left: unsymmetric only
  };
  using Pairs = std::vector<Pair>;
  /// Of rank 0; the structure of the matrix is analysed once.
  struct Solvers {
    std::unique_ptr<InertiaSolver> symmetric, general;
  };
  struct RootResult {
    StabilityResult result;
    double nearest = 0.0;  ///< size of the eigenvalue nearest to zero, not below it; rank 0
    bool is_near_zero = false;
    bool is_reliable = true;
    int of_symmetric_part = 0;  ///< without symmetry: negative eigenvalues of (K + K^T) / 2
  };

  /// A tangent, and what is known of it before any factorisation.
  struct Seen {
    const Tangent& tangent;
    Tangent::InteriorCount interior;
    double zero = 0.0;                  ///< eigenvalues up to this size are zero
    CondensedSystem* chains = nullptr;  ///< those of this tangent, condensed; null: not yet
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
  /// Of the structure without loads: see least_stiffness(), and whether all eigenvalues are known to be above zero.
  struct Unloaded {
    double stiffness = 0.0;
    bool is_stable = false;
  };
  std::optional<Unloaded> unloaded_;
  // When first needed:
  std::unique_ptr<IndependentUnknowns> unknowns_, unknowns_beside_chains_;
  Solvers all_, beside_chains_;
  CondensedSystem* chains_ = nullptr;  ///< of the tangent that is being counted: a solver's, which it may use again
  std::unique_ptr<CondensedSystem> own_chains_;  ///< where solvers have none
};

// Points of a path at which the tangent is singular.

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
  /// Eigenvalues below zero on either side, in the direction of the path; of flutter motions that grow.
  int negative_before = 0, negative_after = 0;
  State state{};     ///< there
  MixedVector mode;  ///< as EigenMode::mode
  int modes = 1;     ///< eigenvalues that vanish, or meet, here together; `mode` is one of theirs
  /// Of the load factor. Where only the first of many points of a step is located the others are one entry: somewhere
  /// within load_factor +- error `modes` eigenvalues change their sign, and state and mode are those of its far end.
  double error = 0.0;
  bool located = true;
  double omega = std::numeric_limits<double>::quiet_NaN();  ///< of flutter: radians per time
  std::vector<MixedVector> eigenspace{};                    ///< all `modes` of them
};

}  // namespace mixbeam
