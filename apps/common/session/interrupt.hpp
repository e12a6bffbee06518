/// Ctrl-C (SIGINT) and SIGTERM ask for an orderly end at the last completed step, within the iteration; where nobody
/// asks for two seconds (inside a library) the program leaves with the same exit code. A second one ends it at once.
#pragma once

#include "discretization/mesh/tpetra_types.hpp"

namespace mixbeam {

/// What shells expect of a program that Ctrl-C ended.
inline constexpr int kInterruptedExitCode = 130;

/// Watches for both signals from now to the end of the program.
void watch_for_interrupts();

/// True on every rank as soon as one of them was asked to stop. Collective.
bool interrupt_requested(const Communicator& communicator);

}  // namespace mixbeam
