#include "nonlinear/sensitivity/adjoint_operator.hpp"

#include "discretization/text/number_text.hpp"
#include "nonlinear/linear/krylov.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/stability/block_krylov.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Share of the cap that may be left in an adjoint: rounding of its products with what a parameter changes. Two or
/// three solves as a rule; structures that share forces by stiffness take as many as there are ways of sharing.
constexpr double kCapLeftInAdjoint = 1e-14;
constexpr int kMostCapSolvesOfAdjoint = 200;
/// Beyond it a gradient has fewer than nine digits: closed frames that are exactly rigid carry any stress of their own.
constexpr double kMostCapLeftInAdjoint = 1e-9;
/// Of the usual cap, where nothing is refined: that leaves 1e-10 of rounding in the derivative of an elastica, this one
/// 1e-12.
constexpr double kCapOfAdjoint = 1e-2;
/// Rounding of a solve beyond which it is refined, and refused: share of the sum of the terms of a row.
constexpr double kRefinedAdjoint = 1e-15, kRefusedAdjoint = 1e-9;

/// Refinements of a whole solution: three as a rule, each of which takes what is left to its share, as far as rounding.
constexpr int kMostRefinements = 6;
constexpr double kFastRefinement = 1e-2, kRefined = 1e-14;

/// Whether all that acts in rows is in those of elements and loads: free motions of joints and of supports that hold
/// a part of the rotations, or spring against them, depend on the state.
bool knows_all_rows(const Conditions& conditions) {
  return conditions.joints.empty() &&
         std::all_of(conditions.supports.begin(), conditions.supports.end(), [](const VertexSupport& support) {
           return support.rotation_kind != SupportRotation::vector && norm(support.rotation_stiffness) == 0.0;
         });
}

std::vector<double> values_of(const DofMatrix& matrix) {
  const auto local = matrix.getLocalMatrixHost();
  return {local.values.data(), local.values.data() + local.values.extent(0)};
}

}  // namespace

AdjointOperator::AdjointOperator(BeamProblem& problem, const State& state, double load_factor, bool transposed)
    : model_(problem.model),
      state_(state),
      transposed_(transposed),
      knows_all_rows_(knows_all_rows(model_.conditions())),
      residual_(model_.create_vector()),
      point_(mixed_residual(model_, state, load_factor, residual_)),
      tangent_(model_, point_, cap_for(model_, point_.scales, knows_all_rows_ ? 1.0 : kCapOfAdjoint),
               TangentKind{true, false}),
      elements_("mixbeam::adjoint::elements", model_.structure().local_elements(), kFullTangent),
      vertex_rows_("mixbeam::adjoint::rows", model_.structure().local_elements()),
      system_(model_),
      unknowns_(model_, system_.remaining()),
      remaining_(system_.matrix()->getRowMap()) {
  for (const ElementBlock& block : model_.structure().blocks) blocks_.push_back(allocate_static_block(block));
  const KernelView<double**> zeros("mixbeam::adjoint::zeros", elements_.extent(0), kFullTangent);
  system_.gather_outside(tangent_, zeros, [this](const MatrixRows&) { outside_.value = values_of(*system_.matrix()); });
  evaluate(false);
  factorize(false);
  if (!transposed_ || !system_.is_unsymmetric()) return;
  evaluate(true);
  factorize(true);
}

void AdjointOperator::evaluate(bool transposed) {
  StructureViews structure = tangent_.cap().structure;
  structure.field_value = point_.line_fields;
  for (VibratingBlock& block : blocks_) {
    block.transposed = transposed;
    evaluate_vibration(block, structure, state_.views, 0.0, false, elements_);
  }
  if (state_.in_plane) hold_in_plane();
}

/// A structure in a plane may be loose across it, where nothing acts: springs whose size does not matter hold it.
void AdjointOperator::hold_in_plane() {
  const double length = model_.structure().shortest_element, turning = model_.structure().bending_reference / length;
  const Mat along = outer(model_.plane()->n, model_.plane()->n);
  const Mat force = (turning / (length * length)) * along, moment = turning * (identity_matrix<double>() - along);
  for (size_t e = 0; e < elements_.extent(0); ++e)
    for (int part = 0; part < 12; part += 3)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          elements_(e, 12 * (part + i) + part + j) += part % kVertexDofs == 0 ? force(i, j) : moment(i, j);
}

/// The matrix over what chains leave is that of the tangent; of its transpose the chains alone are taken.
void AdjointOperator::factorize(bool transposed) {
  const auto keep = [&](const MatrixRows&) {
    if (!transposed) whole_.value = values_of(*system_.matrix());
  };
  if (!system_.condense(tangent_, elements_, keep))
    throw LinearSolverError("the adjoint equations have a chain without stiffness");
  if (transposed) return;
  const SparseMatrix& matrix = unknowns_.reduce(tangent_);
  if (matrix.rows() == 0) return;
  solver_ = std::make_unique<InertiaSolver>(InertiaSolver::Kind::general, matrix);
  solver_->factorize(matrix);
}

void AdjointOperator::gather(const KernelView<double*>& vertex) const {
  const Adjacency adjacency = model_.adjacency();
  for (int v = 0; v < model_.structure().owned_vertices; ++v)
    for (int i = 0; i < kVertexDofs; ++i) {
      double sum = 0.0;
      for (int a = adjacency.start(v); a < adjacency.start(v + 1); ++a)
        sum += vertex_rows_(adjacency.element(a, 0), kVertexDofs * adjacency.element(a, 1) + i);
      vertex(vertex_row(v, i)) = sum;
    }
}

void AdjointOperator::condense_interior(const MixedVector& rows, const KernelView<double*>& vertex) const {
  Kokkos::deep_copy(vertex_rows_, 0.0);
  for (const VibratingBlock& block : blocks_) condense_rows(block, rows.interior(), vertex_rows_);
  gather(vertex);
}

void AdjointOperator::recover(const MixedVector& rows, MixedVector& motion) const {
  const KernelView<const double* [6]> vertex = model_.local_increment(motion);
  const KernelView<double*> interior = motion.writable_interior(false);
  for (const VibratingBlock& block : blocks_) recover_motion(block, rows.interior(), vertex, interior);
}

void AdjointOperator::excess_rows(const MixedVector& motion, MixedVector& rows) const {
  Kokkos::deep_copy(rows.vertex(), 0.0);
  const KernelView<double*> interior = rows.writable_interior(false);
  for (const VibratingBlock& block : blocks_) mixbeam::excess_rows(block, motion.interior(), interior);
}

/// Under rows of vertices and interiors, with signs as kernels/vibration has them.
Adjoint AdjointOperator::respond(MixedVector rows) {
  MixedVector condensed = model_.create_vector();
  const KernelView<double*> vertex = condensed.vertex();
  condense_interior(rows, vertex);
  for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) += rows.vertex()(i);
  tangent_.project_on_free_motions(vertex);
  Adjoint found{model_.create_vector()};
  DofVector& motion = found.field.vertex_dofs();
  system_.condense_rows(condensed.vertex_dofs(), remaining_, motion);
  found.free = unknowns_.reduced_remaining_rows(remaining_);
  solve_reduced(found.free);
  unknowns_.expand(found.free.data(), remaining_);
  system_.expand(remaining_, motion);
  recover(rows, found.field);
  return found;
}

void AdjointOperator::solve_reduced(std::vector<double>& y) const {
  if (y.empty()) return;
  const std::vector<double> given = y;
  solver_->solve(y.data(), 1, transposed_);
  std::vector<double> left = given;
  if (rest(y, left) <= kRefinedAdjoint) return;
  solver_->solve(left.data(), 1, transposed_);
  for (size_t i = 0; i < y.size(); ++i) y[i] += left[i];
  left = given;
  if (const double error = rest(y, left); !(error <= kRefusedAdjoint))
    throw LinearSolverError("the adjoint equations were not solved: backward error " + shortest(error));
}

/// given - K^T y; its size, over the largest sum of the terms of a row.
double AdjointOperator::rest(const std::vector<double>& y, std::vector<double>& given) const {
  const SparseMatrix& matrix = unknowns_.matrix();
  std::vector<double> sum(given.size());
  for (size_t i = 0; i < given.size(); ++i) sum[i] = std::abs(given[i]);
  for (int i = 0; i < matrix.rows(); ++i)
    for (int k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k) {
      const int row = transposed_ ? matrix.column[k] : i, column = transposed_ ? i : matrix.column[k];
      const double term = matrix.value[k] * y[column];
      given[row] -= term;
      sum[row] += std::abs(term);
    }
  double largest = 0.0, size = 0.0;
  for (size_t i = 0; i < given.size(); ++i) {
    largest = std::max(largest, std::abs(given[i]));
    size = std::max(size, sum[i]);
  }
  return largest == 0.0 ? 0.0 : largest / size;
}

/// Motions whose work with the rows of the equations is the part of a quantity that supports hold.
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
    for (const VertexJoint& joint : model_.conditions().joints) {  // whose rows the master shares
      if (joint.master != held.vertex) continue;
      if (joint.kind == JointKind::slider && norm(held.moment) > 0.0)
        throw LinearSolverError("a reaction moment at a slider has no derivative here");
      add(joint.slave, held.force, held.moment);
    }
  }
  return motion;
}

/// Adds factor * matrix^T times a motion of the vertices that chains leave.
void AdjointOperator::add_transposed(const Entries& matrix, const DofVector& motion, double factor,
                                     const KernelView<double*>& rows) const {
  const auto local = system_.matrix()->getLocalMatrixHost();
  const KernelView<const double*> x = MixedVector::view_of(motion);
  const KernelView<int*> vertices = system_.remaining().vertices();
  const auto row_of = [&](int place) { return vertex_row(vertices(place / kVertexDofs), place % kVertexDofs); };
  for (int i = 0; i < static_cast<int>(local.numRows()); ++i) {
    const double by = factor * x(row_of(i));
    if (by == 0.0) continue;
    for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1); ++k)
      rows(row_of(local.graph.entries(k))) += by * matrix.value[k];
  }
}

/// Adds the motion that supports hold, with chains and interiors at rest under it.
void AdjointOperator::add_held_motion(const DofVector& held, Adjoint& adjoint) {
  MixedVector zero = model_.create_vector();
  zero.fill(0.0);
  MixedVector motion = model_.create_vector();
  system_.condense_rows(zero.vertex_dofs(), remaining_, motion.vertex_dofs());
  system_.remaining_values(held, remaining_);
  system_.expand(remaining_, motion.vertex_dofs());
  zero.writable_interior(true);
  recover(zero, motion);
  adjoint.field.update(1.0, motion, 1.0);
}

void AdjointOperator::take_out_cap(Adjoint& adjoint) {
  if (!tangent_.cap().cuts_off) return;
  MixedVector excess = adjoint.field.clone(false);
  excess_rows(adjoint.field, excess);
  const double beta = norm_of(excess);
  if (!(beta > 0.0) || !std::isfinite(beta)) return;
  std::vector<MixedVector> basis;
  std::vector<Adjoint> responses;
  basis.push_back(std::move(excess));
  const GmresResult left_out =
      gmres(basis, beta, kCapLeftInAdjoint, kMostCapSolvesOfAdjoint, [&](const MixedVector& of, MixedVector& next) {
        responses.push_back(respond(of.clone(true)));
        excess_rows(responses.back().field, next);
        next.update(1.0, of, -1.0);
        return true;
      });
  if (!(left_out.left <= kMostCapLeftInAdjoint * beta))
    throw LinearSolverError(
        "the adjoint equations were not solved: rigid members share forces that nothing determines");
  for (size_t k = 0; k < left_out.y.size(); ++k) {
    adjoint.field.update(left_out.y[k], responses[k].field, 1.0);
    for (size_t i = 0; i < adjoint.free.size(); ++i) adjoint.free[i] += left_out.y[k] * responses[k].free[i];
  }
}

/// Moments that are held turn with the spin of their vertex by half a cross product, theory (44).
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

/// Computes the rest -q_x - R_x^T t of rows -q_x after an adjoint, with the true compliance.
MixedVector AdjointOperator::left_of(const MixedVector& rows, const Adjoint& adjoint) const {
  MixedVector left = rows.clone(true), elements = model_.create_vector();
  const KernelView<const double* [6]> motion = model_.local_increment(adjoint.field);
  const KernelView<double*> interior = left.writable_interior(true), vertex = left.vertex();
  for (const VibratingBlock& block : blocks_)
    subtract_equations(block, motion, adjoint.field.interior(), interior, vertex_rows_);
  gather(elements.vertex());
  add_transposed(outside_, adjoint.field.vertex_dofs(), -1.0, vertex);
  for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) += elements.vertex()(i);
  return left;
}

/// Condensed equations of long chains lose digits that those of elements have, and a cap that shifts no forces goes
/// with them. Returns whether the adjoint has converged: where forces are shared by stiffness it does not without
/// GMRES.
bool AdjointOperator::refine(const MixedVector& rows, bool with_gmres, Adjoint& adjoint) {
  const double whole = norm_of(adjoint.field);
  double before = whole;
  for (int pass = 0; pass < kMostRefinements; ++pass) {
    Adjoint more = respond(left_of(rows, adjoint));
    if (with_gmres) take_out_cap(more);
    const double size = norm_of(more.field);
    if (!(size <= kFastRefinement * before)) return size <= kRefined * whole;
    adjoint.field.update(1.0, more.field, 1.0);
    for (size_t i = 0; i < adjoint.free.size(); ++i) adjoint.free[i] += more.free[i];
    if (size * size <= kRefined * whole * before) return true;  // as the next one would be
    before = size;
  }
  return false;
}

/// q_x + R_x^T t at vertices that supports hold. `rows`: -q_x, but for what supports hold of it, which t has.
std::vector<double> AdjointOperator::held_rows(const MixedVector& rows, const Adjoint& adjoint) const {
  const MixedVector left = left_of(rows, adjoint);
  std::vector<double> held(left.vertex().extent(0), 0.0);
  for (const VertexSupport& support : model_.conditions().supports)
    for (size_t i = vertex_row(support.vertex, 0); i < vertex_row(support.vertex, kVertexDofs); ++i)
      held[i] = -left.vertex()(i);
  return held;
}

double AdjointOperator::work_of_free(const Adjoint& adjoint, const DofVector& projected) {
  system_.remaining_values(projected, remaining_);
  const std::vector<double> rows = unknowns_.reduced_remaining_rows(remaining_);
  double sum = 0.0;
  for (size_t i = 0; i < rows.size(); ++i) sum += rows[i] * adjoint.free[i];
  return sum;
}

namespace {

/// Rows of a quantity for a solution with R_x^T t = -q_x: stresses have the other sign in kernels/vibration.
void turn_signs(const Structure& structure, MixedVector& rows) {
  const KernelView<double*> vertex = rows.vertex(), interior = rows.writable_interior(true);
  for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) = -vertex(i);
  for_each_element(structure, [&](const ElementView& element) {
    double* row = element.increments_in(interior);
    for (int i = element.layout().relative_rotation(1); i < element.layout().increments(); ++i) row[i] = -row[i];
  });
}

}  // namespace

Adjoint AdjointOperator::solve(const StateDerivative& quantity) {
  MixedVector own = quantity.rows().clone(true);
  const DofVector held = held_motion(quantity);
  if (!quantity.held().empty()) add_turning(held, own.vertex());
  MixedVector rows = own.clone(true);
  add_transposed(whole_, held, 1.0, rows.vertex());
  turn_signs(model_.structure(), own);
  turn_signs(model_.structure(), rows);
  Adjoint adjoint = respond(std::move(rows));
  if (!quantity.held().empty()) add_held_motion(held, adjoint);
  if (!knows_all_rows_ || !refine(own, false, adjoint)) {
    take_out_cap(adjoint);
    if (knows_all_rows_) refine(own, true, adjoint);
  }
  adjoint.held = held_rows(own, adjoint);
  return adjoint;
}

}  // namespace mixbeam
