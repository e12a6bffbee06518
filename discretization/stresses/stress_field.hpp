/// What a family of shapes knows of its stresses; SectionStresses chooses one.
#pragma once

#include "discretization/scene/section_shape.hpp"
#include "discretization/stresses/section_stresses.hpp"

#include <memory>

namespace mixbeam {

/// Shear forces and torque of a section: what makes shear stresses.
struct ShearLoad {
  double torque = 0.0, force2 = 0.0, force3 = 0.0;
  bool is_zero() const { return torque == 0.0 && force2 == 0.0 && force3 == 0.0; }
  /// Which of T, Q2, Q3 is the only one; -1: none or several.
  int only_one() const {
    if ((torque != 0.0) + (force2 != 0.0) + (force3 != 0.0) != 1) return -1;
    return torque != 0.0 ? 0 : force2 != 0.0 ? 1 : 2;
  }
  double of(int component) const { return component == 0 ? torque : component == 1 ? force2 : force3; }
};

/// sigma = constant + slope2 x2 + slope3 x3
struct NormalStress {
  double constant = 0.0, slope2 = 0.0, slope3 = 0.0;
  double at(double x2, double x3) const { return constant + slope2 * x2 + slope3 * x3; }
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
  /// The one that is farthest against it; shapes are symmetric.
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

/// I and box.
std::shared_ptr<const StressField> wall_stress_field(const SectionShape& shape);

}  // namespace mixbeam
