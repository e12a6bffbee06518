/// The result file of a run: HDF5 for programs, with an XDMF description beside it for ParaView and VisIt.
///
/// Layout (doubles are little-endian IEEE; n is the number of samples of all members together):
///
///     /                         attributes format, format_version, scene_name
///     /scene, /version          the input XML and the program's version, as text
///     /imported/0, 1, ...       files that the input names: attribute name, dataset text
///     /properties               attributes: compiler, threads, ... as the caller names them
///     /quantities               names of the columns of /monitor/quantities, one to a line; only where the scene asks
///                               for quantities
///     /quantity_units           of these columns, empty where there is none; only where the scene names units
///     /members                  names, first_sample, samples, points_per_element, order, elements (members);
///                               arc_length, element (n), reference_position (n,3). Before format 4 a group for each:
///                               /members/<name> with these numbers and index as attributes
///     /supports/0, 1, ...       attribute point
///     /acting                   attribute units, where the scene names them; tables of all that acts, by columns, text
///                               with a line for each row. place: (member, arc length); begins: load factor, NaN for
///                               an amplitude; follower: 1 where components are in a triad
///     /acting/supports          point, place, position, axes (.,9), fixed, stiffness, prescribed (.,6: displacement,
///                               rotation, along the axes), begins: of prescribed motions
///     /acting/joints            name, point, kind, place (on the member joined), position, axis, stiffness
///     /acting/point_loads       point, place, position, force, moment, follower, begins
///     /acting/line_loads        member, force, couple (.,27: at 9 places from start to end), follower, begins
///     /acting/eigenstrains      member, strain, curvature (.,27: likewise), begins
///     /polyline/connectivity    XDMF mixed topology: for each member 2, its number of samples, their numbers
///     /steps/000001             attributes step, load_factor, newton_iterations, residual, strain_energy,
///                               force_energy, moment_energy; position, displacement, force_strain, moment_strain,
///                               material_force, material_moment, spatial_force, spatial_moment, triad_1, triad_2,
///                               triad_3 (n,3), triad (n,4: w,x,y,z); largest_normal_stress, largest_shear_stress,
///                               von_mises_stress, utilisation (n; NaN: section without shape, material without
///                               strength) where asked for and where some material has one; residual_history
///                               (iterations,3: attempt, iteration, scaled maximum norm); reactions (supports,6: force,
///                               moment), balance (2,6: applied force and moment, those of the reactions) and
///                               attributes force_balance_error, moment_balance_error attribute stable: "true",
///                               "false", "neutral" or "unknown"; stable_held: the same with the controlled
///                               displacement held, where known; where stability is looked at: negative_eigenvalues,
///                               and has_potential = 0 for loads without a potential
///     /steps/000001/jump        where the step is a jump: attributes of RecordedJump
///     /steps/000001/critical_points/0, 1, ...
///                               limit points and bifurcations since the step before: attributes kind, load_factor,
///                               negative_before, negative_after, modes; position, displacement, mode (n,3); monitor:
///                               what is monitored there; state
///     /steps/000001/error_estimate
///                               of the state at the end of the path, where asked for: attributes
///                               largest_displacement_error, .._size, the same of displacement, moment, energy;
///                               vertex_displacement (vertices,3), element_displacement, element_moment (elements);
///                               points: one (3) for each point that is followed; quantities and sections, where
///                               there are any: names and not_estimated (why not; empty: estimated), one to a line,
///                               value, error (n; NaN: not estimated); or attribute not_estimated: why not
///     /steps/000001/state       the solver's own numbers, for resuming: see StateSnapshot and PathPoint
///     /buckling/0, 1, ...       linear buckling, where asked for: attributes load_factor, residual, confirmed; mode
///     (n,3) /monitor                  step, load_factor, newton_iterations, residual, the energies and every monitored
///                               quantity, (steps) or (steps,3)
///
/// A run may be killed at any moment: see published_file.hpp.
///
/// Rank 0 alone calls the HDF5 library. It makes room for the large datasets, closes the file and tells where their
/// numbers lie; then each rank writes its rows there by plain system calls, so that neither samples nor states travel.
/// At last rank 0 seals the file (seal.hpp): the bytes are the same for any number of ranks.
#pragma once

#include "discretization/results/disk_file.hpp"
#include "discretization/results/published_file.hpp"
#include "discretization/results/rank_agreement.hpp"
#include "discretization/results/result_lock.hpp"
#include "discretization/results/result_tables.hpp"
#include "discretization/results/stored_run.hpp"
#include "discretization/state/member_samples.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace mixbeam {

/// How a result file is written.
struct WritingOptions {
  SharedResultLock lock{};  ///< of the file, where the caller holds it already
  /// Each step waits until it is on the disk before it is published, so that a power cut loses none. Otherwise only
  /// steps that take long enough do (SyncBudget), and the last one.
  bool durable = false;
};

/// Writes the steps of one run. Every rank owns one: each writes the rows that it holds of the large datasets, rank 0
/// everything else, and all of them see the same folder. What fails on one rank throws the same ResultFileError on
/// every rank. Not for concurrent threads.
class ResultFile {
 public:
  /// Starts an empty file, replacing one of that name. `path` must lie in an existing folder; its extension is free,
  /// and the XDMF file takes the same name with extension `.xdmf`. Throws ResultFileError. Collective.
  ResultFile(const std::filesystem::path& path, ResultHeader header, const Communicator& communicator = one_rank(),
             WritingOptions options = {});

  /// Continues after the last step of a stored run, in its own file. Throws ResultFileError. Collective.
  explicit ResultFile(const StoredRun& run, const Communicator& communicator = one_rank(), WritingOptions options = {});

  /// Removes the second copy and completes the XDMF file, keeping quiet about errors; call `close` to hear of them. Not
  /// collective, for a rank may be alone in leaving by an exception.
  ~ResultFile();

  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  /// Appends a step and publishes it: once this returns, readers of the file see it. On an error (ResultFileError) the
  /// published file keeps the steps it had, and the file takes no more steps.
  /// Members, their samples and monitored names must be those of the first record, and `step` must grow. Collective.
  void append_step(const StepRecord& record);

  /// Brings the XDMF file up to date and removes the second copy; waits until the file is on the disk. Called once;
  /// later calls do nothing. Collective.
  void close();

  const std::filesystem::path& path() const { return path_; }

 private:
  void take_place();
  void or_give_up(const std::function<void()>& step);
  void check_consistent(const StepRecord& record) const;
  void write_step_of(const StepRecord& record);
  void write_xdmf();
  void finish();

  std::filesystem::path path_, xdmf_path_;
  FileRanks ranks_;
  SharedResultLock lock_;  ///< known to rank 0
  PublishedFile file_;
  std::vector<SampledMember> members_;  ///< of every step, those of this rank at least
  std::size_t member_count_ = 0, sample_count_ = 0;
  StepSummary previous_;           ///< describes what is monitored
  std::vector<XdmfStep> labels_;   ///< of all published steps; names of stresses known to rank 0
  std::size_t steps_in_xdmf_ = 0;  ///< known to rank 0
  bool failed_ = false;
  bool closed_ = false;
};

/// For programs that start MPI, before they do. An HDF5 library that is built for MPI closes itself where MPI ends, and
/// there it would try for ever, and say so, to close a damaged file; begun earlier, it is never asked to.
void begin_results_library();

}  // namespace mixbeam
