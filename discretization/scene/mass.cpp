#include "discretization/scene/mass.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Numbers are written with ten digits or more; what is left of a pivot that is zero is less.
constexpr double kRoundedInertia = 1e-9, kNoPivot = 1e-14;

/// |v + w x c|^2 m + w . J w, c in the plane of the section.
Matrix6 mass_matrix(const Section& section) {
  const double m = section.mass, c2 = section.mass_offset[0], c3 = section.mass_offset[1];
  Matrix6 matrix{};
  for (int i = 0; i < 3; ++i) {
    matrix[i][i] = m;
    matrix[3 + i][3 + i] = section.rotary_inertia[i];
  }
  // w x c = (w2 c3 - w3 c2, -w1 c3, w1 c2)
  const double arm[3][3] = {{0.0, c3, -c2}, {-c3, 0.0, 0.0}, {c2, 0.0, 0.0}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      matrix[i][3 + j] = matrix[3 + j][i] = m * arm[i][j];
      for (int k = 0; k < 3; ++k) matrix[3 + i][3 + j] += m * arm[k][i] * arm[k][j];
    }
  matrix[4][5] -= section.inertia_product;
  matrix[5][4] -= section.inertia_product;
  return matrix;
}

}  // namespace

bool is_inertia(const std::array<double, 3>& inertia) {
  const double sum = inertia[0] + inertia[1] + inertia[2], largest = *std::max_element(inertia.begin(), inertia.end());
  return 2.0 * largest <= (1.0 + kRoundedInertia) * sum;
}

/// Cholesky's; a pivot that is zero leaves a column of zeros.
std::array<double, 21> mass_factor(const Section& section) {
  const Matrix6 matrix = mass_matrix(section);
  std::array<double, 21> factor{};
  const auto at = [&factor](int i, int j) -> double& { return factor[static_cast<std::size_t>(i * (i + 1) / 2 + j)]; };
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) {
      double rest = matrix[i][j];
      for (int k = 0; k < j; ++k) rest -= at(i, k) * at(j, k);
      if (i == j)
        at(j, j) = rest > kNoPivot * matrix[j][j] ? std::sqrt(rest) : 0.0;
      else
        at(i, j) = at(j, j) > 0.0 ? rest / at(j, j) : 0.0;
    }
  return factor;
}

}  // namespace mixbeam
