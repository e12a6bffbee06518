/// The result file of a run: HDF5 for programs, with an XDMF description beside it for ParaView and VisIt.
///
/// Layout (doubles are little-endian IEEE; n is the number of samples of all members together):
///
///     /                         attributes format, format_version, scene_name
///     /scene, /version          the input XML and the program's version, as text
///     /imported/0, 1, ...       files that the input names: attribute name, dataset text
///     /properties               attributes: compiler, threads, ... as the caller names them
///     /members/<name>           attributes index, first_sample, samples, points_per_element, order, elements;
///                               arc_length, element, reference_position (.,3)
///     /supports/0, 1, ...       attribute point
///     /polyline/connectivity    XDMF mixed topology: for each member 2, its number of samples, their numbers
///     /steps/000001             attributes step, load_factor, newton_iterations, residual, strain_energy,
///                               force_energy, moment_energy; position, displacement, force_strain, moment_strain,
///                               material_force, material_moment, spatial_force, spatial_moment, triad_1, triad_2,
///                               triad_3 (n,3), triad (n,4: w,x,y,z); residual_history (iterations,3: attempt,
///                               iteration, scaled maximum norm); reactions (supports,6: force, moment), balance
///                               (2,6: applied force and moment, those of the reactions) and attributes
///                               force_balance_error, moment_balance_error
///                               attribute stable: "true", "false", "neutral" or "unknown"; stable_held: the same with
///                               the controlled displacement held, where known; where stability is looked at:
///                               negative_eigenvalues, and has_potential = 0 for loads without a potential
///     /steps/000001/critical_points/0, 1, ...
///                               limit points and bifurcations since the step before: attributes kind, load_factor,
///                               negative_before, negative_after, modes; position, displacement, mode (n,3); monitor:
///                               what is monitored there; state
///     /steps/000001/error_estimate
///                               of the state at the end of the path, where asked for: attributes
///                               largest_displacement_error, .._size, the same of displacement, moment, energy;
///                               vertex_displacement (vertices,3), element_displacement, element_moment (elements);
///                               points: one (3) for each point that is followed; or attribute not_estimated: why not
///     /steps/000001/state       the solver's own numbers, for resuming: see StateSnapshot and PathPoint
///     /buckling/0, 1, ...       linear buckling, where asked for: attributes load_factor, residual, confirmed; mode
///     (n,3) /monitor                  step, load_factor, newton_iterations, residual, the energies and every monitored
///                               quantity, (steps) or (steps,3)
///
/// A run may be killed at any moment: the file under its own name is complete and readable at all times. For that, two
/// hidden copies are written in turn, and the name is moved to a copy only after every rank has closed that copy; each
/// step is therefore written twice, and the disk holds two copies until the run ends.
///
/// Rank 0 alone calls the HDF5 library. It makes room for the large datasets, closes the file and tells where their
/// numbers lie; then each rank writes its rows there by plain system calls, so that neither samples nor states travel.
#pragma once

#include "discretization/results/disk_file.hpp"
#include "discretization/results/rank_agreement.hpp"
#include "discretization/results/result_lock.hpp"
#include "discretization/results/result_tables.hpp"
#include "discretization/results/stored_run.hpp"
#include "discretization/state/member_samples.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace mixbeam {

/// Writes the steps of one run. Every rank owns one: each writes the rows that it holds of the large datasets, rank 0
/// everything else, and all of them see the same folder. What fails on one rank throws the same ResultFileError on
/// every rank. Not for concurrent threads.
class ResultFile {
 public:
  /// Starts an empty file, replacing one of that name. `path` must lie in an existing folder; its extension is free,
  /// and the XDMF file takes the same name with extension `.xdmf`. `lock`: that of the file, where the caller holds it
  /// already. Throws ResultFileError. Collective.
  ResultFile(const std::filesystem::path& path, ResultHeader header, const Communicator& communicator = one_rank(),
             SharedResultLock lock = nullptr);

  /// Goes on behind the last step of a stored run, in its own file. Throws ResultFileError. Collective.
  explicit ResultFile(const StoredRun& run, const Communicator& communicator = one_rank(),
                      SharedResultLock lock = nullptr);

  /// Removes the second copy and completes the XDMF file, keeping quiet about errors; call `close` to hear of them. Not
  /// collective, for a rank may be alone in leaving by an exception.
  ~ResultFile();

  ResultFile(const ResultFile&) = delete;
  ResultFile& operator=(const ResultFile&) = delete;

  /// Appends a step and publishes it: once this returns, readers of the file see it. On an error (ResultFileError) the
  /// published file keeps the steps it had, and the file takes no more steps.
  /// Members, their samples and monitored names must be those of the first record, and `step` must grow. Collective.
  void append_step(const StepRecord& record);

  /// Brings the XDMF file up to date and removes the second copy. Called once; later calls do nothing. Collective.
  void close();

  const std::filesystem::path& path() const { return path_; }
  const std::filesystem::path& xdmf_path() const { return xdmf_path_; }

 private:
  struct Copy {
    std::filesystem::path path{};
    bool created = false;
    bool has_members = false;
    int last_step = -1;  ///< last step in this copy
  };

  struct StepLabel {
    int step = 0;
    double load_factor = 0.0;
  };

  /// A table and where its numbers begin in the published copy.
  struct PlacedTable {
    TableShape shape{};
    std::uint64_t place = 0;
  };

  RankNumber rank() const;
  bool is_root() const { return rank().rank == 0; }
  std::string prefix() const;
  void take_place();
  void together(const std::function<void()>& action) const;
  void on_root(const std::function<void()>& action) const;
  void or_give_up(const std::function<void()>& step);

  void check_consistent(const StepRecord& record) const;
  bool lacks_previous(const Copy& copy) const;
  void start(const Copy& copy) const;
  void write_copy(Copy& copy, const StepRecord& record);
  std::vector<ResultTable> missing_tables(const Copy& copy, const StepRecord& record) const;
  void write_frame(const Copy& copy, const StepRecord& record, const std::vector<ResultTable>& tables,
                   std::vector<std::uint64_t>& places) const;
  void publish(const Copy& copy) const;
  void write_xdmf();
  void finish();
  void remove_hidden_files() const noexcept;

  Communicator communicator_;
  SharedResultLock lock_;  ///< known to rank 0
  std::filesystem::path path_;
  std::filesystem::path xdmf_path_;
  std::filesystem::path new_name_;  ///< hidden name that is renamed to path_
  ResultHeader header_;
  std::array<Copy, 2> copies_;
  std::size_t next_copy_ = 0;  ///< the copy that is not published
  /// Missing in the next copy, which takes the rows of its tables from the published one; its members also describe the
  /// sampling.
  StepRecord previous_;
  std::vector<PlacedTable> previous_tables_;
  std::vector<StepLabel> labels_;  ///< of all published steps
  std::size_t steps_in_xdmf_ = 0;  ///< known to rank 0
  bool failed_ = false;
  bool closed_ = false;
};

}  // namespace mixbeam
