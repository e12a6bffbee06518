/// What acts on a structure, for result files and pictures: each support, joint and load with its place, patterns,
/// wildcards and tables resolved; and the sections of its members.
#pragma once

#include "discretization/mesh/mesh.hpp"
#include "discretization/scene/scene.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// A place on the centerline of a member.
struct PlaceOnMember {
  int member = 0;           ///< in the order of the scene
  double arc_length = 0.0;  ///< from its start [length]
  Vector3 position{};       ///< undeformed
};

template <class Item>
struct PlacedItem {
  Item item{};
  PlaceOnMember place{};
};

/// A line load with its values at kPlacesAlongMember places from start to end of the member, evenly spread.
struct SampledLineLoad {
  DistributedLoad load{};
  int member = 0;
  std::vector<Vector3> force{}, couple{};  ///< (place) spatial, or material where it follows [force / length, force]
};
inline constexpr int kPlacesAlongMember = 9;

/// The same of an eigenstrain, material. [1, radian / length]
struct SampledEigenstrain {
  Eigenstrain eigenstrain{};
  int member = 0;
  std::vector<Vector3> strain{}, curvature{};
};

/// A section along a member, as pictures show it.
struct SampledSection {
  std::string name{};                 ///< of the section, at the start of a taper
  std::vector<SectionShape> shape{};  ///< (place) as of a line load; empty: given by stiffnesses
};

struct Acting {
  std::string units{};  ///< as Scene::units
  std::vector<PlacedItem<Support>> supports{};
  std::vector<PlacedItem<Joint>> joints{};           ///< one for each member that it joins
  std::vector<PlacedItem<PointLoad>> point_loads{};  ///< one that follows is on its member
  std::vector<SampledLineLoad> line_loads{};
  std::vector<SampledEigenstrain> eigenstrains{};
  std::vector<SampledSection> sections{};  ///< all that differ
  std::vector<int> section_of_member{};    ///< place in `sections`
};

/// Of a scene and its mesh. A point lies on the first member there that no joint moves against it.
Acting acting_on(const Scene& scene, const Mesh& mesh);

}  // namespace mixbeam
