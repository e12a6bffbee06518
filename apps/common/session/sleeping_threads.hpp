/// How threads wait for one another.
#pragma once

namespace mixbeam {

/// Threads that wait at the end of a loop sleep after microseconds in place of spinning for milliseconds: on a machine
/// that has other things to do, spinning threads hold the cores that the working ones wait for. A program's choice, not
/// the library's; does nothing where the user has made one (OMP_WAIT_POLICY, GOMP_SPINCOUNT).
void let_waiting_threads_sleep();

}  // namespace mixbeam
