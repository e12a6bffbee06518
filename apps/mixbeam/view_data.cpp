#include "apps/mixbeam/view_page.hpp"

#include "apps/common/tables/formatted.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

namespace mixbeam {

namespace {

using Json = nlohmann::json;
using Point = Vector3;

constexpr std::size_t kMostSeries = 1200;    // time series to choose from
constexpr double kMostNumbers = 12e6;        // of the steps in memory: 100 MB
constexpr double kNumbersOfSample = 19.0;    // of a step without stresses
constexpr double kSame = 0.5;                // largest difference of strains from compliance times force, in units
constexpr double kFlat = 1e-6;               // largest relative thickness of a plane structure
constexpr double kThinRod = 1.0 / 110.0;     // diameter over size of members without shape,
constexpr double kSlenderRod = 0.1;          // at most this share of the median member length
constexpr std::size_t kFewNumbers = 100000;  // samples times steps up to which a page has all section directions
constexpr int kDirections = 120;             // number of directions for corners of the path's hull
constexpr double kNoise = 1e-9;              // section forces below this share of the largest one are round-off
constexpr double kNoLoad = 1e-12;            // likewise moments below this share of EI / size, if none is larger
constexpr double kLeastStrain = 1e-6, kLeastTurn = 1e-3;  // scales of round-off: strains; curvatures times size
constexpr double kMoved = 1e-9;                           // share of the size; smaller changes along a path are ignored
constexpr double kBeforeAny = -1e30;                      // begin of loads given by formulas
constexpr const char* kDrawnAs = "drawn as ";             // prefix of the shape of a section given by stiffnesses
const std::array<const char*, 2> kForces = {"material_force", "material_moment"};
const std::array<const char*, 2> kStrains = {"force_strain", "moment_strain"};  // their strains
const std::array<const char*, 3> kStresses = {"largest_normal_stress", "largest_shear_stress", "von_mises_stress"};
const double kUnknown = std::numeric_limits<double>::quiet_NaN();

bool is_stress(const std::string& name) {
  return std::find(kStresses.begin(), kStresses.end(), name) != kStresses.end();
}

/// A scalar at every sample that colours the structure: a component of a field, or the norm of several.
struct PageField {
  std::string name, label, source;
  std::vector<std::size_t> components;  ///< empty: a scalar field
  bool is_signed;
};

const std::vector<PageField>& page_fields() {
  static const std::vector<PageField> all = {
      {"moment", "moment |M|", "material_moment", {0, 1, 2}, false},
      {"bending", "bending moment √(M₂²+M₃²)", "material_moment", {1, 2}, false},
      {"axial_force", "axial force N", "material_force", {0}, true},
      {"shear_2", "shear force Q₂", "material_force", {1}, true},
      {"shear_3", "shear force Q₃", "material_force", {2}, true},
      {"torsion", "torsional moment T", "material_moment", {0}, true},
      {"bending_2", "bending moment M₂", "material_moment", {1}, true},
      {"bending_3", "bending moment M₃", "material_moment", {2}, true},
      {"shear", "shear force √(Q₂²+Q₃²)", "material_force", {1, 2}, false},
      {"force", "force |N|", "material_force", {0, 1, 2}, false},
      {"axial_strain", "axial strain γ₁", "force_strain", {0}, true},
      {"strain", "force strain |γ|", "force_strain", {0, 1, 2}, false},
      {"twist", "twist κ₁", "moment_strain", {0}, true},
      {"curvature", "bending strain √(κ₂²+κ₃²)", "moment_strain", {1, 2}, false},
      {"displacement", "displacement |u|", "displacement", {0, 1, 2}, false},
      {"von_mises", "von Mises stress, largest of the section", "von_mises_stress", {}, false},
      {"utilisation", "utilisation: von Mises stress over strength", "utilisation", {}, false},
      {"normal_stress", "normal stress σ₁₁, largest of the section", "largest_normal_stress", {}, true},
      {"shear_stress", "shear stress |τ|, largest of the section", "largest_shear_stress", {}, false},
      {"displacement_x", "displacement x", "displacement", {0}, true},
      {"displacement_y", "displacement y", "displacement", {1}, true},
      {"displacement_z", "displacement z", "displacement", {2}, true},
      {"shear_strain_2", "shear strain γ₂", "force_strain", {1}, true},
      {"shear_strain_3", "shear strain γ₃", "force_strain", {2}, true},
      {"curvature_2", "bending strain κ₂", "moment_strain", {1}, true},
      {"curvature_3", "bending strain κ₃", "moment_strain", {2}, true}};
  return all;
}

/// Units of length and force of the scene; empty if not given.
struct Units {
  std::string length{}, force{};
  explicit Units(const std::string& text) {
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos || text.find(',', comma + 1) != std::string::npos) return;
    length = trimmed(text.substr(0, comma));
    force = trimmed(text.substr(comma + 1));
  }
  /// Factor from a stress in these units to megapascals; 1 if unknown.
  double megapascals() const {
    if (length != "m") return 1.0;
    return force == "N" ? 1e-6 : force == "kN" ? 1e-3 : 1.0;
  }
  std::string of(const std::string& source) const {
    if (length.empty()) return "";
    if (source == "material_force") return force;
    if (source == "material_moment") return force + " " + length;
    if (source == "moment_strain") return "1/" + length;
    if (source == "displacement") return length;
    const bool is_known = length == "m" && (force == "N" || force == "kN" || force == "MN");
    if (is_stress(source)) return is_known ? "MPa" : force + "/" + length + "²";
    return "";
  }
};

double largest_of(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values)
    if (!std::isnan(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

double norm_of(const double* v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

double longest_of(const std::vector<double>& vectors) {
  double longest = 0.0;
  for (std::size_t i = 0; 3 * i + 2 < vectors.size(); ++i) longest = std::max(longest, norm_of(&vectors[3 * i]));
  return longest;
}

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const std::size_t half = values.size() / 2;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(half), values.end());
  const double upper = values[half];
  if (values.size() % 2 == 1) return upper;
  return 0.5 * (upper + *std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(half)));
}

/// Indices 0 to count - 1, or `room` of them, evenly spread.
std::vector<std::size_t> evenly(std::size_t count, std::size_t room) {
  std::set<std::size_t> chosen;
  const std::size_t shown = std::min(count, room);
  for (std::size_t i = 0; i < shown; ++i)
    chosen.insert(shown == 1 ? 0
                             : static_cast<std::size_t>(std::nearbyint(static_cast<double>((count - 1) * i) /
                                                                       static_cast<double>(shown - 1))));
  return {chosen.begin(), chosen.end()};
}

/// The fields of a step and the utilisation (stress over strength), each read once, with round-off set to zero.
class HeldStep {
 public:
  HeldStep(const SampledFile& run, const SampledStep& step, const std::vector<double>& strength, double size,
           double stress_factor)
      : run_(run), step_(step), strength_(strength), size_(size), stress_factor_(stress_factor) {
    for (const char* name : {"displacement", kForces[0], kForces[1], kStrains[0], kStrains[1]})
      held_[name] = run.field(step.group, name);
    std::map<std::string, double> floors;
    for (const auto& [name, values] : held_) floors[name] = floor(name);
    force_floors = {floors[kForces[0]], floors[kForces[1]]};
    for (const char* name : kForces) is_loaded_ = is_loaded_ || largest_of(held_[name]) > floors[name];
    for (auto& [name, values] : held_)
      for (double& value : values)
        if (std::abs(value) <= floors[name]) value = 0.0;
  }

  bool has(const std::string& name) const {
    if (name != "utilisation") return held_.count(name) > 0 || run_.has(step_.group, name);
    const auto is_known = [](double value) { return std::isfinite(value); };
    return run_.has(step_.group, "von_mises_stress") && std::any_of(strength_.begin(), strength_.end(), is_known);
  }

  const std::vector<double>& field(const std::string& name) {
    const auto found = held_.find(name);
    if (found != held_.end()) return found->second;
    std::vector<double> values = run_.field(step_.group, name == "utilisation" ? "von_mises_stress" : name);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (name == "utilisation")
        values[i] /= strength_[i];
      else if (is_stress(name))
        values[i] = is_loaded_ ? stress_factor_ * values[i] : std::isfinite(values[i]) ? 0.0 : kUnknown;
    }
    return held_[name] = std::move(values);
  }

  void take(const std::string& name, std::vector<double> values) { held_[name] = std::move(values); }

  /// Smallest and largest value, with round-off set to zero; null if the step does not have the field.
  Json extremes(const PageField& field) {
    if (!has(field.source)) return nullptr;
    const std::vector<double>& all = this->field(field.source);
    double low = HUGE_VAL, high = -HUGE_VAL;
    const std::size_t columns = field.components.empty() ? 1 : 3, count = all.size() / columns;
    for (std::size_t i = 0; i < count; ++i) {
      double value = all[i];
      if (!field.components.empty()) {
        double sum = 0.0;
        for (const std::size_t c : field.components) sum += all[columns * i + c] * all[columns * i + c];
        value = field.is_signed ? all[columns * i + field.components[0]] : std::sqrt(sum);
        if (!std::isfinite(value)) value = 0.0;
      }
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (low > high) return nullptr;
    if (!field.components.empty() && std::max(std::abs(low), std::abs(high)) <= floor(field.source)) low = high = 0.0;
    return {low, high};
  }

  std::array<double, 2> force_floors{};

 private:
  /// Threshold of round-off in a field.
  double floor(const std::string& name) {
    const std::vector<double>&moments = held_[kForces[1]], &curvatures = held_[kStrains[1]];
    const double force = largest_of(held_[kForces[0]]);
    if (bending_ < 0.0) {  // from the values as read, before round-off is removed
      std::vector<double> ratios;
      for (std::size_t i = 0; i < moments.size(); ++i)
        if (std::abs(curvatures[i]) > 0.0) ratios.push_back(std::abs(moments[i]) / std::abs(curvatures[i]));
      bending_ = median_of(std::move(ratios));
    }
    const double moment = std::max(largest_of(moments), kNoLoad / kNoise * bending_ / size_);
    if (name == kForces[0]) return kNoise * std::max(force, moment / size_);
    if (name == kForces[1]) return kNoise * std::max(moment, force * size_);
    return kNoise * std::max(largest_of(held_[name]), name == kStrains[1] ? kLeastTurn / size_ : kLeastStrain);
  }

  const SampledFile& run_;
  const SampledStep& step_;
  const std::vector<double>& strength_;
  double size_, stress_factor_, bending_ = -1.0;
  bool is_loaded_ = false;
  std::map<std::string, std::vector<double>> held_;
};

/// The points that are farthest in evenly spread directions (Fibonacci's sphere).
std::vector<Point> corners(const std::vector<Point>& points) {
  std::set<std::size_t> found;
  for (int k = 0; k < kDirections; ++k) {
    const double turn = M_PI * (3.0 - std::sqrt(5.0)) * k, height = 1.0 - 2.0 * (k + 0.5) / kDirections;
    const double radius = std::sqrt(1.0 - height * height);
    const Point d = {radius * std::cos(turn), radius * std::sin(turn), height};
    std::size_t best = 0;
    double most = -HUGE_VAL;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (const double reach = vector_algebra::dot(points[i], d); reach > most) {
        most = reach;
        best = i;
      }
    found.insert(best);
  }
  std::vector<Point> result;
  for (const std::size_t i : found) result.push_back(points[i]);
  return result;
}

std::vector<Point> points_of(const std::vector<double>& values, const Point& center) {
  std::vector<Point> points(values.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a) points[i][a] = values[3 * i + a] - center[a];
  return points;
}

/// Elevation and azimuth [degrees] under which the points cover most of the picture.
std::array<double, 2> best_view(const std::vector<Point>& points) {
  Point mean{};
  for (const Point& p : points)
    for (std::size_t a = 0; a < 3; ++a) mean[a] += p[a] / static_cast<double>(points.size());
  double sums[3][3] = {};
  for (const Point& p : points)
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) sums[a][b] += (p[a] - mean[a]) * (p[b] - mean[b]);
  const auto product = [&](const Point& u, const Point& v) {
    double sum = 0.0;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) sum += u[a] * sums[a][b] * v[b];
    return sum;
  };
  const auto covered = [&](const std::array<double, 2>& view) {
    const double elevation = view[0] * M_PI / 180.0, azimuth = view[1] * M_PI / 180.0;
    const Point right = {-std::sin(azimuth), std::cos(azimuth), 0.0};
    const Point up = {-std::sin(elevation) * std::cos(azimuth), -std::sin(elevation) * std::sin(azimuth),
                      std::cos(elevation)};
    const double mixed = product(right, up);  // the result is the product of the singular values
    return std::sqrt(std::max(0.0, product(right, right) * product(up, up) - mixed * mixed));
  };
  constexpr std::array<double, 2> kUsual = {24.0, -60.0};
  std::array<double, 2> best = kUsual;
  for (const double elevation : {24.0, 38.0, 52.0})
    for (const double azimuth : {-60.0, -35.0, -120.0})
      if (covered({elevation, azimuth}) > covered(best)) best = {elevation, azimuth};
  // The sum of the principal minors bounds the second eigenvalue: a nearly straight rod looks best in the usual view.
  constexpr double kSlim = 0.15, kNearly = 0.7;
  const double trace = sums[0][0] + sums[1][1] + sums[2][2];
  double minors = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3;
    minors += sums[a][a] * sums[b][b] - sums[a][b] * sums[b][a];
  }
  const bool is_slim = minors < kSlim * kSlim * trace * trace;
  return is_slim || covered(kUsual) > kNearly * covered(best) ? kUsual : best;
}

/// Interpolates values at evenly spread places, at relative arc length x.
double along(const double* values, std::size_t places, std::size_t stride, double x) {
  const double at = std::clamp(x, 0.0, 1.0) * static_cast<double>(places - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), places - 2);
  const double share = at - static_cast<double>(i);
  if (share == 0.0) return values[stride * i];
  return (1.0 - share) * values[stride * i] + share * values[stride * (i + 1)];
}

/// Kind of a T, L or U: letter, orientation, and its centroid relative to the middle, over width and height.
std::string with_centroid(const std::string& shape, const double* d) {
  const double width = d[0], height = d[1], wall = d[2], web = d[3];
  struct Part {
    double area, second, third;
  };
  std::vector<Part> parts = {{width * wall, 0.0, 0.5 * (height - wall)}};  // flange at the top, then the web
  if (shape[0] == 'T') parts.push_back({web * (height - wall), 0.0, -0.5 * wall});
  if (shape[0] == 'U')
    parts = {{2.0 * width * wall, 0.0, 0.0}, {web * (height - 2.0 * wall), 0.5 * (web - width), 0.0}};
  if (shape[0] == 'L')
    parts = {{width * wall, 0.0, -0.5 * (height - wall)}, {wall * (height - wall), 0.5 * (wall - width), 0.5 * wall}};
  double area = 0.0, second = 0.0, third = 0.0;
  for (const Part& part : parts) {
    area += part.area;
    second += part.area * part.second;
    third += part.area * part.third;
  }
  const bool turned = shape.find("mirrored") != std::string::npos;
  return formatted("%c %s %.4f %.4f", shape[0], turned ? "mirrored" : "upright", second / area / width,
                   (turned ? -third : third) / area / height);
}

/// A table of loads and supports; without rows if missing.
struct Table {
  const ActingTable* held = nullptr;
  std::map<std::string, std::vector<std::string>> words{};
  Table(const Acting& acting, const std::string& name) {
    for (const ActingTable& table : acting.tables)
      if (table.name == name) held = &table;
    if (held == nullptr) return;
    for (const auto& [column, text] : held->lines) words[column] = lines_of(text);
  }
  std::size_t rows() const { return held == nullptr ? 0 : held->rows; }
  /// Throws InputError if the column is missing or has another width.
  template <class Columns>
  const auto& entries(const Columns& columns, const std::string& column, std::size_t width) const {
    const auto found = columns.find(column);
    if (found == columns.end() || found->second.size() != width * held->rows)
      throw InputError("damaged, or no result file of mixbeam: acting/" + held->name + "/" + column);
    return found->second;
  }
  const double* row(const std::string& column, std::size_t i, std::size_t width) const {
    return entries(held->numbers, column, width).data() + width * i;
  }
  const std::string& word(const std::string& column, std::size_t i) const { return entries(words, column, 1)[i]; }
};

/// Kind of a support; "spring" only if nothing is fixed.
std::string kind_of_support(const double* fixed) {
  const auto displacements = std::count_if(fixed, fixed + 3, [](double one) { return one != 0.0; });
  const auto rotations = std::count_if(fixed + 3, fixed + 6, [](double one) { return one != 0.0; });
  if (displacements + rotations == 0) return "spring";
  if (displacements == 3) return rotations == 3 ? "clamp" : "hinge";
  return rotations == 3 || displacements == 0 ? "guide" : "roller";
}

/// Largest stage in the text of a scene.
int stages_of(const std::string& text) {
  int most = 1;
  for (std::size_t at = text.find("Stage"); at != std::string::npos; at = text.find("Stage", at + 1)) {
    if (at > 0 && (std::isalnum(static_cast<unsigned char>(text[at - 1])) != 0 || text[at - 1] == '_')) continue;
    const std::string in_xml = "\" type=\"int\" value=\"";
    std::size_t number = at + 5;
    if (text.compare(number, in_xml.size(), in_xml) == 0)
      number += in_xml.size();
    else if (number < text.size() && text[number] == ':')
      number = text.find_first_not_of(" \t\n", number + 1);
    else
      continue;
    if (number != std::string::npos) most = std::max(most, std::atoi(text.c_str() + number));
  }
  return most;
}

/// Load factor from which something acts; kBeforeAny for a formula.
double finite_begin(double begins) { return std::isfinite(begins) ? begins : kBeforeAny; }

/// Kind of a time series of a point: "displacement" for "tip.displacement".
std::string kind_of_series(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? name : name.substr(dot + 1);
}

/// Connected part of each member, from "0*3 1*2"; empty if not in the file.
std::vector<int> connected_parts(const ResultHeader& header) {
  std::vector<int> parts;
  const std::string known = header.property("connected_parts");
  int number = 0, count = 0, length = 0;
  for (const char* text = known.c_str(); std::sscanf(text, " %d*%d%n", &number, &count, &length) == 2; text += length)
    parts.insert(parts.end(), static_cast<std::size_t>(std::max(count, 0)), number);
  return parts;
}

/// Indices of the members named in the messages: in quotes, or in the path of an entry.
Json named_members(const SaidOfScene& said, const std::vector<std::string>& members) {
  std::string text = said.refusal;
  for (const std::string& warning : said.warnings) text += " " + warning;
  Json named = Json::array();
  for (std::size_t m = 0; m < members.size(); ++m)
    if (text.find("\"" + members[m] + "\"") != std::string::npos ||
        text.find("/ Members / " + members[m] + " /") != std::string::npos)
      named.push_back(m);
  return named;
}

/// Builds the ViewData of a run; see there.
class ViewWriter {
 public:
  ViewWriter(const SampledFile& run, const std::optional<SaidOfScene>& said, const PageLimits& limits)
      : run_(run), limits_(limits), units_(run.acting().units), arc_(run.arc_lengths()) {
    const std::vector<double> position = run.field(run.steps().front().group, "position");
    const std::vector<double> displacement = run.field(run.steps().front().group, "displacement");
    if (position.size() != 3 * run.samples() || displacement.size() != position.size())
      throw InputError("damaged, or no result file of mixbeam: positions are no vectors");
    reference_.resize(position.size());
    for (std::size_t i = 0; i < position.size(); ++i) reference_[i] = position[i] - displacement[i];
    thin();
    vector_algebra::Box box;
    for (const Point& point : points_of(reference_, {})) box.enclose(point);
    center_ = vector_algebra::scaled(0.5, vector_algebra::sum(box.low, box.high));
    const Point diagonal = vector_algebra::difference(box.high, box.low);
    if (const double size = norm_of(diagonal.data()); size > 0.0) size_ = size;
    describe_run();
    describe_members();
    add_sections();
    const std::string& first = run.steps().front().group;
    add("rest_triad", drawn(run.field(first, "triad")), kForDrawing);
    add_modes();
    add_marks();
    add_gradients();
    read_steps();
    add_series();
    add_steps();
    if (said) describe_preview(*said);
    data_.arrays.emplace_back("description",
                              deflated(data_.description.dump(-1, ' ', false, Json::error_handler_t::replace)));
  }

  ViewData data() { return std::move(data_); }

 private:
  /// Chooses all samples, or every n-th of each member and its last one; of too many members, every m-th.
  void thin() {
    const auto& members = run_.members();
    const std::size_t most = limits_.samples;
    const std::size_t every = 2 * members.size() > most ? (2 * members.size() + most - 1) / most : 1;
    for (std::size_t m = 0; m < members.size(); m += every) shown_members_.push_back(m);
    const auto with_stride = [&](std::size_t stride) {
      std::size_t sum = 0;
      for (const std::size_t m : shown_members_) sum += (members[m].share.rows - 1 + stride - 1) / stride + 1;
      return sum;
    };
    std::size_t stride = 1;
    const std::size_t longest = run_.samples();
    while (stride < longest && with_stride(stride) > most) ++stride;
    for (const std::size_t m : shown_members_) {
      firsts_.push_back(kept_.size());
      const std::size_t last = members[m].share.rows - 1;
      for (std::size_t i = 0; i < last; i += stride) kept_.push_back(members[m].first_sample + i);
      kept_.push_back(members[m].first_sample + last);
    }
    firsts_.push_back(kept_.size());
  }

  void describe_run() {
    data_.load_case = run_.header().property("load_case");
    data_.scene_name = run_.header().scene_name;
    data_.title = data_.scene_name + (data_.load_case.empty() ? "" : ", load case " + data_.load_case);
    data_.description = {{"title", data_.title},
                         {"units", {units_.length, units_.force}},
                         {"version", run_.header().version},
                         {"stages", stages_of(run_.header().scene_xml)},
                         {"center", center_},
                         {"notes", Json::array()},
                         {"samples", kept_.size()},
                         {"units_of", Json::object()}};
  }

  void describe_members() {
    if (kept_.size() < run_.samples())
      note(formatted("Thinned: %zu of %zu samples and %zu of %zu members are drawn; the result file has all.",
                     kept_.size(), run_.samples(), shown_members_.size(), run_.members().size()));
    Json names = Json::array();
    for (const std::size_t m : shown_members_) names.push_back(run_.members()[m].name);
    data_.description["members"] = names;
    data_.description["all_members"] = run_.members().size();
    data_.description["first_sample"] = std::vector<std::size_t>(firsts_.begin(), firsts_.end() - 1);
    PageRows places = drawn(reference_);
    for (std::size_t i = 0; i < places.values.size(); ++i) places.values[i] -= center_[i % 3];
    add("reference", places, kForPlaces);
    add("arc_length", drawn(arc_), kForPlaces);
  }

  /// Adds sections, and parts if some are disconnected, instead of fields.
  void describe_preview(const SaidOfScene& said) {
    const std::vector<int> all_parts = connected_parts(run_.header());
    std::vector<std::string> parts, names;
    for (const std::size_t m : shown_members_) {
      names.push_back(run_.members()[m].name);
      if (m < all_parts.size()) parts.push_back("part " + std::to_string(all_parts[m] + 1));
    }
    Json fields = Json::array();
    const auto add_groups = [&](const char* label, const std::vector<std::string>& of, bool always) {
      std::vector<std::string> known = of;
      std::sort(known.begin(), known.end(), [](const std::string& a, const std::string& b) {
        return a.size() != b.size() && a.rfind("part ", 0) == 0 && b.rfind("part ", 0) == 0 ? a.size() < b.size()
                                                                                            : a < b;
      });
      known.erase(std::unique(known.begin(), known.end()), known.end());
      if (of.size() != shown_members_.size() || (known.size() < 2 && !always)) return;
      Json of_members = Json::array();
      for (const std::string& one : of)
        of_members.push_back(std::find(known.begin(), known.end(), one) - known.begin());
      const std::size_t most = std::max<std::size_t>(known.size() - 1, 1);
      fields.push_back({{"name", label},
                        {"label", label},
                        {"unit", ""},
                        {"signed", false},
                        {"extremes", Json::array({Json::array({0, most})})},
                        {"names", known},
                        {"of_members", of_members}});
    };
    add_groups("connected part", parts, false);
    add_groups("section", sections_, true);
    data_.description["fields"] = fields;
    if (const std::string drawn = run_.header().property("drawn"); !drawn.empty()) note(drawn);
    data_.description["preview"] = {
        {"refusal", said.refusal}, {"warnings", said.warnings}, {"named", named_members(said, names)}};
    for (Json& mode : data_.description["modes"]) mode["kind"] = "motion without strain";
  }

  void add_sections() {
    constexpr std::size_t kSizes = 4, kWidth = kSizes * kPlacesAlongMember;  // width, height, wall, web per place
    const Table shapes(run_.acting(), "sections"), members(run_.acting(), "members");
    std::vector<double> lengths;
    for (const std::size_t m : shown_members_)
      lengths.push_back(arc_[run_.members()[m].first_sample + run_.members()[m].share.rows - 1]);
    double rod = std::min(kThinRod * size_, kSlenderRod * median_of(lengths));
    for (std::size_t i = 0; i < shapes.rows(); ++i)  // not thicker than sections with a shape
      if (shapes.word("shape", i) != "none") rod = std::min(rod, shapes.row("dimensions", i, kWidth)[0]);
    PageRows dimensions;
    dimensions.columns = kSizes;
    for (std::size_t i = 0; i < kept_.size(); ++i)
      dimensions.values.insert(dimensions.values.end(), {rod, rod, 0.0, 0.0});
    strength_.assign(run_.samples(), kUnknown);
    kinds_.assign(shown_members_.size(), "none");
    sections_.assign(shown_members_.size(), "");
    for (std::size_t at = 0; at < shown_members_.size() && shapes.rows() > 0; ++at) {
      const auto row = static_cast<std::size_t>(members.row("section", shown_members_[at], 1)[0]);
      sections_[at] = shapes.word("name", row);
      std::string kind = shapes.word("shape", row);
      if (kind == "none") continue;
      if (kind.rfind(kDrawnAs, 0) == 0) kind.erase(0, std::string(kDrawnAs).size());
      const double* sizes = shapes.row("dimensions", row, kWidth);
      std::array<double, kPlacesAlongMember> known{};
      for (std::size_t p = 0; p < known.size(); ++p) {
        const double one = shapes.row("strength", row, kPlacesAlongMember)[p];
        known[p] = one > 0.0 ? one : kUnknown;  // 0: not given
      }
      for (std::size_t i = firsts_[at]; i < firsts_[at + 1]; ++i) {
        const double x = arc_[kept_[i]] / lengths[at];
        for (std::size_t k = 0; k < kSizes; ++k)
          dimensions.values[kSizes * i + k] = along(sizes + k, kPlacesAlongMember, kSizes, x);
        if (kind == "circle" || kind == "tube") dimensions.values[kSizes * i + 1] = dimensions.values[kSizes * i];
        strength_[kept_[i]] = along(known.data(), kPlacesAlongMember, 1, x);
      }
      kinds_[at] = kind[0] == 'T' || kind[0] == 'L' || kind[0] == 'U' ? with_centroid(kind, sizes) : kind;
    }
    add("dimensions", dimensions, kForReading);
    data_.description["kinds"] = kinds_;
    data_.description["sections"] = sections_;
    const auto without = std::count(kinds_.begin(), kinds_.end(), "none");
    if (without == 0) return;
    const bool all = static_cast<std::size_t>(without) == kinds_.size();
    note(std::string(all ? "Members are" : "Members without a Shape are") +
         formatted(" drawn as round rods of diameter %.3g", rod) +
         (units_.length.empty() ? "." : " " + units_.length + "."));
  }

  void add_modes() {
    data_.description["modes"] = Json::array();
    const auto& steps = run_.steps();
    const auto for_each = [&](const std::string& kind, const auto& action) {
      for (std::size_t s = 0; s < steps.size(); ++s) {
        const bool is_in_file = kind == "buckling" && s == 0;  // undeformed structure: at the root of the file
        const std::string about = is_in_file ? "" : steps[s].group;
        for (std::size_t i = 0; i < run_.count(about, kind); ++i)
          action(s, (about.empty() ? "" : about + "/") + kind + "/" + std::to_string(i));
      }
    };
    for_each("critical_points", [&](std::size_t step, const std::string& group) {
      add("critical-displacement-" + std::to_string(data_.description["modes"].size()),
          drawn(run_.field(group, "displacement")), kForReading);
      add_mode(group, step,
               {{"kind", run_.word(group, "kind")},
                {"factor", run_.number(group, "load_factor")},
                {"modes", run_.number(group, "modes")},
                {"before", run_.number(group, "negative_before")},
                {"after", run_.number(group, "negative_after")}});
    });
    for_each("buckling", [&](std::size_t step, const std::string& group) {
      add_mode(group, step, {{"kind", "buckling mode"}, {"factor", run_.number(group, "load_factor")}});
    });
    for_each("vibration", [&](std::size_t step, const std::string& group) {
      add_mode(group, step,
               {{"kind", "natural mode"}, {"factor", steps[step].load_factor}, {"omega", run_.number(group, "omega")}});
    });
  }

  /// Adds a mode; `described`: without the step.
  void add_mode(const std::string& group, std::size_t step, Json described) {
    const std::vector<double> all = run_.field(group, "mode");
    const double largest = longest_of(all);
    PageRows mode = drawn(all);
    for (double& value : mode.values) value /= largest > 0.0 ? largest : 1.0;
    Json& modes = data_.description["modes"];
    add("mode-" + std::to_string(modes.size()), mode, kForDrawing);
    described["step"] = step;
    modes.push_back(std::move(described));
  }

  void add_marks() {
    for (const char* kind : {"supports", "joints", "forces", "moments", "shifts", "turns", "line_loads", "strained"})
      data_.description[kind] = Json::array();
    const Table supports(run_.acting(), "supports"), joints(run_.acting(), "joints"),
        strains(run_.acting(), "eigenstrains");
    for (std::size_t i = 0; i < supports.rows(); ++i) {
      const double *place = supports.row("place", i, 2), *fixed = supports.row("fixed", i, 6),
                   *stiffness = supports.row("stiffness", i, 6);
      const std::size_t at = nearest(sample_at(place[0], place[1]));
      const auto is_set = [](double one) { return one > 0.0; };
      data_.description["supports"].push_back({at, kind_of_support(fixed)});
      if (std::any_of(stiffness, stiffness + 6, is_set) && std::any_of(fixed, fixed + 6, is_set))
        data_.description["supports"].push_back({at, "spring"});
    }
    for (std::size_t i = 0; i < joints.rows(); ++i) {
      const double* place = joints.row("place", i, 2);
      data_.description["joints"].push_back({nearest(sample_at(place[0], place[1])), joints.word("kind", i)});
    }
    add_point_loads();
    add_motions(supports);
    add_line_loads();
    const double last = run_.steps().back().load_factor;
    std::set<std::size_t> strained;
    for (std::size_t i = 0; i < strains.rows(); ++i) {
      const double begins = strains.row("begins", i, 1)[0];
      if (std::isfinite(begins) && !(begins < last)) continue;
      const auto member = static_cast<std::size_t>(strains.row("member", i, 1)[0]);
      const auto at = std::find(shown_members_.begin(), shown_members_.end(), member);
      if (at != shown_members_.end()) strained.insert(static_cast<std::size_t>(at - shown_members_.begin()));
    }
    data_.description["strained"] = strained;
  }

  void add_point_loads() {
    const Table loads(run_.acting(), "point_loads");
    for (std::size_t i = 0; i < loads.rows(); ++i) {
      const double* place = loads.row("place", i, 2);
      const std::size_t sample = sample_at(place[0], place[1]);
      const bool follows = loads.row("follower", i, 1)[0] != 0.0;
      const double begins = loads.row("begins", i, 1)[0];
      add_arrow("forces", sample, loads.row("force", i, 3), follows, begins);
      add_arrow("moments", sample, loads.row("moment", i, 3), follows, begins);
    }
  }

  /// Adds prescribed displacements and rotations of supports.
  void add_motions(const Table& supports) {
    for (std::size_t i = 0; i < supports.rows(); ++i) {
      const double *place = supports.row("place", i, 2), *axes = supports.row("axes", i, 9),
                   *prescribed = supports.row("prescribed", i, 6);
      Point shift{}, turn{};
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t c = 0; c < 3; ++c) {
          shift[c] += prescribed[a] * axes[3 * a + c];
          turn[c] += prescribed[3 + a] * axes[3 * a + c];
        }
      const std::size_t sample = sample_at(place[0], place[1]);
      const double begins = supports.row("begins", i, 1)[0];
      add_arrow("shifts", sample, shift.data(), false, begins);
      add_arrow("turns", sample, turn.data(), false, begins);
    }
  }

  void add_line_loads() {
    const Table loads(run_.acting(), "line_loads");
    for (std::size_t i = 0; i < loads.rows(); ++i) {
      const double number = loads.row("member", i, 1)[0];
      const double* force = loads.row("force", i, 3 * kPlacesAlongMember);
      const double whole[] = {0.0, 1.0};  // files of earlier versions
      const double* range = loads.held->numbers.count("range") > 0 ? loads.row("range", i, 2) : whole;
      const SampledMember& member = run_.members()[static_cast<std::size_t>(number)];
      const double length = arc_[member.first_sample + member.share.rows - 1];
      Json places = Json::array(), forces = Json::array();
      bool acts = false;
      for (int p = 0; p < kPlacesAlongMember; ++p) {
        const double x = range[0] + (range[1] - range[0]) * p / (kPlacesAlongMember - 1);
        places.push_back(nearest(sample_at(number, length * x)));
        forces.push_back({force[3 * p], force[3 * p + 1], force[3 * p + 2]});
        acts = acts || norm_of(force + 3 * p) > 0.0;
      }
      if (acts)
        data_.description["line_loads"].push_back(
            {places, forces, loads.row("follower", i, 1)[0] != 0.0, finite_begin(loads.row("begins", i, 1)[0])});
    }
  }

  /// Adds gradients of quantities with respect to stiffnesses of elements, at the end of the path.
  void add_gradients() {
    const std::array<const char*, 6> stiffnesses = {"EA", "GA₂", "GA₃", "GIₜ", "EI₂", "EI₃"};
    const std::string& end = run_.steps().back().group;
    for (std::size_t q = 0; q + 1 < run_.count(end, "gradients"); ++q) {
      const std::string group = "gradients/" + std::to_string(q);
      if (!run_.has(end + "/" + group, "stiffness")) continue;
      for (std::size_t i = 0; i < stiffnesses.size(); ++i) {
        const std::string name = "gradient_" + std::to_string(q) + "_" + std::to_string(i);
        gradients_[name] = {group, i};
        fields_.push_back({name,
                           "gradient of " + run_.word(end + "/" + group, "quantity") + " by " + stiffnesses[i] +
                               ": share of the stiffness, per length",
                           name,
                           {},
                           true});
      }
    }
  }

  /// C dq/dC per element length, at every sample: from the derivatives by C and by 1 / C (-C^2 times the former).
  std::vector<double> sensitivities(const std::string& group, std::size_t stiffness) const {
    const std::vector<double> by = run_.numbers(group, "stiffness", 6), inverse = run_.numbers(group, "compliance", 6);
    std::vector<double> values;
    std::size_t at = stiffness;
    for (const SampledMember& member : run_.members())
      for (int e = 0; e < member.elements; ++e, at += 6) {
        const std::size_t first = values.size(), points = member.share.rows / static_cast<std::size_t>(member.elements);
        const double length = arc_.at(first + points - 1) - arc_[first];
        values.insert(values.end(), points,
                      std::copysign(std::sqrt(std::abs(by.at(at) * inverse.at(at))), by[at]) / length);
      }
    return values;
  }

  /// Reads as many steps as fit into memory, and the extent of the path.
  void read_steps() {
    const auto& steps = run_.steps();
    const double room = std::max(2.0, kMostNumbers / (kNumbersOfSample * static_cast<double>(kept_.size())));
    const std::vector<std::size_t> read = evenly(steps.size(), static_cast<std::size_t>(room));
    std::vector<Point> hull = corners(points_of(reference_, center_));
    const bool turns = shows_directions();
    for (std::size_t s = 0; s < steps.size(); ++s) {
      HeldStep held(run_, steps[s], strength_, size_, units_.megapascals());
      largest_.push_back(longest_of(held.field("displacement")));
      force_floors_ = held.force_floors;
      if (!std::binary_search(read.begin(), read.end(), s)) continue;
      const std::vector<Point> far = corners(points_of(run_.field(steps[s].group, "position"), center_));
      hull.insert(hull.end(), far.begin(), far.end());
      ReadStep& step = steps_.emplace_back();
      step.described = {
          {"number", steps[s].number}, {"factor", steps[s].load_factor}, {"stable", steps[s].stable}, {"place", s}};
      for (const auto& [name, gradient] : gradients_) {
        if (s + 1 < steps.size()) break;
        held.take(name, sensitivities(steps[s].group + "/" + gradient.group, gradient.stiffness));
        step.arrays[name] = drawn(held.field(name));
      }
      for (const PageField& field : fields_) step.extremes.push_back(held.extremes(field));
      for (const char* name : {"displacement", kForces[0], kForces[1], kStrains[0], kStrains[1], kStresses[0],
                               kStresses[1], kStresses[2], "utilisation", "triad"})
        if ((name != std::string("triad") || turns) && held.has(name)) step.arrays[name] = drawn(held.field(name));
    }
    Json corners_of_hull = Json::array();
    constexpr double kDecimals = 1e9;
    for (const Point& p : corners(hull))
      corners_of_hull.push_back({std::nearbyint(p[0] * kDecimals) / kDecimals,
                                 std::nearbyint(p[1] * kDecimals) / kDecimals,
                                 std::nearbyint(p[2] * kDecimals) / kDecimals});
    data_.description["hull"] = corners_of_hull;
    data_.description["camera"] = camera(hull);
    data_.description["size"] = size_;
  }

  /// Elevation and azimuth [degrees]: normal to the plane of the structure, otherwise the best view.
  Json camera(const std::vector<Point>& points) const {
    vector_algebra::Box box;
    for (const Point& point : points) box.enclose(point);
    const Point spread = vector_algebra::difference(box.high, box.low);
    const auto is_flat = [&](std::size_t axis) { return spread[axis] <= kFlat * size_; };
    if (is_flat(2)) return {90.0, -90.0};
    if (is_flat(1)) return {0.0, -90.0};
    if (is_flat(0)) return {0.0, 0.0};
    return best_view(points);
  }

  /// Whether drawings need section directions: sections that are not round, follower loads, diagrams on small pages.
  bool shows_directions() const {
    if (kept_.size() * run_.steps().size() <= kFewNumbers) return true;
    const std::set<std::string> round = {"circle", "tube", "none"};
    if (std::any_of(kinds_.begin(), kinds_.end(), [&](const std::string& kind) { return round.count(kind) == 0; }))
      return true;
    for (const char* kind : {"forces", "moments", "line_loads"})
      for (const Json& load : data_.description[kind])
        if (load[2].get<bool>()) return true;
    return false;
  }

  /// Adds the time series: a row for each step, then one for each critical point.
  void add_series() {
    const auto& steps = run_.steps();
    std::vector<std::string> points;  // groups of critical points
    for (const SampledStep& step : steps)
      for (std::size_t i = 0; i < run_.count(step.group, "critical_points"); ++i)
        points.push_back(step.group + "/critical_points/" + std::to_string(i));
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;
    const auto begin = [&](const std::string& name) -> std::vector<double>& {
      names.push_back(name);
      return columns.emplace_back();
    };
    std::vector<double>& factors = begin("load factor");
    for (const SampledStep& step : steps) factors.push_back(step.load_factor);
    for (const std::string& point : points) factors.push_back(run_.number(point, "load_factor"));
    const auto whole = [&](const std::string& name, const std::function<double(std::size_t)>& value) {
      std::vector<double>& column = begin(name);
      for (std::size_t s = 0; s < steps.size(); ++s) column.push_back(value(s));
      column.resize(steps.size() + points.size(), kUnknown);
    };
    const MonitoredSeries *quantities = nullptr, *energy = nullptr;
    for (const MonitoredSeries& series : run_.monitor()) {
      if (series.name == kQuantitySeries) quantities = &series;
      if (series.name == "strain_energy" && series.columns == 1) energy = &series;
    }
    const std::vector<std::string>& asked = run_.header().quantities;
    for (std::size_t q = 0; quantities != nullptr && quantities->columns == asked.size() && q < asked.size(); ++q)
      whole(asked[q], [&](std::size_t s) { return quantities->values[quantities->columns * s + q]; });
    const std::map<std::string, double> floors = floors_of_series();
    for (const MonitoredSeries& series : run_.monitor()) {
      if (series.columns != 3 || series.name == kQuantitySeries) continue;
      if (columns.size() > kMostSeries) break;
      const double floor = floors.at(kind_of_series(series.name));
      std::vector<Point> rows;
      for (std::size_t s = 0; s < steps.size(); ++s) {
        Point& row = rows.emplace_back();
        for (std::size_t a = 0; a < 3; ++a) {
          const double value = series.values[3 * s + a];
          row[a] = std::abs(value) > floor ? value : 0.0;
        }
      }
      for (const std::string& point : points) {
        Point& row = rows.emplace_back();
        row.fill(kUnknown);
        if (run_.count(point, "monitor") == 0 || !run_.has(point + "/monitor", series.name)) continue;
        const std::vector<double> known = run_.numbers(point + "/monitor", series.name);
        if (known.size() == 3) std::copy(known.begin(), known.end(), row.begin());
      }
      for (std::size_t a = 0; a < 3; ++a) {
        std::vector<double>& column = begin(series.name + "." + "xyz"[a]);
        for (const Point& row : rows) column.push_back(row[a]);
      }
      std::vector<double>& column = begin(series.name + ".norm");
      for (const Point& row : rows) column.push_back(norm_of(row.data()));
    }
    whole("largest displacement", [&](std::size_t s) { return largest_[s]; });
    if (energy != nullptr) whole("strain energy", [&](std::size_t s) { return energy->values[s]; });
    PageRows table;
    table.columns = columns.size();
    for (std::size_t r = 0; r < steps.size() + points.size(); ++r)
      for (const std::vector<double>& column : columns) table.values.push_back(column[r]);
    add("series", table, kForPlaces);
    data_.description["series_names"] = names;
    Json stable = Json::array();
    for (const SampledStep& step : steps) stable.push_back(step.stable);
    data_.description["stable"] = stable;
    data_.description["abscissa"] = telling_series(names, columns);
  }

  /// Round-off of time series by kind: relative to the largest of all points and steps, and to section forces at the
  /// end.
  std::map<std::string, double> floors_of_series() const {
    std::map<std::string, double> largest;
    for (const MonitoredSeries& series : run_.monitor())
      if (series.columns == 3) {
        double& known = largest[kind_of_series(series.name)];
        known = std::max(known, largest_of(series.values));
      }
    double &force = largest["reaction_force"], &moment = largest["reaction_moment"];
    const double own_force = force;
    force = std::max(force, moment / size_);
    moment = std::max(moment, own_force * size_);
    for (auto& [kind, value] : largest) value *= kNoise;
    force = std::max(force, force_floors_[0]);
    moment = std::max(moment, force_floors_[1]);
    return largest;
  }

  /// Default abscissa: the first quantity of the scene that changes, otherwise the displacement that changes most.
  std::string telling_series(const std::vector<std::string>& names,
                             const std::vector<std::vector<double>>& columns) const {
    const auto change = [&](std::size_t c) {
      const auto end = columns[c].begin() + static_cast<std::ptrdiff_t>(run_.steps().size());
      if (std::any_of(columns[c].begin(), end, [](double value) { return !std::isfinite(value); })) return -1.0;
      const auto [low, high] = std::minmax_element(columns[c].begin(), end);
      return *high - *low;
    };
    const std::size_t asked = run_.header().quantities.size();
    for (std::size_t c = 1; c <= asked && c < names.size(); ++c)
      if (names[c] == run_.header().quantities[c - 1] && change(c) > 0.0) return names[c];
    std::string best = "largest displacement";
    double most = kMoved * size_;
    for (std::size_t c = 0; c < names.size(); ++c) {
      const bool is_component =
          names[c].find(".displacement.") != std::string::npos && kind_of_series(names[c]) != "norm";
      if (is_component && change(c) > most) {
        most = change(c);
        best = names[c];
      }
    }
    return best;
  }

  /// {section: compliances (6,)} if strains equal these times the forces in all steps; the strains are then removed
  /// from the steps. Empty otherwise.
  Json taken_out() {
    const std::set<std::string> unique(sections_.begin(), sections_.end());
    const std::vector<std::string> names(unique.begin(), unique.end());
    std::vector<std::size_t> group(kept_.size());
    for (std::size_t m = 0; m < sections_.size(); ++m)
      for (std::size_t i = firsts_[m]; i < firsts_[m + 1]; ++i)
        group[i] = static_cast<std::size_t>(std::lower_bound(names.begin(), names.end(), sections_[m]) - names.begin());
    Json found = Json::object();
    for (const std::string& name : names) found[name] = Json::array();
    for (std::size_t pair = 0; pair < kForces.size(); ++pair)
      for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> above(names.size()), below(names.size());
        for (ReadStep& step : steps_) {
          const PageRows &force = step.arrays[kForces[pair]], &strain = step.arrays[kStrains[pair]];
          for (std::size_t i = 0; i < kept_.size(); ++i) {
            above[group[i]] += force.row(i)[c] * strain.row(i)[c];
            below[group[i]] += force.row(i)[c] * force.row(i)[c];
          }
        }
        for (std::size_t n = 0; n < names.size(); ++n) above[n] = below[n] > 0.0 ? above[n] / below[n] : 0.0;
        for (ReadStep& step : steps_) {
          const PageRows &force = step.arrays[kForces[pair]], &strain = step.arrays[kStrains[pair]];
          double largest = 0.0;
          for (std::size_t i = 0; i < kept_.size(); ++i) largest = std::max(largest, std::abs(strain.row(i)[c]));
          const double unit = largest / std::exp2(kForReading - 1);
          for (std::size_t i = 0; i < kept_.size(); ++i)
            if (std::abs(strain.row(i)[c] - above[group[i]] * force.row(i)[c]) > kSame * unit) return Json::object();
        }
        for (std::size_t n = 0; n < names.size(); ++n) found[names[n]].push_back(above[n]);
      }
    for (ReadStep& step : steps_)
      for (const char* strain : kStrains) step.arrays.erase(strain);
    return found;
  }

  void add_steps() {
    data_.description["compliance"] = taken_out();
    double room = limits_.bytes;
    for (const auto& [name, bytes] : data_.arrays) room -= static_cast<double>(bytes.size());
    std::map<std::string, PackedNumbers> held;
    std::size_t count = steps_.size();
    std::vector<std::size_t> shown = evenly(steps_.size(), count);
    double bytes = pack_steps(shown, held);
    while (bytes > room && count > limits_.fewest_steps) {
      const double fits = std::max(0.0, static_cast<double>(count) * room / bytes);
      count = std::max(limits_.fewest_steps, std::min(count - 1, static_cast<std::size_t>(fits)));
      shown = evenly(steps_.size(), count);
      bytes = pack_steps(shown, held);
    }
    for (auto& [name, numbers] : held) hold(name, std::move(numbers));
    if (shown.size() < run_.steps().size())
      note(formatted("%zu of %zu steps are drawn; the load path has all.", shown.size(), run_.steps().size()));
    Json steps = Json::array(), fields = Json::array();
    for (const std::size_t i : shown) steps.push_back(steps_[i].described);
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      const PageField& field = fields_[f];
      Json extremes = Json::array();
      bool is_there = false;
      for (const std::size_t i : shown) {
        extremes.push_back(steps_[i].extremes[f]);
        is_there = is_there || !steps_[i].extremes[f].is_null();
      }
      if (is_there)
        fields.push_back({{"name", field.name},
                          {"label", field.label},
                          {"unit", units_.of(field.source)},
                          {"source", field.source},
                          {"components", field.components.empty() ? std::vector<std::size_t>{0} : field.components},
                          {"signed", field.is_signed},
                          {"extremes", extremes}});
    }
    data_.description["steps"] = steps;
    data_.description["fields"] = fields;
  }

  /// Packs backwards from the last step, which the page shows first. Returns the number of bytes.
  double pack_steps(const std::vector<std::size_t>& shown, std::map<std::string, PackedNumbers>& held) const {
    held.clear();
    double bytes = 0.0;
    for (std::size_t at = shown.size(); at-- > 0;)
      for (const auto& [name, rows] : steps_[shown[at]].arrays) {
        const auto next = held.find(name + "-" + std::to_string(at + 1)),
                   behind = held.find(name + "-" + std::to_string(at + 2));
        const PackedNumbers* const later = next == held.end() ? nullptr : &next->second;
        const PackedNumbers* const further = later == nullptr || behind == held.end() ? nullptr : &behind->second;
        PackedNumbers& numbers = held[name + "-" + std::to_string(at)] =
            packed(rows, name == "triad" ? kForDrawing : kForReading, later, further);
        bytes += static_cast<double>(numbers.bytes.size());
      }
    return bytes;
  }

  void add(const std::string& name, const PageRows& rows, int bits) { hold(name, packed(rows, bits)); }
  void hold(const std::string& name, PackedNumbers numbers) {
    data_.description["units_of"][name] = numbers.units;
    data_.arrays.emplace_back(name, std::move(numbers.bytes));
  }
  /// Rows of a field at the drawn samples.
  PageRows drawn(const std::vector<double>& values) const {
    PageRows rows;
    rows.columns = values.size() / run_.samples();
    rows.values.reserve(kept_.size() * rows.columns);
    for (const std::size_t sample : kept_)
      for (std::size_t c = 0; c < rows.columns; ++c) rows.values.push_back(values[sample * rows.columns + c]);
    return rows;
  }

  void note(const std::string& text) { data_.description["notes"].push_back(text); }
  /// Sample nearest to a place (member, arc length).
  std::size_t sample_at(double number, double arc_length) const {
    const SampledMember& member = run_.members()[static_cast<std::size_t>(number)];
    std::size_t best = member.first_sample;
    for (std::size_t i = member.first_sample; i < member.first_sample + member.share.rows; ++i)
      if (std::abs(arc_[i] - arc_length) < std::abs(arc_[best] - arc_length)) best = i;
    return best;
  }

  /// Index of the nearest drawn sample.
  std::size_t nearest(std::size_t sample) const {
    const auto above = std::lower_bound(kept_.begin(), kept_.end(), sample);
    if (above == kept_.begin()) return 0;
    const auto below = above - 1;
    const bool takes_below = above == kept_.end() || sample - *below <= *above - sample;
    return static_cast<std::size_t>((takes_below ? below : above) - kept_.begin());
  }

  void add_arrow(const char* kind, std::size_t sample, const double* vector, bool follows, double begins) {
    const double length = norm_of(vector);
    if (!(length > 0.0)) return;
    const Point direction = {vector[0] / length, vector[1] / length, vector[2] / length};
    data_.description[kind].push_back({nearest(sample), direction, follows, finite_begin(begins)});
  }

  const SampledFile& run_;
  const PageLimits& limits_;
  Units units_;
  ViewData data_;
  std::vector<double> arc_, reference_, strength_;
  std::vector<std::size_t> kept_, firsts_;  ///< drawn samples; index of the first of each member, and the end
  std::vector<std::size_t> shown_members_;
  std::vector<std::string> kinds_, sections_;  ///< of each drawn member
  Point center_{};
  double size_ = 1.0;
  std::vector<double> largest_;  ///< largest displacement of each step
  std::array<double, 2> force_floors_{};
  struct ReadStep {
    Json described;
    std::vector<Json> extremes;
    std::map<std::string, PageRows> arrays;
  };
  std::vector<ReadStep> steps_;
  std::vector<PageField> fields_ = page_fields();
  struct PageGradient {
    std::string group;  ///< within the group of its step
    std::size_t stiffness;
  };
  std::map<std::string, PageGradient> gradients_;  ///< by PageField::source
};

}  // namespace

ViewData view_data(const SampledFile& run, const std::optional<SaidOfScene>& said, const PageLimits& limits) {
  return ViewWriter(run, said, limits).data();
}

}  // namespace mixbeam
