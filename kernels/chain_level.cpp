#include "kernels/chain_level.hpp"

#include "kernels/chain_elimination.hpp"

namespace mixbeam {

namespace {

constexpr int kDofs = 6;
using Real = Pack<kLanes>;
using Link = LinkMatrix<kDofs, Real>;
using Factors = VertexFactors<kDofs, Real>;
static_assert(Factors::kSize == kVertexFactorSize, "layout of the factors");
using Range = Kokkos::RangePolicy<ExecutionSpace>;

/// Which links the lanes of one step take, and from which end.
struct StepLinks {
  const double* matrix[kLanes];
  int first[kLanes], second[kLanes];  ///< first rows of both ends in the matrix
  Real::Mask rests;                   ///< lanes whose run has ended: they load what is harmless
};

KOKKOS_INLINE_FUNCTION StepLinks step_links(const ChainLevel& level, const LinkMatrices& matrices, int step) {
  StepLinks result;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int code = level.link(step, lane);
    result.rests[lane] = code < 0 ? -1 : 0;
    const int safe = code < 0 ? level.link(step, 0) : code;
    result.matrix[lane] = matrices[safe / 2];
    result.first[lane] = safe % 2 * kDofs;
    result.second[lane] = kDofs - result.first[lane];
  }
  return result;
}

KOKKOS_INLINE_FUNCTION Link load_link(const StepLinks& links) {
  Link m;
  for (int lane = 0; lane < kLanes; ++lane) {
    const double* a = links.matrix[lane];
    const int f = links.first[lane], s = links.second[lane];
    for (int i = 0; i < kDofs; ++i) {
      const double* first_row = a + 12 * (f + i) + f;
      const double* second_row = a + 12 * (s + i);
      for (int j = 0; j <= i; ++j) m.first[triangle(i, j)].v[lane] = first_row[j];
      for (int j = 0; j <= i; ++j) m.second[triangle(i, j)].v[lane] = second_row[s + j];
      for (int j = 0; j < kDofs; ++j) m.coupling[i][j].v[lane] = second_row[f + j];
    }
  }
  return m;
}

KOKKOS_INLINE_FUNCTION void store_link(const Link& m, int lane, double* out) {
  for (int i = 0; i < kDofs; ++i)
    for (int j = 0; j < kDofs; ++j) {
      const int low = i < j ? triangle(j, i) : triangle(i, j);
      out[12 * i + j] = m.first[low][lane];
      out[12 * (kDofs + i) + kDofs + j] = m.second[low][lane];
      out[12 * (kDofs + i) + j] = out[12 * j + kDofs + i] = m.coupling[i][j][lane];
    }
}

/// Lanes at rest keep what they have.
KOKKOS_INLINE_FUNCTION void keep_resting(const Real::Mask& rests, const Link& before, Link& after) {
  const Real* from = before.first;
  Real* to = after.first;
  constexpr int numbers = sizeof(Link) / sizeof(Real);
  for (int i = 0; i < numbers; ++i) to[i] = select(rests, from[i], to[i]);
}

KOKKOS_INLINE_FUNCTION bool any_rests(const Real::Mask& rests) { return any<kLanes>(rests); }

struct CondenseLoop {
  ChainLevel level;
  LinkMatrices matrices;

  KOKKOS_INLINE_FUNCTION void operator()(int pack) const {
    const int begin = level.step_start(pack), end = level.step_start(pack + 1);
    Link chain = load_link(step_links(level, matrices, begin));
    PivotWatch<Real> watch;
    for (int step = begin + 1; step < end; ++step) {
      const StepLinks links = step_links(level, matrices, step);
      auto& factors = *reinterpret_cast<Factors*>(&level.factors(step - pack - 1, 0));
      if (any_rests(links.rests)) {
        const Link before = chain;
        const PivotWatch<Real> seen = watch;
        eliminate_vertex<kDofs>(chain, load_link(links), factors, watch);
        keep_resting(links.rests, before, chain);
        watch.negative = select(links.rests, seen.negative, watch.negative);
        watch.smallest = select(links.rests, seen.smallest, watch.smallest);
      } else {
        eliminate_vertex<kDofs>(chain, load_link(links), factors, watch);
      }
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      const int run = level.run(pack, lane);
      if (run < 0) continue;
      store_link(chain, lane, &matrices.runs(run, 0));
      level.pivots(run, 0) = watch.negative[lane];
      level.pivots(run, 1) = watch.smallest[lane];
    }
  }
};

/// What has arrived at the vertex between two links: the given rows and the shares of the runs on both sides.
struct RowsLoop {
  ChainLevel level;
  int elements;
  KernelView<const double*> rows;
  KernelView<double* [12]> arrived;
  KernelView<double*> x;

  KOKKOS_INLINE_FUNCTION void add_share(int code, bool far_end, double* sum) const {
    const int run = code / 2 - elements;
    if (run < 0) return;
    const bool second = far_end != (code % 2 == 1);
    for (int c = 0; c < kDofs; ++c) sum[c] += arrived(run, (second ? kDofs : 0) + c);
  }
  KOKKOS_INLINE_FUNCTION void operator()(int pack) const {
    const int begin = level.step_start(pack), end = level.step_start(pack + 1);
    Real at_begin[kDofs], passed[kDofs];
    for (int c = 0; c < kDofs; ++c) at_begin[c] = passed[c] = 0.0;
    for (int lane = 0; lane < kLanes; ++lane) {
      double share[kDofs] = {};
      if (level.run(pack, lane) >= 0) add_share(level.link(begin, lane), false, share);
      for (int c = 0; c < kDofs; ++c) at_begin[c].set(lane, share[c]);
    }
    for (int step = begin + 1; step < end; ++step) eliminate(pack, step, at_begin, passed);
    for (int lane = 0; lane < kLanes; ++lane) {
      const int run = level.run(pack, lane);
      if (run < 0) continue;
      double share[kDofs] = {};
      add_share(level.link(begin + level.links(pack, lane) - 1, lane), true, share);
      for (int c = 0; c < kDofs; ++c) {
        arrived(run, c) = at_begin[c][lane];
        arrived(run, kDofs + c) = passed[c][lane] + share[c];
      }
    }
  }
  /// The vertex before link `step`.
  KOKKOS_INLINE_FUNCTION void eliminate(int pack, int step, Real* at_begin, Real* passed) const {
    const auto& factors = *reinterpret_cast<const Factors*>(&level.factors(step - pack - 1, 0));
    Real b[kDofs];
    Real::Mask rests{};
    for (int lane = 0; lane < kLanes; ++lane) {
      double sum[kDofs] = {};
      const int code = level.link(step, lane);
      rests[lane] = code < 0 ? -1 : 0;
      if (code >= 0) {
        const double* given = &rows(static_cast<size_t>(kDofs) * level.vertex(step - 1, lane));
        for (int c = 0; c < kDofs; ++c) sum[c] = given[c];
        add_share(level.link(step - 1, lane), true, sum);
        add_share(code, false, sum);
      }
      for (int c = 0; c < kDofs; ++c) b[c].set(lane, sum[c]);
    }
    for (int c = 0; c < kDofs; ++c) b[c] += passed[c];
    Real before[2 * kDofs];
    for (int c = 0; c < kDofs; ++c) {
      before[c] = at_begin[c];
      before[kDofs + c] = passed[c];
      passed[c] = 0.0;
    }
    pass_on<kDofs>(factors.left, b, at_begin);
    pass_on<kDofs>(factors.right, b, passed);
    for (int c = 0; c < kDofs; ++c) {
      at_begin[c] = select(rests, before[c], at_begin[c]);
      passed[c] = select(rests, before[kDofs + c], passed[c]);
    }
    solve_block<kDofs>(factors.factor, b);
    for (int lane = 0; lane < kLanes; ++lane)
      if (rests[lane] == 0)
        for (int c = 0; c < kDofs; ++c) x(static_cast<size_t>(kDofs) * level.vertex(step - 1, lane) + c) = b[c][lane];
  }
};

struct ExpandLoop {
  ChainLevel level;
  KernelView<double*> x;

  /// Lanes at rest get zeros.
  KOKKOS_INLINE_FUNCTION void load(const int* vertices, Real* out) const {
    for (int lane = 0; lane < kLanes; ++lane)
      for (int c = 0; c < kDofs; ++c)
        out[c].set(lane, vertices[lane] < 0 ? 0.0 : x(static_cast<size_t>(kDofs) * vertices[lane] + c));
  }
  KOKKOS_INLINE_FUNCTION void operator()(int pack) const {
    const int begin = level.step_start(pack), end = level.step_start(pack + 1);
    Real first[kDofs], next[kDofs];
    load(&level.first_vertex(pack, 0), first);
    load(&level.vertex(end - 1, 0), next);
    for (int step = end - 1; step > begin; --step) {
      const auto& factors = *reinterpret_cast<const Factors*>(&level.factors(step - pack - 1, 0));
      Real here[kDofs];
      load(&level.vertex(step - 1, 0), here);
      Real moved[kDofs];
      for (int c = 0; c < kDofs; ++c) moved[c] = here[c];
      follow<kDofs>(factors.left, first, moved);
      follow<kDofs>(factors.right, next, moved);
      for (int lane = 0; lane < kLanes; ++lane) {
        const bool rests = level.link(step, lane) < 0;  // its end, where the lane waits, is known already
        for (int c = 0; c < kDofs; ++c) {
          const double value = rests ? here[c][lane] : moved[c][lane];
          next[c].set(lane, value);
          if (!rests) x(static_cast<size_t>(kDofs) * level.vertex(step - 1, lane) + c) = value;
        }
      }
    }
  }
};

}  // namespace

void condense_runs(const ChainLevel& level, const LinkMatrices& matrices) {
  Kokkos::parallel_for("mixbeam::chains::condense", Range(0, level.packs), CondenseLoop{level, matrices});
}

void condense_rows(const ChainLevel& level, int elements, const KernelView<const double*>& rows,
                   const KernelView<double* [12]>& arrived, const KernelView<double*>& x) {
  Kokkos::parallel_for("mixbeam::chains::condense_rows", Range(0, level.packs),
                       RowsLoop{level, elements, rows, arrived, x});
}

void expand_runs(const ChainLevel& level, const KernelView<double*>& x) {
  Kokkos::parallel_for("mixbeam::chains::expand", Range(0, level.packs), ExpandLoop{level, x});
}

}  // namespace mixbeam
