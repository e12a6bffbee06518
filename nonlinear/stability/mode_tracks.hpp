/// Motions of natural modes, followed over a path by their shape.
#pragma once

#include "nonlinear/stability/vibration.hpp"

namespace mixbeam {

/// A mode continues the motion of the state before to which it is most like by the product of their momenta, MAC =
/// |p . q|^2 / (|p|^2 |q|^2), that is the inner product M along the axes of the sections: the shape counts, not the
/// place in the order of frequencies. Modes that share a frequency are any vectors of their common space, which is
/// compared as a whole. A mode that is like none of them takes up a motion that was not among those asked for since.
class ModeTracks {
 public:
  /// `tracks`: numbers that an earlier part of the path has given.
  explicit ModeTracks(int tracks = 0) : tracks_(tracks) {}

  /// Numbers, from 1 on, of the motions of the modes about the next state, whose momenta are taken. `known`: those that
  /// these modes have got already (below 1: not known); empty: none.
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
  std::vector<Motion> absent_{};  ///< as they were last, the latest first; no more than there are modes
  int tracks_;                    ///< numbers given so far
};

}  // namespace mixbeam
