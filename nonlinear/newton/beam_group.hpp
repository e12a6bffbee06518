/// Adapters that present vectors and equations to NOX and LOCA.
#pragma once

#include "nonlinear/newton/step.hpp"

#include <LOCA.H>
#include <LOCA_Abstract_Group.H>

#include <functional>
#include <optional>

namespace mixbeam {

/// A mixed vector for NOX and LOCA. Increments and scaled residuals are elements of a vector space; the "solution
/// vector" of a BeamGroup is only a coordinate (the sum of all increments so far), because configurations with
/// rotations do not add.
class BeamVector : public NOX::Abstract::Vector {
 public:
  explicit BeamVector(MixedVector values) : values_(std::move(values)) {}
  BeamVector(const BeamVector& other, NOX::CopyType type)
      : values_(other.values_.clone(type == NOX::DeepCopy)), is_negated_(other.is_negated_) {
    if (type == NOX::DeepCopy) maximum_norm_ = other.maximum_norm_;
  }
  BeamVector(const BeamVector& other) : BeamVector(other, NOX::DeepCopy) {}
  // The implicit operator would call the pure virtual one of the base class.
  BeamVector& operator=(const BeamVector& other) {
    values_.assign(other.values_);
    is_negated_ = other.is_negated_;
    maximum_norm_ = other.maximum_norm_;
    return *this;
  }

  /// Values to be written at once: norm() caches its result and would miss later writes through this reference.
  MixedVector& values() {
    maximum_norm_.reset();
    give_sign();
    return values_;
  }
  const MixedVector& values() const {
    give_sign();
    return values_;
  }
  /// The mixed vector inside any vector passed by NOX or LOCA, also one extended by continuation parameters.
  static const MixedVector& of(const NOX::Abstract::Vector& vector);

  NOX::Abstract::Vector& init(double gamma) override;
  NOX::Abstract::Vector& random(bool use_seed, int seed) override;
  NOX::Abstract::Vector& abs(const NOX::Abstract::Vector& y) override;
  NOX::Abstract::Vector& operator=(const NOX::Abstract::Vector& y) override;
  NOX::Abstract::Vector& reciprocal(const NOX::Abstract::Vector& y) override;
  NOX::Abstract::Vector& scale(double gamma) override;
  NOX::Abstract::Vector& scale(const NOX::Abstract::Vector& a) override;
  NOX::Abstract::Vector& update(double alpha, const NOX::Abstract::Vector& a, double gamma) override;
  NOX::Abstract::Vector& update(double alpha, const NOX::Abstract::Vector& a, double beta,
                                const NOX::Abstract::Vector& b, double gamma) override;
  Teuchos::RCP<NOX::Abstract::Vector> clone(NOX::CopyType type) const override;
  double norm(NormType type) const override;
  double norm(const NOX::Abstract::Vector& weights) const override;
  double innerProduct(const NOX::Abstract::Vector& y) const override;
  NOX::size_type length() const override { return static_cast<NOX::size_type>(values_.global_length()); }

 private:
  void give_sign() const {
    if (is_negated_) values_.scale(-1.0);
    is_negated_ = false;
  }

  mutable MixedVector values_;
  mutable bool is_negated_ = false;             ///< the vector is -values_: LOCA negates each solution twice
  mutable std::optional<double> maximum_norm_;  ///< cached: status tests and reports all ask for that of F
};

/// Name of the continuation parameter.
inline constexpr const char* kLoadFactor = "load factor";

/// The nonlinear system for NOX and LOCA. It defines the update "x + a d": displacements and interior unknowns are
/// added, rotations are composed with exp(a dtheta), so no total rotation vector exists that could reach 2 pi.
class BeamGroup : public LOCA::Abstract::Group {
 public:
  /// Called once for every converged step.
  using StepObserver = std::function<void(const BeamGroup& group, double load_factor)>;

  BeamGroup(const Teuchos::RCP<LOCA::GlobalData>& global, const Teuchos::RCP<BeamProblem>& problem,
            const State& initial, double load_factor, StepObserver observer, const TangentChoice& choice = {});
  BeamGroup(const Teuchos::RCP<BeamProblem>& problem, const State& initial, double load_factor,
            const TangentChoice& choice = {})
      : BeamGroup(problem->loca->global, problem, initial, load_factor, {}, choice) {}
  BeamGroup(const BeamGroup& other, NOX::CopyType type);
  BeamGroup& operator=(const BeamGroup& source);

  const State& state() const { return state_; }
  BeamProblem& problem() const { return *problem_; }
  double load_factor() const { return parameters_.getValue(kLoadFactor); }
  /// Divisors of the rows of F.
  const ResidualScales& scales() const { return point_.scales; }
  /// Point at which F was evaluated.
  const EvaluationPoint& point() const { return point_; }
  /// The factorised tangent at this state, without the Newton increment. `first`: see linearize().
  Linearization& linearization(const MixedVector* first = nullptr);
  /// Evaluates anew the tangent that the Newton increment here is computed with.
  Tangent tangent() const;
  /// Largest equilibrium row (forces and moments, compatibility left out) of the scaled residual.
  double equilibrium_norm() const;
  /// Largest strain or relative rotation that the cap of the last tangent left out of the Newton step from `before` to
  /// here, relative to the motion of the structure; zero if the increment was corrected (newton/step.hpp).
  double left_out_since(const BeamGroup& before) const;
  /// The beam group inside any group passed by NOX or LOCA.
  static const BeamGroup& of(const NOX::Abstract::Group& group);

  // NOX::Abstract::Group
  NOX::Abstract::Group& operator=(const NOX::Abstract::Group& source) override;
  /// Moves the state by the difference to the present coordinate; setX(getX()) changes no bit.
  void setX(const NOX::Abstract::Vector& y) override;
  void computeX(const NOX::Abstract::Group& from, const NOX::Abstract::Vector& direction, double step) override;
  ReturnType computeF() override;
  ReturnType computeJacobian() override;
  ReturnType computeGradient() override { return NotDefined; }
  ReturnType computeNewton(Teuchos::ParameterList& params) override;
  /// Defined for the Newton direction only, where the result is -F: the mixed tangent is never formed.
  ReturnType applyJacobian(const NOX::Abstract::Vector& input, NOX::Abstract::Vector& result) const override;
  ReturnType applyJacobianInverse(Teuchos::ParameterList& params, const NOX::Abstract::Vector& input,
                                  NOX::Abstract::Vector& result) const override;
  bool isF() const override { return valid_f_; }
  bool isJacobian() const override { return linearization_ != nullptr; }
  bool isGradient() const override { return false; }
  bool isNewton() const override { return valid_newton_; }
  const NOX::Abstract::Vector& getX() const override { return *x_; }
  const NOX::Abstract::Vector& getF() const override { return *f_; }
  double getNormF() const override { return f_->norm(NOX::Abstract::Vector::MaxNorm); }
  const NOX::Abstract::Vector& getGradient() const override;
  const NOX::Abstract::Vector& getNewton() const override { return *newton_; }
  Teuchos::RCP<const NOX::Abstract::Vector> getXPtr() const override { return x_; }
  Teuchos::RCP<const NOX::Abstract::Vector> getFPtr() const override { return f_; }
  Teuchos::RCP<const NOX::Abstract::Vector> getGradientPtr() const override { return Teuchos::null; }
  Teuchos::RCP<const NOX::Abstract::Vector> getNewtonPtr() const override { return newton_; }
  Teuchos::RCP<NOX::Abstract::Group> clone(NOX::CopyType type) const override;

  // LOCA
  void copy(const NOX::Abstract::Group& source) override;
  void setParamsMulti(const std::vector<int>& ids, const NOX::Abstract::MultiVector::DenseMatrix& values) override;
  void setParams(const LOCA::ParameterVector& parameters) override;
  void setParam(int id, double value) override;
  void setParam(std::string id, double value) override;
  const LOCA::ParameterVector& getParams() const override { return parameters_; }
  double getParam(int id) const override { return parameters_.getValue(id); }
  double getParam(std::string id) const override { return parameters_.getValue(id); }
  ReturnType computeDfDpMulti(const std::vector<int>& ids, NOX::Abstract::MultiVector& dfdp, bool is_valid_f) override;
  void printSolution(double load_factor) const override;
  void printSolution(const NOX::Abstract::Vector&, double) const override {}
  double computeScaledDotProduct(const NOX::Abstract::Vector& a, const NOX::Abstract::Vector& b) const override;
  void scaleVector(NOX::Abstract::Vector& x) const override;

 private:
  void reset() {
    valid_f_ = valid_newton_ = false;
    linearization_.reset();
  }
  const MixedVector& rows() const { return BeamVector::of(*f_); }  ///< F for reading, so that its cached norm stays
  Cap cap() const { return cap_for(problem_->model, point_.scales, choice_.cap_raise); }
  void linearize_here(bool in_space, const MixedVector* first) const;
  void find_newton() const;
  double enough_for_increment() const;

  Teuchos::RCP<LOCA::GlobalData> global_;
  Teuchos::RCP<BeamProblem> problem_;
  LOCA::ParameterVector parameters_;
  State state_;
  Teuchos::RCP<BeamVector> x_, f_, newton_;
  EvaluationPoint point_;
  StepObserver observer_;
  TangentChoice choice_;
  bool valid_f_ = false;
  double norm_before_ = 0.0;  ///< of F at the start of the last Newton step; zero: not known
  // Caches that belong to F: the Newton increment and the tangent, which copies evaluate anew when they need it.
  mutable bool valid_newton_ = false;
  mutable Cap newton_cap_;  ///< cap that is left in the Newton increment; stiffness zero if it was removed
  mutable std::unique_ptr<Linearization> linearization_;
};

}  // namespace mixbeam
