/// Largest values of a field along members: of the polynomials of the elements, not of their samples.
#pragma once

#include "discretization/quantities/end_layers.hpp"
#include "discretization/quantities/quantity.hpp"

#include <functional>
#include <vector>

namespace mixbeam {

/// Number computed from the fields at one point of a member (index in the scene of the model). A component of a
/// recorded field is read from the records.
struct FieldAlongMember {
  std::function<double(const PointSample& sample, int member)> at{};
  std::vector<Vector3> MemberSamples::*recorded = nullptr;
  std::size_t component = 0;
};

struct MemberExtreme {
  double value = 0.0;       ///< NaN if no member was requested, or if the field is NaN somewhere
  int member = -1;          ///< where: the first of equal ones
  double arc_length = 0.0;  ///< along that member [length]
  int side = 0;             ///< -1: at the end of an element, 1: at its start, 0: inside
};

/// Requested extreme, and the members along which it is taken (indices in the scene of the model).
struct ExtremeRequest {
  std::vector<int> members{};
  FieldAlongMember field{};
  Take take = Take::largest;  ///< largest, smallest, or largest_size
};

/// Extremes of each field along its members, to 1e-8 of the value if the field is as smooth as the polynomials of its
/// elements. `samples`: those of all members of this rank in a record, which are then not taken anew; null: none.
/// `layers`: of a richer space, whose closed forms count besides the elements, with forces by their spatial components;
/// null: none. Collective.
std::vector<MemberExtreme> extremes_along_members(const Model& model, const State& state,
                                                  const std::vector<ExtremeRequest>& requests,
                                                  const SampledMembers* samples = nullptr,
                                                  const std::vector<EndLayer>* layers = nullptr);

}  // namespace mixbeam
