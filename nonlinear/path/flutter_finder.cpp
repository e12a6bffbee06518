#include "nonlinear/path/flutter_finder.hpp"

#include "discretization/text/errors.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/path/thresholds.hpp"
#include "nonlinear/stability/vibration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace mixbeam {

namespace {

/// Least number of frequencies examined: a round column has each of them twice.
constexpr int kLeastModes = 6, kLeastDamped = 4;
/// Ratio of imaginary part to magnitude above which omega^2 is complex: equal values differ by the root of rounding.
constexpr double kComplex = 1e-6;
/// Ratio of the growth rate to |s| above which a motion grows, consistent with kComplex; for damped motions the
/// rounding of Sample::largest_growth().
constexpr double kGrows = 0.5 * kComplex, kDampedGrows = 1e-13;
/// Relative distance within which complex values, or their conjugates, meet together.
constexpr double kTogether = 1e-4;
/// Relative change of the load factor at which a flutter point is located: below, rounding of the discriminant decides.
constexpr double kLocated = 1e-13;
/// Limits of samples (usually ten, by bisection alone 45) and of halvings on the way to the first complex values.
constexpr int kMostSamples = 90, kMostHalvings = 20;

bool is_complex(const std::complex<double>& squared) { return std::abs(squared.imag()) > kComplex * std::abs(squared); }
bool lies_between(double x, double a, double b) { return x > std::min(a, b) && x < std::max(a, b); }

}  // namespace

bool may_flutter(const Scene& scene) {
  const Vector3 none{};
  const auto has_couple = [](const DistributedLoad& load) {
    return load.couple != Vector3{} || std::any_of(load.couple_formula.begin(), load.couple_formula.end(),
                                                   [](const std::string& text) { return !text.empty(); });
  };
  return !scene.rotating_frames.empty() ||
         std::any_of(scene.point_loads.begin(), scene.point_loads.end(),
                     [&](const PointLoad& load) { return load.frame != LoadFrame::dead || load.moment != none; }) ||
         std::any_of(scene.distributed_loads.begin(), scene.distributed_loads.end(),
                     [&](const DistributedLoad& load) { return load.frame != LoadFrame::dead || has_couple(load); });
}

FlutterFinder::FlutterFinder(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters)
    : problem_(problem),
      asked_(parameters.analysis.modes),
      damped_(std::any_of(problem->model.scene().sections.begin(), problem->model.scene().sections.end(),
                          [](const Section& s) { return s.mass_damping > 0.0 || s.stiffness_damping > 0.0; })),
      corrector_(problem, parameters, record_, NewtonPurpose::check) {}

int FlutterFinder::Sample::complex_values() const {
  return static_cast<int>(std::count_if(squared.begin(), squared.end(), is_complex));
}

std::complex<double> FlutterFinder::Cluster::mean(const Sample& sample) const {
  const auto begin = sample.squared.begin() + static_cast<std::ptrdiff_t>(first);
  return std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(count), std::complex<double>{}) /
         static_cast<double>(count);
}

int FlutterFinder::Sample::growing() const {
  return static_cast<int>(std::count_if(rates.begin(), rates.end(), [](const std::complex<double>& rate) {
    return rate.real() > kGrows * std::abs(rate);
  }));
}

/// Scales rates by the rounding of 1 / s, which are the computed values: that of the largest, with the least exponent.
double FlutterFinder::Sample::largest_growth() const {
  double least = HUGE_VAL, largest = -HUGE_VAL;
  for (const std::complex<double>& rate : rates) least = std::min(least, std::abs(rate));
  for (const std::complex<double>& rate : rates) largest = std::max(largest, rate.real() * least / std::norm(rate));
  return largest;
}

size_t FlutterFinder::Sample::most_growing() const {
  const auto grows_less = [](const auto& a, const auto& b) { return a.real() < b.real(); };
  return static_cast<size_t>(std::max_element(rates.begin(), rates.end(), grows_less) - rates.begin());
}

/// Variance over the square of the mean: for two values a quarter of the square of their difference, which is real even
/// if they are complex, and smooth where they meet.
double FlutterFinder::Cluster::discriminant(const Sample& sample) const {
  const std::complex<double> mean = this->mean(sample);
  std::complex<double> sum{};
  for (size_t i = first; i < first + count; ++i) sum += (sample.squared[i] - mean) * (sample.squared[i] - mean);
  return sum.real() / std::norm(mean);
}

FlutterFinder::Sample FlutterFinder::look(const State& state, double load_factor) const {
  Sample sample{state, load_factor};
  const int count = std::max(damped_ ? kLeastDamped : kLeastModes, asked_.number);
  for (VibrationMode& mode : vibration_modes(*problem_, state, load_factor, count, asked_.in_plane)) {
    sample.squared.push_back(-mode.rate * mode.rate);
    sample.rates.push_back(mode.rate);
    sample.modes.push_back(std::move(mode.pair.mode));
  }
  return sample;
}

std::optional<FlutterFinder::Sample> FlutterFinder::between(const Sample& from, double load_factor) {
  const Correction found =
      corrector_.at_load(from.state, load_factor, static_cast<int>(path_limit.most_iterations_nearby));
  record_.clear();
  if (!found.converged) return std::nullopt;
  return look(found.state, load_factor);
}

/// Cluster of the complex values with the lowest frequency and those equal to them.
FlutterFinder::Cluster FlutterFinder::cluster_of(const Sample& sample) {
  const auto& all = sample.squared;
  const size_t first = static_cast<size_t>(std::find_if(all.begin(), all.end(), is_complex) - all.begin());
  const auto belongs = [&](const std::complex<double>& z) {
    const double distance = std::min(std::abs(z - all[first]), std::abs(std::conj(z) - all[first]));
    return is_complex(z) && distance <= kTogether * std::abs(all[first]);
  };
  Cluster cluster{first, 0};
  while (first + cluster.count < all.size() && belongs(all[first + cluster.count])) ++cluster.count;
  return cluster;
}

/// Finds a sample with more complex values between `low` and a state in which more motions grow, and moves `low` next
/// to it: two values may have met, separated below zero, and be real at the end of a step. None if one passes zero
/// alone.
std::optional<FlutterFinder::Sample> FlutterFinder::first_complex(Sample& low, Sample high) {
  for (int i = 0; i < kMostHalvings && high.growing() > low.growing(); ++i) {
    if (high.complex_values() > low.complex_values()) return high;
    if (high.growing() == low.growing() + 1) return std::nullopt;
    std::optional<Sample> middle = between(low, 0.5 * (low.load_factor + high.load_factor));
    if (!middle || middle->squared.size() != low.squared.size()) return std::nullopt;
    (middle->growing() > low.growing() ? high : low) = std::move(*middle);
  }
  return std::nullopt;
}

/// Locates the zero of the discriminant, or of the largest rate of damped motions, by regula falsi (Illinois); halves
/// the bracket if that is slow: with mass damping alone the rate is flat, then a square root.
std::optional<CriticalPoint> FlutterFinder::locate(Sample low, Sample high) {
  const int at_low = low.complex_values();
  if (low.rates.empty() || high.rates.empty()) return std::nullopt;
  Cluster cluster = damped_ ? Cluster{} : cluster_of(high);
  double here = high.load_factor, change = HUGE_VAL, width_before = HUGE_VAL;
  std::array<double, 2> weight{1.0, 1.0};  // an end that stays twice counts half
  std::optional<bool> replaced_high;
  for (int i = 0; i < kMostSamples; ++i) {
    const auto value = [&](const Sample& sample) {
      return damped_ ? sample.largest_rate() : -cluster.discriminant(sample);
    };
    const double of_low = weight[0] * value(low), of_high = weight[1] * value(high);
    const double width = std::abs(high.load_factor - low.load_factor);
    const bool halves = i % 2 == 1 && width > 0.5 * width_before;
    if (i % 2 == 1) width_before = width;
    double next = high.load_factor - of_high * (high.load_factor - low.load_factor) / (of_high - of_low);
    if (halves || !(of_low < 0.0 && of_high > 0.0) || !lies_between(next, low.load_factor, high.load_factor))
      next = 0.5 * (low.load_factor + high.load_factor);
    change = halves ? width : std::abs(next - here);
    here = next;
    if (change <= kLocated * std::abs(here) || next == low.load_factor || next == high.load_factor) break;
    std::optional<Sample> sample = between(low, here);
    if (!sample || sample->rates.size() < std::max<size_t>(1, cluster.first + cluster.count)) return std::nullopt;
    const bool is_high = damped_ ? sample->largest_rate() > 0.0 : sample->complex_values() > at_low;
    weight[is_high] = 1.0;
    weight[!is_high] *= replaced_high == is_high ? 0.5 : 1.0;
    replaced_high = is_high;
    (is_high ? high : low) = std::move(*sample);
    if (!damped_) cluster = cluster_of(high);
  }
  const double width = high.load_factor - low.load_factor,
               share = width == 0.0 ? 1.0 : (here - low.load_factor) / width;
  const auto between_ends = [share](auto at, auto next) { return (1.0 - share) * at + share * next; };
  const size_t mode = damped_ ? high.most_growing() : cluster.first;
  CriticalPoint point{CriticalKind::flutter, here, at_low / 2, high.complex_values() / 2, high.state, high.modes[mode]};
  point.error = change;
  if (damped_) {
    point.negative_before = 0, point.negative_after = 1;
    point.omega = between_ends(low.rates[low.most_growing()].imag(), high.rates[mode].imag());
  } else {
    point.modes = static_cast<int>(cluster.count);
    point.omega = std::sqrt(std::abs(between_ends(cluster.mean(low), cluster.mean(high))));
  }
  return point;
}

/// Locates the point between a state and one about which more motions grow.
std::optional<CriticalPoint> FlutterFinder::entered(Sample low, const Sample& high) {
  if (damped_)
    return low.largest_growth() <= kDampedGrows && high.largest_growth() > kDampedGrows ? locate(low, high)
                                                                                        : std::nullopt;
  if (low.squared.size() != high.squared.size() || high.growing() <= low.growing()) return std::nullopt;
  std::optional<Sample> end = first_complex(low, high);
  if (!end || end->complex_values() <= low.complex_values()) return std::nullopt;
  return locate(std::move(low), std::move(*end));
}

std::vector<CriticalPoint> FlutterFinder::passed(const State& state, double load_factor, bool held) {
  std::vector<CriticalPoint> found;
  try {
    const bool looks = before_ && !(held && before_->squared.empty());
    if (looks && before_->squared.empty()) before_ = look(before_->state, before_->load_factor);
    Sample here = held && !looks ? Sample{state, load_factor} : look(state, load_factor);
    const auto add = [&](const Sample& from, const Sample& to) {
      std::optional<CriticalPoint> point = entered(from, to);
      if (!point && (point = entered(to, from))) std::swap(point->negative_before, point->negative_after);
      if (point) found.push_back(std::move(*point));
    };
    if (looks) {
      std::optional<Sample> middle;
      if (!damped_ && here.growing() == before_->growing())
        middle = between(*before_, 0.5 * (before_->load_factor + load_factor));
      if (middle) add(*before_, *middle);
      add(middle ? *middle : *before_, here);
    }
    if (held) here = {state, load_factor};
    before_ = std::move(here);
  } catch (const LinearSolverError&) {  // equations cannot be solved: the request for modes reports that
    before_.reset();
  } catch (const InputError&) {  // no masses
    before_.reset();
  }
  return found;
}

}  // namespace mixbeam
