#include "discretization/scene/section_law.hpp"

#include "discretization/scene/section_shape.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace mixbeam {

namespace {

constexpr int kComponents = 6;
constexpr const char* kStiffnessNames[kComponents] = {"EA", "GA2", "GA3", "GIt", "EI2", "EI3"};

/// Largest asymmetry of a matrix scaled to a unit diagonal: numbers are written with ten digits or more.
constexpr double kSymmetry = 1e-9;

/// A pivot of such a matrix below this is rounding: six entries of size 1 with some digits lost in writing.
constexpr double kSmallestPivot = 1e-12;

std::string in_section(const Section& section) {
  return section.name.empty() ? "" : "section \"" + section.name + "\": ";
}

void check_diagonal(const Section& section) {
  const auto values = diagonal(section);
  for (int i = 0; i < kComponents; ++i)
    if (!(values[i] > 0.0))
      throw std::invalid_argument(in_section(section) + kStiffnessNames[i] + " is " + shortest(values[i]) +
                                  "; allowed: a positive number or infinity");
}

/// Components that are not rigid.
std::vector<int> elastic_components(const Section& section) {
  std::vector<int> elastic;
  const auto values = diagonal(section);
  for (int i = 0; i < kComponents; ++i)
    if (!std::isinf(values[i])) elastic.push_back(i);
  return elastic;
}

/// Square roots of the diagonal, by which the matrix is scaled: its test must not depend on units.
std::vector<double> scales(const Section& section, const std::vector<int>& elastic) {
  std::vector<double> scale;
  for (int i : elastic) {
    const double value = (*section.matrix)[i][i];
    if (!(value > 0.0) || std::isinf(value))
      throw std::invalid_argument(in_section(section) + "the entry of the matrix for " + kStiffnessNames[i] + " is " +
                                  shortest(value) + "; allowed: a positive number");
    scale.push_back(std::sqrt(value));
  }
  return scale;
}

/// The elastic part of the matrix, scaled to a unit diagonal.
Matrix6 scaled_matrix(const Section& section, const std::vector<int>& elastic, const std::vector<double>& scale) {
  const Matrix6& matrix = *section.matrix;
  Matrix6 scaled{};
  for (std::size_t i = 0; i < elastic.size(); ++i)
    for (std::size_t j = 0; j < elastic.size(); ++j) {
      const double unit = scale[i] * scale[j], here = matrix[elastic[i]][elastic[j]] / unit,
                   there = matrix[elastic[j]][elastic[i]] / unit;
      if (!(std::abs(here - there) <= kSymmetry))
        throw std::invalid_argument(in_section(section) + "the matrix is not symmetric: row " +
                                    kStiffnessNames[elastic[i]] + ", column " + kStiffnessNames[elastic[j]] + " is " +
                                    shortest(matrix[elastic[i]][elastic[j]]) + ", the entry across the diagonal " +
                                    shortest(matrix[elastic[j]][elastic[i]]));
      scaled[i][j] = 0.5 * (here + there);
    }
  return scaled;
}

/// Inverse of the leading n x n part by its Cholesky factor; throws where a pivot is not positive.
Matrix6 positive_inverse(const Section& section, Matrix6 a, int n) {
  int info = 0;
  double* const entries = a[0].data();
  Teuchos::LAPACK<int, double>().POTRF('U', n, entries, kComponents, &info);  // by columns: the lower triangle
  for (int j = 0; j < n; ++j)
    if (info == j + 1 || !(a[j][j] * a[j][j] > kSmallestPivot))
      throw std::invalid_argument(in_section(section) +
                                  "the matrix is not positive definite: some strain of its first " +
                                  std::to_string(j + 1) + " elastic components has no positive energy");
  Teuchos::LAPACK<int, double>().POTRI('U', n, entries, kComponents, &info);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) a[j][i] = a[i][j];
  return a;
}

Matrix6 inverse_of_matrix(const Section& section) {
  const std::vector<int> elastic = elastic_components(section);
  const std::size_t n = elastic.size();
  const std::vector<double> scale = scales(section, elastic);
  const Matrix6 inverse = positive_inverse(section, scaled_matrix(section, elastic, scale), static_cast<int>(n));
  Matrix6 compliance{};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) compliance[elastic[i]][elastic[j]] = inverse[i][j] / (scale[i] * scale[j]);
  return compliance;
}

const Section& find_section(const Scene& scene, const Member& member, const std::string& name) {
  for (const Section& section : scene.sections)
    if (section.name == name) return section;
  std::vector<std::string> names;
  for (const Section& section : scene.sections) names.push_back(section.name);
  throw InputError("member \"" + member.name + "\": there is no section named \"" + name + "\"" +
                   did_you_mean(name, names));
}

double interpolated(double weight, double start, double end) { return (1.0 - weight) * start + weight * end; }

/// (1 - w) start + w end; equal values stay as they are, infinite ones too.
std::array<double, kComponents> interpolated_diagonal(double weight, const Section& start, const Section& end) {
  const auto a = diagonal(start), b = diagonal(end);
  std::array<double, kComponents> result{};
  for (int i = 0; i < kComponents; ++i) result[i] = std::isinf(a[i]) ? a[i] : interpolated(weight, a[i], b[i]);
  return result;
}

Matrix6 stiffness_matrix(const Section& section) {
  if (section.matrix) return *section.matrix;
  Matrix6 matrix{};
  const auto values = diagonal(section);
  for (int i = 0; i < kComponents; ++i) matrix[i][i] = std::isinf(values[i]) ? 0.0 : values[i];
  return matrix;
}

/// Interpolated points with rows of stresses, if both sections have the same ones by name.
std::optional<StressPoints> interpolated_points(double weight, const Section& start, const Section& end) {
  if (!start.stress_points || !end.stress_points) return std::nullopt;
  const StressPoints& other = *end.stress_points;
  StressPoints points = *start.stress_points;
  if (points.points.size() != other.points.size()) return std::nullopt;
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    StressPoints::Place& place = points.points[i];
    const StressPoints::Place& there = other.points[i];
    if (place.name != there.name || !place.stress || !there.stress) return std::nullopt;
    for (int j = 0; j < 2; ++j) place.at[j] = interpolated(weight, place.at[j], there.at[j]);
    for (int j = 0; j < 18; ++j) {
      double& number = (*place.stress)[j / 6][j % 6];
      number = interpolated(weight, number, (*there.stress)[j / 6][j % 6]);
    }
  }
  if (points.strength && other.strength)
    points.strength = interpolated(weight, *points.strength, *other.strength);
  else
    points.strength.reset();
  return points;
}

void interpolate_damping(double weight, const Section& start, const Section& end, Section& section) {
  section.mass_damping = interpolated(weight, start.mass_damping, end.mass_damping);
  section.stiffness_damping = interpolated(weight, start.stiffness_damping, end.stiffness_damping);
}

Section interpolated_stiffness(double weight, const Section& start, const Section& end) {
  Section section;
  section.name = start.name;
  set_diagonal(section, interpolated_diagonal(weight, start, end));
  section.mass = interpolated(weight, start.mass, end.mass);
  interpolate_damping(weight, start, end, section);
  for (int i = 0; i < 3; ++i)
    section.rotary_inertia[i] = interpolated(weight, start.rotary_inertia[i], end.rotary_inertia[i]);
  section.inertia_product = interpolated(weight, start.inertia_product, end.inertia_product);
  for (int i = 0; i < 2; ++i) section.mass_offset[i] = interpolated(weight, start.mass_offset[i], end.mass_offset[i]);
  section.stress_points = interpolated_points(weight, start, end);
  const auto &drawn = start.drawn_as, &drawn_end = end.drawn_as;
  if (drawn && drawn_end && drawn->kind == drawn_end->kind) {
    section.drawn_as = drawn;
    section.drawn_as->size2 = interpolated(weight, drawn->size2, drawn_end->size2);
    section.drawn_as->size3 = interpolated(weight, drawn->size3, drawn_end->size3);
  }
  if (!start.matrix && !end.matrix) return section;
  const Matrix6 a = stiffness_matrix(start), b = stiffness_matrix(end);
  section.matrix.emplace();
  for (int i = 0; i < kComponents; ++i)
    for (int j = 0; j < kComponents; ++j) (*section.matrix)[i][j] = interpolated(weight, a[i][j], b[i][j]);
  return section;
}

double shear_modulus(const SectionShape& shape) {
  return shape.shear_modulus ? *shape.shear_modulus : shape.youngs_modulus / (2.0 * (1.0 + shape.poisson_ratio));
}

Section interpolated_shape(double weight, const Section& start, const Section& end) {
  const SectionShape &a = *start.shape, &b = *end.shape;
  SectionShape shape = a;
  if (!b.strength) shape.strength.reset();
  for (double SectionShape::*number :
       {&SectionShape::size2, &SectionShape::size3, &SectionShape::wall, &SectionShape::web, &SectionShape::fillet,
        &SectionShape::inner_fillet, &SectionShape::youngs_modulus, &SectionShape::poisson_ratio,
        &SectionShape::density})
    shape.*number = interpolated(weight, a.*number, b.*number);
  if (a.shear_modulus || b.shear_modulus)
    shape.shear_modulus = interpolated(weight, shear_modulus(a), shear_modulus(b));
  if (a.strength && b.strength) shape.strength = interpolated(weight, *a.strength, *b.strength);
  for (int i = 0; i < 2; ++i)
    if (a.shear_correction[i] && b.shear_correction[i])
      shape.shear_correction[i] = interpolated(weight, *a.shear_correction[i], *b.shear_correction[i]);
  Section section = make_section(start.name, shape);
  interpolate_damping(weight, start, end, section);
  auto values = diagonal(section);
  const auto of_start = diagonal(start);
  for (int i = 0; i < kComponents; ++i)
    if (std::isinf(of_start[i])) values[i] = of_start[i];
  set_diagonal(section, values);
  return section;
}

/// Between rigid and elastic there is nothing to interpolate.
void check_taper(const Section& start, const Section& end, bool by_shape) {
  const auto a = diagonal(start), b = diagonal(end);
  const std::string text = "taper from section \"" + start.name + "\" to \"" + end.name + "\": ";
  for (int i = 0; i < kComponents; ++i)
    if (std::isinf(a[i]) != std::isinf(b[i]))
      throw std::invalid_argument(text + kStiffnessNames[i] +
                                  " is rigid in one of them and not in the other; allowed: both or none");
  if (!by_shape) return;
  for (int i = 0; i < 2; ++i)
    if (start.shape->shear_correction[i].has_value() != end.shape->shear_correction[i].has_value())
      throw std::invalid_argument(text + "only one of them gives the shear correction " + std::to_string(i + 2) +
                                  "; allowed: both or none");
}

/// Rounding of inertias, which are written with ten digits or more; remainder of a zero pivot.
constexpr double kRoundedInertia = 1e-9, kNoPivot = 1e-14;

/// Matrix of the form |v + w x c|^2 m + w . J w, c in the plane of the section.
Matrix6 mass_matrix(const Section& section) {
  const double m = section.mass, c2 = section.mass_offset[0], c3 = section.mass_offset[1];
  Matrix6 matrix{};
  for (int i = 0; i < 3; ++i) {
    matrix[i][i] = m;
    matrix[3 + i][3 + i] = section.rotary_inertia[i];
  }
  // w x c = (w2 c3 - w3 c2, -w1 c3, w1 c2)
  const double arm[3][3] = {{0.0, c3, -c2}, {-c3, 0.0, 0.0}, {c2, 0.0, 0.0}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      matrix[i][3 + j] = matrix[3 + j][i] = m * arm[i][j];
      for (int k = 0; k < 3; ++k) matrix[3 + i][3 + j] += m * arm[k][i] * arm[k][j];
    }
  matrix[4][5] -= section.inertia_product;
  matrix[5][4] -= section.inertia_product;
  return matrix;
}

}  // namespace

std::array<double, kComponents> diagonal(const Section& s) {
  return {s.axial_stiffness,     s.shear_stiffness[0],   s.shear_stiffness[1],
          s.torsional_stiffness, s.bending_stiffness[0], s.bending_stiffness[1]};
}

void set_diagonal(Section& s, const std::array<double, kComponents>& d) {
  s.axial_stiffness = d[0];
  s.shear_stiffness = {d[1], d[2]};
  s.torsional_stiffness = d[3];
  s.bending_stiffness = {d[4], d[5]};
}

Matrix6 section_compliance(const Section& section) {
  check_diagonal(section);
  if (section.matrix) return inverse_of_matrix(section);
  Matrix6 compliance{};
  const auto values = diagonal(section);
  for (int i = 0; i < kComponents; ++i) compliance[i][i] = 1.0 / values[i];  // rigid: 1/infinity is zero
  return compliance;
}

bool has_general_section(const Scene& scene, const Member& member) {
  return !member.end_section.empty() || find_section(scene, member, member.section).matrix.has_value();
}

SectionLaw::SectionLaw(const Scene& scene, const Member& member)
    : tapered_(!member.end_section.empty()), start_(find_section(scene, member, member.section)) {
  start_compliance_ = section_compliance(start_);  // errors of a section itself do not name a place along the member
  if (!tapered_) return;
  end_ = find_section(scene, member, member.end_section);
  section_compliance(end_);
  weight_ = Expression(member.taper.empty() ? "x" : member.taper, {"x"});
  by_shape_ = start_.shape && end_.shape && start_.shape->kind == end_.shape->kind;
  check_taper(start_, end_, by_shape_);
}

Section SectionLaw::section(double x) const {
  if (!tapered_) return start_;
  const double weight = weight_(x);
  if (!std::isfinite(weight))
    throw std::invalid_argument("taper \"" + weight_.text() + "\" is not a finite number at x = " + shortest(x) +
                                "; allowed: a formula that is finite from x = 0 to 1");
  return section_of_weight(weight);
}

Section SectionLaw::section_of_weight(double weight) const {
  if (!tapered_) return start_;
  return by_shape_ ? interpolated_shape(weight, start_, end_) : interpolated_stiffness(weight, start_, end_);
}

Matrix6 SectionLaw::compliance(double x) const {
  if (!tapered_) return start_compliance_;
  try {
    return section_compliance(section(x));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("at x = " + shortest(x) + " of the taper: " + error.what());
  }
}

bool is_inertia(const std::array<double, 3>& inertia) {
  const double sum = inertia[0] + inertia[1] + inertia[2], largest = *std::max_element(inertia.begin(), inertia.end());
  return 2.0 * largest <= (1.0 + kRoundedInertia) * sum;
}

/// Cholesky factorization; a zero pivot leaves a column of zeros.
std::array<double, 21> mass_factor(const Section& section) {
  const Matrix6 matrix = mass_matrix(section);
  std::array<double, 21> factor{};
  const auto at = [&factor](int i, int j) -> double& { return factor[static_cast<std::size_t>(i * (i + 1) / 2 + j)]; };
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) {
      double rest = matrix[i][j];
      for (int k = 0; k < j; ++k) rest -= at(i, k) * at(j, k);
      if (i == j)
        at(j, j) = rest > kNoPivot * matrix[j][j] ? std::sqrt(rest) : 0.0;
      else
        at(i, j) = at(j, j) > 0.0 ? rest / at(j, j) : 0.0;
    }
  return factor;
}

}  // namespace mixbeam
