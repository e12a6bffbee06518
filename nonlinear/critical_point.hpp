/// Points of a path at which the tangent is singular.
#pragma once

#include "nonlinear/stability.hpp"

#include <vector>

namespace mixbeam {

enum class CriticalKind {
  limit_point,  ///< the load factor is stationary along the path
  bifurcation   ///< another path crosses this one
};

/// "limit point", "bifurcation".
const char* name_of(CriticalKind kind);

struct CriticalPoint {
  CriticalKind kind = CriticalKind::limit_point;
  double load_factor = 0.0;
  int negative_before = 0, negative_after = 0;  ///< eigenvalues below zero on either side, in the direction of the path
  State state{};                                ///< there
  MixedVector mode;                             ///< as EigenMode::mode
  int modes = 1;                                ///< eigenvalues that vanish here together; `mode` is one of theirs
};

}  // namespace mixbeam
