#include "apps/common/session/guarded_run.hpp"

#include "discretization/results/result_file.hpp"
#include "discretization/text/errors.hpp"

#include <mpi.h>

#include <Teuchos_CommHelpers.hpp>

#include <iostream>
#include <stdexcept>

namespace mixbeam {

int guarded_run(const Communicator& communicator, const std::string& program, const std::function<int()>& action) {
  const auto complain = [&](const char* kind, const char* what, int code) {
    if (communicator->getRank() == 0) std::cerr << program << ": " << kind << ": " << what << "\n" << std::flush;
    return code;
  };
  // What may have happened on one rank only: the others would wait for it for ever.
  const auto complain_alone = [&](const char* kind, const char* what, int code) {
    if (communicator->getSize() == 1) return complain(kind, what, code);
    std::cerr << program << ", rank " << communicator->getRank() << ": " << kind << ": " << what << "\n" << std::flush;
    MPI_Abort(MPI_COMM_WORLD, code);
    return code;
  };
  try {
    return action();
  } catch (const InputError& error) {
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
    return complain_alone("unforeseen error", error.what(), kFailedExitCode);
  } catch (const char* error) {  // NOX and LOCA throw texts
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
