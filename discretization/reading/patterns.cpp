#include "discretization/reading/scene_parts.hpp"

#include "discretization/geometry/isometry.hpp"
#include "discretization/geometry/point_grid.hpp"
#include "discretization/geometry/reference_curve.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/section_shape.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/constants.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

namespace mixbeam {
namespace {

using Teuchos::ParameterList;
using namespace vector_algebra;

constexpr double kPointTolerance = 1e-9;  // of the size of the structure: points are written with a dozen digits
constexpr double kMostCopiedBytes = 4e9;  // keeps copies of large members from eating memory
constexpr double kSameAngle = 1e-6;       // of axes 2, whose directions are written with six digits. [radian]
constexpr std::size_t kNoPoint = ~std::size_t{0};

enum class PatternKind { repeat, rotate, mirror };
enum class CopyScope { members, joints, all };

/// One pattern as written: the members, the motion and what is copied with them.
struct Pattern {
  std::vector<std::string> members{"*"};
  PatternKind kind = PatternKind::repeat;
  int count = 2;  // mirror: the original and its image
  Vector3 vector{}, center{}, axis{}, point{}, normal{};
  std::optional<double> angle{};
  CopyScope scope = CopyScope::members;  ///< what is copied with the members: joints, supports, loads and eigenstrains
};

/// Origin of a copy: its name is that of the original with the numbers of the copies on the way.
struct CopyLabel {
  std::string base;
  std::vector<int> numbers{};

  std::string name() const {
    std::size_t count = numbers.size();
    while (count > 0 && numbers[count - 1] == 0) --count;  // the original of this and all later patterns
    if (count == 0) return base;
    std::string text = base + " (";
    for (std::size_t i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + std::to_string(numbers[i]);
    return text + ")";
  }
  CopyLabel copy(int number) const {
    CopyLabel label = *this;
    label.numbers.back() = number;
    return label;
  }
};

BoundList<Pattern> declared_pattern_parameters() {
  BoundList<Pattern> pattern("Copies of members with their points; acts on the copies of the patterns before it too.");
  pattern.bind(&Pattern::members, array("Members", ParameterType::text_array).by_default(),
               "Names of the members; " + kWildcards + ".");
  pattern.bind(&Pattern::kind, text("Kind").required(),
               "repeat: translated by Vector, repeatedly; rotate: about an axis; mirror: reflected in a plane. Points "
               "and members of copies that coincide with existing ones become one with them.",
               {{"repeat", PatternKind::repeat}, {"rotate", PatternKind::rotate}, {"mirror", PatternKind::mirror}});
  pattern.bind(&Pattern::count, integer("Count").at_least(2).at_most(kMostElements),
               "repeat, rotate: number of instances of the members, the original included.");
  pattern.bind(&Pattern::vector, direction("Vector"), "repeat: from each copy to the next [length].");
  pattern.bind(&Pattern::center, bounded_vector("Center"), "rotate: a point of the axis [length].");
  pattern.bind(&Pattern::axis, direction("Axis"), "rotate: direction of the axis; right-handed (any length).");
  pattern.bind(&Pattern::angle, real("Angle").at_least(-kLargestAngle).at_most(kLargestAngle),
               "rotate: from each copy to the next [radian]; a whole turn over Count if absent.");
  pattern.bind(&Pattern::point, bounded_vector("Point"), "mirror: a point of the plane [length].");
  pattern.bind(&Pattern::normal, direction("Normal"), "mirror: normal of the plane (any length).");
  pattern.bind(&Pattern::scope, text("Copy").by_default(),
               "members: these with their points; joints: these as well; all: supports, loads and eigenstrains too, "
               "their directions turned with the copy, unless they act there by their names already.",
               {{"members", CopyScope::members}, {"joints", CopyScope::joints}, {"all", CopyScope::all}});
  pattern.spec.with_forms("Kind", {{"repeat", {{{"Vector", "Count"}}}},
                                   {"rotate", {{{"Center", "Axis", "Count"}, {"Angle"}}}},
                                   {"mirror", {{{"Point", "Normal"}}}}});
  return pattern;
}

const BoundList<Pattern>& pattern_parameters() {
  static const BoundList<Pattern> parameters = declared_pattern_parameters();
  return parameters;
}

/// Motions of all copies, without the original. Throws std::invalid_argument if there is no such motion.
std::vector<Isometry> motions_of(const Pattern& pattern) {
  if (pattern.kind == PatternKind::mirror) return {Isometry::reflection(pattern.point, pattern.normal)};
  std::vector<Isometry> motions;
  for (int i = 1; i < pattern.count; ++i) {
    const double angle = pattern.angle ? i * *pattern.angle : 2.0 * kPi * i / pattern.count;
    motions.push_back(pattern.kind == PatternKind::repeat ? Isometry::shift(vector_algebra::scaled(i, pattern.vector))
                                                          : Isometry::rotation(pattern.center, pattern.axis, angle));
  }
  return motions;
}

/// Image of a line given by a point and a direction.
std::array<double, 6> image(const Isometry& motion, const std::array<double, 6>& line) {
  const Vector3 point = motion.position({line[0], line[1], line[2]}),
                direction = motion.direction({line[3], line[4], line[5]});
  return {point[0], point[1], point[2], direction[0], direction[1], direction[2]};
}

/// Mirrors the stress points of a section whose axis 3 reverses, with the signs of Q3, T, M2, tau_13.
void mirror_stress_points(StressPoints& points) {
  for (StressPoints::Place& place : points.points) {
    place.at[1] = -place.at[1];
    for (std::size_t i = 0; i < 3 && place.stress; ++i)
      for (std::size_t j = 0; j < 6; ++j)
        if ((i == 2) != (j >= 2 && j <= 4)) (*place.stress)[i][j] *= -1.0;
  }
}

/// A member with all that comparisons need; `start` and `end` are the positions of its points.
struct PlacedMember {
  const Member& member;
  const Vector3& start;
  const Vector3& end;
  const Section& section;

  ReferenceCurve curve() const { return make_reference_curve(member, start, end); }
};

enum class SameLine { forward, backward };  ///< direction of the second member relative to the first

/// g2(s), spatial.
Vector3 axis2(const ReferenceCurve& curve, double s) {
  return to_array(rotation_matrix(curve.triad(s)) * Vec3<double>{{0.0, 1.0, 0.0}});
}

/// Whether the rotation of the section about the tangent does not matter.
bool is_isotropic(const Section& section) {
  return !section.matrix && section.shear_stiffness[0] == section.shear_stiffness[1] &&
         section.bending_stiffness[0] == section.bending_stiffness[1];
}

/// Uncoupled sections are invariant under a half turn about the tangent.
bool same_axes(const PlacedMember& a, const PlacedMember& b, SameLine direction) {
  if (is_isotropic(a.section) && a.member.end_section.empty()) return true;
  const ReferenceCurve along_a = a.curve(), along_b = b.curve();
  const Vector3 first = axis2(along_a, 0.0);
  const Vector3 second = axis2(along_b, direction == SameLine::forward ? 0.0 : along_b.length);
  const bool one_sided = a.section.shape && consists_of_rectangles(a.section.shape->kind);
  const bool sign_matters = a.section.matrix.has_value() || one_sided;
  if (sign_matters && (direction == SameLine::backward || dot(first, second) < 0.0)) return false;
  return norm(cross(first, second)) <= kSameAngle;
}

bool same_inner_points(const Member& a, const Member& b, SameLine direction) {
  if (a.inner_points.size() != b.inner_points.size() || a.stations.size() != b.stations.size()) return false;
  const bool forward = direction == SameLine::forward;
  for (std::size_t i = 0; i < a.inner_points.size(); ++i) {
    const InnerPoint& other = b.inner_points[forward ? i : b.inner_points.size() - 1 - i];
    if (a.inner_points[i].point != other.point) return false;
  }
  for (std::size_t i = 0; i < a.stations.size(); ++i) {
    const double other = forward ? b.stations[i] : 1.0 - b.stations[b.stations.size() - 1 - i];
    if (std::abs(a.stations[i] - other) > kStationTolerance) return false;
  }
  return true;
}

/// Whether the centerlines of two members that share both points coincide up to `tolerance` [length], and how.
std::optional<SameLine> same_centerline(const PlacedMember& a, const PlacedMember& b, double tolerance) {
  const bool closed = a.member.start_point == a.member.end_point;
  const bool forward = a.member.start_point == b.member.start_point;
  const auto first = forward ? SameLine::forward : SameLine::backward;
  if (a.member.curve.shape == CurveShape::line && b.member.curve.shape == CurveShape::line) return first;
  const ReferenceCurve along_a = a.curve(), along_b = b.curve();
  if (coincide(along_a, along_b, !forward, tolerance)) return first;
  if (closed && coincide(along_a, along_b, true, tolerance)) return SameLine::backward;
  return std::nullopt;
}

/// Names what two members on the same centerline disagree in, a parameter like "Section" or more; empty if they are the
/// same beam.
std::string difference_between(const PlacedMember& a, const PlacedMember& b, SameLine direction) {
  const Member &m = a.member, &n = b.member;
  const std::string parameter = member_parameters().difference(m, n);
  if (!parameter.empty()) return "\"" + parameter + "\"";
  if (!m.end_section.empty() && direction == SameLine::backward) return "direction of the taper";
  if (!same_inner_points(m, n, direction)) return "inner points or stations";
  if (!same_axes(a, b, direction)) return "direction of axis 2";
  return "";
}

/// The scene while patterns are applied, with indices to find things in it.
class PatternScene {
 public:
  explicit PatternScene(Scene& scene) : scene_(scene) {
    for (std::size_t i = 0; i < scene.sections.size(); ++i) section_index_.emplace(scene.sections[i].name, i);
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      point_index_.emplace(scene.points[i].name, i);
      point_label_.push_back({scene.points[i].name});
    }
    for (const Member& member : scene.members) {
      const Ends ends = {point_index_.at(member.start_point), point_index_.at(member.end_point)};
      members_at_.emplace(between(ends), ends_.size());
      ends_.push_back(ends);
      member_names_.insert(member.name);
      member_label_.push_back({member.name});
    }
  }

  CopiedPattern apply(const Pattern& pattern, const InputPlace& place) {
    Work work{place};
    select_members(pattern.members, work);
    check_size(work, pattern.count - 1);
    const std::vector<Isometry> copies = motions_of(pattern);
    select_points(work);
    check_extent(work, copies);
    PointGrid grid(scene_.points, 4.0 * work.tolerance);
    number_originals(work);
    if (!copies.front().is_shift()) find_second_axes(work);
    work.image.assign(scene_.points.size(), kNoPoint);
    CopiedPattern made;
    for (std::size_t i = 0; i < copies.size(); ++i) {
      const std::size_t before = scene_.members.size();
      copy_points(copies[i], static_cast<int>(i) + 1, grid, work);
      copy_members(copies[i], static_cast<int>(i) + 1, work);
      if (pattern.scope == CopyScope::members) continue;
      made.push_back(names_of_copy(copies[i], before, work));
      made.back().joints_alone = pattern.scope == CopyScope::joints;
    }
    return made;
  }

 private:
  using Ends = std::array<std::size_t, 2>;

  /// State of the pattern being applied.
  struct Work {
    const InputPlace& place;
    std::vector<std::size_t> members{}, points{};  ///< to be copied
    std::vector<Vector3> second_axes{};            ///< of the members, as far as copies must keep them
    std::vector<std::size_t> image{};              ///< point of the scene -> its copy
    std::vector<std::size_t> made_of{};            ///< the original of each member that the last copy made
    double tolerance = 0.0;                        ///< [length]
  };

  InputError error(const Work& work, const std::string& problem) const { return work.place.error(problem); }
  static std::uint64_t between(const Ends& ends) {
    return (static_cast<std::uint64_t>(std::min(ends[0], ends[1])) << 32U) | std::max(ends[0], ends[1]);
  }
  PlacedMember placed(const Member& member, const Ends& ends) const {
    return {member, scene_.points[ends[0]].position, scene_.points[ends[1]].position,
            scene_.sections[section_index_.at(member.section)]};
  }

  void select_members(const std::vector<std::string>& texts, Work& work) const {
    std::vector<std::string> names;
    for (const Member& member : scene_.members) names.push_back(member.name);
    std::unordered_set<std::string> selected;
    for (const std::string& text : texts) {
      const std::vector<std::string> meant = names_meant(text, names);
      if (meant.empty()) throw unknown_name(work.place["Members"], "member", text, names);
      selected.insert(meant.begin(), meant.end());
    }
    std::unordered_set<std::string> ends;
    for (const Member& member : scene_.members)
      if (selected.count(member.name) > 0) ends.insert({member.start_point, member.end_point});
    for (const Member& member : scene_.members)  // an arm goes with its member
      if (member.section == kRigidArm && ends.count(member.end_point) > 0) selected.insert(member.name);
    for (std::size_t i = 0; i < names.size(); ++i)
      if (selected.count(names[i]) > 0) work.members.push_back(i);
  }

  void select_points(Work& work) const {
    std::vector<bool> selected(scene_.points.size(), false);
    const auto select = [&](std::size_t point) {
      if (!selected[point]) work.points.push_back(point);
      selected[point] = true;
    };
    for (const std::size_t m : work.members) {
      select(ends_[m][0]);
      select(ends_[m][1]);
      for (const InnerPoint& inner : scene_.members[m].inner_points) select(point_index_.at(inner.point));
    }
  }

  /// Before anything is copied: elements and memory, as if no two copies coincided.
  void check_size(const Work& work, int copies) const {
    double elements = 0.0, bytes = 0.0;
    for (const Member& member : scene_.members) elements += member.elements;
    for (const std::size_t m : work.members) {
      const Member& member = scene_.members[m];
      const double count = copies;
      elements += count * std::max<double>(member.elements, static_cast<double>(member.inner_points.size()) + 1.0);
      bytes += count * static_cast<double>(sizeof(Member) + sizeof(Vector3) * member.curve.through.size() +
                                           sizeof(double) * member.stations.size() + 3 * member.name.size() +
                                           member.start_point.size() + member.end_point.size() +
                                           member.curve.formula[0].size() + member.curve.formula[1].size() +
                                           member.curve.formula[2].size() + 2 * member.taper.size());
    }
    if (elements <= kMostElements && bytes <= kMostCopiedBytes) return;
    throw error(work, std::to_string(copies) + " copies bring the scene to " + shortest(elements) + " elements and " +
                          shortest(bytes) + " bytes; allowed: " + std::to_string(kMostElements) + " elements, " +
                          shortest(kMostCopiedBytes) + " bytes");
  }

  /// Sets the tolerance by the size of the scene with all copies.
  void check_extent(Work& work, const std::vector<Isometry>& motions) const {
    Box box;
    for (const Point& point : scene_.points) box.enclose(point.position);
    for (const Isometry& motion : motions)
      for (const std::size_t point : work.points) box.enclose(motion.position(scene_.points[point].position));
    for (std::size_t i = 0; i < 3; ++i) {
      if (box.low[i] >= -kLargestCoordinate && box.high[i] <= kLargestCoordinate) continue;
      throw error(work, "copies have coordinates up to " + shortest(std::max(-box.low[i], box.high[i])) +
                            "; allowed: up to " + shortest(kLargestCoordinate));
    }
    work.tolerance = std::max(kPointTolerance * box.diagonal(), kShortestLength);
  }

  /// First point with a number below `end` at this position; `preferred` is checked before all others.
  std::optional<std::size_t> point_at(const Vector3& position, const PointGrid& grid, std::size_t end,
                                      std::size_t preferred, double tolerance) const {
    const auto coincides = [&](std::size_t i) {
      return i < end && norm(difference(scene_.points[i].position, position)) <= tolerance;
    };
    if (coincides(preferred)) return preferred;
    std::optional<std::size_t> found;
    grid.around(position, tolerance, [&](std::size_t i) {
      if ((!found || i < *found) && coincides(i)) found = i;
    });
    return found;
  }

  void number_originals(const Work& work) {
    for (const std::size_t point : work.points) point_label_[point].numbers.push_back(0);
    for (const std::size_t member : work.members) member_label_[member].numbers.push_back(0);
  }

  /// Second axes that copies must keep: the program's own choice depends on the direction in space, except for arc and
  /// helix, whose axis 2 points to their own axis.
  void find_second_axes(Work& work) const {
    for (const std::size_t m : work.members) {
      const Member& member = scene_.members[m];
      const CurveShape shape = member.curve.shape;
      const bool follows = shape == CurveShape::circular_arc || shape == CurveShape::helix;
      if (!is_zero(member.second_axis) || follows) {
        work.second_axes.push_back(member.second_axis);
        continue;
      }
      work.second_axes.push_back(axis2(placed(member, ends_[m]).curve(), 0.0));
    }
  }

  void copy_points(const Isometry& motion, int number, PointGrid& grid, Work& work) {
    const std::size_t before = scene_.points.size();
    for (const std::size_t point : work.points) {
      const Vector3 position = motion.position(scene_.points[point].position);
      const auto there = point_at(position, grid, before, point, work.tolerance);
      work.image[point] = there.value_or(scene_.points.size());
      if (there) continue;
      CopyLabel label = point_label_[point].copy(number);
      const std::string name = label.name();
      if (!point_index_.emplace(name, scene_.points.size()).second) {
        throw error(work, "the copy of point \"" + excerpt(scene_.points[point].name) + "\" would be \"" +
                              excerpt(name) + "\", which exists already; allowed: another name of that point");
      }
      grid.insert(position);
      scene_.points.push_back({name, position});
      point_label_.push_back(std::move(label));
    }
  }

  PatternCopy names_of_copy(const Isometry& motion, std::size_t members_before, const Work& work) const {
    PatternCopy made{motion};
    for (const std::size_t point : work.points)
      made.points.emplace(scene_.points[point].name, scene_.points[work.image[point]].name);
    for (std::size_t i = 0; i < work.made_of.size(); ++i)
      made.members.emplace(scene_.members[work.made_of[i]].name, scene_.members[members_before + i].name);
    return made;
  }

  void copy_members(const Isometry& motion, int number, Work& work) {
    const std::size_t before = scene_.members.size();
    work.made_of.clear();
    for (std::size_t i = 0; i < work.members.size(); ++i) {
      const std::size_t m = work.members[i];
      Member copy = copy_of(motion, m, work.second_axes.empty() ? Vector3{} : work.second_axes[i], work);
      CopyLabel label = member_label_[m].copy(number);
      copy.name = label.name();
      const Ends ends = {work.image[ends_[m][0]], work.image[ends_[m][1]]};
      if (ends[0] == ends[1] && ends_[m][0] != ends_[m][1])
        throw error(
            work,
            "member \"" + excerpt(copy.name) +
                "\" would have no length: both of its ends fall on one point; allowed: copies whose ends are apart");
      if (copy.curve.shape == CurveShape::parametric) placed(copy, ends).curve();  // formulas grow with every copy
      if (is_there(copy, ends, before, work)) continue;
      if (!member_names_.insert(copy.name).second) {
        throw error(work, "the copy of member \"" + excerpt(scene_.members[m].name) + "\" would be \"" +
                              excerpt(copy.name) + "\", which exists already; allowed: another name of that member");
      }
      members_at_.emplace(between(ends), scene_.members.size());
      ends_.push_back(ends);
      member_label_.push_back(std::move(label));
      scene_.members.push_back(std::move(copy));
      work.made_of.push_back(m);
    }
  }

  Member copy_of(const Isometry& motion, std::size_t member, const Vector3& second_axis, const Work& work) {
    Member copy = scene_.members[member];
    copy.start_point = scene_.points[work.image[ends_[member][0]]].name;
    copy.end_point = scene_.points[work.image[ends_[member][1]]].name;
    for (InnerPoint& inner : copy.inner_points)
      inner.point = scene_.points[work.image[point_index_.at(inner.point)]].name;
    copy.curve = image(motion, copy.curve);
    if (copy.second_axis_from) copy.second_axis_from = image(motion, *copy.second_axis_from);
    if (motion.is_shift()) return copy;
    copy.second_axis = motion.direction(second_axis);
    if (!motion.mirrors()) return copy;
    copy.twist = -copy.twist;
    copy.section = mirrored_section(copy.section);
    if (!copy.end_section.empty()) copy.end_section = mirrored_section(copy.end_section);
    return copy;
  }

  /// Whether the copy coincides with a member that existed before this round of copies.
  bool is_there(const Member& copy, const Ends& ends, std::size_t members_before, const Work& work) const {
    const auto [begin, end] = members_at_.equal_range(between(ends));
    std::string problem;
    for (auto entry = begin; entry != end; ++entry) {
      if (entry->second >= members_before) continue;
      const Member& other = scene_.members[entry->second];
      Member here = copy;
      if (differ_in_stress_points(copy.section, other.section)) here.section = other.section;
      if (differ_in_stress_points(copy.end_section, other.end_section)) here.end_section = other.end_section;
      const PlacedMember first = placed(here, ends), second = placed(other, ends_[entry->second]);
      const auto direction = same_centerline(first, second, work.tolerance);
      if (!direction) continue;
      const std::string what = difference_between(first, second, *direction);
      if (what.empty()) return true;
      problem = "member \"" + excerpt(copy.name) + "\" would lie on member \"" + excerpt(other.name) +
                "\" but differ from it in " + what + "; allowed: equal members, which become one";
    }
    if (problem.empty()) return false;
    throw error(work, problem);
  }

  /// Whether a section is the mirror image of another one, and the same but for its stress points: a member that lies
  /// on its image keeps its own.
  bool differ_in_stress_points(const std::string& name, const std::string& other) const {
    const auto known = mirrored_sections_.find(other);
    if (known == mirrored_sections_.end() || known->second != name) return false;
    const Section &a = scene_.sections[section_index_.at(name)], &b = scene_.sections[section_index_.at(other)];
    return !a.shape && a.matrix == b.matrix && a.mass_offset == b.mass_offset && a.inertia_product == b.inertia_product;
  }

  std::string mirrored_section(const std::string& name) {
    const Section& section = scene_.sections[section_index_.at(name)];
    const bool has_top = section.shape && section.shape->kind == SectionShapeKind::t_section;
    const auto known = mirrored_sections_.find(name);
    if (known != mirrored_sections_.end()) return known->second;
    Section mirrored = section;
    if (section.matrix) mirrored.matrix = mirrored_stiffness(*section.matrix);
    if (!has_top && section.mass_offset[1] == 0.0 && section.inertia_product == 0.0 && !section.stress_points &&
        (!section.matrix || *mirrored.matrix == *section.matrix))
      return mirrored_sections_[name] = name;
    mirrored.mass_offset[1] = -section.mass_offset[1];
    mirrored.inertia_product = -section.inertia_product;
    if (section.shape) mirrored.shape->mirrored = !section.shape->mirrored;
    if (section.stress_points) mirror_stress_points(*mirrored.stress_points);
    mirrored.name += " (mirrored)";
    while (section_index_.count(mirrored.name) > 0) mirrored.name += "'";
    mirrored_sections_[name] = mirrored.name;
    mirrored_sections_[mirrored.name] = name;
    section_index_.emplace(mirrored.name, scene_.sections.size());
    scene_.sections.push_back(mirrored);
    return mirrored.name;
  }

  Scene& scene_;
  std::unordered_map<std::string, std::size_t> point_index_, section_index_;
  std::unordered_set<std::string> member_names_;
  std::vector<CopyLabel> point_label_, member_label_;
  std::vector<Ends> ends_;                                          ///< points of every member
  std::unordered_multimap<std::uint64_t, std::size_t> members_at_;  ///< pair of points -> members between them
  std::unordered_map<std::string, std::string> mirrored_sections_;  ///< name -> name of the mirror image
};

}  // namespace

ListSpec patterns_spec() {
  return ListSpec("Copies of members, made in this order.").with_named_lists("pattern", pattern_parameters().spec);
}

std::vector<CopiedPattern> apply_patterns(const ParameterList& patterns, const InputPlace& place, Scene& scene) {
  const std::vector<std::string> names = names_of(patterns);
  std::vector<CopiedPattern> copies;
  if (names.empty()) return copies;
  PatternScene work(scene);
  for (const std::string& name : names) {
    try {
      CopiedPattern made = work.apply(pattern_parameters().read(patterns.sublist(name)), place[name]);
      if (!made.empty()) copies.push_back(std::move(made));
    } catch (const std::invalid_argument& problem) {
      throw place[name].error(std::string("a copy cannot be made: ") + problem.what());
    }
  }
  return copies;
}

}  // namespace mixbeam
