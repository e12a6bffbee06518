/// Natural modes tracked along a path by their shapes.
#pragma once

#include "nonlinear/stability/vibration.hpp"

namespace mixbeam {

/// A mode continues the track of the previous state's mode with the largest MAC of their momenta, |p . q|^2 / (|p|^2
/// |q|^2), that is in the inner product M along the axes of the sections: the shape counts, not the order of
/// frequencies. Modes that share a frequency are arbitrary vectors of their common space, which is compared as a whole.
/// A mode that resembles none of them may resume a track that was absent from the modes computed since.
class ModeTracks {
 public:
  /// `tracks`: number of tracks in an earlier part of the path.
  explicit ModeTracks(int tracks = 0) : tracks_(tracks) {}

  /// Returns the tracks, numbered from 1, of the modes about the next state, whose momenta are moved from. `known`:
  /// tracks that these modes have already (below 1: unknown); empty: none.
  std::vector<int> follow(std::vector<VibrationMode>& modes, const std::vector<int>& known = {});

 private:
  struct Motion {
    int track = 0;
    std::complex<double> squared{};                ///< -s^2
    std::array<std::vector<double>, 2> momenta{};  ///< of unit length
  };
  using Table = std::vector<std::vector<double>>;
  static double likeness(const Motion& a, const Motion& b, bool reversed);
  static Table likenesses(const std::vector<Motion>& now, const std::vector<Motion>& before, bool reversed);
  static void find(const std::vector<Motion>& before, int first, std::vector<Motion>& now, std::vector<int>& place);
  void keep(std::vector<Motion> now);

  std::vector<Motion> before_{};
  std::vector<Motion> absent_{};  ///< absent tracks as they were last, the latest first; at most as many as modes
  int tracks_;                    ///< number of tracks so far
};

}  // namespace mixbeam
