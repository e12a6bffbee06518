#include "nonlinear/path/step_size.hpp"

#include <LOCA_MultiContinuation_ExtendedVector.H>
#include <LOCA_Parameter_SublistParser.H>
#include <NOX_Solver_Generic.H>

#include <algorithm>

namespace mixbeam {

double StepSizeRule::after_success(double size, int iterations) const {
  if (method == LoadPathMethod::fixed) return size == initial ? size : std::min(success_factor * size, initial);
  const double ease = (most_iterations - iterations) / most_iterations;
  return size * (1.0 + aggressiveness * ease * ease);
}

NOX::Abstract::Group::ReturnType StepSizeStrategy::computeStepSize(
    LOCA::MultiContinuation::AbstractStrategy&, const LOCA::MultiContinuation::ExtendedVector& predictor,
    const NOX::Solver::Generic& solver, const LOCA::Abstract::Iterator::StepStatus& status,
    const LOCA::Abstract::Iterator&, double& size) {
  if (attempts_ ==
      0) {  // the predictor's share of the load factor is 1 in natural continuation, but LOCA allows others
    const double share = predictor.getScalar(0);
    if (share != 0.0)
      for (double* number : {&rule_.initial, &rule_.minimum, &rule_.maximum}) *number /= share;
    size = before_ ? rule_.after_success(before_->size, before_->iterations) : rule_.initial;
  } else if (status == LOCA::Abstract::Iterator::Unsuccessful) {
    size = rule_.after_failure(size);
  } else {
    previous_ = size;
    size = rule_.after_success(size, solver.getNumIterations());
  }
  ++attempts_;
  const bool too_small = size < rule_.minimum;
  size_ = size = std::clamp(size, rule_.minimum, rule_.maximum);
  return too_small ? NOX::Abstract::Group::Failed : NOX::Abstract::Group::Ok;
}

bool StepSizeFactory::createStepSizeStrategy(const std::string& name,
                                             const Teuchos::RCP<LOCA::Parameter::SublistParser>& lists,
                                             const Teuchos::RCP<Teuchos::ParameterList>& parameters,
                                             Teuchos::RCP<LOCA::StepSize::AbstractStrategy>& strategy) {
  if (name != "Constant" && name != "Adaptive") return false;
  if (lists->getSublist("Stepper")->get<std::string>("Continuation Method") != "Natural") return false;
  StepSizeRule rule = rule_;
  rule.method = name == "Constant" ? LoadPathMethod::fixed : LoadPathMethod::adaptive;
  rule.failed_factor = parameters->get("Failed Step Reduction Factor", rule.failed_factor);
  rule.success_factor = parameters->get("Successful Step Increase Factor", rule.success_factor);
  strategy_ = Teuchos::rcp(new StepSizeStrategy(rule, before_));
  strategy = strategy_;
  return true;
}

}  // namespace mixbeam
