#include "apps/common/run/scene_search.hpp"

#include "apps/common/run/application.hpp"
#include "apps/common/run/quantity_values.hpp"
#include "apps/common/tables/formatted.hpp"
#include "discretization/parameters/binding.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/parameters/value.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/variables.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/sensitivity/constrained_minimum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

using List = Teuchos::ParameterList;

const std::string kIdentification = "Identification", kDesign = "Design", kParameters = "Parameters",
                  kMeasurements = "Measurements", kConstraints = "Constraints", kObjective = "Objective";

/// Limit on the numbers, each of which costs four evaluations of the equations per step of a search.
constexpr std::size_t kMostSearched = 200;

BoundList<SearchedNumber> searched_numbers() {
  BoundList<SearchedNumber> number("A number of the scene that is looked for, beginning with the value that it has.");
  number.bind(&SearchedNumber::path, text("Number").required(),
              "Path of the number below the list Scene (\"Sections/rod/EI2\", \"Points/tip[0]\", \"Variables/EI\"), or "
              "a pattern that stands for several, each of which is looked for.");
  number.bind(&SearchedNumber::at_least, real("At Least"), "Lower bound; default: none.");
  number.bind(&SearchedNumber::at_most, real("At Most"), "Upper bound; default: none.");
  number.bind(&SearchedNumber::scale, real("Scale").above(0.0),
              "Size of a large change; default: that of the number, else the distance of the bounds.");
  return number;
}

/// Binds quantity and case.
void bind_quantity(BoundList<WantedQuantity>& wanted) {
  wanted.bind(&WantedQuantity::quantity, text("Quantity").required(),
              "Name of a number of the list Quantities (\"tip.y\"), at the end of the path.");
  wanted.bind(&WantedQuantity::load_case, text("Case").by_default(), "Load case or combination in which it is taken.");
}

BoundList<WantedQuantity> measurements() {
  BoundList<WantedQuantity> wanted("A measured value of a quantity.");
  bind_quantity(wanted);
  wanted.bind(&WantedQuantity::value, real("Value").required(), "As measured, in the units of the quantity.");
  wanted.bind(
      &WantedQuantity::deviation, real("Standard Deviation").above(0.0).required(),
      "Of the measurement; its square is the weight in the sum of squares, and the covariance follows from it.");
  return wanted;
}

BoundList<WantedQuantity> constraints() {
  BoundList<WantedQuantity> wanted("Bounds of a quantity, one or both; equal ones: the value that it shall have.");
  bind_quantity(wanted);
  wanted.bind(&WantedQuantity::at_least, real("At Least"), "Smallest value allowed.");
  wanted.bind(&WantedQuantity::at_most, real("At Most"), "Largest value allowed.");
  return wanted;
}

BoundList<WantedQuantity> objectives() {
  BoundList<WantedQuantity> wanted("What shall be as small, or as large, as bounds and constraints allow.");
  bind_quantity(wanted);
  wanted.bind(&WantedQuantity::is_largest, text("Goal").by_default(), "Which value is looked for.",
              {{"smallest", false}, {"largest", true}});
  return wanted;
}

const BoundList<WantedQuantity> kConstraint = constraints(), kDesigned = objectives();
const BoundList<SearchedNumber> kSearchedNumbers = searched_numbers();
const BoundList<WantedQuantity> kMeasured = measurements();

/// Reads the list and refuses names that the scene does not have.
class SearchReader {
 public:
  SearchReader(const Application& app, const std::string& name)
      : app_(app), scene_(app.xml.list->sublist("Scene")), path_{name}, list_(app.xml.list->sublist(name)) {
    search_.list = name;
    search_.is_design = name == kDesign;
  }

  /// Reads all entries and collects their mistakes.
  SearchParameters read() {
    const ParameterSource& source = app_.xml.source;
    require_offered();
    const List& numbers = list_.sublist(kParameters);
    for (const std::string& name : names_of(numbers)) source.attempt([&] { add_numbers(name, numbers.sublist(name)); });
    if (search_.numbers.size() > kMostSearched)
      refuse({kParameters}, "it means " + std::to_string(search_.numbers.size()) + " numbers; allowed: up to " +
                                std::to_string(kMostSearched));
    if (search_.is_design)
      source.attempt([&] { add_wanted("objective", kDesigned.read(list_.sublist(kObjective)), {kObjective}); });
    const std::string& lists = search_.is_design ? kConstraints : kMeasurements;
    const BoundList<WantedQuantity>& declared = search_.is_design ? kConstraint : kMeasured;
    for (const std::string& name : list_.isSublist(lists) ? names_of(list_.sublist(lists)) : std::vector<std::string>{})
      source.attempt([&] {
        const WantedQuantity wanted = declared.read(list_.sublist(lists).sublist(name));
        if (search_.is_design) require_bounds(wanted, {lists, name});
        add_wanted(name, wanted, {lists, name});
      });
    source.require_none();
    return search_;
  }

 private:
  [[noreturn]] void refuse(const ParameterPath& below, const std::string& why) const {
    ParameterPath path = path_;
    path.insert(path.end(), below.begin(), below.end());
    throw app_.xml.source.error(path, why);
  }

  void require_bounds(const WantedQuantity& wanted, const ParameterPath& at) const {
    if (!wanted.at_least && !wanted.at_most) refuse(at, "no bound; needed: \"At Least\" or \"At Most\"");
    if (wanted.at_least && wanted.at_most && *wanted.at_least > *wanted.at_most)
      refuse(child(at, "At Most"), "value " + shortest(*wanted.at_most) + " is below \"At Least\", " +
                                       shortest(*wanted.at_least) + "; allowed: that, or more");
  }

  void require_offered() const {
    if (search_.is_design && app_.xml.list->isSublist(kIdentification))
      refuse({}, "given beside \"Identification\"; allowed: one of them");
    if (app_.xml.list->isSublist("Inverse")) refuse({}, "given beside \"Inverse\"; allowed: one of them");
    if (app_.mesh_is_free || app_.scene.accuracy)
      refuse({}, "given, but the scene names no mesh, or an \"Accuracy\"; allowed: \"Elements\" of members");
    if (app_.solver.analysis.control) refuse({}, "given with \"Control\" in \"Analysis\"; allowed: loads");
    if (app_.communicator->getSize() > 1) refuse({}, "given, and the run has several processes; allowed: one");
    if (!app_.scene.imperfection_modes.empty())
      refuse({}, "given, but the geometry has modes laid on it; allowed: scenes without such imperfections");
  }

  void add_numbers(const std::string& name, const List& list) {
    const SearchedNumber wanted = kSearchedNumbers.read(list);
    const std::vector<NumberPath> paths = numbers_meant(scene_, wanted.path);
    if (paths.empty()) refuse({kParameters, name, "Number"}, unknown_number(scene_, wanted.path));
    for (const NumberPath& path : paths) add_number(name, path, wanted, paths.size() == 1);
  }

  void add_number(const std::string& name, const NumberPath& path, SearchedNumber wanted, bool alone) {
    const auto refuse_number = [&](const std::string& at, const std::string& why) {
      refuse({kParameters, name, at}, "\"" + excerpt(path.text()) + "\" " + why);
    };
    for (const SearchedNumber& other : search_.numbers)
      if (other.path == path.text()) refuse_number("Number", "for the second time; allowed: once");
    if (!stands_in_file(path)) refuse_number("Number", "stands in a table; allowed: numbers of the scene file itself");
    const std::vector<double> values = numbers_in(entry_of(scene_, path));
    const double start = values[static_cast<std::size_t>(std::max(0, path.component))];
    wanted.start = wanted.value = start;
    wanted.deviation = std::nan("");
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double lower = wanted.at_least.value_or(-kInfinity), upper = wanted.at_most.value_or(kInfinity);
    if (!(lower < upper))
      refuse_number("At Most", "has bounds " + shortest(lower) + " and " + shortest(upper) +
                                   "; allowed: \"At Most\" above \"At Least\"");
    if (!(start >= lower && start <= upper))
      refuse_number(start < lower ? "At Least" : "At Most",
                    "is " + shortest(start) + " in the scene, beyond this bound; allowed: a start between the bounds");
    double size = 0.0;
    for (const double value : values) size = std::max(size, std::isfinite(value) ? std::abs(value) : 0.0);
    if (size == 0.0) size = upper - lower;
    if (!wanted.scale && !std::isfinite(size))
      refuse_number("Scale", "is zero in the scene; needed: the size of a large change");
    wanted.scale = wanted.scale.value_or(size);
    wanted.at_least = lower;
    wanted.at_most = upper;
    wanted.name = alone ? name : path.text();
    wanted.path = path.text();
    wanted.place = path;
    search_.numbers.push_back(wanted);
  }

  /// Whether the number is in the scene file itself: only there can found numbers be written.
  bool stands_in_file(const NumberPath& path) const {
    ParameterPath list = {"Scene"};
    list.insert(list.end(), path.names.begin(), path.names.end() - 1);
    return app_.xml.source.line(list) > 0;
  }

  void add_wanted(const std::string& name, WantedQuantity wanted, const ParameterPath& at) {
    const std::vector<std::string> known = names_of_values(app_.quantities), cases = alternatives(app_.scene);
    if (std::count(known.begin(), known.end(), wanted.quantity) == 0)
      refuse(child(at, "Quantity"), "value \"" + excerpt(wanted.quantity) +
                                        "\" is no number that a quantity has; allowed: " +
                                        (known.empty() ? "nothing, the scene has no list \"Quantities\""
                                                       : quoted_list(known) + did_you_mean(wanted.quantity, known)));
    const bool is_known =
        cases.empty() ? wanted.load_case.empty() : std::count(cases.begin(), cases.end(), wanted.load_case) > 0;
    if (!is_known)
      refuse(child(at, "Case"),
             (wanted.load_case.empty() ? "missing" : "value \"" + excerpt(wanted.load_case) + "\"") +
                 "; allowed: " + (cases.empty() ? "nothing, the scene has no cases" : quoted_list(cases)));
    wanted.name = name;
    search_.wanted.push_back(wanted);
  }

  const Application& app_;
  const List& scene_;
  ParameterPath path_;
  const List& list_;
  SearchParameters search_;
};

/// The line with the first mistake of a message.
std::string first_mistake(const std::string& message) {
  std::size_t from = message.find(" mistakes:\n");
  from = from == std::string::npos ? 0 : message.find('\n', from) + 1;
  return message.substr(from, message.find('\n', from) - from);
}

/// Equilibria of the cases of a scene at the end of the path, continued as numbers of the scene change.
class CarriedScene {
 public:
  CarriedScene(Application& app, const SearchParameters& search)
      : app_(app), search_(search), xml_(app.xml), parameters_(app.solver) {
    parameters_.threads = app.threads_for(app.scene, app.solver);
    for (const WantedQuantity& wanted : search.wanted)
      if (std::count(cases_.begin(), cases_.end(), wanted.load_case) == 0) cases_.push_back(wanted.load_case);
  }

  /// Follows the path of each case. False: stopped. Throws ConvergenceError.
  bool begin() {
    for (const std::string& one : cases_) {
      PathControl control;
      control.stop = [this] { return app_.is_asked_to_stop(); };
      const Simulation run = app_.try_to_solve(scene_of_case(app_.scene, one), app_.solver, {}, control);
      if (run.result().interrupted) return false;
      if (!run.result().finished)
        throw ConvergenceError("the scene as it stands, where the list \"" + search_.list +
                               "\" begins: " + run.result().failure);
      accepted_.push_back(run);
    }
    return true;
  }

  /// Values of the wanted quantities with these numbers; none: the accepted equilibrium does not continue there
  /// (obstacle()).
  std::optional<std::vector<double>> move(const std::vector<double>& numbers) {
    trial_.clear();
    try {
      set(numbers);
      for (std::size_t i = 0; i < cases_.size(); ++i)
        if (!carry(i)) return {};
    } catch (const InputError& error) {
      obstacle_ = "the scene refuses it: " + first_mistake(error.what());
      return {};
    }
    std::vector<double> values;
    for (const WantedQuantity& wanted : search_.wanted) {
      const std::vector<double> all = values_of(quantities_, trial_[place_of(wanted.load_case)]);
      for (std::size_t i = 0; i < all.size(); ++i)
        if (quantities_.columns()[i].name == wanted.quantity) values.push_back(all[i]);
      if (std::isfinite(values.back())) continue;
      obstacle_ = "\"" + wanted.quantity + "\" is no finite number";
      return {};
    }
    return values;
  }

  /// Accepts the state of the last move() and returns its derivatives (wanted quantity, number). Throws InputError.
  std::vector<double> derivatives() {
    accepted_ = std::move(trial_);
    const std::size_t n = search_.numbers.size();
    std::vector<double> all(search_.wanted.size() * n, 0.0);
    for (std::size_t i = 0; i < cases_.size(); ++i) {
      GradientParameters asked;
      for (const SearchedNumber& number : search_.numbers) asked.by.push_back(number.path);
      for (const WantedQuantity& wanted : search_.wanted)
        if (wanted.load_case == cases_[i]) asked.of.push_back(wanted.quantity);
      const RecordedGradients found = gradients_at(accepted_[i], asked, {quantities_, {}}, xml_, cases_[i]);
      for (std::size_t k = 0; k < search_.wanted.size(); ++k)
        for (const RecordedGradient& one : found.quantities)
          if (search_.wanted[k].load_case == cases_[i] && one.quantity == search_.wanted[k].quantity)
            std::copy(one.derivative.begin(), one.derivative.end(), all.begin() + static_cast<std::ptrdiff_t>(k * n));
    }
    return all;
  }

  const std::string& obstacle() const { return obstacle_; }

 private:
  std::size_t place_of(const std::string& load_case) const {
    return static_cast<std::size_t>(std::find(cases_.begin(), cases_.end(), load_case) - cases_.begin());
  }

  void set(const std::vector<double>& numbers) {
    xml_.list = Teuchos::rcp(new List(*app_.xml.list));  // a new copy: reading a list modifies it
    List& list = xml_.list->sublist("Scene");
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const NumberPath& path = search_.numbers[i].place;
      set_number(const_cast<Teuchos::ParameterEntry&>(entry_of(list, path)), path.component, numbers[i]);
    }
    scene_ = read_scene(list, xml_.source);
    quantities_ = quantities_of(list, xml_, scene_);
  }

  /// Solves by Newton's method from the accepted state, down to rounding.
  bool carry(std::size_t i) {
    Simulation& there = trial_.emplace_back(scene_of_case(scene_, cases_[i]), parameters_, app_.communicator);
    State start = accepted_[i].state();
    start.in_plane = false;  // the plane may rotate with the numbers
    const bool settled = there.settle(start).finished;
    app_.summary.newton_iterations += there.result().newton_iterations;
    const int before = accepted_[i].stability().negative, after = there.stability().negative;
    if (!settled) obstacle_ = "Newton's method finds no equilibrium near the last one (" + there.result().failure + ")";
    if (settled && before != after)
      obstacle_ =
          "the number of negative eigenvalues changes from " + std::to_string(before) + " to " + std::to_string(after);
    if (!settled || before != after) return false;
    there.polish();
    return true;
  }

  Application& app_;
  const SearchParameters& search_;
  XmlParameters xml_;
  SolverParameters parameters_;
  std::vector<std::string> cases_{};
  Scene scene_{};
  QuantitySet quantities_{};
  std::vector<Simulation> accepted_{}, trial_{};
  std::string obstacle_{};
};

/// The text of the scene file with other numbers, without the list of the search.
std::string scene_with_numbers(const Application& app, const std::vector<SearchedNumber>& numbers,
                               const ListSpec& root) {
  const XmlParameters written = parse_parameters(app.xml.text, app.xml.source.file(), root);
  written.list->remove(app.search->list);
  for (const SearchedNumber& number : numbers) {
    const NumberPath& path = number.place;
    List* here = &written.list->sublist("Scene");
    for (std::size_t j = 0; j + 1 < path.names.size(); ++j) here = &here->sublist(path.names[j]);
    const std::string& name = path.names.back();
    if (path.component < 0) {
      here->setEntry(name, Teuchos::ParameterEntry(number.value));
      continue;
    }
    if (!here->isParameter(name)) here->setEntry(name, entry_of(app.xml.list->sublist("Scene"), path));
    Teuchos::ParameterEntry& entry = here->getEntry(name);
    set_formula(entry, path.component, shortest(number.value));
    if (holds_formula(value_of(entry))) continue;
    Teuchos::Array<double> plain;
    for (const std::string& text : Teuchos::getValue<Teuchos::Array<std::string>>(entry)) {
      double value = 0.0;
      parse_number(text, value);
      plain.push_back(value);
    }
    entry = Teuchos::ParameterEntry(plain);
  }
  return xml_text(*written.list);
}

/// Describes changes of the numbers that change no measurement.
std::vector<std::string> untold_text(const Information& information, const SearchParameters& search) {
  std::vector<std::string> texts;
  for (const std::vector<double>& direction : information.untold) {
    std::string changes;
    for (std::size_t i = 0; i < direction.size(); ++i) {
      constexpr double kSmallShare = 1e-3;  // of the largest component; smaller ones are not shown
      if (std::abs(direction[i]) < kSmallShare) continue;
      changes += (changes.empty() ? "" : ", ") + search.numbers[i].name +
                 formatted(" by %+.4g", direction[i] * *search.numbers[i].scale);
    }
    texts.push_back("the measurements do not tell the parameters apart: none of them feels a change of " + changes);
  }
  return texts;
}

ListSpec search_spec(const std::string& meaning) {
  ListSpec spec(meaning + " The scene with them is written beside the results, and solved.");
  spec.add_list(kParameters, ListSpec("What is looked for.").with_named_lists("parameter", kSearchedNumbers.spec, 1),
                Presence::required);
  return spec;
}

/// A search whose unknowns are numbers of the scene, divided by their scales.
class SceneSearch {
 public:
  SceneSearch(Application& app, const std::function<void(const SearchStep&)>& report)
      : app_(app), search_(*app.search), report_(report), scene_(app, search_) {}

  FoundScene run(const ListSpec& root) {
    found_.numbers = search_.numbers;
    for (const SearchedNumber& number : search_.numbers) {
      space_.start.push_back(number.start / *number.scale);
      space_.lower.push_back(*number.at_least / *number.scale);
      space_.upper.push_back(*number.at_most / *number.scale);
    }
    try {
      found_.end = scene_.begin() ? search() : SearchEnd::stopped;
    } catch (const LinearSolverError& error) {
      found_.end = SearchEnd::blocked;
      found_.failure = std::string("no gradients: ") + error.what();
    }
    found_.xml = scene_with_numbers(app_, found_.numbers, root);
    return found_;
  }

 private:
  /// Numbers of the scene; exactly the bound where an unknown is at it.
  std::vector<double> unscaled(std::vector<double> unknowns) const {
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      const SearchedNumber& number = search_.numbers[i];
      const bool is_lower = unknowns[i] <= space_.lower[i], is_upper = unknowns[i] >= space_.upper[i];
      unknowns[i] = is_lower ? *number.at_least : is_upper ? *number.at_most : unknowns[i] * *number.scale;
    }
    return unknowns;
  }
  /// Evaluates the wanted quantities; returns the rows of the problem.
  std::optional<std::vector<double>> values_at(const std::vector<double>& unknowns) {
    const std::optional<std::vector<double>> values = scene_.move(unscaled(unknowns));
    if (!values) return {};
    values_ = *values;
    std::vector<double> rows;
    for (const Row& row : rows_) rows.push_back(row.factor * (values_[row.wanted] - row.limit));
    return rows;
  }
  /// Derivatives of the rows with respect to the unknowns.
  std::vector<double> derivatives() {
    found_.values = values_;
    if (found_.sizes.empty())
      for (const double value : values_) found_.sizes.push_back(std::abs(value));
    const std::vector<double> all = scene_.derivatives();
    const std::size_t n = search_.numbers.size();
    std::vector<double> rows;
    for (const Row& row : rows_)
      for (std::size_t i = 0; i < n; ++i)
        rows.push_back(row.factor * all[row.wanted * n + i] * *search_.numbers[i].scale);
    return rows;
  }
  void take(SearchStep step) {
    step.unknowns = unscaled(step.unknowns);
    if (search_.is_design) step.objective /= rows_.front().factor;
    for (std::size_t i = 0; i < step.unknowns.size(); ++i) {
      SearchedNumber& number = found_.numbers[i];
      number.value = step.unknowns[i];
      number.is_held = number.value == *number.at_least || number.value == *number.at_most;
    }
    found_.steps.push_back(step);
    report_(step);
  }

  SearchEnd search() {
    SearchProblem problem;
    problem.space = space_;
    problem.values = [this](const std::vector<double>& unknowns) { return values_at(unknowns); };
    problem.derivatives = [this] { return derivatives(); };
    problem.report = [this](const SearchStep& step) { take(step); };
    problem.stop = [this] { return app_.is_asked_to_stop(); };
    const std::size_t equations = add_rows();
    const SearchResult result = search_.is_design ? minimise(problem, equations) : minimise_squares(problem);
    found_.failure = end_text(result);
    if (!search_.is_design && !result.derivatives.empty()) take_covariance(result.derivatives);
    for (const SearchedNumber& number : found_.numbers)
      if (number.is_held)
        found_.remarks.push_back("\"" + number.name + "\" is at its bound, " + shortest(number.value));
    return result.end;
  }

  /// Sets up the rows: residuals, or objective, equations, inequalities, scaled to slopes of about one in the unknowns.
  /// Returns the number of equations.
  std::size_t add_rows() {
    for (std::size_t k = 0; k < search_.wanted.size(); ++k) {
      const WantedQuantity& wanted = search_.wanted[k];
      rows_.push_back({k, search_.is_design ? 1.0 : 1.0 / wanted.deviation, wanted.value});
    }
    if (!search_.is_design) return 0;
    if (!values_at(space_.start)) throw ConvergenceError("the list \"" + search_.list + "\": " + scene_.obstacle());
    const std::vector<double> slopes = derivatives();
    const std::size_t n = search_.numbers.size();
    std::vector<Row> equations, inequalities;
    for (std::size_t k = 0; k < search_.wanted.size(); ++k) {
      const WantedQuantity& wanted = search_.wanted[k];
      double size = 0.0;
      for (std::size_t i = 0; i < n; ++i) size = std::max(size, std::abs(slopes[k * n + i]));
      if (size == 0.0) size = std::max(std::abs(values_[k]), 1.0);
      if (k == 0)
        rows_ = {{k, (wanted.is_largest ? -1.0 : 1.0) / size, 0.0}};
      else if (wanted.at_least && wanted.at_most && *wanted.at_least == *wanted.at_most)
        equations.push_back({k, 1.0 / size, *wanted.at_least});
      else if (wanted.at_least)
        inequalities.push_back({k, -1.0 / size, *wanted.at_least});
      if (k > 0 && wanted.at_most && wanted.at_least != wanted.at_most)
        inequalities.push_back({k, 1.0 / size, *wanted.at_most});
    }
    rows_.insert(rows_.end(), equations.begin(), equations.end());
    rows_.insert(rows_.end(), inequalities.begin(), inequalities.end());
    return equations.size();
  }

  /// Describes what blocks the search, and where.
  std::string end_text(const SearchResult& result) const {
    if (result.end == SearchEnd::too_long) return "not at the minimum after the most steps that are allowed";
    if (result.end == SearchEnd::no_descent && found_.steps.back().violation > kFeasible)
      return "no numbers near the last ones meet all constraints and bounds";
    if (result.end == SearchEnd::no_descent) return "no step makes the objective smaller, and it is not at its minimum";
    if (result.end != SearchEnd::blocked) return "";
    const std::vector<double> numbers = unscaled(result.blocked_at);
    std::string where;
    for (std::size_t i = 0; i < numbers.size() && i < kLongestList; ++i)
      where += (i == 0 ? "" : ", ") + search_.numbers[i].name + " = " + shortest(numbers[i]);
    return "the equilibrium cannot be carried to " + where + ": " + scene_.obstacle() +
           "; its branch ends there, and the search before it";
  }

  void take_covariance(const std::vector<double>& jacobian) {
    std::vector<bool> is_held;
    for (const SearchedNumber& number : found_.numbers) is_held.push_back(number.is_held);
    const Information information = information_of(jacobian, is_held);
    const std::size_t n = is_held.size();
    found_.covariance = information.covariance;
    for (std::size_t i = 0; i < n * n; ++i)
      found_.covariance[i] *= *search_.numbers[i / n].scale * *search_.numbers[i % n].scale;
    for (std::size_t i = 0; i < n; ++i) found_.numbers[i].deviation = std::sqrt(found_.covariance[i * n + i]);
    for (const std::string& text : untold_text(information, search_)) found_.remarks.push_back(text);
  }

  /// factor (value - limit) of a wanted quantity.
  struct Row {
    std::size_t wanted;
    double factor, limit;
  };

  Application& app_;
  const SearchParameters& search_;
  const std::function<void(const SearchStep&)>& report_;
  std::vector<Row> rows_{};
  CarriedScene scene_;
  SearchSpace space_{};
  std::vector<double> values_{};  ///< of the last move
  FoundScene found_{};
};

}  // namespace

ListSpec design_spec() {
  ListSpec spec = search_spec(
      "Find numbers of the scene with which a quantity is as small, or as large, as bounds of others allow.");
  spec.add_list(kObjective, kDesigned.spec, Presence::required);
  spec.add_list(kConstraints, ListSpec("What must hold.").with_named_lists("constraint", kConstraint.spec),
                Presence::optional);
  return spec;
}

ListSpec identification_spec() {
  ListSpec spec = search_spec(
      "Find numbers of the scene from measured quantities, by least squares, with their standard deviations.");
  spec.add_list(kMeasurements, ListSpec("What is known.").with_named_lists("measurement", kMeasured.spec, 1),
                Presence::required);
  return spec;
}

std::optional<SearchParameters> read_search(const Application& app) {
  for (const std::string& list : {kDesign, kIdentification})
    if (app.xml.list->isSublist(list)) return SearchReader(app, list).read();
  return {};
}

FoundScene search_scene(Application& app, const ListSpec& root, const std::function<void(const SearchStep&)>& report) {
  return SceneSearch(app, report).run(root);
}

}  // namespace mixbeam
