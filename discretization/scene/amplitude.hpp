/// How a load or a prescribed motion grows with the load factor.
#pragma once

#include "discretization/scene/scene.hpp"
#include "discretization/text/expression.hpp"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

class LoadClock;

/// Ramp of a stage, from 0 at load factor stage - 1 to 1 at load factor stage, or the user's own function of the load
/// factor. Arc length continuation may leave the range of load factors for a while: the ramp of the first stage
/// continues below 0, that of the last stage above its end, so that loads keep their direction there.
class Amplitude {
 public:
  Amplitude() = default;
  /// `stages`: number of stages of the scene. `formula` of t = load factor; empty: the ramp of `stage`. Throws
  /// std::invalid_argument for an invalid formula.
  Amplitude(Stage stage, Stage stages, const std::string& formula = "");

  /// Interprets arguments as the clock does from now on.
  void follow(std::shared_ptr<const LoadClock> clock) { clock_ = std::move(clock); }

  double operator()(double load_factor) const;
  /// Derivative; where two stages meet, that of the later one; for a formula a five-point difference, hence
  /// approximate.
  double slope(double load_factor) const;
  /// Value at a load factor, regardless of the clock.
  double at(double load_factor) const;

 private:
  double ramp(double load_factor) const;
  double ramp_slope(double load_factor) const;

  Stage stage_ = 1, stages_ = 1;
  std::optional<Expression> formula_{};
  std::shared_ptr<const LoadClock> clock_{};  ///< none: there are no formulas
};

/// Square of a frame's amplitude, in proportion to which centrifugal forces grow, as a formula of t = load factor.
std::string centrifugal_growth(const RotatingFrame& frame, Stage stages);

/// Load factor at which an amplitude reverses or jumps: then `before` is the last load factor of the value before, and
/// `after`, next to it, the first of the value after.
struct LoadTurn {
  double before = 0.0, after = 0.0;
  bool is_jump() const { return after > before; }
};

/// Part of a stage in which every amplitude is monotonic, or a jump of some of them.
struct LoadPiece {
  double from = 0.0, to = 1.0;   ///< load factors
  double low = from, high = to;  ///< the amplitudes are monotonic as far as these
  bool is_jump = false;
  /// The whole stage, with all amplitudes changing at constant rates: a path needs no clock.
  bool is_plain = false;
  bool is_part = false;  ///< part of a plain piece, cut where a state is requested

  /// Last value of the parameter of a path, see LoadClock.
  double end() const { return is_plain ? to : from + 1.0; }
};

/// Distinct amplitudes of a scene, and the parameter in which a path runs through them: it grows by 1 over a piece,
/// theory (69), so that each piece is like a stage with ramps, whatever the formula. In a jump the loads change
/// linearly from the values before to those after. Beyond the range in which the amplitudes are monotonic they continue
/// at their end rates: a path may leave the piece for a while.
class LoadClock {
 public:
  explicit LoadClock(const Scene& scene);

  bool have_formulas() const { return !amplitudes_.empty(); }
  /// Whether loads may cancel each other: those of a single amplitude do not.
  bool have_several() const { return amplitudes_.size() > 1; }
  /// Ascending; those of different amplitudes at one place are merged.
  const std::vector<LoadTurn>& turns() const { return turns_; }
  std::vector<LoadPiece> pieces(Stage stage) const;

  /// Interprets load factors as parameters of the piece from now on; an empty one: as load factors again. Returns the
  /// piece before.
  std::optional<LoadPiece> run(const std::optional<LoadPiece>& piece);
  const std::optional<LoadPiece>& piece() const { return piece_; }
  /// Load factor of a parameter, and how far it is beyond the range of the amplitudes, in parameters; in a jump the
  /// distance from its start.
  struct Moment {
    double load_factor = 0.0, beyond = 0.0;
  };
  Moment at(double parameter) const;
  /// Load factor of a parameter, extrapolated beyond the range of the amplitudes.
  double load_factor(double parameter) const;
  /// Value of an amplitude while the clock runs.
  double value(const Amplitude& amplitude, double parameter) const;
  /// Bound of the rate of a support's amplitude in the current piece, per unit of the parameter.
  double largest_rate(Stage stage, const std::string& formula) const;

  /// Whether all loads, prescribed motions and eigenstrains change in proportion between two parameters, without
  /// reversal: always so without formulas.
  bool is_straight(double from, double to) const;

 private:
  struct Moving {
    double start, weight;
    const Amplitude* amplitude;
  };
  struct Distinct {
    Stage stage;
    std::string formula;
    Amplitude amplitude;
    double range;  ///< largest minus smallest value
  };
  double progress(double load_factor) const;
  double load_factor_at(double share, double low, double high) const;
  bool is_plain(double from, double to) const;
  std::vector<double> values_at(double parameter) const;

  Stage stages_;
  std::vector<Distinct> amplitudes_;  ///< empty: there are no formulas
  std::vector<LoadTurn> turns_;
  std::optional<LoadPiece> piece_{};
  std::vector<Moving> moving_;  ///< in the piece
  double total_ = 0.0;          ///< weighted change of all in the piece
  mutable std::array<std::pair<double, Moment>, 8> known_{};
  mutable size_t next_known_ = 0;
};

}  // namespace mixbeam
