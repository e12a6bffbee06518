#include "nonlinear/path/path_measure.hpp"

#include "discretization/state/difference.hpp"
#include "nonlinear/path/thresholds.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

PathMeasure::PathMeasure(const Model& model) : weights_(model.create_vector()) {
  weights_.fill(0.0);
  const double length = model.structure().length;
  const double vertices = static_cast<double>(model.map()->getGlobalNumElements()) / kVertexDofs;
  const double displacement = 1.0 / (length * length * vertices), rotation = 1.0 / vertices;
  const KernelView<double*> w = weights_.vertex();
  Kokkos::parallel_for(
      "mixbeam::path_measure", Kokkos::RangePolicy<ExecutionSpace>(0, w.extent(0)),
      KOKKOS_LAMBDA(size_t i) { w(i) = i % kVertexDofs < 3 ? displacement : rotation; });
  parts_ = model.structure().parts;
  part_of_vertex_ = model.structure().part_of_vertex;
}

double PathMeasure::motion(const MixedVector& a, const MixedVector& b) const { return a.vertex_product(weights_, b); }

double PathMeasure::motion(const MixedVector& a) const { return std::sqrt(motion(a, a)); }

double PathMeasure::motion_beside(const MixedVector& a, double factor, const MixedVector& b) const {
  const KernelView<const double*> w = weights_.vertex(), x = a.vertex(), y = b.vertex();
  const double sum = ordered_sum(
      x.extent(0), KOKKOS_LAMBDA(size_t i) {
        const double beside = x(i) - factor * y(i);
        return beside * w(i) * beside;
      });
  return std::sqrt(sum_over_ranks(*a.vertex_dofs().getMap()->getComm(), sum));
}

std::vector<double> PathMeasure::motion_of_parts(const MixedVector& a, const MixedVector& b) const {
  if (parts_ == 1) return {motion(a, b)};
  std::vector<double> sums(parts_, 0.0);
  const KernelView<const double*> w = weights_.vertex(), x = a.vertex(), y = b.vertex();
  for (size_t v = 0; v < part_of_vertex_.size(); ++v)
    for (size_t i = kVertexDofs * v; i < kVertexDofs * (v + 1); ++i) sums[part_of_vertex_[v]] += w(i) * x(i) * y(i);
  std::vector<double> all(parts_);
  Teuchos::reduceAll(*a.vertex_dofs().getMap()->getComm(), Teuchos::REDUCE_SUM, parts_, sums.data(), all.data());
  return all;
}

double PathMeasure::cosine(const MixedVector& a, const MixedVector& b) const {
  const double lengths = motion(a) * motion(b);
  return lengths > 0.0 ? motion(a, b) / lengths : 0.0;
}

double PathMeasure::inner(const PathDirection& a, const PathDirection& b) const {
  return motion(a.x, b.x) + path_limit.load_weight * path_limit.load_weight * a.load * b.load;
}

double PathMeasure::length(const PathDirection& a) const { return std::sqrt(inner(a, a)); }

ControlRow PathMeasure::row(const PathDirection& direction, double load_start, double length) const {
  MixedVector weights = direction.x.clone(true);
  weights.multiply_by(weights_);
  return {weights, path_limit.load_weight * path_limit.load_weight * direction.load, load_start, length};
}

PathDirection scaled(const PathDirection& a, double factor) {
  PathDirection result{a.x.clone(true), factor * a.load};
  result.x.scale(factor);
  return result;
}

namespace {

/// Whether two limit points at nearly the same load factor are the same. States are known less accurately: the load is
/// stationary, and an error of 1e-7 in it is one of 3e-4 in them. The difference is relative to the displacement, not
/// to the size of the structure, since cells of a long row snap one by one at one load.
bool are_one(const Model& model, const State& a, const State& b) {
  const StateDifference apart = difference(model, a, b);
  return apart.largest_change <= path_limit.same_place * apart.largest_displacement;
}

}  // namespace

void Way::add(const PathMeasure& measure, const PathDirection& moved, const Model& model,
              const std::vector<CriticalPoint>& passed) {
  travelled_ += measure.motion(moved.x);
  sum_.vertex_dofs().update(1.0, moved.x.vertex_dofs(), 1.0);
  for (const CriticalPoint& point : passed) {
    if (point.kind != CriticalKind::limit_point) continue;
    for (const LimitPoint& limit : limits_)
      if (std::abs(limit.load_factor - point.load_factor) <= path_limit.same_load * std::abs(point.load_factor))
        meets_again_ = meets_again_ || are_one(model, limit.state, point.state);
    limits_.push_back({point.state, point.load_factor});
  }
}

bool Way::returns(const PathMeasure& measure, const Station& here, const PathDirection& last) const {
  const double chord = measure.motion(last.x);
  if (meets_again_) return true;
  return begin_.has_tangent() && travelled_ > path_limit.round_trip * chord && measure.motion(sum_) <= chord &&
         std::abs(here.load_factor - begin_.load_factor) <= std::abs(last.load) &&
         measure.cosine(here.tangent.x, begin_.tangent.x) >= path_limit.same_direction &&
         here.tangent.load * begin_.tangent.load > 0.0;
}

}  // namespace mixbeam
