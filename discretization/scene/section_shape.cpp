#include "discretization/scene/section_shape.hpp"

#include "discretization/scene/section_law.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/constants.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

namespace mixbeam {
namespace {

constexpr double kZeta5 = 1.03692775514336992633;  // Riemann's zeta function at 5

/// Bounds against overflow: stresses of unit forces take the third power, the search for the largest ones the eighth.
constexpr double kSmallestLength = 1e-30, kLargestLength = 1e30;

/// "the wall thickness is 3; allowed: at most 2"
void require_size(bool is_allowed, const std::string& name, double value, const std::string& allowed) {
  require(is_allowed, name + " is " + shortest(value) + "; allowed: " + allowed);
}

void require_length(double value, const std::string& name) {
  require_size(value >= kSmallestLength && value <= kLargestLength, name, value,
               "a length > 0, from 1e-30 to 1e30 in the unit of the scene");
}

double square(double x) { return x * x; }
double cube(double x) { return x * x * x; }

SectionGeometry tube_geometry(double diameter, double wall, double nu) {
  const double inner = diameter - 2.0 * wall;
  SectionGeometry g;
  g.area = kPi * wall * (diameter - wall);  // differences of squares as products: thin walls lose no digits
  const double second_moment = g.area * (square(diameter) + square(inner)) / 16.0;
  g.second_moment = {second_moment, second_moment};
  g.torsion_constant = 2.0 * second_moment;
  const double m = inner / diameter;
  const double p = square(1.0 + square(m));
  const double factor = 6.0 * (1.0 + nu) * p / ((7.0 + 6.0 * nu) * p + (20.0 + 12.0 * nu) * square(m));
  g.shear_factor = {factor, factor};
  return g;
}

double rectangle_shear_factor(double nu) { return 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu); }

SectionGeometry rectangle_geometry(double width, double height, double nu) {
  SectionGeometry g;
  g.area = width * height;
  g.second_moment = {g.area * square(height) / 12.0, g.area * square(width) / 12.0};
  g.torsion_constant = rectangle_torsion_constant(width, height);
  g.shear_factor = {rectangle_shear_factor(nu), rectangle_shear_factor(nu)};
  return g;
}

/// `along`: axis of the ellipse in the direction of the shear force.
double ellipse_shear_factor(double along, double across, double nu) {
  const double r = square(across / along);
  return 12.0 * (1.0 + nu) * (3.0 + r) / ((40.0 + 37.0 * nu) + (16.0 + 10.0 * nu) * r + nu * r * r);
}

SectionGeometry ellipse_geometry(double width, double height, double nu) {
  SectionGeometry g;
  g.area = 0.25 * kPi * width * height;
  g.second_moment = {g.area * square(height) / 16.0, g.area * square(width) / 16.0};
  // pi a^3 b^3 / (a^2 + b^2) with half axes a, b
  g.torsion_constant = 0.25 * g.area * square(width) / (1.0 + square(width / height));
  g.shear_factor = {ellipse_shear_factor(width, height, nu), ellipse_shear_factor(height, width, nu)};
  return g;
}

/// Cowper's thin-walled I loaded along its web; b and h between the middle lines.
double web_shear_factor(const SectionShape& s, double nu) {
  const double h = s.size3 - s.wall;
  const double m = 2.0 * s.size2 * s.wall / (h * s.web);
  const double n2 = square(s.size2 / h);
  const double denominator = 12.0 + 72.0 * m + 150.0 * m * m + 90.0 * cube(m) +
                             nu * (11.0 + 66.0 * m + 135.0 * m * m + 90.0 * cube(m)) + 30.0 * n2 * (m + m * m) +
                             5.0 * nu * n2 * (8.0 * m + 9.0 * m * m);
  return 10.0 * (1.0 + nu) * square(1.0 + 3.0 * m) / denominator;
}

/// Adds, `sign` times, the area between a right-angled corner at (place2, place3) and the quarter circle of radius r
/// that rounds it, in all four quadrants; `side2`, `side3`: it lies towards the axes (-1) or away from them (1).
void add_corners(SectionGeometry& g, double r, double place2, double place3, double side2, double side3, double sign) {
  const double area = (1.0 - 0.25 * kPi) * r * r;
  const double own = (1.0 / 3.0 - kPi / 16.0 - 1.0 / (36.0 - 9.0 * kPi)) * square(square(r));
  const double arm = (10.0 - 3.0 * kPi) / (12.0 - 3.0 * kPi) * r;  // of its centroid from the corner
  g.area += sign * 4.0 * area;
  g.second_moment[0] += sign * 4.0 * (own + area * square(place3 + side3 * arm));
  g.second_moment[1] += sign * 4.0 * (own + area * square(place2 + side2 * arm));
}

/// Keeps the shear areas of the sharp section.
void keep_shear_areas(SectionGeometry& g, double sharp_area) {
  for (double& factor : g.shear_factor) factor *= sharp_area / g.area;
}

/// The torsion constant that EN 10365 prints: as in `i_section_torsion_constant`, but with the fillet in the circle at
/// the junction and in its factor.
double filleted_i_torsion_constant(const SectionShape& s) {
  const double t = s.wall, r = s.fillet;
  const double circle = (square(r + 0.5 * s.web) + square(r + t) - r * r) / (2.0 * r + t);
  return 2.0 / 3.0 * (s.size2 - 0.63 * t) * cube(t) + (s.size3 - 2.0 * t) * cube(s.web) / 3.0 +
         2.0 * s.web / t * (0.145 + 0.1 * r / t) * square(square(circle));
}

SectionGeometry i_geometry(const SectionShape& s, double nu) {
  const double between = s.size3 - 2.0 * s.wall;
  const double flanges = 2.0 * s.size2 * s.wall;
  const double web = between * s.web;
  SectionGeometry g;
  g.area = flanges + web;
  // each flange about its own middle line, and by Steiner's theorem about axis 2
  g.second_moment[0] = (flanges * (square(s.wall) + 3.0 * square(s.size3 - s.wall)) + web * square(between)) / 12.0;
  g.second_moment[1] = (flanges * square(s.size2) + web * square(s.web)) / 12.0;
  g.torsion_constant = i_section_torsion_constant(s.size2, s.size3, s.wall, s.web);
  g.shear_factor = {rectangle_shear_factor(nu) * flanges / g.area, web_shear_factor(s, nu)};
  if (s.fillet == 0.0) return g;
  const double sharp_area = g.area;
  add_corners(g, s.fillet, 0.5 * s.web, 0.5 * between, 1.0, -1.0, 1.0);
  g.torsion_constant = filleted_i_torsion_constant(s);
  keep_shear_areas(g, sharp_area);
  return g;
}

/// Cowper's thin-walled box, shear force along `along`; both dimensions between the middle lines of the walls.
double box_shear_factor(double along, double across, double nu) {
  const double m = across / along, n2 = square(across / along);
  const double denominator = 12.0 + 72.0 * m + 150.0 * m * m + 90.0 * cube(m) +
                             nu * (11.0 + 66.0 * m + 135.0 * m * m + 90.0 * cube(m)) +
                             10.0 * n2 * ((3.0 + nu) * m + 3.0 * m * m);
  return 10.0 * (1.0 + nu) * square(1.0 + 3.0 * m) / denominator;
}

/// Two walls of length `across` and thickness t at +-(along - t) / 2, two between them.
double box_second_moment(double along, double across, double t) {
  const double between = along - 2.0 * t;
  return (2.0 * across * t * (square(t) + 3.0 * square(along - t)) + 2.0 * t * cube(between)) / 12.0;
}

SectionGeometry box_geometry(const SectionShape& s, double nu) {
  const double t = s.wall, b = s.size2 - t, h = s.size3 - t;
  SectionGeometry g;
  g.area = 2.0 * t * (b + h);
  g.second_moment = {box_second_moment(s.size3, s.size2, t), box_second_moment(s.size2, s.size3, t)};
  g.torsion_constant = 2.0 * t * square(b * h) / (b + h) + 2.0 * (b + h) * cube(t) / 3.0;
  g.shear_factor = {box_shear_factor(b, h, nu), box_shear_factor(h, b, nu)};
  if (s.fillet == 0.0 && s.inner_fillet == 0.0) return g;
  const double sharp_area = g.area;
  add_corners(g, s.fillet, 0.5 * s.size2, 0.5 * s.size3, -1.0, -1.0, -1.0);
  add_corners(g, s.inner_fillet, 0.5 * s.size2 - t, 0.5 * s.size3 - t, -1.0, -1.0, 1.0);
  const double r = 0.5 * (s.fillet + s.inner_fillet), missing = 4.0 - kPi;  // of the middle line, of a square around it
  const double round = 2.0 * (b + h) - 2.0 * missing * r, enclosed = b * h - missing * r * r;
  g.torsion_constant = 4.0 * t * square(enclosed) / round + round * cube(t) / 3.0;
  keep_shear_areas(g, sharp_area);
  return g;
}

/// Requires a radius of at most half of the smaller length.
void check_fillet(double radius, const std::string& name, double length, double other) {
  const double most = 0.5 * std::min(length, other);
  require_size(radius >= 0.0 && radius <= most, name, radius,
               "from 0 to " + shortest(most) + ", where it meets the next one");
}

/// Properties of T, L and U. A rectangle carries the shear force along its longer side.
SectionGeometry rectangles_geometry(const SectionShape& s, double nu) {
  SectionGeometry g;
  for (const WallRectangle& wall : section_rectangles(s)) {
    const double b = wall.length(0), h = wall.length(1), area = b * h;
    g.area += area;
    g.torsion_constant += rectangle_torsion_constant(b, h);
    g.second_moment[0] += area * (square(h) / 12.0 + square(wall.middle(1)));
    g.second_moment[1] += area * (square(b) / 12.0 + square(wall.middle(0)));
    g.product_moment += area * wall.middle(0) * wall.middle(1);
    g.shear_factor[b >= h ? 0 : 1] += area;
  }
  if (s.kind != SectionShapeKind::l_section) g.product_moment = 0.0;  // but for rounding
  for (double& factor : g.shear_factor) factor *= rectangle_shear_factor(nu) / g.area;
  return g;
}

void check_dimensions(const SectionShape& s) {
  const bool round = s.kind == SectionShapeKind::circle || s.kind == SectionShapeKind::tube;
  require_length(s.size2, round ? "the diameter" : "the width");
  if (!round) require_length(s.size3, "the height");
  if (s.kind == SectionShapeKind::tube) {
    require_length(s.wall, "the wall thickness");
    require_size(2.0 * s.wall <= s.size2, "the wall thickness", s.wall,
                 "at most half of the diameter " + shortest(s.size2));
  }
  if (s.kind == SectionShapeKind::box) {
    require_length(s.wall, "the wall thickness");
    const double smaller = std::min(s.size2, s.size3);
    require_size(2.0 * s.wall < smaller, "the wall thickness", s.wall,
                 "less than half of the smaller dimension " + shortest(smaller));
    check_fillet(s.fillet, "the corner radius", s.size2, s.size3);
    check_fillet(s.inner_fillet, "the inner radius", s.size2 - 2.0 * s.wall, s.size3 - 2.0 * s.wall);
  }
  if (s.kind == SectionShapeKind::l_section) {
    require_length(s.wall, "the wall thickness");
    const double most = 0.5 * std::min(s.size2, s.size3);
    require_size(s.wall <= most, "the wall thickness", s.wall,
                 "at most " + shortest(most) + ", half of the shorter leg");
  }
  if (s.kind == SectionShapeKind::t_section || s.kind == SectionShapeKind::u_section) {
    require_length(s.wall, "the flange thickness");
    require_length(s.web, "the web thickness");
    const double most = s.kind == SectionShapeKind::t_section ? 0.5 * s.size3 : s.size3 / 3.0;
    require_size(s.wall <= most, "the flange thickness", s.wall,
                 "at most " + shortest(most) + ", so that the web is longer");
    require_size(s.web <= 0.5 * s.size2, "the web thickness", s.web,
                 "at most half of the width of the flanges " + shortest(s.size2));
  }
  if (s.kind == SectionShapeKind::i_section) {
    require_length(s.wall, "the flange thickness");
    require_length(s.web, "the web thickness");
    require_size(2.0 * s.wall < s.size3, "the flange thickness", s.wall,
                 "less than half of the height " + shortest(s.size3));
    require_size(s.web <= s.size2, "the web thickness", s.web, "at most the width of the flanges " + shortest(s.size2));
    check_fillet(s.fillet, "the fillet", s.size2 - s.web, s.size3 - 2.0 * s.wall);
  }
}

void check_material(const SectionShape& s) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  require_size(positive(s.youngs_modulus), "Young's modulus", s.youngs_modulus, "> 0");
  require_size(s.poisson_ratio > -1.0 && s.poisson_ratio <= 0.5, "Poisson's ratio", s.poisson_ratio, "-1 < nu <= 0.5");
  if (s.shear_modulus) require_size(positive(*s.shear_modulus), "the shear modulus", *s.shear_modulus, "> 0");
  for (const auto& factor : s.shear_correction)
    if (factor) require_size(positive(*factor), "a shear correction factor", *factor, "> 0");
}

/// Dimensions far from 1 overflow in their fourth powers.
void check_stiffnesses(const Section& section) {
  for (const double value : {section.axial_stiffness, section.shear_stiffness[0], section.shear_stiffness[1],
                             section.torsional_stiffness, section.bending_stiffness[0], section.bending_stiffness[1]}) {
    require(std::isnormal(value) && value > 0.0, "a stiffness becomes " + shortest(value) +
                                                     "; allowed: dimensions and moduli that give finite stiffnesses "
                                                     "> 0");
  }
}

}  // namespace

SectionGeometry section_geometry(const SectionShape& s) {
  switch (s.kind) {
    case SectionShapeKind::circle:
      return tube_geometry(s.size2, 0.5 * s.size2, s.poisson_ratio);
    case SectionShapeKind::tube:
      return tube_geometry(s.size2, s.wall, s.poisson_ratio);
    case SectionShapeKind::rectangle:
      return rectangle_geometry(s.size2, s.size3, s.poisson_ratio);
    case SectionShapeKind::ellipse:
      return ellipse_geometry(s.size2, s.size3, s.poisson_ratio);
    case SectionShapeKind::i_section:
      return i_geometry(s, s.poisson_ratio);
    case SectionShapeKind::box:
      return box_geometry(s, s.poisson_ratio);
    case SectionShapeKind::t_section:
    case SectionShapeKind::l_section:
    case SectionShapeKind::u_section:
      return rectangles_geometry(s, s.poisson_ratio);
  }
  throw std::logic_error("section_geometry: a kind of section without a rule");
}

bool consists_of_rectangles(SectionShapeKind kind) {
  return kind == SectionShapeKind::t_section || kind == SectionShapeKind::l_section ||
         kind == SectionShapeKind::u_section;
}

std::vector<WallRectangle> section_rectangles(const SectionShape& s) {
  const double b = s.size2, h = s.size3, t = s.wall;
  std::vector<WallRectangle> walls;  // from the lower left corner of the section
  if (s.kind == SectionShapeKind::l_section) {
    walls = {{{0.0, 0.0}, {b, t}}, {{0.0, t}, {t, h}}};
  } else if (s.kind == SectionShapeKind::t_section) {
    walls = {{{0.0, h - t}, {b, h}}, {{0.5 * (b - s.web), 0.0}, {0.5 * (b + s.web), h - t}}};
  } else {
    walls = {{{0.0, h - t}, {b, h}}, {{0.0, 0.0}, {b, t}}, {{0.0, t}, {s.web, h - t}}};
  }
  double area = 0.0;
  std::array<double, 2> first_moment{};
  for (const WallRectangle& wall : walls) {
    const double own = wall.length(0) * wall.length(1);
    area += own;
    for (std::size_t i = 0; i < 2; ++i) first_moment[i] += own * wall.middle(i);
  }
  for (WallRectangle& wall : walls)
    for (std::size_t i = 0; i < 2; ++i) {
      wall.from[i] -= first_moment[i] / area;
      wall.to[i] -= first_moment[i] / area;
    }
  if (s.mirrored)
    for (WallRectangle& wall : walls) std::tie(wall.from[1], wall.to[1]) = std::pair(-wall.to[1], -wall.from[1]);
  return walls;
}

SectionShape sharp_shape(SectionShape shape) {
  shape.fillet = shape.inner_fillet = 0.0;
  return shape;
}

double rectangle_torsion_constant(double width, double height) {
  const double a = std::max(width, height);
  const double b = std::min(width, height);
  // J = a b^3 (1/3 - 64/pi^5 b/a sum tanh(n pi a / 2 b) / n^5), n = 1, 3, 5, ...; with
  // tanh(x) = 1 - 2 / (exp(2 x) + 1), whose first part sums to 31/32 zeta(5) and whose second falls like exp(-n pi).
  constexpr int kLastTerm = 13;  // exp(-13 pi) / 13^5 is 5e-24
  double rest = 0.0;
  for (int n = kLastTerm; n > 0; n -= 2) rest += 2.0 / (std::pow(n, 5) * (std::exp(n * kPi * a / b) + 1.0));
  const double sum = 31.0 / 32.0 * kZeta5 - rest;
  return a * cube(b) * (1.0 / 3.0 - 64.0 / std::pow(kPi, 5) * (b / a) * sum);
}

double i_section_torsion_constant(double width, double height, double flange, double web) {
  const double between = height - 2.0 * flange;
  const double flanges = 2.0 * rectangle_torsion_constant(width, flange);
  const double separate = flanges + rectangle_torsion_constant(between, web);
  if (web > flange) return separate;
  const double ratio = web / flange;
  const double alpha = -0.042 + 0.2204 * ratio - 0.0725 * square(ratio);
  const double circle = flange + 0.25 * square(web) / flange;  // diameter of the inscribed circle at the junction
  return std::max(separate, flanges + between * cube(web) / 3.0 + 2.0 * alpha * square(square(circle)));
}

const std::vector<std::pair<std::string, SectionShapeKind>>& section_shape_words() {
  static const std::vector<std::pair<std::string, SectionShapeKind>> words = {
      {"circle", SectionShapeKind::circle},       {"tube", SectionShapeKind::tube},
      {"rectangle", SectionShapeKind::rectangle}, {"ellipse", SectionShapeKind::ellipse},
      {"I", SectionShapeKind::i_section},         {"box", SectionShapeKind::box},
      {"T", SectionShapeKind::t_section},         {"L", SectionShapeKind::l_section},
      {"U", SectionShapeKind::u_section}};
  return words;
}

const std::string& section_shape_word(SectionShapeKind kind) {
  const auto& words = section_shape_words();
  return std::find_if(words.begin(), words.end(), [kind](const auto& word) { return word.second == kind; })->first;
}

Section make_section(const std::string& name, const SectionShape& shape) {
  check_dimensions(shape);
  check_material(shape);
  const SectionGeometry geometry = section_geometry(shape);
  const double e = shape.youngs_modulus;
  const double g = shape.shear_modulus.value_or(e / (2.0 * (1.0 + shape.poisson_ratio)));
  Section section;
  section.name = name;
  section.axial_stiffness = e * geometry.area;
  section.torsional_stiffness = g * geometry.torsion_constant;
  for (std::size_t i = 0; i < 2; ++i) {
    const double factor = shape.shear_correction[i].value_or(geometry.shear_factor[i]);
    section.shear_stiffness[i] = factor * g * geometry.area;
    section.bending_stiffness[i] = e * geometry.second_moment[i];
  }
  section.mass = shape.density * geometry.area;
  const auto [about2, about3] = geometry.second_moment;
  section.rotary_inertia = {shape.density * (about2 + about3), shape.density * about2, shape.density * about3};
  section.inertia_product = shape.density * geometry.product_moment;
  section.shape = shape;
  check_stiffnesses(section);
  if (geometry.product_moment == 0.0) return section;
  Matrix6& matrix = section.matrix.emplace();
  for (std::size_t i = 0; i < 6; ++i) matrix[i][i] = diagonal(section)[i];
  // M2 = E integral of (kappa2 x3 - kappa3 x2) x3, M3 of the same times -x2
  matrix[4][5] = matrix[5][4] = -e * geometry.product_moment;
  return section;
}

}  // namespace mixbeam
