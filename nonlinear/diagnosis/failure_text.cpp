// The failure report as a page in plain words.
#include "discretization/scene/what_acts.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"
#include "nonlinear/diagnosis/failure_report.hpp"
#include "nonlinear/diagnosis/limp_members.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

namespace mixbeam {

namespace {

/// Number of attempts shown: the first ones add nothing to the last.
constexpr std::size_t kAttemptsShown = 5;
/// Share of the path, after all permitted steps, below which more steps would not help.
constexpr double kShareOfACrawl = 1e-2;
/// Share of a stage below which the path ended at the start of the stage.
constexpr double kStartOfStage = 1e-3;

std::string number(double value) { return rounded(value, 4); }

/// `point "tip" moves along (0, 1, 0)`.
std::string motion_text(const MovingVertex& vertex) {
  std::string text = text_of(vertex.place) + (vertex.turns ? " turns about (" : " moves along (");
  for (int i = 0; i < 3; ++i) text += (i == 0 ? "" : ", ") + number(std::round(vertex.direction[i] * 1e3) / 1e3 + 0.0);
  return text + ")";
}

void write_attempts(std::ostream& out, const FailureReport& report) {
  if (report.attempts.empty()) {
    out << "No step failed: all permitted steps were used.\n";
    return;
  }
  const std::size_t shown = std::min(kAttemptsShown, report.attempts.size());
  out << "Failed attempts since then: " << report.failures
      << (static_cast<std::size_t>(report.failures) > shown ? ", of which the last are" : "") << "\n";
  for (std::size_t i = report.attempts.size() - shown; i < report.attempts.size(); ++i) {
    const FailedAttempt& attempt = report.attempts[i];
    out << "  at ";
    if (std::isfinite(attempt.load_factor))
      out << "load factor " << attempt.load_factor;
    else
      out << "an unknown load factor";
    out << ": " << cause_text(attempt) << "\n";
  }
  if (report.step_at_minimum) out << "  The step was reduced to its minimum of " << report.minimum_step << ".\n";
  if (report.steps_used_up) out << "  Then all permitted steps were used.\n";
  if (!report.attempts.back().linear_solver.empty())
    out << "Last linear solve: " << report.attempts.back().linear_solver << ".\n";
}

void write_peak(std::ostream& out, const FailureReport& report) {
  if (report.attempts.empty() || !report.attempts.back().peak) return;
  const ResidualPeak& peak = *report.attempts.back().peak;
  out << "Largest scaled residual of the last attempt: " << equation_text(peak.place) << ", " << text_of(peak.place);
  if (peak.place.element < 0 && !peak.place.point.empty())
    out << " (member \"" << excerpt(peak.place.member) << "\" at " << peak.place.along << " of its length)";
  out << ", by " << peak.value << " in the units of the scene, " << peak.scaled << " after scaling.\n";
}

void write_angles(std::ostream& out, const FailureReport& report) {
  for (const WideAngle& wide : report.wide_angles)
    out << "Rotation between an element and its vertices (must stay below pi): " << wide.angle << " rad in element "
        << wide.element << " of member \"" << excerpt(wide.member) << "\", "
        << (wide.converged ? "in the last equilibrium" : "in a failed attempt") << "; the member has " << wide.elements
        << (wide.elements == 1 ? " element, " : " elements, ") << wide.suggested_elements << " would suffice.\n";
}

void write_springs(std::ostream& out, const FailureReport& report) {
  for (const auto& [point, angle] : report.spent_springs)
    out << "Rotational springs of the support at point \"" << excerpt(point)
        << "\" act on its rotation vector, which ends "
        << "at a turn (2 pi): it has turned by " << angle << " rad in the last equilibrium. A support that fixes the "
        << "rotations about two axes, or a hinge, counts any number of turns about the third.\n";
}

void write_mode(std::ostream& out, const CriticalMode& mode) {
  out << "  Eigenvalue " << mode.eigenvalue << " (" << mode.relative << " of the lowest of the undeformed structure):";
  for (const MovingVertex& vertex : mode.vertices)
    out << (&vertex == &mode.vertices.front() ? " " : "; ") << motion_text(vertex);
  out << ".\n";
}

void write_tangent(std::ostream& out, const FailureReport& report) {
  if (!report.lost_at.empty())
    out << "The structure is stable up to a " << report.lost_at
        << ": there it buckles or snaps through, and what was followed beyond is unstable.\n";
  const TangentReport& tangent = report.tangent;
  if (!tangent.known) {
    out << "Tangent at the last equilibrium: unknown (" << tangent.unknown_because << ").\n";
    return;
  }
  out << "Tangent at the last equilibrium: ";
  if (tangent.null > 0)
    out << "singular";
  else
    out << (tangent.nearly_singular ? "nearly singular" : "regular");
  out << ", " << tangent.negative << " negative " << (tangent.negative == 1 ? "eigenvalue" : "eigenvalues")
      << (tangent.negative > 0 ? ": the equilibrium is unstable" : "");
  if (tangent.condition) out << "; condition number about " << *tangent.condition;
  out << ".\n";
  for (const CriticalMode& mode : tangent.modes)
    if (tangent.nearly_singular || tangent.mechanism || mode.eigenvalue < 0.0) write_mode(out, mode);
}

/// Writes the advice, with the numbers of this run.
class Adviser {
 public:
  Adviser(const FailureReport& report, const BeamProblem& problem, const SolverParameters& parameters)
      : report_(report), problem_(problem), parameters_(parameters) {}

  std::vector<Advice> advice;

  void correct_load() {
    const FailedAttempt& last = report_.attempts.back();
    add(AdviceKind::correct_load, "Correct the amplitude or formula of " + last.not_finite->what +
                                      ": it has no finite value at load factor " + number(last.load_factor) + ".");
  }
  void check_units() {
    const Scene& scene = problem_.model.scene();
    double force = 0.0;
    for (const PointLoad& load : scene.point_loads)
      force = std::max(force, vector_algebra::largest_component(load.force));
    const Structure& structure = problem_.model.structure();
    const double bending = structure.bending_reference / (structure.length * structure.length);
    std::string text = "Check units and sizes of loads and prescribed motions";
    if (force > 0.0 && bending > 0.0)
      text += ": the largest point load is " + number(force / bending) + " times EI/L^2 of the structure";
    add(AdviceKind::check_units, text + ".");
  }
  void add_support() {
    add(AdviceKind::add_support,
        "Support the structure: it is a mechanism" + of_mode() + ". Add a support or spring there, or close a joint.");
  }
  void hold_neutral_motion() {
    if (report_.tangent.null == 0) return;
    add(AdviceKind::add_support,
        "If no load ever resists that motion" + of_mode() +
            " (a ring of a straight round rod rolls about its tangent): hold it by a support, which takes no force.");
  }
  void prescribe_displacement() {
    const bool is_automatic = parameters_.load_path.method == LoadPathMethod::automatic;
    add(AdviceKind::prescribe_displacement,
        "If the load has reached its largest value: prescribe the displacement of the loaded point in place of the "
        "force (\"Prescribed Displacement\" of a support there), which is possible beyond the limit point" +
            of_mode() +
            (is_automatic ? "." : "; \"Method\" = \"automatic\" in \"Load Path\" follows the path beyond it."));
  }
  void add_imperfection() {
    add(AdviceKind::add_imperfection,
        "If the structure buckles to a side: add a small load (a thousandth of the present one) that pushes it there" +
            of_mode() + ".");
  }
  void stay_below() {
    add(AdviceKind::stay_below, "Results up to load factor " + number(report_.last_load_factor) +
                                    " are valid: if that is the limit load of the structure, nothing is wrong.");
  }
  void more_elements() {
    std::string text = "Use more elements";
    for (const WideAngle& wide : report_.wide_angles)
      text += (&wide == &report_.wide_angles.front() ? ": " : ", ") + std::string("\"Elements\" ") +
              std::to_string(wide.suggested_elements) + " in member \"" + excerpt(wide.member) + "\" (now " +
              std::to_string(wide.elements) + ")";
    if (report_.wide_angles.empty() && !report_.attempts.empty() && report_.attempts.back().peak) {
      const EquationPlace& place = report_.attempts.back().peak->place;
      const int now = problem_.model.mesh().elements_of(member_index(problem_.model.scene(), place.member));
      text += ": \"Elements\" " + std::to_string(2 * now) + " in member \"" + excerpt(place.member) + "\" (now " +
              std::to_string(now) + ")";
    }
    add(AdviceKind::more_elements, text + ".");
  }
  void more_iterations() {
    const int now = parameters_.newton.maximum_iterations;
    add(AdviceKind::more_iterations, "A larger \"Maximum Iterations\" in \"Newton\": " + std::to_string(2 * now) +
                                         " (now " + std::to_string(now) + ").");
  }
  void smaller_rotation() {
    const double now = parameters_.newton.maximum_rotation;
    add_smaller(AdviceKind::smaller_rotation, "\"Maximum Rotation\" in \"Newton\"", 0.5 * now, now);
  }
  void smaller_first_step() {
    const double now = parameters_.load_path.initial_step;
    add_smaller(AdviceKind::smaller_first_step, "\"Initial Step\" in \"Load Path\"", 0.1 * now, now);
  }
  void smaller_minimum_step() {
    const double now = report_.minimum_step;
    add_smaller(AdviceKind::smaller_minimum_step, "\"Minimum Step\" in \"Load Path\"", 0.01 * now, now);
  }
  /// Whether the permitted steps made almost no progress, so that more of them would not help.
  bool crawls() const { return !has_lost_stability() && report_.last_load_factor < kShareOfACrawl * report_.stages; }
  void more_steps() {
    const int now = parameters_.load_path.maximum_steps;
    const double done = report_.last_load_factor / report_.stages;
    const double needed = crawls() ? 10.0 * now : now / std::max(done, kShareOfACrawl);
    const double at_least = std::min(1e9, std::max(2.0 * now, std::ceil(needed)));
    add(AdviceKind::more_steps,
        "A larger \"Maximum Steps\" in \"Load Path\": " + std::to_string(static_cast<int>(at_least)) + " (now " +
            std::to_string(now) + "), or larger steps.");
  }
  void check_sections() {
    add(AdviceKind::check_sections,
        "Check the stiffnesses of the sections: between bending, shear and axial stiffness there may be too many "
        "orders "
        "of magnitude for double precision; \"Inextensible\" and \"Shear Rigid\" serve better than huge numbers.");
  }
  /// Whether the path ended at the start of a stage, with imposed motions or eigenstrains in the scene and members that
  /// only tension stiffens.
  bool is_limp_at_start() const {
    const double into_stage = report_.last_load_factor - std::floor(report_.last_load_factor);
    const Model& model = problem_.model;
    return into_stage < kStartOfStage && imposes_deformation(model.scene()) &&
           has_limp_members(model, model.reference_state(), report_.stages);
  }
  void separate_stages() {
    if (!is_limp_at_start()) return;
    add(AdviceKind::separate_stages,
        "Members that are nearly limp have no stiffness at the start: let what makes them tight (prescribed motions, "
        "eigenstrains) act in one \"Stage\" and the other loads in the next one, or where they stay slack the other "
        "way round.");
  }
  /// Advises jumps if the path was lost at or beyond critical points, and the scene permits jumps.
  void jump() {
    if (!has_lost_stability() || !may_jump()) return;
    add(AdviceKind::jump, "The path was lost near load factor " + number(report_.last_load_factor) +
                              ", at or beyond critical points: \"Snap\" = \"jump\" in \"Analysis\"" +
                              (parameters_.analysis.trace ? ", without \"Trace\"," : "") +
                              " goes from one stable state to the next and ends in a stable one where one exists.");
  }
  void finite_stiffness() {
    const EquationPlace& place = report_.attempts.back().peak->place;
    add(AdviceKind::finite_stiffness,
        "Give member \"" + excerpt(place.member) + "\" " + (place.component == 0 ? "an axial" : "a shear") +
            " stiffness (" + (place.component == 0 ? "\"EA\"" : "\"GA2\", \"GA3\"") + "), " +
            (report_.cause == FailureCause::taut
                 ? "or let one of its ends move along it: \"Fixed Displacement\" of its support."
                 : "or remove eigenstrains and prescribed motions that are compatible only if it changes its length or "
                   "shears. Where it is straight and has to buckle, \"Branch\" in \"Analysis\" chooses the side."));
  }

 private:
  /// Whether the path has lost stability. It starts at a stable state: if it ends at an unstable one it has passed
  /// critical points. Or it is stuck at one, where further equilibria are rejected as another path.
  bool has_lost_stability() const {
    const TangentReport& tangent = report_.tangent;
    const bool sticks = !report_.attempts.empty() && report_.attempts.back().end == AttemptEnd::refused;
    return tangent.known && (tangent.negative > 0 || (tangent.nearly_singular && sticks));
  }

  /// Whether `Snap` = `jump` is permitted: it needs a potential and load steps (check_jumps of a scene).
  bool may_jump() const {
    const AnalysisParameters& analysis = parameters_.analysis;
    const Scene& scene = problem_.model.scene();
    const auto is_dead_force = [](const PointLoad& load) {
      return load.frame == LoadFrame::dead && load.moment == Vector3{};
    };
    const auto is_dead_line_load = [](const DistributedLoad& load) {
      return load.frame == LoadFrame::dead && load.couple == Vector3{} &&
             load.couple_formula == std::array<std::string, 3>{};
    };
    return analysis.snap != Snap::jump && !analysis.control && analysis.stability.value_or(true) && !scene.accuracy &&
           parameters_.loca.is_null() &&
           std::all_of(scene.point_loads.begin(), scene.point_loads.end(), is_dead_force) &&
           std::all_of(scene.distributed_loads.begin(), scene.distributed_loads.end(), is_dead_line_load);
  }

  void add(AdviceKind kind, const std::string& text) { advice.push_back({kind, text}); }
  void add_smaller(AdviceKind kind, const std::string& parameter, double value, double now) {
    add(kind, "A smaller " + parameter + ": " + number(value) + " (now " + number(now) + ").");
  }

  /// ", where point "tip" moves along (0, 1, 0)", of the mode nearest to zero.
  std::string of_mode() const {
    if (report_.tangent.modes.empty() || report_.tangent.modes.front().vertices.empty()) return "";
    return ", where " + motion_text(report_.tangent.modes.front().vertices.front());
  }

  const FailureReport& report_;
  const BeamProblem& problem_;
  const SolverParameters& parameters_;
};

/// Description of a cause, and advice, the most promising first.
struct Remedy {
  const char* words;
  std::vector<void (Adviser::*)()> advice;
};
using A = Adviser;
const std::map<FailureCause, Remedy> kRemedies = {
    {FailureCause::load_not_finite, {"a load or prescribed motion is not finite there", {&A::correct_load}}},
    {FailureCause::steps_used_up, {"more steps are needed than are permitted", {&A::jump, &A::more_steps}}},
    {FailureCause::mechanism, {"the structure is a mechanism: it can move without strain", {&A::add_support}}},
    {FailureCause::end_angle,
     {"elements are too long for the rotations in them", {&A::more_elements, &A::smaller_minimum_step}}},
    {FailureCause::critical_point,
     {"a critical point: the load cannot grow from here (limit point), or the structure buckles (bifurcation)",
      {&A::hold_neutral_motion, &A::prescribe_displacement, &A::jump, &A::add_imperfection, &A::smaller_minimum_step,
       &A::stay_below}}},
    {FailureCause::overflow,
     {"numbers beyond the range of double precision", {&A::check_units, &A::smaller_first_step, &A::check_sections}}},
    {FailureCause::linear_solver,
     {"the linear equations are too ill-conditioned to be solved",
      {&A::check_sections, &A::check_units, &A::smaller_first_step}}},
    {FailureCause::path_lost,
     {"the path continues from here, but not to the end of the stage",
      {&A::jump, &A::prescribe_displacement, &A::smaller_minimum_step, &A::smaller_first_step, &A::stay_below}}},
    {FailureCause::incompatible,
     {"imposed strains or motions are incompatible with members that are inextensible or shear rigid, or nearly so",
      {&A::finite_stiffness, &A::smaller_minimum_step, &A::more_elements, &A::stay_below}}},
    {FailureCause::taut,
     {"a straight member that cannot stretch is held at both ends: no finite axial force carries a load across it",
      {&A::finite_stiffness}}},
    {FailureCause::slow,
     {"Newton's method was converging, but had too few iterations",
      {&A::jump, &A::more_iterations, &A::smaller_minimum_step, &A::smaller_rotation, &A::more_elements}}},
    {FailureCause::wandering,
     {"Newton's method did not converge from the last equilibrium to the next",
      {&A::jump, &A::smaller_minimum_step, &A::more_elements, &A::smaller_rotation, &A::more_iterations,
       &A::smaller_first_step}}}};

}  // namespace

std::vector<Advice> advice_for(const FailureReport& report, const BeamProblem& problem,
                               const SolverParameters& parameters) {
  Adviser to(report, problem, parameters);
  if (report.cause == FailureCause::steps_used_up && to.crawls()) {
    to.check_units();
    to.check_sections();
  }
  if (report.cause != FailureCause::overflow) to.separate_stages();
  for (const auto advice : kRemedies.at(report.cause).advice) (to.*advice)();
  return to.advice;
}

std::string text_of(const FailureReport& report) {
  std::ostringstream out;
  out << "no equilibrium was found beyond load factor " << report.last_load_factor << " of " << report.stages
      << " (step " << report.last_step << ").\n";
  write_attempts(out, report);
  write_peak(out, report);
  write_angles(out, report);
  write_springs(out, report);
  write_tangent(out, report);
  out << "Most likely: " << kRemedies.at(report.cause).words << ".\n";
  out << "What to try, in this order:\n";
  for (std::size_t i = 0; i < report.next.size(); ++i) out << "  " << i + 1 << ". " << report.next[i].text << "\n";
  return out.str();
}

}  // namespace mixbeam
