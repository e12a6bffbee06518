/// Values of parameters: their types, as text, and as entries of a Teuchos list.
#pragma once

#include "discretization/text/number_text.hpp"

#include <Teuchos_Array.hpp>
#include <Teuchos_ParameterList.hpp>

#include <string>
#include <variant>
#include <vector>

namespace mixbeam {

/// No array of booleans: Teuchos cannot store one.
enum class ParameterType { boolean, integer, real, text, integer_array, real_array, text_array };

/// The alternatives stand in the order of ParameterType, after the empty one.
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

/// What an attribute of XML or a cell of a table says: `text`, `0.5`, `true`, `{1, 2, 3}`.
std::string attribute_text(const ParameterValue& value);
/// Reads it: `text`, `0.5`, `true`, `{1, 2, 3}`.
Problem parse_value(const std::string& text, ParameterType type, ParameterValue& value);

/// The value of an entry; empty for a type that XML cannot express (a list that the program made itself).
ParameterValue value_of(const Teuchos::ParameterEntry& entry);

/// `as_default`: the list remembers that this value was not given.
void set_value(Teuchos::ParameterList& list, const std::string& name, const ParameterValue& value,
               bool as_default = false);

}  // namespace mixbeam
