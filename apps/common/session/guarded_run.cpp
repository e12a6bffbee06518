#include "apps/common/session/guarded_run.hpp"

#include "discretization/results/result_file.hpp"
#include "discretization/text/errors.hpp"

#include <mpi.h>

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <stdexcept>

#include <dlfcn.h>
#include <sys/auxv.h>
#include <unistd.h>

namespace mixbeam {

namespace {

constexpr const char* kNoMemory = "not enough memory";

/// Describes the failed allocation; Kokkos names the view and its size in several lines.
std::string what_was_wanted(const std::exception& error) {
  std::string text = error.what();
  if (text == std::bad_alloc().what()) return "a part of the program's own data does not fit";
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Whether all ranks arrive here within kPatience. Usually all fail alike, but a file may be unreadable on one machine
/// only, and the other ranks would wait for ever.
bool all_ranks_fail() {
  constexpr double kPatience = 5.0;  // seconds
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  int all = 0;
  for (const double start = MPI_Wtime(); all == 0 && MPI_Wtime() - start < kPatience; usleep(1000))
    MPI_Test(&request, &all, MPI_STATUS_IGNORE);
  return all != 0;
}

std::terminate_handler other_handler = nullptr;

/// Ends the program if bad_alloc cannot be caught: before main, in a destructor, on a thread. Does not allocate.
[[noreturn]] void end_without_memory() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    static constexpr char kText[] = "not enough memory to go on; every completed step is on disk\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kText, sizeof kText - 1);
    _exit(kInputErrorExitCode);
  } catch (...) {
  }
  if (other_handler != nullptr) other_handler();
  std::abort();
}

/// Installs the handler before objects at namespace scope, some of which allocate (lower numbers run first). Only in
/// programs; a host of the library keeps its own handler.
[[gnu::constructor(101)]] void watch_for_lack_of_memory() {
  Dl_info here{}, program{};
  dladdr(reinterpret_cast<void*>(&watch_for_lack_of_memory), &here);
  dladdr(reinterpret_cast<void*>(getauxval(AT_PHDR)), &program);
  if (here.dli_fbase == program.dli_fbase) other_handler = std::set_terminate(end_without_memory);
}

}  // namespace

int guarded_run(const Communicator& communicator, const std::string& program, const std::function<int()>& action) {
  const auto complain = [&](const char* kind, const char* what, int code) {
    if (communicator->getRank() == 0) std::cerr << program << ": " << kind << ": " << what << "\n" << std::flush;
    return code;
  };
  // Reports errors that may occur on one rank only; aborts the others, which would wait for ever.
  const auto complain_alone = [&](const char* kind, const char* what, int code) {
    if (communicator->getSize() == 1) return complain(kind, what, code);
    std::cerr << program << ", rank " << communicator->getRank() << ": " << kind << ": " << what << "\n" << std::flush;
    MPI_Abort(MPI_COMM_WORLD, code);
    return code;
  };
  try {
    return action();
  } catch (const InputError& error) {
    if (communicator->getSize() > 1 && !all_ranks_fail())
      return complain_alone("bad input", error.what(), kInputErrorExitCode);
    return complain("bad input", error.what(), kInputErrorExitCode);
  } catch (const ConvergenceError& error) {
    return complain("no convergence", error.what(), kConvergenceErrorExitCode);
  } catch (const ResultFileError& error) {
    return complain("results cannot be written", error.what(), kInputErrorExitCode);
  } catch (const FileError& error) {
    return complain_alone("results cannot be written", error.what(), kInputErrorExitCode);
  } catch (const std::invalid_argument& error) {
    return complain_alone("bad input", error.what(), kInputErrorExitCode);
  } catch (const std::exception& error) {
    if (is_out_of_memory(error))
      return complain_alone(kNoMemory, (what_was_wanted(error) + "; every completed step is on disk").c_str(),
                            kInputErrorExitCode);
    return complain_alone("unforeseen error", error.what(), kFailedExitCode);
  } catch (const char* error) {  // NOX and LOCA throw string literals
    return complain_alone("unforeseen error", error, kFailedExitCode);
  }
}

void on_first_rank(const Communicator& communicator, const std::function<void()>& action) {
  std::string problem;
  try {
    if (communicator->getRank() == 0) action();
  } catch (const InputError& error) {
    problem = error.what();
  }
  int size = static_cast<int>(problem.size());
  Teuchos::broadcast(*communicator, 0, &size);
  if (size == 0) return;
  problem.resize(size);
  Teuchos::broadcast(*communicator, 0, size, problem.data());
  throw InputError(problem);
}

}  // namespace mixbeam
