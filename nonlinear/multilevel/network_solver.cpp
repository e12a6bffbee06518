#include "nonlinear/multilevel/network_solver.hpp"

#include "discretization/text/number_text.hpp"
#include "nonlinear/linear/blas_setup.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mixbeam {

namespace {

using NetworkRange = Kokkos::RangePolicy<ExecutionSpace>;

/// Where the residual is still too large then: twice the digits.
constexpr double kSmallReduction = 1e-13;
constexpr int kMostIterations = 300;
/// Entries of a block that the links do not explain, relative to the largest one of the row: rounding of sums.
constexpr double kUnexplained = 1e-11;
/// The same, where nothing else helps: 8 GB.
constexpr double kMostFallbackEntries = 1e9;
/// Factors of a network that a separator of s vertices cuts in two hold about 10 (6 s)^2 entries by nested dissection.
constexpr double kEntriesPerSquare = 10.0;

/// Sum of a_i b_i in pieces of fixed length: the same bits for any number of threads.
double dot(const LevelVector& a, const LevelVector& b) {
  constexpr size_t kPiece = 4096;
  const size_t n = a.extent(0), pieces = (n + kPiece - 1) / kPiece;
  std::vector<double> sums(pieces);
  double* to = sums.data();
  const double *x = a.data(), *y = b.data();
  Kokkos::parallel_for(
      "mixbeam::multilevel::dot", NetworkRange(0, pieces), KOKKOS_LAMBDA(size_t k) {
        double sum = 0.0;
        const size_t end = (k + 1) * kPiece < n ? (k + 1) * kPiece : n;
#pragma omp simd reduction(+ : sum)
        for (size_t i = k * kPiece; i < end; ++i) sum += x[i] * y[i];
        to[k] = sum;
      });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// a += s b
void add(double s, const LevelVector& b, const LevelVector& a) {
  double* to = a.data();
  const double* from = b.data();
  multilevel::for_each(a.extent(0), [=](int i) { to[i] += s * from[i]; });
}

/// Neighbours of the vertices that remain, from the rows of the matrix.
struct Rows {
  explicit Rows(const DofMatrix& matrix) : local(matrix.getLocalMatrixHost()) {}
  int vertices() const { return static_cast<int>(local.numRows()) / kVertexDofs; }
  int blocks(int v) const { return static_cast<int>(width(v)) / kVertexDofs; }
  int neighbour(int v, int block) const {
    return local.graph.entries(local.graph.row_map(kVertexDofs * v) + kVertexDofs * block) / kVertexDofs;
  }
  size_t width(int v) const { return local.graph.row_map(kVertexDofs * v + 1) - local.graph.row_map(kVertexDofs * v); }
  /// First entry of a row of a vertex.
  const double* row(int v, int r) const { return &local.values(local.graph.row_map(kVertexDofs * v) + width(v) * r); }

  DofMatrix::local_matrix_host_type local;
};

/// Vertices that lie as far from one end of a network as the middle one, in steps: a separator.
int separator(const Rows& rows) {
  const int n = rows.vertices();
  std::vector<int> queue, distance;
  const auto search = [&](int start) {
    distance.assign(n, -1);
    queue = {start};
    distance[start] = 0;
    for (size_t k = 0; k < queue.size(); ++k)
      for (int b = 0; b < rows.blocks(queue[k]); ++b)
        if (const int w = rows.neighbour(queue[k], b); distance[w] < 0) {
          distance[w] = distance[queue[k]] + 1;
          queue.push_back(w);
        }
  };
  if (n == 0) return 0;
  search(0);
  search(queue.back());
  const int middle = distance[queue[queue.size() / 2]];
  return static_cast<int>(std::count_if(queue.begin(), queue.end(), [&](int v) { return distance[v] == middle; }));
}

double factor_entries(const CondensedSystem& system) {
  const double side = static_cast<double>(kVertexDofs) * separator(Rows(*system.matrix()));
  return kEntriesPerSquare * side * side;
}

}  // namespace

bool is_large_network(const CondensedSystem& system) { return factor_entries(system) > kMostFactorEntries; }

NetworkSolver::NetworkSolver(const CondensedSystem& system, double residual_tolerance, PhaseTimes& times,
                             double reduction)
    : system_(system), tolerance_(residual_tolerance), reduction_(reduction), times_(times) {
  set_up_blas();
}

/// Nodes are vertices with at least one free row; links join two of them.
void NetworkSolver::number_nodes() {
  const Rows rows(*system_.matrix());
  const int n = rows.vertices();
  std::vector<unsigned char> free(static_cast<size_t>(kVertexDofs) * n, 0);
  unsigned char* is_free = free.data();
  Kokkos::parallel_for(
      "mixbeam::multilevel::free_rows", NetworkRange(0, n), KOKKOS_LAMBDA(int v) {
        for (int r = 0; r < kVertexDofs; ++r) {
          const double* row = rows.row(v, r);
          for (int b = 0; b < rows.blocks(v); ++b)
            for (int c = 0; c < kVertexDofs; ++c)
              if (row[kVertexDofs * b + c] != 0.0 && (rows.neighbour(v, b) != v || c != r))
                is_free[kVertexDofs * v + r] = 1;
        }
      });
  if (free == free_) return;
  PhaseTimer timer(times_, "multilevel: aggregates");
  free_ = std::move(free);
  node_.assign(n, -1);
  int nodes = 0;
  for (int v = 0; v < n; ++v)
    if (std::any_of(&free_[kVertexDofs * v], &free_[kVertexDofs * v] + kVertexDofs, [](auto f) { return f != 0; }))
      node_[v] = nodes++;
  std::vector<int> place;  // (local vertex): among those that remain
  const auto vertices = system_.remaining().vertices();
  for (int v = 0; v < n; ++v) {
    if (vertices(v) >= static_cast<int>(place.size())) place.resize(vertices(v) + 1, -1);
    place[vertices(v)] = v;
  }
  LinkEnds ends;
  link_.clear();
  masked_.clear();
  link_vertices_.clear();
  for (const RemainingLink& link : system_.links()) {
    const int a = place[link.vertex[0]], b = place[link.vertex[1]];
    if (node_[a] < 0 || node_[b] < 0 || a == b) continue;
    ends.push_back({node_[a], node_[b]});
    link_.push_back(link.link);
    link_vertices_.push_back({a, b});
    masked_.push_back(0);
    for (int r = 0; r < kVertexDofs; ++r)
      if (free_[kVertexDofs * a + r] == 0 || free_[kVertexDofs * b + r] == 0) masked_.back() = 1;
  }
  hierarchy_ = std::make_unique<Hierarchy>(nodes, ends);
  const std::vector<int>& order = hierarchy_->order();
  std::vector<int> number(nodes);
  for (int k = 0; k < nodes; ++k) number[order[k]] = k;
  vertex_.resize(nodes);
  for (int v = 0; v < n; ++v)
    if (node_[v] >= 0) {
      node_[v] = number[node_[v]];
      vertex_[node_[v]] = v;
    }
  self_ = KernelView<double*>("mixbeam::multilevel::self", static_cast<size_t>(kVertexDofs * kVertexDofs) * nodes);
  for (LevelVector* vector : {&r_, &x_, &z_, &p_, &q_})
    *vector = LevelVector("mixbeam::multilevel::vector", kVertexDofs * nodes);
}

LinkBlocks NetworkSolver::link_blocks(int link, double* room) const {
  constexpr int kBoth = 2 * kVertexDofs;
  const double* matrix = matrices_.full(link_[link], room);
  if (masked_[link] != 0) {
    if (matrix != room) std::copy_n(matrix, kBoth * kBoth, room);
    for (int end = 0; end < 2; ++end)
      for (int r = 0; r < kVertexDofs; ++r)
        if (free_[kVertexDofs * link_vertices_[link][end] + r] == 0)
          for (int c = 0; c < kBoth; ++c)
            room[kBoth * (kVertexDofs * end + r) + c] = room[kBoth * c + kVertexDofs * end + r] = 0.0;
    matrix = room;
  }
  const int second = kBoth * kVertexDofs;
  return {matrix, matrix + second, matrix + second + kVertexDofs, kBoth, kBoth, 1, kBoth};
}

/// What the links do not explain of the rows: S on the diagonal, and nothing beside it.
void NetworkSolver::read_values() {
  matrices_ = system_.link_matrices();
  const Rows rows(*system_.matrix());
  const int n = rows.vertices();
  std::vector<std::vector<std::pair<int, int>>> touching(n);  // link, its end here
  for (size_t l = 0; l < link_.size(); ++l)
    for (int end = 0; end < 2; ++end) touching[link_vertices_[l][end]].push_back({static_cast<int>(l), end});
  std::vector<unsigned char> unfit(n, 0);
  Kokkos::parallel_for("mixbeam::multilevel::self", NetworkRange(0, n), [&](int v) {
    if (node_[v] < 0) return;
    const size_t width = rows.width(v);
    std::vector<double> left(rows.row(v, 0), rows.row(v, 0) + kVertexDofs * width);
    double room[4 * kVertexDofs * kVertexDofs], size[kVertexDofs] = {};
    for (int r = 0; r < kVertexDofs; ++r)
      for (size_t c = 0; c < width; ++c) size[r] = std::max(size[r], std::abs(left[width * r + c]));
    const auto slot = [&](int w) {
      int b = 0;
      while (rows.neighbour(v, b) != w) ++b;
      return b;
    };
    const int own = slot(v);
    for (const auto& [l, end] : touching[v]) {
      const LinkBlocks link = link_blocks(l, room).seen_from(end);
      const int other = slot(link_vertices_[l][1 - end]);
      for (int r = 0; r < kVertexDofs; ++r)
        for (int c = 0; c < kVertexDofs; ++c) {
          left[width * r + kVertexDofs * own + c] -= link.first[link.first_stride * c + r];
          left[width * r + kVertexDofs * other + c] -= link.coupling[link.coupling_row * r + link.coupling_column * c];
        }
    }
    double* self = self_.data() + static_cast<size_t>(kVertexDofs * kVertexDofs) * node_[v];
    for (int r = 0; r < kVertexDofs; ++r)
      for (size_t c = 0; c < width; ++c) {
        const int w = rows.neighbour(v, static_cast<int>(c) / kVertexDofs), k = static_cast<int>(c) % kVertexDofs;
        const bool counts = free_[kVertexDofs * v + r] != 0 && free_[kVertexDofs * w + k] != 0;
        const double value = left[width * r + c];
        if (w == v)
          self[kVertexDofs * k + r] = counts ? value : (k == r ? 1.0 : 0.0);
        else if (counts && !(std::abs(value) <= kUnexplained * size[r]))
          unfit[v] = 1;
      }
    for (int r = 0; r < kVertexDofs; ++r)
      for (int c = 0; c < r; ++c) {
        double &a = self[kVertexDofs * c + r], &b = self[kVertexDofs * r + c];
        if (!(std::abs(a - b) <= kUnexplained * std::max(size[r], size[c]))) unfit[v] = 1;
        a = b = 0.5 * (a + b);
      }
  });
  if (std::find(unfit.begin(), unfit.end(), 1) != unfit.end())
    throw LinearSolverError(
        "joints, supports at an angle, moments or loads that follow make the tangent unsymmetric, and the iterative "
        "solver needs symmetry");
}

void NetworkSolver::factorize() {
  objection_.clear();
  try {
    number_nodes();
    PhaseTimer timer(times_, "multilevel: coarse spaces");
    read_values();
    hierarchy_->set({self_, [this](int link, double* room) { return link_blocks(link, room); }});
  } catch (const std::runtime_error& error) {
    objection_ = error.what();
    factorize_directly();
  }
}

void NetworkSolver::factorize_directly() {
  if (direct_ == nullptr) {
    if (factor_entries(system_) > kMostFallbackEntries) throw LinearSolverError(objection_);
    direct_ = make_direct_solver(system_.matrix(), kSparseSolver, tolerance_, times_);
  }
  direct_->factorize();
}

bool NetworkSolver::iterate(const DofVector& b, DofVector& x, double reduction) {
  const Level& finest = hierarchy_->finest();
  const Rows rows(*system_.matrix());
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
  Kokkos::parallel_for("mixbeam::multilevel::rows", NetworkRange(0, nodes), [&](int k) {
    const int v = vertex_[k];
    for (int r = 0; r < kVertexDofs; ++r) {
      double sum = 0.0;
      const double* row = rows.row(v, r);
      for (int block = 0; block < rows.blocks(v); ++block)
        for (int c = 0; c < kVertexDofs; ++c)
          sum += row[kVertexDofs * block + c] * found(vertex_row(rows.neighbour(v, block), c));
      z_(kVertexDofs * k + r) = free_[vertex_row(v, r)] != 0 ? given(vertex_row(v, r)) - sum : 0.0;
    }
  });
  finest.scale_rows(z_, r_);
  Kokkos::deep_copy(x_, 0.0);
  double energy = 0.0, first = 0.0;
  bool converged = false;
  for (int k = 0; k <= kMostIterations; ++k) {
    hierarchy_->precondition(r_, z_);
    const double last = energy;
    energy = dot(r_, z_);
    if (k == 0) first = energy;
    if (energy <= reduction * reduction * first) {
      converged = energy >= 0.0;
      break;
    }
    if (k == 0)
      Kokkos::deep_copy(p_, z_);
    else {
      const double beta = energy / last;
      double* p = p_.data();
      const double* z = z_.data();
      multilevel::for_each(p_.extent(0), [=](int i) { p[i] = z[i] + beta * p[i]; });
    }
    finest.apply(p_, q_);
    const double curvature = dot(p_, q_);
    if (!(curvature > 0.0)) {
      objection_ = "the tangent has an eigenvalue below zero, the structure is unstable";
      return false;
    }
    ++iterations_;
    add(energy / curvature, p_, x_);
    add(-energy / curvature, q_, r_);
  }
  if (!converged)
    objection_ = "conjugate gradients did not converge in " + std::to_string(kMostIterations) + " iterations";
  finest.unscale(x_, z_);
  Kokkos::parallel_for("mixbeam::multilevel::solution", NetworkRange(0, nodes), [&](int k) {
    for (int r = 0; r < kVertexDofs; ++r)
      if (free_[vertex_row(vertex_[k], r)] != 0) found(vertex_row(vertex_[k], r)) = z_(kVertexDofs * k + r);
  });
  return converged;
}

double NetworkSolver::solve(const DofVector& b, DofVector& x) {
  if (objection_.empty()) {
    iterations_ = 0;
    for (double reduction : {reduction_, kSmallReduction}) {
      {
        PhaseTimer timer(times_, "multilevel: iterations");
        if (!iterate(b, x, reduction)) break;
      }
      const double error = backward_error(*system_.matrix(), x, b);
      if (error <= tolerance_) return error;
    }
    if (objection_.empty()) objection_ = "the iterative solver does not reach the tolerance of the residual";
    factorize_directly();
  }
  return direct_->solve(b, x);
}

std::unique_ptr<TangentSolver> make_tangent_solver(const Model& model, const std::string& method,
                                                   double residual_tolerance) {
  const bool may_iterate = model.map()->getComm()->getSize() == 1 && (method == kAutomatic || method == kIterative);
  if (!may_iterate) return make_direct_tangent_solver(model, method, residual_tolerance);
  return std::make_unique<ChainSolver>(
      model, kSparseSolver, residual_tolerance, [&](const CondensedSystem& system) -> std::unique_ptr<LinearSolver> {
        if (method == kIterative || is_large_network(system))
          return std::make_unique<NetworkSolver>(system, residual_tolerance, model.times());
        return make_direct_solver(system.matrix(), kSparseSolver, residual_tolerance, model.times());
      });
}

}  // namespace mixbeam
