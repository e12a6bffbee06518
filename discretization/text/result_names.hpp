/// Names that the results of a run can bear: a scene with others is refused before it runs, not when it writes.
#pragma once

#include "discretization/text/number_text.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Time series that every run has, in their order; what is monitored bears other names.
inline const std::vector<std::string> kOwnTimeSeries = {
    "step", "load_factor", "newton_iterations", "residual", "strain_energy", "force_energy", "moment_energy"};
/// Those of paths that may jump: how often so far; of the jump with which a step was made, zero where there was none.
inline const std::vector<std::string> kJumpSeries = {"jumps", "jump.energy_released", "jump.motion",
                                                     "jump.largest_displacement"};
bool is_own_time_series(const std::string& name);

/// The series of all numbers that the list "Quantities" of a scene asks for; the header of the file names them.
inline constexpr const char* kQuantitySeries = "quantities";
inline constexpr const char* kQuantityUnits = "quantity_units";

/// The group of an envelope of several runs, and the text beside it that names them, one to a line.
inline constexpr const char* kEnvelope = "envelope";
inline constexpr const char* kEnvelopeRuns = "runs";

/// Why this cannot name an entry of a result file (HDF5 takes names for paths), and what is allowed; empty if it can.
Problem result_name_problem(const std::string& name);

/// The same for a name that becomes part of the names of files.
Problem file_name_problem(const std::string& name);

}  // namespace mixbeam
