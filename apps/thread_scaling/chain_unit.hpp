/// The unit of time B: how long LAPACK takes on one thread for a linear system of the same size as a chain's.
#pragma once

#include <string>
#include <vector>

namespace mixbeam {

/// A clamped chain of beam elements on a soft foundation: symmetric positive definite, block-tridiagonal with 6 x 6
/// blocks, stored and solved as a band matrix with 11 diagonals on either side (dgbtrf and dgbtrs). A library that has
/// threads of its own is told to use one.
class ChainUnit {
 public:
  explicit ChainUnit(int vertices);

  struct Seconds {
    double factorize = 0.0, solve = 0.0;  ///< wall time
    double processor = 0.0;               ///< processor time of both
    double sum() const { return factorize + solve; }
  };
  /// Factorises and solves once; std::runtime_error unless the solution is the known one.
  Seconds time();

 private:
  void fill();

  int vertices_;
  std::vector<double> band_, rhs_;
  std::vector<int> pivots_;
};

/// Path of the BLAS that LAPACK uses here; "unknown" where the system does not tell. The reference BLAS wherever it is
/// installed, whatever the program itself uses.
std::string blas_library();

}  // namespace mixbeam
