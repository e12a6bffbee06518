#include "nonlinear/stability/block_krylov.hpp"

#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <Teuchos_BLAS.hpp>
#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>

namespace mixbeam {

namespace {

constexpr int kGuardVectors = 2;  ///< beyond those asked for: the last one wanted converges as fast as the first

using Vector = std::vector<double>;

/// Rotations of Jacobi's method: sweeps, of which five are enough.
constexpr int kSweeps = 20;

class KrylovSpace {
 public:
  KrylovSpace(const KrylovProblem& problem, int wanted) : problem_(problem), wanted_(wanted) {}

  /// Adds the operator times the newest block; false when nothing new came.
  bool grow(const std::vector<Vector>& block) {
    const size_t first = basis_.size();
    for (const Vector& v : block) append(v);
    const int added = static_cast<int>(basis_.size() - first), n = problem_.unknowns;
    if (added == 0) return false;
    Vector columns;
    columns.reserve(static_cast<size_t>(added) * n);
    for (size_t j = first; j < basis_.size(); ++j) columns.insert(columns.end(), basis_[j].begin(), basis_[j].end());
    problem_.apply(columns.data(), added);
    for (int j = 0; j < added; ++j)
      image_.emplace_back(columns.begin() + static_cast<size_t>(j) * n,
                          columns.begin() + static_cast<size_t>(j + 1) * n);
    project(first);
    return true;
  }
  std::vector<Vector> newest_images(size_t first) const { return {image_.begin() + first, image_.end()}; }
  int size() const { return static_cast<int>(basis_.size()); }

  std::vector<RitzPair> ritz_pairs() const {
    Vector projected = projected_;
    return problem_.symmetric ? symmetric_pairs(projected) : general_pairs(projected);
  }

 private:
  Vector times_inner(const Vector& x) const {
    if (!problem_.inner) return x;
    Vector y(x.size());
    problem_.inner(x.data(), y.data());
    return y;
  }

  /// Extends V^T B A V (column-major) by what the vectors from `first` on add.
  void project(size_t first) {
    const size_t m = basis_.size();
    Vector larger(m * m);
    for (size_t i = 0; i < m; ++i)
      for (size_t j = 0; j < m; ++j)
        larger[i + j * m] = i < first && j < first ? projected_[i + j * first] : dot_product(dual_[i], image_[j]);
    projected_ = std::move(larger);
  }

  /// Gram-Schmidt, twice: the second time removes the rounding of the first.
  void append(Vector v) {
    Vector dual = times_inner(v);
    const double before = std::sqrt(dot_product(v, dual));
    if (!(before > 0.0)) return;
    for (double& x : v) x /= before;
    for (int pass = 0; pass < 2; ++pass)
      for (size_t j = 0; j < basis_.size(); ++j) add_multiple(-dot_product(dual_[j], v), basis_[j], v);
    dual = times_inner(v);
    const double after = std::sqrt(dot_product(v, dual));
    if (!(after > stability_limit.nothing_new)) return;
    for (double& x : v) x /= after;
    for (double& x : dual) x /= after;
    basis_.push_back(std::move(v));
    dual_.push_back(std::move(dual));
  }

  std::vector<RitzPair> symmetric_pairs(Vector& t) const {
    const int m = size();
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < i; ++j)
        t[i + static_cast<size_t>(j) * m] = t[j + static_cast<size_t>(i) * m] =
            0.5 * (t[i + static_cast<size_t>(j) * m] + t[j + static_cast<size_t>(i) * m]);
    Vector values(m), work(4 * m);
    int info = 0;
    Teuchos::LAPACK<int, double>().SYEV('V', 'L', m, t.data(), m, values.data(), work.data(), 4 * m, &info);
    if (info != 0) throw LinearSolverError("the small eigenvalue problem failed: dsyev " + std::to_string(info));
    std::vector<int> order(m);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return std::abs(values[a]) > std::abs(values[b]); });
    std::vector<RitzPair> pairs;
    for (int k = 0; k < std::min(m, wanted_); ++k)
      pairs.push_back(pair_of(values[order[k]], 0.0, &t[static_cast<size_t>(order[k]) * m]));
    return pairs;
  }

  std::vector<RitzPair> general_pairs(Vector& t) const {
    const int m = size(), length = 8 * m;
    Vector re(m), im(m), vectors(static_cast<size_t>(m) * m), work(length), unused(2 * m);
    int info = 0;
    double none = 0.0;
    Teuchos::LAPACK<int, double>().GEEV('N', 'V', m, t.data(), m, re.data(), im.data(), &none, 1, vectors.data(), m,
                                        work.data(), length, unused.data(), &info);
    if (info != 0) throw LinearSolverError("the small eigenvalue problem failed: dgeev " + std::to_string(info));
    std::vector<int> order(m);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return std::hypot(re[a], im[a]) > std::hypot(re[b], im[b]); });
    std::vector<RitzPair> pairs;
    for (int k = 0; k < std::min(m, wanted_); ++k) {
      const int i = order[k];
      pairs.push_back(
          pair_of(re[i], im[i], &vectors[static_cast<size_t>(i) * m]));  // LAPACK: real part, imaginary part
      const int first = im[i] < 0.0 ? i - 1 : i;
      if (im[i] != 0.0) pairs.back().residual = complex_residual(re[i], std::abs(im[i]), &vectors[first * size_t(m)]);
    }
    return pairs;
  }

  Vector combine(const std::vector<Vector>& columns, const double* weights) const {
    Vector sum(problem_.unknowns, 0.0);
    for (size_t j = 0; j < columns.size(); ++j) add_multiple(weights[j], columns[j], sum);
    return sum;
  }
  double norm(const Vector& x) const { return std::sqrt(dot_product(x, times_inner(x))); }

  RitzPair pair_of(double value, double imaginary, const double* weights) const {
    RitzPair pair{value, imaginary, combine(basis_, weights), 0.0};
    Vector error = combine(image_, weights);
    add_multiple(-value, pair.vector, error);
    pair.residual = norm(error) / std::abs(value);
    return pair;
  }

  /// A (x + i y) = (a + i b)(x + i y); the columns of x and y stand beside each other.
  double complex_residual(double a, double b, const double* weights) const {
    const double* second = weights + size();
    const Vector x = combine(basis_, weights), y = combine(basis_, second);
    Vector real = combine(image_, weights), imaginary = combine(image_, second);
    add_multiple(-a, x, real);
    add_multiple(b, y, real);
    add_multiple(-b, x, imaginary);
    add_multiple(-a, y, imaginary);
    return std::hypot(norm(real), norm(imaginary)) / std::hypot(a, b);
  }

  const KrylovProblem& problem_;
  int wanted_;
  std::vector<Vector> basis_, dual_, image_;  ///< orthonormal v_j, B v_j, A v_j
  Vector projected_;
};

/// The same numbers on every machine: bits of the generator, not a distribution of the library.
std::vector<Vector> start_block(int unknowns, int columns) {
  std::mt19937_64 generator(20240229);
  std::vector<Vector> block(columns, Vector(unknowns));
  for (Vector& v : block)
    for (double& x : v) x = 0x1p-52 * static_cast<double>(generator() >> 11) - 1.0;
  return block;
}

double largest_residual(const std::vector<RitzPair>& pairs, int count) {
  double largest = static_cast<int>(pairs.size()) < count ? HUGE_VAL : 0.0;
  for (int i = 0; i < std::min<int>(count, pairs.size()); ++i) largest = std::max(largest, pairs[i].residual);
  return largest;
}

/// Residuals of the blocks so far, and whether there is no use in going on.
class Progress {
 public:
  explicit Progress(double tolerance) : tolerance_(tolerance) {}
  bool is_enough(double residual) {
    history_.push_back(residual);
    if (residual <= tolerance_) return true;
    const size_t n = history_.size();
    return n > stability_limit.standstill_blocks && residual <= stability_limit.largest_standstill &&
           residual >
               stability_limit.standstill * history_[n - 1 - static_cast<size_t>(stability_limit.standstill_blocks)];
  }

 private:
  double tolerance_;
  std::vector<double> history_;
};

/// Errors of the first `count` pairs; all pairs found tell how far others are away.
std::vector<RitzPair> finished(std::vector<RitzPair> pairs, int count, bool symmetric) {
  for (RitzPair& pair : pairs) {
    pair.error = pair.residual;
    pair.converged = pair.residual <= stability_limit.largest_standstill;
    if (!symmetric) continue;
    double gap = HUGE_VAL;  // pairs that lie within the residual belong to one eigenspace, whose values are as good
    for (const RitzPair& other : pairs) {
      const double distance = std::abs(other.value - pair.value) / std::abs(pair.value);
      if (&other != &pair && distance > 10.0 * (pair.residual + other.residual)) gap = std::min(gap, distance);
    }
    if (gap < HUGE_VAL) pair.error = std::min(pair.error, pair.residual * pair.residual / gap);
  }
  pairs.resize(std::min<size_t>(pairs.size(), count));
  return pairs;
}

}  // namespace

double dot_product(const Vector& x, const Vector& y) {
  return Teuchos::BLAS<int, double>().DOT(static_cast<int>(x.size()), x.data(), 1, y.data(), 1);
}

void add_multiple(double a, const Vector& x, Vector& y) {
  Teuchos::BLAS<int, double>().AXPY(static_cast<int>(x.size()), a, x.data(), 1, y.data(), 1);
}

std::vector<double> small_eigenproblem(std::vector<double>& a, int m) {
  std::vector<double> vectors(a.size(), 0.0);
  for (int i = 0; i < m; ++i) vectors[i * (m + 1)] = 1.0;
  const auto at = [m](std::vector<double>& x, int i, int j) -> double& { return x[i + static_cast<size_t>(j) * m]; };
  bool rotated = true;
  for (int sweep = 0; rotated && sweep < kSweeps; ++sweep) {
    rotated = false;
    for (int p = 0; p < m; ++p)
      for (int q = p + 1; q < m; ++q) {
        const double beside = at(a, p, q), size = std::sqrt(std::abs(at(a, p, p) * at(a, q, q)));
        if (!(std::abs(beside) > std::numeric_limits<double>::epsilon() * size)) continue;
        rotated = true;
        const double half = 0.5 * (at(a, q, q) - at(a, p, p));
        const double t = beside / (half + std::copysign(std::hypot(half, beside), half));
        const double c = 1.0 / std::hypot(1.0, t), s = t * c;
        for (int k = 0; k < m; ++k) {
          const double x = at(a, k, p), y = at(a, k, q), v = at(vectors, k, p), w = at(vectors, k, q);
          at(a, k, p) = c * x - s * y;
          at(a, k, q) = s * x + c * y;
          at(vectors, k, p) = c * v - s * w;
          at(vectors, k, q) = s * v + c * w;
        }
        for (int k = 0; k < m; ++k) {
          const double x = at(a, p, k), y = at(a, q, k);
          at(a, p, k) = c * x - s * y;
          at(a, q, k) = s * x + c * y;
        }
        at(a, p, q) = at(a, q, p) = 0.0;
      }
  }
  return vectors;
}

std::vector<RitzPair> largest_eigenpairs(const KrylovProblem& problem, int count) {
  if (problem.unknowns == 0) return {};  // all vertices are fixed
  const int wanted = std::min(count, problem.unknowns);
  const int width = std::min(problem.unknowns, problem.width > 0 ? problem.width : wanted + kGuardVectors);
  std::vector<Vector> start = start_block(problem.unknowns, width);
  std::vector<RitzPair> pairs;
  for (int blocks = 0; blocks < kMostBlocks;) {
    KrylovSpace krylov(problem, std::max(width, wanted));
    std::vector<Vector> block = start;
    Progress progress(problem.tolerance);
    for (int step = 0; step < stability_limit.longest_space && blocks < kMostBlocks; ++step, ++blocks) {
      const size_t first = krylov.size();
      const bool grown = krylov.grow(block);
      pairs = krylov.ritz_pairs();
      if (!grown || krylov.size() == problem.unknowns || progress.is_enough(largest_residual(pairs, wanted)))
        return finished(std::move(pairs), wanted, problem.symmetric);
      block = krylov.newest_images(first);
    }
    start.clear();
    for (const RitzPair& pair : pairs) start.push_back(pair.vector);
  }
  return finished(std::move(pairs), wanted, problem.symmetric);
}

}  // namespace mixbeam
