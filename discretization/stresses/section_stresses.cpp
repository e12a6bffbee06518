#include "discretization/stresses/section_stresses.hpp"

#include "discretization/stresses/stress_field.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

/// Relative difference of values that count as equal: signs in a symmetric state must not depend on rounding.
constexpr double kEqualStresses = 1e-10;

const double kSqrt3 = std::sqrt(3.0);

ShearLoad shear_load(const SectionForces& f) { return {f.moment[0], f.force[1], f.force[2]}; }

std::shared_ptr<const StressField> field_of(const SectionShape& shape) {
  make_section("", shape);  // for its checks
  const bool walls = shape.kind == SectionShapeKind::i_section || shape.kind == SectionShapeKind::box ||
                     consists_of_rectangles(shape.kind);
  return walls ? wall_stress_field(shape) : solid_stress_field(shape);
}

/// Normal stress of largest magnitude: at the point farthest along the slope, or against it.
LargestStress largest_normal(const StressField& field, const NormalStress& normal) {
  const SectionPoint p = field.farthest(normal.slope2, normal.slope3);
  const SectionPoint opposite = field.farthest_against(normal.slope2, normal.slope3);
  const double tension = normal.at(p[0], p[1]), compression = normal.at(opposite[0], opposite[1]);
  if (-compression > tension * (1.0 + kEqualStresses)) return {compression, opposite};
  return {tension, p};
}

/// Stress field known at some points only.
class PointStressField final : public StressField {
 public:
  explicit PointStressField(const Section& section)
      : StressField(geometry_of(section)), points_(section.stress_points->points) {
    if (section.stress_points->torsion_modulus) shear_of_torque_ = 1.0 / *section.stress_points->torsion_modulus;
  }

  std::array<double, 2> shear(const ShearLoad& load, double /*x2*/, double /*x3*/) const override {
    return {std::abs(load[0]) * shear_of_torque_, 0.0};
  }
  bool contains(double x2, double x3) const override {
    return std::any_of(points_.begin(), points_.end(), [&](const auto& p) { return p.at == SectionPoint{x2, x3}; });
  }
  SectionPoint farthest(double direction2, double direction3) const override {
    const auto distance = [&](const StressPoints::Place& p) { return direction2 * p.at[0] + direction3 * p.at[1]; };
    const auto nearer = [&](const auto& a, const auto& b) { return distance(a) < distance(b); };
    return std::max_element(points_.begin(), points_.end(), nearer)->at;
  }
  SectionPoint farthest_against(double direction2, double direction3) const override {
    return farthest(-direction2, -direction3);
  }
  LargestStress largest_von_mises(const NormalStress& normal, const ShearLoad& load) const override {
    const LargestStress largest = largest_normal(*this, normal);
    return {PointStress{largest.value, shear(load, 0.0, 0.0)}.von_mises(), largest.point};
  }

 private:
  static SectionGeometry geometry_of(const Section& section) {
    const double modulus = section.stress_points->youngs_modulus;
    SectionGeometry geometry;
    geometry.area = section.stress_points->area.value_or(section.axial_stiffness / modulus);
    geometry.second_moment = {section.bending_stiffness[0] / modulus, section.bending_stiffness[1] / modulus};
    return geometry;
  }

  std::vector<StressPoints::Place> points_;
  double shear_of_torque_ = 0.0;
};

PointStress recovered(const StressRows& rows, const SectionForces& f) {
  const auto times = [&](const std::array<double, 6>& row) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) sum += row[i] * f.force[i] + row[i + 3] * f.moment[i];
    return sum;
  };
  return {times(rows[0]), {times(rows[1]), times(rows[2])}};
}

/// Largest stresses over all points; of those that agree to rounding the first.
LargestStresses largest_recovered(const std::vector<StressPoints::Place>& points, const SectionForces& forces) {
  LargestStresses largest;
  const auto note = [](LargestStress& so_far, double value, const SectionPoint& at) {
    const double tension = value > 0.0 ? 1.0 : 1.0 + kEqualStresses;  // which counts where both are as large
    if (std::abs(value) > std::abs(so_far.value) * (1.0 + kEqualStresses) * tension) so_far = {value, at};
  };
  for (const StressPoints::Place& place : points) {
    const PointStress stress = recovered(*place.stress, forces);
    note(largest.normal, stress.normal, place.at);
    note(largest.shear, stress.largest_shear(), place.at);
    note(largest.von_mises, stress.von_mises(), place.at);
  }
  return largest;
}

std::shared_ptr<const StressField> field_of(const Section& section) {
  if (section.shape) return field_of(*section.shape);
  return std::make_shared<PointStressField>(section);
}

}  // namespace

double PointStress::largest_shear() const { return std::sqrt(shear[0] * shear[0] + shear[1] * shear[1]); }

double PointStress::von_mises() const {
  return std::sqrt(normal * normal + 3.0 * (shear[0] * shear[0] + shear[1] * shear[1]));
}

NormalStress StressField::normal(const SectionForces& f) const {
  const SectionGeometry& g = geometry_;
  if (g.product_moment != 0.0) {  // axes 2 and 3 are not the principal ones
    const auto [i2, i3] = g.second_moment;
    const double i23 = g.product_moment, determinant = i2 * i3 - i23 * i23, m2 = f.moment[1], m3 = f.moment[2];
    return {f.force[0] / g.area, -(m3 * i2 + m2 * i23) / determinant, (m2 * i3 + m3 * i23) / determinant};
  }
  return {f.force[0] / g.area, -f.moment[2] / g.second_moment[1], f.moment[1] / g.second_moment[0]};
}

bool has_stresses(const Section& section) { return section.shape || section.stress_points; }

std::optional<double> strength_of(const Section& section) {
  if (section.shape) return section.shape->strength;
  return section.stress_points ? section.stress_points->strength : std::nullopt;
}

SectionStresses::SectionStresses(const SectionShape& shape) : SectionStresses(field_of(shape)) {}

SectionStresses::SectionStresses(const Section& section) : SectionStresses(field_of(section)) {
  if (section.stress_points && section.stress_points->points.front().stress)
    recovered_ = std::make_shared<const std::vector<StressPoints::Place>>(section.stress_points->points);
}

SectionStresses::SectionStresses(std::shared_ptr<const StressField> field) : field_(std::move(field)) {
  for (std::size_t i = 0; i < 3; ++i) {
    ShearLoad unit{};
    unit[i] = 1.0;
    unit_shear_[i] = field_->largest_von_mises({}, unit);
  }
}

PointStress SectionStresses::at(const SectionForces& forces, const SectionPoint& point) const {
  if (recovered_) {
    const auto is_here = [&](const StressPoints::Place& place) { return place.at == point; };
    const auto place = std::find_if(recovered_->begin(), recovered_->end(), is_here);
    return place == recovered_->end() ? PointStress{} : recovered(*place->stress, forces);
  }
  PointStress stress;
  stress.normal = field_->normal(forces).at(point[0], point[1]);
  const ShearLoad load = shear_load(forces);
  if (load != ShearLoad{}) stress.shear = field_->shear(load, point[0], point[1]);
  return stress;
}

bool SectionStresses::contains(const SectionPoint& point) const { return field_->contains(point[0], point[1]); }

LargestStresses SectionStresses::largest(const SectionForces& forces) const {
  if (recovered_) return largest_recovered(*recovered_, forces);
  const NormalStress normal = field_->normal(forces);
  LargestStresses largest;
  largest.normal = largest_normal(*field_, normal);
  const ShearLoad load = shear_load(forces);
  if (load == ShearLoad{}) {
    largest.von_mises = {std::abs(largest.normal.value), largest.normal.point};
    return largest;
  }
  const auto is_there = [](double component) { return component != 0.0; };
  if (std::count_if(load.begin(), load.end(), is_there) > 1) {
    largest.shear = field_->largest_von_mises({}, load);  // sqrt(3) times it
  } else {                                                // scales the stress of the unit force
    const auto only = std::find_if(load.begin(), load.end(), is_there);
    largest.shear = unit_shear_[static_cast<std::size_t>(only - load.begin())];
    largest.shear.value *= std::abs(*only);
  }
  largest.von_mises = normal.constant == 0.0 && normal.slope2 == 0.0 && normal.slope3 == 0.0
                          ? largest.shear
                          : field_->largest_von_mises(normal, load);
  largest.shear.value /= kSqrt3;
  return largest;
}

double SectionStresses::largest_edge_strain(double axial, double bending2, double bending3) const {
  const auto strain = [&](const SectionPoint& p) { return std::abs(axial + (bending2 * p[1] - bending3 * p[0])); };
  return std::max(strain(field_->farthest(-bending3, bending2)), strain(field_->farthest_against(-bending3, bending2)));
}

double SectionStresses::curvature_error(double kappa2, double kappa3) const {
  const double kappa = std::hypot(kappa2, kappa3);
  if (kappa == 0.0 || recovered_) return 0.0;
  const double d2 = kappa3 / kappa, d3 = kappa2 / kappa;  // direction of the centre of curvature, except for the sign
  const SectionPoint p = field_->farthest(d2, d3);
  const SectionGeometry& g = field_->geometry();
  const double distance = p[0] * d2 + p[1] * d3;
  const double second_moment = g.second_moment[1] * d2 * d2 + g.second_moment[0] * d3 * d3;
  return kappa * (distance - second_moment / (g.area * distance));
}

}  // namespace mixbeam
