/// First and second derivatives of functions of many increments by automatic differentiation, in small chunks of
/// directions (a chunk fits the cache, and one pair of scalar types serves every order), and the dense algebra that a
/// test compares with.
#pragma once

#include <Sacado_No_Kokkos.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace mixbeam::element_test {

constexpr int kChunk = 9;  ///< directions per evaluation
using Fad = Sacado::Fad::SFad<double, kChunk>;
using FadOfFad = Sacado::Fad::SFad<Fad, kChunk>;

/// Square matrix, row-major.
struct Dense {
  int size = 0;
  std::vector<double> entry;
  explicit Dense(int n) : size(n), entry(static_cast<size_t>(n) * n, 0.0) {}
  double& operator()(int i, int j) { return entry[static_cast<size_t>(i) * size + j]; }
  double operator()(int i, int j) const { return entry[static_cast<size_t>(i) * size + j]; }
};

/// df/dx at x = 0 for f(const Fad*).
template <class Function>
std::vector<double> gradient_at_zero(int n, const Function& f) {
  std::vector<double> result(n);
  for (int begin = 0; begin < n; begin += kChunk) {
    std::vector<Fad> x(n, Fad(0.0));
    const int width = std::min(kChunk, n - begin);
    for (int a = 0; a < width; ++a) x[begin + a] = Fad(kChunk, a, 0.0);
    const Fad value = f(x.data());
    for (int a = 0; a < width; ++a) result[begin + a] = value.dx(a);
  }
  return result;
}

/// d2 f / dx_i dy_j at x = y = 0 for f(const FadOfFad* x, const FadOfFad* y). A symmetric result costs half.
template <class Function>
Dense mixed_derivatives_at_zero(int n, bool symmetric, const Function& f) {
  Dense result(n);
  for (int row = 0; row < n; row += kChunk) {
    for (int column = 0; column < (symmetric ? row + 1 : n); column += kChunk) {
      std::vector<FadOfFad> x(n, FadOfFad(Fad(0.0))), y = x;
      const int rows = std::min(kChunk, n - row), columns = std::min(kChunk, n - column);
      for (int a = 0; a < rows; ++a) x[row + a] = FadOfFad(kChunk, a, Fad(0.0));
      for (int b = 0; b < columns; ++b) y[column + b] = FadOfFad(Fad(kChunk, b, 0.0));
      const FadOfFad value = f(x.data(), y.data());
      for (int a = 0; a < rows; ++a)
        for (int b = 0; b < columns; ++b) {
          result(row + a, column + b) = value.dx(a).dx(b);
          if (symmetric) result(column + b, row + a) = value.dx(a).dx(b);
        }
    }
  }
  return result;
}

/// Hessian of f at 0, f(const FadOfFad*).
template <class Function>
Dense hessian_at_zero(int n, const Function& f) {
  return mixed_derivatives_at_zero(n, true, [n, &f](const FadOfFad* x, const FadOfFad* y) {
    std::vector<FadOfFad> sum(n);
    for (int i = 0; i < n; ++i) sum[i] = x[i] + y[i];
    return f(sum.data());
  });
}

/// What is left of  H x = -g  when the unknowns `kept`.. (a leading range) stay and `eliminated` are solved for:
///   tangent x_k = -gradient,   x_e = response (x_k, 1)   with kept + 1 columns.
struct SchurComplement {
  std::vector<std::vector<double>> tangent;
  std::vector<double> gradient;
  std::vector<std::vector<double>> response;
};

/// Gaussian elimination with full row pivoting in long double: the reference must not limit the comparison.
inline SchurComplement schur_complement(const Dense& hessian, const std::vector<double>& gradient, int kept,
                                        const std::vector<int>& eliminated) {
  const int n = static_cast<int>(eliminated.size()), columns = kept + 1;
  std::vector<std::vector<long double>> a(n, std::vector<long double>(n + columns));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) a[i][j] = hessian(eliminated[i], eliminated[j]);
    for (int j = 0; j < kept; ++j) a[i][n + j] = -static_cast<long double>(hessian(eliminated[i], j));
    a[i][n + kept] = -static_cast<long double>(gradient[eliminated[i]]);
  }
  for (int k = 0; k < n; ++k) {  // Gauss-Jordan
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::fabs(a[i][k]) > std::fabs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]);
    for (int j = n + columns - 1; j >= k; --j) a[k][j] /= a[k][k];
    for (int i = 0; i < n; ++i) {
      if (i == k || a[i][k] == 0.0L) continue;
      for (int j = n + columns - 1; j >= k; --j) a[i][j] -= a[i][k] * a[k][j];
    }
  }
  SchurComplement result{std::vector<std::vector<double>>(kept, std::vector<double>(kept)), std::vector<double>(kept),
                         std::vector<std::vector<double>>(n, std::vector<double>(columns))};
  for (int r = 0; r < kept; ++r)
    for (int c = 0; c < columns; ++c) {
      long double sum = c < kept ? hessian(r, c) : gradient[r];
      for (int i = 0; i < n; ++i) sum += hessian(r, eliminated[i]) * a[i][n + c];
      (c < kept ? result.tangent[r][c] : result.gradient[r]) = static_cast<double>(sum);
    }
  for (int i = 0; i < n; ++i)
    for (int c = 0; c < columns; ++c) result.response[i][c] = static_cast<double>(a[i][n + c]);
  return result;
}

}  // namespace mixbeam::element_test
