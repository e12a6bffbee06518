#include "apps/extremes/sweeps.hpp"

#include "apps/common/studies/variants.hpp"

#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRadiansPerTurn = 2.0 * M_PI;

/// Scenes that need some load: F L^2 / EI, a tip that turns by 1.43 radians.
constexpr double kLoad = 10.0;

const std::string kElastica = "elastica, elliptic integrals; plus s F / C where EA = GA = C is finite";
const std::string kCircle = "circle of curvature M / EI";
const std::string kHelix = "helix about the moment: constant spatial moment, EI2 = EI3";
const std::string kGaussRule = "k-point Gauss rule of the exact tangent of the circle, exact rotations";

/// 10^from, 10^(from + step) .. 10^to
std::vector<double> decades(int from, int to, int step = 1) {
  std::vector<double> values;
  for (int i = from; i <= to; i += step) values.push_back(std::pow(10.0, i));
  return values;
}

std::vector<double> joined(std::vector<double> first, const std::vector<double>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

/// Section of a square of side L / slenderness, EA = 12 slenderness^2 EI / L^2; GA = EA keeps the closed form.
Cantilever with_slenderness(const Cantilever& rod, double slenderness) {
  return rod.with_force_stiffness(12.0 * std::pow(slenderness / rod.length(), 2) * rod.bending_stiffness());
}

Sweep slenderness() {
  return {"slenderness",
          "slenderness L/a of a square section, EA = GA = 12 (L/a)^2 EI / L^2; inf: inextensible and shear rigid",
          "Dead tip force F L^2 / EI = 10.",
          kElastica,
          joined(decades(0, 10), {kInfinity}),
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            return Trial{with_slenderness(rod, value).with_tip_force(kLoad), solver};
          },
          1e-9,
          1.0,
          kInfinity,
          "The force is an unknown of its own and the compliance goes to zero without any other change, so there is "
          "nothing to lose on the way to the rigid beam."};
}

Sweep stiffness_ratio() {
  return {"stiffness_ratio",
          "ratio EI / GIt",
          "Dead tip moment that bends by 1 rad about y and twists, by 1 rad where GIt is the smaller stiffness.",
          kHelix,
          decades(-6, 6),
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            const Cantilever changed = rod.with_torsional_stiffness(rod.bending_stiffness() / value);
            return Trial{changed.with_tip_moment({{0.0, 1.0, 0.0}}, std::min(1.0, value)), solver};
          },
          1e-5,
          1e-6,
          1e6,
          "Residuals of moments are measured against the largest moment: the soft rotation is only as exact as the "
          "tolerance of 1e-11 times the ratio."};
}

Sweep unit_of_length() {
  return {
      "unit_of_length",
      "numerical value of the length L, forces unchanged",
      "Slenderness 100, dead tip force F L^2 / EI = 10.",
      kElastica,
      decades(-9, 9, 3),
      [](const Cantilever& rod, const SolverParameters& solver, double value) {
        return Trial{with_slenderness(rod.in_units(value / rod.length(), 1.0), 100.0).with_tip_force(kLoad), solver};
      },
      1e-9,
      1e-9,
      1e9,
      "Residuals and tolerances have no dimension."};
}

Sweep unit_of_force() {
  return {"unit_of_force",
          "factor on all stiffnesses and loads",
          "Slenderness 100, dead tip force F L^2 / EI = 10.",
          kElastica,
          decades(-9, 9, 3),
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            return Trial{with_slenderness(rod.in_units(1.0, value), 100.0).with_tip_force(kLoad), solver};
          },
          1e-9,
          1e-9,
          1e9,
          "Residuals and tolerances have no dimension."};
}

Sweep elements(int most) {
  std::vector<double> values = {1, 2, 5};
  for (double n = 10.0; n <= most; n *= 10.0) values.push_back(n);
  return {"elements",
          "number of elements of order 2",
          "Inextensible and shear rigid, dead tip force F L^2 / EI = 1.",
          kElastica,
          values,
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            return Trial{rod.with_mesh(2, static_cast<int>(value)).with_tip_force(1.0), solver};
          },
          1e-6,
          10.0,
          1e5,
          "The error of order 2 falls with the fourth power of the number of elements down to rounding; from there it "
          "grows: the condition number grows with the square of the number of elements, and strains are "
          "differences of displacements over ever shorter elements."};
}

Sweep length_ratio() {
  return {
      "length_ratio",
      "longest to shortest element of one member, 24 elements growing by one factor from the clamp to the tip",
      "Inextensible and shear rigid, dead tip force F L^2 / EI = 10.",
      kElastica,
      decades(0, 8),
      [](const Cantilever& rod, const SolverParameters& solver, double value) {
        return Trial{rod.with_graded_mesh(24, value).with_tip_force(kLoad), solver};
      },
      1e-8,
      1.0,
      1e8,
      "Strains are differences of displacements over the length of an element: over the shortest ones they are lost "
      "in the rounding of the largest displacements, which residuals of compatibility allow for."};
}

Sweep turns() {
  return {"turns",
          "turns of one rod, 8 elements for each turn, at least 8",
          "Inextensible and shear rigid, dead tip moment.",
          kCircle,
          {0.01, 0.1, 0.5, 1, 2, 5, 10, 20, 50, 100},
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            const int order = rod.scene().members.front().order, count = 8 * std::max(1, static_cast<int>(value));
            return Trial{rod.with_mesh(order, count).with_bending_moment(value * kRadiansPerTurn), solver};
          },
          1e-9,
          0.01,
          100.0,
          "The rotation of the tip is M L / EI = 2 pi turns: a rounding error of the load turns the tip by as much, "
          "times the number of turns."};
}

Sweep load_steps() {
  return {"load_steps",
          "equal load steps of one path",
          "GIt = EI / 2, dead tip moment that bends by 2 rad about y and 1 rad about z and twists by 1 rad.",
          kHelix,
          {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000},
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            const Cantilever changed = rod.with_torsional_stiffness(0.5 * rod.bending_stiffness());
            return Trial{changed.with_tip_moment({{0.0, 2.0, 1.0}}, 1.0),
                         with_fixed_steps(solver, static_cast<int>(value))};
          },
          1e-9,
          1.0,
          1000.0,
          "The state is total, not a sum of increments: only the rounding of quaternion products adds up."};
}

/// Ever closer to `angle` from below.
std::vector<double> approaching(double angle) {
  std::vector<double> values;
  for (double gap : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) values.push_back(angle * (1.0 - gap));
  return values;
}

Trial turned_elements(const Cantilever& rod, const SolverParameters& solver, int order, double turn_of_each) {
  constexpr int kCount = 2;
  return {rod.with_mesh(order, kCount).with_bending_moment(kCount * turn_of_each).against_gauss_rule(), solver};
}

Sweep element_turn_lowest_order() {
  return {
      "element_turn_k1",
      "rotation from end to end of each of two elements of order 1, which have no relative rotation inside",
      "Inextensible and shear rigid, dead tip moment.",
      kGaussRule,
      joined(joined({0.1, 1.0, 2.0}, approaching(M_PI)), joined(joined({3.5, 4.5}, approaching(2.0 * M_PI)), {6.5})),
      [](const Cantilever& rod, const SolverParameters& solver, double value) {
        return turned_elements(rod, solver, 1, value);
      },
      1e-9,
      0.1,
      2.0 * M_PI,
      "Half of the rotation lies between the element's triad and each of its vertices: where it reaches pi, the "
      "logarithm has no derivative and the equilibrium ends."};
}

Sweep element_turn() {
  const double series = 2.0 * std::sqrt(kStumpffSeriesLimit);  // half of the turn is the largest argument
  const double next = 1e-12;
  return {"element_turn",
          "rotation from end to end of each of two elements of the scene's order",
          "Inextensible and shear rigid, dead tip moment.",
          kGaussRule,
          joined(joined({0.1, 1.0, 2.0}, approaching(M_PI)),
                 {3.5, 4.5, 6.0, series * (1.0 - next), series * (1.0 + next), 9.0, 12.0}),
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            return turned_elements(rod, solver, rod.scene().members.front().order, value);
          },
          1e-9,
          0.1,
          20.0,
          "The relative rotation inside the element is a vector without bound; only what remains between it and the "
          "vertices must stay below pi on the way."};
}

Sweep angle() {
  const double next = 1e-12;
  const double logarithm = 4.0 * std::atan(std::sqrt(kLogSeriesLimit));  // twice the angle to each vertex
  return {"angle",
          "rotation of the tip, one element of order 1; the last but two next to the end of the logarithm's series",
          "Inextensible and shear rigid, dead tip moment.",
          kGaussRule,
          {0.0, 1e-300, 1e-200, 1e-100, 1e-16, 1e-12, 1e-8, 1e-6, 1e-4, logarithm * (1 - next), logarithm * (1 + next)},
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            return Trial{rod.with_mesh(1, 1).with_bending_moment(value).against_gauss_rule(), solver};
          },
          1e-8,
          0.0,
          1.0,
          "Every coefficient is an entire function of the squared angle, so no small angle is special. Below 1e-6 the "
          "linear solution already meets the tolerance: the part of the motion that is left out is a quarter of the "
          "angle, relative to all of it."};
}

Sweep tip_force() {
  return {
      "tip_force",
      "dead tip force F L^2 / EI, 24 elements growing by 1.4 from the clamp",
      "Inextensible and shear rigid.",
      kElastica,
      decades(-12, 8, 2),
      [](const Cantilever& rod, const SolverParameters& solver, double value) {
        return Trial{rod.with_graded_mesh(24, std::pow(1.4, 23)).with_tip_force(value), solver};
      },
      1e-8,
      1e-12,
      1e8,
      "Large forces bend the rod within sqrt(EI / F) of the clamp, which the mesh has to resolve. Small ones move it "
      "by less than the rounding error of its coordinates, but displacements are unknowns of their own; where the "
      "linear solution already meets the tolerance, the nonlinear part of the motion is left out."};
}

Sweep order() {
  return {"order",
          "order k of 4 elements",
          "Inextensible and shear rigid, dead tip force F L^2 / EI = 10.",
          kElastica,
          {1, 2, 3, 4, 5, 6, 7, 8},
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            return Trial{rod.with_mesh(static_cast<int>(value), 4).with_tip_force(kLoad), solver};
          },
          1e-1,
          1.0,
          8.0,
          "Vertices converge with the power 2 k of the element length, so each order gains about one and a half digits "
          "on this mesh."};
}

const std::string kPendulum = "elastica of a thrust beside the axis, elliptic integrals; the stable equilibrium";

Sweep imperfection() {
  return {"imperfection",
          "force across over the thrust",
          "Inextensible and shear rigid, in space; dead thrust of 1.2 times Euler's load.",
          kPendulum,
          joined(decades(-8, -1), {0.3}),
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            return Trial{rod.with_thrust(1.2, value), solver};
          },
          1e-8,
          1e-8,
          0.3,
          "The smaller the force across, the sharper the path turns at Euler's load; nothing else tells the two sides "
          "apart. The turn about the axis of the thrust is as soft as the force across is small."};
}

Sweep thrust() {
  return {"thrust",
          "dead thrust over Euler's load",
          "Inextensible and shear rigid, in space; a force across of 1e-4 of the thrust.",
          kPendulum,
          {0.5, 0.9, 0.99, 1.0, 1.01, 1.05, 1.2, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0},
          [](const Cantilever& rod, const SolverParameters& solver, double value) {
            return Trial{rod.with_thrust(value, 1e-4), solver};
          },
          1e-7,
          0.5,
          20.0,
          "Beyond Euler's load there are two equilibria and more; the stable one on the side of the force is the one "
          "that the path reaches. Below it the motion is small, and errors are relative to it."};
}

}  // namespace

std::vector<Sweep> all_sweeps(int most_elements) {
  return {slenderness(),
          stiffness_ratio(),
          unit_of_length(),
          unit_of_force(),
          elements(most_elements),
          length_ratio(),
          turns(),
          load_steps(),
          element_turn_lowest_order(),
          element_turn(),
          angle(),
          tip_force(),
          order(),
          imperfection(),
          thrust()};
}

}  // namespace mixbeam
