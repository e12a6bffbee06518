// How the result depends on the representation of the semicircle, which the paper does not state.
#include "apps/common/studies/variants.hpp"
#include "apps/common/tables/convergence_table.hpp"
#include "apps/common/tables/table_printer.hpp"
#include "apps/fork/fork_study.hpp"
#include "discretization/geometry/reference_curve.hpp"
#include "discretization/geometry/vector_algebra.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <ostream>

namespace mixbeam {

namespace {

const std::string kExact = "exact arc";
const std::string kPolygon = "polygon";

/// Places of each reference element at which displacements are compared, less one: enough to see the error inside
/// elements.
constexpr int kIntervalsPerReferenceElement = 16;

/// Of an observed rate; the coarsest meshes are left out.
constexpr double kRateTolerance = 0.15;

/// A rate means something as long as the error is well above what round-off and Newton's tolerance leave.
constexpr double kSmallestError = 1e-11;

/// What the second-order extrapolation of the two finest polygons may miss the limit by: the rest of fourth order with
/// 12 sides in a quarter of a circle, (pi/24)^4 = 3e-4, times displacements and constants of order 1.
constexpr double kPolygonLimitTolerance = 3e-4;

struct Solution {
  Vector3 p1{};                ///< displacement under both forces
  std::vector<Vector3> field;  ///< see displacement_field
};

/// Over the meshes of the study, for one representation and one order.
struct Errors {
  std::vector<double> fork, p1;       ///< mean over the whole fork; of P1
  std::vector<Vector3> displacement;  ///< of P1
};

constexpr const char* kPrototypeSource =
    "stand-alone prototype of the element with all derivatives by automatic differentiation";

/// The prototype's values by representation, in configurations (1) and (2), for k = 1 with 3 elements per member.
std::array<PrintedDisplacement, 2> prototype_p1_displacement(const std::string& representation) {
  if (representation == "polygon")
    return {{{"-1.083302", "-0.753566", "1.981053"}, {"-0.590690", "-0.728401", "1.463117"}}};
  return {{{"-1.095829", "-0.764450", "1.998650"}, {"-0.603967", "-0.740340", "1.483168"}}};
}

/// Corner `i` of the polygon in place of a member; the ends are points of the scene.
std::string corner_name(const Member& member, int i) {
  if (i == 0) return member.start_point;
  return i == member.elements ? member.end_point : member.name + " corner " + std::to_string(i);
}

void replace_by_chain(const Member& arc, Scene& scene) {
  const ReferenceCurve curve = make_reference_curve(arc, position_of(scene, arc.start_point), {});
  for (int i = 0; i < arc.elements; ++i) {
    if (i > 0) {
      const Vec3<double> corner = curve.position(i * curve.length / arc.elements);
      scene.points.push_back({corner_name(arc, i), {corner[0], corner[1], corner[2]}});
    }
    Member side = arc;
    side.name += " side " + std::to_string(i + 1);
    side.start_point = corner_name(arc, i);
    side.end_point = corner_name(arc, i + 1);
    side.curve = Curve{};
    side.elements = 1;
    scene.members.push_back(side);
  }
}

/// Every circular arc replaced by straight members of one element each, between the vertices that the elements of the
/// arc have. The corners are kinks of the undeformed structure.
Scene with_polygons(const Scene& scene) {
  Scene result = scene;
  result.members.clear();
  for (const Member& member : scene.members) {
    if (member.curve.shape == CurveShape::circular_arc)
      replace_by_chain(member, result);
    else
      result.members.push_back(member);
  }
  return result;
}

/// Displacement at equally spaced places of the whole structure, member after member: `points_per_member` places from
/// start to end of each. `elements_per_member`: of the members before any of them was replaced by a polygon; it divides
/// points_per_member - 1. Complete on rank 0, empty on the others. Collective.
std::vector<Vector3> displacement_field(const Simulation& simulation, int elements_per_member, int points_per_member) {
  const int intervals = (points_per_member - 1) / elements_per_member;
  std::vector<Vector3> sampled;  // both ends of each element: vertices inside a member twice
  for (const MemberSamples& member : simulation.samples(intervals + 1))
    sampled.insert(sampled.end(), member.displacement.begin(), member.displacement.end());
  std::vector<Vector3> field;
  const int elements = static_cast<int>(sampled.size()) / (intervals + 1);
  for (int element = 0; element < elements; ++element) {
    const int first = element % elements_per_member == 0 ? 0 : 1;  // a vertex inside a member once
    for (int i = first; i <= intervals; ++i) field.push_back(sampled[element * (intervals + 1) + i]);
  }
  return field;
}

/// Root of the mean square of the difference over all members, which have about the same length. The same on all ranks.
double mean_difference(const std::vector<Vector3>& a, const std::vector<Vector3>& b, int points_per_member,
                       const Communicator& communicator) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    const auto place = static_cast<int>(i) % points_per_member;
    const double weight = place == 0 || place == points_per_member - 1 ? 0.5 : 1.0;  // trapezoidal rule
    sum += weight * std::pow(vector_algebra::distance(a[i], b[i]), 2);
    weights += weight;
  }
  double mean = std::sqrt(sum / weights);
  Teuchos::broadcast(*communicator, 0, &mean);
  return mean;
}

int points_per_member(Application& app) {
  return app.study().get<int>("Reference Elements per Member") * kIntervalsPerReferenceElement + 1;
}

Solution solve(Application& app, int order, int elements, const std::string& representation) {
  const Scene scene = with_mesh(app.scene, order, elements);
  const Simulation simulation = app.solve(representation == kPolygon ? with_polygons(scene) : scene);
  return {simulation.displacement("P1"), displacement_field(simulation, elements, points_per_member(app))};
}

/// All meshes must have places in common with the reference.
void check_meshes(Application& app) {
  const int reference = app.study().get<int>("Reference Elements per Member");
  for (const int elements : study_list<int>(app, "Convergence Elements per Member")) {
    if (reference * kIntervalsPerReferenceElement % elements == 0) continue;
    throw app.xml.source.error({"Study", "Convergence Elements per Member"},
                               "value " + std::to_string(elements) + "; allowed: divisors of " +
                                   std::to_string(reference * kIntervalsPerReferenceElement) +
                                   " (16 times \"Reference Elements per Member\"), so that meshes share points");
  }
}

Errors errors_of(Application& app, const std::string& representation, int order, const Solution& reference) {
  Errors errors;
  for (const int elements : study_list<int>(app, "Convergence Elements per Member")) {
    const Solution solution = solve(app, order, elements, representation);
    errors.fork.push_back(mean_difference(solution.field, reference.field, points_per_member(app), app.communicator));
    errors.p1.push_back(vector_algebra::distance(solution.p1, reference.p1));
    errors.displacement.push_back(solution.p1);
  }
  return errors;
}

std::vector<int> total_elements(Application& app) {
  std::vector<int> totals = study_list<int>(app, "Convergence Elements per Member");
  for (int& elements : totals) elements *= static_cast<int>(app.scene.members.size());
  return totals;
}

/// The exact semicircle converges in the mean with the order of the element; its vertices do better, with 2k. For
/// polygons the corners, not the elements, set the rate.
void check_rate(Application& app, const std::string& representation, int order, const std::optional<double>& rate) {
  if (!rate) return;  // nothing but round-off, or a single mesh
  const bool exact = representation == kExact;
  app.summary.check_absolute("k=" + std::to_string(order) + ": convergence rate with " + representation, *rate,
                             exact ? order + 1 : 2, kRateTolerance,
                             exact ? "approximation order of degree k" : "distance of a polygon from its circle");
}

/// The two finest polygons, extrapolated with the rate that is due to the corners, must meet the limit of the arc.
void check_polygon_limit(Application& app, int order, const Errors& errors, const Vector3& limit) {
  const std::vector<int> elements = total_elements(app);
  const std::size_t finest = elements.size() - 1;
  if (finest == 0) return;
  const double share = std::pow(static_cast<double>(elements[finest - 1]) / elements[finest], 2);
  Vector3 extrapolated{};
  for (std::size_t i = 0; i < 3; ++i)
    extrapolated[i] = (errors.displacement[finest][i] - share * errors.displacement[finest - 1][i]) / (1.0 - share);
  app.summary.check_upper_bound(
      "k=" + std::to_string(order) + ": distance of the limits of polygon and exact arc at P1",
      vector_algebra::distance(extrapolated, limit), kPolygonLimitTolerance, "both represent the same structure");
}

/// k = 1 with 3 elements per member is what the prototype computed for both representations.
void compare_with_prototype(Application& app) {
  TablePrinter table("Fork: displacement of P1, k = 1, 9 elements, beside an independent prototype of the element",
                     {"representation"}, {"u1 / L", "u2 / L", "u3 / L"}, "prototype");
  for (const std::string& representation : {kExact, kPolygon}) {
    const Scene scene = with_mesh(app.scene, 1, 3);
    const ForkSolution solution = solve_fork(app, representation == kPolygon ? with_polygons(scene) : scene);
    const auto prototype = prototype_p1_displacement(representation);
    for (std::size_t c = 0; c < 2; ++c) {
      const std::string configuration = "(" + std::to_string(c + 1) + ")";
      std::vector<ComparedValue> cells;
      for (std::size_t i = 0; i < 3; ++i) {
        app.summary.check_printed_digits(
            "k=1, 9 elements: u" + std::to_string(i + 1) + configuration + " with " + representation, solution.p1[c][i],
            prototype[c][i], kPrototypeSource);
        cells.push_back(compare_printed(prototype[c][i], solution.p1[c][i]));
      }
      table.add_row({representation + " " + configuration}, cells);
    }
  }
  table.print(app.out());
  app.out() << "\n";
}

/// The limit must be the paper's, whatever the meshes.
void check_limit(Application& app, const Vector3& limit) {
  const auto paper = paper_p1_displacement(4, 10)[1];
  for (std::size_t i = 0; i < 3; ++i)
    app.summary.check_printed_digits("limit of the exact arc: u" + std::to_string(i + 1) + "(2)", limit[i], paper[i],
                                     std::string(kForkTableSource) + ", k=4, 30 elements");
}

void write_errors(Application& app, StudyTable& csv, const std::string& representation, int order,
                  const Errors& errors) {
  const std::vector<int> elements = total_elements(app);
  for (std::size_t i = 0; i < elements.size(); ++i)
    csv.add_row({representation, order, elements[i], errors.fork[i], errors.p1[i]});
}

}  // namespace

void compare_representations(Application& app) {
  check_meshes(app);
  compare_with_prototype(app);
  const int order = app.study().get<int>("Reference Order"),
            elements = app.study().get<int>("Reference Elements per Member");
  const Solution reference = solve(app, order, elements, kExact);
  check_limit(app, reference.p1);
  StudyTable csv(app, "convergence.csv", {"representation", "order", "elements", "error", "p1_error"});
  ConvergenceTable of_fork("Fork: error of the displacement, mean over the fork, both forces, relative to L",
                           total_elements(app), kSmallestError);
  ConvergenceTable of_p1("Fork: error of the displacement of P1, both forces, relative to L", total_elements(app),
                         kSmallestError);
  for (const std::string& representation : {kExact, kPolygon}) {
    of_fork.add_group("semicircle: " + representation);
    of_p1.add_group("semicircle: " + representation);
    for (const int k : study_list<int>(app, "Convergence Orders")) {
      const Errors errors = errors_of(app, representation, k, reference);
      check_rate(app, representation, k, of_fork.add_row(k, errors.fork));
      of_p1.add_row(k, errors.p1);
      if (representation == kPolygon) check_polygon_limit(app, k, errors, reference.p1);
      write_errors(app, csv, representation, k, errors);
    }
  }
  of_fork.print(app.out());
  app.out() << "The reference has the exact arc, k = " << order << " and " << elements
            << " elements in each member. With the exact arc the\n"
            << "rate is k+1. The polygon has the same limit, but with rate 2 at every order: its corners, not its\n"
            << "elements, determine the remaining error.\n\n";
  of_p1.print(app.out());
  app.out() << "At vertices the exact arc converges with rate 2k.\n\n";
}

}  // namespace mixbeam
