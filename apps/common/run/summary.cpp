#include "apps/common/run/summary.hpp"

#include "apps/common/tables/formatted.hpp"
#include "discretization/results/disk_file.hpp"
#include "discretization/state/record_fields.hpp"
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

template <>
inline constexpr auto kFields<EstimatedErrors::Quantity> =
    std::tuple{field("name", &EstimatedErrors::Quantity::name), field("error", &EstimatedErrors::Quantity::error),
               field("relative", &EstimatedErrors::Quantity::relative)};
template <>
inline constexpr auto kFields<EstimatedErrors> = std::tuple{
    field("run", &EstimatedErrors::run), field("not_estimated", &EstimatedErrors::not_estimated, Kept::if_known),
    field("quantities", &EstimatedErrors::quantities)};
template <>
inline constexpr auto kFields<ChosenMesh::Members> =
    std::tuple{field("names", &ChosenMesh::Members::names), field("count", &ChosenMesh::Members::count),
               field("order", &ChosenMesh::Members::order), field("elements", &ChosenMesh::Members::elements)};
template <>
inline constexpr auto kFields<ChosenMesh::Round> =
    std::tuple{field("elements", &ChosenMesh::Round::elements),
               field("path_followed", &ChosenMesh::Round::followed),
               field("load_steps", &ChosenMesh::Round::steps),
               field("newton_iterations", &ChosenMesh::Round::iterations),
               field("seconds", &ChosenMesh::Round::seconds),
               field("estimated", &ChosenMesh::Round::error),
               field("remark", &ChosenMesh::Round::remark, Kept::if_known)};
template <>
inline constexpr auto kFields<ChosenMesh> = std::tuple{field("run", &ChosenMesh::run),
                                                       field("wanted", &ChosenMesh::wanted),
                                                       field("estimated", &ChosenMesh::estimated),
                                                       field("outcome", &ChosenMesh::outcome),
                                                       field("members", &ChosenMesh::members),
                                                       field("meshes", &ChosenMesh::rounds)};
template <>
inline constexpr auto kFields<FollowedQuantity> =
    std::tuple{field("run", &FollowedQuantity::run),
               field("name", &FollowedQuantity::name),
               field("value", &FollowedQuantity::value),
               field("at_largest_size", &FollowedQuantity::at_largest_size),
               field("load_factor_of_largest_size", &FollowedQuantity::load_factor_of_largest_size),
               field("step_of_largest_size", &FollowedQuantity::step_of_largest_size),
               field("error", &FollowedQuantity::error, Kept::if_known),
               field("not_estimated", &FollowedQuantity::not_estimated, Kept::if_known),
               field("place", &FollowedQuantity::place, Kept::if_known),
               field("member", &FollowedQuantity::member, Kept::if_known),
               field("arc_length", &FollowedQuantity::arc_length),
               field("side", &FollowedQuantity::side)};
template <>
inline constexpr auto kFields<FoundDerivative> =
    std::tuple{field("run", &FoundDerivative::run), field("quantity", &FoundDerivative::quantity),
               field("value", &FoundDerivative::value), field("number", &FoundDerivative::number),
               field("derivative", &FoundDerivative::derivative)};
template <>
inline constexpr auto kFields<FoundNumberOfScene> =
    std::tuple{field("parameter", &FoundNumberOfScene::parameter),
               field("number", &FoundNumberOfScene::number),
               field("start", &FoundNumberOfScene::start),
               field("value", &FoundNumberOfScene::value),
               field("standard_deviation", &FoundNumberOfScene::deviation, Kept::if_known),
               field("covariance", &FoundNumberOfScene::covariance, Kept::if_known)};
template <>
inline constexpr auto kFields<QuantityEnvelope> =
    std::tuple{field("name", &QuantityEnvelope::name), field("largest", &QuantityEnvelope::largest),
               field("largest_in", &QuantityEnvelope::largest_in), field("smallest", &QuantityEnvelope::smallest),
               field("smallest_in", &QuantityEnvelope::smallest_in)};
template <>
inline constexpr auto kFields<EndOfRun> = std::tuple_cat(
    std::tuple{field("run", &EndOfRun::run), field("load_factor", &EndOfRun::load_factor)}, kFields<RecordedStability>,
    std::tuple{field("has_potential", &EndOfRun::has_potential, Kept::inside),
               field("jumps", &EndOfRun::jumps, Kept::if_known),
               field("collapse", &EndOfRun::collapse, Kept::if_known)});
/// Fields of a check for another process; JSON has more.
template <>
inline constexpr auto kFields<CheckedQuantity> =
    std::tuple{field("name", &CheckedQuantity::name),           field("value", &CheckedQuantity::value),
               field("reference", &CheckedQuantity::reference), field("source", &CheckedQuantity::source),
               field("tolerance", &CheckedQuantity::tolerance), field("comparison", &CheckedQuantity::comparison),
               field("pass", &CheckedQuantity::pass),           field("word", &CheckedQuantity::word),
               field("remark", &CheckedQuantity::remark)};

namespace {

constexpr std::array<std::pair<Comparison, const char*>, 5> kComparisonNames = {
    {{Comparison::absolute, "absolute"},
     {Comparison::relative, "relative"},
     {Comparison::upper_bound, "upper bound"},
     {Comparison::printed_digits, "printed digits"},
     {Comparison::word, "word"}}};

// Shortest exact text; NaN without its sign.
std::string exact_text(double value) { return std::isnan(value) ? "nan" : shortest(value); }

nlohmann::ordered_json json_number(double value) {
  if (std::isfinite(value)) return value;
  return exact_text(value);
}

template <class Value>
inline constexpr bool kIsRecord = std::tuple_size_v<std::decay_t<decltype(kFields<Value>)>> > 0;
template <class Value>
inline constexpr bool kIsList = false;
template <class Entry>
inline constexpr bool kIsList<std::vector<Entry>> = true;

template <class Field>
const char* name_in_summary(const Field& field) {
  return field.in_summary != nullptr ? field.in_summary : field.name;
}

/// JSON of a value. `is_sent`: complete, for another process; numbers keep their bits.
template <class Json, class Value>
Json json_of(const Value& value, bool is_sent) {
  if constexpr (kIsRecord<Value>) {
    Json json = Json::object();
    visit_fields(value, [&](const auto& field, const auto& part) {
      if (is_sent || field.kept == Kept::always || (field.kept == Kept::if_known && is_known_value(part)))
        json[name_in_summary(field)] = json_of<Json>(part, is_sent);
    });
    return json;
  } else if constexpr (kIsList<Value>) {
    Json json = Json::array();
    for (const auto& one : value) json.push_back(json_of<Json>(one, is_sent));
    return json;
  } else {
    if constexpr (std::is_same_v<Value, double>)
      if (!is_sent) return json_number(value);
    return value;
  }
}

/// Reads a value from sent JSON; appends to lists.
template <class Value>
void take(const nlohmann::json& json, Value& value) {
  if constexpr (kIsRecord<Value>)
    visit_fields(value, [&](const auto& field, auto& part) { take(json.at(name_in_summary(field)), part); });
  else if constexpr (kIsList<Value>)
    for (const nlohmann::json& one : json) take(one, value.emplace_back());
  else
    json.get_to(value);
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

/// Limit on failed checks on the terminal; a batch has one per case and limit.
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

void Summary::add_work(int steps, int iterations, const std::map<std::string, double>& times) {
  load_steps += steps;
  newton_iterations += iterations;
  for (const auto& [phase, time] : times) seconds[phase] += time;
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
  const std::string source = kLimitOfScene;
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
  const auto add = [&json](const char* name, const auto& list) {
    if (!list.empty()) json[name] = json_of<nlohmann::ordered_json>(list, false);
  };
  add("ends", ends);
  if (!stable_cases.empty()) json["stable_cases"] = stable_cases;
  if (!warnings.empty()) json["warnings"] = warnings;
  for (const FollowedQuantity& quantity : quantities) {
    json["quantities"].push_back(json_of<nlohmann::ordered_json>(quantity, false));
    if (!quantity.member.empty()) continue;
    for (const char* of_place : {"arc_length", "side"}) json["quantities"].back().erase(of_place);
  }
  add("gradients", gradients);
  add("found_numbers", found_numbers);
  add("envelope", envelope);
  add("estimated_errors", estimated_errors);
  add("chosen_meshes", chosen_meshes);
  for (const auto& [name, value] : rest_shape) json["rest_shape"][name] = json_number(value);
  json["all_passed"] = all_passed();
  json["checks"] = nlohmann::ordered_json::array();
  for (const auto& quantity : checks_) json["checks"].push_back(json_check(quantity));
  const auto replace_broken_utf8 = nlohmann::ordered_json::error_handler_t::replace;
  const bool durable = true;
  replace_file(path, json.dump(2, ' ', false, replace_broken_utf8) + "\n", durable);
}

// CBOR keeps all bits of a number, also NaN and infinity.
std::string Summary::packed() const {
  const auto sent = [](const auto& list) { return json_of<nlohmann::json>(list, true); };
  const nlohmann::json json = {{"load_steps", load_steps},
                               {"newton_iterations", newton_iterations},
                               {"warnings", warnings},
                               {"ends", sent(ends)},
                               {"quantities", sent(quantities)},
                               {"gradients", sent(gradients)},
                               {"errors", sent(estimated_errors)},
                               {"meshes", sent(chosen_meshes)},
                               {"seconds", seconds},
                               {"checks", sent(checks_)}};
  std::string bytes;
  nlohmann::json::to_cbor(json, bytes);
  return bytes;
}

void Summary::append(const std::string& packed) {
  const nlohmann::json json = nlohmann::json::from_cbor(packed);
  add_work(json["load_steps"], json["newton_iterations"], json["seconds"]);
  take(json["warnings"], warnings);
  take(json["ends"], ends);
  take(json["quantities"], quantities);
  take(json["gradients"], gradients);
  take(json["errors"], estimated_errors);
  take(json["meshes"], chosen_meshes);
  take(json["checks"], checks_);
}

}  // namespace mixbeam
