/// The part of ConditionReader that lets what acts go with the copies of patterns.

#include "discretization/reading/conditions/condition_reader.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>

namespace mixbeam {
namespace {

using namespace vector_algebra;

/// Components in the triad of a mirrored section, whose axis 3 is the opposite of the image of axis 3: of vectors, and
/// of axial ones (moments, curvatures).
constexpr Vector3 kMirroredVector{1, 1, -1}, kMirroredAxial{-1, -1, 1};

bool is_given(const Formulas& formula) {
  return std::any_of(formula.begin(), formula.end(), [](const std::string& text) { return !text.empty(); });
}

Vector3 product(const Vector3& a, const Vector3& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }

/// The image of a field under `turn`, which is linear.
template <class Turn>
void turn_field(const Turn& turn, Vector3& constant, Formulas& formula) {
  constant = turn(constant);
  if (!is_given(formula)) return;
  const std::array<Vector3, 3> images = {turn(Vector3{1, 0, 0}), turn(Vector3{0, 1, 0}), turn(Vector3{0, 0, 1})};
  Formulas turned;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      if (images[j][i] != 0.0 && !formula[j].empty())
        turned[i] += (turned[i].empty() ? "(" : " + (") + shortest(images[j][i]) + ") * (" + formula[j] + ")";
    if (turned[i].empty()) turned[i] = "0";
  }
  formula = turned;
}

/// The vectors of a load: in space, or in the triads of members.
template <class Load>
void turn(const Isometry& motion, Load& load) {
  const bool in_triad = ActingKind<Load>::is_in_triad(load);
  ActingKind<Load>::for_each_vector(load, [&](Vector3& constant, Formulas* formula, VectorRole role) {
    const auto image = [&](const Vector3& v) {
      if (!in_triad) return is_axial(role) ? motion.turning_axis(v) : motion.direction(v);
      return motion.mirrors() ? product(is_axial(role) ? kMirroredAxial : kMirroredVector, v) : v;
    };
    Formulas none;
    turn_field(image, constant, formula != nullptr ? *formula : none);
  });
}

/// Its axes go with it, right-handed; a clamp or ball without springs and motion is the same along any axes.
void turn(const Isometry& motion, Support& support) {
  if (motion.is_shift()) return;
  const auto all_alike = [](const std::array<bool, 3>& fixed) { return fixed[0] == fixed[1] && fixed[1] == fixed[2]; };
  const bool is_isotropic = all_alike(support.displacement_fixed) && all_alike(support.rotation_fixed) &&
                            is_zero(support.prescribed_displacement) && is_zero(support.prescribed_rotation) &&
                            is_zero(support.displacement_stiffness) && is_zero(support.rotation_stiffness);
  if (is_isotropic) return;
  for (Vector3& axis : support.axes) axis = motion.direction(axis);
  if (!motion.mirrors()) return;
  support.axes[2] = scaled(-1.0, support.axes[2]);
  turn<Support>(motion, support);
}

void turn(const Isometry& motion, PointMass& body) {
  for (Vector3& axis : body.axes) axis = motion.direction(axis);  // their signs do not matter
}

}  // namespace

/// An entry acts once at each place: where it is already, by its name or as another copy, nothing is added.
template <class Acting>
void ConditionReader::copy_with_patterns() {
  if (copies_.empty()) return;
  using Kind = ActingKind<Acting>;
  auto& all = scene_.*Kind::list;
  std::vector<std::string>& entries = entries_[Kind::name];
  std::set<std::pair<std::string, std::string>> acts;
  for (std::size_t i = 0; i < all.size(); ++i) acts.emplace(entries[i], all[i].*Kind::target);
  for (const CopiedPattern& pattern : copies_) {
    const std::size_t originals = all.size();
    for (const PatternCopy& made : pattern)
      for (std::size_t i = 0; i < originals && !made.joints_alone; ++i) {
        const auto& images = Kind::along_member ? made.members : made.points;
        const auto image = images.find(all[i].*Kind::target);
        if (image == images.end() || !acts.emplace(entries[i], image->second).second) continue;
        Acting copy = all[i];
        copy.*Kind::target = image->second;
        turn(made.motion, copy);
        if (!goes_along(copy, made, entries[i])) continue;
        count(1, place_);
        add(copy, std::string(entries[i]));
      }
  }
}

void ConditionReader::note_left_out(const std::string& list, const std::string& entry, const std::string& point,
                                    const std::string& why) {
  notes_.push_back("\"" + list + " / " + excerpt(entry) + "\" is not copied to \"" + excerpt(point) + "\": " + why);
}

void ConditionReader::copy_supports() { copy_with_patterns<Support>(); }

void ConditionReader::copy_loads() {
  for_each_kind([this](auto kind) {
    using Load = typename std::decay_t<decltype(scene_.*kind.list)>::value_type;
    if constexpr (!kind.stays) copy_with_patterns<Load>();
  });
  copy_with_patterns<PointMass>();
}

bool ConditionReader::goes_along(Support& copy, const PatternCopy&, const std::string& entry) {
  claim_support(copy.point, entry, place_["Supports"][entry]);
  return true;
}

bool ConditionReader::goes_along(PointLoad& copy, const PatternCopy& made, const std::string& entry) {
  if (copy.frame == LoadFrame::dead) return true;
  const auto image = made.members.find(copy.member);
  if (image == made.members.end())
    note_left_out("Point Loads", entry, copy.point,
                  "no copy of the member \"" + excerpt(copy.member) + "\" that it turns with");
  else
    copy.member = image->second;
  return image != made.members.end();
}

bool ConditionReader::goes_along(DistributedLoad& copy, const PatternCopy&, const std::string& entry) {
  divide_at(copy.member, copy.range, place_["Distributed Loads"][entry]["Range"]);
  return true;
}

/// Each listed member takes its joint with it, also to a point that the pattern leaves where it is. Where a pattern
/// ends there may be nobody whom a copy could be joined to.
void ConditionReader::copy_joints() {
  std::set<std::string> written;  // points of joints that no pattern made
  for (const Joint& joint : scene_.joints) written.insert(joint.point);
  const std::size_t first_copy = scene_.joints.size();
  for (const CopiedPattern& pattern : copies_) {
    const std::size_t originals = scene_.joints.size();
    for (const PatternCopy& made : pattern)
      for (std::size_t i = 0; i < originals; ++i) {
        const auto point = made.points.find(scene_.joints[i].point);
        if (point == made.points.end()) continue;
        Joint copy = scene_.joints[i];
        copy.point = point->second;
        copy.axis = made.motion.turning_axis(copy.axis);
        for (const std::string& member : std::exchange(copy.members, {})) {
          const auto image = made.members.find(member);
          if (image != made.members.end() && joined_at_[copy.point].insert(image->second).second)
            copy.members.push_back(image->second);
        }
        if (copy.members.empty()) continue;
        count(copy.members.size(), place_);
        scene_.joints.push_back(std::move(copy));
      }
  }
  std::set<std::string> alone;
  const auto is_left_out = [&](const Joint& joint) {
    if (written.count(joint.point) > 0 || is_someone_left(joint)) return false;
    alone.insert(joint.point);
    note_left_out("Joints", joint.name, joint.point, "no members there that it could be joined to");
    return true;
  };
  const auto first = scene_.joints.begin() + static_cast<std::ptrdiff_t>(first_copy);
  const auto end = std::remove_if(first, scene_.joints.end(), is_left_out);
  scene_.joints.erase(end, scene_.joints.end());
  for (const std::string& point : alone) joined_at_.erase(point);
}

}  // namespace mixbeam
