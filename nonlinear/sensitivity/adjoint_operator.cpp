#include "nonlinear/sensitivity/adjoint_operator.hpp"

#include "nonlinear/linear/krylov.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mixbeam {

namespace {

/// Share of the cap's effect that may be left in an adjoint: rounding of its products with changes by a parameter.
/// Usually two or three solves; as many as there are ways of distribution if forces are distributed by stiffness.
constexpr double kCapLeftInAdjoint = 1e-14;
constexpr int kMostCapSolvesOfAdjoint = 200;
/// Share above which a gradient has fewer than nine digits: exactly rigid closed frames carry any self-stress.
constexpr double kMostCapLeftInAdjoint = 1e-9;
/// Factor on the usual cap, which leaves 1e-11 of rounding in the derivative of an elastica; this one leaves 1e-13.
constexpr double kCapOfAdjoint = 4e-3;
/// Rounding of one solution over the square of the number of elements, a tenth of machine precision. In long chains the
/// correction for the cap need not be more accurate.
constexpr double kShareOfRounding = 2e-17;
/// Number of elements whose matrices are kept at a time, so that they fit into caches.
constexpr int kPart = 128;
/// Residual of a solve above which it is refined, over the sum of |terms| of a row.
constexpr double kRefinedAdjoint = 1e-15;

std::vector<double> values_of(const DofMatrix& matrix) {
  const auto local = matrix.getLocalMatrixHost();
  return {local.values.data(), local.values.data() + local.values.extent(0)};
}

}  // namespace

AdjointOperator::AdjointOperator(BeamProblem& problem, const State& state, double load_factor, bool transposed)
    : model_(problem.model),
      state_(state),
      transposed_(transposed),
      residual_(model_.create_vector()),
      point_(mixed_residual(model_, state, load_factor, residual_)),
      vertex_rows_("mixbeam::adjoint::rows", model_.structure().local_elements()),
      lender_(problem.take_solver()),
      system_(lender_->chains() != nullptr ? *lender_->chains() : own_.emplace(model_)),
      unknowns_(model_, system_.remaining()),
      remaining_(system_.matrix()->getRowMap()) {
  linearize(system_.is_unsymmetric());
}

bool AdjointOperator::is_symmetric() const {
  return !system_.is_unsymmetric() && asymmetry(unknowns_.matrix()) <= stability_limit.symmetric;
}

/// Condenses and factorises the tangent. The remaining matrix is that of the tangent, solved transposed; chains are
/// condensed again with the transposed elements.
void AdjointOperator::linearize(bool in_space) {
  const Cap usual = cap_for(model_, point_.scales);
  tangent_.emplace(model_, point_, usual.cuts_off ? cap_for(model_, point_.scales, kCapOfAdjoint) : usual,
                   TangentKind{in_space, false});
  const auto keep = [&](Entries& entries) {
    return [&](const MatrixRows&) { entries = values_of(*system_.matrix()); };
  };
  if (!system_.condense(*tangent_, false, keep(whole_)))
    throw LinearSolverError("the adjoint equations have a chain without stiffness");
  if (const SparseMatrix& matrix = unknowns_.reduce(*tangent_); matrix.rows() > 0) {
    solver_ = std::make_unique<InertiaSolver>(InertiaSolver::Kind::general, matrix);
    solver_->factorize(matrix);
  }
  if (transposed_ && system_.is_unsymmetric()) {
    const KernelView<double**> elements = tangent_->elements().condensed_tangent;
    for (size_t e = 0; e < elements.extent(0); ++e)
      for (int i = 0; i < 12; ++i)
        for (int j = 0; j < i; ++j) std::swap(elements(e, 12 * i + j), elements(e, 12 * j + i));
    system_.condense(*tangent_);
  }
  // Memory pages of elements in chains stay untouched and cost nothing.
  const KernelView<double**> zeros(Kokkos::view_alloc("mixbeam::adjoint::zeros", Kokkos::WithoutInitializing),
                                   model_.structure().local_elements(), kSymmetricTangent);
  for (const RemainingLink& link : system_.links())
    if (link.link < model_.structure().local_elements())
      for (int i = 0; i < kSymmetricTangent; ++i) zeros(link.link, i) = 0.0;
  system_.gather_outside(*tangent_, zeros, keep(outside_));
}

/// Calls action(part, evaluate) for parts of all elements in turn, whose matrices evaluate() computes: those of all
/// elements together would need more memory than the run.
template <class Action>
void AdjointOperator::for_each_part(bool condenses, const Action& action) const {
  StructureViews structure = tangent_->cap().structure;
  structure.field_value = point_.line_fields;
  const RotatingElements* rotating = model_.rotating();
  for (size_t b = 0; b < model_.structure().blocks.size(); ++b) {
    const ElementBlock& block = model_.structure().blocks[b];
    VibratingBlock part = allocate_static_block(block, std::min(kPart, block.count), condenses);
    part.transposed = transposed_;
    for (int first = 0; first < block.count; first += kPart) {
      part.block = part_of(block, first, std::min(kPart, block.count - first));
      action(part, [&] {
        const Vec spin = model_.frame().at(point_.load_factor);
        evaluate_vibration(part, structure, state_.views, 0.0,
                           condenses ? VibrationUse::condensed : VibrationUse::matrices,
                           tangent_->elements().condensed_tangent,
                           rotating == nullptr ? FrameViews() : rotating->frame(b, spin, first, part.block.count));
      });
    }
  }
}

void AdjointOperator::add_at_vertices(const KernelView<double*>& vertex) const {
  const Adjacency adjacency = model_.adjacency();
  for (int v = 0; v < model_.structure().owned_vertices; ++v)
    for (int i = 0; i < kVertexDofs; ++i)
      for (int a = adjacency.start(v); a < adjacency.start(v + 1); ++a)
        vertex(vertex_row(v, i)) += vertex_rows_(adjacency.element(a, 0), kVertexDofs * adjacency.element(a, 1) + i);
}

/// Condenses rows to the vertices and projects them. Unsymmetric tangents cannot do this, since the condensed interiors
/// of their transpose differ.
DofVector& AdjointOperator::condense(const MixedVector& rows) {
  DofVector& condensed = tangent_->condensed_rows();
  if (!system_.is_unsymmetric()) {
    tangent_->condense_spatial(rows);
    return condensed;
  }
  MixedVector forces = rows.clone(true);
  const KernelView<double*> interior = forces.writable_interior(true), vertex = MixedVector::view_of(condensed);
  Kokkos::deep_copy(vertex_rows_, 0.0);
  for_each_part(true, [&](const VibratingBlock& part, const auto& evaluate) {
    const double *from = interior.data() + part.block.increments_at()(0),
                 *to = interior.data() + part.block.increments_at()(part.block.count);
    if (std::all_of(from, to, [](double x) { return x == 0.0; })) return;
    evaluate();
    take_residual(part, interior, vertex_rows_);
    condense_rows(part, interior, vertex_rows_);
  });
  Kokkos::deep_copy(vertex, 0.0);
  add_at_vertices(vertex);
  for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) = rows.vertex()(i) - vertex(i);
  tangent_->project_on_free_motions(vertex);
  return condensed;
}

void AdjointOperator::recover(const MixedVector& rows, MixedVector& motion) const {
  if (!system_.is_unsymmetric()) return tangent_->recover(motion);
  MixedVector forces = rows.clone(true);
  const KernelView<const double* [6]> vertex = model_.local_increment(motion);
  const KernelView<double*> interior = forces.writable_interior(true), found = motion.writable_interior(false);
  for_each_part(true, [&](const VibratingBlock& part, const auto& evaluate) {
    evaluate();
    take_residual(part, interior, vertex_rows_);
    recover_motion(part, interior, vertex, found);
  });
}

/// Solves J t = -rows with the capped J, the tangent or its transpose. Rows are like those of a residual, spatial for
/// vertices. `held`: motions imposed by supports, whose forces are included in the rows. `projected`: see solve().
Adjoint AdjointOperator::respond(const MixedVector& rows, const DofVector* held, const DofVector* projected) {
  DofVector& condensed = condense(rows);
  condensed.scale(-1.0);
  Adjoint found{model_.create_vector()};
  DofVector& motion = found.field.vertex_dofs();
  system_.condense_rows(condensed, remaining_, motion);
  if (projected != nullptr) {
    DofVector more(remaining_.getMap());
    system_.remaining_values(*projected, more);
    remaining_.update(-1.0, more, 1.0);
  }
  found.free = unknowns_.reduced_remaining_rows(remaining_);
  solve_refined(*solver_, unknowns_.matrix(), found.free, 1, transposed_, kRefinedAdjoint, "adjoint equations");
  unknowns_.expand(found.free.data(), remaining_);
  if (held != nullptr) {
    DofVector imposed(remaining_.getMap());
    system_.remaining_values(*held, imposed);
    remaining_.update(1.0, imposed, 1.0);
  }
  system_.expand(remaining_, motion);
  recover(rows, found.field);
  return found;
}

DofVector AdjointOperator::held_motion(const StateDerivative& quantity) const {
  DofVector motion(model_.map());
  const KernelView<double*> rows = MixedVector::view_of(motion);
  const auto add = [&](int vertex, const Vec& force, const Vec& moment) {
    for (int i = 0; i < 3; ++i) {
      rows(vertex_row(vertex, i)) += force[i];
      rows(vertex_row(vertex, 3 + i)) += moment[i];
    }
  };
  for (const HeldRows& held : quantity.held()) {
    add(held.vertex, held.force, held.moment);
    for (const VertexJoint& joint : model_.conditions().joints) {  // the rows of slaves are added to the master's
      if (joint.master != held.vertex) continue;
      if (joint.kind == JointKind::slider && norm(held.moment) > 0.0)
        throw std::invalid_argument("a reaction moment at a slider has no derivative here");
      add(joint.slave, held.force, held.moment);
    }
  }
  return motion;
}

/// Adds matrix^T, or if not transposed the matrix, times a motion of the remaining vertices.
void AdjointOperator::add_product(const Entries& matrix, const DofVector& motion,
                                  const KernelView<double*>& rows) const {
  const auto local = system_.matrix()->getLocalMatrixHost();
  const KernelView<const double*> x = MixedVector::view_of(motion);
  const KernelView<int*> vertices = system_.remaining().vertices();
  const auto row_of = [&](int place) { return vertex_row(vertices(place / kVertexDofs), place % kVertexDofs); };
  for (int i = 0; i < static_cast<int>(local.numRows()); ++i)
    for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1); ++k) {
      const int column = local.graph.entries(k), from = transposed_ ? i : column, to = transposed_ ? column : i;
      rows(row_of(to)) += matrix[k] * x(row_of(from));
    }
}

/// Computes the rows that the cap leaves out.
void AdjointOperator::excess_rows(const MixedVector& motion, MixedVector& rows) const {
  Kokkos::deep_copy(rows.vertex(), 0.0);
  const KernelView<double*> interior = rows.writable_interior(false);
  for (const ElementBlock& block : model_.structure().blocks)
    cap_compliance_rows(block, tangent_->cap().structure, motion.interior(), interior);
}

void AdjointOperator::take_out_cap(Adjoint& adjoint) {
  if (!tangent_->cap().cuts_off) return;
  MixedVector excess = adjoint.field.clone(false);
  excess_rows(adjoint.field, excess);
  const double beta = norm_of(excess);
  if (!(beta > 0.0) || !std::isfinite(beta)) return;
  const double elements = model_.structure().length / model_.structure().shortest_element;
  const double rounding = kShareOfRounding * elements * elements;
  std::vector<MixedVector> basis;
  std::vector<Adjoint> responses;
  basis.push_back(std::move(excess));
  const GmresResult left_out = gmres(basis, beta, std::max(kCapLeftInAdjoint, rounding), kMostCapSolvesOfAdjoint,
                                     [&](const MixedVector& of, MixedVector& next) {
                                       responses.push_back(respond(of));
                                       excess_rows(responses.back().field, next);
                                       next.update(1.0, of, -1.0);
                                       return true;
                                     });
  if (!(left_out.left <= std::max(kMostCapLeftInAdjoint, rounding) * beta))
    throw LinearSolverError(
        "the adjoint equations were not solved: rigid members share forces that nothing determines");
  for (size_t k = 0; k < left_out.y.size(); ++k) adjoint.add(left_out.y[k], responses[k]);
}

/// Adds the derivative of held moments, which rotate with their vertex by half a cross product, theory (44).
void AdjointOperator::add_turning(const DofVector& held, const KernelView<double*>& rows) const {
  MixedVector spatial = model_.create_vector();
  element_rows(model_, state_, point_.load_factor, ElementLoads::with_centrifugal, spatial);
  for (const auto& energy : model_.external()) energy->add_rows(state_, point_.load_factor, spatial.vertex());
  const KernelView<const double*> motion = MixedVector::view_of(held);
  for (int v = 0; v < model_.structure().owned_vertices; ++v) {
    const Vec moment = rows_of(spatial.vertex(), v, kMomentPart), spin = load_vector(&motion(vertex_row(v, 3)));
    const Vec turned = 0.5 * cross(moment, spin);
    for (int i = 0; i < 3; ++i) rows(vertex_row(v, 3 + i)) += turned[i];
  }
}

/// Computes q_x + R_x^T t at supported vertices, with the true compliance. `rows`: q_x without its part in held rows,
/// which t contains.
std::vector<double> AdjointOperator::held_rows(const MixedVector& rows, const Adjoint& adjoint) const {
  std::vector<unsigned char> is_held(model_.structure().local_vertices(), 0);
  for (const VertexSupport& support : model_.conditions().supports) is_held[support.vertex] = 1;
  MixedVector left = rows.clone(true);
  const KernelView<const double* [6]> motion = model_.local_increment(adjoint.field);
  const KernelView<double*> interior = left.writable_interior(true), vertex = left.vertex();
  for_each_part(false, [&](const VibratingBlock& part, const auto& evaluate) {
    bool is_asked = false;
    for (int e = 0; e < part.block.count && !is_asked; ++e)
      is_asked = is_held[part.block.vertices(e, 0)] != 0 || is_held[part.block.vertices(e, 1)] != 0;
    if (!is_asked) return;
    evaluate();
    add_equations(part, motion, adjoint.field.interior(), interior, vertex_rows_);
  });
  add_at_vertices(vertex);
  add_product(outside_, adjoint.field.vertex_dofs(), vertex);
  std::vector<double> held(vertex.extent(0), 0.0);
  for (size_t i = 0; i < held.size(); ++i)
    if (is_held[i / kVertexDofs] != 0) held[i] = vertex(i);
  return held;
}

double AdjointOperator::work_of_free(const Adjoint& adjoint, const DofVector& projected) {
  system_.remaining_values(projected, remaining_);
  const std::vector<double> rows = unknowns_.reduced_remaining_rows(remaining_);
  double sum = 0.0;
  for (size_t i = 0; i < rows.size(); ++i) sum += rows[i] * adjoint.free[i];
  return sum;
}

std::vector<double> weights_of(const ElementView& element) {
  std::vector<double> weight(static_cast<size_t>(element.layout().moment(0)), 0.0);
  for_each_force_rule(element.order(), element.block().force_integration, [&](int first, int count, int from, int to) {
    double points[kMaximumOrder + 1], gauss[kMaximumOrder + 1];
    gauss_rule(count, points, gauss);
    for (int q = 0; q < count; ++q)
      for (int i = from; i < to; ++i)
        weight[static_cast<size_t>(element.layout().force(first + q) + i)] = 0.5 * element.length() * gauss[q];
  });
  return weight;
}

void weigh_force_rows(const Structure& structure, bool divides, MixedVector& rows) {
  const KernelView<double*> interior = rows.writable_interior(true);
  for_each_element(structure, [&](const ElementView& element) {
    const std::vector<double> weight = weights_of(element);
    double* row = element.increments_in(interior);
    for (size_t i = 0; i < weight.size(); ++i) row[i] *= divides && weight[i] > 0.0 ? 1.0 / weight[i] : weight[i];
  });
}

/// Whether rows and held motions lie in the plane of the state, and interior rows are zero.
bool AdjointOperator::is_planar_for(const MixedVector& rows, const DofVector& held) const {
  const KernelView<const double*> interior = rows.interior();
  const auto is_zero = [](double x) { return x == 0.0; };
  if (!std::all_of(interior.data(), interior.data() + interior.extent(0), is_zero)) return false;
  MixedVector both = rows.clone(true);
  both.vertex_dofs().update(1.0, held, 1.0);
  return model_.is_in_plane(both);
}

Adjoint AdjointOperator::solve(const StateDerivative& quantity, const DofVector* projected, const DofVector* imposed) {
  MixedVector own = quantity.rows().clone(true);
  weigh_force_rows(model_.structure(), true, own);
  const DofVector held = imposed != nullptr ? DofVector(*imposed, Teuchos::Copy) : held_motion(quantity);
  const bool holds = imposed != nullptr || !quantity.held().empty();
  if (holds && imposed == nullptr) add_turning(held, own.vertex());
  if (tangent_->is_planar() && (projected != nullptr || !is_planar_for(own, held))) linearize(true);
  MixedVector rows = own.clone(true);
  if (holds) add_product(whole_, held, rows.vertex());
  Adjoint adjoint = respond(rows, holds ? &held : nullptr, projected);
  take_out_cap(adjoint);
  adjoint.held = held_rows(own, adjoint);
  return adjoint;
}

}  // namespace mixbeam
