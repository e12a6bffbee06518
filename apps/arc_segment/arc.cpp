#include "apps/arc_segment/arc.hpp"

#include "apps/common/studies/variants.hpp"
#include "discretization/geometry/vector_algebra.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/math/gauss.hpp"
#include "kernels/math/legendre.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// p(xi) of the least-squares polynomial of degree k of the curve over one element, measured in k + 1 Gauss points.
Vec3<double> projected_position(const ReferenceCurve& curve, double start, double h, int order, double xi) {
  std::vector<double> points(order + 1), weights(order + 1), basis(order + 1), basis_at_point(order + 1);
  gauss_rule(order + 1, points.data(), weights.data());
  legendre(order, xi, basis.data());
  Vec3<double> sum{{0.0, 0.0, 0.0}};
  for (int q = 0; q <= order; ++q) {
    legendre(order, points[q], basis_at_point.data());
    double factor = 0.0;
    for (int j = 0; j <= order; ++j) factor += 0.5 * (2 * j + 1) * weights[q] * basis_at_point[j] * basis[j];
    sum += factor * curve.position(start + 0.5 * h * (1.0 + points[q]));
  }
  return sum;
}

}  // namespace

ArcScene::ArcScene(const Scene& scene) : scene_(scene) {
  if (scene.members.size() != 1 || scene.members.front().curve.shape != CurveShape::circular_arc)
    throw InputError("the study needs a scene of one member, an arc; other scenes: --single");
  const Member& arc = scene.members.front();
  const Section& section = section_of(scene, arc);
  radius_ = vector_algebra::norm(vector_algebra::difference(position_of(scene, arc.start_point), arc.curve.center));
  const double side = std::sqrt(12.0 * section.bending_stiffness[1] / section.axial_stiffness);  // EI = EA a^2/12
  slenderness_ = radius_ / side;
}

Scene ArcScene::variant(const ArcVariant& arc) const {
  constexpr double rigid = std::numeric_limits<double>::infinity();
  Scene scene = with_mesh(with_side(scene_, slenderness_ / arc.slenderness), arc.order, arc.elements);
  for (Section& section : scene.sections) {
    if (arc.inextensible) section.axial_stiffness = rigid;
    if (arc.shear_rigid) section.shear_stiffness = {rigid, rigid};
  }
  return with_loads(std::move(scene), arc.force_factor);
}

DisplacementField::DisplacementField(const Simulation& simulation)
    : order_(simulation.scene().members.front().order), elements_(simulation.scene().members.front().elements) {
  values_.resize(static_cast<std::size_t>(elements_) * (order_ + 1) * 3);
  const MemberSamples samples = simulation.samples(order_ + 1).front();  // complete on rank 0
  for (std::size_t i = 0; i < samples.displacement.size(); ++i)
    std::copy(samples.displacement[i].begin(), samples.displacement[i].end(), values_.begin() + 3 * i);
  Teuchos::broadcast(*simulation.model().map()->getComm(), 0, static_cast<int>(values_.size()), values_.data());
}

Vec3<double> DisplacementField::at(int element, double xi) const {
  const double* node = &values_[static_cast<std::size_t>(element) * (order_ + 1) * 3];
  Vec3<double> sum{{0.0, 0.0, 0.0}};
  for (int i = 0; i <= order_; ++i, node += 3) {
    double lagrange = 1.0;
    for (int j = 0; j <= order_; ++j)
      if (j != i) lagrange *= (0.5 * order_ * (1.0 + xi) - j) / (i - j);
    sum += lagrange * Vec3<double>{{node[0], node[1], node[2]}};
  }
  return sum;
}

double l2_difference(const DisplacementField& coarse, const DisplacementField& fine) {
  const int points = std::max(coarse.order(), fine.order()) + 1;
  const int parts = fine.elements() / coarse.elements();
  std::vector<double> xi(points), weights(points);
  gauss_rule(points, xi.data(), weights.data());
  double sum = 0.0;
  for (int e = 0; e < fine.elements(); ++e)
    for (int q = 0; q < points; ++q) {
      const double place = (e % parts + 0.5 * (1.0 + xi[q])) / parts;  // in the coarse element, 0 to 1
      const Vec3<double> difference = coarse.at(e / parts, 2.0 * place - 1.0) - fine.at(e, xi[q]);
      sum += 0.5 * weights[q] * dot(difference, difference);
    }
  return std::sqrt(sum / fine.elements());
}

Vec3<double> offset_of_paper(const Simulation& simulation) {
  const Member& member = simulation.scene().members.front();
  const auto whole = simulation.model().whole_mesh();
  const MeshMember& mesh_member = whole->members[0];
  const ReferenceCurve& curve = mesh_member.curve;
  const double h = mesh_member.element_length(0);
  std::vector<double> points(member.order), weights(member.order);
  gauss_rule(member.order, points.data(), weights.data());
  Vec3<double> offset = projected_position(curve, 0.0, h, member.order, -1.0) -
                        projected_position(curve, curve.length - h, h, member.order, 1.0);
  for (int e = 0; e < member.elements; ++e)
    for (int q = 0; q < member.order; ++q)
      offset += 0.5 * h * weights[q] * curve.tangent(h * (e + 0.5 * (1.0 + points[q])));
  return offset;
}

}  // namespace mixbeam
