#include "discretization/state/structure_parts.hpp"

#include "discretization/assembly/equation_place.hpp"
#include "discretization/mesh/element_view.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

double largest_component(const Vec3<double>& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

/// Magnitudes behind residual scales, see residual_scales.
struct PartSize {
  StateMagnitude state{};
  vector_algebra::Box box{};  ///< undeformed
  double longest_member = 0.0, shortest_element = HUGE_VAL;

  double length() const { return std::max(longest_member, box.diagonal()); }
};

/// Magnitudes and residuals of the parts of one state.
class PartMeasure {
 public:
  PartMeasure(const Model& model, const EvaluationPoint& point, const StructureParts& parts)
      : model_(model),
        structure_(model.structure()),
        parts_(parts),
        line_fields_(point.line_fields),
        sizes_(parts.count) {
    measure_vertices(point.state);
    measure_elements(point.state);
    for (const auto& energy : model.external())
      energy->sizes(point.state, point.load_factor, [this](int vertex, const SpatialLoad& load) {
        raise(part_at(vertex).state.load_force, largest_component(load.force));
        raise(part_at(vertex).state.load_moment, largest_component(load.moment));
      });
    for (const PartSize& size : sizes_)
      scales_.push_back(residual_scales(size.state, size.length(), size.shortest_element, structure_.bending_reference,
                                        model.options().residual_tolerance));
  }

  const std::vector<ResidualScales>& scales() const { return scales_; }
  /// Largest row of each part, from a residual scaled for the whole structure.
  std::vector<double> largest_rows(const MixedVector& residual, const ResidualScales& whole) const;

 private:
  PartSize& part_at(int vertex) { return sizes_[parts_.of_vertex[vertex]]; }
  void measure_vertices(const State& state);
  void measure_elements(const State& state);
  void measure_line_fields(const ElementBlock& block, int e, PartSize& size) const;

  const Model& model_;
  const Structure& structure_;
  const StructureParts& parts_;
  KernelView<double* [3]> line_fields_;
  std::vector<PartSize> sizes_;
  std::vector<ResidualScales> scales_;
};

void PartMeasure::measure_vertices(const State& state) {
  const Mesh& mesh = model_.mesh();
  for (int v = 0; v < mesh.vertices(); ++v) {
    PartSize& size = part_at(v);
    double square = 0.0;
    size.box.enclose(mesh.vertex_position[v]);
    for (int i = 0; i < 3; ++i) {
      raise(size.state.displacement, state.views.vertex_displacement(v, i));
      square += state.views.vertex_rotation(v, i + 1) * state.views.vertex_rotation(v, i + 1);
    }
    raise(size.state.rotation, 2.0 * std::sqrt(square));
  }
}

void PartMeasure::measure_elements(const State& state) {
  const Mesh& mesh = model_.mesh();
  for_each_element(structure_, state, [&](const ElementView& element) {
    PartSize& size = sizes_[parts_.of_element[element.local()]];
    const int moments = element.layout().moment(0), end = element.layout().moment(element.order() + 1);
    for (int i = 0; i < moments; ++i) raise(size.state.force, element.unknowns()[i]);
    for (int i = moments; i < end; ++i) raise(size.state.moment, element.unknowns()[i]);
    size.shortest_element = std::min(size.shortest_element, element.length());
    size.longest_member =
        std::max(size.longest_member, mesh.member_of(mesh.elements[element.mesh_element()]).curve.length);
    if (element.block().field_row.extent(0) > 0) measure_line_fields(element.block(), element.index(), size);
  });
}

void PartMeasure::measure_line_fields(const ElementBlock& block, int e, PartSize& size) const {
  const MeshElement& element = model_.mesh().elements[structure_.local_element_to_mesh[block.first_element + e]];
  const double length = model_.mesh().member_of(element).curve.length;
  for (int kind = 0; kind < kLineFields; ++kind) {
    if (block.field_row(e, kind) < 0) continue;
    const LineField field = static_cast<LineField>(kind);
    double largest = 0.0;
    for (int q = 0; q < line_field_points(field, block.order, block.interior.force_points); ++q)
      for (int i = 0; i < 3; ++i) raise(largest, line_fields_(block.field_row(e, kind) + q, i));
    if (field == LineField::dead_force || field == LineField::follower_force)
      raise(size.state.load_force, largest * length);
    else if (field == LineField::dead_couple || field == LineField::follower_couple)
      raise(size.state.load_moment, largest * length);
    else if (field == LineField::eigenstrain)
      raise(size.state.eigenstrain, largest);
    else {
      raise(size.state.load_moment, largest * structure_.bending_reference);
      raise(size.state.eigenstrain, largest * length);
    }
  }
}

std::vector<double> PartMeasure::largest_rows(const MixedVector& residual, const ResidualScales& whole) const {
  std::vector<double> largest(parts_.count, 0.0);
  const auto raise_row = [&](int part, RowKind kind, double h, double row) {
    raise(largest[part], scale_of(kind, whole, h) / scale_of(kind, scales_[part], h) * row);
  };
  const auto fixed = model_.fixed_rows();
  const auto rows = residual.vertex();
  for (size_t i = 0; i < rows.extent(0); ++i)
    raise_row(parts_.of_vertex[i / kVertexDofs], kind_of_vertex_row(i % kVertexDofs, fixed(i) != 0), 0.0, rows(i));
  for_each_element(structure_, [&](const ElementView& element) {
    const double* row = element.increments_in(residual.interior());
    for (int i = 0; i < element.layout().increments(); ++i)
      raise_row(parts_.of_element[element.local()], kind_of_interior_row(element.layout(), i), element.length(),
                row[i]);
  });
  return largest;
}

}  // namespace

StructureParts structure_parts(const Model& model, const std::vector<int>& part_of_member) {
  const Mesh& mesh = model.mesh();
  const Structure& structure = model.structure();
  StructureParts parts;
  parts.count = part_of_member.empty() ? 0 : 1 + *std::max_element(part_of_member.begin(), part_of_member.end());
  parts.of_vertex.resize(mesh.vertices());
  for (const MeshElement& element : mesh.elements)
    for (const int vertex : element.vertex) parts.of_vertex[vertex] = part_of_member[element.member];
  for (const MeshJoint& joint : mesh.joints) {  // a master may have no element
    parts.of_vertex[joint.master] = parts.of_vertex[joint.slave] = part_of_member[joint.member];
  }
  for (const int element : structure.local_element_to_mesh)
    parts.of_element.push_back(part_of_member[mesh.elements[element].member]);
  return parts;
}

std::vector<PartCheck> check_parts(const Model& model, const State& state, double load_factor,
                                   const StructureParts& parts) {
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, state, load_factor, residual);
  const PartMeasure measure(model, point, parts);
  const std::vector<double> rows = measure.largest_rows(residual, point.scales);
  const std::vector<Balance> balance = balance_of_parts(model, state, load_factor, parts, measure.scales());
  std::vector<PartCheck> checks;
  for (int part = 0; part < parts.count; ++part)
    checks.push_back({rows[part], balance[part].force_error, balance[part].moment_error});
  return checks;
}

}  // namespace mixbeam
