#include "nonlinear/stability/mode_tracks.hpp"

#include "nonlinear/stability/block_krylov.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Relative difference of omega^2 below which modes are arbitrary vectors of one space (a residual of 1e-8 mixes them
/// by one per cent there); and the same over the largest omega^2, for rigid motions.
constexpr double kSharedFrequency = 1e-6, kSharedZero = 1e-12;
/// Twice the MAC below which modes are different motions: a cosine of one half.
constexpr double kUnlike = 2.0 * 0.25;
/// Difference below which likenesses are equal, so that the nearest frequency decides.
constexpr double kEquallyLike = 1e-6;

/// Returns (i, j): whether modes share a frequency, or are conjugate.
template <class Motions>
std::vector<std::vector<char>> shared_frequencies(const Motions& motions) {
  double largest = 0.0;
  for (const auto& one : motions) largest = std::max(largest, std::abs(one.squared));
  std::vector<std::vector<char>> shared(motions.size(), std::vector<char>(motions.size()));
  for (std::size_t i = 0; i < motions.size(); ++i)
    for (std::size_t j = 0; j < motions.size(); ++j) {
      const std::complex<double>&a = motions[i].squared, &b = motions[j].squared;
      const double distance = std::min(std::abs(a - b), std::abs(a - std::conj(b)));
      shared[i][j] = distance <= std::max(kSharedFrequency * std::abs(a), kSharedZero * largest);
    }
  return shared;
}

}  // namespace

/// MAC of two modes. `reversed`: with the motion b in the opposite sense of rotation.
double ModeTracks::likeness(const Motion& a, const Motion& b, bool reversed) {
  const auto product = [&](int i, int j) {
    return a.momenta[i].size() == b.momenta[j].size() ? dot_product(a.momenta[i], b.momenta[j]) : 0.0;
  };
  const double sign = reversed ? -1.0 : 1.0;
  return std::norm(std::complex<double>(product(0, 0) + sign * product(1, 1), sign * product(0, 1) - product(1, 0)));
}

/// Returns (mode, motion before): MAC plus that of the whole space, which is equal if no frequency is shared.
ModeTracks::Table ModeTracks::likenesses(const std::vector<Motion>& now, const std::vector<Motion>& before,
                                         bool reversed) {
  const std::size_t n = now.size(), m = before.size();
  Table mac(n, std::vector<double>(m)), table = mac;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < m; ++j) mac[i][j] = likeness(now[i], before[j], reversed);
  const auto with = shared_frequencies(now), with_before = shared_frequencies(before);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < m; ++j) {
      double in_space_before = 0.0, in_space = 0.0;
      for (std::size_t k = 0; k < m; ++k) in_space_before += with_before[j][k] ? mac[i][k] : 0.0;
      for (std::size_t k = 0; k < n; ++k) in_space += with[i][k] ? mac[k][j] : 0.0;
      table[i][j] = mac[i][j] + std::min(1.0, std::max(in_space, in_space_before));
    }
  return table;
}

/// Assigns motions of `before` to modes without a track, the most alike first. `place`: (mode) index in `before` plus
/// `first`. In a rotating frame a frequency may pass zero, and its motion continues in the opposite sense.
void ModeTracks::find(const std::vector<Motion>& before, int first, std::vector<Motion>& now, std::vector<int>& place) {
  for (const bool reversed : {false, true}) {
    const Table table = likenesses(now, before, reversed);
    for (int mode = 0; mode >= 0;) {
      double most = kUnlike, nearest = HUGE_VAL;
      mode = -1;
      int motion = -1;
      for (std::size_t i = 0; i < now.size(); ++i)
        for (std::size_t j = 0; j < before.size() && now[i].track < 1; ++j) {
          const double distance = std::abs(std::sqrt(now[i].squared) - std::sqrt(before[j].squared));
          const bool is_as_like = table[i][j] >= most - kEquallyLike && distance < nearest;
          const bool is_taken = std::find(place.begin(), place.end(), first + static_cast<int>(j)) != place.end();
          if (is_taken || !(table[i][j] > most + kEquallyLike || is_as_like)) continue;
          most = std::max(most, table[i][j]);
          nearest = distance;
          mode = static_cast<int>(i);
          motion = static_cast<int>(j);
        }
      if (mode < 0) continue;
      place[mode] = first + motion;
      now[mode].track = before[motion].track;
    }
  }
}

void ModeTracks::keep(std::vector<Motion> now) {
  std::vector<Motion> absent;
  for (std::vector<Motion>* motions : {&before_, &absent_})
    for (Motion& motion : *motions) {
      const auto is_same = [&](const Motion& other) { return other.track == motion.track; };
      if (absent.size() < now.size() && std::none_of(now.begin(), now.end(), is_same))
        absent.push_back(std::move(motion));
    }
  absent_ = std::move(absent);
  before_ = std::move(now);
}

std::vector<int> ModeTracks::follow(std::vector<VibrationMode>& modes, const std::vector<int>& known) {
  std::vector<Motion> now;
  for (VibrationMode& mode : modes) {
    Motion& motion = now.emplace_back(Motion{0, -mode.rate * mode.rate, std::move(mode.momenta)});
    double sum = 0.0;
    for (const std::vector<double>& part : motion.momenta) sum += dot_product(part, part);
    for (std::vector<double>& part : motion.momenta)
      for (double& x : part) x /= std::sqrt(sum);
  }
  std::vector<int> place(now.size(), -1), tracks;
  for (std::size_t i = 0; i < std::min(known.size(), now.size()); ++i) {
    now[i].track = known[i];
    for (std::size_t j = 0; j < before_.size() && known[i] > 0; ++j)
      if (before_[j].track == known[i]) place[i] = static_cast<int>(j);
  }
  const int present = static_cast<int>(before_.size());
  find(before_, 0, now, place);
  find(absent_, present, now, place);
  for (Motion& motion : now) {
    if (motion.track < 1) motion.track = ++tracks_;
    tracks.push_back(motion.track);
  }
  // If frequencies cross exactly at this state its modes are mixed: keep those of the state before for comparison.
  const auto with = shared_frequencies(now), with_before = shared_frequencies(before_);
  const auto was_present = [&](std::size_t i) { return place[i] >= 0 && place[i] < present; };
  for (std::size_t i = 0; i < now.size(); ++i)
    for (std::size_t k = 0; k < now.size() && was_present(i); ++k)
      if (with[i][k] && was_present(k) && !with_before[place[i]][place[k]]) now[i].momenta = before_[place[i]].momenta;
  keep(std::move(now));
  return tracks;
}

}  // namespace mixbeam
