#include "apps/common/run/room_check.hpp"

#include "apps/common/session/guarded_run.hpp"
#include "apps/common/session/machine_room.hpp"
#include "discretization/text/errors.hpp"

#include <mpi.h>

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>

namespace mixbeam {

namespace {

/// Runs of up to so many elements, members and quantities need less memory than the program itself.
constexpr long long kSmall = 2000;

/// Bytes per number of a quantity: names, places, values in tables and buffers. Measured 514 bytes with 60,006 names of
/// 8 letters.
constexpr double kMemoryOfQuantity = 700.0;
/// Bytes in the file: its name, and space for its values in 64 steps. Measured 523 bytes, likewise.
constexpr double kFileOfQuantity = 550.0;

bool is_small(const Application& app, const Scene& scene) {
  return elements_of(scene) <= kSmall && static_cast<long long>(scene.members.size()) <= kSmall &&
         static_cast<long long>(app.quantities.columns().size()) <= kSmall;
}

/// Fraction of all ranks that run on this machine.
double share_of_this_machine(const Communicator& communicator) {
  if (communicator->getSize() == 1) return 1.0;
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  int ranks = 1;
  MPI_Comm_size(here, &ranks);
  MPI_Comm_free(&here);
  return static_cast<double>(ranks) / communicator->getSize();
}

std::string counts_of(const Needs& needs) {
  return std::to_string(needs.elements) + " elements, " + std::to_string(needs.unknowns()) + " unknowns";
}

[[noreturn]] void refuse(const Application& app, const std::string& problem, const std::string& allowed) {
  const std::string text = problem + "; allowed: " + allowed + ", or --force to run it anyway";
  if (app.xml.source.line({"Scene"}) > 0) throw app.xml.source.error({"Scene"}, text);
  throw InputError(text);
}

void require_disk(const Application& app, const Needs& needs, const std::filesystem::path& file) {
  constexpr double kCopies = 2.0;
  const double wanted = kCopies * (needs.file + needs.steps * needs.file_per_step);
  on_first_rank(app.communicator, [&] {
    std::error_code none;
    const auto present = std::filesystem::file_size(file, none);  // an existing file, which the first copy replaces
    const double room = disk_left(file.parent_path()) + (none ? 0.0 : static_cast<double>(present));
    if (wanted <= room) return;
    refuse(app,
           "needs about " + bytes_text(wanted) + " of disk for the result file " + file.string() + ", " +
               std::to_string(needs.steps) + " or more steps in two copies, " + bytes_text(room) + " available",
           "fewer elements, lower orders, fewer steps, or another folder (--output)");
  });
}

}  // namespace

Needs needs_of_run(const Application& app, const Scene& scene, const SolverParameters& parameters) {
  Needs needs = needs_of(scene, parameters);
  const auto numbers = static_cast<double>(app.quantities.columns().size());
  needs.memory += kMemoryOfQuantity * numbers;
  needs.file += kFileOfQuantity * numbers;
  needs.file_per_step += sizeof(double) * numbers;
  return needs;
}

void require_memory(const Application& app, double bytes, const std::string& what, Communicator ranks) {
  if (app.force) return;
  if (ranks.is_null()) ranks = app.communicator;
  const double wanted = bytes * share_of_this_machine(ranks);
  const Room room = memory_left();
  const double lacking = wanted - room.bytes;
  double most_lacking = lacking;
  Teuchos::reduceAll(*ranks, Teuchos::REDUCE_MAX, lacking, Teuchos::outArg(most_lacking));
  if (most_lacking <= 0.0) return;
  refuse(app,
         "needs about " + bytes_text(wanted) + " of memory for " + what + ", " +
             bytes_text(std::max(0.0, wanted - most_lacking)) + " available (" + room.limit + ")",
         "fewer elements, lower orders, fewer cases, or more memory");
}

void require_memory(const Application& app, const Scene& scene, const Needs& needs) {
  const int ranks = app.communicator->getSize();
  if (!is_small(app, scene)) require_memory(app, ranks * needs.memory_of_rank(ranks), counts_of(needs));
}

void require_room(const Application& app, const Scene& scene, const SolverParameters& parameters,
                  const std::filesystem::path& file) {
  if (is_small(app, scene)) return;
  const Needs needs = needs_of_run(app, scene, parameters);
  take_large_pages(needs.memory_of_rank(app.communicator->getSize()));
  if (app.force) return;
  require_memory(app, scene, needs);
  if (!file.empty()) require_disk(app, needs, file);
}

}  // namespace mixbeam
