#include "discretization/reading/patterns.hpp"

#include "discretization/geometry/isometry.hpp"
#include "discretization/geometry/point_grid.hpp"
#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/parameters/access.hpp"
#include "discretization/reading/comparison.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/name_pattern.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

namespace mixbeam {
namespace {

using Teuchos::ParameterList;
using namespace vector_algebra;

constexpr double kTurn = 6.28318530717958647693;
constexpr double kPointTolerance = 1e-9;  // of the size of the structure: points are written with a dozen digits
constexpr double kMostCopiedBytes = 4e9;  // keeps copies of large members from eating memory
constexpr std::size_t kNoPoint = ~std::size_t{0};

enum class PatternKind { repeat, rotate, mirror };
const std::map<std::string, PatternKind> kKinds = {
    {"repeat", PatternKind::repeat}, {"rotate", PatternKind::rotate}, {"mirror", PatternKind::mirror}};
const std::map<PatternKind, std::vector<std::string>> kNeeded = {{PatternKind::repeat, {"Vector", "Count"}},
                                                                 {PatternKind::rotate, {"Center", "Axis", "Count"}},
                                                                 {PatternKind::mirror, {"Point", "Normal"}}};

ListSpec pattern_spec() {
  ListSpec spec("Copies of members with their points; acts on the copies of the patterns before it too.");
  spec.add(array("Members", ParameterType::text_array)
               .by_default(Teuchos::tuple<std::string>("*"))
               .means("Names of the members, where * stands for any characters."));
  spec.add(choice("Kind", {"repeat", "rotate", "mirror"})
               .required()
               .means("repeat: shifted by Vector again and again; rotate: about an axis; mirror: reflected in a plane. "
                      "Points and members of copies that coincide with what is there become one."));
  spec.add(integer("Count")
               .at_least(2)
               .at_most(kMostElements)
               .means("repeat, rotate: how often the members are there in the end, the original counted."));
  spec.add(bounded_vector("Vector").means("repeat: from each copy to the next [length]."));
  spec.add(bounded_vector("Center").means("rotate: a point of the axis [length]."));
  spec.add(bounded_vector("Axis").means("rotate: direction of the axis; right-handed (any length)."));
  spec.add(real("Angle")
               .at_least(-kLargestAngle)
               .at_most(kLargestAngle)
               .means("rotate: from each copy to the next [radian]; a whole turn over Count if absent."));
  spec.add(bounded_vector("Point").means("mirror: a point of the plane [length]."));
  spec.add(bounded_vector("Normal").means("mirror: normal of the plane (any length)."));
  return spec;
}

/// Where a copy comes from: its name is that of the original and the numbers of the copies on the way.
struct Label {
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
  Label copy(int number) const {
    Label label = *this;
    label.numbers.back() = number;
    return label;
  }
};

/// The scene while patterns act on it, with what finds things in it.
class PatternScene {
 public:
  PatternScene(const ParameterSource& source, Scene& scene);

  void apply(const ParameterList& list, const ParameterPath& path);

 private:
  using Ends = std::array<std::size_t, 2>;

  /// One pattern at work.
  struct Work {
    const ParameterPath& path;
    std::vector<std::size_t> members{}, points{};  ///< what is copied
    std::vector<Vector3> second_axes{};            ///< of the members, as far as copies must keep them
    std::vector<std::size_t> image{};              ///< point of the scene -> its copy
    double tolerance = 0.0;                        ///< [length]
  };

  InputError error(const Work& work, const std::string& parameter, const std::string& problem) const {
    return source_.error(parameter.empty() ? work.path : child(work.path, parameter), problem);
  }
  static std::uint64_t between(const Ends& ends) {
    return (static_cast<std::uint64_t>(std::min(ends[0], ends[1])) << 32U) | std::max(ends[0], ends[1]);
  }
  PlacedMember placed(const Member& member, const Ends& ends) const {
    return {member, scene_.points[ends[0]].position, scene_.points[ends[1]].position,
            scene_.sections[section_index_.at(member.section)]};
  }

  void check_parameters(const ParameterList& list, const Work& work) const;
  std::vector<Isometry> motions(const ParameterList& list, const Work& work) const;
  Vector3 direction(const ParameterList& list, const std::string& name, const Work& work) const;
  void select_members(const ParameterList& list, Work& work) const;
  void select_points(Work& work) const;
  void check_size(const Work& work, int copies) const;
  PointGrid grid_of(Work& work, const std::vector<Isometry>& motions) const;
  void number_originals(const Work& work);
  void find_second_axes(Work& work) const;
  void copy_points(const Isometry& motion, int number, PointGrid& grid, Work& work);
  void copy_members(const Isometry& motion, int number, const Work& work);
  Member copy_of(const Isometry& motion, std::size_t member, const Vector3& second_axis, const Work& work);
  bool is_there(const Member& copy, const Ends& ends, std::size_t members_before, const Work& work) const;
  std::string mirrored_section(const std::string& name);

  const ParameterSource& source_;
  Scene& scene_;
  std::unordered_map<std::string, std::size_t> point_index_, section_index_;
  std::unordered_set<std::string> member_names_;
  std::vector<Label> point_label_, member_label_;
  std::vector<Ends> ends_;                                          ///< points of every member
  std::unordered_multimap<std::uint64_t, std::size_t> members_at_;  ///< pair of points -> members between them
  std::unordered_map<std::string, std::string> mirrored_sections_;  ///< name -> name of the mirror image
};

PatternScene::PatternScene(const ParameterSource& source, Scene& scene) : source_(source), scene_(scene) {
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

void PatternScene::apply(const ParameterList& list, const ParameterPath& path) {
  Work work{path};
  check_parameters(list, work);
  select_members(list, work);
  check_size(work, list.isParameter("Count") ? list.get<int>("Count") - 1 : 1);
  const std::vector<Isometry> copies = motions(list, work);
  select_points(work);
  PointGrid grid = grid_of(work, copies);
  number_originals(work);
  if (!copies.front().is_shift()) find_second_axes(work);
  work.image.assign(scene_.points.size(), kNoPoint);
  for (std::size_t i = 0; i < copies.size(); ++i) {
    copy_points(copies[i], static_cast<int>(i) + 1, grid, work);
    copy_members(copies[i], static_cast<int>(i) + 1, work);
  }
}

Vector3 PatternScene::direction(const ParameterList& list, const std::string& name, const Work& work) const {
  const Vector3 vector = get_vector(list, name);
  if (norm(vector) >= kShortestLength) return vector;
  throw error(work, name, "value " + to_text(vector) + " has no direction; allowed: any vector but zero");
}

void PatternScene::check_parameters(const ParameterList& list, const Work& work) const {
  const auto& word = list.get<std::string>("Kind");
  const PatternKind kind = kKinds.at(word);
  const std::vector<std::string>& needed = kNeeded.at(kind);
  for (const std::string name : {"Vector", "Center", "Axis", "Angle", "Count", "Point", "Normal"}) {
    const bool wanted = std::find(needed.begin(), needed.end(), name) != needed.end();
    const bool may_be = kind == PatternKind::rotate && name == "Angle";
    if (may_be || wanted == list.isParameter(name)) continue;
    const std::string problem = wanted ? "missing; needed for" : "given, but has no meaning for";
    throw error(work, name, problem + " \"Kind\" = \"" + word + "\"; needed with it: " + quoted_list(needed));
  }
}

/// Of all copies, the original not counted.
std::vector<Isometry> PatternScene::motions(const ParameterList& list, const Work& work) const {
  const PatternKind kind = kKinds.at(list.get<std::string>("Kind"));
  if (kind == PatternKind::mirror)
    return {Isometry::reflection(get_vector(list, "Point"), direction(list, "Normal", work))};
  const int count = list.get<int>("Count");
  std::vector<Isometry> motions;
  if (kind == PatternKind::repeat) {
    const Vector3 vector = direction(list, "Vector", work);
    for (int i = 1; i < count; ++i) motions.push_back(Isometry::shift(scaled(i, vector)));
    return motions;
  }
  const Vector3 center = get_vector(list, "Center"), axis = direction(list, "Axis", work);
  const bool by_angle = list.isParameter("Angle");
  for (int i = 1; i < count; ++i) {
    const double angle = by_angle ? i * list.get<double>("Angle") : kTurn * i / count;
    motions.push_back(Isometry::rotation(center, axis, angle));
  }
  return motions;
}

void PatternScene::select_members(const ParameterList& list, Work& work) const {
  std::vector<bool> selected(scene_.members.size(), false);
  std::unordered_map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < scene_.members.size(); ++i) index.emplace(scene_.members[i].name, i);
  for (const std::string& text : list.get<Teuchos::Array<std::string>>("Members")) {
    bool found = false;
    const auto exact = index.find(text);
    if (exact != index.end()) {
      selected[exact->second] = found = true;
    } else if (has_wildcard(text)) {
      for (std::size_t i = 0; i < scene_.members.size(); ++i)
        if (matches(text, scene_.members[i].name)) selected[i] = found = true;
    }
    if (found) continue;
    std::vector<std::string> names;
    for (const Member& member : scene_.members) names.push_back(member.name);
    throw unknown_name(source_, child(work.path, "Members"), "member", text, names);
  }
  for (std::size_t i = 0; i < selected.size(); ++i)
    if (selected[i]) work.members.push_back(i);
}

void PatternScene::select_points(Work& work) const {
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
void PatternScene::check_size(const Work& work, int copies) const {
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
  throw error(work, "",
              std::to_string(copies) + " copies bring the scene to " + shortest(elements) + " elements and " +
                  shortest(bytes) + " bytes; allowed: " + std::to_string(kMostElements) + " elements, " +
                  shortest(kMostCopiedBytes) + " bytes");
}

/// Grid with all points of the scene, wide enough for all copies.
PointGrid PatternScene::grid_of(Work& work, const std::vector<Isometry>& motions) const {
  constexpr double kHuge = 1e300;
  Vector3 low = {kHuge, kHuge, kHuge}, high = {-kHuge, -kHuge, -kHuge};
  const auto include = [&](const Vector3& x) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], x[i]);
      high[i] = std::max(high[i], x[i]);
    }
  };
  for (const Point& point : scene_.points) include(point.position);
  for (const Isometry& motion : motions)
    for (const std::size_t point : work.points) include(motion.position(scene_.points[point].position));
  for (std::size_t i = 0; i < 3; ++i) {
    if (low[i] >= -kLargestCoordinate && high[i] <= kLargestCoordinate) continue;
    throw error(work, "",
                "copies have coordinates up to " + shortest(std::max(-low[i], high[i])) + "; allowed: up to " +
                    shortest(kLargestCoordinate));
  }
  work.tolerance = std::max(kPointTolerance * norm(difference(high, low)), kShortestLength);
  const double reach = 2.0 * work.tolerance;
  PointGrid grid(difference(low, {reach, reach, reach}), work.tolerance);
  for (const Point& point : scene_.points) grid.insert(point.position);
  return grid;
}

void PatternScene::number_originals(const Work& work) {
  for (const std::size_t point : work.points) point_label_[point].numbers.push_back(0);
  for (const std::size_t member : work.members) member_label_[member].numbers.push_back(0);
}

/// A copy keeps how the section lies in it: the choice of the program depends on the direction in space, except for
/// arc and helix, whose axis 2 points to their own axis.
void PatternScene::find_second_axes(Work& work) const {
  for (const std::size_t m : work.members) {
    const Member& member = scene_.members[m];
    const CurveShape shape = member.curve.shape;
    const bool follows = shape == CurveShape::circular_arc || shape == CurveShape::helix;
    if (!is_zero(member.second_axis) || follows) {
      work.second_axes.push_back(member.second_axis);
      continue;
    }
    const Vec3<double> g2 = rotation_matrix(placed(member, ends_[m]).curve().triad(0.0)) * Vec3<double>{{0, 1, 0}};
    work.second_axes.push_back({g2[0], g2[1], g2[2]});
  }
}

void PatternScene::copy_points(const Isometry& motion, int number, PointGrid& grid, Work& work) {
  const std::size_t before = scene_.points.size();
  for (const std::size_t point : work.points) {
    const Vector3 position = motion.position(scene_.points[point].position);
    const auto there = grid.find(position, before, point);
    work.image[point] = there.value_or(scene_.points.size());
    if (there) continue;
    Label label = point_label_[point].copy(number);
    const std::string name = label.name();
    if (!point_index_.emplace(name, scene_.points.size()).second) {
      throw error(work, "",
                  "the copy of point \"" + excerpt(scene_.points[point].name) + "\" would be \"" + excerpt(name) +
                      "\", which exists already; allowed: another name of that point");
    }
    grid.insert(position);
    scene_.points.push_back({name, position});
    point_label_.push_back(std::move(label));
  }
}

void PatternScene::copy_members(const Isometry& motion, int number, const Work& work) {
  const std::size_t before = scene_.members.size();
  for (std::size_t i = 0; i < work.members.size(); ++i) {
    const std::size_t m = work.members[i];
    Member copy = copy_of(motion, m, work.second_axes.empty() ? Vector3{} : work.second_axes[i], work);
    Label label = member_label_[m].copy(number);
    copy.name = label.name();
    const Ends ends = {work.image[ends_[m][0]], work.image[ends_[m][1]]};
    if (ends[0] == ends[1] && ends_[m][0] != ends_[m][1])
      throw error(work, "", "member \"" + excerpt(copy.name) + "\" would have no length");
    if (copy.curve.shape == CurveShape::parametric) placed(copy, ends).curve();  // formulas grow with every copy
    if (is_there(copy, ends, before, work)) continue;
    if (!member_names_.insert(copy.name).second) {
      throw error(work, "",
                  "the copy of member \"" + excerpt(scene_.members[m].name) + "\" would be \"" + excerpt(copy.name) +
                      "\", which exists already; allowed: another name of that member");
    }
    members_at_.emplace(between(ends), scene_.members.size());
    ends_.push_back(ends);
    member_label_.push_back(std::move(label));
    scene_.members.push_back(std::move(copy));
  }
}

Member PatternScene::copy_of(const Isometry& motion, std::size_t member, const Vector3& second_axis, const Work& work) {
  Member copy = scene_.members[member];
  copy.start_point = scene_.points[work.image[ends_[member][0]]].name;
  copy.end_point = scene_.points[work.image[ends_[member][1]]].name;
  for (InnerPoint& inner : copy.inner_points)
    inner.point = scene_.points[work.image[point_index_.at(inner.point)]].name;
  copy.curve = image(motion, copy.curve);
  if (motion.is_shift()) return copy;
  copy.second_axis = motion.direction(second_axis);
  if (!motion.mirrors()) return copy;
  copy.twist = -copy.twist;
  copy.section = mirrored_section(copy.section);
  if (!copy.end_section.empty()) copy.end_section = mirrored_section(copy.end_section);
  return copy;
}

/// Whether the copy coincides with one of the members that were there before this round of copies.
bool PatternScene::is_there(const Member& copy, const Ends& ends, std::size_t members_before, const Work& work) const {
  const auto [begin, end] = members_at_.equal_range(between(ends));
  std::string problem;
  for (auto entry = begin; entry != end; ++entry) {
    if (entry->second >= members_before) continue;
    const Member& other = scene_.members[entry->second];
    const PlacedMember first = placed(copy, ends), second = placed(other, ends_[entry->second]);
    const auto direction = same_centerline(first, second, work.tolerance);
    if (!direction) continue;
    const std::string what = difference_between(first, second, *direction);
    if (what.empty()) return true;
    problem = "member \"" + excerpt(copy.name) + "\" would lie on member \"" + excerpt(other.name) +
              "\" but differ from it in " + what + "; allowed: equal members, which become one";
  }
  if (problem.empty()) return false;
  throw error(work, "", problem);
}

std::string PatternScene::mirrored_section(const std::string& name) {
  const Section& section = scene_.sections[section_index_.at(name)];
  if (!section.matrix) return name;
  const auto known = mirrored_sections_.find(name);
  if (known != mirrored_sections_.end()) return known->second;
  Section mirrored = section;
  mirrored.matrix = mirrored_stiffness(*section.matrix);
  if (*mirrored.matrix == *section.matrix) return mirrored_sections_[name] = name;
  mirrored.name += " (mirrored)";
  while (section_index_.count(mirrored.name) > 0) mirrored.name += "'";
  mirrored_sections_[name] = mirrored.name;
  mirrored_sections_[mirrored.name] = name;
  section_index_.emplace(mirrored.name, scene_.sections.size());
  scene_.sections.push_back(mirrored);
  return mirrored.name;
}

}  // namespace

ListSpec patterns_spec() {
  return ListSpec("Copies of members, made in this order.").with_named_lists("pattern", pattern_spec());
}

void apply_patterns(const ParameterList& patterns, const ParameterSource& source, const ParameterPath& path,
                    Scene& scene) {
  const std::vector<std::string> names = names_of(patterns);
  if (names.empty()) return;
  PatternScene work(source, scene);
  for (const std::string& name : names) {
    try {
      work.apply(patterns.sublist(name), child(path, name));
    } catch (const std::invalid_argument& problem) {
      throw source.error(child(path, name), std::string("a copy cannot be made: ") + problem.what());
    }
  }
}

}  // namespace mixbeam
