// Effective moduli of lattices, from cells that are cut at their mirror planes, against closed forms of the linear
// theory of struts that stretch, bend and shear between joints that do not turn: hexagons (Gibson and Ashby, Cellular
// Solids, ch. 4, with their axial and shear terms), squares, triangles and octets (energy of an affine motion).
#include "tests/support/scenes.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace lattice_moduli_test {

constexpr double kAxial = 400.0, kShear = 140.0, kTorsion = 0.8, kBending = 1.0;  ///< of a strut of length 1
/// Strain of the cells, of both signs: what remains of a central difference is its square times numbers of order 100.
constexpr double kStrain = 1e-6;
/// Rounding of forces of 1e-4, 1e-14 of the stiffness times lengths of 1, over them: 1e-10; closed forms are exact.
constexpr double kAgreement = 1e-8;

/// Forces at the ends of a strut for unit elongation, and for unit offset without rotation.
constexpr double kStretching = kAxial, kOffset = 1.0 / (1.0 / (12.0 * kBending) + 1.0 / kShear);

class Cell {
 public:
  Cell() {
    scene_.name = "cell";
    scene_.sections = {section(kAxial, kShear, kTorsion, kBending),
                       section(0.5 * kAxial, 0.5 * kShear, 0.5 * kTorsion, 0.5 * kBending)};
    scene_.sections[1].name = "half";
  }
  /// In the plane z = 0 unless `fixed` says otherwise; joints do not turn. `motion` for unit strain.
  void add(const std::string& name, const Vector3& position, const std::array<bool, 3>& fixed, const Vector3& motion,
           const std::array<bool, 3>& rotation_fixed = kHeld) {
    scene_.points.push_back({name, position});
    Support support = clamp(name);
    support.displacement_fixed = fixed;
    support.rotation_fixed = rotation_fixed;
    scene_.supports.push_back(support);
    motions_.push_back(motion);
  }
  /// `section`: "half" for struts in a mirror plane, which the next cell shares.
  void join(const std::string& start, const std::string& end, const std::string& section) {
    scene_.members.push_back(line(start + end, start, end, 3, 1));
    scene_.members.back().section = section;
  }
  /// Sum of reactions at these points for unit strain.
  double force(const std::vector<std::string>& points, int component) const {
    return (sum(points, component, kStrain) - sum(points, component, -kStrain)) / (2.0 * kStrain);
  }

 private:
  double sum(const std::vector<std::string>& points, int component, double strain) const {
    Scene scene = scene_;
    for (size_t s = 0; s < motions_.size(); ++s)
      for (int c = 0; c < 3; ++c) scene.supports[s].prescribed_displacement[c] = strain * motions_[s][c];
    const Simulation run = solved(scene);
    double sum = 0.0;
    for (const Reaction& reaction : run.reactions())
      if (std::find(points.begin(), points.end(), reaction.point) != points.end()) sum += reaction.force[component];
    return sum;
  }
  Scene scene_;
  std::vector<Vector3> motions_;
};

void expect_modulus(double measured, double closed_form) {
  EXPECT_NEAR(measured, closed_form, kAgreement * closed_form);
  EXPECT_GT(std::abs(measured - (1.0 + 2.0 * kAgreement) * closed_form), kAgreement * closed_form) << "it compares";
}

constexpr std::array<bool, 3> kAlongX = {false, true, true}, kAlongY = {true, false, true},
                              kFree = {false, false, true};

TEST(LatticeModuli, Hexagons) {
  const double width = std::sqrt(0.75), height = 1.5;
  const double closed_form = 4.0 / std::sqrt(3.0) / (1.0 / kOffset + 3.0 / kStretching);
  for (const bool across : {true, false}) {
    Cell cell;
    cell.add("low", {0, -0.5, 0}, kHeld, {});
    cell.add("a", {0, 0, 0}, kAlongY, {});
    cell.add("b", {width, 0.5, 0}, across ? kAlongY : kFree, {width, 0, 0});
    cell.add("high", {width, 1.0, 0}, across ? kAlongY : kAlongX,
             across ? Vector3{width, 0, 0} : Vector3{0, height, 0});
    cell.join("low", "a", "half");
    cell.join("a", "b", "section");
    cell.join("b", "high", "half");
    expect_modulus(across ? cell.force({"b", "high"}, 0) / height : cell.force({"high"}, 1) / width, closed_form);
  }
}

TEST(LatticeModuli, SquaresInShear) {
  Cell cell;
  constexpr std::array<bool, 3> turns = {true, true, false};
  cell.add("middle", {}, kFree, {}, turns);
  cell.add("right", {0.5, 0, 0}, kHeld, {0, 0.25, 0}, turns);
  cell.add("left", {-0.5, 0, 0}, kHeld, {0, -0.25, 0}, turns);
  cell.add("top", {0, 0.5, 0}, kHeld, {0.25, 0, 0}, turns);
  cell.add("bottom", {0, -0.5, 0}, kHeld, {-0.25, 0, 0}, turns);
  for (const char* end : {"right", "left", "top", "bottom"}) cell.join("middle", end, "section");
  expect_modulus(cell.force({"right"}, 1), 0.5 * kOffset);
}

TEST(LatticeModuli, Triangles) {
  const double height = std::sqrt(0.75), quarter = 0.25 * std::sqrt(3.0);
  const double lambda = quarter * (kStretching - kOffset), mu = quarter * (kStretching + kOffset);
  Cell cell;
  cell.add("o", {}, kHeld, {});
  cell.add("p", {0.5, 0, 0}, kHeld, {0.5, 0, 0});
  cell.add("c", {0.5, height, 0}, kAlongY, {0.5, 0, 0});
  cell.add("q", {0, height, 0}, kAlongY, {});
  cell.join("o", "p", "half");
  cell.join("o", "c", "section");
  cell.join("q", "c", "half");
  expect_modulus(cell.force({"p", "c"}, 0) / height, 4.0 * mu * (lambda + mu) / (lambda + 2.0 * mu));
}

TEST(LatticeModuli, Octets) {
  const double side = std::sqrt(0.5);
  Cell cell;
  cell.add("o", {}, kHeld, {});
  cell.add("xy", {side, side, 0}, kHeld, {side, 0, 0});
  cell.add("xz", {side, 0, side}, kHeld, {side, 0, 0});
  cell.add("yz", {0, side, side}, kHeld, {});
  for (const auto& [start, end] :
       {std::pair{"o", "xy"}, {"o", "xz"}, {"o", "yz"}, {"xy", "xz"}, {"xy", "yz"}, {"xz", "yz"}})
    cell.join(start, end, "half");
  expect_modulus(cell.force({"xy", "xz"}, 0) / (side * side), std::sqrt(2.0) * (kStretching + kOffset));
  expect_modulus(cell.force({"xy", "yz"}, 1) / (side * side), std::sqrt(0.5) * (kStretching - kOffset));
}

}  // namespace lattice_moduli_test
}  // namespace mixbeam::test
