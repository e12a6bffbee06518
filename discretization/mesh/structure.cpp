#include "discretization/mesh/structure.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "discretization/scene/formula_pieces.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/element/layout.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace mixbeam {

namespace {

SectionConstants section_constants(const Section& section) {
  SectionConstants c{};
  const double force[3] = {section.axial_stiffness, section.shear_stiffness[0], section.shear_stiffness[1]};
  const double moment[3] = {section.torsional_stiffness, section.bending_stiffness[0], section.bending_stiffness[1]};
  for (int i = 0; i < 3; ++i) {
    c.force_compliance[i] = std::isinf(force[i]) ? 0.0 : 1.0 / force[i];
    c.tangent_force_stiffness[i] = force[i];  // a tangent caps it where it is rigid or nearly so
    c.moment_stiffness[i] = moment[i];
    c.moment_compliance[i] = 1.0 / moment[i];
  }
  return c;
}

/// A stiffness this much above the softest counts as rigid: softer ones decide how a structure bends.
constexpr double kStiffnessRange = 1e4;

/// Springs may be softer still without deciding that: they lower the reference at most to this share of that of the
/// sections, with which flexible members keep their true stiffness in the tangent (Cap).
constexpr double kShareBesideSprings = 1e-3;

/// Softest spring of supports and joints as a bending stiffness: moment per angle times length, force per displacement
/// times length cubed. Infinite if there is none.
double softest_spring(const Scene& scene, double length) {
  double softest = std::numeric_limits<double>::infinity();
  const auto note = [&](double stiffness, double unit) {
    if (stiffness > 0.0) softest = std::min(softest, stiffness * unit);
  };
  const double cube = length * length * length;
  for (const Support& support : scene.supports)
    for (int i = 0; i < 3; ++i) {
      note(support.rotation_stiffness[i], length);
      note(support.displacement_stiffness[i], cube);
    }
  for (const Joint& joint : scene.joints) note(joint.stiffness, joint.kind == JointKind::slider ? cube : length);
  return softest;
}

/// Largest finite bending or torsional stiffness that is not rigid relative to the softest; one, in any unit, if all
/// are rigid and nothing bends.
double bending_reference(const Scene& scene, double length) {
  double softest = std::numeric_limits<double>::infinity(), largest = 0.0;
  for (const Section& s : scene.sections)
    for (double value : {s.torsional_stiffness, s.bending_stiffness[0], s.bending_stiffness[1]})
      if (!std::isinf(value)) {
        softest = std::min(softest, value);
        largest = std::max(largest, value);
      }
  if (largest == 0.0) return 1.0;
  const double of_sections = std::min(largest, kStiffnessRange * softest);
  return std::clamp(kStiffnessRange * softest_spring(scene, length), kShareBesideSprings * of_sections, of_sections);
}

/// One 3 x 3 block of the compliance, row-major.
void store_block(const Matrix6& compliance, int first_row, int first_column, double* out) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out[3 * i + j] = compliance[first_row + i][first_column + j];
}

Matrix6 weighted(const Matrix6& a, double weight, const Matrix6& b) {
  Matrix6 sum = a;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) sum[i][j] += weight * b[i][j];
  return sum;
}

/// Largest error of a sum over points, relative to the compliance of an element. Beyond it means replace values: they
/// remain valid where values at points are meaningless, but are less accurate elsewhere.
constexpr double kMissedCompliance = 1e-2;

/// Compliance of a member along one of its elements.
struct ElementCompliance {
  const SectionLaw& law;
  std::function<double(double)> place;  ///< x of xi
  const FormulaPieces* pieces;          ///< null: no formula

  Matrix6 integral(double from, double to) const {
    Matrix6 sum{};
    for (const auto& [x, weight] : pieces->points(from, to)) sum = weighted(sum, weight, law.compliance(x));
    return sum;
  }

  Matrix6 sum(const std::vector<Matrix6>& values, const GaussPoints& rule) const {
    Matrix6 result{};
    for (size_t q = 0; q < values.size(); ++q) result = weighted(result, half() * rule.weight[q], values[q]);
    return result;
  }
  double half() const { return 0.5 * (place(1.0) - place(-1.0)); }

  /// Values at the points of a rule. If their sum misses a narrow taper, uses means over cells around the points, as
  /// long as their weights: means are positive, which a polynomial with the right moments need not be. Then all are
  /// scaled so that the sum equals the integral.
  std::vector<Matrix6> at(const GaussPoints& rule) const {
    std::vector<Matrix6> values;
    for (const double xi : rule.xi) values.push_back(law.compliance(place(xi)));
    if (pieces == nullptr || pieces->points(place(-1.0), place(1.0)).empty()) return values;
    const Matrix6 exact = integral(place(-1.0), place(1.0)), plain = sum(values, rule);
    double missed = 0.0;
    for (int i = 0; i < 6; ++i)
      if (exact[i][i] > 0.0) missed = std::max(missed, std::abs(plain[i][i] / exact[i][i] - 1.0));
    if (missed <= kMissedShare) return values;
    double from = place(-1.0);
    for (size_t q = 0; q < values.size() && missed > kMissedCompliance; ++q) {
      const double cell = half() * rule.weight[q];
      const bool is_smooth = pieces->points(from, from + cell).empty();
      values[q] = is_smooth ? law.compliance(from + 0.5 * cell) : weighted({}, 1.0 / cell, integral(from, from + cell));
      from += cell;
    }
    const Matrix6 now = sum(values, rule);
    for (Matrix6& value : values)
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j)
          if (value[i][j] != 0.0) value[i][j] *= std::sqrt(exact[i][i] / now[i][i] * exact[j][j] / now[j][j]);
    return values;
  }
};

/// Writes the compliances of one element as GeneralSectionLayout.
void fill_element(const GeneralSectionLayout& layout, const ElementCompliance& compliance, double* row) {
  const std::vector<Matrix6> force = compliance.at(gauss_points(layout.force_points));
  for (int q = 0; q < layout.force_points; ++q) {
    store_block(force[q], 0, 0, row + layout.force_force(q));
    store_block(force[q], 0, 3, row + layout.force_moment(q));
  }
  const std::vector<Matrix6> moment = compliance.at(gauss_points(layout.order + 1));
  for (int q = 0; q <= layout.order; ++q) store_block(moment[q], 3, 3, row + layout.moment_moment(q));
}

[[noreturn]] void refuse_member(const Member& member, const std::string& what) {
  throw MemberError(member.name, "", what);
}

MemberLaws member_laws(const Scene& scene) {
  MemberLaws laws(scene.members.size());
  for (size_t m = 0; m < scene.members.size(); ++m) {
    const Member& member = scene.members[m];
    if (!has_general_section(scene, member)) continue;
    if (member.force_integration != ForceIntegration::both_reduced)
      refuse_member(member, "coupled and tapered sections need the force integration \"both reduced\"");
    try {
      laws[m] = std::make_shared<const SectionLaw>(scene, member);
    } catch (const std::invalid_argument& error) {
      refuse_member(member, error.what());
    }
  }
  return laws;
}

void fill_compliance(const Scene& scene, const Mesh& mesh, const MemberLaws& laws, const int* mesh_element,
                     ElementBlock& block) {
  const GeneralSectionLayout layout{block.order, block.interior.force_points};
  block.compliance = KernelView<double**>("mixbeam::compliance", block.count, layout.size());
  std::shared_ptr<const FormulaPieces> pieces;
  for (int e = 0; e < block.count; ++e) {
    const MeshElement& element = mesh.elements[mesh_element[e]];
    if (e == 0 || mesh.elements[mesh_element[e - 1]].member != element.member)
      pieces = pieces_of_taper(scene, scene.members[element.member]);
    const double length = mesh.members[element.member].curve.length;
    const SectionLaw& law = *laws[element.member];
    try {
      const auto place = [&](double xi) { return mesh.arc_length(element, xi) / length; };
      fill_element(layout, {law, place, pieces.get()}, &block.compliance(e, 0));
    } catch (const std::invalid_argument& error) {
      refuse_member(scene.members[element.member], error.what());
    }
  }
}

/// Lowers Structure::least_compliance to the values at the points of coupled and tapered members.
void lower_least_compliance(const ElementBlock& block, std::vector<double>& least) {
  const GeneralSectionLayout layout{block.order, block.interior.force_points};
  for (int e = 0; e < block.count; ++e)
    for (int i = 0; i < 3; ++i) {
      const double* numbers = &block.compliance(e, 0) + 4 * i;  // entry (i, i) of a 3 x 3 block
      double* of_section = &least[static_cast<size_t>(6 * block.section(e) + i)];
      for (int q = 0; q < layout.force_points; ++q)
        of_section[0] = std::min(of_section[0], numbers[layout.force_force(q)]);
      for (int q = 0; q <= layout.order; ++q) of_section[3] = std::min(of_section[3], numbers[layout.moment_moment(q)]);
    }
}

/// Kind of element; elements of one kind share their kernels.
struct BlockKey {
  int order, rule;
  bool general_section;
  bool operator<(const BlockKey& other) const {
    return std::tie(order, rule, general_section) < std::tie(other.order, other.rule, other.general_section);
  }
};

BlockKey block_key(const Scene& scene, const MemberLaws& laws, int member) {
  const Member& m = scene.members[member];
  return {m.order, static_cast<int>(m.force_integration), laws[member] != nullptr};
}

bool is_local(const MeshElement& element, const VertexPartition& partition) {
  return partition.owns(element.vertex[0]) || partition.owns(element.vertex[1]);
}

void number_local_vertices(Structure& structure, const Mesh& mesh) {
  const VertexPartition& partition = structure.partition;
  std::set<int> ghosts;
  for (int e : structure.local_element_to_mesh)
    for (int vertex : mesh.elements[e].vertex)
      if (!partition.owns(vertex)) ghosts.insert(vertex);
  structure.owned_vertices = partition.size();
  for (int v = 0; v < partition.size(); ++v) structure.local_vertex_to_global.push_back(partition.vertex(v));
  structure.local_vertex_to_global.insert(structure.local_vertex_to_global.end(), ghosts.begin(), ghosts.end());
}

int local_vertex(const Structure& structure, int global) {
  if (const int place = structure.partition.place(global); place >= 0) return place;
  const auto ghosts = structure.local_vertex_to_global.begin() + structure.owned_vertices;
  const auto entry = std::lower_bound(ghosts, structure.local_vertex_to_global.end(), global);
  return static_cast<int>(entry - structure.local_vertex_to_global.begin());
}

/// Writes the reference data of one element, see ReferenceLayout.
void fill_reference(const ReferenceElement& element, double length, const ReferenceLayout& layout, double* row) {
  row[layout.length()] = length;
  for (int end = 0; end < 2; ++end) store_quaternion(element.end_triad[end], row + layout.end_triad(end));
  for (int q = 0; q < layout.force_points; ++q) store_vector(element.tangent[q], row + layout.tangent(q));
  for (int q = 0; q <= layout.order; ++q) store_vector(element.curvature[q], row + layout.curvature(q));
}

ReferenceElement reference_element(const Mesh& mesh, const MeshElement& element, const ElementBlock& block) {
  return make_reference_element(mesh.member_of(element), element.index, block.order, block.force_integration);
}

void fill_block(ElementBlock& block, const Structure& structure, const Scene& scene, const Mesh& mesh) {
  std::vector<double> row(static_cast<size_t>(block.reference_layout.size()));
  RowsWithoutRepeats rows(row.size());
  for (int e = 0; e < block.count; ++e) {
    const MeshElement& element = mesh.elements[structure.local_element_to_mesh[block.first_element + e]];
    try {
      fill_reference(reference_element(mesh, element, block), mesh.element_length(element), block.reference_layout,
                     row.data());
    } catch (const std::invalid_argument& error) {
      throw MemberError(
          scene.members[element.member].name,
          ", element " + std::to_string(element.index + 1) + " of " + std::to_string(mesh.member_of(element).elements),
          error.what());
    }
    rows.add(row);
    for (int end = 0; end < 2; ++end) block.vertices(e, end) = local_vertex(structure, element.vertex[end]);
    block.section(e) = structure.member_section[element.member];
  }
  block.reference = rows.rows("mixbeam::reference");
}

void add_block(Structure& structure, const BlockKey& key, const std::vector<int>& elements) {
  ElementBlock block;
  block.order = key.order;
  block.force_integration = static_cast<ForceIntegration>(key.rule);
  block.general_section = key.general_section;
  block.first_element = structure.local_elements();
  block.count = static_cast<int>(elements.size());
  if (block.order < 1 || block.order > kMaximumOrder)
    throw InputError("element order " + std::to_string(block.order) + " is outside 1..8");
  const int points = force_point_count(block.order, block.force_integration);
  block.interior = {block.order, points};
  block.reference_layout = {block.order, points};
  block.interior_offset = structure.interior_size;
  block.increment_offset = structure.increment_size;
  block.response_offset = structure.response_size;
  const size_t n = elements.size();
  structure.interior_size += n * block.interior.unknowns();
  structure.increment_size += n * block.interior.increments();
  structure.response_size += n * block.response_size();
  block.vertices = KernelView<int* [2]>("mixbeam::element_vertices", n);
  block.section = KernelView<int*>("mixbeam::element_section", n);
  structure.local_element_to_mesh.insert(structure.local_element_to_mesh.end(), elements.begin(), elements.end());
  structure.blocks.push_back(block);
}

void order_elements(Structure& structure) {
  std::vector<int>& elements = structure.elements_in_order;
  elements.resize(structure.local_elements());
  std::iota(elements.begin(), elements.end(), 0);
  std::sort(elements.begin(), elements.end(), [&structure](int a, int b) {
    return structure.local_element_to_mesh[a] < structure.local_element_to_mesh[b];
  });
}

/// Numbers the constants of sections, shared by their members; locking members have others, with another cap (cap.cpp).
void number_sections(Structure& structure, const Scene& scene) {
  std::map<std::string, SectionConstants> constants;
  for (const Section& section : scene.sections) constants[section.name] = section_constants(section);
  std::vector<SectionConstants> in_use;
  std::map<std::pair<std::string, bool>, int> number;
  for (const Member& member : scene.members) {
    const bool locks = member.force_integration != ForceIntegration::both_reduced;
    const auto [entry, is_new] = number.try_emplace({member.section, locks}, static_cast<int>(in_use.size()));
    structure.member_section.push_back(entry->second);
    if (!is_new) continue;
    in_use.push_back(constants.at(member.section));  // member_laws() has rejected other names
    structure.section_locks.push_back(locks);
    for (const double compliance : in_use.back().force_compliance) structure.least_compliance.push_back(compliance);
    for (const double compliance : in_use.back().moment_compliance) structure.least_compliance.push_back(compliance);
  }
  structure.views.sections = KernelView<SectionConstants*>("mixbeam::sections", in_use.size());
  std::copy(in_use.begin(), in_use.end(), structure.views.sections.data());
}

}  // namespace

int Structure::local_element(int mesh_element) const {
  if (local_elements() == mesh_elements) return elements_in_order[mesh_element];
  const auto found = std::lower_bound(elements_in_order.begin(), elements_in_order.end(), mesh_element,
                                      [this](int local, int wanted) { return local_element_to_mesh[local] < wanted; });
  return found != elements_in_order.end() && local_element_to_mesh[*found] == mesh_element ? *found : -1;
}

const ElementBlock& Structure::block_of(int local_element) const {
  for (const ElementBlock& block : blocks)
    if (local_element < block.first_element + block.count) return block;
  throw std::out_of_range("no block holds local element " + std::to_string(local_element));
}

Structure build_structure(const Scene& scene, const Mesh& mesh, int rank, int ranks) {
  Structure structure;
  structure.partition = VertexPartition(rank, ranks, mesh);
  structure.length = characteristic_length(mesh);
  structure.bending_reference = bending_reference(scene, structure.length);
  structure.shortest_element = std::numeric_limits<double>::max();
  for (const MeshElement& element : mesh.elements)
    structure.shortest_element = std::min(structure.shortest_element, mesh.element_length(element));
  structure.member_laws = member_laws(scene);
  std::map<BlockKey, std::vector<int>> kinds;
  for (size_t e = 0; e < mesh.elements.size(); ++e)
    if (is_local(mesh.elements[e], structure.partition))
      kinds[block_key(scene, structure.member_laws, mesh.elements[e].member)].push_back(static_cast<int>(e));
  structure.mesh_elements = static_cast<int>(mesh.elements.size());
  for (const auto& [key, elements] : kinds) add_block(structure, key, elements);
  order_elements(structure);
  number_sections(structure, scene);
  number_local_vertices(structure, mesh);
  const std::vector<int> part = connected_parts(mesh);
  structure.parts = 1 + *std::max_element(part.begin(), part.end());
  for (int v = 0; v < structure.owned_vertices && structure.parts > 1; ++v)
    structure.part_of_vertex.push_back(part[structure.local_vertex_to_global[v]]);
  for (ElementBlock& block : structure.blocks) {
    fill_block(block, structure, scene, mesh);
    if (!block.general_section) continue;
    fill_compliance(scene, mesh, structure.member_laws, &structure.local_element_to_mesh[block.first_element], block);
    lower_least_compliance(block, structure.least_compliance);
  }
  return structure;
}

State allocate_state(const Structure& structure) {
  StatePool& pool = *structure.states;
  State state;
  state.views.vertex_displacement =
      pool.vertex_displacement.take("mixbeam::vertex_displacement", structure.local_vertices());
  state.views.vertex_rotation = pool.vertex_rotation.take("mixbeam::vertex_rotation", structure.local_vertices());
  state.views.element_triad = pool.element_triad.take("mixbeam::element_triad", structure.local_elements());
  state.views.interior = pool.interior.take("mixbeam::interior", structure.interior_size);
  return state;
}

State reference_state(const Structure& structure, const Mesh& mesh) {
  State state = allocate_state(structure);
  Kokkos::deep_copy(state.views.vertex_displacement, 0.0);
  Kokkos::deep_copy(state.views.interior, 0.0);
  for (int v = 0; v < structure.local_vertices(); ++v)
    store_quaternion(identity_quaternion<double>(), &state.views.vertex_rotation(v, 0));
  for_each_element(structure, state, [&](const ElementView& element) {
    const ReferenceElement reference = reference_element(mesh, mesh.elements[element.mesh_element()], element.block());
    store_quaternion(reference.triad, element.triad_numbers());
    for (int j = 1; j < element.order(); ++j)
      store_vector(reference.relative_rotation[j], element.unknowns() + element.layout().relative_rotation(j));
  });
  return state;
}

// Not initialised: pages are placed near the threads that write them first.
ElementEquations allocate_rows(const Structure& structure) {
  ElementEquations equations;
  equations.residual = KernelView<double* [12]>(
      Kokkos::view_alloc("mixbeam::element_residual", Kokkos::WithoutInitializing), structure.local_elements());
  equations.condensed_residual = equations.residual;  // each is gathered right after its evaluation
  return equations;
}

ElementEquations allocate_tangents(const Structure& structure, bool keeps_full) {
  using Kokkos::view_alloc;
  using Kokkos::WithoutInitializing;
  const int n = structure.local_elements();
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count && !keeps_full; ++e) keeps_full = block.is_unsymmetric(e);
  ElementEquations equations;
  equations.condensed_tangent = KernelView<double**>(view_alloc("mixbeam::condensed_tangent", WithoutInitializing), n,
                                                     keeps_full ? kFullTangent : kSymmetricTangent);
  equations.response =
      KernelView<double*>(view_alloc("mixbeam::response", WithoutInitializing), structure.response_size);
  return equations;
}

}  // namespace mixbeam
