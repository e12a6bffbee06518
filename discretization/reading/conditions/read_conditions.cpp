#include "discretization/reading/scene_parts.hpp"

#include "discretization/parameters/input_place.hpp"
#include "discretization/reading/conditions/condition_reader.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>

namespace mixbeam {
namespace {

// Wildcards multiply: a line of text must not fill the memory.
constexpr std::size_t kMostConditions = 2'000'000;
constexpr std::size_t kMostLoadCases = 1000;
constexpr std::size_t kLongestPattern = 1000;  // matching takes time in proportion to it
constexpr int kSamplesPerStage = 8;            // of an amplitude: catches a pole at simple fractions

}  // namespace

void add_condition_lists(ListSpec& spec) {
  spec.add(array("Load Cases", ParameterType::text_array).or_empty(),
           "Names of alternatives that are solved one by one, each from the undeformed structure, like {wind, snow}; "
           "what acts says by Case to which of them it belongs.");
  spec.add_list(
      "Combinations",
      ListSpec("Load cases that act together, each with a factor, beside whatever belongs to no case; each "
               "combination is solved by itself.")
          .with_named_lists("combination", ListSpec("Factors of its load cases.")
                                               .with_named_parameters(
                                                   "case",
                                                   real("").required().means("Factor of this load case, or, as "
                                                                             "\"Stage 2\", of what acts in a stage."),
                                                   1)),
      Presence::optional);
  spec.add_list("Gravity", gravity_spec(), Presence::optional);
  spec.add_list("Rotating Frame", rotating_frame_spec(), Presence::optional);
  spec.add_list(
      "Supports",
      ListSpec("Supports; at least one here or by Import.").with_named_lists("support", kSupportParameters.spec));
  spec.add_list("Joints", ListSpec("Connections that are not rigid.").with_named_lists("joint", kJointParameters.spec));
  add_load_lists(spec);
}

std::vector<std::string> read_conditions(const Teuchos::ParameterList& scene_list, const InputPlace& place,
                                         Scene& scene, const std::vector<CopiedPattern>& copies) {
  return ConditionReader(scene_list, place, scene, copies).read();
}

std::vector<std::string> ConditionReader::read() {
  place_["Load Cases"].attempt([this] { read_load_cases(); });
  read_combinations();
  place_["Imperfection"]["Case"].attempt([this] { check_case_of_modes(); });
  read_supports();
  read_joints();
  read_loads();
  place_["Gravity"].attempt([this] { read_gravity(); });
  place_["Rotating Frame"].attempt([this] { read_rotating_frame(); });
  if (place_.source().has_mistakes()) return {};
  check_stages();
  check_amplitudes();
  return std::move(notes_);
}

void ConditionReader::read_load_cases() {
  if (!scene_list_.isParameter("Load Cases")) return;
  const InputPlace place = place_["Load Cases"];
  const auto& names = scene_list_.get<Teuchos::Array<std::string>>("Load Cases");
  if (static_cast<std::size_t>(names.size()) > kMostLoadCases)
    throw place.error(std::to_string(names.size()) + " names; allowed: " + std::to_string(kMostLoadCases));
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) throw place.error("names \"" + excerpt(name) + "\" twice; allowed: once");
    const Problem problem = file_name_problem(name);
    if (!problem.empty()) throw place.error("value " + problem);
    scene_.load_cases.push_back(name);
  }
}

void ConditionReader::read_combinations() {
  if (!scene_list_.isSublist("Combinations")) return;
  const List& list = scene_list_.sublist("Combinations");
  const std::vector<std::string>& cases = scene_.load_cases;
  const std::string stage = "Stage ";
  const auto read_one = [&](const std::string& name, const InputPlace& place) {
    if (const Problem problem = file_name_problem(name); !problem.empty()) throw place.error("name " + problem);
    if (std::find(cases.begin(), cases.end(), name) != cases.end())
      throw place.error("the name of a load case too; allowed: names that differ");
    Combination& combination = scene_.combinations.emplace_back();
    combination.name = name;
    for (const std::string& entry : names_of(list.sublist(name))) {
      const double factor = list.sublist(name).get<double>(entry);
      int number = 0;
      const bool is_case = std::find(cases.begin(), cases.end(), entry) != cases.end();
      const bool is_stage = entry.rfind(stage, 0) == 0 && parse_number(entry.substr(stage.size()), number).empty();
      if (is_case)
        combination.cases.emplace_back(entry, factor);
      else if (is_stage && number >= 1)
        combination.stages.emplace_back(number, factor);
      else
        throw place[entry].error("not a load case of the scene; allowed: names in \"Load Cases\": " +
                                 quoted_list(cases) + ", or \"Stage 1\", ..." + did_you_mean(entry, cases));
    }
  };
  for (const std::string& name : names_of(list)) {
    const InputPlace place = place_["Combinations"][name];
    place.attempt([&] { read_one(name, place); });
  }
}

/// Modes of buckling belong to the loads of one of several cases.
void ConditionReader::check_case_of_modes() const {
  const std::vector<std::string> known = alternatives(scene_);
  const std::string& chosen = scene_.imperfection_case;
  const InputPlace place = place_["Imperfection"]["Case"];
  if (chosen.empty() && !known.empty() && !scene_.imperfection_modes.empty())
    throw place.error("missing; needed with \"Modes\", one of: " + quoted_list(known));
  if (chosen.empty() || std::find(known.begin(), known.end(), chosen) != known.end()) return;
  throw place.error("value \"" + excerpt(chosen) + "\" is not a load case or combination of the scene; allowed: " +
                    (known.empty() ? "none, the scene has no load cases" : quoted_list(known)) +
                    did_you_mean(chosen, known));
}

void ConditionReader::check_schedule(Stage stage, const std::string& amplitude, const std::string& load_case,
                                     const List& list, const InputPlace& place) {
  const std::vector<std::string>& cases = scene_.load_cases;
  if (list.isParameter("Case") && std::find(cases.begin(), cases.end(), load_case) == cases.end()) {
    throw place["Case"].error("value \"" + excerpt(load_case) +
                              "\" is not a load case of the scene; allowed: names in \"Load Cases\": " +
                              quoted_list(cases) + did_you_mean(load_case, cases));
  }
  if (list.isParameter("Amplitude")) {
    checked_formula(amplitude, {"t"}, place["Amplitude"]);
    amplitudes_.emplace_back(amplitude, place["Amplitude"]);
  }
  stages_used_.push_back({amplitude.empty() ? stage : 1, stage, load_case, place["Stage"]});
}

void ConditionReader::check_stages() {
  std::stable_sort(stages_used_.begin(), stages_used_.end(),
                   [](const UsedStage& a, const UsedStage& b) { return a.first < b.first; });
  std::vector<std::string> cases = scene_.load_cases;
  if (cases.empty()) cases.emplace_back();
  for (const std::string& load_case : cases) check_stages_of_case({load_case});
  for (const Combination& combination : scene_.combinations) {
    std::set<std::string> acting;
    for (const auto& [load_case, factor] : combination.cases) acting.insert(load_case);
    check_stages_of_case(acting);
  }
  scene_.stages = stages_in_use(scene_);
  for (const Combination& combination : scene_.combinations)
    for (const auto& [stage, factor] : combination.stages)
      if (stage > scene_.stages)
        throw place_["Combinations"][combination.name]["Stage " + std::to_string(stage)].error(
            "nothing acts in this stage; allowed: 1 to " + std::to_string(scene_.stages));
}

void ConditionReader::check_stages_of_case(const std::set<std::string>& acting) const {
  Stage last = 0;
  for (const UsedStage& used : stages_used_) {
    if (!used.load_case.empty() && acting.count(used.load_case) == 0) continue;
    if (used.first > last + 1) {
      const std::vector<std::string> names(acting.begin(), acting.end());
      const bool has_case = !names.empty() && !names.front().empty();
      const std::string inside = has_case ? " of load case " + quoted_list(names) : "";
      throw used.place.error("value " + std::to_string(used.first) + ", but nothing acts in stage " +
                             std::to_string(last + 1) + inside + "; allowed: stages 1, 2, 3, ... without gaps");
    }
    last = std::max(last, used.last);
  }
}

void ConditionReader::check_amplitudes() const {
  std::vector<std::vector<double>> samples;
  for (int i = 0; i <= kSamplesPerStage * scene_.stages; ++i)
    samples.push_back({static_cast<double>(i) / kSamplesPerStage});
  std::set<std::string> checked;  // many loads may share one
  for (const auto& [text, place] : amplitudes_) {
    if (!checked.insert(text).second) continue;
    check_finite(checked_formula(text, {"t"}, place), {"t"}, samples, place);
  }
}

std::vector<std::string> ConditionReader::points_meant(const List& list, const InputPlace& list_place) {
  const InputPlace place = list_place["Point"];
  const auto& text = list.get<std::string>("Point");
  if (names_.members_at(text) != nullptr) {
    count(1, place);
    return {text};
  }
  if (names_.has_point(text)) {
    if (place.source().has_mistakes()) return {text};  // a member with one of them may be meant to touch it
    throw place.error("value \"" + excerpt(text) + "\": no member starts or ends there; allowed: points of members");
  }
  const std::vector<std::string> points = has_wildcard(text) && text.size() <= kLongestPattern
                                              ? names_meant(text, names_.point_names())
                                              : std::vector<std::string>{};
  const std::string what = names_.member(text) == nullptr ? "point" : "point, but a member,";
  if (points.empty()) throw unknown_name(place, what, text, names_.point_names());
  count(points.size(), place);
  return points;
}

std::vector<const Member*> ConditionReader::members_meant(const List& list, const InputPlace& list_place) {
  const InputPlace place = list_place["Member"];
  const auto& text = list.get<std::string>("Member");
  std::vector<const Member*> members;
  if (const Member* const member = names_.member(text))
    members.push_back(member);
  else if (text.size() <= kLongestPattern)
    for (const std::string& name : names_meant(text, names_.member_names())) members.push_back(names_.member(name));
  const std::string what = names_.has_point(text) ? "member, but a point," : "member";
  if (members.empty()) throw unknown_name(place, what, text, names_.member_names());
  count(members.size(), place);
  return members;
}

void ConditionReader::count(std::size_t more, const InputPlace& place) {
  conditions_ += more;
  if (conditions_ <= kMostConditions) return;
  throw place.error("brings the scene to " + std::to_string(conditions_) +
                    " loads and supports; allowed: " + std::to_string(kMostConditions));
}

void ConditionReader::check_any_given(const List& list, const std::vector<std::string>& parameters,
                                      const std::string& problem, const InputPlace& place) const {
  const bool any = std::any_of(parameters.begin(), parameters.end(),
                               [&](const std::string& parameter) { return is_given(list, parameter); });
  if (!any) throw place.error(problem + "; allowed: one or more of " + quoted_list(parameters));
}

}  // namespace mixbeam
