/// `mixbeam batch FOLDER`: the scenes of a folder, one row of a table for each structure and load case.
#pragma once

#include "apps/common/session/command_line.hpp"

namespace mixbeam {

/// Reads all scenes of the folder that the command line names before the first is solved; then solves each by itself,
/// shared out over the ranks of mpirun, and writes <output>/<folder>-batch.csv and .h5. Returns the exit code. Throws
/// InputError for a scene that is refused, and as conclude_batch().
int structures_batch(const CommandLine& line);

}  // namespace mixbeam
