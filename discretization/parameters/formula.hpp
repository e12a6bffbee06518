/// Formulas of a scene, checked while it is read.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/text/expression.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// The formula that a parameter holds. Throws InputError at `path` for a text that is none, or that uses other names
/// than `variables`.
Expression checked_formula(const std::string& text, const std::vector<std::string>& variables,
                           const ParameterSource& source, const ParameterPath& path);

/// Throws InputError at `path` unless the formula has a finite value at each of the `samples` (one value per variable
/// each). A sample can miss a pole; it finds the slips that matter: a division by s at the start, a root of 1 - x that
/// should have been one of x - 1.
void check_finite(const Expression& formula, const std::vector<std::string>& variables,
                  const std::vector<std::vector<double>>& samples, const ParameterSource& source,
                  const ParameterPath& path);

}  // namespace mixbeam
