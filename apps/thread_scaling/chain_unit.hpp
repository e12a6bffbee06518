/// The unit of time B: time of LAPACK on one thread for a linear system of the same size as a chain's.
#pragma once

#include <string>
#include <vector>

namespace mixbeam {

/// A clamped chain of beam elements on a soft foundation: symmetric positive definite, block-tridiagonal with 6 x 6
/// blocks, stored and solved as a band matrix with 11 diagonals on either side (dgbtrf and dgbtrs). A BLAS with its own
/// threads is limited to one.
class ChainUnit {
 public:
  explicit ChainUnit(int vertices);

  struct Seconds {
    double factorize = 0.0, solve = 0.0;  ///< wall time
    double processor = 0.0;               ///< processor time of both
    double sum() const { return factorize + solve; }
  };
  /// Factorises and solves once; throws std::runtime_error if the solution is wrong.
  Seconds time();

 private:
  void fill();

  int vertices_;
  std::vector<double> band_, rhs_;
  std::vector<int> pivots_;
};

/// Path of the BLAS that LAPACK uses here: the reference BLAS if installed, independent of the program's own; "unknown"
/// if it cannot be determined.
std::string blas_library();

}  // namespace mixbeam
