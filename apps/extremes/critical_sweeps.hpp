/// Sweeps of structures whose critical load factors have a closed form.
#pragma once

#include "apps/common/run/application.hpp"

#include <iosfwd>

namespace mixbeam {

/// One value of a sweep, computed.
struct CriticalRow {
  double value = 0.0;
  bool finished = false;
  int expected = 0, found = 0;  ///< critical points
  double error = 0.0;           ///< largest of a load factor, relative; infinity where one is missing
  int negative = -1;            ///< eigenvalues of the last state
  int steps = 0, iterations = 0;
  double processor_seconds = 0.0;
  std::string failure{};
};

struct CriticalSweep {
  std::string name, parameter, what, source;
  std::vector<CriticalRow> rows{};
};

/// The rise of a truss of two bars that snaps through, and the axial stiffness of a rail that is heated to three times
/// its critical temperature and followed on its branch. Checks every load factor. Writes critical.csv.
std::vector<CriticalSweep> run_critical_sweeps(Application& app, int most_values);

/// The section of the page.
void write_critical_sweeps(std::ostream& page, const std::vector<CriticalSweep>& sweeps);

}  // namespace mixbeam
