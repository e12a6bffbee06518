/// The frame of every benchmark application: command line, XML, exit codes, single run, summary. An application adds
/// its study (what the paper tabulates and plots) and nothing else.
#pragma once

#include "apps/common/summary.hpp"
#include "discretization/expected_values.hpp"
#include "discretization/result_file.hpp"
#include "discretization/xml_reader.hpp"
#include "nonlinear/simulation.hpp"

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <set>
#include <string>
#include <vector>

namespace mixbeam {

/// What a study works with. Output streams and files belong to rank 0: `out()` swallows everything on other ranks, and
/// files are written only where `writes_files()`.
class Application {
 public:
  std::string name;
  XmlParameters xml;
  Scene scene;  ///< as the XML file gives it; a study changes copies of it
  SolverParameters solver;
  std::vector<ExpectedValue> expected;
  std::filesystem::path output;  ///< existing folder
  bool quiet = false;            ///< no progress lines
  Summary summary;
  Communicator communicator;

  std::ostream& out() const;
  bool writes_files() const { return communicator->getRank() == 0; }
  /// Parameters of the list "Study", validated against the application's own declaration.
  Teuchos::ParameterList& study() { return xml.list->sublist("Study"); }

  /// Solves a scene; counts its steps, iterations and times in the summary. `label` starts each progress line (none:
  /// silent). Scenes too small to profit from threads run on one, unless the user chose a number; results are the same
  /// bits. `observer` is called with the simulation after each converged step. When no equilibrium is found, the last
  /// converged state is written to <output>/<label>_last_converged.h5 and ConvergenceError is thrown.
  using RunObserver = std::function<void(const Simulation& simulation, const StepReport& report)>;
  Simulation solve(const Scene& solved, const SolverParameters& parameters, const std::string& label,
                   const RunObserver& observer = {});
  Simulation solve(const Scene& solved) { return solve(solved, solver, ""); }

  /// As solve(), and writes every step to <output>/<file>.h5 with XDMF. Monitored: all points of the scene.
  Simulation solve_and_record(const Scene& solved, const SolverParameters& parameters, const std::string& file,
                              int points_per_element = 9, const RunObserver& observer = {});

  /// Checks those values of the list "Expected" that belong to this load factor; a value without one belongs to the end
  /// of the path. `own_quantity` evaluates the application's own quantities, which are left out without it.
  using OwnQuantity = std::function<double(const ExpectedValue&)>;
  void check_expected(const Simulation& simulation, double load_factor, const OwnQuantity& own_quantity = {});
  /// At the end of a run.
  void check_expected(const Simulation& simulation, const OwnQuantity& own_quantity = {}) {
    check_expected(simulation, simulation.result().load_factor, own_quantity);
  }
  /// Expected values that no check_expected() has compared so far.
  std::vector<ExpectedValue> not_compared() const;

 private:
  ResultHeader header(const Scene& solved) const;

  std::set<std::string> compared_;  ///< names of expected values
};

struct ApplicationDefinition {
  std::string name;                         ///< also of the default scene file, <name>.xml beside the executable
  std::string purpose;                      ///< one sentence
  ListSpec study;                           ///< declaration of the list "Study"
  std::vector<std::string> own_quantities;  ///< of the list "Expected", besides those of points
  std::function<void(Application&)>
      single;  ///< empty: run the scene, record it to single.h5, check the expected values
  std::function<void(Application&)> run_study;
};

/// The whole program. Returns the exit code: 0 all checks passed, 1 a check failed (or something unforeseen happened),
/// 2 bad input, 3 no convergence.
int run_application(int argc, char** argv, const ApplicationDefinition& definition);

}  // namespace mixbeam
