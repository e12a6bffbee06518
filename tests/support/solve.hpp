/// Solving a scene in a test, and comparing vectors.
#pragma once

#include "kernels/math/gauss.hpp"
#include "nonlinear/run/simulation.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <string>
#include <vector>

namespace mixbeam::test {

/// The scene at the end of its load path; fails the test when the path has no end.
inline Simulation solved(const Scene& scene, const SolverParameters& parameters = {},
                         const Communicator& comm = this_rank()) {
  Simulation simulation(scene, parameters, comm);
  const LoadPathResult& result = simulation.run();
  EXPECT_TRUE(result.finished) << scene.name << ": " << result.failure;
  return simulation;
}

/// A scene in a plane, solved with three unknowns per vertex and with six.
inline std::vector<Simulation> solved_in_plane_and_in_space(const Scene& scene, SolverParameters parameters = {}) {
  std::vector<Simulation> both;
  for (bool planar : {true, false}) {
    parameters.planar = planar;
    both.push_back(solved(scene, parameters));
    EXPECT_EQ(both.back().state().in_plane, planar) << scene.name;
  }
  return both;
}

/// Steps for the ten coils of the helical rod, where a step of the whole load leads to another number of coils.
inline SolverParameters careful_path() {
  SolverParameters parameters;
  parameters.load_path.initial_step = 0.12;
  parameters.newton.maximum_iterations = 30;
  parameters.newton.maximum_rotation = 0.45;
  return parameters;
}

/// Largest component of a - b.
inline double distance(const Vector3& a, const Vector3& b) {
  double largest = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double difference = std::abs(a[i] - b[i]);
    if (!(difference <= largest)) largest = difference;  // keeps not-a-number
    if (std::isnan(largest)) return largest;
  }
  return largest;
}

/// Whether no component differs by more than `tolerance`; a value that is not a number never agrees.
inline testing::AssertionResult agrees(const Vector3& actual, const Vector3& expected, double tolerance) {
  const bool holds = distance(actual, expected) <= tolerance;
  testing::AssertionResult result(holds);
  result << std::setprecision(15) << "(" << actual[0] << ", " << actual[1] << ", " << actual[2] << ")"
         << (holds ? " agrees with " : " differs from ") << "(" << expected[0] << ", " << expected[1] << ", "
         << expected[2] << ") by " << std::setprecision(3) << distance(actual, expected) << ", allowed " << tolerance;
  return result;
}

inline double largest_component(const Vector3& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

/// The same, relative to the largest component expected.
inline testing::AssertionResult agrees_relatively(const Vector3& actual, const Vector3& expected, double tolerance) {
  return agrees(actual, expected, tolerance * largest_component(expected));
}

/// Where a curve in the plane that starts at the origin is at s: the integral of (cos, sin) of its angle.
template <class Angle>
Vector3 point_of_curve(double s, const Angle& angle) {
  constexpr int kPanels = 40, kPoints = 8;
  double xi[kPoints], weight[kPoints];
  gauss_rule(kPoints, xi, weight);
  Vector3 point{};
  for (int panel = 0; panel < kPanels; ++panel)
    for (int q = 0; q < kPoints; ++q) {
      const double a = angle(s / kPanels * (panel + 0.5 * (1.0 + xi[q])));
      point[0] += 0.5 * s / kPanels * weight[q] * std::cos(a);
      point[1] += 0.5 * s / kPanels * weight[q] * std::sin(a);
    }
  return point;
}

}  // namespace mixbeam::test
