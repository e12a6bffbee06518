/// Krylov methods for any type of vector, with all sums in a fixed order.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

namespace mixbeam {

enum class KrylovEnd { converged, not_converged, negative_curvature };

/// Conjugate gradients: adds A^-1 r to x until r . M^-1 r has fallen by reduction^2; r is then the residual. z, p and q
/// are scratch. `system` has dot(a, b), add(s, b, a) for a += s b, precondition(r, z) for z = M^-1 r,
/// extend(z, beta, p) for p = z + beta p (p undefined if beta = 0) and multiply(p, q) for q = A p.
/// `goes_on(iterations, energy, first)` is called before each iteration with r . M^-1 r now and at the start.
template <class System, class Vector, class GoesOn>
KrylovEnd conjugate_gradients(const System& system, Vector& x, Vector& r, Vector& z, Vector& p, Vector& q,
                              double reduction, const GoesOn& goes_on) {
  double first = 0.0, last = 0.0;
  for (int k = 0;; ++k) {
    system.precondition(r, z);
    const double energy = system.dot(r, z);
    if (k == 0) first = energy;
    if (!(energy > reduction * reduction * first))
      return energy >= 0.0 ? KrylovEnd::converged : KrylovEnd::not_converged;
    if (!goes_on(k, energy, first)) return KrylovEnd::not_converged;
    system.extend(z, k == 0 ? 0.0 : energy / last, p);
    system.multiply(p, q);
    const double curvature = system.dot(p, q);
    if (!(curvature > 0.0)) return KrylovEnd::negative_curvature;
    system.add(energy / curvature, p, x);
    system.add(-energy / curvature, q, r);
    last = energy;
  }
}

/// Least-squares solution of the Hessenberg system of GMRES by Givens rotations, one column at a time.
class Hessenberg {
 public:
  explicit Hessenberg(double beta) : rhs_{beta} {}

  /// Takes a column with one more entry than those before; returns the norm of the residual.
  double add(std::vector<double> column) {
    const size_t k = rotations_.size();
    for (size_t i = 0; i < k; ++i) rotate(rotations_[i], column[i], column[i + 1]);
    const double r = std::hypot(column[k], column[k + 1]);
    rotations_.push_back(r == 0.0 ? Rotation{1.0, 0.0} : Rotation{column[k] / r, column[k + 1] / r});
    rhs_.push_back(0.0);
    rotate(rotations_[k], column[k], column[k + 1]);
    rotate(rotations_[k], rhs_[k], rhs_[k + 1]);
    columns_.push_back(std::move(column));
    return std::abs(rhs_.back());
  }

  std::vector<double> solution() const {
    std::vector<double> y(columns_.size());
    for (size_t i = columns_.size(); i-- > 0;) {
      double sum = rhs_[i];
      for (size_t j = i + 1; j < columns_.size(); ++j) sum -= columns_[j][i] * y[j];
      y[i] = sum / columns_[i][i];
    }
    return y;
  }

 private:
  struct Rotation {
    double c, s;
  };
  static void rotate(const Rotation& rotation, double& a, double& b) {
    const double first = rotation.c * a + rotation.s * b;
    b = rotation.c * b - rotation.s * a;
    a = first;
  }

  std::vector<std::vector<double>> columns_;
  std::vector<Rotation> rotations_;
  std::vector<double> rhs_;
};

template <class Vector>
double norm_of(const Vector& v) {
  return std::sqrt(v.inner_product(v));
}

struct GmresResult {
  std::vector<double> y;
  double left = 0.0;  ///< norm of the residual
};

/// GMRES without restart: minimises |b - A sum y_k v_k| over y, v the basis of the Krylov space of b. `basis`: b, of
/// norm `beta`, on entry, v on return. `multiply(v, next)` sets next = A v, or returns false to stop without it. Stops
/// when the residual has fallen by `reduction`. Vectors have inner_product, update, scale, clone like MixedVector.
template <class Vector, class Multiply>
GmresResult gmres(std::vector<Vector>& basis, double beta, double reduction, int most_vectors,
                  const Multiply& multiply) {
  basis[0].scale(1.0 / beta);
  Hessenberg system(beta);
  double left = beta;
  for (int k = 0; k < most_vectors && left > reduction * beta; ++k) {
    Vector next = basis[k].clone(false);
    if (!multiply(basis[k], next)) break;
    std::vector<double> column;
    for (const Vector& v : basis) {
      column.push_back(v.inner_product(next));
      next.update(-column.back(), v, 1.0);
    }
    column.push_back(norm_of(next));
    const double length = column.back();
    left = system.add(std::move(column));
    if (!(length > 0.0)) break;
    next.scale(1.0 / length);
    basis.push_back(std::move(next));
  }
  return {system.solution(), left};
}

}  // namespace mixbeam
