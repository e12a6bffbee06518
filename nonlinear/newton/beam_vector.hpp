/// A mixed vector as NOX and LOCA see it. Increments and scaled residuals are vectors in the true sense; the "solution
/// vector" of a BeamGroup is only a coordinate (the sum of all increments so far), because configurations with
/// rotations do not add.
#pragma once

#include "discretization/mesh/mixed_vector.hpp"

#include <NOX_Abstract_Vector.H>

#include <optional>

namespace mixbeam {

class BeamVector : public NOX::Abstract::Vector {
 public:
  explicit BeamVector(MixedVector values) : values_(std::move(values)) {}
  BeamVector(const BeamVector& other, NOX::CopyType type) : values_(other.values_.clone(type == NOX::DeepCopy)) {
    if (type == NOX::DeepCopy) maximum_norm_ = other.maximum_norm_;
  }
  BeamVector(const BeamVector& other) : BeamVector(other, NOX::DeepCopy) {}
  // The implicit operator would call the pure virtual one of the base.
  BeamVector& operator=(const BeamVector& other) {
    values_.assign(other.values_);
    maximum_norm_ = other.maximum_norm_;
    return *this;
  }

  /// For writing at once: what is written after the next question for a norm would not be seen by it.
  MixedVector& values() {
    maximum_norm_.reset();
    return values_;
  }
  const MixedVector& values() const { return values_; }
  /// The mixed vector inside any vector that NOX or LOCA hands over, also one extended by continuation parameters.
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
  MixedVector values_;
  mutable std::optional<double> maximum_norm_;  ///< once known: status tests and reports all ask for that of F
};

}  // namespace mixbeam
