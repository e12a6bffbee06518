/// Sizes of load steps: a pure function of the step before, so that a path can go on from any completed step with the
/// same sizes as if it had never stopped.
#pragma once

#include "nonlinear/parameters/solver_parameters.hpp"

#include <LOCA_Abstract_Factory.H>
#include <LOCA_StepSize_AbstractStrategy.H>

#include <optional>

namespace mixbeam {

/// Sizes are changes of the load factor. The rules are those of LOCA's strategies "Constant" and "Adaptive".
struct StepSizeRule {
  LoadPathMethod method = LoadPathMethod::adaptive;
  double initial = 1.0, minimum = 1e-4, maximum = 1.0;
  double aggressiveness = 0.5;
  double most_iterations = 50.0;  ///< with which a step of an adaptive path does not grow at all
  double failed_factor = 0.5;     ///< after a failed attempt
  double success_factor = 1.26;   ///< fixed: after a success with a reduced size

  double after_success(double size, int iterations) const;
  double after_failure(double size) const { return failed_factor * size; }
};

/// The step that led to where a path stands.
struct LastStep {
  double size = 0.0;
  int iterations = 0;
};

/// The rule as LOCA's stepper wants it, for continuation in the load factor itself.
class StepSizeStrategy : public LOCA::StepSize::AbstractStrategy {
 public:
  /// `before`: the last step of a path that goes on; none: the path, or a stage of it, starts.
  StepSizeStrategy(const StepSizeRule& rule, const std::optional<LastStep>& before) : rule_(rule), before_(before) {}

  NOX::Abstract::Group::ReturnType computeStepSize(LOCA::MultiContinuation::AbstractStrategy& group,
                                                   const LOCA::MultiContinuation::ExtendedVector& predictor,
                                                   const NOX::Solver::Generic& solver,
                                                   const LOCA::Abstract::Iterator::StepStatus& status,
                                                   const LOCA::Abstract::Iterator& stepper, double& size) override;
  double getPrevStepSize() const override { return previous_; }
  double getStartStepSize() const override { return rule_.initial; }

  double size() const { return size_; }       ///< of the present attempt
  int attempts() const { return attempts_; }  ///< sizes given so far

 private:
  StepSizeRule rule_;
  std::optional<LastStep> before_;
  double size_ = 0.0, previous_ = 0.0;
  int attempts_ = 0;
};

/// Hands the strategy above to LOCA for natural continuation; arc length keeps LOCA's own.
class StepSizeFactory : public LOCA::Abstract::Factory {
 public:
  StepSizeFactory(const StepSizeRule& rule, const std::optional<LastStep>& before) : rule_(rule), before_(before) {}
  void init(const Teuchos::RCP<LOCA::GlobalData>&) override {}
  bool createStepSizeStrategy(const std::string& name, const Teuchos::RCP<LOCA::Parameter::SublistParser>& lists,
                              const Teuchos::RCP<Teuchos::ParameterList>& parameters,
                              Teuchos::RCP<LOCA::StepSize::AbstractStrategy>& strategy) override;

  /// Null when LOCA uses one of its own.
  const StepSizeStrategy* strategy() const { return strategy_.get(); }

 private:
  StepSizeRule rule_;
  std::optional<LastStep> before_;
  Teuchos::RCP<StepSizeStrategy> strategy_;
};

}  // namespace mixbeam
