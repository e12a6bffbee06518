// What to try when no equilibrium was found: one list for each cause, the most promising first.
#include "discretization/text/message_text.hpp"
#include "nonlinear/diagnosis/failure_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace mixbeam {

namespace {

/// Of the path, after all steps that are permitted.
constexpr double kShareOfACrawl = 1e-2;

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

std::string direction_text(const Vector3& v) {
  std::string text;
  for (double x : v) text += (text.empty() ? "(" : ", ") + number(std::round(x * 1e3) / 1e3 + 0.0);
  return text + ")";
}

double largest_component(const Vector3& v) { return std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])}); }

/// The sentences, each with the numbers of this run.
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
    for (const PointLoad& load : scene.point_loads) force = std::max(force, largest_component(load.force));
    const Structure& structure = problem_.model.structure();
    const double bending = structure.bending_reference / (structure.length * structure.length);
    std::string text = "Check units and sizes of loads and prescribed motions";
    if (force > 0.0 && bending > 0.0)
      text += ": the largest point load is " + number(force / bending) + " times EI/L^2 of the structure";
    add(AdviceKind::check_units, text + ".");
  }
  void add_support() {
    add(AdviceKind::add_support, "Hold the structure: without loads it moves without strain" + of_mode() +
                                     ". Add a support or spring there, or close a joint.");
  }
  void prescribe_displacement() {
    add(AdviceKind::prescribe_displacement,
        "If the load has reached its largest value: prescribe the displacement of the loaded point in place of the "
        "force (\"Displacement\" of a support there); the structure can then be led through" +
            of_mode() + ".");
  }
  void add_imperfection() {
    add(AdviceKind::add_imperfection,
        "If the structure buckles to a side: add a small load (a thousandth of the present one) that pushes it there" +
            of_mode() + ".");
  }
  void stay_below() {
    add(AdviceKind::stay_below, "Results up to load factor " + number(report_.last_load_factor) +
                                    " stand: if that load is what the structure carries, nothing is wrong.");
  }
  void more_elements() {
    std::string text = "Use more elements";
    for (const WideAngle& wide : report_.wide_angles)
      text += (&wide == &report_.wide_angles.front() ? ": " : ", ") + std::string("\"Elements\" ") +
              std::to_string(wide.suggested_elements) + " in member \"" + excerpt(wide.member) + "\" (now " +
              std::to_string(wide.elements) + ")";
    if (report_.wide_angles.empty() && !report_.attempts.empty() && report_.attempts.back().peak) {
      const EquationPlace& place = report_.attempts.back().peak->place;
      const int now = problem_.model.mesh().members[member_index(problem_.model.scene(), place.member)].elements;
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
    add(AdviceKind::smaller_rotation,
        "A smaller \"Maximum Rotation\" in \"Newton\": " + number(0.5 * now) + " (now " + number(now) + ").");
  }
  void smaller_first_step() {
    const double now = parameters_.load_path.initial_step;
    add(AdviceKind::smaller_first_step,
        "A smaller \"Initial Step\" in \"Load Path\": " + number(0.1 * now) + " (now " + number(now) + ").");
  }
  void smaller_minimum_step() {
    const double now = report_.minimum_step;
    add(AdviceKind::smaller_minimum_step,
        "A smaller \"Minimum Step\" in \"Load Path\": " + number(0.01 * now) + " (now " + number(now) + ").");
  }
  /// Whether the steps permitted have brought the path next to nowhere: more of them will not do.
  bool crawls() const { return report_.last_load_factor < kShareOfACrawl * report_.stages; }
  void more_steps() {
    const int now = parameters_.load_path.maximum_steps;
    const double done = report_.last_load_factor / report_.stages;
    const double needed = crawls() ? 10.0 * now : now / done;
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
  void finite_stiffness() {
    const EquationPlace& place = report_.attempts.back().peak->place;
    add(AdviceKind::finite_stiffness,
        "Give member \"" + excerpt(place.member) + "\" " + (place.component == 0 ? "an axial" : "a shear") +
            " stiffness (" + (place.component == 0 ? "\"EA\"" : "\"GA2\", \"GA3\"") +
            ") with which it can yield, or take away what is imposed: eigenstrains and prescribed motions that only " +
            "fit if it changes its length or shears.");
  }

 private:
  void add(AdviceKind kind, const std::string& text) { advice.push_back({kind, text}); }

  /// ", where point "tip" moves along (0, 1, 0)", of the mode nearest to zero.
  std::string of_mode() const {
    if (report_.tangent.modes.empty() || report_.tangent.modes.front().vertices.empty()) return "";
    const MovingVertex& most = report_.tangent.modes.front().vertices.front();
    return ", where " + text_of(most.place) + (most.turns ? " turns about " : " moves along ") +
           direction_text(most.direction);
  }

  const FailureReport& report_;
  const BeamProblem& problem_;
  const SolverParameters& parameters_;
};

}  // namespace

std::vector<Advice> advice_for(const FailureReport& report, const BeamProblem& problem,
                               const SolverParameters& parameters) {
  Adviser to(report, problem, parameters);
  switch (report.cause) {
    case FailureCause::load_not_finite:
      to.correct_load();
      break;
    case FailureCause::steps_used_up:
      if (to.crawls()) to.check_units(), to.check_sections();
      to.more_steps();
      break;
    case FailureCause::mechanism:
      to.add_support();
      break;
    case FailureCause::end_angle:
      to.more_elements(), to.smaller_minimum_step();
      break;
    case FailureCause::critical_point:
      to.prescribe_displacement(), to.add_imperfection(), to.smaller_minimum_step(), to.stay_below();
      break;
    case FailureCause::overflow:
      to.check_units(), to.smaller_first_step(), to.check_sections();
      break;
    case FailureCause::linear_solver:
      to.check_sections(), to.check_units(), to.smaller_first_step();
      break;
    case FailureCause::path_lost:
      to.prescribe_displacement(), to.smaller_minimum_step(), to.smaller_first_step(), to.stay_below();
      break;
    case FailureCause::incompatible:
      to.finite_stiffness(), to.smaller_minimum_step(), to.more_elements(), to.stay_below();
      break;
    case FailureCause::slow:
      to.more_iterations(), to.smaller_minimum_step(), to.smaller_rotation(), to.more_elements();
      break;
    case FailureCause::wandering:
      to.smaller_minimum_step(), to.more_elements(), to.smaller_rotation(), to.more_iterations();
      to.smaller_first_step();
      break;
  }
  return to.advice;
}

}  // namespace mixbeam
