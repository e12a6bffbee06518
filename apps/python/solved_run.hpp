/// A completed or ongoing run: its scene, steps, and evaluations. Independent of Python.
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

  /// Opens a result file of `mixbeam run`. Throws InputError.
  static std::unique_ptr<SolvedRun> from_file(const std::filesystem::path& file, const std::optional<int>& threads);

  /// Solves a case of the scene ("": a scene without cases) into `file`, or without one. Throws InputError,
  /// ConvergenceError; completed steps are kept in any case.
  void solve(const std::string& load_case, const std::filesystem::path& file, const WritingOptions& writing,
             const StoredRun* resume = nullptr);

  /// Writes the result file that the run would have written. Throws ResultFileError, InputError.
  void write(const std::filesystem::path& file) const;

  /// Sets a function that solve() calls after each step, which at(-1) then returns.
  void on_step(std::function<void()> action) { on_step_ = std::move(action); }

  Application& app() { return app_; }
  const Application& app() const { return app_; }
  const std::vector<KeptStep>& steps() const { return steps_; }
  bool interrupted() const { return interrupted_; }
  /// Output of the program.
  std::string report() const { return report_.str(); }

  /// The structure in the state of a step, counted from 0, or from the end as -1, -2, ... Throws InputError.
  Simulation at(int step) const;
  /// Critical points of all steps, in the order of the path.
  std::vector<CriticalPoint> critical_points() const;
  /// Throws InputError if the result file of the run has been replaced.
  void require_same_file() const;
  /// A step; its critical points too, unless it is from a file. Throws InputError.
  const KeptStep& step(int step) const { return steps_[place_of(step)]; }

 private:
  std::size_t place_of(int step) const;
  void keep(const Simulation& simulation, const StepReport& report);

  std::ostringstream report_;
  Application app_;
  std::optional<Simulation> simulation_;  ///< in the last step
  std::vector<KeptStep> steps_;
  std::optional<StoredRun> stored_;  ///< states of the steps, if they are from a file
  std::filesystem::path file_{};     ///< result file, and its status when read:
  struct stat opened_ {};
  std::function<void()> on_step_{};
  bool interrupted_ = false;
};

/// Parses a scene in XML or YAML; `file`: name in messages, relative to whose folder files are imported. Throws
/// InputError. `is_object`: the text was made from an object, whose entries messages name.
XmlParameters parsed_scene(const std::string& text, const std::string& file, bool is_object = false);

/// The chosen case of a scene. Throws InputError if it has several and none is named.
std::string meant_case(const Scene& scene, const std::optional<std::string>& wanted);

}  // namespace mixbeam
