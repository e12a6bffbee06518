/// Layers of bending at the ends of stretched members that are too thin for the polynomials of an element: theory (70).
#pragma once

#include "discretization/state/sampling.hpp"

#include <vector>

namespace mixbeam {

/// Layers in the length of an element over its order + 1, up to which one order more at least halves the error in
/// exp(-s / l): ratio of the modified Bessel functions that are the coefficients of the exponential.
inline constexpr double kLayersPerOrder = 2.0;

/// Layer at one end of an element that is longer than its order allows for the thickness sqrt(EI / N), where a member
/// ends or something is attached to it. There the member turns from the direction of its vertex into that of its force.
struct EndLayer {
  int member = 0, element = 0;  ///< in the scene of the model; within the member
  int side = 1;                 ///< of the vertex: 1 at the start of the element, -1 at its end
  int vertex = 0, other = 0;    ///< of the mesh; at the other end of the element
  double thickness = 0.0;       ///< sqrt(EI / N), of the softer axis [length]
  double length = 0.0;          ///< of the element
  PointSample sample{};         ///< at the vertex, in closed form
  Vec3<double> surplus{};       ///< of its moment over that of the polynomial, spatial
  Vec3<double> push{};          ///< force of the element, whose line the layer displaces, on its vertices
  /// False: the formula does not hold (compression, coupled sections, a rotation by more than two radian).
  bool is_known = true;

  double vertex_arc_length() const { return sample.arc_length; }
};

/// Finds the layers of all elements, on every rank. Hinged ends have none: no moment, no layer. `coarse`: the scene
/// whose state this richer one judges; orders count up to one more than there. Collective.
std::vector<EndLayer> end_layers(const Model& model, const State& state, const Scene* coarse = nullptr);

}  // namespace mixbeam
