#include "nonlinear/path/load_history.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace mixbeam {

namespace {

/// A history is looked at in so many parts of a step.
constexpr int kParts = 8;
/// What it leaves a straight line by, over its length, before a step along that line is another one.
constexpr double kOffLine = 1e-2;

std::vector<double> values_at(const std::vector<Amplitude>& amplitudes, double load_factor) {
  std::vector<double> values;
  for (const Amplitude& amplitude : amplitudes) values.push_back(amplitude(load_factor));
  return values;
}

}  // namespace

LoadHistory::LoadHistory(const Scene& scene) {
  std::set<std::pair<Stage, std::string>> different;
  const auto add = [&](const auto& all) {
    for (const auto& acting : all) different.insert({acting.stage, acting.amplitude});
  };
  add(scene.point_loads);
  add(scene.distributed_loads);
  add(scene.supports);
  add(scene.eigenstrains);
  if (std::all_of(different.begin(), different.end(), [](const auto& d) { return d.second.empty(); })) return;
  for (const auto& [stage, formula] : different) amplitudes_.emplace_back(stage, scene.stages, formula);
}

bool LoadHistory::is_straight(double from, double to) const {
  const std::vector<double> first = values_at(amplitudes_, from), last = values_at(amplitudes_, to);
  double length = 0.0, done = 0.0;
  for (size_t i = 0; i < first.size(); ++i) length += (last[i] - first[i]) * (last[i] - first[i]);
  for (int part = 1; part < kParts; ++part) {
    const std::vector<double> here = values_at(amplitudes_, from + (to - from) * part / kParts);
    double along = 0.0, all = 0.0;
    for (size_t i = 0; i < first.size(); ++i) {
      along += (here[i] - first[i]) * (last[i] - first[i]);
      all += (here[i] - first[i]) * (here[i] - first[i]);
    }
    const double aside = std::max(0.0, all - (length > 0.0 ? along * along / length : 0.0));
    if (aside > kOffLine * kOffLine * length || along < done || along > length) return false;
    done = along;
  }
  return true;
}

}  // namespace mixbeam
