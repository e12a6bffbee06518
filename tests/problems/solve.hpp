/// Solving a scene in a test, and comparing vectors.
#pragma once

#include "nonlinear/run/simulation.hpp"
#include "tests/problems/scenes.hpp"

#include <gtest/gtest.h>

#include <Teuchos_DefaultMpiComm.hpp>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <string>

namespace mixbeam::test {

inline Communicator this_rank() { return Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)); }
inline Communicator all_ranks() { return Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_WORLD)); }

/// The scene at the end of its load path; fails the test when the path has no end.
inline Simulation solved(const Scene& scene, const SolverParameters& parameters = {},
                         const Communicator& comm = this_rank()) {
  Simulation simulation(scene, parameters, comm);
  const LoadPathResult& result = simulation.run();
  EXPECT_TRUE(result.finished) << scene.name << ": " << result.failure;
  return simulation;
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

}  // namespace mixbeam::test
