/// Loads and supports as one rank applies them, at any load factor.
#pragma once

#include "discretization/amplitude.hpp"
#include "discretization/structure.hpp"

#include <vector>

namespace mixbeam {

/// Force and moment on one vertex; follower components are stored in the vertex frame (turned back by Lambda_V).
struct VertexLoad {
  int vertex = 0;  ///< owned local vertex
  Vec3<double> force{}, moment{};
  LoadFrame frame = LoadFrame::dead;
  Stage stage = 1;
};

struct VertexSupport {
  int vertex = 0;  ///< owned local vertex
  int index = 0;   ///< in Scene::supports
  bool fixed[6] = {};
  Vec3<double> displacement{}, rotation{};
  bool rotation_prescribed = false;  ///< all three rotations fixed: the triad follows exp(amplitude * rotation)
  Stage stage = 1;
};

struct MemberLoad {
  int member = 0;
  Vector3 force{}, couple{};
  Stage stage = 1;
};

/// Everything that acts on a structure from outside.
struct Conditions {
  std::vector<VertexLoad> loads;
  std::vector<VertexSupport> supports;
  std::vector<MemberLoad> line_loads;  ///< of all members, on every rank
};

Conditions build_conditions(const Scene& scene, const Mesh& mesh, const Structure& structure);

/// Force and moment that a vertex load exerts at a state, spatial.
struct SpatialLoad {
  Vec3<double> force, moment;
};
SpatialLoad spatial_load(const VertexLoad& load, double amplitude, const State& state);

/// Largest prescribed rotation of any support per unit of load factor, in radians (whole scene).
double largest_prescribed_rotation(const Scene& scene);

/// Writes the line loads of all members at a load factor into the structure's views; `slope` writes their derivative
/// instead.
void set_line_loads(const Conditions& conditions, double load_factor, bool slope, const StructureViews& views);

}  // namespace mixbeam
