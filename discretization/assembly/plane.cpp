#include "discretization/assembly/plane.hpp"

#include "discretization/mesh/reference_element.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace mixbeam {

namespace {

/// Relative to the length of the structure, to the load or to one: the rounding of positions and triads that were
/// computed from curves, with some room. What is farther out of the plane was meant to be.
constexpr double kInPlane = 1e-12;
/// Components of a normal that are rounding beside the others: without them coordinate planes have exact zeros.
constexpr double kNoComponent = 1e-15;

Vec without_rounding(Vec v) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(v[i]) < kNoComponent) v[i] = 0.0;
  return (1.0 / norm(v)) * v;
}

Vec column(const Mat& m, int j) { return {{m(0, j), m(1, j), m(2, j)}}; }
Vec row(const Mat& m, int i) { return {{m(i, 0), m(i, 1), m(i, 2)}}; }

/// p is the coordinate axis that lies most in the plane, as far as it does.
PlaneAxes axes_of(const Vec& normal) {
  PlaneAxes axes;
  axes.n = without_rounding(normal);
  int most = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(axes.n[i]) < std::abs(axes.n[most])) most = i;
  Vec p{{0.0, 0.0, 0.0}};
  p[most] = 1.0;
  axes.p = without_rounding(p - axes.n[most] * axes.n);
  axes.q = cross(axes.n, axes.p);
  return axes;
}

class PlaneCheck {
 public:
  explicit PlaneCheck(const Vec& normal) : n_(normal) {}

  bool holds(const Mesh& mesh, double length) const {
    const Vec origin = position(mesh, 0);
    for (int v = 0; v < mesh.vertices(); ++v)
      if (!is_small(dot(position(mesh, v) - origin, n_), length)) return false;
    return true;
  }
  bool holds(const ElementBlock& block) const {
    if (block.general_section || block.force_integration != ForceIntegration::both_reduced ||
        block.field_row.extent(0) > 0)
      return false;
    for (int e = 0; e < block.count; ++e)
      if (!holds(block, e)) return false;
    return true;
  }
  bool holds(const VertexLoad& load) const { return in_plane(load.force) && along_normal(load.moment); }
  bool holds(const VertexSupport& support) const {
    const bool* fixed = support.fixed;
    Vec displacement{{0.0, 0.0, 0.0}};
    for (int i = 0; i < 3; ++i)
      if (fixed[i]) displacement += support.displacement[i] * row(support.axes, i);
    if (!in_plane(displacement) || !along_normal(support.rotation)) return false;
    return aligned(support.axes) ||
           (uniform(fixed, support.displacement_stiffness) && uniform(fixed + 3, support.rotation_stiffness));
  }
  bool holds(const VertexJoint& joint) const {
    const Vec axis = row(joint.frame, 2);
    return joint.kind == JointKind::ball || in_plane(axis) || along_normal(axis);
  }

 private:
  Vec n_;

  static bool is_small(double x, double against) { return std::abs(x) <= kInPlane * against; }
  bool in_plane(const Vec& v) const { return is_small(dot(v, n_), norm(v)); }
  bool along_normal(const Vec& v) const { return is_small(norm(cross(v, n_)), norm(v)); }
  /// One of the axes is normal to the plane.
  bool aligned(const Mat& axes) const {
    return along_normal(row(axes, 0)) || along_normal(row(axes, 1)) || along_normal(row(axes, 2));
  }
  /// All directions alike.
  static bool uniform(const bool* fixed, const Vec& stiffness) {
    return fixed[0] == fixed[1] && fixed[1] == fixed[2] && stiffness[0] == stiffness[1] && stiffness[1] == stiffness[2];
  }
  static Vec position(const Mesh& mesh, int v) {
    const Vector3& x = mesh.vertex_position[v];
    return {{x[0], x[1], x[2]}};
  }
  /// Triads and tangents; the curvature is along g2 or g3 where that is normal, measured as an angle.
  bool holds(const ElementBlock& block, int e) const {
    const double* reference = &block.reference(e, 0);
    const ReferenceLayout& layout = block.reference_layout;
    int normal = 0;
    for (int end = 0; end < 2; ++end) {
      const Mat triad = rotation_matrix(load_quaternion(reference + layout.end_triad(end)));
      const int found = along_normal(column(triad, 1)) ? 1 : along_normal(column(triad, 2)) ? 2 : 0;
      if (found == 0 || (end == 1 && found != normal)) return false;
      normal = found;
    }
    for (int q = 0; q < layout.force_points; ++q)
      if (!in_plane(load_vector(reference + layout.tangent(q)))) return false;
    for (int q = 0; q <= layout.order; ++q) {
      const double* curvature = reference + layout.curvature(q);
      for (int other : {0, 3 - normal})
        if (!is_small(reference[layout.length()] * curvature[other], 1.0)) return false;
    }
    return true;
  }
};

bool keeps_to(const Vec& normal, const Mesh& mesh, const Structure& structure, const Conditions& conditions) {
  const PlaneCheck check(normal);
  const auto all = [&](const auto& list) {
    return std::all_of(list.begin(), list.end(), [&](const auto& one) { return check.holds(one); });
  };
  return all(conditions.loads) && all(conditions.supports) && all(conditions.joints) && all(structure.blocks) &&
         check.holds(mesh, structure.length);
}

}  // namespace

std::optional<PlaneAxes> plane_of(const Teuchos::Comm<int>& comm, const Mesh& mesh, const Structure& structure,
                                  const LineFields& line_fields, const Conditions& conditions) {
  if (!line_fields.empty()) return std::nullopt;
  const MeshElement& first = mesh.elements.front();
  const Mat triad = rotation_matrix(
      make_reference_element(mesh.member_of(first), first.index, 1, ForceIntegration::both_reduced).end_triad[0]);
  for (int axis : {2, 1}) {
    const PlaneAxes axes = axes_of(column(triad, axis));
    const int mine = keeps_to(axes.n, mesh, structure, conditions) ? 1 : 0;
    int everywhere = mine;
    Teuchos::reduceAll(comm, Teuchos::REDUCE_MIN, mine, Teuchos::outArg(everywhere));
    if (everywhere != 0) return axes;
  }
  return std::nullopt;
}

}  // namespace mixbeam
