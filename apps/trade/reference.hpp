/// What errors are measured against: a solution far finer than any that is judged, confirmed by another one.
#pragma once

#include "apps/trade/path_trace.hpp"

#include <cmath>

namespace mixbeam {

/// All relative. Fields over the whole structure in the L2 norm.
struct Errors {
  double displacement = 0.0;  ///< of the judged point, over its displacement; in the gallery the largest of all points
                              ///< of the scene, over the largest displacement
  double centerline = 0.0;    ///< position of the centerline, over the norm of its displacement
  double moment = 0.0;        ///< material moment, over its norm
  double energy = 0.0;        ///< strain energy
  double largest() const;     ///< not a number if one of them is
};

/// Of a simulation that did not converge.
inline const Errors kNoErrors{std::nan(""), std::nan(""), std::nan(""), std::nan("")};

struct Discretization {
  int order = 0, elements = 0;
};

class Reference {
 public:
  /// Solves on both meshes; the first is the reference, the second tells how far to trust it. Throws ConvergenceError.
  Reference(const BenchmarkProblem& problem, const Communicator& communicator, const Discretization& reference,
            const Discretization& confirmation);

  /// Of a simulation of the same scene on any mesh. Collective.
  Errors errors_of(const Simulation& simulation) const;
  /// Distance of the two solutions: errors as small as this are those of the reference.
  const Errors& difference() const { return difference_; }
  const Simulation& simulation() const { return simulation_; }
  /// What it met on its way.
  const PathTrace& trace() const { return trace_; }
  /// What errors of displacements are divided by.
  double displacement() const { return displacement_; }

 private:
  PathTrace trace_;
  Simulation simulation_;
  std::vector<std::string> points_;                                             ///< whose displacements are judged
  double displacement_ = 0.0, centerline_ = 0.0, moment_ = 0.0, energy_ = 0.0;  ///< what errors are divided by
  Errors difference_;
};

}  // namespace mixbeam
