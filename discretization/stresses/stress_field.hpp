/// Stress fields of families of shapes; SectionStresses chooses one.
#pragma once

#include "discretization/scene/section_shape.hpp"
#include "discretization/stresses/section_stresses.hpp"

#include <cmath>
#include <memory>

namespace mixbeam {

/// T, Q2, Q3 of a section, which cause shear stresses.
using ShearLoad = std::array<double, 3>;

/// sigma = constant + slope2 x2 + slope3 x3
struct NormalStress {
  double constant = 0.0, slope2 = 0.0, slope3 = 0.0;
  double at(double x2, double x3) const { return constant + slope2 * x2 + slope3 * x3; }
};

/// Largest sqrt(sigma^2 + 3 tau^2) of those that are added; of equal ones the first. `equal`: relative rounding of the
/// values.
class LargestVonMises {
 public:
  explicit LargestVonMises(double equal) : equal_(equal) {}
  void add(double square, const SectionPoint& point) {
    if (square <= square_ * (1.0 + equal_)) return;
    square_ = square;
    point_ = point;
  }
  double square() const { return square_; }
  LargestStress found() const { return {std::sqrt(square_), point_}; }

 private:
  double equal_;
  double square_ = 0.0;
  SectionPoint point_{};
};

class StressField {
 public:
  virtual ~StressField() = default;
  StressField(const StressField&) = delete;
  StressField& operator=(const StressField&) = delete;

  /// tau_12, tau_13
  virtual std::array<double, 2> shear(const ShearLoad& load, double x2, double x3) const = 0;
  virtual bool contains(double x2, double x3) const = 0;
  /// Point of the section that is farthest in a direction, from the centroid.
  virtual SectionPoint farthest(double direction2, double direction3) const = 0;
  /// Point farthest in the opposite direction; most shapes are symmetric.
  virtual SectionPoint farthest_against(double direction2, double direction3) const {
    const SectionPoint p = farthest(direction2, direction3);
    return {-p[0], -p[1]};
  }
  /// Largest sqrt(sigma^2 + 3 tau^2) over the section; with sigma = 0 sqrt(3) times the largest shear stress.
  virtual LargestStress largest_von_mises(const NormalStress& normal, const ShearLoad& load) const = 0;

  NormalStress normal(const SectionForces& forces) const;
  const SectionGeometry& geometry() const { return geometry_; }

 protected:
  explicit StressField(const SectionShape& shape) : geometry_(section_geometry(shape)) {}
  explicit StressField(const SectionGeometry& geometry) : geometry_(geometry) {}

 private:
  SectionGeometry geometry_;
};

/// Circle, tube, ellipse, rectangle.
std::shared_ptr<const StressField> solid_stress_field(const SectionShape& shape);

/// I, box, T, L and U.
std::shared_ptr<const StressField> wall_stress_field(const SectionShape& shape);

}  // namespace mixbeam
