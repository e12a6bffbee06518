#include "discretization/assembly/residual.hpp"

#include "discretization/assembly/workspace.hpp"
#include "kernels/element/kinematics.hpp"

#include <Teuchos_CommHelpers.hpp>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

/// Line fields as another evaluation needs them, for as long as it lasts.
class OtherLineFields {
 public:
  explicit OtherLineFields(const Model& model) : model_(model) { model_.workspace().load_factor.reset(); }
  ~OtherLineFields() { model_.workspace().load_factor.reset(); }
  OtherLineFields(const OtherLineFields&) = delete;
  OtherLineFields& operator=(const OtherLineFields&) = delete;

 private:
  const Model& model_;
};

}  // namespace

void set_line_fields(const Model& model, double load_factor) {
  std::optional<double>& present = model.workspace().load_factor;
  if (present == load_factor) return;
  model.line_fields().set(model.structure(), load_factor);
  present = load_factor;
}

void gather_rows(const Model& model, const KernelView<double*>& rows) {
  const KernelView<const double* [12]> element_rows = model.workspace().rows.residual;
  const Adjacency adjacency = model.adjacency();
  Kokkos::parallel_for(
      "mixbeam::gather::residual", Range(0, model.structure().owned_vertices), KOKKOS_LAMBDA(int v) {
        double sum[kVertexDofs] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
        for (int a = adjacency.start(v); a < adjacency.start(v + 1); ++a) {
          const double* row = &element_rows(adjacency.element(a, 0), kVertexDofs * adjacency.element(a, 1));
          for (int c = 0; c < kVertexDofs; ++c) sum[c] += row[c];
        }
        for (int c = 0; c < kVertexDofs; ++c) rows(kVertexDofs * v + c) = sum[c];
      });
}

void gather_planar_rows(const Model& model, const KernelView<double*>& rows) {
  const Adjacency adjacency = model.adjacency();
  const KernelView<const double* [4]> element_rows = model.workspace().rows.planar_rows;
  const PlaneAxes axes = *model.plane();
  Kokkos::parallel_for(
      "mixbeam::gather::planar_residual", Range(0, model.structure().owned_vertices), KOKKOS_LAMBDA(int v) {
        double p = 0.0, q = 0.0, moment = 0.0;
        for (int a = adjacency.start(v); a < adjacency.start(v + 1); ++a) {
          const double* row = &element_rows(adjacency.element(a, 0), 0);
          const int end = adjacency.element(a, 1);
          p += end == 0 ? -row[0] : row[0];
          q += end == 0 ? -row[1] : row[1];
          moment += row[2 + end];
        }
        double* out = &rows(static_cast<size_t>(kVertexDofs) * v);
        store_vector(p * axes.p + q * axes.q, out);
        store_vector(moment * axes.n, out + 3);
      });
}

namespace {

KernelView<double*> take_end_angles(const Model& model) {
  return model.workspace().end_angles.take("mixbeam::end_angles", model.structure().local_elements());
}

/// Element residuals, interior rows straight into `out`; `scales`: of these rows, null: unscaled.
void evaluate_elements(const Model& model, const State& state, const ResidualScales* scales,
                       const KernelView<double*>& end_angles, MixedVector& out) {
  const Structure& structure = model.structure();
  ElementEquations equations = model.workspace().rows;
  equations.largest_end_angle = end_angles;
  equations.interior_residual = out.writable_interior(false);
  equations.scales_interior = scales != nullptr;
  if (scales != nullptr) equations.interior_scales = *scales;
  for (size_t b = 0; b < structure.blocks.size(); ++b)
    if (state.in_plane)
      evaluate_planar_residual(structure.blocks[b], model.planar_blocks()[b], structure.views, state.views, equations);
    else
      evaluate_residual(structure.blocks[b], structure.views, state.views, equations);
  if (state.in_plane)
    gather_planar_rows(model, out.vertex());
  else
    gather_rows(model, out.vertex());
}

}  // namespace

EvaluationPoint mixed_residual(const Model& model, const State& state, double load_factor, MixedVector& rows) {
  PhaseTimer timer(model.times(), "residual");
  EvaluationPoint point{state, load_factor, scales_of(model, state, load_factor)};
  point.end_angles = take_end_angles(model);
  set_line_fields(model, load_factor);
  evaluate_elements(model, state, &point.scales, point.end_angles, rows);
  const KernelView<double*> vertex = rows.vertex();
  subtract_point_loads(model.conditions(), state, load_factor, false, vertex);
  point.carried = std::make_shared<const CarriedForces>(model.constraints().carried(state, vertex));
  model.constraints().project(state, vertex);
  model.constraints().set(state, load_factor, vertex);
  scale_vertex_rows(model, point.scales, vertex);
  return point;
}

void element_rows(const Model& model, const State& state, double load_factor, bool with_line_loads, MixedVector& rows) {
  if (with_line_loads || !model.line_fields().has_loads()) {
    set_line_fields(model, load_factor);
    return evaluate_elements(model, state, nullptr, take_end_angles(model), rows);
  }
  const OtherLineFields without(model);
  model.line_fields().set(model.structure(), load_factor, false);
  evaluate_elements(model, state, nullptr, take_end_angles(model), rows);
}

void load_derivative(const Model& model, const State& state, double load_factor, const ResidualScales& scales,
                     MixedVector& rows) {
  rows.fill(0.0);
  if (!model.line_fields().empty()) {
    // fields enter linearly: their contribution is the residual with their derivative minus that without any
    const OtherLineFields derivatives(model);
    MixedVector without = rows.clone(false);
    model.line_fields().set_zero(model.structure());
    evaluate_elements(model, state, nullptr, take_end_angles(model), without);
    model.line_fields().set_slope(model.structure(), load_factor);
    evaluate_elements(model, state, nullptr, take_end_angles(model), rows);
    rows.update(-1.0, without, 1.0);
  }
  const KernelView<double*> vertex = rows.vertex();
  subtract_point_loads(model.conditions(), state, load_factor, true, vertex);
  model.constraints().project(state, vertex);
  model.constraints().set_slopes(load_factor, vertex);
  scale_rows(model, scales, rows);
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
  const MeshElement& found = model.mesh().elements[element];
  return {everywhere, model.scene().members[found.member].name, found.index};
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

}  // namespace mixbeam
