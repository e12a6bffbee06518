/// Structure made of parts that do not touch each other: each is measured separately, as if it were alone.
#pragma once

#include "discretization/state/reactions.hpp"
#include "discretization/state/sampling.hpp"

namespace mixbeam {

/// Part of each vertex and element. One rank only: local and global numbers coincide.
struct StructureParts {
  int count = 1;
  std::vector<int> of_vertex{};   ///< (vertex); empty if there is one part
  std::vector<int> of_element{};  ///< (local element); empty likewise
};

/// `part_of_member`: part of each member of the scene, numbered from zero without gaps.
StructureParts structure_parts(const Model& model, const std::vector<int>& part_of_member);

/// Equilibrium check of one part.
struct PartCheck {
  double residual = 0.0;  ///< largest row of the mixed residual over the scales of the part alone
  double force_error = 0.0, moment_error = 0.0;  ///< as in Balance
};

/// Residual and balance of every part.
std::vector<PartCheck> check_parts(const Model& model, const State& state, double load_factor,
                                   const StructureParts& parts);

/// balance() of every part separately, moments about the middle of its own box; `scales`: of each part.
std::vector<Balance> balance_of_parts(const Model& model, const State& state, double load_factor,
                                      const StructureParts& parts, const std::vector<ResidualScales>& scales);

/// strain_energy() of every part.
std::vector<StrainEnergy> strain_energy_of_parts(const Model& model, const State& state, const StructureParts& parts);

}  // namespace mixbeam
