/// The paper's study of the arc under a force out of its plane: tip displacement for slenderness, order and mesh, and
/// convergence of the displacement.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Declaration of the list "Study".
ListSpec arc_spec();

/// Records the arc at three slendernesses (single_rho*.h5), compares with the paper's table (table.csv) and with
/// independent values, checks Newton's iterations up to the rigid limit, and the rates of convergence
/// (convergence.csv).
void run_arc_study(Application& app);

}  // namespace mixbeam
