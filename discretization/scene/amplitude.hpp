/// How a load or a prescribed motion grows with the load factor.
#pragma once

#include "discretization/scene/scene.hpp"
#include "discretization/text/expression.hpp"

#include <optional>
#include <string>

namespace mixbeam {

/// The ramp of a stage, from 0 at load factor stage - 1 to 1 at load factor stage, or the user's own function of the
/// load factor. A path that is followed by its length may leave the range of load factors for a while: the ramp of the
/// first stage goes on below 0, that of the last stage above its end, so that loads keep their direction there.
class Amplitude {
 public:
  Amplitude() = default;
  /// `stages`: number of stages of the scene. `formula` of t = load factor; empty: the ramp of `stage`. Throws
  /// std::invalid_argument for a text that is no formula.
  Amplitude(Stage stage, Stage stages, const std::string& formula = "");

  double operator()(double load_factor) const;
  /// Derivative, at the joint of two stages that of the later one; of a formula by a five-point difference, so not
  /// exact.
  double slope(double load_factor) const;

 private:
  double ramp(double load_factor) const;
  double ramp_slope(double load_factor) const;

  Stage stage_ = 1, stages_ = 1;
  std::optional<Expression> formula_{};
};

}  // namespace mixbeam
