#include "discretization/results/records.hpp"
#include "discretization/scene/section_shape.hpp"

#include <array>
#include <map>

namespace mixbeam {

namespace {

constexpr double kFromTheBeginning = -1.0;  // below every load factor

/// A table by its columns, filled row by row: numbers, or lines of a text.
class ActingTable {
 public:
  void add(const std::string& column, double number) { append(column, std::array<double, 1>{number}); }
  void add(const std::string& column, const std::string& line) { lines_[column] += line + "\n"; }
  void add(const std::string& column, const Vector3& v) { append(column, v); }
  void add(const std::string& column, const std::array<bool, 3>& held) { append(column, held); }
  void add(const std::string& column, const std::vector<Vector3>& values) {
    for (const Vector3& v : values) append(column, v);
  }
  void add(const PlaceOnMember& at) {
    append("place", std::array<double, 2>{static_cast<double>(at.member), at.arc_length});
    append("position", at.position);
  }
  /// What has a stage or an amplitude: the load factor at which it begins to act; a formula may say anything and counts
  /// as acting from the beginning. Not NaN: what compares two files would find them different.
  template <class Load>
  void add_beginning(const Load& load) {
    add("begins", load.amplitude.empty() ? load.stage - 1.0 : kFromTheBeginning);
  }
  void write(hid_t parent, const std::string& name, std::size_t rows) const {
    if (rows == 0) return;
    const auto group = hdf5::create_group(parent, name);
    for (const auto& [column, text] : lines_) hdf5::write_text(group, column, text);
    for (const auto& [column, values] : numbers_) hdf5::write_dataset(group, column, values, values.size() / rows);
  }

 private:
  template <class Values>
  void append(const std::string& column, const Values& values) {
    std::vector<double>& held = numbers_[column];
    held.insert(held.end(), values.begin(), values.end());
  }

  std::map<std::string, std::vector<double>> numbers_;
  std::map<std::string, std::string> lines_;
};

/// A table of this name with a row for each item, which `fill(table, item)` adds.
template <class Item, class Fill>
void write_table(hid_t acting, const std::string& name, const std::vector<Item>& items, const Fill& fill) {
  ActingTable table;
  for (const Item& item : items) fill(table, item);
  table.write(acting, name, items.size());
}

std::string word_of(JointKind kind) {
  return kind == JointKind::hinge ? "hinge" : kind == JointKind::ball ? "ball" : "slider";
}

void add_support(ActingTable& table, const PlacedItem<Support>& placed) {
  const Support& support = placed.item;
  table.add(placed.place);
  table.add("point", support.point);
  for (const Vector3& axis : support.axes) table.add("axes", axis);
  table.add("fixed", support.displacement_fixed);
  table.add("fixed", support.rotation_fixed);
  table.add("stiffness", support.displacement_stiffness);
  table.add("stiffness", support.rotation_stiffness);
  table.add("prescribed", support.prescribed_displacement);
  table.add("prescribed", support.prescribed_rotation);
  table.add_beginning(support);
}

void add_joint(ActingTable& table, const PlacedItem<Joint>& placed) {
  const Joint& joint = placed.item;
  table.add(placed.place);
  table.add("name", joint.name);
  table.add("point", joint.point);
  table.add("kind", word_of(joint.kind));
  table.add("axis", joint.axis);
  table.add("stiffness", joint.stiffness);
}

void add_point_load(ActingTable& table, const PlacedItem<PointLoad>& placed) {
  const PointLoad& load = placed.item;
  table.add(placed.place);
  table.add("point", load.point);
  table.add("force", load.force);
  table.add("moment", load.moment);
  table.add("follower", load.frame == LoadFrame::follower ? 1.0 : 0.0);
  table.add_beginning(load);
}

void add_line_load(ActingTable& table, const SampledLineLoad& sampled) {
  table.add("member", static_cast<double>(sampled.member));
  table.add("force", sampled.force);
  table.add("couple", sampled.couple);
  table.add("follower", sampled.load.frame == LoadFrame::follower ? 1.0 : 0.0);
  table.add_beginning(sampled.load);
}

void add_eigenstrain(ActingTable& table, const SampledEigenstrain& sampled) {
  table.add("member", static_cast<double>(sampled.member));
  table.add("strain", sampled.strain);
  table.add("curvature", sampled.curvature);
  table.add_beginning(sampled.eigenstrain);
}

void add_section(ActingTable& table, const SampledSection& sampled) {
  const bool has_shape = !sampled.shape.empty();
  table.add("name", sampled.name);
  table.add("shape", has_shape ? section_shape_word(sampled.shape.front().kind) : "none");
  const std::vector<SectionShape> shapes = has_shape ? sampled.shape : std::vector<SectionShape>(kPlacesAlongMember);
  for (const SectionShape& shape : shapes) {
    for (const double size : {shape.size2, shape.size3, shape.wall, shape.web}) table.add("dimensions", size);
    table.add("strength", shape.strength.value_or(0.0));
  }
}

}  // namespace

void write_acting(hid_t file, const Acting& acting) {
  const auto group = hdf5::create_group(file, "acting");
  if (!acting.units.empty()) hdf5::write_attribute(group, "units", acting.units);
  write_table(group, "supports", acting.supports, add_support);
  write_table(group, "joints", acting.joints, add_joint);
  write_table(group, "point_loads", acting.point_loads, add_point_load);
  write_table(group, "line_loads", acting.line_loads, add_line_load);
  write_table(group, "eigenstrains", acting.eigenstrains, add_eigenstrain);
  write_table(group, "sections", acting.sections, add_section);
  write_table(group, "members", acting.section_of_member,
              [](ActingTable& table, int section) { table.add("section", static_cast<double>(section)); });
}

}  // namespace mixbeam
