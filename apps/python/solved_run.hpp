/// A run that is over, or under way: its scene, its steps, and what can be asked of them. Nothing here knows Python.
#pragma once

#include "apps/common/run/application.hpp"

#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace mixbeam {

class SolvedRun {
 public:
  /// Reads a scene. Throws InputError.
  SolvedRun(XmlParameters parameters, const std::optional<int>& threads, bool force);

  /// A run from a result file of `mixbeam run`. Throws InputError.
  static std::unique_ptr<SolvedRun> from_file(const std::filesystem::path& file, const std::optional<int>& threads);

  /// Solves a case of the scene ("": a scene without cases) into `file`, or without one. Throws InputError,
  /// ConvergenceError; the steps that were done are there in any case.
  void solve(const std::string& load_case, const std::filesystem::path& file, const WritingOptions& writing,
             const StoredRun* resume = nullptr);

  /// Writes the result file that the run would have left. Throws ResultFileError, InputError.
  void write(const std::filesystem::path& file) const;

  /// Called after each step of solve(), which at(-1) is then.
  void on_step(std::function<void()> action) { on_step_ = std::move(action); }

  Application& app() { return app_; }
  const Application& app() const { return app_; }
  const std::vector<KeptStep>& steps() const { return steps_; }
  bool interrupted() const { return interrupted_; }
  /// What the program would have printed.
  std::string report() const { return report_.str(); }

  /// The structure in the state of a step, counted from 0, or from the end from -1 on. Throws InputError.
  Simulation at(int step) const;
  /// Those of all steps, in the order of the path.
  std::vector<CriticalPoint> critical_points() const;
  /// Throws InputError where the result file of the run has been replaced.
  void require_same_file() const;
  /// That step with its critical points. Throws InputError.
  const KeptStep& step(int step) const { return steps_[place_of(step)]; }

 private:
  std::size_t place_of(int step) const;
  void keep(const Simulation& simulation, const StepReport& report);

  std::ostringstream report_;
  Application app_;
  std::optional<Simulation> simulation_;  ///< of the last step
  std::vector<KeptStep> steps_;
  std::optional<StoredRun> stored_;  ///< holds the states of the steps, where they come from a file
  std::filesystem::path file_{};     ///< of the results, as it was:
  struct stat opened_ {};
  std::function<void()> on_step_{};
  bool interrupted_ = false;
};

/// The text of a scene in XML or YAML; `file` stands in messages, and what the scene imports lies in its folder. Throws
/// InputError.
/// `is_object`: the text was made of an object, and messages tell the place of an entry in that.
XmlParameters parsed_scene(const std::string& text, const std::string& file, bool is_object = false);

/// The case of a scene that is meant. Throws InputError where it has several and none is named.
std::string meant_case(const Scene& scene, const std::optional<std::string>& wanted);

}  // namespace mixbeam
