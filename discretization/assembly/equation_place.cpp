#include "discretization/assembly/equation_place.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

RowKind kind_of_vertex_row(int component, bool fixed) {
  if (component < 3) return fixed ? RowKind::held_displacement : RowKind::vertex_displacement;
  return fixed ? RowKind::held_rotation : RowKind::vertex_rotation;
}

RowKind kind_of_interior_row(const InteriorLayout& layout, int row) {
  if (row < layout.moment(0)) return RowKind::element_force;
  if (row < layout.relative_rotation(1)) return RowKind::element_moment;
  if (row < layout.bubble(1)) return RowKind::element_rotation;
  return row < layout.spin() ? RowKind::element_displacement : RowKind::element_rotation;
}

double scale_of(RowKind kind, const ResidualScales& scales, double h) {
  switch (kind) {
    case RowKind::vertex_displacement:
      return scales.force;
    case RowKind::vertex_rotation:
      return scales.moment;
    case RowKind::element_rotation:
      return scales.element_moment(h);
    case RowKind::held_displacement:
      return scales.length;
    case RowKind::held_rotation:
      return 1.0;
    case RowKind::element_force:
      return scales.element_strain(h);
    case RowKind::element_moment:
      return scales.rotation;
    case RowKind::element_displacement:
      return scales.element_bubble(h);
  }
  return 1.0;
}

namespace {

/// Location of a vertex or element of this rank.
struct Site {
  int member = -1;  ///< -1: no element meets the vertex
  double along = 0.0, element_length = 0.0;
  Vector3 position{};
};

/// Row of the system; sent between ranks as bytes.
struct RowKey {
  bool found = false;
  RowKind kind = RowKind::vertex_displacement;
  int component = 0;
  int vertex = -1, element = -1;  ///< of the mesh
  double size = 0.0;              ///< the larger one wins
  double value = 0.0;             ///< the entry
  Site site{};                    ///< set for the best row
};

const std::string kAxes[] = {"x", "y", "z"};

/// Visits all rows of one rank.
template <class Visit>
void for_each_row(const Model& model, const MixedVector& vector, const Visit& visit) {
  const Structure& structure = model.structure();
  const KernelView<const unsigned char*> fixed = model.fixed_rows();
  const KernelView<const double*> rows = vector.vertex(), interior = vector.interior();
  for (size_t i = 0; i < rows.extent(0); ++i) {
    const int component = static_cast<int>(i % kVertexDofs);
    visit({true, kind_of_vertex_row(component, fixed(i) != 0), component % 3,
           structure.local_vertex_to_global[i / kVertexDofs], -1, 0.0, rows(i)});
  }
  for_each_element(structure, [&](const ElementView& element) {
    const double* row = element.increments_in(interior);
    for (int i = 0; i < element.layout().increments(); ++i)
      visit({true, kind_of_interior_row(element.layout(), i), i % 3, -1, element.mesh_element(), 0.0, row[i]});
  });
}

Site site_of_element(const Mesh& mesh, int number) {
  const MeshElement& element = mesh.elements[number];
  Site site{element.member, 0.0, mesh.element_length(element)};
  site.along = mesh.arc_length(element, 0.0) / mesh.member_of(element).curve.length;
  const Vector3 &a = mesh.vertex_position[element.vertex[0]], &b = mesh.vertex_position[element.vertex[1]];
  for (int i = 0; i < 3; ++i) site.position[i] = 0.5 * (a[i] + b[i]);
  return site;
}

/// Location of a vertex owned by this rank, which has all of its elements.
Site site_of_vertex(const Model& model, int vertex) {
  const Mesh& mesh = model.mesh();
  const Structure& structure = model.structure();
  Site site;
  site.position = mesh.vertex_position[vertex];
  for (int local : structure.elements_in_order) {
    const MeshElement& element = mesh.elements[structure.local_element_to_mesh[local]];
    for (int end = 0; end < 2; ++end) {
      if (element.vertex[end] != vertex) continue;
      site.member = element.member;
      site.along = mesh.arc_length(element, end == 0 ? -1.0 : 1.0) / mesh.member_of(element).curve.length;
      return site;
    }
  }
  return site;
}

/// The key of largest `size` on any rank; of ranks with equal sizes, which all name the same row, the highest.
RowKey best_of_ranks(const Model& model, RowKey mine) {
  if (mine.found)
    mine.site = mine.element >= 0 ? site_of_element(model.mesh(), mine.element) : site_of_vertex(model, mine.vertex);
  const Teuchos::Comm<int>& comm = *model.map()->getComm();
  if (comm.getSize() == 1) return mine;
  const double size = mine.found ? mine.size : -std::numeric_limits<double>::infinity();
  double best = size;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, size, Teuchos::outArg(best));
  int candidate = mine.found && size == best ? comm.getRank() : -1, winner = -1;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, candidate, Teuchos::outArg(winner));
  if (winner < 0) return {};
  RowKey key = mine;
  Teuchos::broadcast(comm, winner, static_cast<int>(sizeof key), reinterpret_cast<char*>(&key));
  return key;
}

EquationPlace place_of(const Model& model, const RowKey& key) {
  EquationPlace place;
  place.kind = key.kind;
  place.component = key.component;
  place.global_vertex = key.vertex;
  place.global_element = key.element;
  place.along = key.site.along;
  place.position = key.site.position;
  if (key.site.member >= 0) place.member = model.scene().members[key.site.member].name;
  if (key.element >= 0) {
    place.element = model.mesh().index_of_element(key.element);
    return place;
  }
  for (const auto& [point, vertex] : model.mesh().vertex_of_point)
    if (vertex == key.vertex && place.point.empty()) place.point = point;
  return place;
}

}  // namespace

std::optional<ResidualPeak> largest_row(const Model& model, const MixedVector& scaled_residual,
                                        const ResidualScales& scales) {
  RowKey largest;
  for_each_row(model, scaled_residual, [&largest](RowKey key) {
    key.size = std::abs(key.value);
    if (std::isfinite(key.size) && key.size > largest.size) largest = key;
  });
  largest = best_of_ranks(model, largest);
  if (!largest.found) return {};
  ResidualPeak peak{place_of(model, largest), largest.size, 0.0};
  peak.value = largest.value * scale_of(peak.place.kind, scales, largest.site.element_length);
  return peak;
}

std::optional<EquationPlace> first_not_finite(const Model& model, const MixedVector& vector, SearchOrder order) {
  // Decides between ranks as well: elements come before vertices, or after them.
  const double behind = model.mesh().vertices() + static_cast<double>(model.mesh().elements.size());
  RowKey first;
  for_each_row(model, vector, [&](RowKey key) {
    if (std::isfinite(key.value)) return;
    const bool is_late = (key.element >= 0) != (order == SearchOrder::elements_first);
    key.size = -(key.element >= 0 ? key.element : key.vertex) - (is_late ? behind : 0.0);
    if (!first.found || key.size > first.size) first = key;
  });
  first = best_of_ranks(model, first);
  return first.found ? std::optional(place_of(model, first)) : std::nullopt;
}

std::optional<EquationPlace> first_tangent_not_finite(const Tangent& tangent) {
  const Model& model = tangent.model();
  const bool planar = tangent.is_planar();
  const auto entries_of = [&](int e) -> const double* {
    return planar ? &tangent.planar_elements()(e, 0) : &tangent.elements().condensed_tangent(e, 0);
  };
  const size_t entries = planar ? size_t{kPlanarTangent} : tangent.elements().condensed_tangent.extent(1);
  RowKey first;
  for (int e = 0; e < model.structure().local_elements() && !first.found; ++e)
    if (!std::all_of(entries_of(e), entries_of(e) + entries, [](double x) { return std::isfinite(x); })) {
      first.found = true;
      first.element = model.structure().local_element_to_mesh[e];
      first.size = -first.element;
    }
  first = best_of_ranks(model, first);
  return first.found ? std::optional(place_of(model, first)) : std::nullopt;
}

EquationPlace place_of_vertex(const Model& model, int global_vertex) {
  RowKey key;
  key.found = model.structure().partition.owns(global_vertex);
  key.vertex = global_vertex;
  return place_of(model, best_of_ranks(model, key));
}

EndAngle largest_end_angle(const Model& model, const EvaluationPoint& point) {
  double mine = 0.0;
  int where = 0;
  for (int e = 0; e < model.structure().local_elements(); ++e)
    if (point.end_angles(e) > mine) {
      mine = point.end_angles(e);
      where = model.structure().local_element_to_mesh[e];
    }
  const auto& comm = *model.map()->getComm();
  const double everywhere = maximum_over_ranks(comm, mine);
  int candidate = mine == everywhere ? where : -1, element = candidate;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, candidate, Teuchos::outArg(element));
  const Mesh& mesh = model.mesh();
  return {everywhere, model.scene().members[mesh.member_of_element(element)].name, mesh.index_of_element(element)};
}

std::vector<EndAngle> end_angles_of_members(const Model& model, const EvaluationPoint& point) {
  const Structure& structure = model.structure();
  const Mesh& mesh = model.mesh();
  const auto& comm = *model.map()->getComm();
  const int members = static_cast<int>(mesh.members.size());
  std::vector<double> angle(members, 0.0), largest(members, 0.0);
  std::vector<int> where(members, 0);
  for (int e = 0; e < structure.local_elements(); ++e) {
    const MeshElement& element = mesh.elements[structure.local_element_to_mesh[e]];
    const double here = point.end_angles(e);
    if (here > angle[element.member]) angle[element.member] = here, where[element.member] = element.index;
  }
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, members, angle.data(), largest.data());
  for (int m = 0; m < members; ++m)
    if (angle[m] < largest[m]) where[m] = -1;
  std::vector<int> element(where);
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, members, where.data(), element.data());
  std::vector<EndAngle> angles(members);
  for (int m = 0; m < members; ++m) angles[m] = {largest[m], model.scene().members[m].name, element[m]};
  return angles;
}

std::string text_of(const EquationPlace& place) {
  if (place.element >= 0)
    return "element " + std::to_string(place.element) + " of member \"" + excerpt(place.member) + "\"";
  if (!place.point.empty()) return "point \"" + excerpt(place.point) + "\"";
  return "member \"" + excerpt(place.member) + "\" at " + rounded(place.along, 4) + " of its length";
}

namespace {

/// Wording for the rows of one kind: for the first component, if it differs, and for the others, followed by axis or
/// number.
struct RowWords {
  const char* others;
  bool by_axis;
  const char* first = nullptr;

  std::string of(int component) const {
    if (component == 0 && first != nullptr) return first;
    return others + (by_axis ? kAxes[component] : std::to_string(component + 1));
  }
};

/// Same order as RowKind.
constexpr RowWords kEquations[] = {
    {"balance of forces, component ", true},
    {"balance of moments, component ", true},
    {"displacement constrained by a support or joint, component ", false},
    {"rotation constrained by a support or joint, component ", false},
    {"constitutive equation of the force, shear ", false, "constitutive equation of the force, axial"},
    {"constitutive equation of the moment, bending ", false, "constitutive equation of the moment, twist"},
    {"balance of moments inside, component ", false},
    {"balance of forces inside, component ", true}};
constexpr RowWords kUnknowns[] = {{"displacement ", true},
                                  {"rotation about ", true},
                                  {"displacement ", true},
                                  {"rotation about ", true},
                                  {"shear force ", false, "axial force"},
                                  {"bending moment ", false, "torque"},
                                  {"rotation inside, component ", false},
                                  {"displacement inside, component ", true}};

}  // namespace

std::string equation_text(const EquationPlace& place) {
  return kEquations[static_cast<int>(place.kind)].of(place.component);
}

std::string unknown_text(const EquationPlace& place) {
  return kUnknowns[static_cast<int>(place.kind)].of(place.component);
}

}  // namespace mixbeam
