#include "nonlinear/multilevel/hierarchy.hpp"

#include "discretization/mesh/row_lists.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

namespace mixbeam {

namespace {

/// Eigenvalues below which modes of an aggregate go to the next level; the smoother damps the others. On the first
/// level there is a gap between 0.01 and 0.1. Measured with 2e4 junctions of all kinds and slendernesses: with 0.05 and
/// 0.04 in place of 0.1 and 0.05 cubic lattices need as many iterations, but those with a third of the struts removed
/// 36 in place of 30; 0.03 on later levels needs 1 or 2 more.
/// Under compression all modes that shear a lattice soften together; on the first level a raise gains nothing.
constexpr Level::ModeLimit kSoftMode{0.1, 0.0}, kSoftModeLater{0.05, 4.0};
/// Unknowns up to which a level is factorised: 2 million entries if its matrix is full. With 5000 the solves of the
/// coarsest level took half of the time of iterations for a cubic lattice of 8,610 struts.
constexpr int kDirectUnknowns = 2000;
/// Share of the unknowns above which the next level is not made.
constexpr double kLeastReduction = 0.75;

// Aggregates: nested groups of neighbouring nodes of a network, on which the coarse spaces are defined.

/// Nodes up to which a level is not coarsened: few enough for a direct solver, however many unknowns a node has.
constexpr int kSmallGraph = 64;
/// Ratio of aggregates to nodes above which the next level does not pay.
constexpr double kLeastCoarsening = 0.5;

/// Rounds of pairing: pairs of pairs of pairs have eight nodes, the size with the least total time. Eigenproblems grow
/// with the cube of this size, the number of levels falls with its logarithm.
constexpr int kRounds = 3;
/// Size below which an aggregate joins a neighbour, and the largest size of both together: for the ends of odd rows
/// beside whole cubes.
constexpr int kLeastSize = 5, kMostSize = 12;
/// Direction that is no lattice direction, nor a combination of those with small integers.
constexpr Vector3 kDirection = {0.7799, 0.5515, 0.2948};
/// Exponent for which twice as many links count more than any direction: squares before rows of four.
constexpr double kWeightPower = 4.0;
/// Weight of a link perpendicular to the direction, added to the squared cosine of the angle to it.
constexpr double kAcross = 0.01;
/// Share of the best neighbour's closeness, if that is taken, down to which another one is as good: the rows of a
/// perturbed lattice have no better ones.
constexpr double kCloseEnough = 0.5;
constexpr double kLeastDistance = 1e-300;  ///< avoids division by zero

/// Builds the graph of nodes. `weights`: (link) number of links that it stands for; empty: all one.
Graph<double> graph_of(int nodes, const LinkEnds& ends, const std::vector<double>& weights) {
  return joined_links<double>(nodes, [&](const auto& add) {
    for (size_t l = 0; l < ends.size(); ++l)
      for (int end = 0; end < 2; ++end) add(ends[l][end], {ends[l][1 - end], weights.empty() ? 1.0 : weights[l]});
  });
}

/// Nodes or groups of them.
struct Groups {
  std::vector<int> of_node;    ///< (node): its group
  std::vector<Vector3> place;  ///< (group): mean place of its nodes
  std::vector<int> size;       ///< (group): its nodes
};

/// Joins groups to pairs, in their order along a direction: each with the neighbour that has the most links; among
/// equals, with the one that closes a square beside another pair, or lies along the direction. In a lattice pairs are
/// therefore parallel and side by side, pairs of pairs squares, and pairs of those cubes. A group whose best neighbours
/// are all taken stays single, like the last one of an odd row. Returns (group): its pair; `count`: number of pairs.
std::vector<int> pairs_of(const Graph<double>& graph, const std::vector<Vector3>& place, int& count) {
  const int n = graph.nodes();
  std::vector<double> along(n);
  for (int v = 0; v < n; ++v) along[v] = vector_algebra::dot(place[v], kDirection);
  std::vector<int> order(n), pair(n, -1), partner(n, -1), squares(n, 0);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return std::tie(along[a], a) < std::tie(along[b], b); });
  const auto for_each_square = [&](int v, const auto& action) {
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
      const int a = graph.neighbour[k], b = partner[a];
      if (b < 0) continue;
      for (int j = graph.start[b]; j < graph.start[b + 1]; ++j)
        if (graph.neighbour[j] != a) action(squares[graph.neighbour[j]]);
    }
  };
  count = 0;
  for (const int v : order) {
    if (pair[v] >= 0) continue;
    for_each_square(v, [](int& number) { ++number; });
    int best = -1;
    double most = 0.0, most_free = 0.0;
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
      const int w = graph.neighbour[k];
      const double cosine =
          (along[w] - along[v]) / std::max(vector_algebra::distance(place[v], place[w]), kLeastDistance);
      const double closeness = std::pow(graph.weight[k], kWeightPower) * (cosine * cosine + kAcross + squares[w]);
      most = std::max(most, closeness);
      if (pair[w] < 0 && closeness > most_free) most_free = closeness, best = w;
    }
    for_each_square(v, [](int& number) { number = 0; });
    pair[v] = count;
    if (most_free >= kCloseEnough * most && best >= 0) {
      pair[best] = count;
      partner[v] = best;
      partner[best] = v;
    }
    ++count;
  }
  return pair;
}

/// Joins small groups to the neighbour with the most links. Returns (group): new number; `count`: number of groups.
std::vector<int> without_small_ones(const Graph<double>& graph, std::vector<int> size, int& count) {
  const int n = graph.nodes();
  std::vector<int> joined(n), number(n, -1);
  std::iota(joined.begin(), joined.end(), 0);
  const auto root = [&joined](int v) {
    while (joined[v] != v) v = joined[v];
    return v;
  };
  for (int v = 0; v < n; ++v) {
    if (size[v] >= kLeastSize) continue;  // includes groups that have joined it
    int best = -1;
    double most = 0.0;
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k) {
      const int w = root(graph.neighbour[k]);
      if (w == v || size[w] + size[v] > kMostSize || !(graph.weight[k] > most)) continue;
      most = graph.weight[k];
      best = w;
    }
    if (best < 0) continue;
    joined[v] = best;
    size[best] += size[v];
  }
  count = 0;
  for (int v = 0; v < n; ++v)
    if (joined[v] == v) number[v] = count++;
  std::vector<int> group(n);
  for (int v = 0; v < n; ++v) group[v] = number[root(v)];
  return group;
}

/// Contracts the graph to groups of its nodes.
Graph<double> contracted(const Graph<double>& graph, const std::vector<int>& group, int groups) {
  LinkEnds links;
  std::vector<double> weights;
  for (int v = 0; v < graph.nodes(); ++v)
    for (int k = graph.start[v]; k < graph.start[v + 1]; ++k)
      if (group[v] < group[graph.neighbour[k]]) {
        links.push_back({group[v], group[graph.neighbour[k]]});
        weights.push_back(graph.weight[k]);
      }
  return graph_of(groups, links, weights);
}

/// Joins groups to larger ones. `joined`: (group) number of the larger one.
void join(Graph<double>& graph, Groups& groups, const std::vector<int>& joined, int count) {
  graph = contracted(graph, joined, count);
  std::vector<Vector3> place(count, Vector3{});
  std::vector<int> size(count, 0);
  for (size_t g = 0; g < joined.size(); ++g) {
    size[joined[g]] += groups.size[g];
    for (int i = 0; i < 3; ++i) place[joined[g]][i] += groups.size[g] * groups.place[g][i];
  }
  for (int g = 0; g < count; ++g)
    for (double& x : place[g]) x /= size[g];
  groups.place = std::move(place);
  groups.size = std::move(size);
  for (int& g : groups.of_node) g = joined[g];
}

}  // namespace

Nesting nest(const std::vector<Vector3>& places, const LinkEnds& ends) {
  const int nodes = static_cast<int>(places.size());
  std::vector<std::vector<int>> aggregate;  // (level)(node): before anything is renumbered
  std::vector<int> counts = {nodes};
  Graph<double> graph = graph_of(nodes, ends, {});
  Groups groups;
  groups.place = places;
  while (counts.back() > kSmallGraph) {
    groups.of_node.resize(counts.back());
    std::iota(groups.of_node.begin(), groups.of_node.end(), 0);
    groups.size.assign(counts.back(), 1);
    int count = 0;
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<int> pair = pairs_of(graph, groups.place, count);
      join(graph, groups, pair, count);
    }
    const std::vector<int> joined = without_small_ones(graph, groups.size, count);
    join(graph, groups, joined, count);
    if (count > kLeastCoarsening * counts.back()) break;
    aggregate.push_back(groups.of_node);
    counts.push_back(count);
  }
  Nesting nesting;
  nesting.first.resize(aggregate.size());
  std::vector<int> place(counts.back());
  std::iota(place.begin(), place.end(), 0);
  nesting.order = place;
  for (size_t level = aggregate.size(); level-- > 0;) {
    std::vector<int>& first = nesting.first[level];
    first.assign(counts[level + 1] + 1, 0);
    for (int a : aggregate[level]) ++first[place[a] + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<int> next(first.begin(), first.end() - 1), finer(counts[level]);
    for (int v = 0; v < counts[level]; ++v) finer[v] = next[place[aggregate[level][v]]]++;
    place = std::move(finer);
  }
  nesting.order.resize(nodes);
  for (int v = 0; v < nodes; ++v) nesting.order[place[v]] = v;
  return nesting;
}

namespace {

LevelVector zeros(int count) { return LevelVector("mixbeam::multilevel::vector", count); }

/// Largest number of modes of an aggregate.
int widest(const Level::Coarse& coarse) {
  int most = 0;
  for (size_t a = 0; a + 1 < coarse.unknown.size(); ++a)
    most = std::max(most, coarse.unknown[a + 1] - coarse.unknown[a]);
  return most;
}

}  // namespace

Hierarchy::Hierarchy(const std::vector<Vector3>& places, const LinkEnds& ends, Halo halo) {
  const int nodes = static_cast<int>(places.size());
  LinkEnds links;
  std::copy_if(ends.begin(), ends.end(), std::back_inserter(links),
               [nodes](const auto& link) { return link[0] < nodes && link[1] < nodes; });
  Nesting nesting = nest(places, links);
  order_ = nesting.order;
  std::vector<int> place(nodes + halo.ghosts());
  std::iota(place.begin(), place.end(), 0);
  for (int k = 0; k < nodes; ++k) place[order_[k]] = k;
  halo.renumber(place);
  links = ends;
  for (auto& [a, b] : links) a = place[a], b = place[b];
  int count = nodes;
  const auto most = static_cast<size_t>(halo.largest(static_cast<double>(nesting.first.size())));
  for (size_t l = 0; l < most; ++l) {
    if (l >= nesting.first.size()) {  // if other ranks have more levels, nodes here stay single
      nesting.first.emplace_back(count + 1);
      std::iota(nesting.first[l].begin(), nesting.first[l].end(), 0);
    }
    levels_.push_back(std::make_unique<Level>(count, std::move(links), std::move(nesting.first[l]), std::move(halo)));
    links = levels_.back()->coarse_ends();
    count = levels_.back()->aggregates();
    halo = levels_.back()->coarse_halo();
  }
  levels_.push_back(std::make_unique<Level>(count, std::move(links), std::vector<int>(), std::move(halo)));
}

void Hierarchy::set_finest(const NetworkMatrix& matrix) {
  std::vector<int> unknown(levels_[0]->nodes() + levels_[0]->halo().ghosts() + 1);
  for (size_t v = 0; v < unknown.size(); ++v) unknown[v] = 6 * static_cast<int>(v);
  levels_[0]->set(std::move(unknown), matrix.self, matrix.links);
}

void Hierarchy::set(const NetworkMatrix& matrix) {
  set_finest(matrix);
  KernelView<double*> self = matrix.self;
  LinkSource links = matrix.links;
  std::unique_ptr<Level::Coarse> present;
  used_ = 1;
  while (used_ < levels_.size()) {
    Level& fine = *levels_[used_ - 1];
    const Halo& halo = fine.halo();
    const double unknowns = halo.sum(fine.unknowns());
    if (unknowns <= kDirectUnknowns) break;
    auto next = std::make_unique<Level::Coarse>(fine.find_modes(used_ == 1 ? kSoftMode : kSoftModeLater, self, links));
    if (halo.sum(next->unknown[fine.aggregates()]) > kLeastReduction * unknowns ||
        halo.largest(widest(*next)) > Level::kMostModes)
      break;
    if (used_ > 1) fine.round();  // frees memory before the links of two levels exist
    fine.project_links(links, *next);
    self = next->self;
    present = std::move(next);
    links = present->source();
    levels_[used_]->set(present->unknown, self, links);
    fine.set_coarse_scale(*levels_[used_]);
    ++used_;
  }
  for (size_t l = 1; l < used_; ++l) levels_[l]->drop_scale();
  self = {};
  links = nullptr;
  present.reset();
  vectors_.resize(used_);
  for (size_t l = 0; l < used_; ++l)
    if (const int n = levels_[l]->room(); n != static_cast<int>(vectors_[l].x.extent(0)))
      vectors_[l] = {zeros(n), zeros(n), zeros(n), zeros(n)};
  factorize_coarsest();
#ifdef __GLIBC__
  malloc_trim(0);  // memory freed by making spaces is fragmented and would not be returned until the end of the run
#endif
}

/// Factorises on rank 0 alone, so that runs on the same number of ranks have the same bits.
void Hierarchy::factorize_coarsest() {
  Level& level = *levels_[used_ - 1];
  const bool is_shared = level.halo().has_several_ranks();
  direct_.reset();  // frees the old factors first
  SparseMatrix coarsest = level.matrix();
  if (used_ > 1) level.drop_values();
  if (is_shared) {
    const RowsOfRanks share = level.shares();
    coarsest = gathered(coarsest, share);
    coarsest_rows_ = share.rows;
  }
  std::string problem;
  int negative = 0;
  if (!is_shared || coarsest.rows() > 0) try {
      direct_ = std::make_unique<InertiaSolver>(InertiaSolver::Kind::symmetric, coarsest);
      negative = direct_->factorize(coarsest).negative;
      direct_->drop_matrix();
    } catch (const LinearSolverError& error) {
      problem = error.what();
    }
  if (level.halo().largest(problem.empty() ? 0.0 : 1.0) > 0.0)
    throw LinearSolverError("the coarsest matrix has no factors: " + problem);
  if (level.halo().largest(negative) > 0.0) throw NegativeCurvature("the coarsest matrix has negative eigenvalues");
}

/// Solves x = A^-1 residual.
void Hierarchy::solve_coarsest() {
  const Vectors& v = vectors_[used_ - 1];
  const Level& level = *levels_[used_ - 1];
  if (!level.halo().has_several_ranks()) {
    std::copy_n(v.residual.data(), v.residual.extent(0), v.x.data());
    direct_->solve(v.x.data(), 1);
    return;
  }
  const MPI_Comm comm = level.halo().communicator();
  std::vector<double> all(direct_ == nullptr ? 0 : coarsest_rows_.total());
  MPI_Gatherv(v.residual.data(), level.unknowns(), MPI_DOUBLE, all.data(), coarsest_rows_.counts.data(),
              coarsest_rows_.offsets.data(), MPI_DOUBLE, 0, comm);
  if (direct_ != nullptr) direct_->solve(all.data(), 1);
  MPI_Scatterv(all.data(), coarsest_rows_.counts.data(), coarsest_rows_.offsets.data(), MPI_DOUBLE, v.x.data(),
               level.unknowns(), MPI_DOUBLE, 0, comm);
}

void Hierarchy::precondition(const LevelVector& r, const LevelVector& z) {
  Kokkos::deep_copy(vectors_[0].residual, r);
  cycle(0);
  Kokkos::deep_copy(z, vectors_[0].x);
}

void Hierarchy::cycle(size_t l) {
  const Vectors& v = vectors_[l];
  if (l + 1 == used_) return solve_coarsest();
  const Level& level = *levels_[l];
  level.smooth(v.residual, v.x, v.step, v.other, true);
  level.subtract_product(v.step, v.residual);
  level.restrict_to(v.residual, vectors_[l + 1].residual);
  cycle(l + 1);
  level.prolong(vectors_[l + 1].x, v.step);
  multilevel::add(1.0, v.step, v.x);
  level.subtract_product(v.step, v.residual);
  level.smooth(v.residual, v.x, v.step, v.other, false);
}

}  // namespace mixbeam
