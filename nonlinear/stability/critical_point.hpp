/// Points of a path at which the tangent is singular.
#pragma once

#include "nonlinear/stability/stability.hpp"

#include <limits>
#include <vector>

namespace mixbeam {

enum class CriticalKind {
  limit_point,  ///< the load factor is stationary along the path
  bifurcation,  ///< another path crosses this one
  flutter       ///< frequencies meet, and motions begin to grow
};

/// "limit point", "bifurcation", "flutter".
const char* name_of(CriticalKind kind);

struct CriticalPoint {
  CriticalKind kind = CriticalKind::limit_point;
  double load_factor = 0.0;
  /// Eigenvalues below zero on either side, in the direction of the path; of flutter motions that grow.
  int negative_before = 0, negative_after = 0;
  State state{};     ///< there
  MixedVector mode;  ///< as EigenMode::mode
  int modes = 1;     ///< eigenvalues that vanish, or meet, here together; `mode` is one of theirs
  /// Of the load factor. Where only the first of many points of a step is located the others are one entry: somewhere
  /// within load_factor +- error `modes` eigenvalues change their sign, and state and mode are those of its far end.
  double error = 0.0;
  bool located = true;
  double omega = std::numeric_limits<double>::quiet_NaN();  ///< of flutter: radians per time
  std::vector<MixedVector> eigenspace{};                    ///< all `modes` of them
};

}  // namespace mixbeam
