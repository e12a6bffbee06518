/// Random structures as XML scenes: trees and loops of lines, arcs and splines with kinks, joints, supports, loads and
/// eigenstrains of every kind, in random units; never two draws in one expression whose order the
/// language leaves open.
#pragma once

#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"
#include "tests/support/random_numbers.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace mixbeam::test {

struct RandomScene {
  std::string name{};
  std::string text{};   ///< in YAML
  bool strong = false;  ///< loads that turn members by angles of order one, and more
};

/// Scene number `number` of the series that `seed` begins. Not every one can be read: joints may make a mechanism;
/// `with_joints` false: the same scene with rigid connections.
class RandomSceneMaker {
 public:
  RandomSceneMaker(std::uint64_t seed, int number, bool with_joints)
      : random_(seed + 1000003ULL * static_cast<std::uint64_t>(number)), number_(number), with_joints_(with_joints) {}

  RandomScene make() {
    choose_units();
    make_sections();
    make_tree();
    close_loops();
    make_supports();
    make_joints();
    make_loads();
    RandomScene scene;
    scene.name = "random " + std::to_string(number_);
    scene.strong = strong_;
    scene.text = "Name: " + scene.name + "\nScene: {Sections: {" + sections_ + "}, Points: {" + points_ +
                 "}, Members: {" + members_ + "}, Supports: {" + supports_ + "}, " + optional_list("Joints", joints_) +
                 optional_list("Point Loads", point_loads_) + optional_list("Distributed Loads", line_loads_) +
                 optional_list("Eigenstrains", eigenstrains_) + "}\n";
    return scene;
  }

 private:
  struct Node {
    Vector3 position{};
    std::vector<int> members{};
  };
  struct Bar {
    int start = 0, end = 0;
  };

  static std::string optional_list(const std::string& name, const std::string& inside) {
    return inside.empty() ? "" : name + ": {" + inside + "}, ";
  }
  static std::string number(const std::string& name, double value) { return name + ": " + shortest(value) + ", "; }
  static std::string integer(const std::string& name, int value) { return name + ": " + std::to_string(value) + ", "; }
  static std::string text_of(const Vector3& v) {
    return shortest(v[0]) + ", " + shortest(v[1]) + ", " + shortest(v[2]);
  }
  static std::string vector(const std::string& name, const Vector3& v) { return name + ": [" + text_of(v) + "], "; }
  static std::string point(int node) { return "P" + std::to_string(node); }
  static std::string member(int bar) { return "M" + std::to_string(bar); }

  void choose_units() {
    length_ = random_.decades(-3, 3);
    force_ = random_.decades(-4, 4);
    strong_ = random_.chance(0.65);
  }

  /// Bending stiffness 1 in the middle of the scene, in units of force and length; slenderness 5 .. 1e4.
  void make_sections() {
    const int count = 1 + random_.below(3);
    const double spread = random_.chance(0.3) ? 3.0 : 1.0;
    for (int i = 0; i < count; ++i) {
      const double bending = random_.decades(-spread, spread) * force_ * length_ * length_;
      const double slenderness = random_.decades(0.7, 4.0);
      const double axial = 12.0 * bending * slenderness * slenderness / (length_ * length_);
      std::string text;
      if (random_.chance(0.2))
        text += "Inextensible: true, ";
      else
        text += number("EA", axial);
      if (random_.chance(0.25))
        text += "Shear Rigid: true, ";
      else
        for (const char* name : {"GA2", "GA3"}) text += number(name, axial * random_.between(0.2, 0.5));
      text += number("GIt", bending * random_.between(0.1, 2.0)) + number("EI2", bending);
      text += number("EI3", bending * random_.decades(0.0, 1.0));
      sections_ += "S" + std::to_string(i) + ": {" + text + "}, ";
      softest_ = i == 0 ? bending : std::min(softest_, bending);
    }
    section_count_ = count;
  }

  /// Section, order and elements: coarse for high orders.
  std::string rest_of_member() {
    const int order = 1 + random_.below(4);
    const int elements[] = {16, 8, 5, 4};
    const int count = elements[order - 1] + random_.below(3);
    const int section = random_.below(section_count_);
    return "Section: S" + std::to_string(section) + ", " + integer("Order", order) + integer("Elements", count);
  }

  void add_member(int start, int end, const std::string& curve) {
    const int bar = static_cast<int>(bars_.size());
    bars_.push_back({start, end});
    nodes_[start].members.push_back(bar);
    nodes_[end].members.push_back(bar);
    members_ +=
        member(bar) + ": {Start: " + point(start) + ", End: " + point(end) + ", " + rest_of_member() + curve + "}, ";
  }

  int add_node(const Vector3& position) {
    nodes_.push_back({position});
    const int node = static_cast<int>(nodes_.size()) - 1;
    points_ += vector(point(node), position);
    return node;
  }

  void make_tree() {
    using namespace vector_algebra;
    add_node(scaled(length_, random_.direction()));
    const int count = 1 + random_.below(6);
    for (int i = 0; i < count; ++i) {
      const int from =
          random_.chance(0.5) ? static_cast<int>(nodes_.size()) - 1 : random_.below(static_cast<int>(nodes_.size()));
      const double kind = random_.between(0.0, 1.0);
      const double size = length_ * random_.between(0.5, 2.0);
      const Vector3 start = nodes_[from].position, along = random_.direction();
      if (kind < 0.3)
        add_arc(from, start, along, size);
      else
        add_member(from, add_node(sum(start, scaled(size, along))),
                   kind < 0.5 ? spline(start, sum(start, scaled(size, along))) : "");
    }
  }

  void add_arc(int from, const Vector3& start, const Vector3& along, double size) {
    using namespace vector_algebra;
    Vector3 axis = cross(along, random_.direction());
    while (norm(axis) < 0.3) axis = cross(along, random_.direction());
    axis = scaled(1.0 / norm(axis), axis);
    const Vector3 inward = cross(axis, along);
    const double angle = random_.between(0.3, 3.0), radius = size / angle;
    const Vector3 center = sum(start, scaled(radius, inward));
    const Vector3 end =
        sum(center, sum(scaled(-radius * std::cos(angle), inward), scaled(radius * std::sin(angle), along)));
    add_member(from, add_node(end),
               "Curve: {Shape: arc, " + vector("Center", center) + vector("Axis", axis) + number("Angle", angle) + "}");
  }

  /// Through one or two points beside the straight line.
  std::string spline(const Vector3& start, const Vector3& end) {
    using namespace vector_algebra;
    const int count = 1 + random_.below(2);
    const Vector3 chord = difference(end, start);
    std::string through;
    for (int i = 1; i <= count; ++i) {
      const double part = static_cast<double>(i) / (count + 1);
      const Vector3 beside = random_.vector(0.0, 0.25 * norm(chord));
      through += (i == 1 ? "" : ", ") + text_of(sum(start, sum(scaled(part, chord), beside)));
    }
    return "Curve: {Shape: spline, Through: [" + through + "]}, ";
  }

  bool are_neighbours(int a, int b) const {
    for (const Bar& bar : bars_)
      if ((bar.start == a && bar.end == b) || (bar.start == b && bar.end == a)) return true;
    return false;
  }

  void close_loops() {
    if (nodes_.size() < 3 || !random_.chance(0.45)) return;
    const int wanted = 1 + random_.below(2);
    for (int i = 0; i < wanted; ++i) {
      const int a = random_.below(static_cast<int>(nodes_.size())), b = random_.below(static_cast<int>(nodes_.size()));
      const double distance = vector_algebra::norm(vector_algebra::difference(nodes_[a].position, nodes_[b].position));
      if (a == b || are_neighbours(a, b) || distance < 0.2 * length_) continue;
      add_member(a, b, random_.chance(0.4) ? spline(nodes_[a].position, nodes_[b].position) : "");
    }
  }

  std::string random_axes() {
    if (random_.chance(0.6)) return "";
    Vector3 x = random_.direction(), y = random_.direction();
    while (vector_algebra::norm(vector_algebra::cross(x, y)) < 0.3) y = random_.direction();
    return "Axes: [" + text_of(x) + ", " + text_of(y) + "], ";
  }

  std::string some_axes() {
    std::string text;
    for (const char* axis : {"x", "y", "z"})
      if (random_.chance(0.5)) text += (text.empty() ? "" : ", ") + std::string(axis);
    if (text.empty()) text = "y";
    return "Fixed Displacement: [" + text + "], ";
  }

  void add_support(const std::string& inside, int node) {
    supports_ += "support " + std::to_string(held_.size()) + ": {Point: " + point(node) + ", " + inside + "}, ";
    held_.push_back(node);
  }

  /// Point 0 clamped, always sufficient; then what else may be held or moved.
  void make_supports() {
    if (random_.chance(0.15))
      add_support(vector("Prescribed Rotation", random_.vector(0.2, 2.0)), 0);
    else
      add_support("", 0);
    const int last = static_cast<int>(nodes_.size()) - 1;
    if (random_.chance(0.45)) add_further_support(last);
    if (last > 2 && random_.chance(0.2)) add_further_support(last - 1);
  }

  void add_further_support(int node) {
    const double kind = random_.between(0.0, 1.0);
    const std::string free_rotation = "Fixed Rotation: [], ";
    if (kind < 0.25) {
      add_support(free_rotation, node);
    } else if (kind < 0.4) {
      const std::string held = some_axes() + free_rotation;
      add_support(held + random_axes(), node);
    } else if (kind < 0.5)
      add_support("Fixed Rotation: [x, y], " + random_axes(), node);
    else if (kind < 0.75)
      add_support(free_rotation + vector("Prescribed Displacement", random_.vector(0.02 * length_, 0.5 * length_)),
                  node);
    else if (kind < 0.85)
      add_support(vector("Prescribed Rotation", random_.vector(0.2, 4.0)), node);
    else
      add_support(
          "Fixed Displacement: [], " + free_rotation + vector("Displacement Stiffness", {spring(), spring(), spring()}),
          node);
  }

  double spring() { return random_.decades(-2, 2) * softest_ / (length_ * length_ * length_); }

  void make_joints() {
    const bool wanted = random_.chance(0.35);
    const double kind = random_.between(0.0, 1.0), stiffness = random_.decades(-2, 1) * softest_ / length_;
    const Vector3 axis = random_.direction();
    std::vector<int> places;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (nodes_[i].members.size() > 1) places.push_back(static_cast<int>(i));
    const int chosen = random_.below(1 + static_cast<int>(places.size()));
    if (!wanted || !with_joints_ || chosen == static_cast<int>(places.size())) return;
    const Node& node = nodes_[places[chosen]];
    const int bar = node.members[random_.below(static_cast<int>(node.members.size()))];
    joint_node_ = places[chosen];
    joined_bar_ = bar;
    std::string text = "Point: " + point(joint_node_) + ", Members: [" + member(bar) + "], ";
    if (kind < 0.4)
      text += "Kind: ball, ";
    else if (kind < 0.9)
      text += "Kind: hinge, " + vector("Axis", axis) + (kind < 0.65 ? number("Stiffness", stiffness) : "");
    else
      text += "Kind: slider, " + vector("Axis", axis) + number("Stiffness", stiffness / (length_ * length_));
    joints_ = "joint: {" + text + "}, ";
  }

  /// Force of the size F L^2/EI = 3 .. 30 for the softest section, or below.
  double load_size() {
    return (strong_ ? random_.decades(0.5, 1.5) : random_.decades(-3, 0.5)) * softest_ / (length_ * length_);
  }

  void make_loads() {
    const int count = 1 + random_.below(3);
    for (int i = 0; i < count; ++i) add_point_load(i);
    if (random_.chance(0.35)) add_line_load();
    if (random_.chance(0.2)) add_eigenstrain();
  }

  /// One that is rigidly connected with the point; -1: there is none.
  int followed_member(int node) const {
    for (int bar : nodes_[node].members)
      if (node != joint_node_ || bar != joined_bar_) return bar;
    return -1;
  }

  void add_point_load(int i) {
    const int node = 1 + random_.below(static_cast<int>(nodes_.size()) - 1);
    const double size = load_size();
    const double kind = random_.between(0.0, 1.0);
    std::string text = "Point: " + point(node) + ", ";
    if (kind < 0.75) text += vector("Force", vector_algebra::scaled(size, random_.direction()));
    if (kind > 0.6) text += vector("Moment", vector_algebra::scaled(0.2 * size * length_, random_.direction()));
    const int followed = followed_member(node);
    if (random_.chance(0.3) && followed >= 0) text += "Frame: follower, Member: " + member(followed) + ", ";
    if (i == 1 && random_.chance(0.3)) text += integer("Stage", 2);
    point_loads_ += "load " + std::to_string(i) + ": {" + text + "}, ";
  }

  void add_line_load() {
    const int bar = random_.below(static_cast<int>(bars_.size()));
    const double size = load_size() / length_;
    std::string text =
        "Member: " + member(bar) + ", " + vector("Force", vector_algebra::scaled(size, random_.direction()));
    if (random_.chance(0.3))
      text += vector("Couple", vector_algebra::scaled(0.1 * size * length_, random_.direction()));
    if (random_.chance(0.4)) text += "Frame: follower, ";
    line_loads_ = "line load: {" + text + "}, ";
  }

  void add_eigenstrain() {
    const int bar = random_.below(static_cast<int>(bars_.size()));
    std::string text = "Member: " + member(bar) + ", ";
    text += vector("Curvature", random_.vector(0.1 / length_, 2.0 / length_));
    if (random_.chance(0.5)) text += vector("Strain", {random_.between(-0.01, 0.01), 0.0, 0.0});
    eigenstrains_ = "growth: {" + text + "}, ";
  }

  RandomNumbers random_;
  int number_ = 0;
  bool with_joints_ = true, strong_ = false;
  double length_ = 1.0, force_ = 1.0;  ///< units
  double softest_ = 1.0;               ///< bending stiffness
  int section_count_ = 1;
  int joint_node_ = -1, joined_bar_ = -1;
  std::vector<Node> nodes_{};
  std::vector<Bar> bars_{};
  std::vector<int> held_{};
  std::string sections_{}, points_{}, members_{}, supports_{}, joints_{}, point_loads_{}, line_loads_{},
      eigenstrains_{};
};

}  // namespace mixbeam::test
