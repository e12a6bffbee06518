#include "apps/common/studies/imperfect_structures.hpp"

#include "apps/common/studies/random_numbers.hpp"
#include "apps/common/studies/variants.hpp"
#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/constants.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace mixbeam {

namespace {

constexpr std::array<const char*, 8> kFamilies = {"column", "frame",   "knee", "arch",
                                                  "ring",   "lattice", "dome", "strip"};
constexpr int kOrder = 3;
constexpr double kRigid = std::numeric_limits<double>::infinity();
constexpr Vector3 kNormal = {0, 0, 1};  ///< of the plane in which all but domes are drawn

Vector3 times(double factor, const Vector3& v) { return vector_algebra::scaled(factor, v); }

/// Draws one structure. Lengths are multiples of length_, bending stiffnesses of bending_.
class ImperfectMaker {
 public:
  ImperfectMaker(std::uint64_t seed, int number)
      : random_(seed + 1000003ULL * static_cast<std::uint64_t>(number)),
        family_(static_cast<size_t>(number) % kFamilies.size()) {
    made_.family = kFamilies[family_];
    made_.scene.name = made_.family + " " + std::to_string(number);
    length_ = random_.decades(-1, 1);
    bending_ = random_.decades(-2, 2);
    const double size = random_.decades(-6, -1);
    made_.imperfection = random_.chance(0.5) ? size : -size;
    // More than half are meant to pass the critical load, by 10 % at least: most of the formulas are rough.
    made_.estimate =
        random_.chance(0.5) ? random_.between(0.2, 0.9) : random_.decades(std::log10(1.1), std::log10(4.0));
  }

  ImperfectStructure make() {
    using Maker = ImperfectMaker;
    const std::array make_family = {&Maker::make_column, &Maker::make_frame,   &Maker::make_knee, &Maker::make_arch,
                                    &Maker::make_ring,   &Maker::make_lattice, &Maker::make_dome, &Maker::make_strip};
    make_section();
    (this->*make_family[family_])();
    return made_;
  }

 private:
  Scene& scene() { return made_.scene; }
  double unit_force() const { return bending_ / (length_ * length_); }

  /// g3 is the normal of the plane where there is one, so EI3 bends in it.
  void make_section() {
    const double slenderness = random_.decades(1.5, 3.5);
    axial_ = bending_ * slenderness * slenderness / (length_ * length_);
    const double shear = random_.chance(0.5) ? kRigid : 0.35 * axial_;
    const double across = random_.chance(0.5) ? 1.0 : random_.between(1.0, 4.0);
    scene().sections = {{"rod", axial_, {shear, shear}, 0.8 * bending_, {across * bending_, bending_}}};
    in_space_ = random_.chance(0.35);
  }

  void add_point(const std::string& name, const Vector3& place) {
    scene().points.push_back({name, times(length_, place)});
  }
  const Vector3& place_of(const std::string& name) const { return position_of(made_.scene, name); }

  Member& add_member(const std::string& start, const std::string& end, int elements) {
    Member member = straight_member(start, end, "rod", kOrder, elements);
    const Vector3 along = vector_algebra::difference(place_of(end), place_of(start));
    member.second_axis = vector_algebra::cross(kNormal, along);
    scene().members.push_back(member);
    return scene().members.back();
  }
  /// About a centre in the plane, counterclockwise.
  void add_arc(const std::string& start, const std::string& end, double angle, int elements) {
    Member& member = add_member(start, end, elements);
    member.curve.shape = CurveShape::circular_arc;
    member.curve.axis = kNormal;
    member.curve.angle = angle;
    const Vector3 outwards = place_of(start);
    member.second_axis = times(-1.0, outwards);
  }

  Support& add_support(const std::string& point, const std::array<bool, 3>& displacement,
                       const std::array<bool, 3>& rotation) {
    scene().supports.push_back(support_of(point, displacement, rotation));
    return scene().supports.back();
  }
  Support& clamp(const std::string& point) { return add_support(point, {true, true, true}, {true, true, true}); }
  Support& hinge(const std::string& point) { return add_support(point, {true, true, true}, {true, true, false}); }
  /// Keeps a point in the plane, unless the structure may leave it.
  void hold_in_plane(const std::string& point) {
    if (!in_space_) add_support(point, {false, false, true}, {true, true, false});
  }

  void push(const std::string& point, const Vector3& force, const Vector3& moment = {}) {
    PointLoad load;
    load.point = point;
    load.force = force;
    load.moment = moment;
    scene().point_loads.push_back(load);
  }
  /// The imperfection of the load: a force across, out of the plane too where nothing holds there.
  void disturb(const std::string& point, double load, const Vector3& across) {
    Vector3 force = times(made_.imperfection * load, across);
    if (in_space_) force[2] += made_.imperfection * load * random_.between(0.3, 1.0);
    push(point, force);
  }
  DistributedLoad& load_line(const std::string& member, const Vector3& force) {
    scene().distributed_loads.emplace_back();
    scene().distributed_loads.back().member = member;
    scene().distributed_loads.back().force = force;
    return scene().distributed_loads.back();
  }
  void heat(const std::string& member, double strain, double curvature) {
    Eigenstrain heating;
    heating.member = member;
    heating.strain = {strain, 0, 0};
    heating.curvature = {0, 0, curvature};
    scene().eigenstrains.push_back(heating);
  }

  /// Cantilever, hinged or clamped; under a force, an end that is moved, or heat between held ends.
  void make_column() {
    const int ends = random_.below(3);  // free, hinged, clamped
    const int kind = ends == 0 ? 0 : random_.below(3);
    const int imperfect = random_.below(3);  // force, bow, moment or curvature by heat
    const double critical = std::array{0.25, 1.0, 4.0}[static_cast<size_t>(ends)] * kPi * kPi * unit_force();
    const double load = made_.estimate * critical;
    add_point("a", {0, 0, 0});
    add_point("b", {1, 0, 0});
    Member& rod = add_member("a", "b", 8);
    rod.inner_points = {{"m", 0.5}};
    const std::string loaded = ends == 0 ? "b" : "m";
    ends == 1 ? hinge("a") : clamp("a");
    if (ends > 0) {
      Support& end = ends == 1 ? hinge("b") : clamp("b");
      end.displacement_fixed[0] = kind > 0;
      if (kind == 1) end.prescribed_displacement = {-load / axial_ * length_, 0, 0};
    }
    hold_in_plane(loaded);
    if (imperfect == 1 && ends > 0) {
      rod.curve.shape = CurveShape::spline;
      rod.curve.through = {times(length_, {0.5, made_.imperfection, 0})};
    }
    if (kind == 0) push("b", {-load, 0, 0});
    if (kind == 2) heat(rod.name, load / axial_, imperfect == 2 ? made_.imperfection / length_ : 0.0);
    if (kind < 2 && imperfect == 2) push(ends == 2 ? "m" : "b", {}, {0, 0, made_.imperfection * load * length_});
    if (imperfect == 0 || in_space_ || (imperfect == 1 && ends == 0)) disturb(loaded, load, {0, 1, 0});
    made_.load = std::array{"force", "motion", "heat"}[static_cast<size_t>(kind)];
  }

  /// Portal: two columns and a beam, loaded at its corners or along the beam; sways.
  void make_frame() {
    const bool clamped = random_.chance(0.5);
    const int kind = random_.below(3);  // forces at the corners, line load, and moments beside the forces
    const double height = random_.between(0.7, 1.3), span = random_.between(0.7, 1.5);
    const double share = in_space_ ? 0.25 : clamped ? 0.75 : 0.18;
    const double load = made_.estimate * share * kPi * kPi * unit_force() / (height * height);
    add_point("a", {0, 0, 0});
    add_point("b", {0, height, 0});
    add_point("c", {span, height, 0});
    add_point("d", {span, 0, 0});
    add_member("a", "b", 5);
    add_member("b", "c", 5);
    add_member("c", "d", 5);
    for (const char* foot : {"a", "d"}) clamped ? clamp(foot) : hinge(foot);
    for (const char* corner : {"b", "c"}) {
      hold_in_plane(corner);
      if (kind != 1) push(corner, {0, -load, 0}, kind == 2 ? Vector3{0, 0, 0.02 * load * length_} : Vector3{});
    }
    if (kind == 1) load_line("b to c", {0, -2.0 * load / (span * length_), 0});
    disturb("b", load, {1, 0, 0});
    made_.load = std::array{"force", "line load", "moment"}[static_cast<size_t>(kind)];
  }

  /// Roorda's frame: column and beam on hinges, loaded above the column; an unsymmetric bifurcation, which an
  /// imperfection turns into a limit point or into a stable path.
  void make_knee() {
    const double beam = random_.between(0.6, 1.5);
    const bool moved = random_.chance(0.3);
    const double load = made_.estimate * 1.4 * kPi * kPi * unit_force();
    add_point("a", {0, 0, 0});
    add_point("b", {0, 1, 0});
    add_point("c", {beam, 1, 0});
    add_member("a", "b", 6);
    add_member("b", "c", 5);
    hinge("a");
    hinge("c");
    hold_in_plane("b");
    if (moved)
      scene().supports[0].prescribed_displacement = {0, 0.05 * made_.estimate * length_, 0};
    else
      push("b", {0, -load, 0}, {0, 0, made_.imperfection * load * length_});
    if (moved || in_space_) disturb("b", load, {1, 0, 0});
    made_.load = moved ? "motion" : "force";
  }

  /// Shallow to half a circle and more.
  void make_arch() {
    const bool clamped = random_.chance(0.5);
    const int kind = random_.below(4);  // force at the crown, line load, heat, feet that approach
    const double half = random_.between(0.3, 1.6);
    const double thrust =
        unit_force() * ((clamped ? 20.2 : kPi * kPi) / (half * half) - 1.0);  // antisymmetric buckling
    const double load = made_.estimate * thrust * half;
    add_point("a", {std::sin(half), std::cos(half), 0});
    add_point("t", {0, 1, 0});
    add_point("b", {-std::sin(half), std::cos(half), 0});
    add_arc("a", "t", half, 6);
    add_arc("t", "b", half, 6);
    for (const char* foot : {"a", "b"}) clamped ? clamp(foot) : hinge(foot);
    hold_in_plane("t");
    if (kind == 0) push("t", {0, -load, 0});
    for (const Member& part : scene().members) {
      if (kind == 1) load_line(part.name, {0, -load / (half * length_), 0});
      if (kind == 2) heat(part.name, 0.01 * made_.estimate, 0.0);
    }
    if (kind == 3)
      scene().supports[0].prescribed_displacement = {-0.1 * made_.estimate * std::sin(half) * length_, 0, 0};
    disturb("t", load, {1, 0, 0});
    made_.load = std::array{"force", "line load", "heat", "motion"}[static_cast<size_t>(kind)];
  }

  /// Under dead radial pressure, pinched, or with one side turned about the diameter.
  void make_ring() {
    const int kind = random_.below(3);
    const double pressure = made_.estimate * 4.0 * unit_force() / length_;
    for (int i = 0; i < 4; ++i)
      add_point("p" + std::to_string(i), {std::array{1.0, 0.0, -1.0, 0.0}[static_cast<size_t>(i)],
                                          std::array{0.0, 1.0, 0.0, -1.0}[static_cast<size_t>(i)], 0});
    for (int i = 0; i < 4; ++i) add_arc("p" + std::to_string(i), "p" + std::to_string((i + 1) % 4), 0.5 * kPi, 5);
    if (kind == 2) {
      clamp("p0");
      Support& turned = add_support("p2", {false, true, true}, {true, true, true});
      turned.prescribed_rotation = {random_.between(0.2, 1.0) * made_.estimate, 0, 0};
    } else {
      hinge("p0");
      add_support("p2", {false, true, true}, {true, true, false});
      for (const char* point : {"p1", "p3"}) hold_in_plane(point);
    }
    if (kind == 0)
      for (int i = 0; i < 4; ++i) {
        const std::string angle = "(" + shortest(0.5 * kPi * i) + "+s/" + shortest(length_) + ")";
        load_line(scene().members[static_cast<size_t>(i)].name, {}).force_formula = {
            "-" + shortest(pressure) + "*cos" + angle, "-" + shortest(pressure) + "*sin" + angle, "0"};
      }
    const double pinch = 2.0 * pressure * length_;
    if (kind == 1) push("p1", {0, -pinch, 0});
    if (kind == 1) push("p3", {0, pinch, 0});
    disturb("p1", pinch, {0.2, -1, 0});
    made_.load = std::array{"line load", "force", "motion"}[static_cast<size_t>(kind)];
  }

  /// Square cells; the upper side is loaded or moved downwards.
  void make_lattice() {
    const int cells = 2, elements = 4;
    const bool moved = random_.chance(0.5);
    const double load = made_.estimate * (in_space_ ? 0.25 / (cells * cells) : 0.5) * kPi * kPi * unit_force();
    const auto name = [](int i, int j) { return "p" + std::to_string(i) + std::to_string(j); };
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) add_point(name(i, j), {static_cast<double>(i), static_cast<double>(j), 0});
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        if (i < cells && j > 0 && !(moved && j == cells)) add_member(name(i, j), name(i + 1, j), elements);
        if (j < cells) add_member(name(i, j), name(i, j + 1), elements);
      }
    for (int i = 0; i <= cells; ++i) {
      clamp(name(i, 0));
      for (int j = 1; j < cells; ++j) hold_in_plane(name(i, j));
      if (moved) {
        const double motion = cells * length_ * load / axial_;
        clamp(name(i, cells)).prescribed_displacement = {0, -motion, 0};
      } else {
        hold_in_plane(name(i, cells));
        push(name(i, cells), {0, -load, 0});
      }
    }
    disturb(name(0, 1), load, {1, 0, 0});
    made_.load = moved ? "motion" : "force";
  }

  /// Legs that meet at an apex, loaded there beside the axis, pushed down by a motion, or heated.
  void make_dome() {
    const int legs = 3 + random_.below(4), kind = random_.below(3);
    const bool clamped = random_.chance(0.6);
    const double rise = random_.between(0.1, 0.8), leg = std::hypot(1.0, rise);
    in_space_ = true;
    add_point("apex", {0, 0, rise});
    for (int i = 0; i < legs; ++i) {
      const double angle = 2.0 * kPi * i / legs;
      const std::string foot = "foot " + std::to_string(i);
      add_point(foot, {std::cos(angle), std::sin(angle), 0});
      add_member(foot, "apex", 5);
      add_support(foot, {true, true, true}, {clamped, clamped, clamped});
    }
    // snap of a truss, Euler's load of the legs
    const double snap = axial_ * std::pow(1.0 - std::pow(1.0 / leg, 2.0 / 3.0), 1.5);
    const double buckling = (clamped ? 2.0 : 1.0) * kPi * kPi * unit_force() / (leg * leg) * rise / leg;
    const double load = made_.estimate * legs * std::min(snap, buckling);
    if (kind == 0) push("apex", {0, 0, -load});
    // at which the legs reach their load, or half of the way through the plane of the feet
    const double motion = std::min(0.5 * rise * length_, buckling / axial_ * leg * length_ * std::pow(leg / rise, 2));
    if (kind == 1)
      add_support("apex", {false, false, true}, {false, false, false}).prescribed_displacement = {
          0, 0, -made_.estimate * motion};
    if (kind == 2)
      for (const Member& member : scene().members) heat(member.name, 0.01 * made_.estimate, 0.0);
    push("apex", times(made_.imperfection * load, {1.0, 0.3, 0.0}));
    made_.load = std::array{"force", "motion", "heat"}[static_cast<size_t>(kind)];
  }

  /// A tall cantilever under a force or a moment in its strong direction buckles sideways.
  void make_strip() {
    const bool moment = random_.chance(0.4);
    const double strong = random_.decades(1.3, 2.5);
    in_space_ = true;
    scene().sections[0].bending_stiffness = {bending_, strong * bending_};
    const double mean = std::sqrt(0.8) * unit_force();  // sqrt(EI GIt) / L^2
    add_point("a", {0, 0, 0});
    add_point("b", {1, 0, 0});
    add_member("a", "b", 10);
    clamp("a");
    const double load = made_.estimate * mean * (moment ? 0.5 * kPi : 4.0126);
    if (moment)
      push("b", {}, {0, 0, load * length_});
    else
      push("b", {0, -load, 0});
    push("b", {0, 0, made_.imperfection * load});
    made_.load = moment ? "moment" : "force";
  }

  RandomNumbers random_;
  size_t family_;
  ImperfectStructure made_{};
  double length_ = 1.0, bending_ = 1.0;  ///< units
  double axial_ = 1.0;
  bool in_space_ = false;
};

}  // namespace

ImperfectStructure imperfect_structure(std::uint64_t seed, int number) { return ImperfectMaker(seed, number).make(); }

}  // namespace mixbeam
