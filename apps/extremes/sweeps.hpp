/// The sweeps of the study: the structure of most of them, a straight cantilever with EI2 = EI3 under a dead load at
/// its tip, its closed forms, and the table of sweeps: which quantity, which values, which scene and closed form for a
/// value.
#pragma once

#include "kernels/math/rotation.hpp"
#include "nonlinear/run/simulation.hpp"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace mixbeam {

/// An inextensible, shear rigid cantilever of length 1 and EI = 1 under a dead force at its tip.
struct ElasticaTip {
  double back = 0.0;    ///< against the direction of the undeformed axis
  double across = 0.0;  ///< to the side of the force
  double angle = 0.0;   ///< that the tip turns, in radians
};

/// Under a force across, any load = F L^2 / EI > 0. Error of all three a few roundings, relative to the motion where
/// the load is below 0.03, else to the length. (Bisshopp and Drucker, Quart. Appl. Math. 3, 1945)
ElasticaTip elastica_tip(double load);

/// Under a thrust P L^2 / EI > 0 against its axis with the fraction `eccentricity` > 0 of it across: the stable
/// equilibrium, which bends towards the force across; `angle` up to pi. Relative error a few roundings over that of the
/// eccentricity.
ElasticaTip thrust_tip(double thrust, double eccentricity);

/// One scene of a sweep with its exact answer. Geometry, mesh and stiffness first, then the load, which finds the exact
/// motion of the tip.
struct Cantilever {
  double length = 1.0, bending = 1.0, torsion = 1.0;
  double force_stiffness = std::numeric_limits<double>::infinity();  ///< EA = GA2 = GA3
  int order = 1, elements = 1;
  double ratio = 0.0;  ///< of the longest element to the shortest, growing from the clamp by one factor; 0: all equal
  int steps = 0;       ///< equal ones of the load; 0: as the solver's parameters say
  Vector3 force{}, moment{};
  Vec3<double> exact_displacement{};
  Quaternion<double> exact_rotation = identity_quaternion<double>();
  double displacement_scale = 1.0;  ///< of errors: the displacement itself, so that tiny motions are exact too
  double rotation_scale = 1.0;      ///< the angle, at most one radian

  /// Inextensible and shear rigid. Throws InputError unless the scene is one straight member from the origin along x,
  /// clamped at its start, with one dead load at its end and nothing else, and EI2 = EI3.
  explicit Cantilever(const Scene& scene);

  /// Section of a square of side L / slenderness, EA = 12 slenderness^2 EI / L^2; GA = EA keeps the closed form.
  void set_slenderness(double slenderness) { force_stiffness = 12.0 * std::pow(slenderness / length, 2) * bending; }

  /// Dead force along y, F L^2 / EI = load >= 0. Exact: elastica, and with C = EA = GA2 = GA3 every point moves by
  /// s F / C further, whatever the rotations (r' = g1 + n / C, and m' = - r' x n does not see C).
  void pull(double load);
  /// The same with a slenderness of 100, the unit of length divided by one number and that of force by another.
  void pull_in_units(double of_length, double of_force, double load);
  /// Dead thrust against the axis, as a multiple of Euler's load, and the fraction `eccentricity` > 0 of it along y.
  /// Exact: elastica (inextensible and shear rigid alone), the stable equilibrium on the side of the force along y.
  void push(double load, double eccentricity);
  /// Dead moment with bending_turn = (0, y, z) EI / L across the rod, as spatial vector, and twisting it by `twist`.
  /// Exact (EI2 = EI3, no forces): the spatial moment m is constant and so is its component M1 along the tangent; the
  /// rotations are exp(s m / EI) exp(s M1 (1/GIt - 1/EI) e1), the centerline is a helix about m.
  void turn(const Vec3<double>& bending_turn, double twist);
  /// Dead moment about z that turns the tip by `angle`. Exact: that of the discrete equations on equal elements, the
  /// k-point Gauss rule of the exact tangent (rotations are exact and force strains vanish at these points), because
  /// the circle is far away where an element turns by a radian and more.
  void turn_by_gauss_rule(double angle);

  /// `given` with all this.
  Scene in(Scene given) const;
  /// Distance of a computed tip from the exact one, the larger of displacement and rotation over their scales.
  double error(const Simulation& simulation) const;
};

/// One value of a sweep: what is solved, and how it is judged.
struct Trial {
  Scene scene;
  SolverParameters solver;
  std::function<double(const Simulation&)> error{};  ///< of the end; empty: critical load factors are judged
  std::vector<double> critical{};                    ///< load factors of all critical points
};

struct Sweep {
  std::string name;  ///< in tables and files: snake_case; what it is about tells apps/plots/extremes.py
  std::vector<double> values;
  double allowed;      ///< error that is promised ...
  double from, to;     ///< ... for values in this range; the others are recorded only
  std::string source;  ///< of the closed form
  std::function<Trial(const Scene&, const SolverParameters&, double value)> trial;
};

/// Sweeps of the cantilever, in the order of the page. `most_elements`: end of the one over the number of elements.
std::vector<Sweep> all_sweeps(int most_elements);
/// Of structures whose critical load factors have a closed form: the rise of a truss of two bars that snaps through,
/// and the axial stiffness of a rail that is heated to three times its critical temperature and followed on its branch.
std::vector<Sweep> critical_sweeps();

}  // namespace mixbeam
