#include "discretization/checks/scene_warnings.hpp"
#include "discretization/checks/survey.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "discretization/scene/division.hpp"
#include "discretization/scene/formula_pieces.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

std::string warned_place(const std::string& list, const std::string& name) {
  return list + " / " + excerpt(name) + ": ";
}

namespace {

using namespace vector_algebra;

constexpr double kMostLoad = 1e6;  // F L^2 / EI; a strut buckles at 2.5 to 40, a coil of ten turns needs 4e3
// Steel breaks at 1 %, wood and glass below; the law of the section, linear in its strains, says little beyond.
constexpr double kMostStrain = 0.1;
// And F l^2 / EI far above all that buckles a member: thick members may strain so much and mean it.
constexpr double kLoadOfStrain = 100.0;
// F l^2 / EI where no deflection could be measured: a millionth of a millimetre on a metre.
constexpr double kLeastLoad = 1e-6;
// Gravity of the earth in m/s^2 beside an E that no solid has in kN/m^2 (diamond 1e9): the scene is in m, N and kg.
constexpr double kLeastOfEarth = 9.5, kMostOfEarth = 10.1, kLeastModulusInPascal = 2e9;
// E over density, square of the speed of sound [m^2/s^2]: metals and wood 3e7, carbon fibres 2e8, diamond 3e8.
constexpr double kMostSpecificStiffness = 1e9;
// Share of a formula that the points of a mesh miss: a jump inside an element may do so and hardly matter.
constexpr double kMissedOfFormula = 0.01;

struct ActingForce {
  std::string at;
  double force, moment;
};

/// Forces known without a computation: loads without formulas.
struct ForceSurvey {
  std::vector<ActingForce> forces{};
  bool has_formulas = false;
};

template <class Load>
bool has_formula(const Load& load) {
  return !load.amplitude.empty();
}
bool has_formula(const DistributedLoad& load) {
  const auto given = [](const std::string& text) { return !text.empty(); };
  return given(load.amplitude) || std::any_of(load.force_formula.begin(), load.force_formula.end(), given) ||
         std::any_of(load.couple_formula.begin(), load.couple_formula.end(), given);
}

ForceSurvey forces_of(const SceneSurvey& survey) {
  ForceSurvey found;
  for (const PointLoad& load : survey.scene.point_loads) {
    if (has_formula(load)) found.has_formulas = true;
    found.forces.push_back({warned_place("Point Loads", "at " + load.point), norm(load.force), norm(load.moment)});
  }
  for (const DistributedLoad& load : survey.scene.distributed_loads) {
    const auto member = static_cast<std::size_t>(survey.names.member(load.member) - survey.scene.members.data());
    const double length = survey.curves[member].length;
    if (has_formula(load)) found.has_formulas = true;
    found.forces.push_back({warned_place("Distributed Loads", "on " + load.member), norm(load.force) * length,
                            norm(load.couple) * length});
  }
  return found;
}

/// The stiffest and the softest of all members; infinite ones do not count, and leave zero or infinity where all are.
struct StiffnessRange {
  double most_bending = 0.0, most_axial = 0.0;
  double least_bending = std::numeric_limits<double>::infinity();
  double longest = 0.0;  ///< member
};

StiffnessRange stiffness_range(const SceneSurvey& survey) {
  StiffnessRange found;
  for (std::size_t i = 0; i < survey.scene.members.size(); ++i) {
    const Section& section = survey.section_of(survey.scene.members[i]);
    for (const double bending : section.bending_stiffness) {
      if (std::isfinite(bending)) found.most_bending = std::max(found.most_bending, bending);
      found.least_bending = std::min(found.least_bending, bending);
    }
    found.most_axial = std::max(found.most_axial, section.axial_stiffness);
    found.longest = std::max(found.longest, survey.curves[i].length);
  }
  return found;
}

/// Strain of fibres at twice the radius of gyration r (a round rod) of a member of length l that a force bends: as a
/// lever, 2 F l r / EI, but no more than of the elastica, whose curvature stays below sqrt(2 F / EI). Zero where the
/// force is not far above what the member bears.
double strain_by(double force, const StiffnessRange& stiffness) {
  const double bending = stiffness.most_bending, axial = stiffness.most_axial, length = stiffness.longest;
  if (bending == 0.0 || !std::isfinite(axial) || force * length * length < kLoadOfStrain * bending) return 0.0;
  const double radius = std::sqrt(bending / axial);
  const double curvature = std::min(force * length / bending, std::sqrt(2.0 * force / bending));
  return std::max(force / axial, 2.0 * radius * curvature);
}

void warn_of_large(const ForceSurvey& found, const StiffnessRange& stiffness, double size, WarningList& list) {
  for (const ActingForce& acting : found.forces) {
    const double load = std::max(acting.force * size * size, acting.moment * size) / stiffness.most_bending;
    if (stiffness.most_bending > 0.0 && load > kMostLoad) {
      list.add("loads of unusual size", acting.at + "the load times size of the structure squared over EI is " +
                                            rounded(load, 3) +
                                            "; a strut buckles at about 10; usually units of the load or of EI");
      continue;
    }
    const double strain = found.has_formulas ? 0.0 : strain_by(acting.force, stiffness);
    if (strain > kMostStrain)
      list.add("loads that cause large strains",
               acting.at + "the force strains the stiffest members by about " + rounded(100.0 * strain, 3) +
                   " %; steel yields at 0.2 %; usually units of the load, of E or of the section");
  }
}

void warn_of_small(const ForceSurvey& found, const StiffnessRange& stiffness, WarningList& list) {
  if (found.has_formulas || found.forces.empty() || !std::isfinite(stiffness.least_bending)) return;
  const double length = stiffness.longest;
  double largest = 0.0;
  for (const ActingForce& acting : found.forces)
    largest = std::max(largest, std::max(acting.force * length * length, acting.moment * length));
  const double load = largest / stiffness.least_bending;
  if (load > 0.0 && load < kLeastLoad)
    list.add("scenes", "Point Loads, Distributed Loads: the largest load times length of a member squared over EI is " +
                           rounded(load, 3) +
                           ", so that nothing moves visibly; usually units of the load, of E or of the section");
}

/// Members of which no mass is known are passed over.
void warn_of_weightless(const std::string& what, const SceneSurvey& survey, WarningList& list) {
  std::vector<std::string> names;
  for (const Member& member : survey.scene.members) {
    if (member.section == kRigidArm) continue;
    const bool has_taper = !member.end_section.empty();
    if (survey.section_of(member).mass == 0.0 || (has_taper && survey.sections.at(member.end_section)->mass == 0.0))
      names.push_back(member.name);
  }
  if (names.empty()) return;
  list.add("scenes", what + " of " + std::to_string(names.size()) + " of " +
                         std::to_string(survey.scene.members.size()) + " members: " + quoted_list(names) +
                         "; usually \"Density\" in \"Material\", or \"Mass\", of their sections is missing");
}

/// Warns of densities in g/cm^3, if all sections have them: one alone may stand for something rigid.
void warn_of_light(const SceneSurvey& survey, WarningList& list) {
  if (survey.scene.gravity < kLeastOfEarth || survey.scene.gravity > kMostOfEarth) return;
  const Section* lightest = nullptr;
  for (const Member& member : survey.scene.members) {
    const Section& section = survey.section_of(member);
    if (!section.shape || section.mass == 0.0 || section.shape->youngs_modulus < kLeastModulusInPascal) continue;
    if (section.shape->youngs_modulus < kMostSpecificStiffness * section.shape->density) return;
    if (lightest == nullptr || section.shape->density < lightest->shape->density) lightest = &section;
  }
  if (lightest == nullptr) return;
  list.add("scenes", warned_place("Sections", lightest->name) + "Density " + rounded(lightest->shape->density, 3) +
                         " beside E = " + rounded(lightest->shape->youngs_modulus, 3) + " and a gravity of " +
                         rounded(survey.scene.gravity, 3) +
                         ": no solid is so light; usually g/cm3, where m, N and kg ask for kg/m3");
}

/// A formula whose values at the points of the elements are not what it is between them.
void warn_of_narrow(const Member& member, const FormulaAlong& formula, WarningList& list) {
  const GaussPoints& rule = gauss_points(member.order + 1);
  const std::vector<double> station = divide(member).station;
  const bool is_load = formula.list != "Taper" && formula.list != "Curve";
  MissedIntegral sum, most;
  std::array<double, 2> where{};
  std::vector<double> value;
  for (std::size_t e = 1; e < station.size(); ++e) {
    const double first = station[e - 1], last = station[e], middle = 0.5 * (first + last);
    if (middle < formula.range[0] || middle > formula.range[1]) continue;
    value.clear();
    for (const double xi : rule.xi) value.push_back(formula.function(middle + 0.5 * (last - first) * xi));
    MissedIntegral here =
        integrate_at_points(*formula.pieces, formula.function, first, last, rule.xi, rule.weight, value);
    if (here.total == 0.0)  // smooth
      for (std::size_t q = 0; q < value.size(); ++q)
        here.total += 0.5 * (last - first) * rule.weight[q] * std::abs(value[q]);
    sum.missed += here.missed;
    sum.total += here.total;
    if (here.missed <= most.missed) continue;
    most = here;
    where = {first, last};
  }
  if (!(sum.missed > kMissedOfFormula * sum.total)) return;
  list.add("narrow formulas",
           warned_place(is_load ? formula.list : "Members", (is_load ? "on " : "") + member.name) + "\"" +
               excerpt(formula.text) + "\" changes between the points of the " + std::to_string(station.size() - 1) +
               " elements of order " + std::to_string(member.order) + ": the sum over them misses " +
               rounded(100.0 * sum.missed / sum.total, 3) +
               (formula.list == "Curve" ? " % of its squared curvature" : " % of it") +
               ", most of it from x = " + rounded(where[0], 4) + " to " + rounded(where[1], 4) + "; " +
               (formula.list == "Curve"
                    ? ""
                    : "the integral over each element is used in its place, but not how it varies inside; ") +
               "\"Stations\" there, or \"Accuracy\" without \"Elements\", resolve it");
}

void warn_of_narrow_formulas(const SceneSurvey& survey, WarningList& list) {
  const Scene& scene = survey.scene;
  for (const FormulaAlong& formula : formulas_along(
           scene, [&](const Member& member) { return !scene.accuracy || member.keeps_elements; },
           [&](std::size_t m) -> const ReferenceCurve& { return survey.curves[m]; }, false))
    warn_of_narrow(scene.members[formula.member], formula, list);
}

}  // namespace

void add_load_warnings(const SceneSurvey& survey, WarningList& list) {
  const Scene& scene = survey.scene;
  const ForceSurvey found = forces_of(survey);
  const StiffnessRange stiffness = stiffness_range(survey);
  warn_of_large(found, stiffness, survey.size, list);
  warn_of_narrow_formulas(survey, list);
  const bool is_moved = imposes_deformation(scene);
  if (!anything_acts(scene))
    list.add("scenes", kNothingActs);
  if (!is_moved) warn_of_small(found, stiffness, list);
  if (!scene.rotating_frames.empty()) warn_of_weightless("Rotating Frame: no centrifugal force", survey, list);
  if (scene.gravity == 0.0) return;
  warn_of_weightless("Gravity: no weight", survey, list);
  warn_of_light(survey, list);
}

}  // namespace mixbeam
