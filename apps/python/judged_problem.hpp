/// A scene whose solutions on any mesh are judged by one on a far finer mesh, and timed.
#pragma once

#include "apps/common/studies/study.hpp"
#include "nonlinear/run/accurate_run.hpp"

namespace mixbeam {

/// All relative. Fields over the whole structure in the L2 norm.
enum ErrorOf {
  kDisplacement,  ///< of the judged point, over its displacement; without such a point the largest of all points of the
                  ///< scene, over the largest displacement
  kCenterline,    ///< position of the centerline, over the norm of its displacement
  kMoment,        ///< material moment, over its norm
  kEnergy,        ///< strain energy
  kErrors
};
using Errors = std::array<double, kErrors>;

/// In seconds: from the scene to equilibrium, reading left out; of it, until the first residual; of all threads
/// together.
using RunTimes = std::array<double, 3>;

/// What a path met on its way to the end: critical points, and states for which the scene has expected values.
class PathTrace {
 public:
  explicit PathTrace(const std::vector<ExpectedValue>& on_path);

  /// The next step of the path. Collective.
  void add(const Simulation& simulation, const StepReport& report);
  /// Largest difference of the critical loads, over the largest of them, and of the displacements, over
  /// `displacement`; not a number where the paths met different things, or nothing.
  double error_against(const PathTrace& exact, double displacement) const;

 private:
  std::vector<ExpectedValue> wanted_;   ///< short of the end
  std::vector<double> critical_loads_;  ///< load factors
  std::vector<Vector3> displacements_;  ///< of the points of `wanted_`, in the order of the path
};

/// A run, and what it cost.
struct JudgedRun {
  Simulation simulation;
  PathTrace trace;
  RunTimes times{};
  AccuracyEnd end = AccuracyEnd::reached;  ///< where an accuracy was asked for
  std::vector<MeshRound> rounds{};         ///< likewise
};

/// Which part of a scene file is meant, and how.
struct JudgedCase {
  std::string load_case;       ///< of the file
  double load_share = 1.0;     ///< of its loads
  std::string branch;          ///< "positive": where the load is beyond a bifurcation; empty: what the file says
  std::string point;           ///< whose displacement is judged; empty: the first loaded point
  bool is_as_in_file = false;  ///< stability and steps as the file says, all points judged, elements of the members in
                               ///< the proportions of the file
};

/// A problem, ready to be solved on any mesh: elements of order `order`, so many of them in each member or, see
/// JudgedCase::is_as_in_file, in the finest one.
class JudgedProblem {
 public:
  /// `file`: empty for the scene of the application. Stability is determined only where the file counts or a branch is
  /// to be followed: it would cost as much as the solve, and has no effect on accuracy. Throws InputError.
  JudgedProblem(Application& app, const std::string& file, const JudgedCase& about);

  /// `most_seconds`: of the processor, after which it stops with the load step; `follows`: with its trace, which costs.
  /// Throws InputError.
  JudgedRun solve(int order, int elements, bool is_full, std::optional<int> threads, double most_seconds,
                  bool follows) const;
  /// The program's way to an accuracy.
  JudgedRun solve_accurately(double wanted, int threads) const;
  /// What a run estimates of its own error; not a number where it does not.
  Errors estimated(const JudgedRun& run) const;
  /// Holds a run against the values of the file that belong to the end of the path.
  void check_expected(const JudgedRun& run, const std::string& name) const;

  /// Elements of the finest member in the file.
  int own_elements() const;
  std::size_t members() const { return scene_.members.size(); }
  std::size_t expected_values() const { return expected_.size(); }
  const std::string& point() const { return about_.point; }
  bool judges_all_points() const { return about_.is_as_in_file; }

 private:
  Scene on(int order, int elements, bool is_full) const;

  Application& app_;
  bool is_own_scene_;
  JudgedCase about_;
  Scene scene_;  ///< of one load case
  SolverParameters solver_;
  std::vector<ExpectedValue> expected_, on_path_;  ///< of the end; others, where the path is that of the file
};

/// What errors are measured against.
class JudgedReference {
 public:
  JudgedReference(const JudgedProblem& problem, const JudgedRun& run);
  /// Of a simulation of the same scene on any mesh. Collective.
  Errors errors_of(const JudgedRun& other) const;
  double path_error_of(const JudgedRun& other) const;

 private:
  const JudgedRun run_;
  std::vector<std::string> points_;  ///< whose displacements are judged
  Errors scale_{};                   ///< what errors are divided by
};

}  // namespace mixbeam
