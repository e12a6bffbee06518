/// Checking what a user wrote against the declaration of the parameters.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>
#include <vector>

namespace mixbeam {

/// Why the parameter cannot have this value, and what is allowed; empty if it can.
Problem problem_of(const ParameterValue& value, const ParameterSpec& spec);

/// A value that stands in place of a mistake so that others are found; none where any text could be meant.
ParameterValue something_allowed(const ParameterSpec& spec);

/// Fills in the defaults and converts whole numbers given for reals. Throws InputError for an unknown name, a wrong
/// type, a value out of range or not among the choices, and for anything required that is missing; the message holds
/// `file:line: XML path "...": what was seen; allowed: ...; did you mean "..."?`. A second call changes nothing.
/// `path`: where `list` stands below the root of `source`. All mistakes are found; inside ParameterSource::collect()
/// they wait, and the list holds something allowed in their place, as far as the declaration tells what.
///
/// `keep_formulas`: formulas stand in place of numbers as they are, for who only writes the list somewhere else.
///
/// Takes out parameters that earlier versions had and returns a warning of each, `file:line: XML path "...": ...`.
std::vector<std::string> validate(Teuchos::ParameterList& list, const ListSpec& spec, const ParameterSource& source,
                                  const ParameterPath& path = {}, bool keep_formulas = false);

}  // namespace mixbeam
