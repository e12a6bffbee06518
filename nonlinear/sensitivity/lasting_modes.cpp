#include "nonlinear/sensitivity/lasting_modes.hpp"

#include "kernels/math/constants.hpp"
#include "nonlinear/stability/block_krylov.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mixbeam {

namespace {

/// Relative difference of omega^2 up to which frequencies are one: derivatives of closer ones hold only for smaller
/// changes, and their modes have fewer digits.
constexpr double kOneFrequency = 1e-5;
/// Modes beyond those requested, which may share the last frequency: as many as a free body has rigid motions.
constexpr int kMostOfOneFrequency = 6;
/// Relative distance of the shift from omega^2: each solution leaves that share of modes at twice the frequency, and
/// loses two digits.
constexpr double kBesideFrequency = 0.01;
constexpr int kSolutionsOfMode = 2;

/// Derivative of the frequency by omega^2.
double slope_of_frequency(double square) { return 1.0 / (4.0 * kPi * std::sqrt(square)); }

}  // namespace

LastingModes::LastingModes(BeamProblem& problem, const State& state, double load_factor, const ModesParameters& asked)
    : asked_(asked), load_factor_(load_factor), operator_(problem.model, state, load_factor, asked.in_plane) {
  if (operator_.has_forces_of_velocity())
    throw std::invalid_argument("frequencies of motions with damping have no derivative here");
  modes_ = vibration_modes(problem, state, load_factor, asked.number + kMostOfOneFrequency, asked.in_plane);
}

double LastingModes::frequency(int mode) { return std::sqrt(shared(mode).square) / (2.0 * kPi); }

const LastingModes::Shared& LastingModes::shared(int mode) {
  if (const int known = std::min(asked_.number, static_cast<int>(modes_.size())); mode > known)
    throw std::invalid_argument("number " + std::to_string(mode) + " of " + std::to_string(known) + " modes");
  const auto square = [&](int i) { return modes_[i].pair.eigenvalue; };
  const auto is_one = [&](int i) { return square(i) - square(i - 1) <= kOneFrequency * std::abs(square(i)); };
  int first = mode - 1, end = mode;
  while (first > 0 && is_one(first)) --first;
  while (end < static_cast<int>(modes_.size()) && is_one(end)) ++end;
  const auto found = shared_.find(first);
  return found != shared_.end() ? found->second : shared_[first] = of_cluster(first, end - first);
}

LastingModes::Shared LastingModes::of_cluster(int first, int count) {
  Shared found{modes_[first].pair.eigenvalue, count};
  if (!(found.square > 0.0) || modes_[first].rate.real() != 0.0)
    throw std::invalid_argument("a motion that does not vibrate has no frequency to differentiate");
  operator_.factorize(-found.square * (1.0 - kBesideFrequency), 1.0, VibrationUse::condensed);
  if (!operator_.symmetric())
    throw std::invalid_argument("frequencies under loads without a potential have no derivative here");
  std::vector<std::vector<double>> momenta;
  for (int a = 0; a < count; ++a) momenta.push_back(operator_.momenta_of(modes_[first + a].pair.mode));
  for (int k = 0; k < kSolutionsOfMode; ++k) {
    found.motions.clear();
    for (const std::vector<double>& of : momenta) found.motions.push_back(operator_.respond(of.data()));
    orthonormalize(found.motions);
    for (int a = 0; a < count; ++a) momenta[a] = operator_.momenta_of(found.motions[a].motion);
  }
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b) {
      const VibrationOperator::Response& one = found.motions[a];
      found.motions.push_back({one.motion.clone(true), one.y});
      found.motions.back().add(1.0, found.motions[b]);
    }
  return found;
}

void LastingModes::orthonormalize(std::vector<VibrationOperator::Response>& motions) const {
  std::vector<std::vector<double>> before;
  for (VibrationOperator::Response& one : motions) {
    for (std::size_t b = 0; b < before.size(); ++b)
      one.add(-dot_product(operator_.momenta_of(one.motion), before[b]), motions[b]);
    std::vector<double> own = operator_.momenta_of(one.motion);
    const double size = std::sqrt(dot_product(own, own));
    one.add(1.0 / size - 1.0, {one.motion.clone(true), one.y});
    before.push_back(operator_.momenta_of(one.motion));
  }
}

std::vector<double> LastingModes::changes(int mode, const Model& model, const State& state) {
  const Shared& of = shared(mode);
  VibrationOperator there(model, state, load_factor_, asked_.in_plane);
  const std::vector<double> forms = there.forms(operator_, of.motions, of.square);
  const int m = of.count;
  std::vector<double> changes(static_cast<std::size_t>(m) * m);
  for (int a = 0; a < m; ++a) changes[a * (m + 1)] = slope_of_frequency(of.square) * forms[a];
  for (int a = 0, next = m; a < m; ++a)
    for (int b = a + 1; b < m; ++b, ++next)
      changes[a + b * m] = changes[b + a * m] =
          0.5 * slope_of_frequency(of.square) * (forms[next] - forms[a] - forms[b]);
  return changes;
}

}  // namespace mixbeam
