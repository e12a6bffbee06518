/// Names that the results of a run can bear: a scene with others is refused before it runs, not when it writes.
#pragma once

#include "discretization/text/number_text.hpp"

#include <string>

namespace mixbeam {

/// Why this cannot name an entry of a result file (HDF5 takes names for paths), and what is allowed; empty if it can.
Problem result_name_problem(const std::string& name);

/// The same for a name that becomes part of the names of files.
Problem file_name_problem(const std::string& name);

}  // namespace mixbeam
