/// A beam group with what it needs, for tests of the group and its vectors.
#pragma once

#include "nonlinear/newton/beam_group.hpp"
#include "tests/support/solve.hpp"
#include "tests/support/states.hpp"

#include <LOCA_GlobalData.H>

namespace mixbeam::test {

inline bool same_bits(const NOX::Abstract::Vector& a, const NOX::Abstract::Vector& b) {
  return same_bits(BeamVector::of(a), BeamVector::of(b));
}

/// Force stiffness never capped: the tangent is that of the residual, to the last digit.
inline SolverParameters without_cap() {
  SolverParameters parameters;
  parameters.linear.force_stiffness_cap = 1e12;
  return parameters;
}

class BeamFixture {
 public:
  BeamFixture(const Scene& scene, double load_factor, const SolverParameters& parameters = without_cap())
      : list_(Teuchos::rcp(new Teuchos::ParameterList("mixbeam"))),
        global_(LOCA::createGlobalData(list_, Teuchos::null)),
        problem_(Teuchos::rcp(new BeamProblem(scene, this_rank(), parameters))),
        group_(Teuchos::rcp(new BeamGroup(global_, problem_, problem_->model.reference_state(), load_factor, {}))) {}
  ~BeamFixture() {
    group_ = Teuchos::null;
    LOCA::destroyGlobalData(global_);
  }
  BeamFixture(const BeamFixture&) = delete;
  BeamFixture& operator=(const BeamFixture&) = delete;

  BeamGroup& group() { return *group_; }
  BeamProblem& problem() { return *problem_; }
  BeamVector create_vector() const { return BeamVector(problem_->model.create_vector()); }
  BeamVector random_vector(double size, unsigned seed) const {
    BeamVector v = create_vector();
    fill_at_random(v.values(), size, seed);
    return v;
  }
  Teuchos::ParameterList& no_parameters() { return none_; }

  void newton_step(double fraction = 1.0) {
    compute();
    const Teuchos::RCP<NOX::Abstract::Group> old = group().clone(NOX::DeepCopy);
    group().computeX(*old, old->getNewton(), fraction);
  }
  /// Residual and Newton increment where the group is.
  void compute() {
    group().computeF();
    group().computeNewton(none_);
  }
  /// What the tangent of the group answers to these rows.
  BeamVector answer_to(const NOX::Abstract::Vector& rows) {
    BeamVector answer = create_vector();
    EXPECT_EQ(group().applyJacobianInverse(none_, rows, answer), NOX::Abstract::Group::Ok);
    return answer;
  }
  /// Newton's method without any limit: for small loads.
  void converge() {
    constexpr int kMostIterations = 30;
    constexpr double kConverged = 1e-12;
    for (int i = 0; i < kMostIterations; ++i) {
      newton_step();
      group().computeF();
      if (group().getNormF() < kConverged) return;
    }
    ADD_FAILURE() << "not converged: " << group().getNormF();
  }

 private:
  Teuchos::RCP<Teuchos::ParameterList> list_;
  Teuchos::RCP<LOCA::GlobalData> global_;
  Teuchos::RCP<BeamProblem> problem_;
  Teuchos::RCP<BeamGroup> group_;
  Teuchos::ParameterList none_;
};

}  // namespace mixbeam::test
