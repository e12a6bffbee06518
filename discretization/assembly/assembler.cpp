#include "discretization/assembly/assembler.hpp"

#include "kernels/element/kinematics.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

}  // namespace

Assembler::Assembler(const Scene& scene, const Communicator& comm, const AssemblerOptions& options)
    : scene_(scene),
      mesh_(build_mesh(scene)),
      structure_(build_structure(scene, mesh_, comm->getRank(), comm->getSize())),
      line_fields_(scene, mesh_, structure_),
      conditions_(build_conditions(scene, mesh_, structure_)),
      constraints_(conditions_),
      options_(options),
      equations_(allocate_equations(structure_)) {
  PhaseTimer timer(times_, "setup");
  build_maps(comm);
  mark_fixed_rows();
  mark_owned_interior();
  build_adjacency();
  build_plane();
}

MixedVector Assembler::create_vector() const {
  return MixedVector(maps_.rows, structure_.increment_size, owned_interior_, vectors_);
}

void Assembler::set_load_factor(double load_factor) {
  if (line_fields_set_ && load_factor == load_factor_) return;
  line_fields_.set(structure_, load_factor);
  load_factor_ = load_factor;
  line_fields_set_ = true;
}

void Assembler::gather_rows(const KernelView<double* [12]>& element_rows, const KernelView<double*>& rows) const {
  const Adjacency adjacency = adjacency_;
  Kokkos::parallel_for(
      "mixbeam::gather::residual", Range(0, structure_.owned_vertices), KOKKOS_LAMBDA(int v) {
        double sum[kVertexDofs] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
        for (int a = adjacency.start(v); a < adjacency.start(v + 1); ++a) {
          const double* row = &element_rows(adjacency.element(a, 0), kVertexDofs * adjacency.element(a, 1));
          for (int c = 0; c < kVertexDofs; ++c) sum[c] += row[c];
        }
        for (int c = 0; c < kVertexDofs; ++c) rows(kVertexDofs * v + c) = sum[c];
      });
}

/// The same in a plane: two elements of a chain hold each other by the force that acts on the end of the one and,
/// turned round, on the start of the other.
void Assembler::gather_planar_rows(const KernelView<double*>& rows) const {
  const Adjacency adjacency = adjacency_;
  const KernelView<const double* [4]> element_rows = equations_.planar_rows;
  const PlaneAxes axes = *plane_;
  Kokkos::parallel_for(
      "mixbeam::gather::planar_residual", Range(0, structure_.owned_vertices), KOKKOS_LAMBDA(int v) {
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

/// Unscaled element residuals (but for the interior where equations_ says so), interior rows straight into `out`.
void Assembler::evaluate_elements(const State& state, MixedVector& out) {
  equations_.interior_residual = out.writable_interior(false);
  for (size_t b = 0; b < structure_.blocks.size(); ++b)
    if (state.in_plane)
      evaluate_planar_residual(structure_.blocks[b], planar_blocks_[b], structure_.views, state.views, equations_);
    else
      evaluate_residual(structure_.blocks[b], structure_.views, state.views, equations_);
  equations_.interior_residual = KernelView<double*>();
  if (state.in_plane)
    gather_planar_rows(out.vertex());
  else
    gather_rows(equations_.residual, out.vertex());
}

void Assembler::residual(const State& state, double load_factor, MixedVector& out) {
  PhaseTimer timer(times_, "residual");
  scales_ = scales_of(state, load_factor);
  equations_.interior_scales = scales_;
  equations_.scales_interior = true;
  evaluate_elements(state, out);
  equations_.scales_interior = false;
  const KernelView<double*> rows = out.vertex();
  subtract_point_loads(conditions_, state, load_factor, false, rows);
  constraints_.remember(state, load_factor, rows);
  constraints_.turn(state, rows);
  constraints_.set(state, load_factor, rows);
  scale_vertex_rows(rows, false);
}

ResidualScales Assembler::scales_of(const State& state, double load_factor) {
  set_load_factor(load_factor);
  return residual_scales(magnitude(state), structure_.length, structure_.shortest_element, structure_.bending_reference,
                         options_.residual_tolerance);
}

void Assembler::element_rows(const State& state, double load_factor, bool with_line_loads, MixedVector& out) {
  set_load_factor(load_factor);
  const bool set_aside = !with_line_loads && line_fields_.has_loads();
  if (set_aside) line_fields_.set(structure_, load_factor, false);
  evaluate_elements(state, out);
  if (set_aside) line_fields_.set(structure_, load_factor);
}

namespace {

/// Elements that lock carry parasitic forces of the size of their stiffness, far above the loads: with the cap that
/// suits other elements Newton's method needs hundreds of steps. Studies of locking pay with condition for contraction.
constexpr double kCapForLockingElements = 1e3;

/// Rounding errors of the assembled and factorised tangent act like springs to the ground, eps * cap / h each: they
/// disturb an increment by 3e-12 * cap * L/h (measured on chains of 1e3 to 1e6 elements), which must stay well below
/// one for Newton's method to go on converging fast.
constexpr double kCapTimesElements = 1e9;

/// Below this the cap itself would slow Newton's method more than rounding errors do; a mesh whose shortest element is
/// 1e-9 of its length does not need less.
constexpr double kLeastCap = 1e3;

}  // namespace

/// Theory (36). The residual keeps the true compliance, so the cap costs accuracy nowhere; it only decides how fast
/// Newton's method contracts. Each iteration leaves a strain of (change of N)/cap: the cap must be large against the
/// forces at work, but no larger, because the condition of the condensed tangent grows with it (and with it the error
/// of every increment). Where forces are shared by stiffness, that strain would stay: softening_rows() tells it.
void Assembler::cap_force_stiffness() {
  const double bending = structure_.bending_reference / (structure_.length * structure_.length);
  const double elements = structure_.length / structure_.shortest_element;
  const double factor =
      cap_raise_ * std::min(options_.force_stiffness_cap, std::max(kLeastCap, kCapTimesElements / elements));
  const double cap = factor * std::max(bending, scales_.force);
  const double moment_cap = cap * structure_.length * structure_.length;  // far above all that bends
  if (cap == stiffness_cap_) return;
  stiffness_cap_ = cap;
  least_cap_ratio_ = 0.0;
  const auto note_cap_ratio = [this](double softening, double ratio) {
    if (softening > 0.0 && ratio > 0.0 && (least_cap_ratio_ == 0.0 || ratio < least_cap_ratio_))
      least_cap_ratio_ = ratio;
  };
  for (size_t m = 0; m < structure_.views.member_section.extent(0); ++m) {
    SectionConstants& section = structure_.views.member_section(m);
    const bool locks = scene_.members[m].force_integration != ForceIntegration::both_reduced;
    const double limit = locks ? kCapForLockingElements * cap : cap;
    for (int i = 0; i < 3; ++i) {
      section.force_softening[i] = std::max(0.0, 1.0 / limit - section.force_compliance[i]);
      section.tangent_force_stiffness[i] = section.force_softening[i] > 0.0 ? limit : 1.0 / section.force_compliance[i];
      section.moment_softening[i] = std::max(0.0, 1.0 / moment_cap - section.moment_compliance[i]);
      section.moment_stiffness[i] = section.moment_softening[i] > 0.0 ? moment_cap : 1.0 / section.moment_compliance[i];
      note_cap_ratio(section.force_softening[i], section.force_compliance[i] * limit);
      note_cap_ratio(section.moment_softening[i], section.moment_compliance[i] * moment_cap);
    }
    section.force_stiffness_limit = limit;
    section.moment_stiffness_limit = moment_cap;
  }
}

void Assembler::raise_cap(double factor) {
  if (factor != cap_raise_ && tangent_.number != 0) ++tangent_.number;
  cap_raise_ = factor;
}

/// The tangent needs what supports and joints carry, which the condensed residual does not show.
void Assembler::remember_constraint_forces(const State& state, double load_factor) {
  if (constraints_.remembers(state, load_factor)) return;
  MixedVector rows = create_vector();
  evaluate_elements(state, rows);
  subtract_point_loads(conditions_, state, load_factor, false, rows.vertex());
  constraints_.remember(state, load_factor, rows.vertex());
}

void Assembler::evaluate_spatial_tangents(const State& state) const {
  PhaseTimer timer(times_, "element tangent");
  for (const ElementBlock& block : structure_.blocks)
    evaluate_tangent(block, structure_.views, state.views, equations_);
}

void Assembler::spatial_tangent(const State& state, double load_factor) {
  set_load_factor(load_factor);
  remember_constraint_forces(state, load_factor);
  cap_force_stiffness();
  evaluate_spatial_tangents(state);
  finish_tangent(state, load_factor, false);
}

void Assembler::tangent(const State& state, double load_factor) {
  if (interior_negative_.extent(0) == 0)
    interior_negative_ = KernelView<int*>("mixbeam::elements::interior_negative", structure_.local_elements());
  equations_.interior_negative = interior_negative_;
  spatial_tangent(state, load_factor);
  equations_.interior_negative = KernelView<int*>();
}

Assembler::InteriorCount Assembler::interior_count() const {
  long mine[2] = {0, 0};
  for (const ElementBlock& block : structure_.blocks)
    for (int e = 0; e < block.count; ++e) {
      if (block.vertices(e, 0) >= structure_.owned_vertices) continue;  // counted by the rank that owns the vertex
      const int negative = interior_negative_(block.first_element + e);
      if (negative == kUncertainCount)
        mine[1] = 1;
      else
        mine[0] += negative;
    }
  long all[2] = {mine[0], mine[1]};
  Teuchos::reduceAll(*map()->getComm(), Teuchos::REDUCE_SUM, 2, mine, all);
  return {all[0], all[1] > 0};
}

void Assembler::newton_tangent(const State& state, double load_factor, bool in_space) {
  if (!state.in_plane || in_space) return spatial_tangent(state, load_factor);
  set_load_factor(load_factor);
  remember_constraint_forces(state, load_factor);
  cap_force_stiffness();
  {
    PhaseTimer timer(times_, "element tangent");
    for (size_t b = 0; b < structure_.blocks.size(); ++b)
      evaluate_planar_tangent(structure_.blocks[b], planar_blocks_[b], structure_.views, state.views, planar_tangents_,
                              equations_);
  }
  finish_tangent(state, load_factor, true);
}

void Assembler::finish_tangent(const State& state, double load_factor, bool planar) {
  PhaseTimer timer(times_, "assemble");
  const KernelView<double*> rows = MixedVector::view_of(*condensed_residual_);
  if (planar)
    gather_planar_rows(rows);
  else
    gather_rows(equations_.condensed_residual, rows);
  subtract_point_loads(conditions_, state, load_factor, false, rows);
  constraints_.turn(state, rows);
  constraints_.set(state, load_factor, rows);
  constraints_.keep_for_tangent();
  tangent_ = {state, load_factor, tangent_.number + 1, planar};
  matrix_is_filled_ = false;
}

void Assembler::condense(const State& state, double load_factor, const MixedVector& scaled_rhs) {
  PhaseTimer timer(times_, "condense right-hand side");
  set_load_factor(load_factor);
  cap_force_stiffness();
  MixedVector rhs = scaled_rhs.clone(true);
  scale_rows(rhs, true);
  for (size_t b = 0; b < structure_.blocks.size(); ++b)
    if (tangent_.planar)
      condense_planar_right_hand_side(structure_.blocks[b], planar_blocks_[b], structure_.views, state.views,
                                      rhs.interior(), planar_tangents_, equations_);
    else
      condense_right_hand_side(structure_.blocks[b], structure_.views, state.views, rhs.interior(), equations_);
  const KernelView<double*> rows = MixedVector::view_of(*condensed_residual_);
  if (tangent_.planar)
    gather_planar_rows(rows);
  else
    gather_rows(equations_.condensed_residual, rows);
  constraints_.turn(state, rows);
  const KernelView<double*> given = rhs.vertex();
  const auto fixed = fixed_;
  Kokkos::parallel_for(
      "mixbeam::condense::vertex", Range(0, rows.extent(0)),
      KOKKOS_LAMBDA(size_t i) { rows(i) = fixed(i) ? given(i) : rows(i) + given(i); });
}

void Assembler::softening_rows(const MixedVector& increment, MixedVector& out) const {
  const KernelView<double*> vertex = out.vertex();
  Kokkos::parallel_for(
      "mixbeam::softening::vertex", Range(0, vertex.extent(0)), KOKKOS_LAMBDA(size_t i) { vertex(i) = 0.0; });
  const KernelView<double*> rows = out.writable_interior(false);
  for (const ElementBlock& block : structure_.blocks)
    mixbeam::softening_rows(block, structure_.views, increment.interior(), rows);
  scale_rows(out, false);
}

double Assembler::largest_softening_row(const MixedVector& increment) const {
  double largest = 0.0;
  for (const ElementBlock& block : structure_.blocks)
    largest = std::max(largest, mixbeam::largest_softening_row(block, structure_.views, increment.interior(), scales_));
  return maximum_over_ranks(*maps_.rows->getComm(), largest);
}

const Teuchos::RCP<DofMatrix>& Assembler::matrix() const {
  if (matrix_ == nullptr) {
    std::vector<RemainingLink> elements;
    for (const ElementBlock& block : structure_.blocks)
      for (int e = 0; e < block.count; ++e) {
        const int element = block.first_element + e;
        elements.push_back({element, element, {block.vertices(e, 0), block.vertices(e, 1)}});
      }
    const std::vector<unsigned char> all(structure_.local_vertices(), 1);
    matrix_ = std::make_unique<VertexMatrix>(structure_, maps_, all, std::move(elements), conditions_.joints);
  }
  if (tangent_.number != 0 && !matrix_is_filled_) {
    if (tangent_.planar) evaluate_spatial_tangents(tangent_.state);
    PhaseTimer timer(times_, "assemble");
    fill(*matrix_, LinkMatrices<kSpatialDofs>{equations_.condensed_tangent, {}});
    matrix_is_filled_ = true;
  }
  return matrix_->matrix();
}

void Assembler::fill(const VertexMatrix& matrix, const LinkMatrices<kSpatialDofs>& links) const {
  matrix.gather(links);
  const MatrixRows rows = matrix.rows();
  add_load_tangents(rows);
  constraints_.turn(tangent_.state, rows);
}

/// External loads whose virtual work is not that of a potential, or that follow the vertex: theory (44).
void Assembler::add_load_tangents(const MatrixRows& rows) const {
  for (const VertexLoad& load : conditions_.loads) {
    const SpatialLoad spatial = spatial_load(load, load.amplitude(tangent_.load_factor), tangent_.state);
    const bool follower = load.frame == LoadFrame::follower;
    rows.add(load.vertex, kMomentPart, load.vertex, kMomentPart, (follower ? 0.5 : -0.5) * hat(spatial.moment));
    if (follower) rows.add(load.vertex, kForcePart, load.vertex, kMomentPart, hat(spatial.force));
  }
}

KernelView<const double* [6]> Assembler::local_increment(const MixedVector& increment) const {
  DofVector* source = &increment.vertex_dofs();
  if (!maps_.import.is_null()) {
    ghosted_increment_->doImport(*source, *maps_.import, Tpetra::REPLACE);
    source = ghosted_increment_.get();
  }
  const KernelView<double*> flat = MixedVector::view_of(*source);
  return KernelView<const double* [6]>(flat.data(), flat.extent(0) / kVertexDofs);
}

void Assembler::recover(const State& state, MixedVector& increment) {
  PhaseTimer timer(times_, "recover");
  const KernelView<const double* [6]> vertex = local_increment(increment);
  const KernelView<double*> interior = increment.writable_interior(false);
  for (size_t b = 0; b < structure_.blocks.size(); ++b)
    if (tangent_.planar)
      recover_planar_interior(structure_.blocks[b], planar_blocks_[b], vertex, interior);
    else
      recover_interior(structure_.blocks[b], state.views, equations_, vertex, interior);
}

State Assembler::apply(const State& from, const MixedVector& increment, double step) {
  PhaseTimer timer(times_, "update");
  State to = allocate_state(structure_);
  const KernelView<const double* [6]> d = local_increment(increment);
  apply_vertex_increment(structure_.local_vertices(), from.views, d, step, to.views);
  for (const ElementBlock& block : structure_.blocks)
    apply_interior_increment(block, from.views, increment.interior(), step, to.views);
  to.in_plane = from.in_plane && is_in_plane(increment);
  return to;
}

void Assembler::load_derivative(const State& state, double load_factor, MixedVector& out) {
  out.fill(0.0);
  if (!line_fields_.empty()) {
    // fields enter linearly: their contribution is the residual with their derivative minus that without any
    MixedVector without = out.clone(false);
    line_fields_.set_zero(structure_);
    evaluate_elements(state, without);
    line_fields_.set_slope(structure_, load_factor);
    evaluate_elements(state, out);
    out.update(-1.0, without, 1.0);
    line_fields_set_ = false;
    set_load_factor(load_factor);
  }
  const KernelView<double*> rows = out.vertex();
  subtract_point_loads(conditions_, state, load_factor, true, rows);
  constraints_.turn(state, rows);
  constraints_.set_slopes(load_factor, rows);
  scale_rows(out, false);
}

Assembler::EndAngle Assembler::largest_end_angle() const {
  EndAngle largest;
  int where = 0;
  for (int e = 0; e < structure_.local_elements(); ++e)
    if (equations_.largest_end_angle(e) > largest.angle) {
      largest.angle = equations_.largest_end_angle(e);
      where = structure_.local_element_to_mesh[e];
    }
  const auto& comm = *maps_.rows->getComm();
  const double everywhere = maximum_over_ranks(comm, largest.angle);
  int mine = largest.angle == everywhere ? where : -1, element = mine;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(element));
  largest.angle = everywhere;
  largest.member = scene_.members[mesh_.elements[element].member].name;
  largest.element = mesh_.elements[element].index;
  return largest;
}

}  // namespace mixbeam
