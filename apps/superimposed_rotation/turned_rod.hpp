/// Compares a rod that turns as a whole with what it was before.
#pragma once

#include "nonlinear/run/simulation.hpp"

#include <vector>

namespace mixbeam {

/// How a turned configuration differs from the one before, after turning it back.
struct Deviation {
  double rotation = 0.0;         ///< prescribed so far [rad]
  double relative_u3 = 0.0;      ///< displacement of the tip along the axis of rotation, change over L
  double relative_energy = 0.0;  ///< moment energy, change over its value
  double position = 0.0;         ///< farthest vertex, distance over L
  double triad = 0.0;            ///< vertex whose triad differs most, angle [rad]
  int iterations = 0;            ///< Newton's, for this increment
};

/// Follows a run: keeps the state at the start of the prescribed rotation and compares every later one with it.
class TurnedRod {
 public:
  /// The support with a prescribed rotation says axis, centre and stage; `tip` is the point watched.
  TurnedRod(const Scene& scene, const std::string& tip);

  /// Collective; to be called after every converged step.
  void observe(const Simulation& simulation, const StepReport& report);

  /// The state before the rotation first (no deviation, no iterations), then every increment.
  const std::vector<Deviation>& deviations() const { return deviations_; }
  /// Largest absolute values of all increments, the largest number of iterations among them, and the whole rotation.
  Deviation largest() const;

 private:
  struct Configuration {
    double along_axis = 0.0;  ///< of the tip's displacement
    double moment_energy = 0.0;
    std::vector<Vec3<double>> positions;
    std::vector<Quaternion<double>> rotations;
  };

  Configuration configuration_of(const Simulation& simulation) const;
  Deviation compare(const Configuration& turned, double rotation, double length) const;

  std::string tip_;
  Support support_;
  Vec3<double> center_{}, axis_{};
  double whole_rotation_ = 0.0;
  Configuration start_;
  std::vector<Deviation> deviations_;
};

}  // namespace mixbeam
