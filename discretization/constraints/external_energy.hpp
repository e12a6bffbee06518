/// Energies that act on vertices in addition to the elements and need no constraint rows: loads, springs to the ground.
/// Residual and its scales, tangent, potential, reactions and chains use only this interface, so another energy (an
/// obstacle, a mass in a field) takes a class and a line in external_energies().
#pragma once

#include "discretization/constraints/constraint_rows.hpp"

#include <functional>
#include <memory>
#include <vector>

namespace mixbeam {

/// Energy on one rank, for its own vertices. All quantities are spatial.
class ExternalEnergy {
 public:
  virtual ~ExternalEnergy() = default;

  /// Owned local vertices at which it may add to the tangent; chains keep them.
  virtual std::vector<int> vertices() const = 0;
  /// True if it belongs to the supports: its forces are then reactions, not loads.
  virtual bool is_support() const { return false; }
  /// Calls act(vertex, force and moment on it).
  using Act = std::function<void(int, const SpatialLoad&)>;
  virtual void forces(const State& state, double load_factor, const Act& act) const = 0;
  /// Calls act with their derivatives with respect to the load factor.
  virtual void slopes(const State&, double, const Act&) const {}
  /// Calls act with loads that enter the scales of the residual, theory (40), in any frame.
  virtual void sizes(const State& state, double load_factor, const Act& act) const {
    if (!is_support()) forces(state, load_factor, act);
  }
  /// Adds the derivative of the rows, minus half of the contribution of a moment on the vertex by theory (44).
  virtual void add_tangent(const State& state, double load_factor, const MatrixRows& rows) const = 0;
  /// Energy; zero for moments and loads that rotate with the structure, which have none.
  virtual double energy(const State& state, double load_factor) const = 0;
  /// True if it keeps motion in a plane with this normal.
  virtual bool keeps_in_plane(const Vec& /*normal*/, double /*tolerance*/) const { return false; }

  /// Adds its gradient to the rows (6 * owned vertex + component): the negative of forces and moments on the vertices.
  void add_rows(const State& state, double load_factor, const KernelView<double*>& rows) const;
  /// Adds the derivative of the gradient with respect to the load factor.
  void add_slopes(const State& state, double load_factor, const KernelView<double*>& rows) const;
};

using ExternalEnergies = std::vector<std::unique_ptr<const ExternalEnergy>>;

/// All external energies of a structure.
ExternalEnergies external_energies(const Scene& scene, const Mesh& mesh, const Structure& structure,
                                   const Conditions& conditions, const std::shared_ptr<const LoadClock>& clock);

}  // namespace mixbeam
