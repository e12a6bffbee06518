#include "nonlinear/multilevel/hierarchy.hpp"

#include "nonlinear/linear/linear_solver.hpp"

#include <malloc.h>

#include <algorithm>
#include <iterator>
#include <numeric>

namespace mixbeam {

namespace {

/// Modes of an aggregate with smaller eigenvalues are left to the next level; the smoother takes the others. On the
/// first level there is a gap between 0.01 and 0.1. Measured with 2e4 junctions of all kinds and slendernesses: with
/// 0.05 and 0.04 in place of 0.1 and 0.05 cubic lattices need as many iterations, those with a third of the struts
/// removed 36 in place of 30; 0.03 on later levels needs 1 or 2 more.
/// Under compression all motions that shear a lattice soften together; on the first level a raise gains nothing.
constexpr Level::ModeLimit kSoftMode{0.1, 0.0}, kSoftModeLater{0.05, 4.0};
/// A level with so few unknowns is factorised: 12.5 million entries if its matrix is full.
constexpr int kDirectUnknowns = 5000;
/// Coarsening stops at a level that would keep more than this share of the unknowns.
constexpr double kLeastReduction = 0.75;

LevelVector zeros(int count) { return LevelVector("mixbeam::multilevel::vector", count); }

/// Modes of the aggregate that has most.
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
    if (l >= nesting.first.size()) {  // where other ranks have more levels, nodes stay single
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
    if (used_ > 1) fine.round();  // before the links of two levels lie in memory
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
  malloc_trim(0);  // what making spaces has freed lies between what is kept: it would stay until the end of the run
#endif
}

/// By one rank alone, so that results of the same ranks have the same bits.
void Hierarchy::factorize_coarsest() {
  Level& level = *levels_[used_ - 1];
  const bool is_shared = level.halo().has_several_ranks();
  direct_.reset();  // one at a time
  SparseMatrix coarsest = level.matrix();
  if (used_ > 1) level.drop_values();
  if (is_shared) {
    const SharedRows share = level.shares();
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

/// x = A^-1 residual
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
  level.add(v.step, v.x);
  level.subtract_product(v.step, v.residual);
  level.smooth(v.residual, v.x, v.step, v.other, false);
}

}  // namespace mixbeam
