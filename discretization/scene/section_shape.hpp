/// Stiffnesses of a cross-section that is given by its shape and its material.
#pragma once

#include "discretization/scene/scene.hpp"

#include <string>
#include <utility>
#include <vector>

namespace mixbeam {

/// Section of the given name with the stiffnesses of `shape`, which it remembers. Section axes 2 and 3 are the axes of
/// symmetry; stiffness about axis 2 is EI2 = E * integral of x3^2, about axis 3 EI3 = E * integral of x2^2.
///
/// Shear correction (unless the shape overrides it): Cowper, "The shear coefficient in Timoshenko's beam theory",
/// J. Appl. Mech. 33 (1966) 335-340: circle, thick tube, rectangle, ellipse, the thin-walled box, and the thin-walled I
/// loaded along its web. The I loaded along its flanges: two rectangles of Cowper, the web carries nothing.
///
/// T (flange at the top of axis 3), L (legs along axes 2 and 3, meeting at their lower ends) and U (open towards axis
/// 2) are rectangles: each carries the shear force along it with a rectangle's factor, and J is the sum of theirs.
/// Forces act at the centroid as if that were the shear centre, and nothing warps. The section of an L has a matrix,
/// which couples bending about axes 2 and 3.
///
/// Torsion: closed form for circle, tube and ellipse, Saint-Venant's series summed to rounding for the rectangle, for
/// the I `i_section_torsion_constant`, for the box Bredt's formula along the middle lines of its walls plus the walls'
/// own l t^3 / 3.
///
/// Fillets count in area, second moments and torsion, not in shear areas. Torsion with them: an I as in the tables of
/// EN 10365, a box as in EN 10210-2.
///
/// Throws std::invalid_argument for impossible dimensions or moduli.
Section make_section(const std::string& name, const SectionShape& shape);

/// Names of the kinds in files.
const std::vector<std::pair<std::string, SectionShapeKind>>& section_shape_words();
const std::string& section_shape_word(SectionShapeKind kind);

/// Properties of the geometry, independent of the material except for the shear factors.
struct SectionGeometry {
  double area = 0.0;
  double torsion_constant = 0.0;          ///< J [length^4]
  std::array<double, 2> second_moment{};  ///< about axes 2 and 3 [length^4]
  std::array<double, 2> shear_factor{};   ///< of GA2, GA3
  double product_moment = 0.0;            ///< integral of x2 x3 [length^4]
};

/// Rectangle with sides along axes 2 and 3; the longer one runs along a wall.
struct WallRectangle {
  std::array<double, 2> from{}, to{};  ///< corners, from the centroid of the section

  double length(std::size_t axis) const { return to[axis] - from[axis]; }
  double middle(std::size_t axis) const { return 0.5 * (from[axis] + to[axis]); }
};

/// Rectangles of a T (flange, web), an L (legs along axes 2 and 3) or a U (flange at the top, at the bottom, web).
std::vector<WallRectangle> section_rectangles(const SectionShape& shape);
bool consists_of_rectangles(SectionShapeKind kind);

/// Properties of a shape that make_section accepts; its own shear correction is not checked.
SectionGeometry section_geometry(const SectionShape& shape);

/// The shape without its fillets.
SectionShape sharp_shape(SectionShape shape);

/// Torsion constant of a full rectangle, Saint-Venant's series [length^4]; relative error below 1e-14 for any ratio.
/// Timoshenko and Goodier, Theory of Elasticity, section 109.
double rectangle_torsion_constant(double width, double height);

/// Torsion constant of an I without fillets [length^4]: three rectangles joined by the junction term of El Darwish and
/// Johnston, "Torsion of structural shapes", J. Struct. Div. ASCE 91 (1965) 203-227, for webs not thicker than the
/// flanges; at least the sum over the three separate rectangles, which is a lower bound for any such section.
/// Within 2 per cent for the proportions of rolled sections.
double i_section_torsion_constant(double width, double height, double flange, double web);

}  // namespace mixbeam
