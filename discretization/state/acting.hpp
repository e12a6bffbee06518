/// Supports, joints and loads of a structure, for result files and pictures: each at its place, with patterns,
/// wildcards and tables resolved; and the sections of its members.
#pragma once

#include "discretization/mesh/mesh.hpp"
#include "discretization/scene/scene.hpp"

#include <map>
#include <string>
#include <vector>

namespace mixbeam {

/// Table by columns, filled row by row: equally many numbers per row, or lines of a text. Columns: results.md.
struct ActingTable {
  std::string name{};
  std::size_t rows = 0;
  std::map<std::string, std::vector<double>> numbers{};
  std::map<std::string, std::string> lines{};
};

/// Number of equally spaced places along a member, ends included, at which varying quantities are sampled.
inline constexpr int kPlacesAlongMember = 9;

struct Acting {
  std::string units{};                ///< as Scene::units
  std::vector<ActingTable> tables{};  ///< those with rows
};

/// Lists supports, joints, loads and sections. A point is on the first member there that no joint separates from it.
Acting acting_on(const Scene& scene, const Mesh& mesh);

}  // namespace mixbeam
