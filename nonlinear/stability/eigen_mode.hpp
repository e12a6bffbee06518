/// Modes of a structure: what stability and linear buckling share.
#pragma once

#include "nonlinear/stability/independent_unknowns.hpp"

#include <functional>
#include <vector>

namespace mixbeam {

struct EigenMode {
  double eigenvalue = 0.0;
  /// Motion of all vertices, those at the far sides of joints included, and the interior that follows it, as an
  /// increment (Model::apply). Largest of |du_i|/L, |dtheta_i| is one, and positive where it occurs first.
  MixedVector mode;
  /// Estimated error of the eigenvalue: what is left of its equation, and the rounding of the tangent.
  double error = 0.0;
  bool converged = true;  ///< false: found within the bounded work, but not to rounding
};

/// Motion that belongs to independent unknowns (rank 0) at the state of a tangent, which unknowns.reduce() got: of the
/// vertices, and of the interior that follows without forces of its own. Collective.
MixedVector complete_motion(const Tangent& tangent, const IndependentUnknowns& unknowns, const std::vector<double>& y);

/// Sum of weights[i] times vectors[i]; at least one vector.
MixedVector combination(const std::vector<MixedVector>& vectors, const double* weights);

/// Scales a mode as EigenMode promises, by the factor returned. Collective.
double normalize_mode(const Model& model, MixedVector& mode);

/// Work of rank 0 alone; what goes wrong there is a LinearSolverError on every rank.
void on_root(const RootCopy& root, const std::function<void()>& action);
/// A number that rank 0 finds, on every rank.
double number_of_root(const RootCopy& root, const std::function<double()>& number);

}  // namespace mixbeam
