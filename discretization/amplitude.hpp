/// How a load or a prescribed motion grows with the load factor.
#pragma once

#include "discretization/expression.hpp"
#include "discretization/scene.hpp"

#include <optional>
#include <string>

namespace mixbeam {

/// clamp(load_factor - (stage - 1), 0, 1)
double stage_amplitude(double load_factor, Stage stage);
/// Slope of the amplitude; at the joint of two stages the one of the later stage.
double stage_amplitude_slope(double load_factor, Stage stage);

/// The ramp of a stage, or the user's own function of the load factor.
class Amplitude {
 public:
  Amplitude() = default;
  explicit Amplitude(Stage stage) : stage_(stage) {}
  /// `formula` of t = load factor; empty: the ramp of `stage`. Throws std::invalid_argument for a text that is no
  /// formula.
  Amplitude(Stage stage, const std::string& formula);

  double operator()(double load_factor) const;
  /// Derivative; of a formula by a five-point difference, so not exact.
  double slope(double load_factor) const;

 private:
  Stage stage_ = 1;
  std::optional<Expression> formula_{};
};

}  // namespace mixbeam
