#include "discretization/reading/sections.hpp"

#include "discretization/parameters/access.hpp"
#include "discretization/scene/section_shape.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace mixbeam {
namespace {

using Teuchos::ParameterList;

const std::vector<std::string> kStiffnesses = {"EA", "GA2", "GA3", "GIt", "EI2", "EI3"};
const std::vector<std::string> kDimensions = {"Diameter", "Wall", "Width", "Height", "Flange", "Web"};
constexpr std::size_t kMatrixSize = 36;
constexpr std::size_t kTriangleSize = 21;
// Entries (i, j) and (j, i) agree to this share of the root of their diagonal entries: numbers are written with ten
// digits or more.
constexpr double kSymmetryTolerance = 1e-9;
// A pivot of the scaled matrix below this is rounding: 6 entries of size 1 with some digits lost in writing.
constexpr double kSmallestPivot = 1e-12;

struct ShapeRule {
  SectionShapeKind kind;
  std::vector<std::string> dimensions;
};

const std::map<std::string, ShapeRule> kShapeRules = {
    {"circle", {SectionShapeKind::circle, {"Diameter"}}},
    {"tube", {SectionShapeKind::tube, {"Diameter", "Wall"}}},
    {"rectangle", {SectionShapeKind::rectangle, {"Width", "Height"}}},
    {"ellipse", {SectionShapeKind::ellipse, {"Width", "Height"}}},
    {"I", {SectionShapeKind::i_section, {"Width", "Height", "Flange", "Web"}}}};

ListSpec material_spec() {
  ListSpec spec("Material of a section given by its shape.");
  spec.add(real("E").above(0.0), "Young's modulus [force / length^2].");
  spec.add(real("nu").above(-1.0).at_most(0.5),
           "Poisson's ratio; may be absent where G is given, and follows then from E and G.");
  spec.add(real("G").above(0.0), "Shear modulus [force / length^2]; E / (2 (1 + nu)) if absent.");
  return spec;
}

void add_stiffnesses(ListSpec& spec) {
  spec.add(real("EA").above(0.0).or_infinite(),
           "Axial stiffness [force]; inf or the switch Inextensible for none of the strain.");
  spec.add(real("GA2").above(0.0).or_infinite(),
           "Shear stiffness in direction 2 [force]; inf or the switch Shear Rigid for none of the strain.");
  spec.add(real("GA3").above(0.0).or_infinite(),
           "Shear stiffness in direction 3 [force]; inf or the switch Shear Rigid for none of the strain.");
  spec.add(real("GIt").above(0.0), "Torsional stiffness [force * length^2].");
  spec.add(real("EI2").above(0.0), "Bending stiffness about axis 2 [force * length^2].");
  spec.add(real("EI3").above(0.0), "Bending stiffness about axis 3 [force * length^2].");
}

void add_shape(ListSpec& spec) {
  spec.add(choice("Shape", {"circle", "tube", "rectangle", "ellipse", "I"}),
           "Shape of a section of one material, instead of stiffnesses; with its dimensions and Material.");
  spec.add(real("Diameter").above(0.0), "circle, tube: outer diameter [length].");
  spec.add(real("Wall").above(0.0), "tube: thickness of the wall, at most half of the diameter [length].");
  spec.add(real("Width").above(0.0), "rectangle, ellipse, I: whole width along axis 2 [length].");
  spec.add(real("Height").above(0.0), "rectangle, ellipse, I: whole height along axis 3 [length].");
  spec.add(real("Flange").above(0.0), "I: thickness of the flanges, which lie along axis 2 [length].");
  spec.add(real("Web").above(0.0), "I: thickness of the web [length].");
  spec.add(array("Shear Correction", ParameterType::real_array, 2).above(0.0),
           "Factors of G A in GA2 and GA3; absent: those of Cowper (1966) for the shape.");
  spec.add_list("Material", material_spec(), Presence::optional);
}

/// Reads one section; `path` is its place.
class SectionReader {
 public:
  SectionReader(const ParameterList& list, const ParameterSource& source, ParameterPath path)
      : list_(list), source_(source), path_(std::move(path)) {}

  Section read() const {
    check_one_way();
    if (list_.isParameter("Shape")) return with_switches(section_from_shape());
    if (list_.isParameter("Matrix")) return section_from_matrix();
    return section_from_stiffnesses();
  }

 private:
  InputError error(const std::string& parameter, const std::string& problem) const {
    return source_.error(child(path_, parameter), problem);
  }

  bool rigid_axially() const { return list_.get<bool>("Inextensible"); }
  bool rigid_in_shear() const { return list_.get<bool>("Shear Rigid"); }
  bool is_rigid(std::size_t component) const {
    return component == 0 ? rigid_axially() : component < 3 && rigid_in_shear();
  }

  /// Parameters of one way to give a section must not stand beside those of another.
  void check_one_way() const {
    const bool shape = list_.isParameter("Shape");
    const bool matrix = list_.isParameter("Matrix");
    if (shape && matrix) throw error("Matrix", "given beside \"Shape\"; allowed: one of the two");
    if (shape || matrix) refuse(kStiffnesses, shape ? "\"Shape\"" : "\"Matrix\"");
    if (shape) return;
    const std::string owner = matrix ? "\"Matrix\"" : "stiffness values";
    const std::string problem = "given beside " + owner + "; allowed: with \"Shape\" only";
    for (const std::string& name : kDimensions)
      if (list_.isParameter(name)) throw error(name, problem);
    if (list_.isParameter("Shear Correction")) throw error("Shear Correction", problem);
    if (list_.isSublist("Material")) throw error("Material", problem);
  }

  void refuse(const std::vector<std::string>& names, const std::string& owner) const {
    for (const std::string& name : names)
      if (list_.isParameter(name)) {
        throw error(name, "given beside " + owner + "; allowed: stiffness values, or \"Shape\", or \"Matrix\"");
      }
  }

  double stiffness(std::size_t component) const {
    const std::string& name = kStiffnesses[component];
    const bool given = list_.isParameter(name);
    const std::string rigid_switch = component == 0 ? "Inextensible" : "Shear Rigid";
    const bool may_be_rigid = component < 3;
    if (is_rigid(component)) {
      if (!given) return std::numeric_limits<double>::infinity();
      throw error(name, "value " + shortest(list_.get<double>(name)) + ", but \"" + rigid_switch +
                            "\" is true; allowed: one of the two");
    }
    if (given) return list_.get<double>(name);
    throw error(name, "missing; allowed: a double > 0" +
                          (may_be_rigid ? ", or inf, or \"" + rigid_switch + "\" = true" : std::string()) +
                          "; or \"Shape\" or \"Matrix\" instead of all stiffness values");
  }

  Section section_from_stiffnesses() const {
    Section section;
    section.axial_stiffness = stiffness(0);
    section.shear_stiffness = {stiffness(1), stiffness(2)};
    section.torsional_stiffness = stiffness(3);
    section.bending_stiffness = {stiffness(4), stiffness(5)};
    return section;
  }

  Section with_switches(Section section) const {
    const double infinity = std::numeric_limits<double>::infinity();
    if (rigid_axially()) section.axial_stiffness = infinity;
    if (rigid_in_shear()) section.shear_stiffness = {infinity, infinity};
    return section;
  }

  Section section_from_shape() const {
    const auto& word = list_.get<std::string>("Shape");
    const ShapeRule& rule = kShapeRules.at(word);
    check_dimensions(word, rule);
    SectionShape shape;
    shape.kind = rule.kind;
    const bool round = rule.kind == SectionShapeKind::circle || rule.kind == SectionShapeKind::tube;
    shape.size2 = list_.get<double>(round ? "Diameter" : "Width");
    if (!round) shape.size3 = list_.get<double>("Height");
    if (rule.kind == SectionShapeKind::tube) shape.wall = list_.get<double>("Wall");
    if (rule.kind == SectionShapeKind::i_section) {
      shape.wall = list_.get<double>("Flange");
      shape.web = list_.get<double>("Web");
    }
    if (list_.isParameter("Shear Correction")) {
      const auto& factors = list_.get<Teuchos::Array<double>>("Shear Correction");
      shape.shear_correction = {factors[0], factors[1]};
    }
    read_material(shape);
    try {
      return make_section("", shape);
    } catch (const std::invalid_argument& problem) {
      throw error("Shape", "value \"" + word + "\": " + problem.what());
    }
  }

  void check_dimensions(const std::string& word, const ShapeRule& rule) const {
    for (const std::string& name : kDimensions) {
      const auto& needed = rule.dimensions;
      const bool wanted = std::find(needed.begin(), needed.end(), name) != needed.end();
      if (wanted == list_.isParameter(name)) continue;
      const std::string problem = wanted ? "missing; needed for" : "given, but has no meaning for";
      throw error(name, problem + " \"Shape\" = \"" + word + "\"; allowed with it: " + quoted_list(needed));
    }
    if (!list_.isSublist("Material"))
      throw error("Material", "missing ParameterList; needed for \"Shape\" = \"" + word + "\": \"E\" and \"nu\"");
  }

  void read_material(SectionShape& shape) const {
    const ParameterList& material = list_.sublist("Material");
    const auto missing = [&](const std::string& name, const std::string& allowed) {
      return source_.error(child(child(path_, "Material"), name), "missing; allowed: " + allowed);
    };
    if (!material.isParameter("E")) throw missing("E", "a double > 0 (Young's modulus)");
    shape.youngs_modulus = material.get<double>("E");
    if (material.isParameter("G")) shape.shear_modulus = material.get<double>("G");
    if (material.isParameter("nu")) {
      shape.poisson_ratio = material.get<double>("nu");
      return;
    }
    if (!shape.shear_modulus) throw missing("nu", "a double, -1 < value <= 0.5 (Poisson's ratio), or \"G\"");
    shape.poisson_ratio = 0.5 * shape.youngs_modulus / *shape.shear_modulus - 1.0;
    if (shape.poisson_ratio <= 0.5) return;
    throw missing("nu", "a double, -1 < value <= 0.5; E / (2 G) - 1 is " + shortest(shape.poisson_ratio) +
                            ", which no isotropic material has");
  }

  Section section_from_matrix() const {
    const Matrix6 matrix = read_matrix();
    Section section;
    std::array<double, 6> diagonal{};
    for (std::size_t i = 0; i < 6; ++i)
      diagonal[i] = is_rigid(i) ? std::numeric_limits<double>::infinity() : matrix[i][i];
    section.axial_stiffness = diagonal[0];
    section.shear_stiffness = {diagonal[1], diagonal[2]};
    section.torsional_stiffness = diagonal[3];
    section.bending_stiffness = {diagonal[4], diagonal[5]};
    section.matrix = matrix;
    return section;
  }

  Matrix6 read_matrix() const {
    const auto& values = list_.get<Teuchos::Array<double>>("Matrix");
    const auto count = static_cast<std::size_t>(values.size());
    if (count != kMatrixSize && count != kTriangleSize) {
      throw error("Matrix", std::to_string(count) +
                                " entries; allowed: 36, row by row, or the 21 of the upper triangle, row by row, in "
                                "the order EA, GA2, GA3, GIt, EI2, EI3");
    }
    Matrix6 matrix{};
    Teuchos::Ordinal next = 0;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = count == kMatrixSize ? 0 : i; j < 6; ++j) {
        matrix[i][j] = values[next++];
        if (count == kTriangleSize) matrix[j][i] = matrix[i][j];
      }
    check_diagonal(matrix);
    make_symmetric(matrix);
    check_positive_definite(matrix);
    return matrix;
  }

  void check_diagonal(const Matrix6& matrix) const {
    for (std::size_t i = 0; i < 6; ++i) {
      if (is_rigid(i) || matrix[i][i] > 0.0) continue;
      throw error("Matrix", "entry " + entry_name(i, i) + " is " + shortest(matrix[i][i]) + "; allowed: > 0");
    }
  }

  static std::string entry_name(std::size_t i, std::size_t j) {
    return "(" + std::to_string(i + 1) + ", " + std::to_string(j + 1) + ")";
  }

  void make_symmetric(Matrix6& matrix) const {
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const double size = std::sqrt(std::abs(matrix[i][i])) * std::sqrt(std::abs(matrix[j][j]));
        const bool counts = !is_rigid(i) && !is_rigid(j);
        if (counts && std::abs(matrix[i][j] - matrix[j][i]) > kSymmetryTolerance * size) {
          throw error("Matrix", "entry " + entry_name(i, j) + " is " + shortest(matrix[i][j]) + ", but " +
                                    entry_name(j, i) + " is " + shortest(matrix[j][i]) +
                                    "; allowed: a symmetric matrix");
        }
        matrix[i][j] = matrix[j][i] = 0.5 * (matrix[i][j] + matrix[j][i]);
      }
  }

  /// Cholesky's factors of the matrix scaled to a diagonal of ones, without the rigid components.
  void check_positive_definite(const Matrix6& matrix) const {
    Matrix6 factor{};
    for (std::size_t i = 0; i < 6; ++i) {
      if (is_rigid(i)) continue;
      for (std::size_t j = 0; j <= i; ++j) {
        if (is_rigid(j)) continue;
        double rest = matrix[i][j] / (std::sqrt(matrix[i][i]) * std::sqrt(matrix[j][j]));
        for (std::size_t k = 0; k < j; ++k) rest -= factor[i][k] * factor[j][k];
        if (i != j) {
          factor[i][j] = rest / factor[j][j];
        } else if (rest > kSmallestPivot) {
          factor[i][i] = std::sqrt(rest);
        } else {
          throw error(
              "Matrix",
              "not positive definite: its upper left block of " + std::to_string(i + 1) +
                  " rows has a state of strain without energy or below; allowed: a symmetric positive definite matrix");
        }
      }
    }
  }

  const ParameterList& list_;
  const ParameterSource& source_;
  const ParameterPath path_;
};

}  // namespace

ListSpec section_spec() {
  ListSpec spec(
      "Linear elastic section in its own axes 1 (along), 2, 3: either a stiffness for each strain, or Shape with "
      "Material, or Matrix.");
  add_stiffnesses(spec);
  add_shape(spec);
  spec.add(array("Matrix", ParameterType::real_array).at_least(-std::numeric_limits<double>::max()),
           "Stiffness of a coupled section in the order EA, GA2, GA3, GIt, EI2, EI3: all 36 entries or the 21 of the "
           "upper triangle, row by row; symmetric and positive definite.");
  spec.add(boolean("Inextensible").by_default(false),
           "True: no axial strain; EA must then not be given, and its row of Matrix does not count.");
  spec.add(boolean("Shear Rigid").by_default(false),
           "True: no shear strain, sections stay normal to the axis; GA2 and GA3 must then not be given, and their "
           "rows of Matrix do not count.");
  return spec;
}

std::vector<Section> read_sections(const ParameterList& sections, const ParameterSource& source,
                                   const ParameterPath& path) {
  std::vector<Section> read;
  for (const std::string& name : names_of(sections)) {
    Section section = SectionReader(sections.sublist(name), source, child(path, name)).read();
    section.name = name;
    read.push_back(std::move(section));
  }
  return read;
}

}  // namespace mixbeam
