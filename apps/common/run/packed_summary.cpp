#include "apps/common/run/summary.hpp"

#include <nlohmann/json.hpp>

namespace mixbeam {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CheckedQuantity, name, value, reference, source, tolerance, comparison, pass, word,
                                   remark)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EstimatedErrors::Quantity, name, error, relative)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EstimatedErrors, run, not_estimated, quantities)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ChosenMesh::Members, names, count, order, elements)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ChosenMesh::Round, elements, followed, steps, iterations, seconds, error, remark)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ChosenMesh, run, wanted, estimated, outcome, members, rounds)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FollowedQuantity, run, name, value, at_largest_size, load_factor_of_largest_size,
                                   step_of_largest_size, member, arc_length, side, error, not_estimated)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RecordedJump, from, to, released, motion, largest, place, factorizations)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EndOfRun, run, load_factor, stable, held, negative, has_potential, jumps)

namespace {

template <class List>
void append_to(List& list, const nlohmann::json& more) {
  for (auto& one : more.get<List>()) list.push_back(std::move(one));
}

}  // namespace

// CBOR keeps every bit of a number, and those that are not finite.
std::string Summary::packed() const {
  const nlohmann::json json = {{"load_steps", load_steps}, {"newton_iterations", newton_iterations},
                               {"warnings", warnings},     {"ends", ends},
                               {"quantities", quantities}, {"errors", estimated_errors},
                               {"meshes", chosen_meshes},  {"seconds", seconds},
                               {"checks", checks_}};
  std::string bytes;
  nlohmann::json::to_cbor(json, bytes);
  return bytes;
}

void Summary::append(const std::string& packed) {
  const nlohmann::json json = nlohmann::json::from_cbor(packed);
  load_steps += json["load_steps"].get<int>();
  newton_iterations += json["newton_iterations"].get<int>();
  append_to(warnings, json["warnings"]);
  append_to(ends, json["ends"]);
  append_to(quantities, json["quantities"]);
  append_to(estimated_errors, json["errors"]);
  append_to(chosen_meshes, json["meshes"]);
  append_to(checks_, json["checks"]);
  for (const auto& [phase, time] : json["seconds"].get<std::map<std::string, double>>()) seconds[phase] += time;
}

}  // namespace mixbeam
