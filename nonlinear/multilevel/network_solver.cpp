#include "nonlinear/multilevel/network_solver.hpp"

#include "nonlinear/linear/blas_setup.hpp"
#include "nonlinear/linear/krylov.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Views the remaining matrix by vertices: rows of a vertex have the same columns, six for each neighbour.
struct BlockRows {
  explicit BlockRows(const DofMatrix& matrix) : local(matrix.getLocalMatrixHost()) {}
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

/// Energy error of the second attempt, if the residual is too large after the first: almost twice the digits.
constexpr double kSmallReduction = 1e-13;
constexpr int kMostIterations = 300;
/// Limit of iterations of GMRES, to which each joint adds some.
constexpr int kMostOfGmres = 1000;
/// Share of the limit of factor entries up to which unsymmetric tangents are factorised without trying GMRES: a cube of
/// 26^3 junctions.
constexpr double kBeforeGmres = 0.1;
/// Growth of the number of iterations at which spaces of an earlier tangent are replaced. (Making spaces costs about
/// as much as 40 iterations.)
constexpr double kMostGrowth = 1.5;
/// Growth at which a solve with such spaces is abandoned and started again with new ones.
constexpr int kGivenUp = 3;

using NetworkRange = Kokkos::RangePolicy<ExecutionSpace>;

/// Entries of a block not due to links that pass for rounding of sums, relative to the largest one of the row.
constexpr double kUnexplained = 1e-11;

/// Stiffness by which the preconditioner replaces a motion prescribed by a support at an angle, over that of the links
/// there: the error of the preconditioner is the inverse of it.
constexpr double kAlmostRigid = 1e6;
/// Vectors v that GMRES keeps, each with M^-1 v, before it restarts: 1 GB for a million unknowns.
constexpr int kVectorsOfGmres = 60;
/// Difference below which components of axes are the same.
constexpr double kSameAxis = 1e-14;

class IteratingSolver final : public NetworkSolver {
 public:
  IteratingSolver(const CondensedSystem& system, double residual_tolerance, PhaseTimes& times, bool has_factors_at_hand,
                  double reduction, double most_fallback_entries)
      : system_(system),
        tolerance_(residual_tolerance),
        reduction_(reduction),
        most_fallback_entries_(most_fallback_entries),
        times_(times),
        has_factors_at_hand_(has_factors_at_hand) {
    set_up_blas();  // LAPACK computes the modes of aggregates
  }

  void factorize() override {
    objection_.clear();
    is_unstable_ = has_solved_ = false;
    method_ = Method::none;
    if (!may_iterate_) return factorize_directly();
    bool is_symmetric = true;
    try {
      number_nodes();
      is_symmetric = read_values();
      if (!is_symmetric)
        refuse("joints, supports at an angle, moments or loads that follow make the tangent unsymmetric", false);
      if (is_symmetric || !prefers_factors()) {
        set_matrix(matrix());
        method_ = is_symmetric ? Method::conjugate_gradients : Method::gmres;
      }
    } catch (const NegativeCurvature& error) {
      refuse(error.what(), is_symmetric);
    } catch (const std::runtime_error& error) {
      refuse(error.what(), false);
    }
    if (method_ == Method::none) factorize_directly();
  }

  double solve(const DofVector& b, DofVector& x, double energy_reduction) override {
    if (method_ == Method::conjugate_gradients || method_ == Method::gmres) {
      try {
        std::string why = "the iterative solver does not reach the tolerance of the residual";
        for (double reduction : {std::max(reduction_, energy_reduction), kSmallReduction}) {
          if (!iterate_with_spaces(b, x, reduction)) {
            why = std::string(method_ == Method::gmres ? "GMRES" : "conjugate gradients") + " did not converge";
            break;
          }
          const double error = backward_error(*system_.matrix(), x, b);
          if (error > std::max(tolerance_, energy_reduction)) continue;
          has_solved_ = true;
          return error;
        }
        refuse(why, false);
      } catch (const NegativeCurvature& error) {
        refuse(error.what(), method_ == Method::conjugate_gradients);
      }
      gmres_fails_ = gmres_fails_ || method_ == Method::gmres;
      method_ = Method::none;
    }
    if (method_ == Method::none) factorize_directly();
    return direct_->solve(b, x);
  }

  bool iterates() const override { return !has_factors_at_hand_; }
  bool tries_iteration() const override { return true; }
  void allow_iteration(bool allowed) override { may_iterate_ = allowed || !has_factors_at_hand_; }
  bool counts_by_solves() const override { return iterates() || method_ == Method::conjugate_gradients; }
  /// Counts by factors if there are any; otherwise 0 or 1 says whether solves with the last matrix met negative
  /// curvature.
  std::optional<long> negative_eigenvalues() override {
    if (method_ == Method::factors) return direct_->negative_eigenvalues();
    if (is_unstable_) return 1;
    return has_solved_ && method_ == Method::conjugate_gradients ? std::optional<long>(0) : std::nullopt;
  }

  void reset_factors() override {
    has_spaces_ = false;
    if (direct_ != nullptr) direct_->reset_factors();
  }

  void adopt_factors_of(Solver& other) override {
    auto* from = dynamic_cast<IteratingSolver*>(&other);
    if (from == nullptr || !from->has_spaces_) return;
    hierarchy_ = std::move(from->hierarchy_);
    ends_ = std::move(from->ends_);
    usual_rate_ = from->usual_rate_;
    has_spaces_ = true;
    free_.clear();
    from->has_spaces_ = false;
    from->free_.clear();
  }

  int iterations() const override { return iterations_; }
  int spaces_made() const override { return spaces_made_; }
  const std::string& objection() const override { return objection_; }

 private:
  /// Numbers the nodes, which are vertices with at least one free row, and finds the links between them.
  void number_nodes() {
    const DofMatrix& matrix = *system_.matrix();
    const std::vector<unsigned char> free = free_rows();
    if (maximum_over_ranks(*matrix.getRowMap()->getComm(), free == free_ ? 0.0 : 1.0) == 0.0) return;
    PhaseTimer timer(times_, "multilevel: aggregates");
    free_ = free;
    const int n = BlockRows(matrix).vertices(), columns = static_cast<int>(free_.size()) / kVertexDofs;
    node_.assign(columns, -1);
    int nodes = 0;
    for (int v = 0; v < n; ++v)
      if (has_free_row(v)) node_[v] = nodes++;
    Halo halo = number_ghosts(nodes);
    LinkEnds ends = find_links();
    const bool is_other = hierarchy_ == nullptr || hierarchy_->finest().nodes() != nodes || ends != ends_;
    if (halo.largest(is_other ? 1.0 : 0.0) > 0.0) {
      has_spaces_ = false;
      std::vector<Vector3> places(nodes);
      const Model& model = system_.model();
      const auto vertices = system_.remaining().vertices();
      for (int v = 0; v < n; ++v)
        if (node_[v] >= 0)
          places[node_[v]] = model.mesh().vertex_position[model.structure().local_vertex_to_global[vertices(v)]];
      hierarchy_ = std::make_unique<Hierarchy>(places, ends, std::move(halo));
      ends_ = std::move(ends);
    }
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
      *vector = LevelVector("mixbeam::multilevel::vector",
                            kVertexDofs * (nodes + static_cast<size_t>(hierarchy_->finest().halo().ghosts())));
  }

  /// Returns (row, then column of other ranks): 1 if its equation couples several unknowns.
  std::vector<unsigned char> free_rows() const {
    const DofMatrix& matrix = *system_.matrix();
    const BlockRows rows(matrix);
    DofVector mine(matrix.getRowMap());
    const KernelView<double*> is_free = MixedVector::view_of(mine);
    Kokkos::parallel_for(
        "mixbeam::multilevel::free_rows", NetworkRange(0, rows.vertices()), KOKKOS_LAMBDA(int v) {
          for (int r = 0; r < kVertexDofs; ++r) {
            const double* row = rows.row(v, r);
            is_free(vertex_row(v, r)) = 0.0;
            for (int b = 0; b < rows.blocks(v); ++b)
              for (int c = 0; c < kVertexDofs; ++c)
                if (row[kVertexDofs * b + c] != 0.0 && (rows.neighbour(v, b) != v || c != r))
                  is_free(vertex_row(v, r)) = 1.0;
          }
        });
    const DofVector columns = in_columns(matrix, mine);
    const KernelView<const double*> all = MixedVector::view_of(columns);
    return {all.data(), all.data() + all.extent(0)};
  }

  bool has_free_row(int vertex) const {
    const unsigned char* first = &free_[kVertexDofs * vertex];
    return std::any_of(first, first + kVertexDofs, [](auto f) { return f != 0; });
  }

  /// Numbers other ranks' vertices in node_, in the order of ranks and of their numbers there.
  Halo number_ghosts(int nodes) {
    const DofMatrix& matrix = *system_.matrix();
    if (matrix.getRowMap()->getComm()->getSize() == 1) return {};
    const MPI_Comm comm = communicator_of(matrix);
    const int first = Halo(comm, nodes, {}).first_of(nodes);
    DofVector mine(matrix.getRowMap());
    const KernelView<double*> number = MixedVector::view_of(mine);
    const int n = BlockRows(matrix).vertices();
    for (int v = 0; v < n; ++v) number(vertex_row(v, 0)) = first + node_[v];
    const DofVector columns = in_columns(matrix, mine);
    const KernelView<const double*> all = MixedVector::view_of(columns);
    std::vector<std::pair<int, int>> ghosts;  // {global number, vertex}
    for (int v = n; v < static_cast<int>(node_.size()); ++v)
      if (has_free_row(v)) ghosts.push_back({static_cast<int>(all(vertex_row(v, 0))), v});
    std::sort(ghosts.begin(), ghosts.end());
    std::vector<int> numbers;
    for (const auto& [ghost, v] : ghosts) {
      node_[v] = nodes + static_cast<int>(numbers.size());
      numbers.push_back(ghost);
    }
    return {comm, nodes, numbers};
  }

  LinkEnds find_links() {
    LinkEnds ends;
    link_.clear();
    masked_.clear();
    link_vertices_.clear();
    for (const RemainingLink& link : system_.links()) {
      const int a = system_.remaining().place(link.vertex[0]), b = system_.remaining().place(link.vertex[1]);
      if (node_[a] < 0 || node_[b] < 0 || a == b) continue;
      ends.push_back({node_[a], node_[b]});
      link_.push_back(link.link);
      link_vertices_.push_back({a, b});
      masked_.push_back(0);
      for (int r = 0; r < kVertexDofs; ++r)
        if (free_[kVertexDofs * a + r] == 0 || free_[kVertexDofs * b + r] == 0) masked_.back() = 1;
    }
    return ends;
  }

  /// Reads the part of the rows that is not due to links: the diagonal blocks S. Returns whether S is symmetric and
  /// there are no other entries.
  bool read_values() {
    matrices_ = system_.link_matrices();
    find_turned_rows();
    const BlockRows rows(*system_.matrix());
    const int n = rows.vertices();
    std::vector<std::vector<std::pair<int, int>>> touching(n);  // {link, its end here}
    for (size_t l = 0; l < link_.size(); ++l)
      for (int end = 0; end < 2; ++end)
        if (const int v = link_vertices_[l][end]; v < n) touching[v].push_back({static_cast<int>(l), end});
    std::vector<unsigned char> unfit(n, 0);
    Kokkos::parallel_for("mixbeam::multilevel::self", NetworkRange(0, n), [&](int v) {
      if (node_[v] < 0) return;
      const size_t width = rows.width(v);
      std::vector<double> left(rows.row(v, 0), rows.row(v, 0) + kVertexDofs * width);
      double room[4 * kVertexDofs * kVertexDofs], size[kVertexDofs] = {};
      TurnedRows* turned = turned_of_[v] < 0 ? nullptr : &turned_[turned_of_[v]];
      for (int r = 0; r < kVertexDofs; ++r)
        for (size_t c = 0; c < width; ++c) size[r] = std::max(size[r], std::abs(left[width * r + c]));
      const auto slot = [&](int w) {
        int b = 0;
        while (rows.neighbour(v, b) != w) ++b;
        return b;
      };
      const int own = slot(v);
      double stiffness[kVertexDofs] = {};
      for (const auto& [l, end] : touching[v]) {
        const LinkBlocks link = link_blocks(l, room).seen_from(end);
        const int other = slot(link_vertices_[l][1 - end]);
        for (int r = 0; r < kVertexDofs; ++r) {
          stiffness[r] += link.first[link.first_stride * r + r];
          for (int q = 0; q < kVertexDofs; ++q) {
            const double part = turned != nullptr ? turned->projection[r][q] : (q == r ? 1.0 : 0.0);
            if (part == 0.0) continue;
            for (int c = 0; c < kVertexDofs; ++c) {
              left[width * r + kVertexDofs * own + c] -= part * link.first[link.first_stride * c + q];
              left[width * r + kVertexDofs * other + c] -=
                  part * link.coupling[link.coupling_row * q + link.coupling_column * c];
            }
          }
        }
      }
      if (turned != nullptr) set_springs(*turned, &free_[kVertexDofs * v], stiffness, width, own, left.data());
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
    const bool is_unfit = !turned_.empty() || std::find(unfit.begin(), unfit.end(), 1) != unfit.end();
    return hierarchy_->finest().halo().largest(is_unfit ? 1.0 : 0.0) == 0.0;
  }

  LinkBlocks link_blocks(int link, double* room) const {
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

  NetworkMatrix matrix() const {
    return {self_, [this](int link, double* room) { return link_blocks(link, room); }};
  }

  /// Sets the matrix; reuses coarse spaces of earlier tangents if there are any.
  void set_matrix(const NetworkMatrix& matrix) {
    if (has_spaces_) {
      PhaseTimer timer(times_, "multilevel: finest level");
      hierarchy_->set_finest(matrix);
      are_fresh_ = false;
    } else
      make_spaces(matrix);
  }

  void make_spaces(const NetworkMatrix& matrix) {
    PhaseTimer timer(times_, "multilevel: coarse spaces");
    has_spaces_ = false;
    hierarchy_->set(matrix);
    has_spaces_ = are_fresh_ = true;
    usual_rate_ = {};
    ++spaces_made_;
  }

  /// Iterates with spaces of an earlier tangent, and with new ones if these take too many iterations.
  bool iterate_with_spaces(const DofVector& b, DofVector& x, double reduction) {
    const double digits = -std::log10(reduction);
    const int most = method_ == Method::gmres ? kMostOfGmres : kMostIterations;
    for (;;) {
      const bool may_begin_anew = !are_fresh_ && usual_rate_ > 0.0;
      const bool converged = iterate(
          b, x, reduction, may_begin_anew ? std::min(most, static_cast<int>(kGivenUp * usual_rate_ * digits)) : most);
      if (converged && usual_rate_ == 0.0) usual_rate_ = iterations_ / digits;
      if (converged && !are_fresh_ && iterations_ > kMostGrowth * usual_rate_ * digits) has_spaces_ = false;
      if (converged || are_fresh_) return converged;
      make_spaces(matrix());
    }
  }

  /// Whether to factorise an unsymmetric tangent. Large ones take twice as long, GMRES as long as conjugate gradients.
  bool prefers_factors() const {
    return direct_ != nullptr ||
           factor_entries(system_) <= (gmres_fails_ ? 1.0 : kBeforeGmres) * most_fallback_entries_;
  }

  void factorize_directly() {
    method_ = Method::none;
    if (direct_ == nullptr) {
      if (factor_entries(system_) > most_fallback_entries_)
        throw LinearSolverError(objection_ + "; the network is too large for factors, which solve such states");
      direct_ = make_direct_solver(system_.matrix(), kSparseSolver, tolerance_, times_);
    }
    direct_->factorize();
    method_ = Method::factors;
  }

  void refuse(const std::string& why, bool is_unstable) {
    objection_ = objection_.empty() ? why : objection_ + "; " + why;
    is_unstable_ = is_unstable;
  }

  struct Iteration {
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

  /// A vector v with z = M^-1 v: operations apply to both, and v . z' is the inner product in which A M^-1 is
  /// self-adjoint if A is symmetric. Copies share their values.
  struct Column {
    const Level* level;
    LevelVector v, z;

    double inner_product(const Column& other) const { return level->dot(v, other.z); }
    /// Sets this = a x + b this.
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

  /// Solves for the unknowns of rows that are not free, in x, and sets r_ to the right-hand side left for the others.
  void begin_solve(const DofVector& b, DofVector& x) {
    const BlockRows rows(*system_.matrix());
    const auto given = MixedVector::view_of(b);
    const auto found = MixedVector::view_of(x);
    const int nodes = static_cast<int>(vertex_.size());
    // Rows that are not free have one unknown each.
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

  /// Unscales x_ into the free rows of x.
  void end_solve(DofVector& x) {
    const auto found = MixedVector::view_of(x);
    hierarchy_->finest().unscale(x_, z_);
    Kokkos::parallel_for("mixbeam::multilevel::solution", Kokkos::RangePolicy<ExecutionSpace>(0, vertex_.size()),
                         [&](int k) {
                           for (int r = 0; r < kVertexDofs; ++r)
                             if (free_[vertex_row(vertex_[k], r)] != 0)
                               found(vertex_row(vertex_[k], r)) = z_(kVertexDofs * k + r);
                         });
  }

  bool iterate(const DofVector& b, DofVector& x, double reduction, int most_iterations) {
    PhaseTimer timer(times_, "multilevel: iterations");
    begin_solve(b, x);
    iterations_ = 0;
    const bool converged =
        method_ == Method::gmres ? gmres(reduction, most_iterations) : conjugate_gradients(reduction, most_iterations);
    end_solve(x);
    return converged;
  }

  bool conjugate_gradients(double reduction, int most_iterations) {
    const KrylovEnd end = mixbeam::conjugate_gradients(Iteration{*hierarchy_}, x_, r_, z_, p_, q_, reduction,
                                                       [&](int iterations, double /*energy*/, double /*first*/) {
                                                         iterations_ = iterations + 1;
                                                         return iterations < most_iterations;
                                                       });
    if (end == KrylovEnd::negative_curvature)
      throw NegativeCurvature("the tangent has an eigenvalue below zero, the structure is unstable");
    return end == KrylovEnd::converged;
  }

  /// Minimises r . M^-1 r until it has fallen by reduction^2.
  bool gmres(double reduction, int most_iterations) {
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

  /// Computes y = A^ x with the unsymmetric matrix itself.
  void multiply(const LevelVector& x, const LevelVector& y) const {
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

  /// Rotates the spatial forces and moments of a vertex to the axes of a support at an angle (`projection`), and rows
  /// back, with stiff springs in place of prescribed motions (`back`).
  struct TurnedRows {
    int vertex = 0;  ///< among the remaining vertices
    double projection[kVertexDofs][kVertexDofs] = {}, back[kVertexDofs][kVertexDofs] = {};
    /// Whether the projection leaves free rows unchanged.
    bool keeps(const unsigned char* free) const {
      for (int r = 0; r < kVertexDofs; ++r)
        for (int q = 0; q < kVertexDofs; ++q)
          if (free[r] != 0 && !(std::abs(projection[r][q] - (q == r ? 1.0 : 0.0)) <= kSameAxis)) return false;
      return true;
    }
  };

  /// Finds vertices with rotated rows. Slaves of joints count as held by the joint alone: the coupling to the master is
  /// left to the iteration, a few dimensions for each joint.
  void find_turned_rows() {
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
    const auto as_it_is = [this](const TurnedRows& turned) {
      return turned.keeps(&free_[kVertexDofs * turned.vertex]);
    };
    turned_.erase(std::remove_if(turned_.begin(), turned_.end(), as_it_is), turned_.end());
    turned_of_.assign(node_.size(), -1);
    for (size_t i = 0; i < turned_.size(); ++i) turned_of_[turned_[i].vertex] = static_cast<int>(i);
  }

  /// Replaces the rest of a vertex's rows, without the links, by springs.
  static void set_springs(TurnedRows& turned, const unsigned char* free, const double* stiffness, size_t width, int own,
                          double* left) {
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

  /// Rotates rows of nodes back to spatial forces and moments.
  void turn_rows(const LevelVector& rows) const {
    for (const TurnedRows& turned : turned_) {
      double* here = rows.data() + static_cast<size_t>(kVertexDofs) * node_[turned.vertex];
      double sum[kVertexDofs] = {};
      for (int q = 0; q < kVertexDofs; ++q)
        for (int r = 0; r < kVertexDofs; ++r) sum[q] += turned.back[q][r] * here[r];
      std::copy_n(sum, kVertexDofs, here);
    }
  }

  const CondensedSystem& system_;
  double tolerance_, reduction_, most_fallback_entries_;
  PhaseTimes& times_;
  std::vector<unsigned char> free_;    ///< (row, then column of other ranks): see free_rows()
  std::vector<int> node_;              ///< (vertex of those): its place in the hierarchy, -1: has no free row
  std::vector<int> vertex_;            ///< (place): its vertex
  std::vector<int> link_;              ///< (link of the network): its number among those of the system
  std::vector<unsigned char> masked_;  ///< (link of the network): 1 if an end has a row that is not free
  std::vector<std::array<int, 2>> link_vertices_;
  LinkMatrices<kVertexDofs> matrices_;
  KernelView<double*> self_;
  LinkEnds ends_;  ///< links for which hierarchy_ was made
  std::unique_ptr<Hierarchy> hierarchy_;
  LevelVector r_, x_, z_, p_, q_;
  std::vector<TurnedRows> turned_;
  std::vector<int> turned_of_;  ///< (remaining vertex): its index in turned_, -1: none
  std::unique_ptr<LinearSolver> direct_;
  std::string objection_;
  enum class Method { none, conjugate_gradients, gmres, factors };
  Method method_ = Method::none;  ///< for the last matrix
  bool is_unstable_ = false, has_solved_ = false;
  bool has_factors_at_hand_, may_iterate_ = true;
  bool gmres_fails_ = false;  ///< GMRES failed for an earlier matrix
  int iterations_ = 0;
  bool has_spaces_ = false;  ///< there are spaces for the next tangent
  bool are_fresh_ = false;   ///< they were made for the present tangent
  double usual_rate_ = 0.0;  ///< iterations per decimal digit in the first solve with them
  int spaces_made_ = 0;
};

/// Entries of factors over (6 s)^2, by nested dissection of a network that a separator of s vertices cuts in two.
constexpr double kEntriesPerSquare = 10.0;
/// Entries of factors per junction above which iteration is faster: cubes from 13 junctions a side on, but no sheets.
constexpr double kLeastEntriesOfJunction = 2800.0;

/// Size of the largest separator of a component: the vertices as many steps from one end as the median vertex.
int separator(const std::vector<int>& start, const std::vector<int>& next) {
  const int n = static_cast<int>(start.size()) - 1;
  std::vector<int> queue, distance(n, -1);
  const auto search = [&](int first) {
    queue = {first};
    distance[first] = 0;
    for (size_t k = 0; k < queue.size(); ++k)
      for (int i = start[queue[k]]; i < start[queue[k] + 1]; ++i)
        if (const int w = next[i]; distance[w] < 0) {
          distance[w] = distance[queue[k]] + 1;
          queue.push_back(w);
        }
  };
  std::ptrdiff_t largest = 0;
  for (int first = 0; first < n; ++first) {
    if (distance[first] >= 0) continue;
    search(first);
    const int end = queue.back();
    for (const int v : queue) distance[v] = -1;
    search(end);
    const int middle = distance[queue[queue.size() / 2]];
    largest =
        std::max(largest, std::count_if(queue.begin(), queue.end(), [&](int v) { return distance[v] == middle; }));
  }
  return static_cast<int>(largest);
}

}  // namespace

std::unique_ptr<NetworkSolver> make_network_solver(const CondensedSystem& system, double residual_tolerance,
                                                   PhaseTimes& times, bool has_factors_at_hand, double reduction,
                                                   double most_fallback_entries) {
  return std::make_unique<IteratingSolver>(system, residual_tolerance, times, has_factors_at_hand, reduction,
                                           most_fallback_entries);
}

double factor_entries(const std::vector<int>& start, const std::vector<int>& next) {
  const double side = static_cast<double>(kVertexDofs) * separator(start, next);
  return kEntriesPerSquare * side * side;
}

double factor_entries(const CondensedSystem& system) {
  const DofMatrix& matrix = *system.matrix();
  const BlockRows rows(matrix);
  SparseMatrix graph{{0}, {}, {}};  // of vertices
  for (int v = 0; v < rows.vertices(); ++v) {
    for (int b = 0; b < rows.blocks(v); ++b) graph.column.push_back(rows.neighbour(v, b));
    graph.row_start.push_back(static_cast<int>(graph.column.size()));
  }
  if (matrix.getRowMap()->getComm()->getSize() == 1) return factor_entries(graph.row_start, graph.column);
  RowsOfRanks share;
  share.communicator = communicator_of(matrix);
  share.rows = GatherPlan(share.communicator, rows.vertices());
  const auto columns = matrix.getColMap();
  for (size_t c = 0; c < columns->getNodeNumElements(); c += kVertexDofs)
    share.column_number.push_back(static_cast<int>(columns->getGlobalElement(static_cast<int>(c)) / kVertexDofs));
  const SparseMatrix all = gathered_structure(graph, share);
  double entries = factor_entries(all.row_start, all.column);  // on rank 0
  MPI_Bcast(&entries, 1, MPI_DOUBLE, 0, share.communicator);
  return entries;
}

bool is_quicker_by_iteration(const CondensedSystem& system, double factor_entries) {
  const double junctions = static_cast<double>(system.matrix()->getGlobalNumRows()) / kVertexDofs;
  return factor_entries >= kLeastEntriesOfJunction * junctions;
}

std::unique_ptr<TangentSolver> make_tangent_solver(const Model& model, const std::string& method,
                                                   double residual_tolerance) {
  if (method != kAutomatic && method != kIterative)
    return make_direct_tangent_solver(model, method, residual_tolerance);
  return std::make_unique<ChainSolver>(
      model, kSparseSolver, residual_tolerance, [&](const CondensedSystem& system) -> std::unique_ptr<LinearSolver> {
        const double entries = method == kIterative ? 2.0 * kMostFactorEntries : factor_entries(system);
        if (entries > kMostFactorEntries || is_quicker_by_iteration(system, entries))
          return make_network_solver(system, residual_tolerance, model.times(), entries <= kMostFactorEntries);
        return make_direct_solver(system.matrix(), kSparseSolver, residual_tolerance, model.times());
      });
}

}  // namespace mixbeam
