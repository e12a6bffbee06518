/// Values of parameters: their types, as text, and as entries of a Teuchos list.
#pragma once

#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <Teuchos_Array.hpp>
#include <Teuchos_ParameterList.hpp>

#include <string>
#include <variant>
#include <vector>

namespace mixbeam {

/// No array of booleans: Teuchos cannot store one.
enum class ParameterType { boolean, integer, real, text, integer_array, real_array, text_array };

/// The alternatives are in the order of ParameterType, after the empty one.
using ParameterValue = std::variant<std::monostate, bool, int, double, std::string, Teuchos::Array<int>,
                                    Teuchos::Array<double>, Teuchos::Array<std::string>>;

/// Types as written in XML, `Array(double)`, in the order of ParameterType.
const std::vector<std::string>& xml_names();
inline const std::string& xml_name(ParameterType type) { return xml_names()[static_cast<std::size_t>(type)]; }

inline bool is_array(ParameterType type) { return type >= ParameterType::integer_array; }

inline bool has_type(const ParameterValue& value, ParameterType type) {
  return value.index() == static_cast<std::size_t>(type) + 1;
}

/// `"text"`, `0.5`, `true`, `{1, 2, 3}`.
std::string to_text(const ParameterValue& value);

/// Text of a value in an XML attribute or a cell of a table: `text`, `0.5`, `true`, `{1, 2, 3}`.
std::string attribute_text(const ParameterValue& value);
/// Parses such a text; a number may be a formula.
Problem parse_value(const std::string& text, ParameterType type, ParameterValue& value);

/// The value of an entry; empty for a type that XML cannot express (a list that the program made itself).
ParameterValue value_of(const Teuchos::ParameterEntry& entry);

/// `as_default`: the list remembers that this value was not given.
void set_value(Teuchos::ParameterList& list, const std::string& name, const ParameterValue& value,
               bool as_default = false);

/// Names of all entries, in the order of the file.
inline std::vector<std::string> names_of(const Teuchos::ParameterList& list) {
  std::vector<std::string> names;
  for (auto entry = list.begin(); entry != list.end(); ++entry) names.push_back(list.name(entry));
  return names;
}

/// Whether the user gave this parameter, as opposed to its default; or this list.
inline bool is_given(const Teuchos::ParameterList& list, const std::string& name) {
  return list.isSublist(name) || (list.isParameter(name) && !list.getEntry(name).isDefault());
}

inline Vector3 get_vector(const Teuchos::ParameterList& list, const std::string& name) {
  const auto& values = list.get<Teuchos::Array<double>>(name);
  return {values[0], values[1], values[2]};
}

/// Whether a text is a formula in place of a number: `=2*L`. For its value see reading/variables.hpp.
bool is_formula(const std::string& text);
/// Whether a value is a formula, or an array with one.
bool holds_formula(const ParameterValue& value);

/// Entry as written, with its formulas. Once a formula is evaluated, the entry keeps type and formula in its
/// documentation: `double =2*L`.
struct WrittenValue {
  std::string type{};  ///< in XML; empty: that of the value, or unknown
  ParameterValue value;
};
WrittenValue written_value(const Teuchos::ParameterEntry& entry);
/// Sets the value (number, text, array) that `written` evaluates to.
void set_result(Teuchos::ParameterEntry& entry, const ParameterValue& result, const WrittenValue& written);

}  // namespace mixbeam
