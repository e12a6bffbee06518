/// Random structures that are nearly perfect: columns, frames, arches, rings, lattices, domes and strips that buckle or
/// snap, with an imperfection that decides to which side. What the following of paths is measured with.
#pragma once

#include "discretization/scene/scene.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace mixbeam {

struct ImperfectStructure {
  Scene scene{};
  std::string family{};       ///< "column", "frame", ...: in turn
  std::string load{};         ///< "force", "moment", "line load", "heat", "motion"
  double imperfection = 0.0;  ///< of the load, or of the length, with its sign
  double estimate = 0.0;      ///< full load over a hand formula of the critical one; two of three exceed 1
};

/// Structure number `number` >= 0 of the series that `seed` begins, in random units: the same on every machine.
ImperfectStructure imperfect_structure(std::uint64_t seed, int number);

}  // namespace mixbeam
