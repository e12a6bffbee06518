// The part of NetworkSolver that iterates, and what makes rows of supports at an angle and of joints fit for it.
#include "nonlinear/linear/krylov.hpp"
#include "nonlinear/multilevel/block_rows.hpp"
#include "nonlinear/multilevel/network_solver.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Stiffness of a vertex where a support at an angle prescribes its motion, over that of the links there: the error of
/// the preconditioner is the inverse of it.
constexpr double kAlmostRigid = 1e6;
/// GMRES keeps so many vectors, each with what M^-1 makes of it, and then starts anew: 1 GB for a million unknowns.
constexpr int kVectorsOfGmres = 60;
/// Components of axes that differ by less are the same.
constexpr double kSameAxis = 1e-14;

}  // namespace

/// Whether rows that are free stay as they are.
bool NetworkSolver::TurnedRows::keeps(const unsigned char* free) const {
  for (int r = 0; r < kVertexDofs; ++r)
    for (int q = 0; q < kVertexDofs; ++q)
      if (free[r] != 0 && !(std::abs(projection[r][q] - (q == r ? 1.0 : 0.0)) <= kSameAxis)) return false;
  return true;
}

/// A slave of a joint counts as held by the joint alone: iteration finds what that leaves out, some numbers a joint.
void NetworkSolver::find_turned_rows() {
  turned_.clear();
  turned_of_.assign(node_.size(), -1);
  const auto vertices = system_.remaining().vertices();
  const auto note = [&](int vertex) {
    const int v = system_.remaining().place(vertex);
    if (v >= static_cast<int>(vertices.extent(0)) || node_[v] < 0 || turned_of_[v] >= 0) return;
    turned_of_[v] = static_cast<int>(turned_.size());
    turned_.emplace_back();
    turned_.back().vertex = v;
  };
  for (const VertexSupport& support : system_.model().conditions().supports)
    if (support.turns_forces || turns_moment_rows(support)) note(support.vertex);
  for (const VertexJoint& joint : system_.model().conditions().joints) note(joint.slave);
  if (turned_.empty()) return;
  MixedVector rows = system_.model().create_vector();
  const auto unit = rows.vertex();
  for (int q = 0; q < kVertexDofs; ++q) {
    for (size_t i = 0; i < unit.extent(0); ++i) unit(i) = i % kVertexDofs == static_cast<size_t>(q) ? 1.0 : 0.0;
    system_.project_on_free_motions(unit);
    for (TurnedRows& turned : turned_)
      for (int r = 0; r < kVertexDofs; ++r) turned.projection[r][q] = unit(vertex_row(vertices(turned.vertex), r));
  }
  const auto as_it_is = [this](const TurnedRows& turned) { return turned.keeps(&free_[kVertexDofs * turned.vertex]); };
  turned_.erase(std::remove_if(turned_.begin(), turned_.end(), as_it_is), turned_.end());
  turned_of_.assign(node_.size(), -1);
  for (size_t i = 0; i < turned_.size(); ++i) turned_of_[turned_[i].vertex] = static_cast<int>(i);
}

/// The springs of a vertex from what links leave of its rows.
void NetworkSolver::set_springs(TurnedRows& turned, const unsigned char* free, const double* stiffness, size_t width,
                                int own, double* left) {
  double springs[kVertexDofs][kVertexDofs] = {};
  for (int r = 0; r < kVertexDofs; ++r) {
    if (free[r] == 0) continue;
    const double* row = left + width * r + static_cast<size_t>(kVertexDofs) * own;
    const double* projection = turned.projection[r];
    const bool holds = std::all_of(projection, projection + kVertexDofs, [](double p) { return p == 0.0; });
    const double* of_part = stiffness + (r < 3 ? 0 : 3);
    const double rigid = kAlmostRigid * *std::max_element(of_part, of_part + 3);
    for (int q = 0; q < kVertexDofs; ++q) {
      turned.back[q][r] = free[q] == 0 ? 0.0 : (holds ? rigid * row[q] : projection[q]);
      for (int c = 0; c < kVertexDofs; ++c) springs[q][c] += turned.back[q][r] * row[c];
    }
  }
  for (int r = 0; r < kVertexDofs; ++r)
    std::copy_n(springs[r], kVertexDofs, left + width * r + static_cast<size_t>(kVertexDofs) * own);
}

/// Unknowns of rows that are not free, in x, and r_, what they leave of b to the others.
void NetworkSolver::begin_solve(const DofVector& b, DofVector& x) {
  const BlockRows rows(*system_.matrix());
  const auto given = MixedVector::view_of(b);
  const auto found = MixedVector::view_of(x);
  const int nodes = static_cast<int>(vertex_.size());
  // rows that are not free have one unknown each
  for (int v = 0; v < rows.vertices(); ++v)
    for (int r = 0; r < kVertexDofs; ++r) {
      double& value = found(vertex_row(v, r));
      value = 0.0;
      if (free_[vertex_row(v, r)] != 0) continue;
      for (int block = 0; block < rows.blocks(v); ++block)
        if (rows.neighbour(v, block) == v) value = given(vertex_row(v, r)) / rows.row(v, r)[kVertexDofs * block + r];
    }
  const DofVector columns = in_columns(*system_.matrix(), x);
  const KernelView<const double*> known = MixedVector::view_of(columns);
  Kokkos::parallel_for("mixbeam::multilevel::rows", Kokkos::RangePolicy<ExecutionSpace>(0, nodes), [&](int k) {
    const int v = vertex_[k];
    for (int r = 0; r < kVertexDofs; ++r) {
      double sum = 0.0;
      const double* row = rows.row(v, r);
      for (int block = 0; block < rows.blocks(v); ++block)
        for (int c = 0; c < kVertexDofs; ++c)
          sum += row[kVertexDofs * block + c] * known(vertex_row(rows.neighbour(v, block), c));
      z_(kVertexDofs * k + r) = free_[vertex_row(v, r)] != 0 ? given(vertex_row(v, r)) - sum : 0.0;
    }
  });
  turn_rows(z_);
  hierarchy_->finest().scale_rows(z_, r_);
  Kokkos::deep_copy(x_, 0.0);
}

/// x_ to the free rows of x.
void NetworkSolver::end_solve(DofVector& x) {
  const auto found = MixedVector::view_of(x);
  hierarchy_->finest().unscale(x_, z_);
  Kokkos::parallel_for("mixbeam::multilevel::solution", Kokkos::RangePolicy<ExecutionSpace>(0, vertex_.size()),
                       [&](int k) {
                         for (int r = 0; r < kVertexDofs; ++r)
                           if (free_[vertex_row(vertex_[k], r)] != 0)
                             found(vertex_row(vertex_[k], r)) = z_(kVertexDofs * k + r);
                       });
}

/// Rows of the nodes to spatial forces and moments.
void NetworkSolver::turn_rows(const LevelVector& rows) const {
  for (const TurnedRows& turned : turned_) {
    double* here = rows.data() + static_cast<size_t>(kVertexDofs) * node_[turned.vertex];
    double sum[kVertexDofs] = {};
    for (int q = 0; q < kVertexDofs; ++q)
      for (int r = 0; r < kVertexDofs; ++r) sum[q] += turned.back[q][r] * here[r];
    std::copy_n(sum, kVertexDofs, here);
  }
}

/// A^ x with the matrix itself.
void NetworkSolver::multiply(const LevelVector& x, const LevelVector& y) const {
  const Level& finest = hierarchy_->finest();
  const BlockRows rows(*system_.matrix());
  finest.unscale(x, z_);
  finest.complete(z_);
  Kokkos::parallel_for("mixbeam::multilevel::product", Kokkos::RangePolicy<ExecutionSpace>(0, vertex_.size()),
                       [&](int k) {
                         const int v = vertex_[k];
                         double sum[kVertexDofs] = {};
                         for (int block = 0; block < rows.blocks(v); ++block) {
                           const int other = node_[rows.neighbour(v, block)];
                           if (other < 0) continue;
                           const double* from = z_.data() + static_cast<size_t>(kVertexDofs) * other;
                           for (int r = 0; r < kVertexDofs; ++r)
                             for (int c = 0; c < kVertexDofs; ++c)
                               sum[r] += rows.row(v, r)[kVertexDofs * block + c] * from[c];
                         }
                         for (int r = 0; r < kVertexDofs; ++r)
                           q_(kVertexDofs * k + r) = free_[kVertexDofs * v + r] != 0 ? sum[r] : 0.0;
                       });
  turn_rows(q_);
  finest.scale_rows(q_, y);
}

bool NetworkSolver::iterate(const DofVector& b, DofVector& x, double reduction, int most_iterations) {
  PhaseTimer timer(times_, "multilevel: iterations");
  begin_solve(b, x);
  iterations_ = 0;
  const bool converged =
      method_ == Method::gmres ? gmres(reduction, most_iterations) : conjugate_gradients(reduction, most_iterations);
  end_solve(x);
  return converged;
}

struct NetworkSolver::Iteration {
  Hierarchy& hierarchy;

  double dot(const LevelVector& a, const LevelVector& b) const { return hierarchy.finest().dot(a, b); }
  static void add(double s, const LevelVector& b, const LevelVector& a) { multilevel::add(s, b, a); }
  static void extend(const LevelVector& from, double beta, const LevelVector& to) {
    if (beta == 0.0) return Kokkos::deep_copy(to, from);
    double* p = to.data();
    const double* z = from.data();
    multilevel::for_each(to.extent(0), [=](int i) { p[i] = z[i] + beta * p[i]; });
  }
  void multiply(const LevelVector& p, const LevelVector& q) const { hierarchy.finest().apply(p, q); }
  void precondition(const LevelVector& r, const LevelVector& z) const { hierarchy.precondition(r, z); }
};

bool NetworkSolver::conjugate_gradients(double reduction, int most_iterations) {
  const KrylovEnd end = mixbeam::conjugate_gradients(Iteration{*hierarchy_}, x_, r_, z_, p_, q_, reduction,
                                                     [&](int iterations, double /*energy*/, double /*first*/) {
                                                       iterations_ = iterations + 1;
                                                       return iterations < most_iterations;
                                                     });
  if (end == KrylovEnd::negative_curvature)
    throw NegativeCurvature("the tangent has an eigenvalue below zero, the structure is unstable");
  return end == KrylovEnd::converged;
}

/// A vector v with z = M^-1 v: all sums are done to both, and v . z' is the inner product in which A M^-1 is
/// self-adjoint where A is symmetric. Copies share their numbers.
struct NetworkSolver::Column {
  const Level* level;
  LevelVector v, z;

  double inner_product(const Column& other) const { return level->dot(v, other.z); }
  /// this = a x + b this
  void update(double a, const Column& x, double b) const {
    for (const auto& [from, to] : {std::pair(x.v, v), std::pair(x.z, z)}) {
      const double* other = from.data();
      double* mine = to.data();
      multilevel::for_each(to.extent(0), [=](int i) { mine[i] = a * other[i] + b * mine[i]; });
    }
  }
  void scale(double a) const { update(0.0, *this, a); }
  Column clone(bool /*copy_values*/) const {
    return {level, multilevel::numbers(v.extent(0)), multilevel::numbers(z.extent(0))};
  }
};

/// Minimises r . M^-1 r, until it has fallen by reduction^2.
bool NetworkSolver::gmres(double reduction, int most_iterations) {
  const Level& finest = hierarchy_->finest();
  const LevelVector answer("mixbeam::multilevel::vector", r_.extent(0));
  double first = -1.0;
  for (;;) {
    hierarchy_->precondition(r_, z_);
    const double beta = std::sqrt(finest.dot(r_, z_));
    if (first < 0.0) first = beta;
    if (!(beta > reduction * first) || iterations_ >= most_iterations) return beta <= reduction * first;
    std::vector<Column> basis = {Column{&finest, r_, z_}.clone(false)};
    Kokkos::deep_copy(basis[0].v, r_);
    Kokkos::deep_copy(basis[0].z, z_);
    const int most = std::min(kVectorsOfGmres, most_iterations - iterations_);
    const GmresResult found =
        mixbeam::gmres(basis, beta, reduction * first / beta, most, [&](const Column& of, const Column& next) {
          ++iterations_;
          multiply(of.z, next.v);
          hierarchy_->precondition(next.v, next.z);
          return true;
        });
    Kokkos::deep_copy(answer, 0.0);
    for (size_t k = 0; k < found.y.size(); ++k) multilevel::add(found.y[k], basis[k].z, answer);
    multilevel::add(1.0, answer, x_);
    if (found.left <= reduction * first) return true;
    multiply(answer, p_);
    multilevel::add(-1.0, p_, r_);
  }
}

}  // namespace mixbeam
