#include "discretization/scene/amplitude.hpp"

#include <algorithm>

namespace mixbeam {

namespace {

// Where rounding (1e-16 / step) and truncation (step^4) of the difference below are both about 1e-12.
constexpr double kDifferenceStep = 1e-3;

}  // namespace

Amplitude::Amplitude(Stage stage, Stage stages, const std::string& formula) : stage_(stage), stages_(stages) {
  if (!formula.empty()) formula_.emplace(formula, std::vector<std::string>{"t"});
}

double Amplitude::ramp(double load_factor) const {
  double value = load_factor - (stage_ - 1);
  if (stage_ > 1) value = std::max(value, 0.0);
  return stage_ < stages_ ? std::min(value, 1.0) : value;
}

double Amplitude::ramp_slope(double load_factor) const {
  const bool begun = stage_ == 1 || load_factor >= stage_ - 1, ended = stage_ < stages_ && load_factor >= stage_;
  return begun && !ended ? 1.0 : 0.0;
}

double Amplitude::operator()(double load_factor) const {
  return formula_ ? (*formula_)(load_factor) : ramp(load_factor);
}

double Amplitude::slope(double load_factor) const {
  if (!formula_) return ramp_slope(load_factor);
  const double h = kDifferenceStep;
  const auto f = [&](double offset) { return (*formula_)(load_factor + offset); };
  return (f(-2 * h) - 8 * f(-h) + 8 * f(h) - f(2 * h)) / (12 * h);
}

}  // namespace mixbeam
