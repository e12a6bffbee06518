/// Supports, joints and loads of a structure, for result files and pictures: each with its place, patterns, wildcards
/// and tables resolved; and the sections of its members.
#pragma once

#include "discretization/mesh/mesh.hpp"
#include "discretization/scene/scene.hpp"

#include <map>
#include <string>
#include <vector>

namespace mixbeam {

/// A table by its columns, filled row by row: numbers, as many for each row, or lines of a text. Columns: results.md.
struct ActingTable {
  std::string name{};
  std::size_t rows = 0;
  std::map<std::string, std::vector<double>> numbers{};
  std::map<std::string, std::string> lines{};
};

/// Quantities that vary along a member are sampled at this many places from its start to its end, evenly spread.
inline constexpr int kPlacesAlongMember = 9;

struct Acting {
  std::string units{};                ///< as Scene::units
  std::vector<ActingTable> tables{};  ///< those that have rows
};

/// Lists all that acts in a scene and its mesh. A point lies on the first member there that no joint moves against it.
Acting acting_on(const Scene& scene, const Mesh& mesh);

}  // namespace mixbeam
