/// State of a run after a completed step, from which it resumes with bitwise identical results. Plain numbers,
/// independent of ranks and threads.
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace mixbeam {

/// Consecutive rows of a table.
struct RowRun {
  std::size_t first = 0, count = 0;
};

/// Rows of a table held by a rank. Together the ranks of a run hold every row exactly once.
struct RowShare {
  std::size_t rows = 0;        ///< of the whole table
  std::vector<RowRun> runs{};  ///< held here, ascending; adjacent runs are merged

  std::size_t held() const {
    std::size_t sum = 0;
    for (const RowRun& run : runs) sum += run.count;
    return sum;
  }

  /// Appends rows to those already held.
  void hold(std::size_t first, std::size_t count) {
    if (count == 0) return;
    if (!runs.empty() && runs.back().first + runs.back().count == first)
      runs.back().count += count;
    else
      runs.push_back({first, count});
  }
};

/// Share with every row on one rank.
inline RowShare all_rows(std::size_t rows) {
  RowShare share{rows};
  share.hold(0, rows);
  return share;
}

/// Splits rows evenly over the ranks: for tables that every rank knows.
inline RowShare even_share(std::size_t rows, int rank, int ranks) {
  const auto bound = [&](int r) { return rows / ranks * r + rows % ranks * r / ranks; };
  RowShare share{rows};
  share.hold(bound(rank), bound(rank + 1) - bound(rank));
  return share;
}

/// Load factors are sums of rounded steps: two that differ by less than this (relative) are equal.
inline constexpr double kSameLoadFactor = 1e-12;

/// True if the load has reached the end of a stage.
inline bool is_end_of_stage(double load_factor, double end) {
  return std::abs(load_factor - end) <= kSameLoadFactor * end;
}

/// Numbers of a state, bitwise. Vertices and elements in the order of the mesh; quaternions as w, x, y, z.
struct StateSnapshot {
  std::vector<double> vertex_displacement{};  ///< (vertex, 3), spatial
  std::vector<double> vertex_rotation{};      ///< (vertex, 4)
  std::vector<double> element_triad{};        ///< (element, 4)
  std::vector<double> interior{};             ///< unknowns inside each element, element after element
  bool in_plane = false;                      ///< State::in_plane

  bool empty() const { return vertex_rotation.empty(); }
};

/// Rows of the arrays of a state that one rank holds, one after the other.
struct StateShare {
  StateSnapshot held{};
  RowShare vertices{}, elements{}, interior{};

  bool empty() const { return vertices.rows == 0; }
};

/// Share with the whole state on one rank.
inline StateShare whole(StateSnapshot state) {
  const RowShare vertices = all_rows(state.vertex_rotation.size() / 4), interior = all_rows(state.interior.size()),
                 elements = all_rows(state.element_triad.size() / 4);
  return {std::move(state), vertices, elements, interior};
}

/// Position on a load path after a completed step: with the state, it determines all further steps.
struct PathPoint {
  int step = 0;                                 ///< number of the step, 0: the state at the start of the path
  int stage = 1;                                ///< stage of the step, or which it ends
  double load_factor = 0.0;                     ///< of that step
  double step_size = 0.0;                       ///< from the step size control; 0 at the start
  int iterations = 0;                           ///< of the attempt that succeeded
  int attempts_left = 0;                        ///< in this stage
  int failed_steps = 0, newton_iterations = 0;  ///< on the whole path so far
  int critical_points = 0;                      ///< passed on the whole path so far, this step included
  int jumps = 0;                                ///< same, see RecordedJump
  // Only for paths followed by arc length:
  double path_length = 0.0;  ///< of the next step; 0: steps of the load factor
  int direction = 1;         ///< sign of the change of the load factor along the path here
  int negative = -1;         ///< number of negative eigenvalues of the tangent; -1: not counted
  bool branched = false;     ///< the path has left the primary one at a bifurcation
  // Only if loads have formulas, see LoadClock:
  double piece = -1.0;     ///< start of the current piece of the stage; negative: none
  double parameter = 0.0;  ///< of the step within the piece
};

/// Scaled maximum norm of the residual after an iteration (0: before the first one) of an attempt at a step.
struct NewtonIteration {
  int attempt = 0, iteration = 0;
  double residual = 0.0;
};

}  // namespace mixbeam
