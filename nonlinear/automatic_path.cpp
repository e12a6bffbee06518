#include "nonlinear/automatic_path.hpp"

#include "nonlinear/automatic_stage.hpp"
#include "nonlinear/beam_group.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace mixbeam {

PathMeasure::PathMeasure(const Assembler& assembler) : weights_(assembler.create_vector()) {
  weights_.fill(0.0);
  const double length = assembler.structure().length;
  const double vertices = static_cast<double>(assembler.map()->getGlobalNumElements()) / kVertexDofs;
  const KernelView<double*> w = weights_.vertex();
  Kokkos::parallel_for(
      "mixbeam::path_measure", Kokkos::RangePolicy<ExecutionSpace>(0, w.extent(0)), KOKKOS_LAMBDA(size_t i) {
        w(i) = (i % kVertexDofs < 3 ? 1.0 / (length * length) : 1.0) / vertices;
      });
}

double PathMeasure::inner(const MixedVector& a, const MixedVector& b) const {
  MixedVector weighted = a.clone(true);
  weighted.multiply_by(weights_);
  return weighted.inner_product(b);
}

double PathMeasure::length(const MixedVector& x, double load) const { return std::sqrt(inner(x, x) + load * load); }

ControlRow PathMeasure::row(const PathDirection& direction, double load_start, double length) const {
  MixedVector weights = direction.x.clone(true);
  weights.multiply_by(weights_);
  return {weights, direction.load, load_start, length};
}

namespace {
double env(const char* name, double value) { const char* t = std::getenv(name); return t ? std::atof(t) : value; }

class StageFollower {
 public:
  StageFollower(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters, SolveRecord& record,
        const StageCallbacks& callbacks)
      : problem_(problem),
        parameters_(parameters),
        callbacks_(callbacks),
        corrector_(problem, parameters, record),
        measure_(problem->assembler) {}

  bool follow(State& state, double from, double to) {
    Correction start = corrector_.at_load({state, from}, parameters_.newton.maximum_iterations);
    if (!start.converged) { fail(start, from, 0.0); return false; }
    state = start.state;
    callbacks_.converged(start);
    const int first = static_cast<int>(env("FIRST", 25));
    if (first > 0) {
    Correction all = corrector_.at_load({state, to}, first);
    if (all.converged) { state = all.state; callbacks_.converged(all); return true; }
    fail(all, from, to - from);
    }
    return trace(state, from, to);
  }

  void fail(const Correction& c, double from, double size) {
    std::fprintf(stderr, "   failed from %.6f size %.3g: %s\n", from, size, c.cause.c_str());
  }

  PathDirection tangent(const State& state, double load_factor) {
    BeamGroup group(corrector_.global(), problem_, state, load_factor, {});
    group.computeF();
    group.computeJacobian();
    BeamVector slope(problem_->assembler.create_vector());
    problem_->assembler.use_scales(problem_->assembler.scales());
    problem_->assembler.load_derivative(state, load_factor, slope.values());
    BeamVector x(problem_->assembler.create_vector());
    Teuchos::ParameterList none;
    group.applyJacobianInverse(none, slope, x);
    x.scale(-1.0);
    const double length = measure_.length(x.values(), 1.0);
    x.scale(1.0 / length);
    return {x.values().clone(true), 1.0 / length};
  }

  bool trace(State& state, double from, double to) {
    double load = from;
    PathDirection direction = tangent(state, load);
    // initial step
    double spin = direction.x.largest_vertex_spin();
    double step = std::min(env("SPIN0", 0.5) / std::max(spin, 1e-300), (to - from) / std::abs(direction.load));
    const bool secant = env("SECANT", 0) > 0;
    const double spin_max = env("SPINMAX", 1e9);
    const int most = static_cast<int>(env("MOST", 12));
    const double want = env("WANT", 6);
    for (int k = 0; k < 2000; ++k) {
      step = std::min(step, spin_max / direction.x.largest_vertex_spin());
      MixedVector moved = direction.x.clone(true);
      moved.scale(step);
      double guess_load = load + step * direction.load;
      const bool last = guess_load >= to;
      Correction c{false, state, load, moved, 0, 0.0, {}};
      if (last) {
        const double r = (to - load) / direction.load;
        moved.scale(r / step);
        c = corrector_.at_load({state, to, &moved}, most);
        if (!c.converged) fail(c, load, r), step = r, c = Correction{false, state, load, moved, 0,0,"x"};
      } else {
        c = corrector_.on_row({state, guess_load, &moved}, measure_.row(direction, load, step), most);
        if (!c.converged) fail(c, load, step);
      }
      if (!c.converged) { step *= 0.5; if (step < 1e-6) return false; continue; }
      if (!last && c.load_factor > to) {
        const double r = (to - load) / (c.load_factor - load);
        MixedVector part = c.moved.clone(true);
        part.scale(r);
        c = corrector_.at_load({state, to, &part}, most);
        if (!c.converged) { fail(c, load, step); step *= 0.5; continue; }
      }
      MixedVector done = c.moved.clone(true);
      const double dl = c.load_factor - load;
      const double len = measure_.length(done, dl);
      PathDirection next = tangent(c.state, c.load_factor);
      double cosine = (measure_.inner(done, next.x) + dl * next.load) / len;
      if (cosine < 0) { next.x.scale(-1.0); next.load = -next.load; cosine = -cosine; }
      const double straight = (measure_.inner(done, direction.x) + dl * direction.load) / len;
      const double turn = measure_.inner(direction.x, next.x) + direction.load * next.load;
      if (std::getenv("VERB")) std::fprintf(stderr, "  %3d load %.8f ds %.4g len %.4g its %d spin %.3f dload %.3g straight %.4f turn %.4f\n", k, c.load_factor, step, len, c.iterations,
                   done.largest_vertex_spin(), next.load, straight, turn);
      if ((turn < env("TURN", 0.5) || straight < env("STRAIGHT", 0.85)) && step > 1e-4) { std::fprintf(stderr, "   turned\n"); step = 0.5 * std::min(len, step); continue; }
      state = c.state;
      load = c.load_factor;
      callbacks_.converged(c);
      if (load >= to) return true;
      if (secant) { next.x = done.clone(true); next.x.scale(1.0 / len); next.load = dl / len; }
      direction = next;
      const double angle = std::acos(std::clamp(turn, -1.0, 1.0));
      step *= std::clamp(std::min(std::pow(want / c.iterations, env("POW", 1.0)), env("ANGLE", 0.5) / std::max(angle, 1e-9)), 0.5, 2.0);
    }
    return false;
  }

 private:
  Teuchos::RCP<BeamProblem> problem_;
  const SolverParameters& parameters_;
  const StageCallbacks& callbacks_;
  Corrector corrector_;
  PathMeasure measure_;
};
}  // namespace

bool follow_automatically(const Teuchos::RCP<BeamProblem>& problem, const SolverParameters& parameters,
                          SolveRecord& record, const StageCallbacks& callbacks, State& state, double from, double to) {
  StageFollower stage(problem, parameters, record, callbacks);
  return stage.follow(state, from, to);
}

}  // namespace mixbeam
