#include "discretization/assembly/tangent.hpp"

#include "discretization/assembly/workspace.hpp"
#include "discretization/mesh/element_view.hpp"
#include "kernels/element/layout.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <utility>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

std::shared_ptr<TangentArrays> allocate_arrays(const Model& model) {
  using Kokkos::view_alloc;
  using Kokkos::WithoutInitializing;
  auto arrays = std::make_shared<TangentArrays>();
  arrays->elements = allocate_tangents(model.structure(), model.rotating() != nullptr);
  arrays->condensed_rows = Teuchos::rcp(new DofVector(model.map()));
  for (size_t b = 0; b < model.structure().blocks.size() && model.rotating() != nullptr; ++b)
    arrays->rotating.push_back(
        allocate_vibrating_block(model.structure().blocks[b], model.rotating()->frame(b, {}).mass));
  if (model.rotating() != nullptr)
    arrays->rotating_rows = KernelView<double*>("mixbeam::frame::interior_rows", model.structure().increment_size);
  if (!model.plane()) return arrays;
  arrays->planar =
      PlanarTangents(view_alloc("mixbeam::planar::tangents", WithoutInitializing), model.structure().local_elements());
  arrays->planar_blocks = model.planar_blocks();
  for (PlanarBlock& block : arrays->planar_blocks)
    block.response = KernelView<double**>(view_alloc("mixbeam::planar::response", WithoutInitializing),
                                          block.response.extent(0), block.response.extent(1));
  return arrays;
}

std::shared_ptr<TangentArrays> take_arrays(const Model& model) {
  auto& all = model.workspace().tangents;
  auto found = std::find_if(all.begin(), all.end(), [](const auto& arrays) { return arrays.use_count() == 1; });
  if (found == all.end()) found = all.insert(all.end(), allocate_arrays(model));
  const ElementEquations& rows = model.workspace().rows;
  (*found)->elements.condensed_residual = rows.residual;
  (*found)->elements.planar_rows = rows.planar_rows;
  (*found)->elements.planar_loads = rows.planar_loads;
  return *found;
}

bool is_zero_inside(const MixedVector& rows) {
  const KernelView<const double*> x = rows.interior();
  return rows.shares_zeros() || std::all_of(x.data(), x.data() + x.extent(0), [](double row) { return row == 0.0; });
}

}  // namespace

Tangent::Tangent(const Model& model, const EvaluationPoint& point, const Cap& cap, const TangentKind& kind)
    : model_(&model),
      point_(point),
      cap_(cap),
      planar_(point.state.in_plane && !kind.in_space),
      springs_(kind.springs),
      arrays_(take_arrays(model)),
      constants_(model.create_vector()) {
  if (kind.counts_interior && arrays_->interior_negative.extent(0) == 0)
    arrays_->interior_negative =
        KernelView<int*>("mixbeam::elements::interior_negative", model.structure().local_elements());
  arrays_->elements.interior_negative = kind.counts_interior ? arrays_->interior_negative : KernelView<int*>();
  const MixedVector* rhs = kind.right_hand_side;
  if (rhs == nullptr || !arrays_->rotating.empty() || is_zero_inside(*rhs)) {
    evaluate();
  } else {
    condense(*rhs);
    held_ = *rhs;
  }
}

const ElementEquations& Tangent::elements() const { return arrays_->elements; }
const PlanarTangents& Tangent::planar_elements() const { return arrays_->planar; }
DofVector& Tangent::condensed_rows() const { return *arrays_->condensed_rows; }

StructureViews Tangent::structure_views() const {
  StructureViews views = cap_.structure;
  views.field_value = point_.line_fields;
  return views;
}

/// Evaluates only the matrices.
void Tangent::evaluate_rotating() const {
  const RotatingElements& rotating = *model_->rotating();
  const KernelView<int*> negative = arrays_->elements.interior_negative;
  for (size_t b = 0; b < arrays_->rotating.size(); ++b) {
    const VibratingBlock& own = arrays_->rotating[b];
    evaluate_vibration(own, structure_views(), point_.state.views, 0.0,
                       negative.extent(0) > 0 ? VibrationUse::counted : VibrationUse::condensed,
                       arrays_->elements.condensed_tangent, rotating.frame(b, rotating.spin().at(point_.load_factor)));
    for (int e = 0; e < own.block.count && negative.extent(0) > 0; ++e)
      negative(own.block.first_element + e) = own.negative(e);
  }
}

/// Condenses interior rows and the rows of element ends in the workspace.
void Tangent::condense_rotating(const KernelView<const double*>& interior) const {
  Kokkos::deep_copy(arrays_->rotating_rows, interior);
  const KernelView<double* [12]> ends = model_->workspace().rows.residual;
  for (const VibratingBlock& own : arrays_->rotating) {
    take_residual(own, arrays_->rotating_rows, ends);
    condense_rows(own, arrays_->rotating_rows, ends);
  }
  Kokkos::parallel_for(
      "mixbeam::frame::condensed", Range(0, ends.extent(0)), KOKKOS_LAMBDA(int e) {
        for (int i = 0; i < 12; ++i) ends(e, i) = -ends(e, i);
      });
}

void Tangent::evaluate_in_space(MixedVector& constants) const {
  PhaseTimer timer(model_->times(), "element tangent");
  if (!arrays_->rotating.empty()) {
    evaluate_rotating();
    MixedVector rows = model_->create_vector();
    element_rows(*model_, point_.state, point_.load_factor, ElementLoads::with_centrifugal, rows);
    condense_rotating(rows.interior());
    return;
  }
  ElementEquations to = arrays_->elements;
  to.constants = constants.writable_interior(false);
  for (const ElementBlock& block : model_->structure().blocks)
    evaluate_tangent(block, structure_views(), point_.state.views, to);
}

void Tangent::evaluate() {
  if (planar_) {
    PhaseTimer timer(model_->times(), "element tangent");
    for (size_t b = 0; b < arrays_->planar_blocks.size(); ++b)
      evaluate_planar_tangent(model_->structure().blocks[b], arrays_->planar_blocks[b], structure_views(),
                              point_.state.views, arrays_->planar, arrays_->elements);
  } else {
    evaluate_in_space(constants_);
  }
  PhaseTimer timer(model_->times(), "assemble");
  const KernelView<double*> rows = MixedVector::view_of(condensed_rows());
  gather_condensed_rows(arrays_->elements.planar_loads, rows);
  for (const auto& energy : model_->external()) energy->add_rows(point_.state, point_.load_factor, rows);
  model_->constraints().project(point_.state, rows);
  model_->constraints().set(point_.state, point_.load_factor, rows);
  holds_residual_ = true;
}

void Tangent::gather_condensed_rows(const KernelView<double* [2]>& loads, const KernelView<double*>& rows) const {
  if (planar_)
    gather_planar_rows(*model_, loads, rows);
  else
    gather_rows(*model_, rows);
}

bool Tangent::condense_residual() {
  if (holds_residual_) return false;
  held_.reset();
  evaluate();
  return true;
}

/// Returns the spatial vertex rows due to the interior rows, which may be moved out of `rhs`.
KernelView<double*> Tangent::condense_interior(MixedVector& rhs) {
  holds_residual_ = false;
  constants_.fill(0.0);
  const MixedVector& given = rhs;
  const KernelView<const double*> interior(given.interior().data(), given.interior().extent(0));  // not an owner
  const Structure& structure = model_->structure();
  const KernelView<double*> rows = MixedVector::view_of(condensed_rows());
  if (arrays_->rotating.empty() && is_zero_inside(rhs)) {
    for (size_t b = 0; b < structure.blocks.size() && planar_; ++b)
      clear_planar_right_hand_side(arrays_->planar_blocks[b]);
    Kokkos::deep_copy(rows, 0.0);
    return rows;
  }
  if (!arrays_->rotating.empty()) {
    Kokkos::deep_copy(model_->workspace().rows.residual, 0.0);
    condense_rotating(interior);
  }
  ElementEquations to = arrays_->elements;
  if (!planar_ && arrays_->rotating.empty()) {
    constants_.take_interior(rhs);
    to.constants = constants_.writable_interior(true);
  }
  for (size_t b = 0; b < structure.blocks.size() && arrays_->rotating.empty(); ++b)
    if (planar_)
      condense_planar_right_hand_side(structure.blocks[b], arrays_->planar_blocks[b], structure_views(),
                                      point_.state.views, interior, arrays_->planar, to);
    else
      condense_right_hand_side(structure.blocks[b], structure_views(), point_.state.views, to.constants, to);
  gather_condensed_rows({}, rows);
  return rows;
}

bool Tangent::condense(const MixedVector& scaled_rhs) {
  const std::optional<MixedVector> held = std::exchange(held_, std::nullopt);
  if (held && held->shares_entries(scaled_rhs)) return false;
  PhaseTimer timer(model_->times(), "condense right-hand side");
  MixedVector rhs = scaled_rhs.clone(true);
  unscale_rows(*model_, point_.scales, rhs);
  const KernelView<double*> rows = condense_interior(rhs);
  project_on_free_motions(rows);
  const KernelView<double*> given = rhs.vertex();
  const auto fixed = model_->fixed_rows();
  Kokkos::parallel_for(
      "mixbeam::condense::vertex", Range(0, rows.extent(0)),
      KOKKOS_LAMBDA(size_t i) { rows(i) = fixed(i) ? given(i) : rows(i) + given(i); });
  return true;
}

void Tangent::condense_spatial(const MixedVector& rows) {
  PhaseTimer timer(model_->times(), "condense right-hand side");
  MixedVector rhs = rows.clone(true);
  const KernelView<double*> all = condense_interior(rhs);
  const KernelView<const double*> given = rows.vertex();
  for (size_t i = 0; i < all.extent(0); ++i) all(i) += given(i);
  project_on_free_motions(all);
}

void Tangent::recover(MixedVector& increment) const {
  increment.share_interior(constants_);
  recover_in_place(increment);
}

void Tangent::recover_last(MixedVector& increment) {
  if (!constants_.shares_zeros()) holds_residual_ = false;
  increment.take_interior(constants_);
  recover_in_place(increment);
}

void Tangent::recover_in_place(MixedVector& increment) const {
  PhaseTimer timer(model_->times(), "recover");
  const Structure& structure = model_->structure();
  const KernelView<const double* [6]> vertex = model_->local_increment(increment);
  const KernelView<double*> interior = increment.writable_interior(!planar_ && arrays_->rotating.empty());
  for (const VibratingBlock& own : arrays_->rotating) recover_motion(own, arrays_->rotating_rows, vertex, interior);
  for (size_t b = 0; b < structure.blocks.size() && arrays_->rotating.empty(); ++b)
    if (planar_)
      recover_planar_interior(structure.blocks[b], arrays_->planar_blocks[b], vertex, interior);
    else
      recover_interior(structure.blocks[b], structure_views(), point_.state.views, arrays_->elements, vertex, interior);
}

void Tangent::gather(const VertexMatrix& matrix) const {
  MixedVector unused = model_->create_vector();
  if (planar_) evaluate_in_space(unused);
  PhaseTimer timer(model_->times(), "assemble");
  gather(matrix, LinkMatrices<kSpatialDofs>{arrays_->elements.condensed_tangent, {}});
}

void Tangent::gather(const VertexMatrix& matrix, const LinkMatrices<kSpatialDofs>& links,
                     const std::function<void(const MatrixRows&)>& add_more) const {
  matrix.gather(links);
  const MatrixRows rows = matrix.rows();
  for (const auto& energy : model_->external()) energy->add_tangent(point_.state, point_.load_factor, rows);
  add_springs(rows);
  if (add_more) add_more(rows);
  model_->constraints().project(point_.state, *point_.carried, rows);
}

void Tangent::add_springs(const MatrixRows& rows) const {
  for (size_t i = 0; i < springs_.extent(0); i += 3) {
    const int vertex = static_cast<int>(i / kVertexDofs);
    const VertexPart part = i % kVertexDofs == 0 ? kForcePart : kMomentPart;
    Mat stiffness{};
    for (int c = 0; c < 3; ++c) stiffness(c, c) = springs_(i + c);
    rows.add(vertex, part, vertex, part, stiffness);
  }
}

Tangent::InteriorCount Tangent::interior_count() const {
  const Structure& structure = model_->structure();
  long mine[2] = {0, 0};
  for_each_element(structure, [&](const ElementView& element) {
    if (!element.is_owned()) return;  // counted by the rank that owns its first vertex
    const int negative = arrays_->interior_negative(element.local());
    if (negative == kUncertainCount)
      mine[1] = 1;
    else
      mine[0] += negative;
  });
  long all[2] = {mine[0], mine[1]};
  Teuchos::reduceAll(*model_->map()->getComm(), Teuchos::REDUCE_SUM, 2, mine, all);
  return {all[0], all[1] > 0};
}

}  // namespace mixbeam
