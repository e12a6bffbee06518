#include "discretization/stresses/section_stresses.hpp"

#include "discretization/stresses/stress_field.hpp"

#include <cmath>

namespace mixbeam {

namespace {

/// Values that differ by less are equal: in a symmetric state the sign of the largest stress must not hang on rounding.
constexpr double kEqualStresses = 1e-10;

const double kSqrt3 = std::sqrt(3.0);

ShearLoad shear_load(const SectionForces& f) { return {f.moment[0], f.force[1], f.force[2]}; }

std::shared_ptr<const StressField> field_of(const SectionShape& shape) {
  make_section("", shape);  // for its checks
  const bool walls = shape.kind == SectionShapeKind::i_section || shape.kind == SectionShapeKind::box;
  return walls ? wall_stress_field(shape) : solid_stress_field(shape);
}

/// Of largest magnitude: at the point farthest along the slope, or against it.
LargestStress largest_normal(const StressField& field, const NormalStress& normal) {
  const SectionPoint p = field.farthest(normal.slope2, normal.slope3);
  const SectionPoint opposite = {-p[0], -p[1]};  // shapes are symmetric
  const double tension = normal.at(p[0], p[1]), compression = normal.at(opposite[0], opposite[1]);
  if (-compression > tension * (1.0 + kEqualStresses)) return {compression, opposite};
  return {tension, p};
}

}  // namespace

double PointStress::largest_shear() const { return std::sqrt(shear[0] * shear[0] + shear[1] * shear[1]); }

double PointStress::von_mises() const {
  return std::sqrt(normal * normal + 3.0 * (shear[0] * shear[0] + shear[1] * shear[1]));
}

NormalStress StressField::normal(const SectionForces& f) const {
  const SectionGeometry& g = geometry_;
  return {f.force[0] / g.area, -f.moment[2] / g.second_moment[1], f.moment[1] / g.second_moment[0]};
}

SectionStresses::SectionStresses(const SectionShape& shape) : field_(field_of(shape)) {
  const std::array<ShearLoad, 3> units = {ShearLoad{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  for (std::size_t i = 0; i < units.size(); ++i) unit_shear_[i] = field_->largest_von_mises({}, units[i]);
}

/// sqrt(3) times it. One force alone scales what the unit force makes.
LargestStress SectionStresses::largest_shear(const SectionForces& forces) const {
  const ShearLoad load = shear_load(forces);
  const int only = load.only_one();
  if (only < 0) return field_->largest_von_mises({}, load);
  const LargestStress& unit = unit_shear_[static_cast<std::size_t>(only)];
  return {unit.value * std::abs(load.of(only)), unit.point};
}

PointStress SectionStresses::at(const SectionForces& forces, const SectionPoint& point) const {
  PointStress stress;
  stress.normal = field_->normal(forces).at(point[0], point[1]);
  const ShearLoad load = shear_load(forces);
  if (!load.is_zero()) stress.shear = field_->shear(load, point[0], point[1]);
  return stress;
}

bool SectionStresses::contains(const SectionPoint& point) const { return field_->contains(point[0], point[1]); }

LargestStresses SectionStresses::largest(const SectionForces& forces) const {
  const NormalStress normal = field_->normal(forces);
  LargestStresses largest;
  largest.normal = largest_normal(*field_, normal);
  const ShearLoad load = shear_load(forces);
  if (load.is_zero()) {
    largest.von_mises = {std::abs(largest.normal.value), largest.normal.point};
    return largest;
  }
  largest.shear = largest_shear(forces);
  largest.von_mises = normal.constant == 0.0 && normal.slope2 == 0.0 && normal.slope3 == 0.0
                          ? largest.shear
                          : field_->largest_von_mises(normal, load);
  largest.shear.value /= kSqrt3;
  return largest;
}

double SectionStresses::largest_edge_strain(double axial, double bending2, double bending3) const {
  const SectionPoint p = field_->farthest(-bending3, bending2);
  return std::abs(axial) + std::abs(bending2 * p[1] - bending3 * p[0]);
}

double SectionStresses::curvature_error(double kappa2, double kappa3) const {
  const double kappa = std::hypot(kappa2, kappa3);
  if (kappa == 0.0) return 0.0;
  const double d2 = kappa3 / kappa, d3 = kappa2 / kappa;  // where the centre of curvature is, but for the sign
  const SectionPoint p = field_->farthest(d2, d3);
  const SectionGeometry& g = field_->geometry();
  const double distance = p[0] * d2 + p[1] * d3;
  const double second_moment = g.second_moment[1] * d2 * d2 + g.second_moment[0] * d3 * d3;
  return kappa * (distance - second_moment / (g.area * distance));
}

}  // namespace mixbeam
