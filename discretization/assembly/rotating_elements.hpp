/// Elements with masses in a frame that turns: what they add to rows, potential and tangents, theory (75).
#pragma once

#include "discretization/constraints/rotating_frame.hpp"
#include "kernels/vibration/vibration.hpp"

namespace mixbeam {

/// Masses at the moment points of the elements of a block: VibratingBlock::mass.
void fill_masses(const Scene& scene, const Mesh& mesh, const Structure& structure, const ElementBlock& block,
                 const KernelView<double**>& mass);

/// On one rank.
class RotatingElements {
 public:
  RotatingElements(const Scene& scene, const Mesh& mesh, const Structure& structure, const FrameSpin& spin);

  const FrameSpin& spin() const { return spin_; }
  /// The frame of a block at some angular velocity.
  FrameViews frame(size_t block, const Vec& spin) const { return {blocks_[block].mass, blocks_[block].place, spin}; }
  /// Force per length on the undeformed structure times the length of its member, where that is largest, at
  /// amplitude 1.
  double largest_force() const { return largest_force_; }
  /// Adds a factor times the rows at an angular velocity to those of elements, scaled as ElementEquations tells.
  void add_rows(const Structure& structure, const State& state, const Vec& spin, double factor,
                const ElementEquations& to) const;
  /// Potential of the elements that this rank owns.
  double energy(const Structure& structure, const State& state, double load_factor) const;

 private:
  FrameSpin spin_;
  std::vector<FrameViews> blocks_{};
  double largest_force_ = 0.0;
};

/// Null without a frame that turns, or without a section that has a mass.
std::unique_ptr<const RotatingElements> rotating_elements(const Scene& scene, const Mesh& mesh,
                                                          const Structure& structure, const FrameSpin& spin);

}  // namespace mixbeam
