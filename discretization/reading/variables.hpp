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
  /// Of what stands wrong in a formula: the error at the place of the formula.
  using Refusal = std::function<InputError(const std::string& problem)>;

  /// `scene`: the list "Scene" at `path`, not validated yet.
  Variables(const Teuchos::ParameterList& scene, const ParameterSource& source, const ParameterPath& path = {"Scene"});

  /// Puts its value in place of each formula in the list, and the values of variables into formulas of s, x and t. An
  /// entry remembers its formula (value.hpp): resolving again takes the values that variables have by then. Formulas
  /// that are none, unknown names, what needs itself and what is not finite are mistakes that the source keeps; numbers
  /// stand in their place, and what follows from these is no mistake of its own.
  void resolve(Teuchos::ParameterList& list, const ListSpec& spec, const ParameterPath& path);

  /// The value of this type that formulas stand for: a number, or an array in which some entries may be formulas.
  ParameterValue value(const ParameterValue& written, ParameterType type, const Refusal& refusal);

 private:
  /// A variable, or a coordinate of a point.
  struct Named {
    std::string text{};
    Refusal refusal{};  ///< at the place of the text
    std::optional<double> value{};
    bool is_open = false;   ///< its text is being evaluated
    bool is_guess = false;  ///< it follows from a mistake
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
  std::vector<std::string> open_;            ///< names whose texts are being evaluated
  bool is_guess_ = false;                    ///< what is being evaluated follows from a mistake
};

/// Sets a number of an entry, that of `component` in an array, in place of its formula.
void set_number(Teuchos::ParameterEntry& entry, int component, double value);

/// Puts a formula in the place of that number.
void set_formula(Teuchos::ParameterEntry& entry, int component, const std::string& formula);

/// Paths of all formulas in the list.
std::vector<ParameterPath> paths_of_formulas(const Teuchos::ParameterList& list, const ParameterPath& path);

}  // namespace mixbeam
