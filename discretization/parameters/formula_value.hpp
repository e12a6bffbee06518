/// Formulas in place of numbers, as they are written: `=2*L`. What they say: reading/variables.hpp.
#pragma once

#include "discretization/parameters/spec.hpp"

namespace mixbeam {

/// Whether it stands in place of a number: `=2*L`.
bool is_formula(const std::string& text);
/// The same of a value, in an array of any entry.
bool holds_formula(const ParameterValue& value);

/// Whether it stands in place of what the parameter declares. A number with other words takes any text for a formula.
bool stands_for_number(const ParameterValue& value, const ParameterSpec& spec);

/// An entry as it was written, formulas in it. Behind the number that a formula has become, the entry keeps both in its
/// documentation: `double =2*L`.
struct WrittenValue {
  std::string type{};  ///< in XML; empty: that of the value, or nobody said it
  ParameterValue value;
};
WrittenValue written_value(const Teuchos::ParameterEntry& entry);
/// The number (text, array) that `written` has become.
void set_result(Teuchos::ParameterEntry& entry, const ParameterValue& result, const WrittenValue& written);

}  // namespace mixbeam
