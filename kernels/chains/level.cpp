#include "kernels/chains/level.hpp"

#include "kernels/chains/elimination.hpp"

#include <type_traits>

namespace mixbeam {

namespace {

using Real = Pack<kLanes>;
template <int N>
using SymmetricLink = LinkMatrix<N, Real>;
template <int N>
using GeneralLink = GeneralLinkMatrix<N, Real>;
template <int N>
using FreeLink = FreeLinkMatrix<N, Real>;
template <int N, ChainKind kind>
using FullLink = std::conditional_t<kind == ChainKind::general, GeneralLink<N>, SymmetricLink<N>>;
template <int N, ChainKind kind>
using Link = std::conditional_t<kind == ChainKind::free, FreeLink<N>, FullLink<N, kind>>;
template <int N, ChainKind kind>
using Factors =
    std::conditional_t<kind == ChainKind::general, GeneralVertexFactors<N, Real>,
                       std::conditional_t<kind == ChainKind::free, FreeVertexFactors<N, Real>, VertexFactors<N, Real>>>;

/// Factors stored by a step of a pack other than its first.
template <int N, ChainKind kind>
KOKKOS_INLINE_FUNCTION Factors<N, kind>& factors_at(const ChainFactors& factors, int step, int pack) {
  return reinterpret_cast<Factors<N, kind>*>(factors.data())[step - pack - 1];
}
using Range = Kokkos::RangePolicy<ExecutionSpace>;

/// Links that the lanes of one step take, and from which end.
struct StepLinks {
  int link[kLanes];
  bool backward[kLanes];  ///< traversed from the second end
  Real::Mask rests;       ///< lanes whose run has ended: they load the link of lane 0

  KOKKOS_INLINE_FUNCTION StepLinks(const ChainLevel& level, int step) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const int code = level.link(step, lane);
      rests[lane] = code < 0 ? -1 : 0;
      const int safe = code < 0 ? level.link(step, 0) : code;
      link[lane] = safe / 2;
      backward[lane] = safe % 2 == 1;
    }
  }
};

/// Loads full matrices, or their symmetric parts.
template <int N, ChainKind kind>
KOKKOS_INLINE_FUNCTION FullLink<N, kind> load_full(const StepLinks& links, const double* const* matrix) {
  Real numbers[4 * N * N];
  gather_lanes(matrix, 4 * N * N, numbers);
  Real::Mask turned{};
  for (int lane = 0; lane < kLanes; ++lane) turned[lane] = links.backward[lane] ? -1 : 0;
  const bool some_turned = any<kLanes>(turned);
  const auto number = [&](int row, int column, int i, int j) {
    const Real& x = numbers[2 * N * (N * row + i) + N * column + j];
    return some_turned ? select(turned, numbers[2 * N * (N * (1 - row) + i) + N * (1 - column) + j], x) : x;
  };
  const auto entry = [&](int row, int column, int i, int j) {
    const Real x = number(row, column, i, j);
    return kind == ChainKind::symmetric_part ? Real(0.5) * (x + number(column, row, j, i)) : x;
  };
  FullLink<N, kind> m;
#pragma GCC unroll 6
  for (int i = 0; i < N; ++i) {
#pragma GCC unroll 6
    for (int j = 0; j < (kind == ChainKind::general ? N : i + 1); ++j) {
      if constexpr (kind == ChainKind::general) {
        m.first[i][j] = entry(0, 0, i, j);
        m.second[i][j] = entry(1, 1, i, j);
        m.back[i][j] = entry(0, 1, i, j);
      } else {
        m.first[triangle(i, j)] = entry(0, 0, i, j);
        m.second[triangle(i, j)] = entry(1, 1, i, j);
      }
    }
#pragma GCC unroll 6
    for (int j = 0; j < N; ++j) m.coupling[i][j] = entry(1, 0, i, j);
  }
  return m;
}

/// Swaps the ends: u_b - u_a changes sign, the spins are exchanged.
template <int N>
KOKKOS_INLINE_FUNCTION void turn_around(const Real* from, Real* to) {
  using Layout = TangentLayout<N>;
  constexpr int moved = Layout::kMoved, turned = Layout::kTurned;
  const auto counterpart = [](int i) { return i < moved ? i : (i < moved + turned ? i + turned : i - turned); };
#pragma GCC unroll 9
  for (int i = 0; i < Layout::kReduced; ++i)
#pragma GCC unroll 9
    for (int j = 0; j <= i; ++j) {
      const Real& x = from[Layout::place(counterpart(i), counterpart(j))];
      to[triangle(i, j)] = i >= moved && j < moved ? -x : x;
    }
}

template <int N>
KOKKOS_INLINE_FUNCTION FreeLink<N> free_link(const SymmetricLink<N>& full) {
  constexpr int moved = FreeLink<N>::kMoved, turned = FreeLink<N>::kTurned;
  FreeLink<N> m;
  for (int i = 0; i < turned; ++i)
    for (int j = 0; j <= i; ++j) m.first[triangle(i, j)] = full.first[triangle(moved + i, moved + j)];
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < turned; ++j) m.coupling[i][j] = full.coupling[i][moved + j];
  for (int i = 0; i < triangle_size(N); ++i) m.second[i] = full.second[i];
  return m;
}

/// Loads symmetric tangents of elements.
template <int N>
KOKKOS_INLINE_FUNCTION FreeLink<N> load_symmetric(const StepLinks& links, const double* const* numbers) {
  using Layout = TangentLayout<N>;
  Real forward[Layout::kSymmetric];
  gather_lanes(numbers, Layout::kSymmetric, forward);
  bool some_backward = false;
  for (int lane = 0; lane < kLanes; ++lane) some_backward = some_backward || links.backward[lane];
  if (some_backward) {
    Real backward[Layout::kSymmetric];
    turn_around<N>(forward, backward);
    Real::Mask turned{};
    for (int lane = 0; lane < kLanes; ++lane) turned[lane] = links.backward[lane] ? -1 : 0;
    for (int i = 0; i < Layout::kSymmetric; ++i) forward[i] = select(turned, backward[i], forward[i]);
  }
  const auto entry = [&](int i, int j) {
    const Real& x = forward[Layout::place_of_full(i, j)];
    return Layout::is_negative(i, j) ? -x : x;
  };
  constexpr int moved = Layout::kMoved, turned = Layout::kTurned;
  FreeLink<N> m;
  for (int i = 0; i < turned; ++i)
    for (int j = 0; j <= i; ++j) m.first[triangle(i, j)] = entry(moved + i, moved + j);
#pragma GCC unroll 6
  for (int i = 0; i < N; ++i) {
#pragma GCC unroll 6
    for (int j = 0; j <= i; ++j) m.second[triangle(i, j)] = entry(N + i, N + j);
#pragma GCC unroll 6
    for (int j = 0; j < turned; ++j) m.coupling[i][j] = entry(N + i, moved + j);
  }
  return m;
}

template <int N, ChainKind kind>
KOKKOS_INLINE_FUNCTION Link<N, kind> load_link(const LinkMatrices<N>& matrices, const StepLinks& links) {
  const double* rows[kLanes];
  if constexpr (kind == ChainKind::free) {
    bool all_elements = true;
    for (int lane = 0; lane < kLanes; ++lane) all_elements = all_elements && matrices.is_element(links.link[lane]);
    if (all_elements) {
      for (int lane = 0; lane < kLanes; ++lane) rows[lane] = &matrices.elements(links.link[lane], 0);
      return load_symmetric<N>(links, rows);
    }
  }
  double room[kLanes][LinkMatrices<N>::kFull];
  for (int lane = 0; lane < kLanes; ++lane) rows[lane] = matrices.full(links.link[lane], room[lane]);
  if constexpr (kind == ChainKind::free)
    return free_link<N>(load_full<N, ChainKind::symmetric>(links, rows));
  else
    return load_full<N, kind>(links, rows);
}

/// Steps by which tangents and rows are prefetched: lanes read them far apart, where the hardware predicts too late.
constexpr int kStepsAhead = 1;

/// `step`: kStepsAhead further than the loop; it need not exist.
template <int N, ChainKind kind>
KOKKOS_FORCEINLINE_FUNCTION void fetch_links(const ChainLevel& level, const LinkMatrices<N>& matrices, int pack,
                                             int step) {
  if (kind != ChainKind::free || step < level.step_start(pack) || step >= level.step_start(pack + 1)) return;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int link = level.link(step, lane) / 2;
    if (matrices.is_element(link)) fetch<const double>(&matrices.elements(link, 0), TangentLayout<N>::kSymmetric);
  }
}

/// Prefetches the factors stored by `step`, which need not exist.
template <int N, ChainKind kind, class Factors>
KOKKOS_FORCEINLINE_FUNCTION void fetch_factors(const ChainLevel& level, const Factors& factors_of, int pack, int step) {
  if (step <= level.step_start(pack) || step >= level.step_start(pack + 1)) return;
  auto& ahead = factors_at<N, kind>(factors_of, step, pack);
  fetch(reinterpret_cast<double*>(&ahead), sizeof(ahead) / sizeof(double));
}

/// Prefetches the numbers of the vertices before links `step`, which need not exist.
template <int N, class Number>
KOKKOS_FORCEINLINE_FUNCTION void fetch_vertices(const ChainLevel& level, const KernelView<Number*>& numbers, int pack,
                                                int step) {
  if (step <= level.step_start(pack) || step >= level.step_start(pack + 1)) return;
  for (int lane = 0; lane < kLanes; ++lane)
    if (level.vertex(step - 1, lane) >= 0) fetch(&numbers(static_cast<size_t>(N) * level.vertex(step - 1, lane)), N);
}

template <int N>
KOKKOS_INLINE_FUNCTION void store_link(const SymmetricLink<N>& m, int lane, double* out) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      const int low = i < j ? triangle(j, i) : triangle(i, j);
      out[2 * N * i + j] = m.first[low][lane];
      out[2 * N * (N + i) + N + j] = m.second[low][lane];
      out[2 * N * (N + i) + j] = out[2 * N * j + N + i] = m.coupling[i][j][lane];
    }
}

template <int N>
KOKKOS_INLINE_FUNCTION void store_link(const FreeLink<N>& m, int lane, double* out) {
  constexpr int moved = FreeLink<N>::kMoved;
  double numbers[TangentLayout<N>::kSymmetric];  // of (u_b - u_a, theta_a, theta_b)
  const auto put = [&](int i, int j, double x) { numbers[TangentLayout<N>::place(i, j)] = x; };
  const auto at_second = [](int i) { return i < moved ? i : i + FreeLink<N>::kTurned; };
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) put(at_second(i), at_second(j), m.second[triangle(i, j)][lane]);
    for (int j = 0; j < FreeLink<N>::kTurned; ++j) put(at_second(i), moved + j, m.coupling[i][j][lane]);
  }
  for (int i = 0; i < FreeLink<N>::kTurned; ++i)
    for (int j = 0; j <= i; ++j) put(moved + i, moved + j, m.first[triangle(i, j)][lane]);
  expand_symmetric_tangent<N>(numbers, out);
}

template <int N>
KOKKOS_INLINE_FUNCTION void store_link(const GeneralLink<N>& m, int lane, double* out) {
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) {
      out[2 * N * i + j] = m.first[i][j][lane];
      out[2 * N * i + N + j] = m.back[i][j][lane];
      out[2 * N * (N + i) + j] = m.coupling[i][j][lane];
      out[2 * N * (N + i) + N + j] = m.second[i][j][lane];
    }
}

/// Keeps the values of idle lanes.
template <class AnyLink>
KOKKOS_INLINE_FUNCTION void keep_resting(const Real::Mask& rests, const AnyLink& before, AnyLink& after) {
  const Real* from = reinterpret_cast<const Real*>(&before);
  Real* to = reinterpret_cast<Real*>(&after);
  constexpr int numbers = sizeof(AnyLink) / sizeof(Real);
  for (int i = 0; i < numbers; ++i) to[i] = select(rests, from[i], to[i]);
}

/// Sums the rows at the vertex between two links: the given ones and the shares of the runs on both sides.
template <int N, ChainKind kind>
struct RowsLoop {
  ChainLevel level;
  LinkMatrices<N> matrices;
  ChainFactors factors_of;
  KernelView<const double*> rows;
  KernelView<double*> x;
  KernelView<double * [2 * N]> arrived;

  KOKKOS_INLINE_FUNCTION void add_share(int code, bool far_end, double* sum) const {
    const int run = code / 2 - static_cast<int>(matrices.elements.extent(0));
    if (run < 0) return;
    const bool second = far_end != (code % 2 == 1);
    for (int c = 0; c < N; ++c) sum[c] += arrived(run, (second ? N : 0) + c);
  }
  /// Rows that arrive at the starts of runs, and at the vertex before the current link.
  struct Shares {
    Real at_begin[N], passed[N];
  };

  KOKKOS_INLINE_FUNCTION void operator()(int pack) const {
    const int begin = level.step_start(pack), end = level.step_start(pack + 1);
    Shares shares;
    start(pack, shares);
    for (int step = begin + 1; step < end; ++step) {
      fetch_links<N, kind>(level, matrices, pack, step + kStepsAhead);
      fetch_factors<N, kind>(level, factors_of, pack, step + kStepsAhead);
      const auto& factors = factors_at<N, kind>(factors_of, step, pack);
      if constexpr (kind == ChainKind::free) {
        const Link<N, kind> link = load_link<N, kind>(matrices, StepLinks(level, step));
        eliminate(pack, step, factors, &link, shares);
      } else {
        eliminate(pack, step, factors, nullptr, shares);
      }
    }
    finish(pack, shares);
  }
  KOKKOS_INLINE_FUNCTION void start(int pack, Shares& shares) const {
    const int begin = level.step_start(pack);
    for (int c = 0; c < N; ++c) shares.at_begin[c] = shares.passed[c] = 0.0;
    for (int lane = 0; lane < kLanes; ++lane) {
      double share[N] = {};
      if (level.run(pack, lane) >= 0) add_share(level.link(begin, lane), false, share);
      for (int c = 0; c < N; ++c) shares.at_begin[c].set(lane, share[c]);
    }
  }
  KOKKOS_INLINE_FUNCTION void finish(int pack, const Shares& shares) const {
    const int begin = level.step_start(pack);
    for (int lane = 0; lane < kLanes; ++lane) {
      const int run = level.run(pack, lane);
      if (run < 0) continue;
      double share[N] = {};
      add_share(level.link(begin + level.links(pack, lane) - 1, lane), true, share);
      for (int c = 0; c < N; ++c) {
        arrived(run, c) = shares.at_begin[c][lane];
        arrived(run, N + c) = shares.passed[c][lane] + share[c];
      }
    }
  }
  /// Eliminates the vertex before link `step`; free chains need the link. One instance: all callers get the same bits.
  KOKKOS_FUNCTION __attribute__((noinline)) void eliminate(int pack, int step, const Factors<N, kind>& factors,
                                                           const Link<N, kind>* link, Shares& shares) const {
    Real *at_begin = shares.at_begin, *passed = shares.passed;
    fetch_vertices<N>(level, rows, pack, step + kStepsAhead);
    fetch_vertices<N>(level, x, pack, step + kStepsAhead);
    Real b[N];
    Real::Mask rests{};
    for (int lane = 0; lane < kLanes; ++lane) {
      double sum[N] = {};
      const int code = level.link(step, lane);
      rests[lane] = code < 0 ? -1 : 0;
      if (code >= 0) {
        const double* given = &rows(static_cast<size_t>(N) * level.vertex(step - 1, lane));
        for (int c = 0; c < N; ++c) sum[c] = given[c];
        add_share(level.link(step - 1, lane), true, sum);
        add_share(code, false, sum);
      }
      for (int c = 0; c < N; ++c) b[c].set(lane, sum[c]);
    }
    for (int c = 0; c < N; ++c) b[c] += passed[c];
    Real before[2 * N];
    for (int c = 0; c < N; ++c) {
      before[c] = at_begin[c];
      before[N + c] = passed[c];
      passed[c] = 0.0;
    }
    if constexpr (kind == ChainKind::free)
      eliminate_rows<N>(factors, *link, b, at_begin, passed);
    else
      eliminate_rows<N>(factors, b, at_begin, passed);
    for (int c = 0; c < N; ++c) {
      at_begin[c] = select(rests, before[c], at_begin[c]);
      passed[c] = select(rests, before[N + c], passed[c]);
    }
    for (int lane = 0; lane < kLanes; ++lane)
      if (rests[lane] == 0)
        for (int c = 0; c < N; ++c) x(static_cast<size_t>(N) * level.vertex(step - 1, lane) + c) = b[c][lane];
  }
};

template <int N, ChainKind kind>
struct CondenseLoop {
  ChainLevel level;
  LinkMatrices<N> matrices;
  ChainFactors factors_of;
  ChainPivots pivots;
  RowsLoop<N, kind> rows;
  bool has_rows;

  KOKKOS_INLINE_FUNCTION void operator()(int pack) const {
    const int begin = level.step_start(pack), end = level.step_start(pack + 1);
    typename RowsLoop<N, kind>::Shares shares;
    if (has_rows) rows.start(pack, shares);
    Link<N, kind> chain = load_link<N, kind>(matrices, StepLinks(level, begin));
    PivotWatch<Real> watch;
    for (int step = begin + 1; step < end; ++step) {
      const StepLinks links(level, step);
      auto& factors = factors_at<N, kind>(factors_of, step, pack);
      fetch_links<N, kind>(level, matrices, pack, step + kStepsAhead);
      fetch_factors<N, kind>(level, factors_of, pack, step + kStepsAhead);
      const Link<N, kind> link = load_link<N, kind>(matrices, links);
      if (any<kLanes>(links.rests)) {
        const Link<N, kind> before = chain;
        const PivotWatch<Real> seen = watch;
        eliminate_vertex<N>(chain, link, factors, watch);
        keep_resting(links.rests, before, chain);
        watch.negative = select(links.rests, seen.negative, watch.negative);
        watch.smallest = select(links.rests, seen.smallest, watch.smallest);
      } else {
        eliminate_vertex<N>(chain, link, factors, watch);
      }
      if (has_rows) rows.eliminate(pack, step, factors, &link, shares);
    }
    if (has_rows) rows.finish(pack, shares);
    for (int lane = 0; lane < kLanes; ++lane) {
      const int run = level.run(pack, lane);
      if (run < 0) continue;
      store_link<N>(chain, lane, &matrices.runs(run, 0));
      pivots(run, 0) = watch.negative[lane];
      pivots(run, 1) = watch.smallest[lane];
    }
  }
};

template <int N, ChainKind kind>
struct ExpandLoop {
  ChainLevel level;
  LinkMatrices<N> matrices;
  ChainFactors factors_of;
  KernelView<double*> x;

  /// Loads zeros into idle lanes.
  KOKKOS_INLINE_FUNCTION void load(const int* vertices, Real* out) const {
    for (int c = 0; c < N; ++c)
      out[c] = Real::gathered(
          [&](int lane) { return vertices[lane] < 0 ? 0.0 : x(static_cast<size_t>(N) * vertices[lane] + c); });
  }
  KOKKOS_INLINE_FUNCTION void operator()(int pack) const {
    const int begin = level.step_start(pack), end = level.step_start(pack + 1);
    Real first[N], next[N];
    load(&level.first_vertex(pack, 0), first);
    load(&level.vertex(end - 1, 0), next);
    for (int step = end - 1; step > begin; --step) {
      const auto& factors = factors_at<N, kind>(factors_of, step, pack);
      fetch_links<N, kind>(level, matrices, pack, step - kStepsAhead);
      fetch_factors<N, kind>(level, factors_of, pack, step - kStepsAhead);
      fetch_vertices<N>(level, x, pack, step - kStepsAhead);
      Real here[N];
      load(&level.vertex(step - 1, 0), here);
      Real moved[N];
      for (int c = 0; c < N; ++c) moved[c] = here[c];
      if constexpr (kind == ChainKind::free)
        follow_neighbours(factors, load_link<N, kind>(matrices, StepLinks(level, step)), first, next, moved);
      else
        follow_neighbours(factors, first, next, moved);
      for (int lane = 0; lane < kLanes; ++lane) {
        const bool rests = level.link(step, lane) < 0;  // its end vertex is known already
        for (int c = 0; c < N; ++c) {
          const double value = rests ? here[c][lane] : moved[c][lane];
          next[c].set(lane, value);
          if (!rests) x(static_cast<size_t>(N) * level.vertex(step - 1, lane) + c) = value;
        }
      }
    }
  }
};

/// Calls f(std::integral_constant<ChainKind, kind>); a plane has free links only.
template <int N, class F>
void for_kind(ChainKind kind, const F& f) {
  if constexpr (N == kSpatialDofs) {
    if (kind == ChainKind::general) return f(std::integral_constant<ChainKind, ChainKind::general>());
    if (kind == ChainKind::symmetric_part) return f(std::integral_constant<ChainKind, ChainKind::symmetric_part>());
    if (kind == ChainKind::symmetric) return f(std::integral_constant<ChainKind, ChainKind::symmetric>());
  }
  f(std::integral_constant<ChainKind, ChainKind::free>());
}

}  // namespace

template <int N>
void condense_runs(ChainKind kind, const ChainLevel& level, const LinkMatrices<N>& matrices,
                   const ChainFactors& factors, const ChainPivots& pivots, const ChainRows<N>& first) {
  static_assert(FreeVertexFactors<N, Real>::kSize == free_factor_size(N), "layout of the factors");
  static_assert(VertexFactors<N, Real>::kSize == vertex_factor_size(N), "layout of the factors");
  static_assert(GeneralVertexFactors<N, Real>::kSize == general_factor_size(N), "layout of the factors");
  for_kind<N>(kind, [&](auto of) {
    Kokkos::parallel_for(
        "mixbeam::chains::condense", Range(0, level.packs),
        CondenseLoop<N, of()>{level, matrices, factors, pivots,
                              RowsLoop<N, of()>{level, matrices, factors, first.rows, first.x, first.arrived},
                              first.rows.extent(0) > 0});
  });
}

template <int N>
void condense_rows(ChainKind kind, const ChainLevel& level, const LinkMatrices<N>& matrices,
                   const ChainFactors& factors, const ChainRows<N>& rows) {
  for_kind<N>(kind, [&](auto of) {
    Kokkos::parallel_for("mixbeam::chains::condense_rows", Range(0, level.packs),
                         RowsLoop<N, of()>{level, matrices, factors, rows.rows, rows.x, rows.arrived});
  });
}

template <int N>
void expand_runs(ChainKind kind, const ChainLevel& level, const LinkMatrices<N>& matrices, const ChainFactors& factors,
                 const KernelView<double*>& x) {
  for_kind<N>(kind, [&](auto of) {
    Kokkos::parallel_for("mixbeam::chains::expand", Range(0, level.packs),
                         ExpandLoop<N, of()>{level, matrices, factors, x});
  });
}

#define MIXBEAM_CHAINS(N)                                                                                   \
  template void condense_runs<N>(ChainKind, const ChainLevel&, const LinkMatrices<N>&, const ChainFactors&, \
                                 const ChainPivots&, const ChainRows<N>&);                                  \
  template void condense_rows<N>(ChainKind, const ChainLevel&, const LinkMatrices<N>&, const ChainFactors&, \
                                 const ChainRows<N>&);                                                      \
  template void expand_runs<N>(ChainKind, const ChainLevel&, const LinkMatrices<N>&, const ChainFactors&,   \
                               const KernelView<double*>&);
MIXBEAM_CHAINS(kSpatialDofs)
MIXBEAM_CHAINS(kPlanarDofs)
#undef MIXBEAM_CHAINS

}  // namespace mixbeam
