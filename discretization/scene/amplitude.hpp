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

/// The ramp of a stage, from 0 at load factor stage - 1 to 1 at load factor stage, or the user's own function of the
/// load factor. A path that is followed by its length may leave the range of load factors for a while: the ramp of the
/// first stage goes on below 0, that of the last stage above its end, so that loads keep their direction there.
class Amplitude {
 public:
  Amplitude() = default;
  /// `stages`: number of stages of the scene. `formula` of t = load factor; empty: the ramp of `stage`. Throws
  /// std::invalid_argument for a text that is no formula.
  Amplitude(Stage stage, Stage stages, const std::string& formula = "");

  /// From here on as the clock runs.
  void follow(std::shared_ptr<const LoadClock> clock) { clock_ = std::move(clock); }

  double operator()(double load_factor) const;
  /// Derivative, at the joint of two stages that of the later one; of a formula by a five-point difference, so not
  /// exact.
  double slope(double load_factor) const;
  /// The value whatever the clock says.
  double at(double load_factor) const;

 private:
  double ramp(double load_factor) const;
  double ramp_slope(double load_factor) const;

  Stage stage_ = 1, stages_ = 1;
  std::optional<Expression> formula_{};
  std::shared_ptr<const LoadClock> clock_{};  ///< none: there are no formulas
};

/// The square of a frame's amplitude, with which centrifugal forces grow, as a formula of t = load factor.
std::string centrifugal_growth(const RotatingFrame& frame, Stage stages);

/// Where an amplitude turns back, or jumps: then `before` is the last load factor of the value before, `after`, next to
/// it, the first of the value after.
struct LoadTurn {
  double before = 0.0, after = 0.0;
  bool is_jump() const { return after > before; }
};

/// A part of a stage in which every amplitude rises or falls all the way, or a jump of some of them.
struct LoadPiece {
  double from = 0.0, to = 1.0;   ///< load factors
  double low = from, high = to;  ///< the amplitudes rise or fall as far as these
  bool is_jump = false;
  /// The whole stage, in which all amplitudes change at constant rates: a path needs no clock.
  bool is_plain = false;
  bool is_part = false;  ///< of what is plain, cut where a state is asked for

  /// Of the parameter of a path, see LoadClock.
  double end() const { return is_plain ? to : from + 1.0; }
};

/// The different amplitudes of a scene, and the parameter in which a path runs through them: in a piece from its start
/// to that plus 1, theory (69), so that each piece is a stage in which loads grow like ramps, however the formula runs.
/// In a jump the loads go straight from the values before to those after. Beyond the range in which the amplitudes rise
/// or fall they go on at their end rates: a path may leave the piece for a while.
class LoadClock {
 public:
  explicit LoadClock(const Scene& scene);

  bool have_formulas() const { return !amplitudes_.empty(); }
  /// Whether loads may cancel each other: a single amplitude in a piece does not.
  bool have_several() const { return amplitudes_.size() > 1; }
  /// In their order; those of different amplitudes at one place are one.
  const std::vector<LoadTurn>& turns() const { return turns_; }
  std::vector<LoadPiece> pieces(Stage stage) const;

  /// From here on numbers given for load factors are parameters of the piece; an empty one: load factors again. Tells
  /// what ran before.
  std::optional<LoadPiece> run(const std::optional<LoadPiece>& piece);
  const std::optional<LoadPiece>& piece() const { return piece_; }
  /// The load factor of a parameter, and how far beyond the range of the amplitudes, in parameters; in a jump the way
  /// since its start.
  struct Moment {
    double load_factor = 0.0, beyond = 0.0;
  };
  Moment at(double parameter) const;
  /// Beyond the range of the amplitudes as if it went on.
  double load_factor(double parameter) const;
  /// Value of an amplitude while the clock runs.
  double value(const Amplitude& amplitude, double parameter) const;
  /// Bound of a rate of a support's amplitude in the present piece, per parameter.
  double largest_rate(Stage stage, const std::string& formula) const;

  /// Whether all loads, prescribed motions and eigenstrains change in proportion between two parameters, none turning
  /// back: always where there are no formulas.
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
    double range;  ///< largest value less smallest
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
