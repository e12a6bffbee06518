#include "discretization/scene/amplitude.hpp"

#include "discretization/scene/what_acts.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace mixbeam {

namespace {

// Step for which rounding (1e-16 / step) and truncation (step^4) of the difference below are both about 1e-12.
constexpr double kDifferenceStep = 1e-3;

/// Samples of a stage, a prime lest a periodic formula hides between them: three meet a pulse of 1e-4 of it.
constexpr int kSamples = 32749;
/// Samples of a stage's length before the first stage and after the last one, where a path may stray.
constexpr int kSamplesOutside = 1021;
/// Least reversal that counts, over the range and the size of a formula: less is rounding.
constexpr double kLeastSwing = 1e-9, kRounding = 1e-13;
/// Distance below which turning points are merged; largest width of a jump.
constexpr double kSamePlace = 1e-12, kJumpWidth = 1e-15;
/// An interval with a jump keeps more than this share of its change after so many halvings towards the larger change;
/// others keep about an eighth.
constexpr double kShareOfJump = 0.3;
constexpr int kHalvings = 3;
/// Intervals with this share of the range, or so many times the change of their neighbours, may hold a jump.
constexpr double kLargeChange = 1e-3, kUnlikeNeighbours = 4.0;
/// Smooth peaks are found to 1e-8; a rounded place with the same value is preferred.
constexpr double kRoundedPlace = 1e7;
constexpr double kGolden = 0.6180339887498949;

/// Turning points and jumps of one formula.
struct Course {
  std::vector<LoadTurn> turns{};
  double range = 0.0;
};

class CourseFinder {
 public:
  CourseFinder(const Expression& formula, int stages) : formula_(formula), stages_(stages) {}

  Course find() {
    std::vector<Node> nodes = sampled(0.0, stages_, kSamples * stages_);
    if (!all_finite(nodes)) return {};  // reported when the scene is read, or when the path meets it
    const auto [low, high] =
        std::minmax_element(nodes.begin(), nodes.end(), [](const Node& a, const Node& b) { return a.value < b.value; });
    course_.range = high->value - low->value;
    tiny_ = std::max(kLeastSwing * course_.range, kRounding * std::max(std::abs(low->value), std::abs(high->value)));
    const std::vector<Node> before = sampled(-1.0, 0.0, kSamplesOutside),
                            after = sampled(stages_, stages_ + 1.0, kSamplesOutside);
    if (all_finite(before))
      nodes.insert(nodes.begin(), before.begin(), before.end() - 1);
    else
      course_.turns.push_back({0.0, 0.0});
    if (all_finite(after))
      nodes.insert(nodes.end(), after.begin() + 1, after.end());
    else
      course_.turns.push_back({1.0 * stages_, 1.0 * stages_});
    divide_at_jumps(nodes);
    return std::move(course_);
  }

 private:
  struct Node {
    double at, value;
  };
  static bool all_finite(const std::vector<Node>& nodes) {
    return std::all_of(nodes.begin(), nodes.end(), [](const Node& node) { return std::isfinite(node.value); });
  }

  std::vector<Node> sampled(double from, double to, int parts) const {
    std::vector<Node> nodes(parts + 1);
    for (int i = 0; i <= parts; ++i) {
      const double at = i == parts ? to : from + (to - from) * i / parts;
      nodes[i] = {at, formula_(at)};
    }
    return nodes;
  }

  void divide_at_jumps(const std::vector<Node>& nodes) {
    const auto change = [&](size_t i) {
      return i + 1 < nodes.size() ? std::abs(nodes[i + 1].value - nodes[i].value) : 0.0;
    };
    std::vector<Node> block{nodes.front()};
    for (size_t i = 0; i + 1 < nodes.size(); ++i) {
      const double beside = std::max(i > 0 ? change(i - 1) : 0.0, change(i + 1));
      if (change(i) > std::max(tiny_, std::min(kLargeChange * course_.range, kUnlikeNeighbours * beside)))
        if (const auto jump = jump_within(nodes[i], nodes[i + 1])) {
          block.push_back(jump->first);
          find_turns(block);
          course_.turns.push_back({jump->first.at, jump->second.at});
          block = {jump->second};
        }
      block.push_back(nodes[i + 1]);
    }
    find_turns(block);
  }

  std::optional<std::pair<Node, Node>> jump_within(Node left, Node right) const {
    const double whole = std::abs(right.value - left.value);
    for (int i = 1; right.at - left.at > kJumpWidth; ++i) {
      const double middle = 0.5 * (left.at + right.at);
      if (middle <= left.at || middle >= right.at) break;
      const Node here{middle, formula_(middle)};
      (std::abs(here.value - left.value) < std::abs(right.value - here.value) ? left : right) = here;
      const bool is_finite = std::isfinite(here.value);
      if (!is_finite || (i >= kHalvings && std::abs(right.value - left.value) < kShareOfJump * whole))
        return std::nullopt;
    }
    return std::pair{left, right};
  }

  /// Finds the turning points between two jumps.
  void find_turns(const std::vector<Node>& nodes) {
    size_t low = 0, high = 0;
    int direction = 0;
    for (size_t i = 1; i < nodes.size(); ++i) {
      const double value = nodes[i].value;
      if (direction <= 0 && value <= nodes[low].value) low = i;
      if (direction >= 0 && value >= nodes[high].value) high = i;
      if (direction >= 0 && nodes[high].value - value > tiny_) {
        if (direction > 0) add_turn(nodes, high, 1.0);
        direction = -1;
        low = i;
      } else if (direction <= 0 && value - nodes[low].value > tiny_) {
        if (direction < 0) add_turn(nodes, low, -1.0);
        direction = 1;
        high = i;
      }
    }
  }

  /// Refines an extreme sample by golden sections between its neighbours.
  void add_turn(const std::vector<Node>& nodes, size_t extreme, double sign) {
    double left = nodes[extreme - 1].at, right = nodes[std::min(extreme + 1, nodes.size() - 1)].at;
    const auto at = [&](double t) { return sign * formula_(t); };
    double a = right - kGolden * (right - left), b = left + kGolden * (right - left), of_a = at(a), of_b = at(b);
    while (right - left > kJumpWidth && a > left && b < right && a < b) {
      if (of_a > of_b) {
        right = std::exchange(b, a);
        of_b = of_a;
        of_a = at(a = right - kGolden * (right - left));
      } else {
        left = std::exchange(a, b);
        of_a = of_b;
        of_b = at(b = left + kGolden * (right - left));
      }
    }
    double place = 0.5 * (left + right);
    if (sign * nodes[extreme].value >= at(place)) place = nodes[extreme].at;
    const double rounded = std::round(place * kRoundedPlace) / kRoundedPlace;
    if (at(place) - at(rounded) <= 1e-3 * tiny_) place = rounded;
    course_.turns.push_back({place, place});
  }

  const Expression& formula_;
  int stages_;
  double tiny_ = 0.0;
  Course course_;
};

/// Course of a formula, cached: models of a scene are built repeatedly, on other meshes, for errors, for its cases.
Course course_of(const std::string& formula, int stages) {
  constexpr size_t kMostKept = 10000;
  thread_local std::map<std::pair<std::string, int>, Course> known;
  if (known.size() > kMostKept) known.clear();
  const auto found = known.find({formula, stages});
  if (found != known.end()) return found->second;
  return known[{formula, stages}] = CourseFinder(Expression(formula, {"t"}), stages).find();
}

/// Tolerance for loads along one line, over the largest component; range of a sum, over those of its parts, below which
/// it may be rounding. Each distinct sum costs the samples of a formula, 2 ms for each stage.
constexpr double kAlongOneLine = 1e-12, kLeastSum = 1e-6;
constexpr size_t kMostSums = 20;
/// Largest deviation of amplitudes from straight lines, over their ranges.
constexpr double kPlain = 1e-12;
constexpr int kPlainSamples = 64;
/// Distance beyond a stage up to which its formulas are sampled, in load factors.
constexpr double kStrays = 1.0;
/// Parts of a step at which a load history is sampled.
constexpr int kParts = 8;
/// Largest deviation of a load history from a straight line, over its length, for a step to be straight.
constexpr double kOffLine = 1e-2;
/// Share of a piece that counts as its end, and share over which rates at the ends of the range are taken: loads that
/// cancel each other over the whole piece do not at its ends.
constexpr double kEndOfPiece = 1e-12, kShareOfRates = 1e-3;

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

double Amplitude::at(double load_factor) const { return formula_ ? (*formula_)(load_factor) : ramp(load_factor); }

double Amplitude::operator()(double load_factor) const {
  return clock_ && clock_->piece() ? clock_->value(*this, load_factor) : at(load_factor);
}

double Amplitude::slope(double load_factor) const {
  const double h = kDifferenceStep;
  double middle = load_factor;
  if (clock_ && clock_->piece()) {  // a piece ends in a corner of the loads
    const double from = clock_->piece()->from, to = clock_->piece()->end();
    if (from <= middle && middle <= to) middle = std::clamp(middle, from + 2 * h, to - 2 * h);
  } else if (!formula_) {
    return ramp_slope(load_factor);
  }
  const auto f = [&](double offset) { return (*this)(middle + offset); };
  return (f(-2 * h) - 8 * f(-h) + 8 * f(h) - f(2 * h)) / (12 * h);
}

namespace {

/// Formula of an amplitude, that of a ramp too.
std::string formula_of(const std::string& amplitude, Stage stage, Stage stages) {
  if (!amplitude.empty()) return amplitude;
  std::string ramp = "t-" + std::to_string(stage - 1);
  if (stage > 1) ramp = "max(0," + ramp + ")";
  return stage < stages ? "min(1," + ramp + ")" : ramp;
}

}  // namespace

std::string centrifugal_growth(const RotatingFrame& frame, Stage stages) {
  return "(" + formula_of(frame.amplitude, frame.stage, stages) + ")^2";
}

namespace {

/// Loads of one place act alike except for their vectors.
using Place = std::tuple<std::string, std::string, LoadFrame, std::string, bool, bool, std::array<double, 2>>;
Place place_of(const PointLoad& load) {
  return {load.point, load.member, load.frame, load.load_case, false, false, {-1.0, -1.0}};
}
Place place_of(const DistributedLoad& load) {
  return {load.member, "", load.frame, load.load_case, load.is_projected, load.is_weight, load.range};
}

/// Amplitudes by stage and formula, and the size with which each of them acts.
using Growths = std::map<std::pair<Stage, std::string>, double>;

/// Loads along one line at one place: they reverse where the sum of their amplitudes does.
struct Together {
  std::array<double, 6> way{};  ///< direction of the first, scaled to a largest component of 1
  Growths growths{};

  /// Adds a load that is along the line; otherwise false.
  bool take(const std::pair<Stage, std::string>& growth, const std::array<double, 6>& load) {
    const size_t largest = std::max_element(way.begin(), way.end(), is_smaller) - way.begin();
    const double size = load[largest];
    for (size_t i = 0; i < way.size(); ++i)
      if (!(std::abs(load[i] - size * way[i]) <= kAlongOneLine * std::abs(size))) return false;
    growths[growth] += size;
    return true;
  }
  static bool is_smaller(double a, double b) { return std::abs(a) < std::abs(b); }
};

/// Adds a load to its line; false for a zero load, and if there are too many lines.
bool take(std::vector<Together>& lines, const std::pair<Stage, std::string>& growth,
          const std::array<double, 6>& load) {
  for (Together& line : lines)
    if (line.take(growth, load)) return true;
  const double largest = *std::max_element(load.begin(), load.end(), Together::is_smaller);
  if (largest == 0.0 || lines.size() >= kMostSums) return false;
  lines.emplace_back();
  for (size_t i = 0; i < load.size(); ++i) lines.back().way[i] = load[i] / largest;
  return lines.back().take(growth, load);
}

std::string sum_of(const Growths& growths, Stage stages) {
  std::string sum;
  for (const auto& [growth, size] : growths)
    sum += (sum.empty() ? "(" : "+(") + shortest(size) + ")*(" + formula_of(growth.second, growth.first, stages) + ")";
  return sum;
}

/// Formula by which a load grows; empty: a ramp.
template <class Load>
const std::string& growth_of(const Load& load, Stage) {
  return load.amplitude;
}
std::string growth_of(const RotatingFrame& frame, Stage stages) { return centrifugal_growth(frame, stages); }

/// Adds loads that act by themselves to `alone`, the rest to the sums of its place.
template <class Load, class Kind>
void add_to(std::map<Place, std::vector<Together>>& places, std::set<std::pair<Stage, std::string>>& alone,
            const Load& load, const Kind&, Stage stages) {
  const std::pair<Stage, std::string> growth{load.stage, growth_of(load, stages)};
  if constexpr (std::is_same_v<Load, PointLoad> || std::is_same_v<Load, DistributedLoad>) {
    std::array<double, 6> vectors{};
    size_t next = 0;
    bool is_constant = true;
    Kind::for_each_vector(load, [&](const Vector3& vector, const Formulas* formula, VectorRole) {
      for (size_t i = 0; i < 3; ++i) {
        vectors[next++] = vector[i];
        is_constant = is_constant && (formula == nullptr || (*formula)[i].empty());
      }
    });
    if (!is_constant || !take(places[place_of(load)], growth, vectors)) alone.insert(growth);
  } else if (Kind::acts(load)) {
    alone.insert(growth);
  }
}

/// Distinct amplitudes of a scene, with those of loads along one line at one place summed: a part may still grow where
/// the load reverses. Returns `all` if sums are many, or nearly vanish and reverse by rounding.
std::set<std::pair<Stage, std::string>> with_sums(const Scene& scene, std::set<std::pair<Stage, std::string>> all) {
  std::map<Place, std::vector<Together>> places;
  std::set<std::pair<Stage, std::string>> result;
  for_each_acting(scene, [&](const auto& load, auto kind) { add_to(places, result, load, kind, scene.stages); });
  std::set<Growths> seen;
  for (const auto& [place, lines] : places)
    for (const Together& line : lines) {
      Growths growths;
      for (const auto& [growth, size] : line.growths)
        if (size != 0.0) growths.emplace(growth, size);
      if (growths.size() == 1) result.insert(growths.begin()->first);
      if (growths.size() < 2) continue;
      const double first = growths.begin()->second;
      double parts = 0.0;
      for (auto& [growth, size] : growths) {
        size /= first;
        parts += std::abs(size) * course_of(formula_of(growth.second, growth.first, scene.stages), scene.stages).range;
      }
      if (!seen.insert(growths).second) continue;
      if (seen.size() > kMostSums) return all;
      const std::string sum = sum_of(growths, scene.stages);
      if (course_of(sum, scene.stages).range < kLeastSum * parts) return all;
      result.insert({1, sum});
    }
  return result;
}

}  // namespace

LoadClock::LoadClock(const Scene& scene) : stages_(scene.stages) {
  std::set<std::pair<Stage, std::string>> different;
  for_each_acting(scene, [&](const auto& load, auto kind) {
    if (kind.acts(load)) different.insert({load.stage, growth_of(load, scene.stages)});
  });
  if (std::all_of(different.begin(), different.end(), [](const auto& d) { return d.second.empty(); })) return;
  if (different.size() > 1) different = with_sums(scene, std::move(different));
  std::vector<LoadTurn> all;
  for (const auto& [stage, formula] : different) {
    const Course course = formula.empty() ? Course{{}, 1.0} : course_of(formula, scene.stages);
    amplitudes_.push_back({stage, formula, Amplitude(stage, scene.stages, formula), course.range});
    all.insert(all.end(), course.turns.begin(), course.turns.end());
  }
  std::sort(all.begin(), all.end(), [](const LoadTurn& a, const LoadTurn& b) { return a.before < b.before; });
  for (const LoadTurn& turn : all) {
    if (turns_.empty() || turn.before > turns_.back().after + kSamePlace)
      turns_.push_back(turn);
    else if (turn.is_jump())
      turns_.back() = {turns_.back().is_jump() ? turns_.back().before : turn.before,
                       std::max(turns_.back().after, turn.after)};
  }
}

/// Whether all amplitudes change at constant rates; formulas also beyond the stage, where a path may stray and where
/// differences for slopes reach (a ramp continues there by itself).
bool LoadClock::is_plain(double from, double to) const {
  for (const Distinct& one : amplitudes_) {
    const double beyond = one.formula.empty() ? 0.0 : kStrays, begin = from - beyond, length = to - from + 2.0 * beyond;
    const double first = one.amplitude.at(begin), change = one.amplitude.at(begin + length) - first;
    const double allowed = kPlain * std::max(one.range, std::abs(first));
    for (int i = 1; i < kPlainSamples; ++i) {
      const double share = static_cast<double>(i) / kPlainSamples;
      if (!(std::abs(one.amplitude.at(begin + share * length) - first - share * change) <= allowed)) return false;
    }
  }
  return true;
}

std::vector<LoadPiece> LoadClock::pieces(Stage stage) const {
  const double from = stage - 1.0, to = stage;
  std::vector<LoadPiece> pieces;
  LoadPiece next{from, to, -1.0, stages_ + 1.0};
  const auto end_at = [&](double place) {
    next.to = next.high = place;
    if (next.to > next.from) pieces.push_back(next);
  };
  for (const LoadTurn& turn : turns_) {
    if (turn.after <= from + (turn.is_jump() ? 0.0 : kSamePlace)) {
      next.low = std::min(from, turn.after);
      continue;
    }
    if (turn.before >= to - (turn.is_jump() ? 0.0 : kSamePlace)) {
      next.high = std::max(to, turn.before);
      break;
    }
    const double before = std::max(from, turn.before), after = std::min(to, turn.after);
    end_at(before);
    if (turn.is_jump()) pieces.push_back({before, after, before, after, true});
    next = {after, to, after, stages_ + 1.0};
  }
  next.to = to;
  next.high = std::max(to, next.high);
  if (next.to > next.from) pieces.push_back(next);
  if (pieces.size() == 1) pieces.front().is_plain = is_plain(from, to);
  return pieces;
}

std::optional<LoadPiece> LoadClock::run(const std::optional<LoadPiece>& piece) {
  const std::optional<LoadPiece> before = piece_;
  piece_ = piece && !piece->is_plain ? piece : std::nullopt;
  known_.fill({std::nan(""), {}});
  moving_.clear();
  total_ = 0.0;
  if (!piece_) return before;
  for (const Distinct& one : amplitudes_) {
    const double start = one.amplitude.at(piece_->from), change = one.amplitude.at(piece_->to) - start;
    if (!(std::abs(change) > kRounding * std::max(one.range, std::abs(start)))) continue;
    moving_.push_back({start, 1.0 / std::max(one.range, std::abs(change)), &one.amplitude});
    total_ += moving_.back().weight * std::abs(change);
  }
  return before;
}

/// Share of the weighted changes of all amplitudes in the piece: theory (69).
double LoadClock::progress(double load_factor) const {
  if (moving_.empty()) return (load_factor - piece_->from) / (piece_->to - piece_->from);
  double sum = 0.0;
  for (const Moving& one : moving_) sum += one.weight * std::abs(one.amplitude->at(load_factor) - one.start);
  return std::copysign(sum / total_, load_factor - piece_->from);
}

/// The smallest load factor with that progress.
double LoadClock::load_factor_at(double share, double low, double high) const {
  for (double middle = 0.5 * (low + high); low < middle && middle < high; middle = 0.5 * (low + high))
    (progress(middle) >= share ? high : low) = middle;
  return high;
}

LoadClock::Moment LoadClock::at(double parameter) const {
  const LoadPiece& piece = *piece_;
  const double share = parameter - piece.from;
  if (share == 0.0) return {piece.from, 0.0};
  if (std::abs(share - 1.0) <= kEndOfPiece) return {piece.to, 0.0};
  if (piece.is_jump) return {piece.from, share};
  for (const auto& [known, moment] : known_)
    if (known == parameter) return moment;
  const double least = progress(piece.low), most = progress(piece.high);
  Moment found;
  if (share < least)
    found = {piece.low, share - least};
  else if (share > most)
    found = {piece.high, share - most};
  else if (share < 0.0)
    found = {load_factor_at(share, piece.low, piece.from), 0.0};
  else if (share < 1.0)
    found = {load_factor_at(share, piece.from, piece.to), 0.0};
  else
    found = {load_factor_at(share, piece.to, piece.high), 0.0};
  known_[next_known_++ % known_.size()] = {parameter, found};
  return found;
}

double LoadClock::load_factor(double parameter) const {
  if (!piece_) return parameter;
  const Moment moment = at(parameter);
  return moment.load_factor + moment.beyond * (piece_->to - piece_->from);
}

double LoadClock::value(const Amplitude& amplitude, double parameter) const {
  if (!piece_) return amplitude.at(parameter);
  const Moment moment = at(parameter);
  const double value = amplitude.at(moment.load_factor);
  if (moment.beyond == 0.0) return value;
  if (moving_.size() < 2 || piece_->is_jump)
    return value + moment.beyond * (amplitude.at(piece_->to) - amplitude.at(piece_->from));
  const double share = std::copysign(kShareOfRates, moment.beyond);
  const Moment inside = at(parameter - moment.beyond - share);
  return value + moment.beyond * (value - amplitude.at(inside.load_factor)) / share;
}

double LoadClock::largest_rate(Stage stage, const std::string& formula) const {
  for (const Distinct& one : amplitudes_)
    if (one.stage == stage && one.formula == formula)
      for (const Moving& moving : moving_)
        if (moving.amplitude == &one.amplitude) return total_ / moving.weight;
  return 0.0;
}

std::vector<double> LoadClock::values_at(double parameter) const {
  std::vector<double> values;
  for (const Distinct& one : amplitudes_) values.push_back(value(one.amplitude, parameter));
  return values;
}

bool LoadClock::is_straight(double from, double to) const {
  const std::vector<double> first = values_at(from), last = values_at(to);
  double length = 0.0, done = 0.0;
  for (size_t i = 0; i < first.size(); ++i) length += (last[i] - first[i]) * (last[i] - first[i]);
  for (int part = 1; part < kParts; ++part) {
    const std::vector<double> here = values_at(from + (to - from) * part / kParts);
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
