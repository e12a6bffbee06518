/// The manual page of the parameters, generated from their declaration.
#pragma once

#include "discretization/parameter_spec.hpp"

#include <ostream>
#include <string>

namespace mixbeam {

/// The complete tree below a list called `name`: every parameter with its type, default, range and meaning.
void print_parameters(std::ostream& out, const ListSpec& spec, const std::string& name = "");

}  // namespace mixbeam
