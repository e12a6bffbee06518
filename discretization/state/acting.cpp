#include "discretization/state/acting.hpp"

#include "discretization/assembly/line_fields.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/scene/section_shape.hpp"
#include "discretization/text/expression.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace mixbeam {

namespace {

/// Place on the centerline of a member.
struct PlaceOnMember {
  int member = 0;           ///< in the order of the scene
  double arc_length = 0.0;  ///< from its start [length]
  Vector3 position{};       ///< undeformed
};

/// Finds the places of points. Members that are joined at a point come after all others.
class PlaceFinder {
 public:
  PlaceFinder(const Scene& scene, const Mesh& mesh) : mesh_(mesh) {
    std::set<std::pair<std::string, std::string>> joined;  // point, member
    for (const Joint& joint : scene.joints)
      for (const std::string& member : joint.members) joined.emplace(joint.point, member);
    for (std::size_t m = 0; m < scene.members.size(); ++m) {
      const Member& member = scene.members[m];
      index_.emplace(member.name, static_cast<int>(m));
      const double length = mesh.member_length[m];
      const auto add = [&](const std::string& point, double s) {
        const bool is_joined = !joined.empty() && joined.count({point, member.name}) > 0;
        auto& places = is_joined ? joined_ : free_;
        places[point].emplace_back(static_cast<int>(m), s);
      };
      add(member.start_point, 0.0);
      for (const InnerPoint& inner : member.inner_points) add(inner.point, inner.position * length);
      add(member.end_point, length);
    }
  }

  int member(const std::string& name) const { return index_.at(name); }
  PlaceOnMember place(const std::string& point, const std::string& member = "") const {
    for (const auto* places : {&free_, &joined_}) {
      const auto found = places->find(point);
      if (found == places->end()) continue;
      for (const auto& [index, s] : found->second)
        if (member.empty() || index == index_.at(member)) return {index, s, position_of(point)};
    }
    return {0, 0.0, position_of(point)};  // only if the points of the scene were not checked
  }

 private:
  using Places = std::unordered_map<std::string, std::vector<std::pair<int, double>>>;

  Vector3 position_of(const std::string& point) const { return mesh_.vertex_position[vertex_of(mesh_, point)]; }

  const Mesh& mesh_;
  Places free_, joined_;
  std::unordered_map<std::string, int> index_;
};

constexpr double kFromTheBeginning = -1.0;  // below every load factor

/// Fills the rows of one table.
class TableFiller {
 public:
  explicit TableFiller(ActingTable& table) : table_(table) { ++table_.rows; }

  void add(const std::string& column, double number) { append(column, std::array<double, 1>{number}); }
  void add(const std::string& column, const std::string& line) { table_.lines[column] += line + "\n"; }
  void add(const std::string& column, const Vector3& v) { append(column, v); }
  void add(const std::string& column, const std::array<bool, 3>& held) { append(column, held); }
  void add(const PlaceOnMember& at) {
    append("place", std::array<double, 2>{static_cast<double>(at.member), at.arc_length});
    append("position", at.position);
  }
  /// Load factor at which a load with a stage or an amplitude begins to act; a formula is not analysed and acts from
  /// the beginning. Not NaN, because a comparison of two files would find it different.
  template <class Load>
  void add_beginning(const Load& load) {
    add("begins", load.amplitude.empty() ? load.stage - 1.0 : kFromTheBeginning);
  }
  /// Adds values along a range of a member of this length: a constant, formulas, or a table, times factor_at(arc
  /// length).
  template <class Factor>
  void add_along(const std::string& column, const Vector3& constant, const std::array<std::string, 3>& formula,
                 double length, const std::array<double, 2>& range, const Factor& factor_at,
                 const FieldTable* table = nullptr) {
    std::vector<Vector3> values(kPlacesAlongMember, constant);
    const auto place_at = [&](int place) {
      return range[0] + (range[1] - range[0]) * place / (kPlacesAlongMember - 1);
    };
    for (std::size_t i = 0; i < 3; ++i) {
      if (formula[i].empty()) continue;
      const Expression component(formula[i], {"s", "x"});
      for (int place = 0; place < kPlacesAlongMember; ++place) {
        const double x = place_at(place);
        values[place][i] = component({x * length, x});
      }
    }
    for (int place = 0; place < kPlacesAlongMember; ++place) {
      const double s = place_at(place) * length;
      const Vector3 value = table != nullptr ? table->at(s) : values[place];
      append(column, vector_algebra::is_zero(value) ? value : vector_algebra::scaled(factor_at(s), value));
    }
  }

 private:
  template <class Values>
  void append(const std::string& column, const Values& values) {
    std::vector<double>& held = table_.numbers[column];
    held.insert(held.end(), values.begin(), values.end());
  }

  ActingTable& table_;
};

std::string word_of(JointKind kind) {
  return kind == JointKind::hinge ? "hinge" : kind == JointKind::ball ? "ball" : "slider";
}

/// Creates the tables, one row per item.
class ActingTables {
 public:
  ActingTables(const Scene& scene, const Mesh& mesh) : scene_(scene), mesh_(mesh), places_(scene, mesh) {}

  ActingTable supports() const {
    return table_of("supports", scene_.supports, [&](TableFiller row, const Support& support) {
      row.add(places_.place(support.point));
      row.add("point", support.point);
      for (const Vector3& axis : support.axes) row.add("axes", axis);
      row.add("fixed", support.displacement_fixed);
      row.add("fixed", support.rotation_fixed);
      row.add("stiffness", support.displacement_stiffness);
      row.add("stiffness", support.rotation_stiffness);
      row.add("prescribed", support.prescribed_displacement);
      row.add("prescribed", support.prescribed_rotation);
      row.add_beginning(support);
    });
  }
  /// One row per member connected by a joint.
  ActingTable joints() const {
    ActingTable table{"joints"};
    for (const Joint& joint : scene_.joints)
      for (const std::string& member : joint.members) {
        TableFiller row(table);
        row.add(places_.place(joint.point, member));
        row.add("name", joint.name);
        row.add("point", joint.point);
        row.add("kind", word_of(joint.kind));
        row.add("axis", joint.axis);
        row.add("stiffness", joint.stiffness);
      }
    return table;
  }
  /// Follower loads are placed on their member.
  ActingTable point_loads() const {
    return table_of("point_loads", scene_.point_loads, [&](TableFiller row, const PointLoad& load) {
      const bool follows = load.frame == LoadFrame::follower;
      row.add(places_.place(load.point, follows ? load.member : ""));
      row.add("point", load.point);
      row.add("force", load.force);
      row.add("moment", load.moment);
      row.add("follower", follows ? 1.0 : 0.0);
      row.add_beginning(load);
    });
  }
  ActingTable line_loads() const {
    return table_of("line_loads", scene_.distributed_loads, [&](TableFiller row, const DistributedLoad& load) {
      const double length = add_member(row, load.member);
      const int member = places_.member(load.member);
      SectionLaw law;
      const bool varies = load.is_weight && has_general_section(scene_, scene_.members[member]);
      if (varies) law = SectionLaw(scene_, scene_.members[member]);
      const auto factor_at = [&](double s) {
        return local_factor(load, mesh_.members[member], varies ? &law : nullptr, s);
      };
      row.add_along("force", load.force, load.force_formula, length, load.range, factor_at);
      row.add_along("couple", load.couple, load.couple_formula, length, load.range, factor_at);
      for (const double x : load.range) row.add("range", x);
      row.add("follower", load.frame == LoadFrame::follower ? 1.0 : 0.0);
      row.add_beginning(load);
    });
  }
  ActingTable eigenstrains() const {
    return table_of("eigenstrains", scene_.eigenstrains, [&](TableFiller row, const Eigenstrain& strain) {
      const double length = add_member(row, strain.member);
      const auto add = [&](const char* column, const Vector3& constant, const auto& formula, const FieldTable* table) {
        const double factor = table != nullptr ? strain.table_factor : 1.0;
        row.add_along(
            column, constant, formula, length, {0.0, 1.0}, [=](double) { return factor; }, table);
      };
      add("strain", strain.strain, strain.strain_formula, strain.strain_table.get());
      add("curvature", strain.curvature, strain.curvature_formula, strain.curvature_table.get());
      for (const Vector3& turn : strain.end_turns) row.add("turns", turn);
      row.add_beginning(strain);
    });
  }
  ActingTable rotating_frames() const {
    return table_of("rotating_frames", scene_.rotating_frames, [&](TableFiller row, const RotatingFrame& frame) {
      row.add("position", frame.point);
      row.add("velocity", frame.velocity);
      row.add_beginning(frame);
    });
  }
  /// Lists all different sections, and the one of each member.
  std::array<ActingTable, 2> sections() const {
    std::array<ActingTable, 2> tables{ActingTable{"sections"}, ActingTable{"members"}};
    std::map<std::tuple<std::string, std::string, std::string>, int> known;
    for (const Member& member : scene_.members) {
      const auto [section, is_new] =
          known.try_emplace({member.section, member.end_section, member.taper}, static_cast<int>(known.size()));
      if (is_new) add_section(TableFiller(tables[0]), SectionLaw(scene_, member));
      TableFiller(tables[1]).add("section", static_cast<double>(section->second));
    }
    return tables;
  }

 private:
  template <class Item, class Fill>
  static ActingTable table_of(const char* name, const std::vector<Item>& items, const Fill& fill) {
    ActingTable table{name};
    for (const Item& item : items) fill(TableFiller(table), item);
    return table;
  }
  double add_member(TableFiller& row, const std::string& name) const {
    const int member = places_.member(name);
    row.add("member", static_cast<double>(member));
    return mesh_.member_length[member];
  }
  /// Named after the section at the start of a taper.
  static void add_section(TableFiller row, const SectionLaw& law) {
    for (int place = 0; place < kPlacesAlongMember; ++place) {
      const Section section = law.section(static_cast<double>(place) / (kPlacesAlongMember - 1));
      if (place == 0) row.add("name", section.name);
      const SectionShape shape = section.shape.value_or(section.drawn_as.value_or(SectionShape{}));
      const std::string word = (section.drawn_as ? "drawn as " : "") + section_shape_word(shape.kind);
      const bool is_seen = section.shape || section.drawn_as;
      if (place == 0) row.add("shape", is_seen ? word + (shape.mirrored ? " mirrored" : "") : "none");
      for (const double size : {shape.size2, shape.size3, shape.wall, shape.web}) row.add("dimensions", size);
      row.add("strength", shape.strength.value_or(0.0));
    }
  }

  const Scene& scene_;
  const Mesh& mesh_;
  PlaceFinder places_;
};

}  // namespace

Acting acting_on(const Scene& scene, const Mesh& mesh) {
  const ActingTables tables(scene, mesh);
  Acting acting{scene.units,
                {tables.supports(), tables.joints(), tables.point_loads(), tables.line_loads(), tables.eigenstrains(),
                 tables.rotating_frames()}};
  for (ActingTable& table : tables.sections()) acting.tables.push_back(std::move(table));
  const auto is_empty = [](const ActingTable& table) { return table.rows == 0; };
  acting.tables.erase(std::remove_if(acting.tables.begin(), acting.tables.end(), is_empty), acting.tables.end());
  return acting;
}

}  // namespace mixbeam
