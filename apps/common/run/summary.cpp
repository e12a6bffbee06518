#include "apps/common/run/summary.hpp"

#include "apps/common/tables/printed_digits.hpp"
#include "discretization/results/disk_file.hpp"
#include "discretization/text/number_text.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <ostream>
#include <stdexcept>
#include <utility>

namespace mixbeam {
namespace {

constexpr std::array<std::pair<Comparison, const char*>, 5> kComparisonNames = {
    {{Comparison::absolute, "absolute"},
     {Comparison::relative, "relative"},
     {Comparison::upper_bound, "upper bound"},
     {Comparison::printed_digits, "printed digits"},
     {Comparison::word, "word"}}};

// A NaN without its sign.
std::string exact_text(double value) { return std::isnan(value) ? "nan" : shortest(value); }

nlohmann::ordered_json json_number(double value) {
  if (std::isfinite(value)) return value;
  return exact_text(value);
}

nlohmann::ordered_json json_mesh(const ChosenMesh& mesh) {
  nlohmann::ordered_json json = {{"run", mesh.run},
                                 {"wanted", json_number(mesh.wanted)},
                                 {"estimated", json_number(mesh.estimated)},
                                 {"outcome", mesh.outcome}};
  json["members"] = nlohmann::ordered_json::array();
  for (const auto& members : mesh.members)
    json["members"].push_back(
        {{"names", members.names}, {"count", members.count}, {"order", members.order}, {"elements", members.elements}});
  json["meshes"] = nlohmann::ordered_json::array();
  for (const auto& round : mesh.rounds) {
    json["meshes"].push_back({{"elements", round.elements},
                              {"path_followed", round.followed},
                              {"load_steps", round.steps},
                              {"newton_iterations", round.iterations},
                              {"seconds", json_number(round.seconds)},
                              {"estimated", json_number(round.error)}});
    if (!round.remark.empty()) json["meshes"].back()["remark"] = round.remark;
  }
  return json;
}

nlohmann::ordered_json json_errors(const EstimatedErrors& errors) {
  nlohmann::ordered_json json = {{"run", errors.run}};
  if (!errors.not_estimated.empty()) json["not_estimated"] = errors.not_estimated;
  json["quantities"] = nlohmann::ordered_json::array();
  for (const auto& quantity : errors.quantities)
    json["quantities"].push_back({{"name", quantity.name},
                                  {"error", json_number(quantity.error)},
                                  {"relative", json_number(quantity.relative)}});
  return json;
}

nlohmann::ordered_json json_check(const CheckedQuantity& quantity) {
  const bool is_word = quantity.comparison == Comparison::word;
  nlohmann::ordered_json json = {{"name", quantity.name},
                                 {"value", json_number(quantity.value)},
                                 {"reference", quantity.reference},
                                 {"printed_reference", quantity.reference},
                                 {"source", quantity.source},
                                 {"comparison", name_of(quantity.comparison)},
                                 {"tolerance", json_number(quantity.tolerance)},
                                 {"pass", quantity.pass}};
  if (is_word && quantity.remark.empty()) json["value"] = quantity.word;
  if (!is_word) json["reference"] = printed_value(quantity.reference);
  if (!quantity.remark.empty()) json["remark"] = quantity.remark;
  return json;
}

nlohmann::ordered_json json_end(const EndOfRun& end) {
  nlohmann::ordered_json json = {
      {"run", end.run}, {"load_factor", json_number(end.load_factor)}, {"stable", end.stable}};
  if (!end.held.empty()) json["stable_held"] = end.held;
  if (end.negative >= 0) json["negative_eigenvalues"] = end.negative;
  for (const RecordedJump& jump : end.jumps)
    json["jumps"].push_back({{"from_load_factor", json_number(jump.from)},
                             {"to_load_factor", json_number(jump.to)},
                             {"energy_released", json_number(jump.released)},
                             {"motion", json_number(jump.motion)},
                             {"largest_displacement", json_number(jump.largest)},
                             {"place", jump.place},
                             {"factorizations", jump.factorizations}});
  return json;
}

nlohmann::ordered_json json_quantity(const FollowedQuantity& quantity) {
  nlohmann::ordered_json json = {{"run", quantity.run},
                                 {"name", quantity.name},
                                 {"value", json_number(quantity.value)},
                                 {"at_largest_size", json_number(quantity.at_largest_size)},
                                 {"load_factor_of_largest_size", json_number(quantity.load_factor_of_largest_size)},
                                 {"step_of_largest_size", quantity.step_of_largest_size}};
  if (!std::isnan(quantity.error)) json["error"] = json_number(quantity.error);
  if (!quantity.not_estimated.empty()) json["not_estimated"] = quantity.not_estimated;
  if (quantity.member.empty()) return json;
  json["member"] = quantity.member;
  json["arc_length"] = json_number(quantity.arc_length);
  json["side"] = quantity.side;
  return json;
}

nlohmann::ordered_json json_envelope(const QuantityEnvelope& one) {
  return {{"name", one.name},
          {"largest", json_number(one.largest)},
          {"largest_in", one.largest_in},
          {"smallest", json_number(one.smallest)},
          {"smallest_in", one.smallest_in}};
}

/// Failed checks on the terminal: a batch has one for each case and limit.
constexpr std::size_t kMostFailures = 24;

std::string check_line(const CheckedQuantity& quantity) {
  const bool digits = quantity.comparison == Comparison::printed_digits;
  std::string line = quantity.pass ? "  pass  " : "  FAIL  ";
  if (!quantity.remark.empty())
    return line + quantity.name + ": " + quantity.remark + ", reference " + quantity.reference;
  if (quantity.comparison == Comparison::word)
    return line + quantity.name + " = " + quantity.word + ", reference " + quantity.reference;
  line +=
      quantity.name + " = " + (digits ? in_style_of(quantity.value, quantity.reference) : exact_text(quantity.value));
  if (quantity.comparison == Comparison::upper_bound) return line + ", at most " + quantity.reference;
  line += ", reference " + quantity.reference;
  if (digits) return line + " (printed digits, " + exact_text(quantity.tolerance) + " in the last)";
  return line + " (" + name_of(quantity.comparison) + " " + exact_text(quantity.tolerance) + ")";
}

}  // namespace

std::string name_of(Comparison comparison) {
  for (const auto& [kind, name] : kComparisonNames) {
    if (kind == comparison) return name;
  }
  throw std::invalid_argument("unknown comparison");
}

bool agrees(const CheckedQuantity& quantity) {
  if (!quantity.remark.empty()) return false;
  if (quantity.comparison == Comparison::word) return quantity.word == quantity.reference;
  const double reference = printed_value(quantity.reference);
  if (!std::isfinite(quantity.tolerance) || quantity.tolerance < 0.0) {
    throw std::invalid_argument("the tolerance of '" + quantity.name + "' must be a finite number of at least 0");
  }
  if (!std::isfinite(quantity.value)) return false;
  const double difference = std::abs(quantity.value - reference);
  switch (quantity.comparison) {
    case Comparison::absolute:
      return difference <= quantity.tolerance;
    case Comparison::relative:
      return difference <= quantity.tolerance * std::abs(reference);
    case Comparison::upper_bound:
      return quantity.value <= reference;
    case Comparison::printed_digits:
      return agrees_in_printed_digits(quantity.value, quantity.reference, static_cast<int>(quantity.tolerance));
    case Comparison::word:
      break;
  }
  return false;
}

bool Summary::check(CheckedQuantity quantity) {
  if (quantity.source.empty()) throw std::invalid_argument("the reference of '" + quantity.name + "' names no source");
  quantity.pass = agrees(quantity);
  checks_.push_back(std::move(quantity));
  return checks_.back().pass;
}

bool Summary::check_absolute(const std::string& name, double value, double reference, double tolerance,
                             const std::string& source) {
  return check({name, value, exact_text(reference), source, tolerance, Comparison::absolute, false});
}

bool Summary::check_relative(const std::string& name, double value, double reference, double tolerance,
                             const std::string& source) {
  return check({name, value, exact_text(reference), source, tolerance, Comparison::relative, false});
}

bool Summary::check_expected(const std::string& name, double value, const ExpectedValue& expected) {
  const auto check = expected.kind == ToleranceKind::absolute ? &Summary::check_absolute : &Summary::check_relative;
  return (this->*check)(name, value, expected.value, expected.tolerance, expected.source);
}

bool Summary::check_upper_bound(const std::string& name, double value, double bound, const std::string& source) {
  return check({name, value, exact_text(bound), source, 0.0, Comparison::upper_bound, false});
}

void Summary::check_limit(const std::string& name, const std::string& where, double size, double error,
                          const std::string& not_estimated, double limit) {
  const std::string source = "limit of the scene";
  if (not_estimated.empty())
    check_upper_bound(name + (error > 0.0 ? " and its error" : "") + where, size + error, limit, source);
  else
    fail(name + where, formatted("at most %.10g", limit), source,
         formatted("%.10g, with an error that is not known: ", size) + not_estimated);
}

bool Summary::check_printed_digits(const std::string& name, double value, const std::string& printed,
                                   const std::string& source, int units_in_last_place) {
  return check(
      {name, value, printed, source, static_cast<double>(units_in_last_place), Comparison::printed_digits, false});
}

bool Summary::check_word(const std::string& name, const std::string& word, const std::string& reference,
                         const std::string& source) {
  return check({name, 0.0, reference, source, 0.0, Comparison::word, false, word});
}

void Summary::fail(const std::string& name, const std::string& reference, const std::string& source,
                   const std::string& remark) {
  check({name, std::nan(""), reference, source, 0.0, Comparison::word, false, "", remark});
}

std::string Summary::stable() const {
  for (const char* word : {"false", "unknown", "neutral", "true"}) {
    const auto found = stable_cases.find(word);
    const auto is_word = [word](const EndOfRun& end) { return end.stable == word; };
    if ((found != stable_cases.end() && found->second > 0) || std::any_of(ends.begin(), ends.end(), is_word))
      return word;
  }
  return "";
}

bool Summary::all_passed() const {
  return failure.empty() &&
         std::all_of(checks_.begin(), checks_.end(), [](const CheckedQuantity& quantity) { return quantity.pass; });
}

void Summary::print_checks(std::ostream& stream, bool every_check) const {
  const auto warned = [this] {
    if (warnings.empty()) return std::string();
    return std::to_string(warnings.size()) + (warnings.size() == 1 ? " warning" : " warnings");
  };
  if (checks_.empty()) {
    stream << "Nothing was checked: " << (unchecked.empty() ? "the scene gives no expected values" : unchecked) << "."
           << (warnings.empty() ? "" : " " + warned() + ".") << "\n";
    return;
  }
  std::size_t failed = 0;
  for (const auto& quantity : checks_) {
    failed += quantity.pass ? 0 : 1;
    if (every_check || (!quantity.pass && failed <= kMostFailures))
      stream << check_line(quantity) << ", from " << quantity.source << '\n';
  }
  if (!every_check && failed > kMostFailures)
    stream << "  ... and " << failed - kMostFailures << " more that FAIL; --summary FILE.json has all\n";
  stream << checks_.size() - failed << " of " << checks_.size() << " checks passed";
  if (failed > 0) stream << ", " << failed << " FAILED";
  stream << (warnings.empty() ? "" : ", " + warned()) << ".\n";
}

bool holds_summary(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return false;
  std::ifstream stream(file, std::ios::binary);
  const bool throws = false;
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, throws);
  return json.is_object() && json.contains("all_passed");
}

void Summary::write_json(const std::filesystem::path& path) const {
  nlohmann::ordered_json json = {{"program", program},
                                 {"version", version},
                                 {"compiler", compiler},
                                 {"threads", threads},
                                 {"ranks", ranks},
                                 {"load_steps", load_steps},
                                 {"newton_iterations", newton_iterations}};
  json["seconds"] = nlohmann::ordered_json::object();
  for (const auto& [phase, time] : seconds) json["seconds"][phase] = json_number(time);
  if (!failure.empty()) json["failure"] = failure;
  if (!stable().empty()) json["stable"] = stable();
  for (const auto& end : ends) json["ends"].push_back(json_end(end));
  if (!stable_cases.empty()) json["stable_cases"] = stable_cases;
  if (!warnings.empty()) json["warnings"] = warnings;
  for (const auto& quantity : quantities) json["quantities"].push_back(json_quantity(quantity));
  for (const auto& one : envelope) json["envelope"].push_back(json_envelope(one));
  if (!estimated_errors.empty()) json["estimated_errors"] = nlohmann::ordered_json::array();
  for (const auto& errors : estimated_errors) json["estimated_errors"].push_back(json_errors(errors));
  if (!chosen_meshes.empty()) json["chosen_meshes"] = nlohmann::ordered_json::array();
  for (const auto& mesh : chosen_meshes) json["chosen_meshes"].push_back(json_mesh(mesh));
  json["all_passed"] = all_passed();
  json["checks"] = nlohmann::ordered_json::array();
  for (const auto& quantity : checks_) json["checks"].push_back(json_check(quantity));
  const auto replace_broken_utf8 = nlohmann::ordered_json::error_handler_t::replace;
  const bool durable = true;
  replace_file(path, json.dump(2, ' ', false, replace_broken_utf8) + "\n", durable);
}

}  // namespace mixbeam
