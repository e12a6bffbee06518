#include "discretization/results/records.hpp"

#include <limits>

namespace mixbeam {

namespace {

/// Columns of a table, filled row by row.
using Numbers = std::vector<double>;
using Lines = std::vector<std::string>;

void add_vector(Numbers& numbers, const Vector3& v) { numbers.insert(numbers.end(), v.begin(), v.end()); }

std::string joined_lines(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += (&line == &lines.front() ? "" : "\n") + line;
  return text;
}

const char* word_of(JointKind kind) {
  return kind == JointKind::hinge ? "hinge" : kind == JointKind::ball ? "ball" : "slider";
}

/// Load factor at which it begins to act; NaN where a formula says how it grows.
template <class Load>
double beginning_of(const Load& load) {
  return load.amplitude.empty() ? load.stage - 1.0 : std::numeric_limits<double>::quiet_NaN();
}

struct PlaceColumns {
  Numbers place, position;
  void add(const PlaceOnMember& at) {
    place.insert(place.end(), {static_cast<double>(at.member), at.arc_length});
    add_vector(position, at.position);
  }
  void write(hid_t group) const {
    hdf5::write_dataset(group, "place", place, 2);
    hdf5::write_dataset(group, "position", position, 3);
  }
};

void write_acting_supports(hid_t acting, const std::vector<PlacedItem<Support>>& supports) {
  if (supports.empty()) return;
  PlaceColumns places;
  Numbers axes, fixed, stiffness, prescribed;
  Lines points;
  for (const auto& [support, place] : supports) {
    places.add(place);
    points.push_back(support.point);
    for (const Vector3& axis : support.axes) add_vector(axes, axis);
    for (const auto* held : {&support.displacement_fixed, &support.rotation_fixed})
      fixed.insert(fixed.end(), held->begin(), held->end());
    add_vector(stiffness, support.displacement_stiffness);
    add_vector(stiffness, support.rotation_stiffness);
    add_vector(prescribed, support.prescribed_displacement);
    add_vector(prescribed, support.prescribed_rotation);
  }
  const auto group = hdf5::create_group(acting, "supports");
  places.write(group);
  hdf5::write_text(group, "point", joined_lines(points));
  hdf5::write_dataset(group, "axes", axes, 9);
  hdf5::write_dataset(group, "fixed", fixed, 6);
  hdf5::write_dataset(group, "stiffness", stiffness, 6);
  hdf5::write_dataset(group, "prescribed", prescribed, 6);
}

void write_joints(hid_t acting, const std::vector<PlacedItem<Joint>>& joints) {
  if (joints.empty()) return;
  PlaceColumns places;
  Numbers axes, stiffness;
  Lines names, points, kinds;
  for (const auto& [joint, place] : joints) {
    places.add(place);
    names.push_back(joint.name);
    points.push_back(joint.point);
    kinds.emplace_back(word_of(joint.kind));
    add_vector(axes, joint.axis);
    stiffness.push_back(joint.stiffness);
  }
  const auto group = hdf5::create_group(acting, "joints");
  places.write(group);
  hdf5::write_text(group, "name", joined_lines(names));
  hdf5::write_text(group, "point", joined_lines(points));
  hdf5::write_text(group, "kind", joined_lines(kinds));
  hdf5::write_dataset(group, "axis", axes, 3);
  hdf5::write_dataset(group, "stiffness", stiffness, 1);
}

void write_point_loads(hid_t acting, const std::vector<PlacedItem<PointLoad>>& loads) {
  if (loads.empty()) return;
  PlaceColumns places;
  Numbers force, moment, follower, begins;
  Lines points;
  for (const auto& [load, place] : loads) {
    places.add(place);
    points.push_back(load.point);
    add_vector(force, load.force);
    add_vector(moment, load.moment);
    follower.push_back(load.frame == LoadFrame::follower);
    begins.push_back(beginning_of(load));
  }
  const auto group = hdf5::create_group(acting, "point_loads");
  places.write(group);
  hdf5::write_text(group, "point", joined_lines(points));
  hdf5::write_dataset(group, "force", force, 3);
  hdf5::write_dataset(group, "moment", moment, 3);
  hdf5::write_dataset(group, "follower", follower, 1);
  hdf5::write_dataset(group, "begins", begins, 1);
}

void write_line_loads(hid_t acting, const std::vector<SampledLineLoad>& loads) {
  if (loads.empty()) return;
  Numbers member, force, couple, follower, begins;
  for (const SampledLineLoad& load : loads) {
    member.push_back(load.member);
    for (const Vector3& value : load.force) add_vector(force, value);
    for (const Vector3& value : load.couple) add_vector(couple, value);
    follower.push_back(load.load.frame == LoadFrame::follower);
    begins.push_back(beginning_of(load.load));
  }
  const auto group = hdf5::create_group(acting, "line_loads");
  hdf5::write_dataset(group, "member", member, 1);
  hdf5::write_dataset(group, "force", force, 3 * kPlacesOfLineLoad);
  hdf5::write_dataset(group, "couple", couple, 3 * kPlacesOfLineLoad);
  hdf5::write_dataset(group, "follower", follower, 1);
  hdf5::write_dataset(group, "begins", begins, 1);
}

}  // namespace

void write_acting(hid_t file, const Acting& acting) {
  const auto group = hdf5::create_group(file, "acting");
  if (!acting.units.empty()) hdf5::write_attribute(group, "units", acting.units);
  write_acting_supports(group, acting.supports);
  write_joints(group, acting.joints);
  write_point_loads(group, acting.point_loads);
  write_line_loads(group, acting.line_loads);
}

}  // namespace mixbeam
