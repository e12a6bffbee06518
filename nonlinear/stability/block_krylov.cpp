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

constexpr int kGuardVectors = 2;  ///< additional vectors, so that the last wanted pair converges as fast as the first

using Vector = std::vector<double>;

/// Share of a vector's norm above which an orthogonalisation has not lost digits.
constexpr double kKept = 0.5;

/// Limit of sweeps of Jacobi's method; five are usually enough.
constexpr int kSweeps = 20;

/// Computes C = alpha op(A) B + beta C for contiguous column-major matrices; op(A) is A^T if `transposed`.
void multiply(bool transposed, int m, int n, int k, double alpha, const double* a, const double* b, double beta,
              double* c) {
  if (m == 0 || n == 0 || k == 0) return;
  Teuchos::BLAS<int, double>().GEMM(transposed ? Teuchos::TRANS : Teuchos::NO_TRANS, Teuchos::NO_TRANS, m, n, k, alpha,
                                    a, transposed ? k : m, b, k, beta, c, m);
}

/// Orthonormal V and T with A V = V T + Q R, where Q is the next block and R acts on the newest one: Arnoldi's
/// relation, which provides residuals without vectors.
class KrylovSpace {
 public:
  KrylovSpace(const KrylovProblem& problem, int wanted, Vector start)
      : problem_(problem), wanted_(wanted), next_(std::move(start)) {
    columns_next_ = static_cast<int>(next_.size() / problem.unknowns);
    split_next();
  }

  /// Adds the next block to V; false if there is none.
  bool grow() {
    if (columns_next_ == 0) return false;
    const int added = columns_next_;
    for (size_t j = t_.size() - last_; j < t_.size(); ++j)
      t_[j].insert(t_[j].end(), &split_.r[(j + last_ - t_.size()) * added],
                   &split_.r[(j + last_ - t_.size()) * added] + added);
    Block& block = blocks_.emplace_back(Block{std::move(next_), {}, added});
    if (problem_.inner) block.dual = duals(block.v, added);
    size_ += added;
    last_ = added;
    next_ = block.v;
    problem_.apply(next_.data(), added);
    split_next();
    for (int j = 0; j < added; ++j)
      t_.emplace_back(&split_.h[static_cast<size_t>(j) * size_], &split_.h[static_cast<size_t>(j) * size_] + size_);
    return true;
  }
  bool is_complete() const { return columns_next_ == 0 || size_ == problem_.unknowns; }

  /// Pairs of largest magnitude, without vectors.
  struct Pairs {
    std::vector<RitzPair> values;
    Vector weights;  ///< coefficients in V, a column for each pair
  };
  Pairs ritz_pairs() const { return problem_.symmetric ? symmetric_pairs() : general_pairs(); }
  /// Vectors of the pairs, column-major.
  Vector vectors(const Pairs& pairs) const {
    const int n = problem_.unknowns, count = static_cast<int>(pairs.values.size());
    Vector all(static_cast<size_t>(n) * count, 0.0), part;
    int first = 0;
    for (const Block& block : blocks_) {
      part.resize(static_cast<size_t>(block.columns) * count);
      for (int k = 0; k < count; ++k)
        std::copy_n(&pairs.weights[first + static_cast<size_t>(k) * size_], block.columns, &part[k * block.columns]);
      multiply(false, n, count, block.columns, 1.0, block.v.data(), part.data(), 1.0, all.data());
      first += block.columns;
    }
    return all;
  }

 private:
  struct Block {
    Vector v, dual;  ///< orthonormal columns, and B times them (empty if B = 1)
    int columns;
    const double* left() const { return (dual.empty() ? v : dual).data(); }
  };
  /// Split x = V h + Q r; `left`: norm of the part of each column that Q omits.
  struct Split {
    Vector h, r, left;
  };

  Vector duals(const Vector& x, int columns) const {
    Vector y(x.size());
    for (int j = 0; j < columns; ++j)
      problem_.inner(&x[static_cast<size_t>(j) * problem_.unknowns], &y[static_cast<size_t>(j) * problem_.unknowns]);
    return y;
  }
  double norm(const double* x) const {
    const int n = problem_.unknowns;
    const Vector dual = problem_.inner ? duals(Vector(x, x + n), 1) : Vector();
    return std::sqrt(Teuchos::BLAS<int, double>().DOT(n, x, 1, dual.empty() ? x : dual.data(), 1));
  }

  /// Splits the candidates of the next block twice: the second pass removes the rounding of the first. With a symmetric
  /// operator all blocks but the last two have components of rounding only: the first pass skips them.
  void split_next() {
    const int columns = columns_next_;
    Vector before(columns);
    for (int j = 0; j < columns; ++j) before[j] = norm(&next_[static_cast<size_t>(j) * problem_.unknowns]);
    constexpr size_t kCoupled = 2;
    split_.h = project(columns, problem_.symmetric ? blocks_.size() - std::min(kCoupled, blocks_.size()) : 0);
    split_.r = orthonormalize(before, split_.left);
    const int kept = columns_next_;
    const Vector h = project(kept, 0);
    Vector left;
    const Vector r = orthonormalize(Vector(kept, 1.0), left);
    multiply(false, size_, columns, kept, 1.0, h.data(), split_.r.data(), 1.0, split_.h.data());
    const Vector first = std::move(split_.r);
    split_.r.assign(static_cast<size_t>(columns_next_) * columns, 0.0);
    multiply(false, columns_next_, columns, kept, 1.0, r.data(), first.data(), 0.0, split_.r.data());
  }
  /// Subtracts V h from the next block; returns h, which has zeros for the blocks before `begin`.
  Vector project(int columns, size_t begin) {
    const int n = problem_.unknowns;
    Vector h(static_cast<size_t>(size_) * columns), part;
    int first = 0;
    for (size_t b = 0; b < blocks_.size(); first += blocks_[b++].columns) {
      if (b < begin) continue;
      const Block& block = blocks_[b];
      part.assign(static_cast<size_t>(block.columns) * columns, 0.0);
      multiply(true, block.columns, columns, n, 1.0, block.left(), next_.data(), 0.0, part.data());
      multiply(false, n, columns, block.columns, -1.0, block.v.data(), part.data(), 1.0, next_.data());
      for (int j = 0; j < columns; ++j)
        std::copy_n(&part[j * block.columns], block.columns, &h[first + static_cast<size_t>(j) * size_]);
    }
    return h;
  }
  /// Gram-Schmidt within the next block; drops columns that have become negligible beside their norms `before`. Returns
  /// the factor of the columns kept.
  Vector orthonormalize(const Vector& before, Vector& left) {
    const int n = problem_.unknowns, columns = columns_next_;
    Vector factor(static_cast<size_t>(columns) * columns, 0.0), dual;
    left.assign(columns, 0.0);
    int kept = 0;
    for (int j = 0; j < columns; ++j) {
      double *x = &next_[static_cast<size_t>(j) * n], *own = &next_[static_cast<size_t>(kept) * n];
      double* r = &factor[static_cast<size_t>(j) * columns];
      double size = norm(x);
      for (double last = HUGE_VAL; kept > 0 && size < kKept * last && size > stability_limit.nothing_new * before[j];) {
        Vector part(kept);
        multiply(true, kept, 1, n, 1.0, problem_.inner ? dual.data() : next_.data(), x, 0.0, part.data());
        multiply(false, n, 1, kept, -1.0, next_.data(), part.data(), 1.0, x);
        for (int i = 0; i < kept; ++i) r[i] += part[i];
        last = size;
        size = norm(x);
      }
      if (!(size > stability_limit.nothing_new * before[j])) {
        left[j] = size;
        continue;
      }
      for (int i = 0; i < n; ++i) own[i] = x[i] / size;
      r[kept++] = size;
      if (problem_.inner) {
        const Vector newest = duals(Vector(own, own + n), 1);
        dual.insert(dual.end(), newest.begin(), newest.end());
      }
    }
    next_.resize(static_cast<size_t>(kept) * n);
    columns_next_ = kept;
    Vector r(static_cast<size_t>(kept) * columns);
    for (int j = 0; j < columns; ++j) std::copy_n(&factor[static_cast<size_t>(j) * columns], kept, r.data() + j * kept);
    return r;
  }

  Vector projected() const {
    Vector t(static_cast<size_t>(size_) * size_, 0.0);
    for (int j = 0; j < size_; ++j) std::copy(t_[j].begin(), t_[j].end(), &t[static_cast<size_t>(j) * size_]);
    return t;
  }
  /// Norm of A V w - V T w.
  double residual(const double* weights) const {
    const double* newest = weights + size_ - last_;
    Vector rest(columns_next_, 0.0);
    multiply(false, columns_next_, 1, last_, 1.0, split_.r.data(), newest, 0.0, rest.data());
    double left = 0.0;
    for (int j = 0; j < last_; ++j) left += std::abs(split_.left[j] * newest[j]);
    return std::hypot(std::sqrt(dot_product(rest, rest)), left);
  }

  Pairs symmetric_pairs() const {
    const int m = size_;
    Vector t = projected(), values(m), work(4 * m);
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < i; ++j)
        t[i + static_cast<size_t>(j) * m] = t[j + static_cast<size_t>(i) * m] =
            0.5 * (t[i + static_cast<size_t>(j) * m] + t[j + static_cast<size_t>(i) * m]);
    int info = 0;
    Teuchos::LAPACK<int, double>().SYEV('V', 'L', m, t.data(), m, values.data(), work.data(), 4 * m, &info);
    if (info != 0) throw LinearSolverError("the small eigenvalue problem failed: dsyev " + std::to_string(info));
    Pairs pairs;
    for (const int i : largest([&](int k) { return std::abs(values[k]); })) {
      const double* weights = &t[static_cast<size_t>(i) * m];
      pairs.values.push_back({values[i], 0.0, {}, residual(weights) / std::abs(values[i])});
      pairs.weights.insert(pairs.weights.end(), weights, weights + m);
    }
    return pairs;
  }

  Pairs general_pairs() const {
    const int m = size_, length = 8 * m;
    Vector t = projected(), re(m), im(m), vectors(static_cast<size_t>(m) * m), work(length), unused(2 * m);
    int info = 0;
    double none = 0.0;
    Teuchos::LAPACK<int, double>().GEEV('N', 'V', m, t.data(), m, re.data(), im.data(), &none, 1, vectors.data(), m,
                                        work.data(), length, unused.data(), &info);
    if (info != 0) throw LinearSolverError("the small eigenvalue problem failed: dgeev " + std::to_string(info));
    Pairs pairs;
    for (const int i : largest([&](int k) { return std::hypot(re[k], im[k]); })) {
      const double* weights = &vectors[static_cast<size_t>(i) * m];  // LAPACK: real part, then the imaginary one
      const double other = im[i] == 0.0 ? 0.0 : residual(im[i] < 0.0 ? weights - m : weights + m);
      pairs.values.push_back({re[i], im[i], {}, std::hypot(residual(weights), other) / std::hypot(re[i], im[i])});
      pairs.weights.insert(pairs.weights.end(), weights, weights + m);
    }
    return pairs;
  }
  template <class Size>
  std::vector<int> largest(const Size& size) const {
    std::vector<int> order(size_);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size(a) > size(b); });
    order.resize(std::min(size_, wanted_));
    return order;
  }

  const KrylovProblem& problem_;
  int wanted_, size_ = 0, last_ = 0;  ///< columns of V, and of its newest block
  std::vector<Block> blocks_;
  std::vector<Vector> t_;  ///< columns of T down to their last entry
  Vector next_;            ///< Q
  int columns_next_ = 0;
  Split split_;
};

/// Random start vectors, the same on every machine: from the bits of the generator, not a library's distribution.
Vector start_block(int unknowns, int columns) {
  std::mt19937_64 generator(20240229);
  Vector block(static_cast<size_t>(unknowns) * columns);
  for (double& x : block) x = 0x1p-52 * static_cast<double>(generator() >> 11) - 1.0;
  return block;
}

double largest_residual(const std::vector<RitzPair>& pairs, int count) {
  double largest = static_cast<int>(pairs.size()) < count ? HUGE_VAL : 0.0;
  for (int i = 0; i < std::min<int>(count, pairs.size()); ++i) largest = std::max(largest, pairs[i].residual);
  return largest;
}

/// Residuals after each block, to decide when to stop.
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

/// Estimates the errors of the first `count` pairs; uses the distances of all pairs found.
std::vector<RitzPair> finished(std::vector<RitzPair> pairs, int count, bool symmetric) {
  for (RitzPair& pair : pairs) {
    pair.error = pair.residual;
    pair.converged = pair.residual <= stability_limit.largest_standstill;
    if (!symmetric) continue;
    double gap = HUGE_VAL;  // pairs closer than the residuals form one eigenspace, whose values are as accurate
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
  Vector start = start_block(problem.unknowns, width);
  KrylovSpace::Pairs pairs;
  const int longest = problem.blocks > 0 ? problem.blocks : static_cast<int>(stability_limit.longest_space);
  const int most = problem.blocks > 0 ? 2 * problem.blocks : kMostBlocks;
  for (int blocks = 0; blocks < most;) {
    KrylovSpace krylov(problem, std::max(width, wanted), std::move(start));
    Progress progress(problem.tolerance);
    bool ends = false;
    for (int step = 0; !ends && step < longest && blocks < most; ++step, ++blocks) {
      if (!krylov.grow()) break;
      pairs = krylov.ritz_pairs();
      ends = krylov.is_complete() || progress.is_enough(largest_residual(pairs.values, wanted)) ||
             (problem.goes_on && !problem.goes_on(pairs.values));
    }
    start = krylov.vectors(pairs);
    if (ends) break;
  }
  for (size_t k = 0; k < pairs.values.size(); ++k)
    pairs.values[k].vector.assign(&start[k * problem.unknowns], &start[k * problem.unknowns] + problem.unknowns);
  return finished(std::move(pairs.values), wanted, problem.symmetric);
}

}  // namespace mixbeam
