/// The frame of every application: runs, result files, checks, summary. A benchmark adds only its study (the tables and
/// plots of the paper).
#pragma once

#include "apps/common/run/scene_gradients.hpp"
#include "apps/common/run/scene_search.hpp"
#include "apps/common/run/summary.hpp"
#include "discretization/checks/expected_values.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/quantities/quantity_set.hpp"
#include "discretization/results/result_file.hpp"
#include "nonlinear/run/accurate_run.hpp"

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace mixbeam {

using RunObserver = std::function<void(const Simulation& simulation, const StepReport& report)>;

/// Where and how a run is recorded.
struct Recording {
  std::filesystem::path file{};     ///< result file; XDMF of the same name beside it; empty: only observers see the run
  std::filesystem::path monitor{};  ///< CSV file of the time series over the steps; empty: none
  int points_per_element = kPointsByOrder;
  std::map<std::string, std::string> properties{};  ///< attributes of the file besides program and machine
  RunObserver observer{};
  std::function<void(const StepRecord& record)> record_observer{};
  std::function<bool()> stop{};             ///< see PathControl
  std::function<void()> restart{};          ///< called before the path begins again: discard earlier steps
  const QuantitySet* quantities = nullptr;  ///< recorded besides the motion of points
  /// Gradients at the end of the path, and of the critical points since its start or resumption; empty: not requested.
  std::function<RecordedGradients(const Simulation&, const std::vector<CriticalPoint>&)> gradients{};
  std::vector<RecordedBucklingMode> motions{};  ///< free motions of the undeformed structure, beside its modes
  const StoredRun* resume = nullptr;            ///< continued after its last step, in the same file
  WritingOptions writing{};
};

/// A step of a run, kept for evaluation.
struct KeptStep {
  StepReport report{};
  State state{};
  RecordedStability stability{};
};

/// Returns the report of step `position` of a stored run, without stability, critical points and history.
StepReport stored_report(const StoredRun& run, std::size_t position);

/// Critical points of step `position` of a stored run, with their states, without modes.
std::vector<CriticalPoint> stored_critical_points(Simulation& simulation, const StoredRun& run, std::size_t position);

/// Instruction set that this library was built for (a package has several): "x86-64-v4, 8 lanes". Runs are
/// bit-identical if it agrees.
std::string instructions();

/// `results/scene_failure.txt` of `results/scene.h5`.
std::filesystem::path failure_file_of(const std::filesystem::path& results);

/// State and services of a program or study. Only rank 0 writes: `out()` discards everything on other ranks, and files
/// are written only if `writes_files()`.
class Application {
 public:
  std::string name;
  XmlParameters xml;
  Scene scene;  ///< as the XML file gives it; a study changes copies of it
  /// True if the scene names no mesh: it has a start mesh (start_mesh()) until a run chooses one.
  bool mesh_is_free = false;
  std::string mesh_note{};  ///< how that mesh was chosen; empty if the scene names one
  SolverParameters solver;
  std::vector<ExpectedValue> expected;
  QuantitySet quantities{};                      ///< list "Quantities" of the scene; may be empty
  std::optional<GradientParameters> gradient{};  ///< list "Gradient", if the scene has one
  std::optional<SearchParameters> search{};      ///< list "Identification" or "Design", if the scene has one
  std::string load_case{};                       ///< case being solved; expected values of other cases are not compared
  std::filesystem::path output;                  ///< existing folder
  bool quiet = false;                            ///< no progress lines
  bool force = false;                            ///< runs even if memory or disk seem too small
  std::string* loose = nullptr;                  ///< for scenes that are only drawn: see read_scene()
  Summary summary;
  SharedResultLock summary_lock{};  ///< lock of the summary file, if there is one
  Communicator communicator;
  std::ostream* terminal = nullptr;       ///< where rank 0 prints; null: standard output
  std::ostream* reports = nullptr;        ///< short reports of several runs; null: a full report of each run
  std::function<bool()> asked_to_stop{};  ///< polled together with interrupts; empty: never stops
  RunObserver watch{};                    ///< called for each step after it was recorded

  std::ostream& out() const;
  /// Adds a warning to the summary, and prints it.
  void warn(const std::string& text);
  /// Stream for progress lines; discards them in quiet mode or if the label is empty.
  std::ostream& progress_out(const std::string& label) const;
  /// True after a signal, or if asked_to_stop() returns true. Collective.
  bool is_asked_to_stop() const;
  bool writes_files() const { return communicator->getRank() == 0; }
  /// Parameters of the list "Study", validated against the application's own declaration.
  Teuchos::ParameterList& study() { return xml.list->sublist("Study"); }

  /// Solves a scene; adds its steps, iterations and times to the summary. `label` begins each progress line (empty:
  /// silent). Scenes too small to profit from threads use one, unless the user chose a number; results are
  /// bit-identical. `observer` is called after each converged step. If no equilibrium is found, writes the last
  /// converged state to <output>/<label>_last_converged.h5 and the failure report to <label>_last_converged_failure.txt
  /// beside it, and throws ConvergenceError.
  Simulation solve(const Scene& solved, const SolverParameters& parameters, const std::string& label,
                   const RunObserver& observer = {});
  Simulation solve(const Scene& solved) { return solve(solved, solver, ""); }

  /// Number of threads: the user's choice, otherwise as many as the scene profits from.
  int threads_for(const Scene& solved, const SolverParameters& parameters) const;

  /// Solves like solve(), for runs that may fail: result() states how the run ended, nothing is written, and only
  /// InputError is thrown. A path that returns to an earlier state is followed again, unless an observer would see its
  /// steps twice.
  Simulation try_to_solve(const Scene& solved, const SolverParameters& parameters, const RunObserver& observer = {},
                          const PathControl& control = {});

  /// Solves like solve() and writes every step to a result file. After a failure that file ends with the last converged
  /// state, and the report is in <name of the file>_failure.txt beside it. A stopped run ends like any other, with
  /// result().interrupted true. The simulation keeps the scene, which must not change.
  Simulation record(const std::shared_ptr<const Scene>& solved, const SolverParameters& parameters,
                    const Recording& recording);
  Simulation record(const Scene& solved, const SolverParameters& parameters, const Recording& recording) {
    return record(std::make_shared<const Scene>(solved), parameters, recording);
  }

  /// Records a scene with an accuracy (accurate_run.hpp): the file holds the last mesh with its whole path, or only the
  /// end if the state was transferred from another mesh. `keeps_path`: always follow the whole path.
  AccurateRun record_accurately(const Scene& solved, const SolverParameters& parameters, const Recording& recording,
                                bool keeps_path);

  /// Writes the result file that record() would have written during the run. `simulation`: solved these steps.
  void write(const Simulation& simulation, const std::vector<KeptStep>& steps, const Recording& recording) const;

  /// Calls record() for <output>/<file>.h5.
  Simulation solve_and_record(const Scene& solved, const SolverParameters& parameters, const std::string& file,
                              int points_per_element = kPointsByOrder, const RunObserver& observer = {});

  /// Checks the values of the list "Expected" at this load factor; values without a load factor are checked at the end
  /// of the path. `own_quantity` evaluates the application's own quantities; without it they are skipped.
  using OwnQuantity = std::function<double(const Simulation& simulation, const ExpectedValue&)>;
  void check_expected(const Simulation& simulation, double load_factor, const OwnQuantity& own_quantity = {});
  /// Also checks the values at critical points since the previous step.
  void check_expected(const Simulation& simulation, const StepReport& report, const OwnQuantity& own_quantity = {});
  /// Checks the values at the end of a run.
  void check_expected(const Simulation& simulation, const OwnQuantity& own_quantity = {}) {
    check_expected(simulation, simulation.result().load_factor, own_quantity);
  }
  /// Expected values that check_expected() has not compared yet.
  std::vector<ExpectedValue> not_compared() const;
  /// Forgets what check_expected() has seen of the present load case, whose path begins again. `checks`: number of
  /// checks before it; the others are discarded.
  void forget_path(std::size_t checks);
  /// Number of critical points of a load case that check_expected() has seen so far.
  int critical_points(const std::string& of_case) const;

 private:
  class Recorder;

  ResultHeader header(const Scene& solved, const std::map<std::string, std::string>& properties = {}) const;
  /// Calls `prepare`, follows the path and adds its costs to the summary; does not check how it ended.
  Simulation walk(const std::shared_ptr<const Scene>& solved, const SolverParameters& parameters,
                  const std::string& label, const PathControl& control, const std::function<void(Simulation&)>& prepare,
                  const RunObserver& observer);
  /// Writes the report to <stem of `results`>_failure.txt beside `results` and throws it as ConvergenceError.
  [[noreturn]] void give_up(const Simulation& simulation, const std::string& label, const std::string& where_state,
                            const std::filesystem::path& results) const;
  /// Stored run to resume, with its time series recomputed if they are damaged.
  std::optional<StoredRun> completed_series(const Scene& solved, const SolverParameters& parameters,
                                            const Recording& recording) const;
  void replay(Simulation& simulation, const StoredRun& run, const RunObserver& observer) const;
  void compare(const Simulation& simulation, const std::function<bool(const ExpectedValue&)>& is_due,
               const OwnQuantity& own_quantity);

  std::set<std::string> compared_;              ///< names of expected values
  std::map<std::string, int> critical_points_;  ///< by load case
};

struct ApplicationDefinition {
  std::string name;                          ///< also the stem of the default scene file, <name>.xml
  std::filesystem::path folder{};            ///< folder of that file; empty: folder of the executable
  std::string purpose;                       ///< one sentence
  ListSpec study;                            ///< declaration of the list "Study"
  std::optional<ListSpec> batch{};           ///< declaration of the list "Batch"; none: not accepted
  bool chooses_meshes = false;               ///< accepts "Accuracy" in the list "Scene"
  bool answers_quantities = false;           ///< accepts the list "Quantities"
  bool finds_rest_shapes = false;            ///< accepts the lists "Inverse", "Identification", "Design"
  std::vector<std::string> own_quantities;   ///< allowed in the list "Expected" besides those of points
  std::function<void(Application&)> single;  ///< empty: solve the scene, record single.h5, check the expected values
  std::function<void(Application&)> run_study;
};

/// Starts MPI and runs `action`, which returns an exit code, for one application on all ranks; reports errors like
/// guarded_run().
int with_application(const std::string& program, const std::function<int(Application&)>& action);

/// Runs the whole program. Returns the exit code: 0 all checks passed, 1 a check failed (or unforeseen error), 2 bad
/// input, 3 no convergence.
int run_application(int argc, char** argv, const ApplicationDefinition& definition);

/// Returns `stable`, or the verdict of the frequencies if the eigenvalues of the tangent leave stability undetermined.
std::string judged_by_modes(const std::string& stable, const std::vector<RecordedVibrationMode>& modes);

}  // namespace mixbeam
