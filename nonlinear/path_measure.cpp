#include "nonlinear/path_measure.hpp"

#include <cmath>

namespace mixbeam {

PathMeasure::PathMeasure(const Assembler& assembler) : weights_(assembler.create_vector()) {
  weights_.fill(0.0);
  const double length = assembler.structure().length;
  const double vertices = static_cast<double>(assembler.map()->getGlobalNumElements()) / kVertexDofs;
  const double displacement = 1.0 / (length * length * vertices), rotation = 1.0 / vertices;
  const KernelView<double*> w = weights_.vertex();
  Kokkos::parallel_for(
      "mixbeam::path_measure", Kokkos::RangePolicy<ExecutionSpace>(0, w.extent(0)),
      KOKKOS_LAMBDA(size_t i) { w(i) = i % kVertexDofs < 3 ? displacement : rotation; });
}

double PathMeasure::inner(const PathDirection& a, const PathDirection& b) const {
  MixedVector weighted = a.x.clone(true);
  weighted.multiply_by(weights_);
  return weighted.inner_product(b.x) + a.load * b.load;
}

double PathMeasure::length(const PathDirection& a) const { return std::sqrt(inner(a, a)); }

ControlRow PathMeasure::row(const PathDirection& direction, double load_start, double length) const {
  MixedVector weights = direction.x.clone(true);
  weights.multiply_by(weights_);
  return {weights, direction.load, load_start, length};
}

PathDirection scaled(const PathDirection& a, double factor) {
  PathDirection result{a.x.clone(true), factor * a.load};
  result.x.scale(factor);
  return result;
}

PathDirection path_tangent(const Teuchos::RCP<LOCA::GlobalData>& global, const Teuchos::RCP<BeamProblem>& problem,
                           const PathMeasure& measure, const State& state, double load_factor) {
  BeamGroup group(global, problem, state, load_factor, {});
  group.computeJacobian();
  BeamVector slope(problem->assembler.create_vector());
  problem->assembler.load_derivative(state, load_factor, slope.values());
  BeamVector x(problem->assembler.create_vector());
  Teuchos::ParameterList none;
  group.applyJacobianInverse(none, slope, x);
  const PathDirection rate{x.values().clone(true), -1.0};
  return scaled(rate, -1.0 / measure.length(rate));
}

}  // namespace mixbeam
