/// The frame of every application: runs with their records, checks, summary. A benchmark adds its study (what the paper
/// tabulates and plots) and nothing else.
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
  std::filesystem::path file{};     ///< result file; XDMF of the same name beside it; empty: observers see it only
  std::filesystem::path monitor{};  ///< CSV file of what is followed over the steps; empty: none
  int points_per_element = kPointsByOrder;
  std::map<std::string, std::string> properties{};  ///< in the file, besides those of program and machine
  RunObserver observer{};
  std::function<void(const StepRecord& record)> record_observer{};
  std::function<bool()> stop{};             ///< see PathControl
  std::function<void()> restart{};          ///< what was observed so far does not count: another mesh follows
  const QuantitySet* quantities = nullptr;  ///< followed besides the motion of points
  /// Of the state at the end of the path, and of critical points since it began or was resumed; none: they are not
  /// asked for.
  std::function<RecordedGradients(const Simulation&, const std::vector<CriticalPoint>&)> gradients{};
  std::vector<RecordedBucklingMode> motions{};  ///< of the undeformed structure, beside its buckling modes
  const StoredRun* resume = nullptr;            ///< continues after its last step, in its file
  WritingOptions writing{};
};

/// A step of a run that is over.
struct KeptStep {
  StepReport report{};
  State state{};
  RecordedStability stability{};
};

/// Critical points of a step of a run, with their states and without modes.
std::vector<CriticalPoint> stored_critical_points(Simulation& simulation, const StoredRun& run, std::size_t position);

/// Instruction set that this library was built for, of which a package has several: "x86-64-v4, 8 lanes". Runs have the
/// same bits where this agrees.
std::string instructions();

/// `results/scene_failure.txt` of `results/scene.h5`.
std::filesystem::path failure_file_of(const std::filesystem::path& results);

/// What a study works with. Output streams and files belong to rank 0: `out()` discards everything on other ranks, and
/// files are written only where `writes_files()`.
class Application {
 public:
  std::string name;
  XmlParameters xml;
  Scene scene;  ///< as the XML file gives it; a study changes copies of it
  /// The scene names no mesh and has a start mesh (start_mesh()) so far; a run chooses another one.
  bool mesh_is_free = false;
  std::string mesh_note{};  ///< how that mesh was chosen; empty where the scene names one
  SolverParameters solver;
  std::vector<ExpectedValue> expected;
  QuantitySet quantities{};                      ///< of the scene; empty: none are asked for
  std::optional<GradientParameters> gradient{};  ///< of these, where they are asked for
  std::optional<SearchParameters> search{};      ///< of numbers of the scene, before it is solved
  std::string load_case{};       ///< of the scene that is being solved; expected values of other cases wait
  std::filesystem::path output;  ///< existing folder
  bool quiet = false;            ///< no progress lines
  bool force = false;            ///< runs what seems not to fit into memory or onto the disk
  std::string* loose = nullptr;  ///< of a scene that is only drawn: see read_scene()
  Summary summary;
  SharedResultLock summary_lock{};  ///< of the file of the summary, where one is asked for
  Communicator communicator;
  std::ostream* terminal = nullptr;       ///< where rank 0 prints; null: standard output
  std::ostream* reports = nullptr;        ///< of several runs, each in a few lines; null: each by itself, in full
  std::function<bool()> asked_to_stop{};  ///< a run asks it as it asks for interrupts; none: never
  RunObserver watch{};                    ///< of the steps of a run, after they were recorded

  std::ostream& out() const;
  /// Adds a warning to the summary, and prints it.
  void warn(const std::string& text);
  /// Where progress lines of a run go: nowhere if the user or an empty label says so.
  std::ostream& progress_out(const std::string& label) const;
  /// By a signal or by asked_to_stop. Collective.
  bool is_asked_to_stop() const;
  bool writes_files() const { return communicator->getRank() == 0; }
  /// Parameters of the list "Study", validated against the application's own declaration.
  Teuchos::ParameterList& study() { return xml.list->sublist("Study"); }

  /// Solves a scene; counts its steps, iterations and times in the summary. `label` starts each progress line (none:
  /// silent). Scenes too small to profit from threads run on one, unless the user chose a number; results are the same
  /// bits. `observer` is called with the simulation after each converged step. When no equilibrium is found, the last
  /// converged state is written to <output>/<label>_last_converged.h5, the report of the failure beside it to
  /// <label>_last_converged_failure.txt, and ConvergenceError is thrown.
  Simulation solve(const Scene& solved, const SolverParameters& parameters, const std::string& label,
                   const RunObserver& observer = {});
  Simulation solve(const Scene& solved) { return solve(solved, solver, ""); }

  /// Threads that a scene profits from, unless the user chose a number.
  int threads_for(const Scene& solved, const SolverParameters& parameters) const;

  /// As solve(), for runs that may fail: result() of what is returned states how it ended, nothing is written or thrown
  /// but InputError. Without an observer, who would see its steps twice, a path that returns to an earlier state is
  /// followed again.
  Simulation try_to_solve(const Scene& solved, const SolverParameters& parameters, const RunObserver& observer = {},
                          const PathControl& control = {});

  /// As solve(), and writes every step to a result file; then the last converged state is in that file, and the report
  /// of a failure beside it in <name of the file>_failure.txt. A run that was
  /// stopped ends like any other, and result().interrupted is true.
  /// What is returned keeps the scene, which must not change.
  Simulation record(const std::shared_ptr<const Scene>& solved, const SolverParameters& parameters,
                    const Recording& recording);
  Simulation record(const Scene& solved, const SolverParameters& parameters, const Recording& recording) {
    return record(std::make_shared<const Scene>(solved), parameters, recording);
  }

  /// As record(), for a scene with an accuracy (accurate_run.hpp): the file holds the last mesh, its whole path or,
  /// where the state was carried over from another mesh, its end. `keeps_path`: the whole path is wanted.
  AccurateRun record_accurately(const Scene& solved, const SolverParameters& parameters, const Recording& recording,
                                bool keeps_path);

  /// Writes the result file that record() would have written on the way. `simulation`: of these steps.
  void write(const Simulation& simulation, const std::vector<KeptStep>& steps, const Recording& recording) const;

  /// As record(), to <output>/<file>.h5.
  Simulation solve_and_record(const Scene& solved, const SolverParameters& parameters, const std::string& file,
                              int points_per_element = kPointsByOrder, const RunObserver& observer = {});

  /// Checks those values of the list "Expected" that belong to this load factor; a value without one belongs to the end
  /// of the path. `own_quantity` evaluates the application's own quantities, which are left out without it.
  using OwnQuantity = std::function<double(const ExpectedValue&)>;
  void check_expected(const Simulation& simulation, double load_factor, const OwnQuantity& own_quantity = {});
  /// Likewise, and those that belong to the critical points since the step before.
  void check_expected(const Simulation& simulation, const StepReport& report, const OwnQuantity& own_quantity = {});
  /// At the end of a run.
  void check_expected(const Simulation& simulation, const OwnQuantity& own_quantity = {}) {
    check_expected(simulation, simulation.result().load_factor, own_quantity);
  }
  /// Expected values that no check_expected() has compared so far.
  std::vector<ExpectedValue> not_compared() const;
  /// Critical points on the paths that were followed, by load case, as far as check_expected() has seen them.
  int critical_points(const std::string& of_case) const;

 private:
  class Recorder;

  ResultHeader header(const Scene& solved, const std::map<std::string, std::string>& properties = {}) const;
  /// Walks along the path, after `prepare`, and counts its costs; does not judge how it ended.
  Simulation walk(const std::shared_ptr<const Scene>& solved, const SolverParameters& parameters,
                  const std::string& label, const PathControl& control, const std::function<void(Simulation&)>& prepare,
                  const RunObserver& observer);
  /// Writes the report to <stem of `results`>_failure.txt beside `results` and throws it as ConvergenceError.
  [[noreturn]] void give_up(const Simulation& simulation, const std::string& label, const std::string& where_state,
                            const std::filesystem::path& results) const;
  /// Of a run that is resumed, made anew where they are damaged.
  std::optional<StoredRun> completed_series(const Scene& solved, const SolverParameters& parameters,
                                            const Recording& recording) const;
  void replay(Simulation& simulation, const StoredRun& run, const RunObserver& observer) const;
  void compare(const Simulation& simulation, const std::function<bool(const ExpectedValue&)>& is_due,
               const OwnQuantity& own_quantity);

  std::set<std::string> compared_;              ///< names of expected values
  std::map<std::string, int> critical_points_;  ///< by load case
};

struct ApplicationDefinition {
  std::string name;                         ///< also of the default scene file, <name>.xml
  std::filesystem::path folder{};           ///< of that file; empty: the one of the executable
  std::string purpose;                      ///< one sentence
  ListSpec study;                           ///< declaration of the list "Study"
  std::optional<ListSpec> batch{};          ///< declaration of the list "Batch"; none: the program takes no such list
  bool chooses_meshes = false;              ///< takes "Accuracy" of the list "Scene"
  bool answers_quantities = false;          ///< takes the list "Quantities"
  bool finds_rest_shapes = false;           ///< takes the lists "Inverse", "Identification", "Design"
  std::vector<std::string> own_quantities;  ///< of the list "Expected", besides those of points
  std::function<void(Application&)>
      single;  ///< empty: run the scene, record it to single.h5, check the expected values
  std::function<void(Application&)> run_study;
};

/// Starts MPI, runs `action`, which returns an exit code, for an application of all ranks, and reports errors as
/// guarded_run().
int with_application(const std::string& program, const std::function<int(Application&)>& action);

/// The whole program. Returns the exit code: 0 all checks passed, 1 a check failed (or something unforeseen happened),
/// 2 bad input, 3 no convergence.
int run_application(int argc, char** argv, const ApplicationDefinition& definition);

/// The verdict of the frequencies, where eigenvalues of the tangent do not tell whether a state is stable.
std::string judged_by_modes(const std::string& stable, const std::vector<RecordedVibrationMode>& modes);

}  // namespace mixbeam
