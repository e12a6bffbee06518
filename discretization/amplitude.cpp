#include "discretization/amplitude.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

// Where rounding (1e-16 / step) and truncation (step^4) of the difference below are both about 1e-12.
constexpr double kDifferenceStep = 1e-3;

}  // namespace

double stage_amplitude(double load_factor, Stage stage) { return std::clamp(load_factor - (stage - 1), 0.0, 1.0); }

double stage_amplitude_slope(double load_factor, Stage stage) {
  const double x = load_factor - (stage - 1);
  return x >= 0.0 && x < 1.0 ? 1.0 : 0.0;
}

Amplitude::Amplitude(Stage stage, const std::string& formula) : stage_(stage) {
  if (!formula.empty()) formula_.emplace(formula, std::vector<std::string>{"t"});
}

double Amplitude::operator()(double load_factor) const {
  return formula_ ? (*formula_)(load_factor) : stage_amplitude(load_factor, stage_);
}

double Amplitude::slope(double load_factor) const {
  if (!formula_) return stage_amplitude_slope(load_factor, stage_);
  const double h = kDifferenceStep;
  const auto f = [&](double offset) { return (*formula_)(load_factor + offset); };
  return (f(-2 * h) - 8 * f(-h) + 8 * f(h) - f(2 * h)) / (12 * h);
}

}  // namespace mixbeam
