/// Output generated from the declaration of the parameters: manual pages, data for programs, schemas for editors.
#pragma once

#include "discretization/parameters/spec.hpp"

#include <ostream>
#include <string>

namespace mixbeam {

/// The complete tree below a list called `name`: every parameter with its type, default, range and meaning.
void print_parameters(std::ostream& out, const ListSpec& spec, const std::string& name = "");

/// Page of Markdown: title and introduction (itself Markdown), links to the outer lists, then a heading for each list
/// and a table of its parameters. The root has no parameters of its own.
void print_parameters_markdown(std::ostream& out, const ListSpec& spec, const std::string& title,
                               const std::string& introduction);

/// JSON for programs. A list has its `path` (a free name as "<point>"), `presence`, `meaning`, its `parameters` and
/// `lists`; if the user names its entries, `free_names` with the `placeholder`, their least number and the declaration
/// of each (`parameter` or `list`); `forms`: for each word, the other entries that it needs and allows.
void print_parameters_json(std::ostream& out, const ListSpec& spec);

/// JSON Schema (draft 7) of files in YAML. It cannot express comparisons of values: ranges that depend on another
/// parameter, references to names, lengths of vectors.
void print_json_schema(std::ostream& out, const ListSpec& spec, const std::string& title);

/// RELAX NG schema of files in XML. Nor can it express that an entry is required, unique, or depends on another: all
/// elements have the same tag.
void print_relax_ng(std::ostream& out, const ListSpec& spec);

/// Identifier of a parameter or list in programs: `Point Loads` is point_loads; symbols (E, EI2, GIt) stay as they are,
/// and keywords of Python get an underscore (import_).
std::string program_name(const std::string& name);

}  // namespace mixbeam
