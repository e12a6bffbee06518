#include "discretization/assembly/residual.hpp"

#include "discretization/assembly/workspace.hpp"
#include "discretization/mesh/element_view.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Strains and relative rotations are differences of numbers of order one (and of u/h): a few roundings each.
constexpr double kRoundings = 16.0;

/// Without load the internal forces must vanish; a force of this fraction of EI/L^2 times the tolerance causes
/// displacements below the rounding error of the length.
constexpr double kUnloadedForce = 1e-6;

/// Relative to the length of the structure: beyond it a path has diverged, and rounding would excuse any strain.
constexpr double kLargestDisplacement = 1e6;

}  // namespace

ResidualScales residual_scales(const StateMagnitude& state, double length, double shortest_element,
                               double bending_stiffness, double tolerance) {
  ResidualScales scales;
  const bool loaded = state.load_force > 0.0 || state.load_moment > 0.0;
  const double floor = loaded ? 0.0 : kUnloadedForce * bending_stiffness / (length * length);
  const double moment = std::max(state.moment, state.load_moment);
  scales.force = std::max({state.force, state.load_force, moment / length, floor});
  scales.moment = std::max(moment, scales.force * shortest_element);
  const double noise = kRoundings * std::numeric_limits<double>::epsilon() / tolerance;
  const double amplitude = std::min(1.0, std::max({state.rotation, state.displacement / length, state.eigenstrain}));
  scales.rotation = std::max(amplitude, noise);
  scales.strain = std::max(amplitude, noise);
  scales.rotation_noise = noise;
  scales.displacement_noise = noise * std::min(state.displacement, kLargestDisplacement * length);
  scales.length = length;
  scales.amplitude = amplitude;
  return scales;
}

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

double largest_component(const Vec& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

/// Ignores NaN.
KOKKOS_INLINE_FUNCTION void raise_by_numbers(double& largest, const double* x, int count) {
  for (int i = 0; i < count; ++i) {
    const double a = x[i] < 0.0 ? -x[i] : x[i];
    if (a > largest) largest = a;
  }
}

/// Largest force and moment of all elements of a block.
Largest<2> largest_stresses(const ElementBlock& block, const KernelView<const double*>& interior) {
  const InteriorLayout layout = block.interior;
  const ElementPlaces place = block.unknowns_at();
  return largest_of<2>(
      "mixbeam::magnitude::stresses", block.count, KOKKOS_LAMBDA(int e, Largest<2>& pair) {
        const double* x = interior.data() + place(e);
        raise_by_numbers(pair.of[0], x, layout.moment(0));
        raise_by_numbers(pair.of[1], x + layout.moment(0), 3 * (layout.order + 1));
      });
}

}  // namespace

StateMagnitude magnitude_of(const Model& model, const State& state, double load_factor) {
  const Structure& structure = model.structure();
  StateMagnitude m;
  for (const ElementBlock& block : structure.blocks) {
    const Largest<2> stresses = largest_stresses(block, state.views.interior);
    m.force = std::max(m.force, stresses.of[0]);
    m.moment = std::max(m.moment, stresses.of[1]);
  }
  const KernelView<const double* [3]> u = state.views.vertex_displacement;
  const KernelView<const double* [4]> q = state.views.vertex_rotation;
  const Largest<2> motions = largest_of<2>(
      "mixbeam::magnitude::motions", structure.owned_vertices, KOKKOS_LAMBDA(int v, Largest<2>& pair) {
        raise_by_numbers(pair.of[0], &u(v, 0), 3);
        const double square = q(v, 1) * q(v, 1) + q(v, 2) * q(v, 2) + q(v, 3) * q(v, 3);
        if (square > pair.of[1]) pair.of[1] = square;
      });
  m.displacement = motions.of[0];
  m.rotation = 2.0 * std::sqrt(motions.of[1]);
  for (const auto& energy : model.external())
    energy->sizes(state, load_factor, [&m](int, const SpatialLoad& load) {
      m.load_force = std::max(m.load_force, largest_component(load.force));
      m.load_moment = std::max(m.load_moment, largest_component(load.moment));
    });
  const LineFieldMagnitude fields = model.line_fields().magnitude(load_factor);
  m.load_force = std::max(m.load_force, fields.force);
  if (const RotatingElements* rotating = model.rotating())
    m.load_force = std::max(m.load_force, rotating->spin().square(load_factor) * rotating->largest_force());
  // load that would bend the structure like the eigencurvature: otherwise a free member, in equilibrium without any
  // force, would be measured against its own rounding errors
  m.load_moment = std::max({m.load_moment, fields.couple, structure.bending_reference * fields.curvature});
  m.eigenstrain = std::max(fields.strain, fields.turn);
  if (!model.vertex_maps().import.is_null()) {
    double mine[7] = {m.force, m.moment, m.displacement, m.rotation, m.load_force, m.load_moment, m.eigenstrain};
    double all[7];
    Teuchos::reduceAll(*model.map()->getComm(), Teuchos::REDUCE_MAX, 7, mine, all);
    m = {all[0], all[1], all[2], all[3], all[4], all[5], all[6]};
  }
  return m;
}

ResidualScales scales_of(const Model& model, const State& state, double load_factor) {
  const Structure& structure = model.structure();
  return residual_scales(magnitude_of(model, state, load_factor), structure.length, structure.shortest_element,
                         structure.bending_reference, model.options().residual_tolerance);
}

namespace {

void scale_vertex_rows(const Model& model, const ResidualScales& scales, bool inverse,
                       const KernelView<double*>& rows) {
  const auto factor = [inverse](double scale) { return inverse ? scale : 1.0 / scale; };
  const double force = factor(scales.force), moment = factor(scales.moment), length = factor(scales.length);
  const auto fixed = model.fixed_rows();
  Kokkos::parallel_for(
      "mixbeam::scale::vertex", Range(0, model.structure().owned_vertices), KOKKOS_LAMBDA(int v) {
        double* row = &rows(static_cast<size_t>(kVertexDofs) * v);
        const unsigned char* held = &fixed(static_cast<size_t>(kVertexDofs) * v);
        for (int c = 0; c < 3; ++c) {
          row[c] *= held[c] != 0 ? length : force;
          row[3 + c] *= held[3 + c] != 0 ? 1.0 : moment;
        }
      });
  model.constraints().scale_springs(scales, inverse, rows);
}

void scale_rows(const Model& model, const ResidualScales& scales, bool inverse, MixedVector& rows) {
  scale_vertex_rows(model, scales, inverse, rows.vertex());
  if (rows.shares_zeros()) return;
  const ResidualScales by = scales;
  const KernelView<double*> interior = rows.writable_interior(true);
  for (const ElementBlock& block : model.structure().blocks) {
    const InteriorLayout layout = block.interior;
    const ElementPlaces place = block.increments_at();
    const SharedRows reference = block.reference;
    Kokkos::parallel_for(
        "mixbeam::scale::interior", Range(0, block.count), KOKKOS_LAMBDA(int e) {
          scale_interior_rows(layout, by, reference(e, 0), inverse, interior.data() + place(e));
        });
  }
}

}  // namespace

void scale_rows(const Model& model, const ResidualScales& scales, MixedVector& rows) {
  scale_rows(model, scales, false, rows);
}
void unscale_rows(const Model& model, const ResidualScales& scales, MixedVector& rows) {
  scale_rows(model, scales, true, rows);
}
void scale_vertex_rows(const Model& model, const ResidualScales& scales, const KernelView<double*>& rows) {
  scale_vertex_rows(model, scales, false, rows);
}

namespace {

/// Largest magnitude among entries [first, end) of the increments of every element of a block; NaN counts as infinity.
double largest_row(const ElementBlock& block, const KernelView<const double*>& interior, int first, int end) {
  const ElementPlaces place = block.increments_at();
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::scaled::interior", Range(0, block.count),
      KOKKOS_LAMBDA(int e, double& m) {
        for (int i = first; i < end; ++i) raise(m, interior(place(e) + i));
      },
      Kokkos::Max<double>(largest));
  return largest;
}

}  // namespace

double compatibility_norm(const Model& model, const MixedVector& scaled_residual) {
  double largest = 0.0;
  for (const ElementBlock& block : model.structure().blocks)
    largest = std::max(largest, largest_row(block, scaled_residual.interior(), 0, block.interior.relative_rotation(1)));
  return maximum_over_ranks(*model.map()->getComm(), largest);
}

double equilibrium_norm(const Model& model, const MixedVector& scaled_residual) {
  const KernelView<const double*> rows = scaled_residual.vertex(), interior = scaled_residual.interior();
  const auto fixed = model.fixed_rows();
  double largest = 0.0;
  Kokkos::parallel_reduce(
      "mixbeam::equilibrium::vertex", Range(0, rows.extent(0)),
      KOKKOS_LAMBDA(size_t i, double& m) {
        if (!fixed(i)) raise(m, rows(i));
      },
      Kokkos::Max<double>(largest));
  for (const ElementBlock& block : model.structure().blocks)
    largest = std::max(largest,
                       largest_row(block, interior, block.interior.relative_rotation(1), block.interior.increments()));
  return maximum_over_ranks(*model.map()->getComm(), largest);
}

namespace {

/// Line fields of the model times these factors; returns the same array while the factors do not change.
KernelView<double* [3]> line_fields_of(const Model& model, std::vector<double> factors) {
  if (model.line_fields().rows() == 0) return {};
  LastLineFields& last = model.workspace().line_fields;
  if (last.values.data() != nullptr && last.factors == factors) return last.values;
  const KernelView<double* [3]> values = last.pool.take("mixbeam::field_value", model.line_fields().rows());
  model.line_fields().add_up(model.structure(), factors, values);
  last.factors = std::move(factors);
  last.values = values;
  return values;
}

}  // namespace

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

void gather_planar_rows(const Model& model, const KernelView<double* [2]>& loads, const KernelView<double*>& rows) {
  const Adjacency adjacency = model.adjacency();
  const KernelView<const double* [4]> element_rows = model.workspace().rows.planar_rows;
  const PlaneAxes axes = *model.plane();
  Kokkos::parallel_for(
      "mixbeam::gather::planar_residual", Range(0, model.structure().owned_vertices), KOKKOS_LAMBDA(int v) {
        double p = 0.0, q = 0.0, moment = 0.0;
        for (int a = adjacency.start(v); a < adjacency.start(v + 1); ++a) {
          const int element = adjacency.element(a, 0), end = adjacency.element(a, 1);
          const double* row = &element_rows(element, 0);
          p += end == 0 ? -row[0] : row[0];
          q += end == 0 ? -row[1] : row[1];
          if (loads.extent(0) > 0) {
            p += loads(element, 0);
            q += loads(element, 1);
          }
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

/// Evaluates the rows of the elements, interior rows directly in `out`. `scales`: of these rows, null: unscaled.
/// `spin`: of the frame that carries their masses. `fields_alone`: line fields only.
void evaluate_elements(const Model& model, const State& state, const KernelView<double* [3]>& line_fields,
                       const Vec& spin, const ResidualScales* scales, const KernelView<double*>& end_angles,
                       MixedVector& out, bool fields_alone = false) {
  const Structure& structure = model.structure();
  StructureViews views = structure.views;
  views.field_value = line_fields;
  ElementEquations equations = model.workspace().rows;
  equations.largest_end_angle = end_angles;
  equations.interior_residual = out.writable_interior(false);
  equations.scales_interior = scales != nullptr;
  equations.fields_alone = fields_alone;
  if (scales != nullptr) equations.interior_scales = *scales;
  for (size_t b = 0; b < structure.blocks.size(); ++b)
    if (state.in_plane)
      evaluate_planar_residual(structure.blocks[b], model.planar_blocks()[b], views, state.views, equations);
    else
      evaluate_residual(structure.blocks[b], views, state.views, equations);
  if (model.rotating() != nullptr && dot(spin, spin) > 0.0)
    model.rotating()->add_rows(structure, state, spin, 1.0, equations);
  if (state.in_plane)
    gather_planar_rows(model, equations.planar_loads, out.writable_vertex(false));
  else
    gather_rows(model, out.writable_vertex(false));
}

Vec spin_of(const Model& model, double load_factor) {
  return model.rotating() == nullptr ? Vec{} : model.rotating()->spin().at(load_factor);
}

/// Adds the load derivative of the frame's forces, which grow with the square of its amplitude.
void add_frame_slopes(const Model& model, const State& state, double load_factor, MixedVector& rows) {
  const FrameSpin& spin = model.rotating()->spin();
  ElementEquations equations = model.workspace().rows;
  equations.interior_residual = rows.writable_interior(true);
  Kokkos::deep_copy(equations.residual, 0.0);
  model.rotating()->add_rows(model.structure(), state, spin.full(), spin.square_slope(load_factor), equations);
  const KernelView<double*> vertex = rows.vertex(), sum("mixbeam::frame::slopes", vertex.extent(0));
  gather_rows(model, sum);
  for (size_t i = 0; i < sum.extent(0); ++i) vertex(i) += sum(i);
}

}  // namespace

EvaluationPoint mixed_residual(const Model& model, const State& state, double load_factor, MixedVector& rows) {
  PhaseTimer timer(model.times(), "residual");
  EvaluationPoint point{state, load_factor, scales_of(model, state, load_factor)};
  point.end_angles = take_end_angles(model);
  point.line_fields = line_fields_of(model, model.line_fields().amplitudes(load_factor));
  evaluate_elements(model, state, point.line_fields, spin_of(model, load_factor), &point.scales, point.end_angles,
                    rows);
  const KernelView<double*> vertex = rows.vertex();
  for (const auto& energy : model.external()) energy->add_rows(state, load_factor, vertex);
  point.carried = std::make_shared<const CarriedForces>(model.constraints().carried(state, vertex));
  model.constraints().project(state, vertex);
  model.constraints().set(state, load_factor, vertex);
  scale_vertex_rows(model, point.scales, vertex);
  return point;
}

void element_rows(const Model& model, const State& state, double load_factor, ElementLoads loads, MixedVector& rows) {
  const bool with_line_loads = loads != ElementLoads::none;
  const Vec spin = loads == ElementLoads::with_centrifugal ? spin_of(model, load_factor) : Vec{};
  evaluate_elements(model, state, line_fields_of(model, model.line_fields().amplitudes(load_factor, with_line_loads)),
                    spin, nullptr, take_end_angles(model), rows);
}

void load_derivative(const Model& model, const State& state, double load_factor, const ResidualScales& scales,
                     MixedVector& rows) {
  rows.fill(0.0);
  const bool rotates = model.rotating() != nullptr;
  if (!model.line_fields().empty())
    evaluate_elements(model, state, line_fields_of(model, model.line_fields().slopes(load_factor)), {},
                      rotates ? nullptr : &scales, take_end_angles(model), rows, true);
  if (rotates) add_frame_slopes(model, state, load_factor, rows);
  const KernelView<double*> vertex = rows.vertex();
  for (const auto& energy : model.external()) energy->add_slopes(state, load_factor, vertex);
  model.constraints().project(state, vertex);
  model.constraints().set_slopes(load_factor, vertex);
  if (rotates)
    scale_rows(model, scales, rows);
  else
    scale_vertex_rows(model, scales, vertex);
}

void clear_rows(const Structure& structure, const KernelView<double*>& interior, RowsOf which) {
  for_each_element(structure, [&](const ElementView& element) {
    double* const row = element.increments_in(interior);
    double* const end = row + element.layout().relative_rotation(1);
    if (which == RowsOf::forces)
      std::fill(row, end, 0.0);
    else
      std::fill(end, row + element.layout().increments(), 0.0);
  });
}

}  // namespace mixbeam
