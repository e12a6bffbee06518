/// Names allowed in the results of a run: a scene with others is refused before it runs, not when it writes.
#pragma once

#include "discretization/text/number_text.hpp"

#include <string>
#include <vector>

namespace mixbeam {

/// Time series of every run, in order; monitored quantities must have other names.
inline const std::vector<std::string> kOwnTimeSeries = {
    "step", "load_factor", "newton_iterations", "residual", "strain_energy", "force_energy", "moment_energy"};
/// Time series of paths that may jump: number of jumps so far, then the jump that led to the step, zeros if none.
inline const std::vector<std::string> kJumpSeries = {"jumps", "jump.energy_released", "jump.motion",
                                                     "jump.largest_displacement"};
bool is_own_time_series(const std::string& name);

/// Time series of all numbers that the list "Quantities" requests; the header of the file names its columns.
inline constexpr const char* kQuantitySeries = "quantities";
inline constexpr const char* kQuantityUnits = "quantity_units";

/// Group of an envelope over several runs, and the text beside it that lists them, one per line.
inline constexpr const char* kEnvelope = "envelope";
inline constexpr const char* kEnvelopeRuns = "runs";

/// Reason why `name` cannot name an entry of a result file (HDF5 reads names as paths), and what is allowed; or empty.
Problem result_name_problem(const std::string& name);

/// Reason why `name` cannot be part of file names, and what is allowed; or empty.
Problem file_name_problem(const std::string& name);

}  // namespace mixbeam
