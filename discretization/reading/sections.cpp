#include "discretization/reading/scene_parts.hpp"

#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/scene/limits.hpp"
#include "discretization/scene/names.hpp"
#include "discretization/scene/section_law.hpp"
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
constexpr std::size_t kMatrixSize = 36;
constexpr std::size_t kTriangleSize = 21;
constexpr double kRigid = std::numeric_limits<double>::infinity();
/// For a thin strip the square of the inertia product is that of the moments; numbers are written with ten digits.
constexpr double kRoundedProduct = 1e-9;

/// Parameters that are allowed only with Shape.
const std::vector<std::string> kOfShape = {"Diameter", "Wall",   "Width",         "Height",       "Flange",
                                           "Web",      "Fillet", "Corner Radius", "Inner Radius", "Shear Correction",
                                           "Material"};

/// A section as written, in one of three ways.
struct SectionDraft {
  std::array<std::optional<double>, 6> stiffness{};
  SectionShape shape{};
  std::optional<std::array<double, 2>> shear_correction{};
  std::optional<double> youngs_modulus{}, poisson_ratio{};
  std::vector<double> matrix{};
  std::optional<double> mass{};
  std::optional<std::array<double, 2>> damping{};  ///< alpha, beta
  std::optional<std::array<double, 3>> rotary_inertia{};
  std::optional<double> inertia_product{};
  std::optional<std::array<double, 2>> mass_offset{};
  std::optional<double> inner_radius{};
  std::optional<StressPoints> stress_points{};
  std::optional<SectionShape> drawn_as{};
  bool inextensible = false, shear_rigid = false;
  double largest_strain = Section{}.largest_strain;

  bool is_rigid(std::size_t component) const { return component == 0 ? inextensible : component < 3 && shear_rigid; }
};

BoundList<SectionDraft> material_parameters() {
  BoundList<SectionDraft> material("Material of a section given by its shape.");
  material.bind(&SectionDraft::youngs_modulus, real("E").above(0.0), "Young's modulus [force / length^2].");
  material.bind(&SectionDraft::poisson_ratio, real("nu").above(-1.0).at_most(0.5),
                "Poisson's ratio; may be absent where G is given, and follows then from E and G.");
  material.bind(
      [](auto& d) -> auto& { return d.shape.shear_modulus; }, real("G").above(0.0),
      "Shear modulus [force / length^2]; E / (2 (1 + nu)) if absent.");
  material.bind(
      [](auto& d) -> auto& { return d.shape.strength; }, real("Strength").above(0.0),
      "Admissible von Mises stress (yield strength over the safety factor) [force / length^2]; the report then states "
      "the utilisation.");
  material.bind(
      [](auto& d) -> auto& { return d.shape.density; }, real("Density").at_least(0.0),
      "Mass per volume, for the list Gravity and for Modes.");
  return material;
}

BoundList<StressPoints> stress_points_parameters() {
  BoundList<StressPoints> stress(
      "Of a section given by stiffnesses: where its stresses are asked for. Normal stress N / A + M2 x3 / I2 - M3 x2 / "
      "I3 with I = EI / E; shear stress of the torque alone. Of one given by Matrix: E times the strain at each point, "
      "or what Recovery says.");
  stress.bind(&StressPoints::youngs_modulus, real("E").above(0.0),
              "Young's modulus [force / length^2]; needed unless Recovery is given.");
  stress.bind(&StressPoints::area, real("Area").above(0.0), "Area A [length^2]; EA / E if absent.");
  stress.bind(&StressPoints::torsion_modulus, real("Torsion Modulus").above(0.0),
              "Torque over shear stress at every point [length^3]; if absent, the torque causes no shear stress.");
  stress.bind(&StressPoints::strength, real("Strength").above(0.0),
              "Admissible von Mises stress [force / length^2]; the report then states the utilisation.");
  stress.bind_named(&StressPoints::points, "Points", "The points; at least one.", "point",
                    coordinates("", 2).required().means("Coordinates along axes 2 and 3, from the centroid [length]."),
                    &StressPoints::Place::name, &StressPoints::Place::at);
  stress.spec.add_list(
      "Recovery",
      ListSpec("Beside Matrix: stresses at each of the Points of unit section forces.")
          .with_named_parameters("point", array("", ParameterType::real_array)
                                              .at_least(-std::numeric_limits<double>::max())
                                              .required()
                                              .means("Normal stress of unit N, Q2, Q3, T, M2, M3, six numbers; after "
                                                     "them six of tau_12 and six of tau_13, if these are wanted.")),
      Presence::optional);
  return stress;
}

BoundList<SectionShape> drawn_as_parameters() {
  BoundList<SectionShape> drawn("How pictures show a section given by stiffnesses or Matrix; it changes nothing else.");
  drawn.bind(&SectionShape::kind, text("Shape").required(), "Its outline.",
             {{"ellipse", SectionShapeKind::ellipse}, {"rectangle", SectionShapeKind::rectangle}});
  drawn.bind(&SectionShape::size2, real("Chord").above(0.0).required(), "Whole width along axis 2 [length].");
  drawn.bind(&SectionShape::size3, real("Thickness").above(0.0).required(), "Whole height along axis 3 [length].");
  return drawn;
}

BoundList<std::array<double, 2>> damping_parameters() {
  BoundList<std::array<double, 2>> damping("Damping of vibrations, for Modes; static states are not damped.");
  damping.bind(
      [](auto& d) -> auto& { return d[0]; }, real("Alpha").at_least(0.0).by_default(),
      "Mass proportional: forces of alpha times mass times velocity [1 / time].");
  damping.bind(
      [](auto& d) -> auto& { return d[1]; }, real("Beta").at_least(0.0).by_default(),
      "Proportional to the stiffness of the material (Kelvin, Voigt): stresses of strain + beta times its rate "
      "[time].");
  return damping;
}

void bind_stiffnesses(BoundList<SectionDraft>& section) {
  auto bind = [&, component = std::size_t{0}](const ParameterSpec& spec, const std::string& meaning) mutable {
    section.bind(
        [i = component++](auto& d) -> auto& { return d.stiffness[i]; }, spec, meaning);
  };
  bind(real("EA").above(0.0).or_infinite(), "Axial stiffness [force]; inf or the switch Inextensible for zero strain.");
  for (const std::string direction : {"2", "3"})
    bind(real("GA" + direction).above(0.0).or_infinite(),
         "Shear stiffness in direction " + direction + " [force]; inf or the switch Shear Rigid for zero strain.");
  bind(real("GIt").above(0.0), "Torsional stiffness [force * length^2].");
  for (const std::string axis : {"2", "3"})
    bind(real("EI" + axis).above(0.0), "Bending stiffness about axis " + axis + " [force * length^2].");
}

void bind_shape(BoundList<SectionDraft>& section) {
  section.bind(
      [](auto& d) -> auto& { return d.shape.kind; }, text("Shape"),
      "Shape of a section of one material, instead of stiffnesses; with its dimensions and Material.",
      section_shape_words());
  const auto bind = [&](double SectionShape::*size, const std::string& name, const std::string& meaning) {
    section.bind(
        [size](auto& d) -> auto& { return d.shape.*size; }, real(name).above(0.0), meaning);
  };
  bind(&SectionShape::size2, "Diameter", "circle, tube: outer diameter [length].");
  bind(&SectionShape::wall, "Wall",
       "tube, box, L: thickness of the wall, at most half of the diameter, less than half of Width and Height "
       "[length].");
  bind(&SectionShape::size2, "Width", "rectangle, ellipse, I, box, T, L, U: whole width along axis 2 [length].");
  bind(&SectionShape::size3, "Height", "rectangle, ellipse, I, box, T, L, U: whole height along axis 3 [length].");
  bind(&SectionShape::wall, "Flange",
       "I, T, U: thickness of the flanges, which lie along axis 2; that of a T is at the top, those of a U point along "
       "axis 2 [length].");
  bind(&SectionShape::web, "Web", "I, T, U: thickness of the web [length].");
  bind(&SectionShape::fillet, "Fillet", "I: radius between web and flanges [length].");
  bind(&SectionShape::fillet, "Corner Radius", "box: outer radius of its corners [length].");
  section.bind(&SectionDraft::inner_radius, real("Inner Radius").at_least(0.0),
               "box: inner radius of its corners; Corner Radius less Wall if absent, and at least zero [length].");
  section.bind(&SectionDraft::shear_correction, array("Shear Correction", ParameterType::real_array, 2).above(0.0),
               "Factors of G A in GA2 and GA3; absent: those of Cowper (1966) for the shape.");
  section.bind_list(
      [](SectionDraft & d) -> auto& { return d; }, "Material", material_parameters(), Presence::optional);
  const auto form = [](std::vector<std::string> dimensions, std::vector<std::string> optional = {}) {
    dimensions.emplace_back("Material");
    optional.emplace_back("Shear Correction");
    return std::vector<Form>{{std::move(dimensions), std::move(optional)}};
  };
  section.spec.with_forms("Shape", {{"circle", form({"Diameter"})},
                                    {"tube", form({"Diameter", "Wall"})},
                                    {"rectangle", form({"Width", "Height"})},
                                    {"ellipse", form({"Width", "Height"})},
                                    {"I", form({"Width", "Height", "Flange", "Web"}, {"Fillet"})},
                                    {"box", form({"Width", "Height", "Wall"}, {"Corner Radius", "Inner Radius"})},
                                    {"T", form({"Width", "Height", "Flange", "Web"})},
                                    {"L", form({"Width", "Height", "Wall"})},
                                    {"U", form({"Width", "Height", "Flange", "Web"})}});
  section.spec.without_form({"EA", "GA2", "GA3", "GIt", "EI2", "EI3", "Matrix", "Mass", "Rotary Inertia",
                             "Inertia Product", "Mass Offset", "Stress Points", "Drawn As"});
}

const BoundList<SectionDraft> kSectionParameters = [] {
  BoundList<SectionDraft> section(
      "Linear elastic section in its own axes 1 (along), 2, 3: either a stiffness for each strain, or Shape or Profile "
      "with Material, or Matrix.");
  section.spec.add(text("Profile"),
                   "Shape and dimensions by name from the catalogue, as IPE 300, HEB 200, SHS 100x100x5, and from the "
                   "table Profiles File of the list Import; with Material, and Units of the scene.");
  bind_stiffnesses(section);
  bind_shape(section);
  section.bind(&SectionDraft::matrix,
               array("Matrix", ParameterType::real_array).at_least(-std::numeric_limits<double>::max()),
               "Stiffness of a coupled section in the order EA, GA2, GA3, GIt, EI2, EI3: all 36 entries or the 21 of "
               "the upper triangle, row by row; symmetric and positive definite.");
  section.bind(&SectionDraft::mass, real("Mass").at_least(0.0),
               "Mass per length of a section given by stiffnesses or Matrix, for the list Gravity and for Modes "
               "(Density of Material of one given by Shape).");
  section.bind(&SectionDraft::rotary_inertia, array("Rotary Inertia", ParameterType::real_array, 3).at_least(0.0),
               "With Mass: moments of inertia per length about axes 1, 2 and 3 through the centre of mass, for Modes; "
               "zero if absent (those of one given by Shape follow from Density) [mass * length].");
  section.bind(&SectionDraft::inertia_product, real("Inertia Product"),
               "Integral of density times x2 x3, with Rotary Inertia, over the section, from the centre of mass; zero "
               "if absent [mass * length].");
  section.bind(
      &SectionDraft::mass_offset, coordinates("Mass Offset", 2),
      "With Mass: place of the centre of mass along axes 2 and 3, for Modes; zero if absent. Weight acts on the axis "
      "all the same [length].");
  section.bind_list(&SectionDraft::damping, "Damping", damping_parameters(), Presence::optional);
  section.bind_list(&SectionDraft::stress_points, "Stress Points", stress_points_parameters(), Presence::optional);
  section.bind_list(&SectionDraft::drawn_as, "Drawn As", drawn_as_parameters(), Presence::optional);
  section.bind(&SectionDraft::inextensible, boolean("Inextensible").by_default(),
               "True: no axial strain; EA must then not be given, and its row of Matrix does not count.");
  section.bind(&SectionDraft::shear_rigid, boolean("Shear Rigid").by_default(),
               "True: no shear strain, sections stay normal to the axis; GA2 and GA3 must then not be given, and their "
               "rows of Matrix do not count.");
  section.bind(&SectionDraft::largest_strain, real("Largest Strain").above(0.0).by_default(),
               "A run warns of larger strains, of the axis or at the edge of the section: the linear law is hardly "
               "valid there. Eigenstrains do not count.");
  return section;
}();

/// Reads one section; `path` is its place.
class SectionReader {
 public:
  SectionReader(const ParameterList& list, const InputPlace& place)
      : list_(list), place_(place), draft_(kSectionParameters.read(list)) {}

  Section read() const {
    check_one_way();
    Section section = list_.isParameter("Shape")    ? section_from_shape()
                      : list_.isParameter("Matrix") ? section_from_matrix()
                                                    : section_from_stiffnesses();
    section.largest_strain = draft_.largest_strain;
    if (draft_.mass) read_mass(section);
    if (draft_.damping) {
      section.mass_damping = (*draft_.damping)[0];
      section.stiffness_damping = (*draft_.damping)[1];
    }
    if (draft_.stress_points) section.stress_points = checked_stress_points(section);
    section.drawn_as = draft_.drawn_as;
    return section;
  }

 private:
  InputError error(const std::string& parameter, const std::string& problem) const {
    return place_[parameter].error(problem);
  }

  /// Parameters of different ways to give a section exclude each other.
  void check_one_way() const {
    const bool shape = list_.isParameter("Shape"), matrix = list_.isParameter("Matrix");
    for (const char* name : {"Mass", "Rotary Inertia", "Inertia Product", "Mass Offset"}) {
      if (!is_given(list_, name)) continue;
      if (shape) throw error(name, "given beside \"Shape\"; allowed: \"Density\" in \"Material\"");
      if (!draft_.mass) throw error(name, "given without \"Mass\"; allowed: with it");
    }
    if (shape && draft_.drawn_as)
      throw error("Drawn As", "given beside \"Shape\"; allowed: beside stiffness values or \"Matrix\"");
    const std::string owner = shape ? "\"Shape\"" : matrix ? "\"Matrix\"" : "stiffness values";
    if (shape && matrix) throw error("Matrix", "given beside \"Shape\"; allowed: one of the two");
    for (const std::string& name : kStiffnesses)
      if ((shape || matrix) && is_given(list_, name))
        throw error(name, "given beside " + owner + "; allowed: stiffness values, or \"Shape\", or \"Matrix\"");
    for (const std::string& name : kOfShape)
      if (!shape && is_given(list_, name))
        throw error(name, "given beside " + owner + "; allowed: with \"Shape\" only");
  }

  void read_mass(Section& section) const {
    section.mass = *draft_.mass;
    section.rotary_inertia = draft_.rotary_inertia.value_or(section.rotary_inertia);
    section.mass_offset = draft_.mass_offset.value_or(section.mass_offset);
    if (!is_inertia(section.rotary_inertia))
      throw error("Rotary Inertia",
                  "one of the three is larger than the sum of the others, which no body has; allowed: for flat "
                  "sections {J2 + J3, J2, J3}");
    section.inertia_product = draft_.inertia_product.value_or(0.0);
    const double product = section.inertia_product;
    if (product * product > section.rotary_inertia[1] * section.rotary_inertia[2] * (1.0 + kRoundedProduct))
      throw error("Inertia Product", "value " + shortest(product) +
                                         ": its square is larger than the product of the moments about axes 2 and 3, "
                                         "which no body has; allowed: with \"Rotary Inertia\", at most its root");
  }

  StressPoints checked_stress_points(const Section& section) const {
    const InputPlace place = place_["Stress Points"];
    if (list_.isParameter("Shape"))
      throw place.error("given beside \"Shape\"; allowed: beside stiffness values or \"Matrix\"");
    if (draft_.stress_points->points.empty()) throw place["Points"].error("no point; allowed: at least one");
    const bool recovers = list_.sublist("Stress Points").isSublist("Recovery");
    if (recovers != (draft_.stress_points->youngs_modulus == 0.0))
      throw place["E"].error(recovers ? "given beside \"Recovery\"; allowed: one of the two"
                                      : "missing; allowed: a double > 0 (Young's modulus)");
    if (list_.isParameter("Matrix")) return points_of_matrix(section, place);
    if (recovers) throw place["Recovery"].error("given beside stiffness values; allowed: beside \"Matrix\"");
    if (!draft_.stress_points->area && !std::isfinite(stiffness(0)))
      throw place["Area"].error("missing; needed where \"Inextensible\" is true, or EA is inf");
    return *draft_.stress_points;
  }

  /// Rows of stresses: those given, or E (gamma_1 + kappa_2 x3 - kappa_3 x2) of the strains, and the torque's shear.
  StressPoints points_of_matrix(const Section& section, const InputPlace& place) const {
    StressPoints points = *draft_.stress_points;
    if (points.area) throw place["Area"].error("given beside \"Matrix\"; allowed: beside stiffness values");
    const ParameterList& list = list_.sublist("Stress Points");
    if (list.isSublist("Recovery")) {
      if (points.torsion_modulus)
        throw place["Torsion Modulus"].error("given beside \"Recovery\"; allowed: rows of tau_12 and tau_13 there");
      read_recovery(list.sublist("Recovery"), place["Recovery"], points);
      return points;
    }
    const Matrix6 compliance = section_compliance(section);
    for (StressPoints::Place& point : points.points) {
      StressRows& rows = point.stress.emplace();
      for (std::size_t j = 0; j < 6; ++j)
        rows[0][j] = points.youngs_modulus *
                     (compliance[0][j] + point.at[1] * compliance[4][j] - point.at[0] * compliance[5][j]);
      if (points.torsion_modulus) rows[1][3] = 1.0 / *points.torsion_modulus;
    }
    return points;
  }

  static void read_recovery(const ParameterList& list, const InputPlace& place, StressPoints& points) {
    std::vector<std::string> names;
    for (StressPoints::Place& point : points.points) {
      names.push_back(point.name);
      if (!list.isParameter(point.name)) throw place[point.name].error("missing; needed: a row for each of \"Points\"");
      const auto& numbers = list.get<Teuchos::Array<double>>(point.name);
      if (numbers.size() != 6 && numbers.size() != 18)
        throw place[point.name].error(std::to_string(numbers.size()) +
                                      " numbers; allowed: 6 of the normal stress, or 18 with tau_12 and tau_13");
      StressRows& rows = point.stress.emplace();
      for (int i = 0; i < numbers.size(); ++i) rows[i / 6][i % 6] = numbers[i];
    }
    for (const std::string& name : names_of(list))
      if (std::find(names.begin(), names.end(), name) == names.end())
        throw place[name].error("not one of \"Points\"; allowed: " + quoted_list(names) + did_you_mean(name, names));
  }

  double stiffness(std::size_t component) const {
    const std::string& name = kStiffnesses[component];
    const std::optional<double>& given = draft_.stiffness[component];
    const std::string rigid_switch = component == 0 ? "Inextensible" : "Shear Rigid";
    if (draft_.is_rigid(component)) {
      if (!given) return kRigid;
      throw error(name,
                  "value " + shortest(*given) + ", but \"" + rigid_switch + "\" is true; allowed: one of the two");
    }
    if (given) return *given;
    throw error(name, "missing; allowed: a double > 0" +
                          (component < 3 ? ", or inf, or \"" + rigid_switch + "\" = true" : std::string()) +
                          "; or \"Shape\" or \"Matrix\" instead of all stiffness values");
  }

  Section section_from_stiffnesses() const {
    Section section;
    set_diagonal(section, {stiffness(0), stiffness(1), stiffness(2), stiffness(3), stiffness(4), stiffness(5)});
    return section;
  }

  Section section_from_shape() const {
    SectionShape shape = draft_.shape;
    if (shape.kind == SectionShapeKind::box)
      shape.inner_fillet = draft_.inner_radius.value_or(std::max(0.0, shape.fillet - shape.wall));
    if (draft_.shear_correction) std::copy_n(draft_.shear_correction->begin(), 2, shape.shear_correction.begin());
    read_material(shape);
    try {
      Section section = make_section("", shape);
      if (draft_.inextensible) section.axial_stiffness = kRigid;
      if (draft_.shear_rigid) section.shear_stiffness = {kRigid, kRigid};
      return section;
    } catch (const std::invalid_argument& problem) {
      throw error("Shape", "value \"" + list_.get<std::string>("Shape") + "\": " + problem.what());
    }
  }

  void read_material(SectionShape& shape) const {
    const auto missing = [&](const std::string& name, const std::string& allowed) {
      return place_["Material"][name].error("missing; allowed: " + allowed);
    };
    if (!draft_.youngs_modulus) throw missing("E", "a double > 0 (Young's modulus)");
    shape.youngs_modulus = *draft_.youngs_modulus;
    if (!draft_.poisson_ratio && !shape.shear_modulus)
      throw missing("nu", "a double, -1 < value <= 0.5 (Poisson's ratio), or \"G\"");
    shape.poisson_ratio =
        draft_.poisson_ratio ? *draft_.poisson_ratio : 0.5 * shape.youngs_modulus / *shape.shear_modulus - 1.0;
    if (shape.poisson_ratio <= 0.5) return;
    throw missing("nu", "a double, -1 < value <= 0.5; E / (2 G) - 1 is " + shortest(shape.poisson_ratio) +
                            ", which no isotropic material has");
  }

  Section section_from_matrix() const {
    Section section;
    Matrix6& matrix = section.matrix.emplace(whole_matrix());
    std::array<double, 6> diagonal{};
    for (std::size_t i = 0; i < 6; ++i) diagonal[i] = draft_.is_rigid(i) ? kRigid : matrix[i][i];
    set_diagonal(section, diagonal);
    try {
      section_compliance(section);
    } catch (const std::invalid_argument& problem) {
      throw error("Matrix", problem.what());
    }
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < i; ++j) matrix[i][j] = matrix[j][i] = 0.5 * (matrix[i][j] + matrix[j][i]);
    return section;
  }

  Matrix6 whole_matrix() const {
    const std::size_t count = draft_.matrix.size();
    if (count != kMatrixSize && count != kTriangleSize) {
      throw error("Matrix", std::to_string(count) +
                                " entries; allowed: 36, row by row, or the 21 of the upper triangle, row by row, in "
                                "the order EA, GA2, GA3, GIt, EI2, EI3");
    }
    Matrix6 matrix{};
    auto next = draft_.matrix.begin();
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = count == kMatrixSize ? 0 : i; j < 6; ++j) {
        matrix[i][j] = *next++;
        if (count == kTriangleSize) matrix[j][i] = matrix[i][j];
      }
    return matrix;
  }

  const ParameterList& list_;
  const InputPlace place_;
  const SectionDraft draft_;
};

/// Refuses parameters of the shape beside Profile.
void check_profile_alone(const ParameterList& list, const InputPlace& place) {
  std::vector<std::string> others = kStiffnesses;
  others.insert(others.end(), profile_parameters().begin(), profile_parameters().end());
  others.insert(others.end(),
                {"Matrix", "Mass", "Rotary Inertia", "Inertia Product", "Mass Offset", "Stress Points", "Drawn As"});
  for (const std::string& name : others)
    if (is_given(list, name) || list.isSublist(name))
      throw place[name].error("given beside \"Profile\"; allowed: \"Material\", \"Shear Correction\"");
  if (!list.isSublist("Material")) throw place["Material"].error("missing; needed beside \"Profile\"");
}

}  // namespace

ListSpec section_spec() { return kSectionParameters.spec; }

const std::vector<std::string>& profile_parameters() {
  static const std::vector<std::string> names = {"Shape",  "Diameter", "Wall",   "Width",         "Height",
                                                 "Flange", "Web",      "Fillet", "Corner Radius", "Inner Radius"};
  return names;
}

std::vector<Section> read_sections(const ParameterList& sections, const InputPlace& place,
                                   const ProfileFinder& profile) {
  std::vector<Section> read;
  for (const std::string& name : names_of(sections)) {
    const ParameterList& list = sections.sublist(name);
    Section section;
    place[name].attempt([&] {
      if (name == kRigidArm) throw place[name].error("the section of arms that offsets make; allowed: another name");
      if (list.isParameter("Profile")) check_profile_alone(list, place[name]);
      section = list.isParameter("Profile") ? SectionReader(profile(list, place[name]), place[name]).read()
                                            : SectionReader(list, place[name]).read();
    });
    section.name = name;
    read.push_back(std::move(section));
  }
  return read;
}

}  // namespace mixbeam
