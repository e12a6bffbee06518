/// Fields of one element as polynomials, to and from the numbers of a state.
#pragma once

#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "kernels/element/layout.hpp"

#include <vector>

namespace mixbeam {

struct StrainEnergy;

/// Access to the numbers of a state by vertices and elements of the mesh, in a snapshot or in the share of a rank.
template <class Number>
class StateNumbers {
 public:
  /// `interior_first`: see interior_places(). Both must outlive this.
  template <class Snapshot>
  StateNumbers(Snapshot& state, const std::vector<size_t>& interior_first)
      : arrays_{state.vertex_displacement.data(), state.vertex_rotation.data(), state.element_triad.data(),
                state.interior.data()},
        interior_first_(&interior_first) {}
  StateNumbers(const StateViews& state, const Structure& share)
      : arrays_{state.vertex_displacement.data(), state.vertex_rotation.data(), state.element_triad.data(),
                state.interior.data()},
        share_(&share) {}

  Number* displacement(int vertex) const { return arrays_[0] + 3 * static_cast<size_t>(vertex); }
  Number* rotation(int vertex) const { return arrays_[1] + 4 * static_cast<size_t>(vertex); }
  /// Displacement of an end vertex of a mesh element.
  Number* displacement(const MeshElement& element, int number, int end) const {
    return displacement(share_ == nullptr ? element.vertex[end] : view(number).vertex(end));
  }
  Number* triad(int element) const {
    return arrays_[2] + 4 * static_cast<size_t>(share_ == nullptr ? element : share_->local_element(element));
  }
  Number* interior(int element) const {
    if (share_ == nullptr) return arrays_[3] + (*interior_first_)[element];
    const ElementView of = view(element);
    return arrays_[3] + of.block().unknowns_at()(of.index());
  }

 private:
  ElementView view(int element) const {
    const int local = share_->local_element(element);
    const ElementBlock& block = share_->block_of(local);
    return {*share_, block, local - block.first_element};
  }

  Number* arrays_[4];
  const std::vector<size_t>* interior_first_ = nullptr;
  const Structure* share_ = nullptr;
};

using Coefficients = std::array<Vec, kMaximumOrder + 1>;  ///< of P_0 .. P_k

/// Value of a polynomial at a point with Legendre values P.
Vec value_at(const Coefficients& coefficients, int degree, const double* P);

/// Fields of one element as polynomials. Coefficients beyond its order are zero.
struct ElementPolynomials {
  Vec start{};                     ///< displacement at the start
  Coefficients slope{};            ///< u' = du/ds, degree k - 1
  Quat triad;                      ///< Lambda_lo
  Coefficients psi{};              ///< degree k - 1, [0] = 0
  Coefficients force{}, moment{};  ///< N of degree k - 1 or k, M of degree k
};

/// `start`, `end`: displacements of the ends; `triad` and `interior` as in a StateSnapshot. `length`: of the element.
ElementPolynomials polynomials_of(const Member& member, double length, const double* start, const double* end,
                                  const double* triad, const double* interior);

/// Stores polynomials in the numbers of an element, the inverse except for the vertex displacements. Coefficients
/// beyond the order of the member are dropped.
void store_polynomials(const Member& member, const ElementPolynomials& element, double* triad, double* interior);

/// N at xi in [-1, 1], material, interpolated between its Gauss points.
Vec force_at(const ElementView& element, double xi);
/// Adds the derivative of weight . force_at() with respect to the numbers of the element to its interior rows.
void add_force_derivative(const ElementView& element, double xi, const Vec& weight, double* rows);
/// Force at xi, interpolated in spatial components, which are smoother where the element rotates.
Vec force_through_space_at(const ElementView& element, double xi);

/// Strain energy of one element, see sampling.hpp.
StrainEnergy element_energy(const ElementView& element);

}  // namespace mixbeam
