/// The manual page of the parameters, generated from their declaration.
#pragma once

#include "discretization/parameters/spec.hpp"

#include <ostream>
#include <string>

namespace mixbeam {

/// The complete tree below a list called `name`: every parameter with its type, default, range and meaning.
void print_parameters(std::ostream& out, const ListSpec& spec, const std::string& name = "");

/// The same as a page of Markdown: title and introduction (itself Markdown), links to the outer lists, then a heading
/// for each list and a table of its parameters. The root has no parameters of its own.
void print_parameters_markdown(std::ostream& out, const ListSpec& spec, const std::string& title,
                               const std::string& introduction);

}  // namespace mixbeam
