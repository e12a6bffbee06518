/// Equilibria at any load factor and what their tangents say, for tests of stability.
#pragma once

#include "nonlinear/stability/stability.hpp"
#include "tests/nonlinear/beam_fixture.hpp"
#include "tests/support/scene_units.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>

namespace mixbeam::test {

/// Negative eigenvalues of a symmetric matrix with a shift, by all of its eigenvalues.
inline int negative_by_lapack(const SparseMatrix& sparse, double shift = 0.0) {
  const int n = sparse.rows();
  std::vector<double> dense(static_cast<size_t>(n) * n, 0.0), values(n), work(4 * n);
  for (int i = 0; i < n; ++i) {
    for (int k = sparse.row_start[i]; k < sparse.row_start[i + 1]; ++k)
      dense[i + size_t(n) * sparse.column[k]] = sparse.value[k];
    dense[i * (size_t(n) + 1)] += shift;
  }
  int info = 0;
  Teuchos::LAPACK<int, double>().SYEV('N', 'L', n, dense.data(), n, values.data(), work.data(), 4 * n, &info);
  EXPECT_EQ(info, 0);
  return static_cast<int>(std::count_if(values.begin(), values.end(), [](double x) { return x < 0.0; }));
}

/// Equilibrium of a scene whose loads are proportional to the load factor, by Newton's method from the last one.
class StabilityFixture {
 public:
  explicit StabilityFixture(Scene scene, const Communicator& comm = this_rank(),
                            const SolverParameters& parameters = {})
      : list_(Teuchos::rcp(new Teuchos::ParameterList("mixbeam"))),
        global_(LOCA::createGlobalData(list_, Teuchos::null)) {
    for (PointLoad& load : scene.point_loads) load.amplitude = "t";
    for (DistributedLoad& load : scene.distributed_loads) load.amplitude = "t";
    problem_ = Teuchos::rcp(new BeamProblem(scene, comm, parameters));
    state_ = problem_->model.reference_state();
    stability_ = std::make_unique<Stability>(*problem_);
  }
  ~StabilityFixture() { LOCA::destroyGlobalData(global_); }
  StabilityFixture(const StabilityFixture&) = delete;
  StabilityFixture& operator=(const StabilityFixture&) = delete;

  BeamProblem& problem() { return *problem_; }
  Stability& stability() { return *stability_; }
  const State& state() const { return state_; }

  const State& equilibrium(double load_factor) {
    BeamGroup group(global_, problem_, state_, load_factor, {});
    Teuchos::ParameterList none;
    constexpr int kMostIterations = 30;
    constexpr double kConverged = 1e-12;
    for (int i = 0; i < kMostIterations; ++i) {
      group.computeF();
      if (group.getNormF() < kConverged) break;
      group.computeNewton(none);
      const Teuchos::RCP<NOX::Abstract::Group> old = group.clone(NOX::DeepCopy);
      group.computeX(*old, old->getNewton(), 1.0);
    }
    group.computeF();
    EXPECT_LT(group.getNormF(), 1e-10) << "load factor " << load_factor;
    return state_ = group.state();
  }
  /// In space, at the last equilibrium; with its interior counted.
  Tangent tangent(double load_factor) const {
    MixedVector residual = problem_->model.create_vector();
    const EvaluationPoint point = mixed_residual(problem_->model, state_, load_factor, residual);
    return Tangent(problem_->model, point, cap_for(problem_->model, point.scales), {true, true});
  }
  StabilityResult count(double load_factor) {
    return *stability_->ask({equilibrium(load_factor), load_factor}, How::inertia);
  }
  Spectrum spectrum(double load_factor, int modes) {
    return stability_->spectrum(equilibrium(load_factor), load_factor, modes);
  }
  /// Load factor at which the eigenvalue nearest to zero vanishes, by the secant method from two guesses.
  double critical(double a, double b) {
    double at_a = spectrum(a, 1).modes[0].eigenvalue;
    constexpr int kMostSteps = 12;
    for (int i = 0; i < kMostSteps && std::abs(b - a) > 1e-13 * std::abs(b); ++i) {
      const double at_b = spectrum(b, 1).modes[0].eigenvalue;
      if (at_b == at_a) break;
      const double next = b - at_b * (b - a) / (at_b - at_a);
      a = b;
      at_a = at_b;
      b = next;
    }
    return b;
  }

 private:
  Teuchos::RCP<Teuchos::ParameterList> list_;
  Teuchos::RCP<LOCA::GlobalData> global_;
  Teuchos::RCP<BeamProblem> problem_;
  std::unique_ptr<Stability> stability_;
  State state_;
};

}  // namespace mixbeam::test
