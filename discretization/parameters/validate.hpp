/// Checks of the input against the declaration of its parameters.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>
#include <vector>

namespace mixbeam {

/// Reason why the parameter cannot have this value, and what is allowed; empty if it can.
Problem problem_of(const ParameterValue& value, const ParameterSpec& spec);

/// Value put in place of a mistake so that others are found; empty if any text could be meant.
ParameterValue something_allowed(const ParameterSpec& spec);

/// Fills in the defaults and converts whole numbers given for reals. Throws InputError for an unknown name, a wrong
/// type, a value out of range or not among the choices, and for a missing required entry; the message holds `file:line:
/// XML path "...": what was seen; allowed: ...; did you mean "..."?`. A second call changes nothing. `path`: place of
/// `list` below the root of `source`. All mistakes are found; inside ParameterSource::collect() they are kept, and the
/// list holds allowed values in their place where the declaration determines one.
///
/// `keep_formulas`: leaves formulas in place of numbers, for callers that only write the list elsewhere.
///
/// Removes parameters of earlier versions and returns a warning for each, `file:line: XML path "...": ...`.
std::vector<std::string> validate(Teuchos::ParameterList& list, const ListSpec& spec, const ParameterSource& source,
                                  const ParameterPath& path = {}, bool keep_formulas = false);

}  // namespace mixbeam
