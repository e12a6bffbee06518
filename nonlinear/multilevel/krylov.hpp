/// Krylov methods of Belos for matrices with which conjugate gradients break down, theory (64).
#pragma once

#include "nonlinear/multilevel/level.hpp"

#include <functional>

namespace mixbeam::multilevel {

/// y = A x
using LinearMap = std::function<void(const LevelVector& x, const LevelVector& y)>;

enum class KrylovMethod {
  minres,  ///< A symmetric, of any sign
  gmres,   ///< any A
};

struct KrylovResult {
  bool converged = false;
  int iterations = 0;
};

/// x = A^-1 b until r . M^-1 r has fallen by reduction^2. `preconditioner`: M^-1, symmetric positive definite. Both
/// methods minimise that norm of the residual. Vectors are those of a level. The same bits for any number of threads.
KrylovResult solve(KrylovMethod method, const Level& level, const LinearMap& matrix, const LinearMap& preconditioner,
                   const LevelVector& b, const LevelVector& x, double reduction, int most_iterations);

}  // namespace mixbeam::multilevel
