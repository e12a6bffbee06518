/// Variables of a scene, and formulas of them in place of numbers: `=2*L*sin(theta) + x("tip")`.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/reading/import.hpp"

#include <Teuchos_ParameterList.hpp>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mixbeam {

/// Declaration of the list "Variables".
ListSpec variables_spec();

class Variables {
 public:
  /// Makes the error for a mistake in a formula, at the place of the formula.
  using Refusal = std::function<InputError(const std::string& problem)>;

  /// `scene`: the list "Scene" at `path`, not validated yet.
  Variables(const Teuchos::ParameterList& scene, const ParameterSource& source, const ParameterPath& path = {"Scene"});

  /// Replaces each formula in the list by its value, and variables in formulas of s, x and t by theirs. An entry
  /// remembers its formula (value.hpp): resolving again takes the current values of variables. Invalid formulas,
  /// unknown names, circular references and results that are not finite are mistakes kept by the source; numbers
  /// replace them, and their consequences are not reported.
  void resolve(Teuchos::ParameterList& list, const ListSpec& spec, const ParameterPath& path);

  /// Value of this type: a number, or an array in which some entries may be formulas.
  ParameterValue value(const ParameterValue& written, ParameterType type, const Refusal& refusal);

 private:
  /// A variable, or a coordinate of a point.
  struct Named {
    std::string text{};
    Refusal refusal{};  ///< makes errors at the place of the text
    std::optional<double> value{};
    bool is_open = false;   ///< its text is being evaluated
    bool is_guess = false;  ///< depends on a mistake
  };

  double evaluated(const std::string& text, ParameterType type, const Refusal& refusal);
  double number(const std::string& text, ParameterType type, const Refusal& refusal);
  double value_of(const std::string& name, Named& named);
  double variable(const std::string& name);
  double coordinate(int axis, const std::string& point);
  void read_points();
  void check_name(const std::string& name, const InputPlace& place) const;
  void resolve(Teuchos::ParameterEntry& entry, const ParameterSpec& spec, const ParameterPath& path);
  std::string with_values(const std::string& formula);

  const Teuchos::ParameterList& scene_;
  const InputPlace place_;
  std::vector<std::string> names_, points_;  ///< of variables; of points, read by the first formula that asks for one
  std::map<std::string, Named> named_;       ///< "L", "x(tip)"
  std::optional<ImportTable> table_;         ///< of points
  std::vector<std::string> open_;            ///< names whose texts are being evaluated, outermost first
  bool is_guess_ = false;                    ///< the current result depends on a mistake
};

/// Sets a number of an entry, or that of `component` in an array, in place of its formula.
void set_number(Teuchos::ParameterEntry& entry, int component, double value);

/// Sets a formula in place of that number.
void set_formula(Teuchos::ParameterEntry& entry, int component, const std::string& formula);

/// Paths of all formulas in the list.
std::vector<ParameterPath> paths_of_formulas(const Teuchos::ParameterList& list, const ParameterPath& path);

}  // namespace mixbeam
