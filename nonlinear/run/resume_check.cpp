#include "nonlinear/path/load_path.hpp"

namespace mixbeam {

namespace {

/// The first value of a text parameter with this name anywhere below `list` that is among `values`; empty if none is.
std::string find_value(const Teuchos::ParameterList& list, const std::string& name,
                       const std::vector<std::string>& values) {
  for (auto it = list.begin(); it != list.end(); ++it) {
    const Teuchos::ParameterEntry& entry = list.entry(it);
    if (entry.isList()) {
      const std::string found = find_value(list.sublist(list.name(it)), name, values);
      if (!found.empty()) return found;
    } else if (list.name(it) == name && entry.isType<std::string>()) {
      for (const std::string& value : values)
        if (Teuchos::getValue<std::string>(entry) == value) return value;
    }
  }
  return "";
}

bool is_switched_on(const Teuchos::ParameterList& list, const std::string& name) {
  return list.isType<bool>(name) && list.get<bool>(name);
}

}  // namespace

std::string obstacle_to_resuming(const SolverParameters& parameters) {
  if (!parameters.loca.is_null()) {
    const Teuchos::ParameterList& loca = *parameters.loca;
    if (!find_value(loca, "Continuation Method", {"Arc Length"}).empty())
      return "arc length continuation (\"Solver / LOCA / Stepper\") scales its steps by what happened since its start";
    if (!find_value(loca, "Method", {"Secant", "Tangent"}).empty())
      return "the predictor of \"Solver / LOCA / Predictor\" extrapolates from steps before the last one";
    if (loca.isSublist("Stepper") && is_switched_on(loca.sublist("Stepper"), "Enable Tangent Factor Step Size Scaling"))
      return "the step sizes depend on the tangents of steps before the last one (\"Solver / LOCA / Stepper\")";
  }
  if (parameters.status_tests.is_null()) return "";
  const std::string test =
      find_value(*parameters.status_tests, "Test Type", {"NormUpdate", "NormWRMS", "User Defined"});
  if (test.empty()) return "";
  return "the test \"" + test + "\" of \"Solver / Status Tests\" measures all displacements since the start of a stage";
}

}  // namespace mixbeam
