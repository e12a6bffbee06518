#include "nonlinear/stability/vibration.hpp"

#include "discretization/text/errors.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/stability/block_krylov.hpp"
#include "nonlinear/stability/thresholds.hpp"
#include "nonlinear/stability/vibration_operator.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Modes beyond those requested: the count needs a gap above them.
constexpr int kModesBehind = 2;
/// Least number of columns of a block, since six rigid motions share one eigenvalue; wanted modes over columns.
constexpr int kLeastBlock = 6, kBlocksOfModes = 4;
/// Narrow blocks, which take two thirds of the solutions; if the count shows that modes are missing, wide ones follow.
constexpr int kNarrowBlock = 2, kNarrowBlocksOfModes = 10, kNarrowBlocks = 45;
/// Bounds of the shift over the lowest nonzero omega^2, between which rigid motions and elastic modes keep their digits
/// (rigid omega^2 at 1e-18 of the first elastic one), and its best value.
constexpr double kLeastShift = 1e-3, kMostShift = 1.0, kShift = 0.03;
constexpr int kMostShifts = 4;
/// Factor beyond those bounds at which a search is stopped early, and largest residual of pairs used for that: omega^2
/// above kRoughlyRigid times the shift then has one digit.
constexpr double kFarOutside = 10.0, kRough = 1e-2, kRoughlyRigid = 1e-2;
/// Ratio of omega^2 to the shift below which a motion is rigid: rounding leaves 1e-20.
constexpr double kRigid = 1e-12;
/// Share of the largest eigenvalue 1 / (omega^2 + shift) below which motions have no mass.
constexpr double kMassless = 1e-13;
/// Tolerance for unsymmetric operators: errors of eigenvalues are not squares of residuals, and roots where two meet.
constexpr double kOfUnsymmetric = 1e-13;
/// Residual up to which such a pair counts as found: near a double value rounding leaves its root.
constexpr double kFound = 1e-7;
/// Share of the largest eigenvalue 1 / s below which values are the root of its rounding: massless motions form chains.
constexpr double kChained = 1e-8;
/// Ratio of the frequency to |s| above which the imaginary part of a mode has correct digits.
constexpr double kOscillates = 1e-6;
/// Factor on the usual cap. Each solution is corrected for the cap, usually once; with this factor the cap does not
/// affect most structures, and no correction is needed. omega^2 of chains of 100,000 elements agrees with that of the
/// usual cap to 4e-14. Counts keep the usual cap, which lowers omega^2 by 3e-5 there: hence the gap.
constexpr double kCapOfVibration = 100.0, kGap = 2e-4;
/// Factor for unsymmetric operators: a low cap reduces rounding, which affects their eigenvalues to first order.
constexpr double kCapWithoutSymmetry = 1e-2;

/// Divisor of velocities, a frequency among those sought, in units of sqrt(EI/(m L^4)): with 1 the search takes 50 %
/// longer.
constexpr double kVelocityScale = 30.0;

/// Tolerance of residuals of pairs: the error of omega^2 is its square, and one more solution follows.
constexpr double kResidual = 1e-8;

class Vibration {
 public:
  Vibration(BeamProblem& problem, const State& state, double load_factor, bool in_plane,
            const ModeSearchObserver& observer, bool with_momenta)
      : operator_(problem.model, state, load_factor, in_plane),
        load_factor_(load_factor),
        observer_(observer),
        with_momenta_(with_momenta) {}

  std::vector<VibrationMode> modes(int count) {
    if (operator_.has_forces_of_velocity()) return damped_modes(count);
    const int wanted = count + kModesBehind;
    double shift = first_shift();
    std::vector<VibrationMode> found = search(wanted, shift, true);
    if (operator_.symmetric() && !confirm(found, count, wanted)) {  // narrow blocks may miss multiple frequencies
      found = search(wanted, shift, false);
      confirm(found, count, wanted);
    }
    if (static_cast<int>(found.size()) > count) found.resize(count, found.front());
    return found;
  }

 private:
  /// Searches for modes. `shift`: an estimate on entry; on return one that suits the frequencies found.
  std::vector<VibrationMode> search(int wanted, double& shift, bool narrow) {
    std::vector<VibrationMode> found;
    double cap = kCapOfVibration;
    for (int i = 0; i < kMostShifts; ++i) {
      operator_.factorize(shift, cap, VibrationUse::columns);
      if (!operator_.symmetric() && cap != kCapWithoutSymmetry)
        operator_.factorize(shift, cap = kCapWithoutSymmetry, VibrationUse::columns);
      found.clear();
      double rough = 0.0;
      std::vector<RitzPair> pairs = ritz_pairs(wanted, narrow, i + 1 < kMostShifts ? shift : 0.0, rough);
      if (rough != 0.0) {
        shift = kShift * rough;
        continue;
      }
      for (RitzPair& pair : pairs) {
        found.push_back(completed(pair, shift));
        std::vector<double>().swap(pair.vector);
      }
      std::vector<double> squared;
      for (const VibrationMode& mode : found) squared.push_back(std::norm(mode.rate));
      const double lowest = far_from(shift, squared, kRigid, 1.0);
      if (lowest == 0.0) break;
      shift = kShift * lowest;
    }
    std::stable_sort(found.begin(), found.end(), [](const VibrationMode& a, const VibrationMode& b) {
      return a.pair.eigenvalue < b.pair.eigenvalue;  // stable: the positive imaginary part stays first
    });
    return found;
  }

  void tell(const std::vector<RitzPair>& pairs, double tolerance, int wanted) const {
    if (!observer_) return;
    const auto found =
        std::count_if(pairs.begin(), pairs.end(), [&](const RitzPair& pair) { return pair.residual <= tolerance; });
    observer_({std::min(static_cast<int>(found), wanted), wanted, load_factor_});
  }

  /// Estimates the shift by EI/(m L^3) from the largest stiffness and m = all mass, or I/L^2 of a body if that is more.
  double first_shift() {
    operator_.linearize(0.0, kCapOfVibration, VibrationUse::matrices);
    double mass = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      translation_[axis] = operator_.masses().translation(operator_.state(), axis);
      mass = std::max(mass, dot_product(translation_[axis], translation_[axis]));
    }
    outside_ = operator_.outside();
    const Structure& structure = operator_.model().structure();
    const double length = structure.length;
    for (const PointMass& body : operator_.model().scene().point_masses)
      for (const double inertia : body.inertia) mass = std::max(mass, inertia / (length * length));
    if (!(mass > 0.0)) throw InputError("modes need a mass: no section and no point has any");
    return structure.bending_reference / (mass * length * length * length);
  }

  /// Returns the lowest omega^2 above `rigid` times the shift if the shift is outside its bounds by more than `factor`;
  /// 0 if it is not. A small shift does no harm if no motion is slower.
  static double far_from(double shift, const std::vector<double>& squared, double rigid, double factor) {
    double lowest = 0.0;
    bool is_slow = false;
    for (const double size : squared) {
      is_slow = is_slow || size < shift;
      if (size > rigid * shift && (lowest == 0.0 || size < lowest)) lowest = size;
    }
    const bool is_small = is_slow && shift * factor < kLeastShift * lowest;
    return is_small || shift > factor * kMostShift * lowest ? lowest : 0.0;
  }

  /// Finds pairs. `rough`: result of far_from() that ended the search early, or 0. `shift`: 0 disables that.
  std::vector<RitzPair> ritz_pairs(int wanted, bool narrow, double shift, double& rough) {
    KrylovProblem eigen;
    eigen.unknowns = operator_.masses().momenta();
    eigen.symmetric = operator_.symmetric();
    eigen.tolerance = eigen.symmetric ? kResidual : kOfUnsymmetric;
    eigen.goes_on = [&](const std::vector<RitzPair>& pairs) {
      tell(pairs, eigen.tolerance, wanted);
      std::vector<double> squared;
      for (const RitzPair& pair : pairs) {
        if (pair.residual > kRough) break;
        squared.push_back(std::abs(1.0 / std::complex<double>(pair.value, pair.imaginary) - shift));
      }
      rough = shift == 0.0 ? 0.0 : far_from(shift, squared, kRoughlyRigid, kFarOutside);
      return rough == 0.0;
    };
    eigen.width = std::max(kLeastBlock, (wanted + kBlocksOfModes - 1) / kBlocksOfModes);
    if (narrow && eigen.symmetric) {
      eigen.width = std::max(kNarrowBlock, wanted / kNarrowBlocksOfModes);
      eigen.blocks = kNarrowBlocks;
    }
    eigen.apply = [&](double* block, int columns) { operator_.apply(block, columns); };
    std::vector<RitzPair> pairs = largest_eigenpairs(eigen, wanted);
    double largest = 0.0;
    const auto size = [](const RitzPair& pair) { return std::hypot(pair.value, pair.imaginary); };
    for (const RitzPair& pair : pairs) largest = std::max(largest, size(pair));
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(),
                               [&](const RitzPair& pair) { return !(size(pair) > kMassless * largest); }),
                pairs.end());
    return pairs;
  }

  /// Computes the mode by one more solution, and the eigenvalue as its Rayleigh quotient, with compliances instead of
  /// stiffnesses, whose rounding would hide small eigenvalues.
  VibrationMode completed(const RitzPair& pair, double shift) {
    VibrationOperator::Response found = operator_.respond(pair.vector.data());
    std::vector<double> momenta = operator_.momenta_of(found.motion);
    VibrationMode mode{{0.0, std::move(found.motion)}, {}, 0.0, {}};
    const double outside = number_of_root(operator_.unknowns().root(), [&] {
      std::vector<double> force(found.y.size());
      outside_.multiply(found.y.data(), force.data());
      return dot_product(found.y, force);
    });
    mode.pair.eigenvalue =
        (operator_.masses().stiffness_form(mode.pair.mode) + outside) / dot_product(momenta, momenta);
    mode.rate = rate_of(mode.pair.eigenvalue);
    mode.pair.error = pair.residual;
    if (!operator_.symmetric()) take_value(pair, shift, mode);
    const double factor = normalize_mode(operator_.model(), mode.pair.mode);
    for (double& momentum : momenta) momentum *= factor;
    take_masses(std::move(momenta), mode);
    return mode;
  }

  /// Returns s with -s^2 = omega^2: that of the growing motion, if any, and of the decaying one for the conjugate.
  static std::complex<double> rate_of(const std::complex<double>& squared) {
    const std::complex<double> omega = std::sqrt(squared);
    return {omega.imag(), std::abs(omega.real())};
  }

  void take_masses(std::vector<double> momenta, VibrationMode& mode) const {
    mode.modal_mass = dot_product(momenta, momenta);
    for (int axis = 0; axis < 3; ++axis)
      mode.participation[axis] = dot_product(momenta, translation_[axis]) / mode.modal_mass;
    if (with_momenta_) mode.momenta[0] = std::move(momenta);
  }

  /// Computes the momenta of a complex mode from the real parts of those of phi and s phi: motions in opposite senses
  /// of rotation differ only in the latter.
  std::array<std::vector<double>, 2> complex_momenta(const std::vector<double>& own, double reference,
                                                     const std::complex<double>& rate) const {
    const size_t n = operator_.masses().momenta();
    std::array<std::vector<double>, 2> parts{std::vector<double>(own.begin(), own.begin() + n), {}};
    if (!(rate.imag() > kOscillates * std::abs(rate))) return parts;
    for (size_t i = 0; i < n; ++i) parts[1].push_back((rate.real() * own[i] - reference * own[n + i]) / rate.imag());
    return parts;
  }

  /// Iterates on (G phi, s G phi / omega_0, beta D phi), all that damping, Coriolis forces and inertia depend on.
  std::vector<VibrationMode> damped_modes(int count) {
    const double reference = kVelocityScale * std::sqrt(first_shift());
    operator_.factorize(0.0, kCapWithoutSymmetry, VibrationUse::condensed);
    const size_t n = operator_.masses().momenta(), strains = operator_.masses().damped_strains();
    KrylovProblem eigen;
    eigen.unknowns = static_cast<int>(2 * n + strains);
    eigen.symmetric = false;
    eigen.tolerance = kOfUnsymmetric;
    eigen.width = std::max(kLeastBlock, count + kModesBehind);
    eigen.apply = [&](double* block, int columns) {
      for (int j = 0; j < columns; ++j) {
        double* own = block + static_cast<size_t>(j) * eigen.unknowns;
        const MixedVector motion = damped_response(own, reference);
        const std::vector<double> momenta = operator_.momenta_of(motion);
        const std::vector<double> strained = operator_.masses().damped_strains_of(motion);
        for (size_t i = 0; i < n; ++i) own[n + i] = own[i] / reference;
        std::copy(momenta.begin(), momenta.end(), own);
        std::copy(strained.begin(), strained.end(), own + 2 * n);
      }
    };
    eigen.goes_on = [&](const std::vector<RitzPair>& pairs) {
      tell(pairs, eigen.tolerance, 2 * count + kModesBehind);
      return true;
    };
    std::vector<VibrationMode> found;
    const std::vector<RitzPair> pairs = largest_eigenpairs(eigen, 2 * count + kModesBehind);
    for (const RitzPair& pair : pairs) {
      if (std::hypot(pair.value, pair.imaginary) < kChained * std::hypot(pairs[0].value, pairs[0].imaginary)) break;
      const std::complex<double> rate = 1.0 / std::complex<double>(pair.value, pair.imaginary);
      if (rate.imag() < 0.0 || !(pair.residual <= kFound)) continue;  // massless motions leave pairs of rounding
      VibrationMode mode{{-(rate * rate).real(), damped_response(pair.vector.data(), reference)}, rate, 0.0, {}};
      mode.pair.error = pair.residual;
      normalize_mode(operator_.model(), mode.pair.mode);
      take_masses(operator_.momenta_of(mode.pair.mode), mode);
      if (with_momenta_) mode.momenta = complex_momenta(pair.vector, reference, rate);
      found.push_back(std::move(mode));
    }
    std::stable_sort(found.begin(), found.end(), [](const VibrationMode& a, const VibrationMode& b) {
      return std::abs(a.rate) < std::abs(b.rate);
    });
    if (static_cast<int>(found.size()) > count) found.resize(count, found.front());
    return found;
  }

  /// Computes -K^-1 (C phi + s M phi).
  MixedVector damped_response(const double* own, double reference) {
    const size_t n = operator_.masses().momenta();
    std::vector<double> forces = operator_.masses().damped_momenta(own);
    for (size_t i = 0; i < n; ++i) forces[i] = -(forces[i] + reference * own[n + i]);
    const bool by_strain = operator_.masses().damped_strains() > 0;
    return std::move(operator_.respond(forces.data(), by_strain ? own + 2 * n : nullptr).motion);
  }

  /// Takes the eigenvalue from the pair itself, if unsymmetric.
  static void take_value(const RitzPair& pair, double shift, VibrationMode& mode) {
    const double size = pair.value * pair.value + pair.imaginary * pair.imaginary;
    mode.pair.eigenvalue = pair.value / size - shift;
    const std::complex<double> squared(mode.pair.eigenvalue, pair.imaginary == 0.0 ? 0.0 : -pair.imaginary / size);
    mode.rate = rate_of(squared);
    mode.pair.converged = pair.residual <= kFound;
  }

  /// Counts the eigenvalues below a gap above the requested modes; returns whether none is missing.
  bool confirm(std::vector<VibrationMode>& found, int count, int wanted) {
    const auto value = [&](int i) { return found[i].pair.eigenvalue; };
    const int have = static_cast<int>(found.size());
    if (have == 0) return false;
    int below = have;
    double place = 0.0;
    for (int i = std::min(count, have); i < have; ++i)
      if (value(i) - value(i - 1) > kGap * std::abs(value(i))) {
        below = i;
        place = 0.5 * (value(i) + value(i - 1));
        break;
      }
    if (below == have) place = have < wanted ? 2.0 * std::abs(value(have - 1)) : value(have - 1) * (1.0 + kGap);
    const bool agrees = operator_.factorize(-place, stability_limit.cap_of_count, VibrationUse::counted) == below;
    for (VibrationMode& mode : found) mode.pair.converged = agrees;
    return agrees;
  }

  VibrationOperator operator_;
  double load_factor_;
  const ModeSearchObserver& observer_;
  bool with_momenta_;
  std::array<std::vector<double>, 3> translation_{};  ///< momenta of unit velocity along each axis
  SparseMatrix outside_{};                            ///< contribution of springs, loads, constraints to K; rank 0
};

}  // namespace

std::vector<VibrationMode> vibration_modes(BeamProblem& problem, const State& state, double load_factor, int count,
                                           bool in_plane, const ModeSearchObserver& observer, bool with_momenta) {
  return Vibration(problem, state, load_factor, in_plane, observer, with_momenta).modes(count);
}

}  // namespace mixbeam
