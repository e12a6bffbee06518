#include "nonlinear/newton/beam_vector.hpp"

#include <LOCA_Extended_Vector.H>
#include <LOCA_MultiContinuation_ExtendedVector.H>

#include <cmath>
#include <stdexcept>

namespace mixbeam {

const MixedVector& BeamVector::of(const NOX::Abstract::Vector& vector) {
  if (const auto* beam = dynamic_cast<const BeamVector*>(&vector)) return beam->values();
  if (const auto* extended = dynamic_cast<const LOCA::MultiContinuation::ExtendedVector*>(&vector))
    return of(*extended->getXVec());
  throw std::logic_error("a vector that holds no beam vector reached the beam group");
}

NOX::Abstract::Vector& BeamVector::init(double gamma) {
  values().fill(gamma);
  return *this;
}

NOX::Abstract::Vector& BeamVector::random(bool, int) {
  throw std::logic_error("random beam vectors are not used by any solver of this project");
}

NOX::Abstract::Vector& BeamVector::abs(const NOX::Abstract::Vector& y) {
  values().absolute_values_of(of(y));
  return *this;
}

NOX::Abstract::Vector& BeamVector::operator=(const NOX::Abstract::Vector& y) {
  values().assign(of(y));
  return *this;
}

NOX::Abstract::Vector& BeamVector::reciprocal(const NOX::Abstract::Vector& y) {
  values().reciprocals_of(of(y));
  return *this;
}

NOX::Abstract::Vector& BeamVector::scale(double gamma) {
  values().scale(gamma);
  return *this;
}

NOX::Abstract::Vector& BeamVector::scale(const NOX::Abstract::Vector& a) {
  values().multiply_by(of(a));
  return *this;
}

NOX::Abstract::Vector& BeamVector::update(double alpha, const NOX::Abstract::Vector& a, double gamma) {
  values().update(alpha, of(a), gamma);
  return *this;
}

NOX::Abstract::Vector& BeamVector::update(double alpha, const NOX::Abstract::Vector& a, double beta,
                                          const NOX::Abstract::Vector& b, double gamma) {
  values().update(alpha, of(a), beta, of(b), gamma);
  return *this;
}

Teuchos::RCP<NOX::Abstract::Vector> BeamVector::clone(NOX::CopyType type) const {
  return Teuchos::rcp(new BeamVector(*this, type));
}

double BeamVector::norm(NormType type) const {
  if (type == MaxNorm) {
    if (!maximum_norm_) maximum_norm_ = values_.maximum_norm();
    return *maximum_norm_;
  }
  return type == OneNorm ? values_.one_norm() : std::sqrt(values_.inner_product(values_));
}

double BeamVector::norm(const NOX::Abstract::Vector& weights) const {
  MixedVector weighted = values_.clone(true);
  weighted.multiply_by(of(weights));
  return std::sqrt(weighted.inner_product(values_));
}

double BeamVector::innerProduct(const NOX::Abstract::Vector& y) const { return values_.inner_product(of(y)); }

}  // namespace mixbeam
