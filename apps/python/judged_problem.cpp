/// A scene whose solutions on any mesh are compared with one on a far finer mesh, and timed.
#include "apps/common/run/quantity_values.hpp"
#include "apps/common/run/scene_file.hpp"
#include "apps/common/studies/phase_costs.hpp"
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "apps/python/arrays.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/math/vector_algebra.hpp"
#include "nonlinear/run/accurate_run.hpp"

#include <algorithm>

namespace py = pybind11;

namespace mixbeam {

namespace {

/// Gauss points beyond the k + 1 that are exact for an element's polynomials: the reference is no such polynomial.
constexpr int kMoreGaussPoints = 4;
/// Steps end at requested load factors up to rounding.
constexpr double kSameTraceLoad = 1e-12;

double energy_of(const Simulation& simulation) {
  const StrainEnergy energy = simulation.strain_energy();
  return energy.force + energy.moment;
}

int judging_points(const Simulation& simulation) { return simulation.scene().members.front().order + kMoreGaussPoints; }

/// Reads a scene that belongs to another application and ignores its study.
Application read_other_scene(const Application& app, const std::string& file) {
  ApplicationDefinition definition;
  definition.name = app.name;
  definition.study = ListSpec("Of another application.").without_checks();
  Application read;
  read.communicator = app.communicator;
  read_scene_file(read, file, definition);
  return read;
}

/// Relative errors; of fields, in the L2 norm over the structure.
enum ErrorOf {
  kDisplacement,  ///< of the judged point, over its displacement; without such a point the largest of all points, over
                  ///< the largest displacement
  kCenterline,    ///< position of the centerline, over the norm of its displacement
  kMoment,        ///< material moment, over its norm
  kEnergy,        ///< strain energy
  kErrors
};
using Errors = std::array<double, kErrors>;

/// Times [s]: from the scene (already read) to equilibrium; its part before the first residual; processor time of all
/// threads.
using RunTimes = std::array<double, 3>;

/// Critical points of a path, and its states with expected values.
class PathTrace {
 public:
  explicit PathTrace(const std::vector<ExpectedValue>& on_path) {
    for (const ExpectedValue& value : on_path)
      if (!value.critical_point && !value.point.empty()) wanted_.push_back(value);
  }

  /// Adds the next step of the path. Collective.
  void add(const Simulation& simulation, const StepReport& report) {
    for (const CriticalPoint& point : report.critical_points) critical_loads_.push_back(point.load_factor);
    for (const ExpectedValue& value : wanted_)
      if (std::abs(report.load_factor - *value.load_factor) <= kSameTraceLoad)
        displacements_.push_back(simulation.displacement(value.point));
  }

  /// Largest difference of critical loads, over the largest of them, and of displacements, over `displacement`; NaN if
  /// the paths differ in their events, or have none.
  double error_against(const PathTrace& exact, double displacement) const {
    if (critical_loads_.size() != exact.critical_loads_.size() ||
        displacements_.size() != exact.displacements_.size() || (critical_loads_.empty() && displacements_.empty()))
      return std::nan("");
    double size = 0.0, error = 0.0;
    for (const double load : exact.critical_loads_) size = std::max(size, std::abs(load));
    for (size_t i = 0; i < critical_loads_.size(); ++i)
      error = std::max(error, std::abs(critical_loads_[i] - exact.critical_loads_[i]) / size);
    for (size_t i = 0; i < displacements_.size(); ++i)
      error = std::max(error, vector_algebra::distance(displacements_[i], exact.displacements_[i]) / displacement);
    return error;
  }

 private:
  std::vector<ExpectedValue> wanted_;   ///< before the end
  std::vector<double> critical_loads_;  ///< load factors
  std::vector<Vector3> displacements_;  ///< of the points of `wanted_`, in the order of the path
};

/// A run and its cost.
struct JudgedRun {
  Simulation simulation;
  PathTrace trace;
  RunTimes times{};
  AccuracyEnd end = AccuracyEnd::reached;  ///< of a run with an accuracy
  std::vector<MeshRound> rounds{};         ///< likewise
};

/// The part of a scene file to judge, and options.
struct JudgedCase {
  std::string load_case;       ///< of the file
  double load_share = 1.0;     ///< of its loads
  std::string branch;          ///< "positive": for loads beyond a bifurcation; empty: as in the file
  std::string point;           ///< point whose displacement is judged; empty: the first loaded point
  bool is_as_in_file = false;  ///< stability and steps as in the file, all points judged, elements of members in the
                               ///< proportions of the file
};

/// A problem to be solved on any mesh: elements of order `order`, `elements` of them in each member or, with
/// JudgedCase::is_as_in_file, in the finest one.
class JudgedProblem {
 public:
  /// `file`: empty for the application's scene. Determines stability only if taken from the file or for a branch: it
  /// would cost as much as the solve, and does not affect accuracy. Throws InputError.
  JudgedProblem(Application& app, const std::string& file, const JudgedCase& about)
      : app_(app), is_own_scene_(file.empty()), about_(about) {
    const Application read = is_own_scene_ ? app : read_other_scene(app, file);
    scene_ = with_loads(scene_of_case(read.scene, about.load_case), about.load_share);
    solver_ = read.solver;
    for (const ExpectedValue& value : read.expected) {
      const bool is_on_path = value.critical_point || value.load_factor.value_or(scene_.stages) != scene_.stages;
      if (is_on_path && about.is_as_in_file) on_path_.push_back(value);
      if (!is_on_path && value.load_case == about.load_case && about.load_share == 1.0) expected_.push_back(value);
    }
    if (about.is_as_in_file) return;
    if (about.point.empty() && scene_.point_loads.empty())
      throw InputError("the study judges the displacement of the first loaded point; the scene has no point load");
    if (about.point.empty()) about_.point = scene_.point_loads.front().point;
    if (about.branch == "positive") solver_.analysis.branch = Branch::positive;
    solver_.analysis.stability = solver_.analysis.branch != Branch::primary;
  }

  /// `most_seconds`: processor time after which it stops with the load step; `follows`: records the trace, which costs
  /// time. Throws InputError.
  JudgedRun solve(int order, int elements, bool is_full, std::optional<int> threads, double most_seconds,
                  bool follows) const {
    const Scene scene = on(order, elements, is_full);
    SolverParameters parameters = solver_;
    if (threads) parameters.threads = *threads;
    PathTrace trace(on_path_);
    const RunWatch watch;
    Simulation simulation(scene, parameters, app_.communicator);
    const double setup = watch.seconds();
    PathControl control;
    control.stop = [&] { return app_.communicator->getSize() == 1 && watch.processor_seconds() > most_seconds; };
    if (follows)
      simulation.run([&](const StepReport& report, const State&) { trace.add(simulation, report); }, control);
    else
      simulation.run({}, control);
    const RunTimes times{watch.seconds(), setup, watch.processor_seconds()};
    return {std::move(simulation), std::move(trace), times};
  }

  /// Solves by the program's own mesh refinement.
  JudgedRun solve_accurately(double wanted, int threads) const {
    Scene scene = scene_;
    scene.accuracy = wanted;
    for (Member& member : scene.members) {
      member.keeps_order = member.keeps_elements = false;
      member.stations.clear();
      member.force_integration = ForceIntegration::both_reduced;
    }
    SolverParameters parameters = solver_;
    parameters.threads = threads;
    std::vector<ExpectedValue> values = expected_;
    values.insert(values.end(), on_path_.begin(), on_path_.end());
    const bool keeps_path = asks_for_path(solver_, values, about_.load_case, scene_);
    PathTrace trace(on_path_);  // of the last path
    AccurateRunObserver observer;
    observer.begin = [&](const Simulation&) { trace = PathTrace(on_path_); };
    observer.step = [&](const Simulation& simulation, const StepReport& report) { trace.add(simulation, report); };
    observer.end = [&](const Simulation& simulation, const StepReport& report, const ErrorEstimate&) {
      trace.add(simulation, report);
    };
    const RunWatch watch;
    AccurateRun run = run_accurately(scene, parameters, app_.communicator, keeps_path, observer);
    const RunTimes times{watch.seconds(), std::nan(""), watch.processor_seconds()};
    return {std::move(run.simulation), std::move(trace), times, run.end, std::move(run.rounds)};
  }

  /// Errors as estimated by the run itself; NaN if not estimated.
  Errors estimated(const JudgedRun& run) const {
    using vector_algebra::norm;
    const ErrorEstimate estimate = run.simulation.estimate_error();
    if (!estimate.exists()) return {std::nan(""), std::nan(""), std::nan(""), std::nan("")};
    const Vector3 error = estimate.vertex_displacement.at(vertex_of(run.simulation.model().mesh(), about_.point));
    return {norm(error) / norm(run.simulation.displacement(about_.point)), estimate.displacement.relative(),
            estimate.moment.relative(), std::abs(estimate.energy.relative())};
  }

  /// Compares a run with the expected values at the end of the path.
  void check_expected(const JudgedRun& run, const std::string& name) const {
    if (is_own_scene_) return app_.check_expected(run.simulation);
    for (const ExpectedValue& value : expected_)
      if (const auto present = present_value(run.simulation, value))
        app_.summary.check_expected(name + ": " + value.name, *present, value);
  }

  /// Number of elements of the finest member in the file.
  int own_elements() const {
    int most = 1;
    for (const Member& member : scene_.members) most = std::max(most, member.elements);
    return most;
  }

  std::size_t members() const { return scene_.members.size(); }
  std::size_t expected_values() const { return expected_.size(); }
  const std::string& point() const { return about_.point; }
  bool judges_all_points() const { return about_.is_as_in_file; }

 private:
  Scene on(int order, int elements, bool is_full) const {
    Scene changed = scene_;
    const int own = own_elements();
    for (Member& member : changed.members) {
      member.order = order;
      member.elements = about_.is_as_in_file ? (member.elements * elements + own - 1) / own : elements;
      member.force_integration = is_full ? ForceIntegration::full : ForceIntegration::both_reduced;
    }
    return changed;
  }

  Application& app_;
  bool is_own_scene_;
  JudgedCase about_;
  Scene scene_;  ///< of one load case
  SolverParameters solver_;
  std::vector<ExpectedValue> expected_, on_path_;  ///< at the end; before it, if the path is that of the file
};

/// Reference solution for errors.
class JudgedReference {
 public:
  JudgedReference(const JudgedProblem& problem, const JudgedRun& run) : run_(run) {
    const Simulation& simulation = run_.simulation;
    const int gauss = judging_points(simulation);
    if (problem.judges_all_points()) {
      for (const auto& [name, vertex] : simulation.model().mesh().vertex_of_point) points_.push_back(name);
      scale_[kDisplacement] = largest_displacement(simulation.model(), simulation.state());
    } else {
      points_ = {problem.point()};
      scale_[kDisplacement] = vector_algebra::norm(simulation.displacement(problem.point()));
    }
    scale_[kCenterline] = simulation.l2_norm(gauss, [](const PointSample& sample, int) { return sample.displacement; });
    scale_[kMoment] = simulation.l2_norm(gauss, [](const PointSample& sample, int) { return sample.moment; });
    scale_[kEnergy] = energy_of(simulation);
  }

  /// Errors of a simulation of the same scene on any mesh. Collective.
  Errors errors_of(const JudgedRun& run) const {
    const Simulation &simulation = run_.simulation, &other = run.simulation;
    const int gauss = judging_points(other);
    const auto exact = [&](const PointSample& sample, int member) {
      const double length = simulation.model().mesh().member_length[member];
      return sample_member(simulation.model(), simulation.state(), member, sample.arc_length / length);
    };
    Errors errors{};
    for (const std::string& point : points_)
      errors[kDisplacement] = std::max(
          errors[kDisplacement], vector_algebra::distance(other.displacement(point), simulation.displacement(point)));
    errors[kCenterline] = other.l2_norm(gauss, [&](const PointSample& sample, int member) {
      return sample.displacement - exact(sample, member).displacement;
    });
    errors[kMoment] = other.l2_norm(
        gauss, [&](const PointSample& sample, int member) { return sample.moment - exact(sample, member).moment; });
    errors[kEnergy] = std::abs(energy_of(other) - scale_[kEnergy]);
    for (int i = 0; i < kErrors; ++i) errors[i] /= scale_[i];
    return errors;
  }

  double path_error_of(const JudgedRun& other) const {
    return other.trace.error_against(run_.trace, scale_[kDisplacement]);
  }

 private:
  const JudgedRun run_;
  std::vector<std::string> points_;  ///< points whose displacements are judged
  Errors scale_{};                   ///< divisors of errors
};

/// [(order, elements) of the finest member and whether the whole path was followed], for each mesh.
py::list meshes_of(const JudgedRun& run) {
  const auto work = [](const MemberMesh& mesh) { return (mesh.order + 1) * mesh.elements; };
  py::list meshes;
  for (const MeshRound& round : run.rounds) {
    const MemberMesh finest = *std::max_element(round.mesh.begin(), round.mesh.end(),
                                                [&](const auto& a, const auto& b) { return work(a) < work(b); });
    meshes.append(py::make_tuple(finest.order, finest.elements, round.followed));
  }
  return meshes;
}

/// (global unknowns, interior unknowns, floating-point operations of all iterations, counted as for elements of plain
/// sections)
py::tuple sizes_of(const JudgedRun& run) {
  const Model& model = run.simulation.model();
  const Member& member = run.simulation.scene().members.front();
  const InteriorLayout layout{member.order, force_point_count(member.order, member.force_integration)};
  const int elements = static_cast<int>(model.mesh().elements.size());
  const double flops = phase_costs("spatial", member.order).at(kWholeIteration).flops;
  return py::make_tuple(static_cast<int>(model.map()->getGlobalNumElements()), elements * layout.increments(),
                        run.simulation.result().newton_iterations * (flops * elements));
}

}  // namespace

void bind_judged_problem(py::module_& module) {
  using namespace py::literals;
  const auto result_of = [](auto member) {
    return [member](const JudgedRun& run) { return run.simulation.result().*member; };
  };
  py::class_<JudgedRun>(module, "JudgedRun")
      .def_property_readonly("finished", result_of(&LoadPathResult::finished))
      .def_property_readonly("interrupted", result_of(&LoadPathResult::interrupted))
      .def_property_readonly("failure", result_of(&LoadPathResult::failure))
      .def_property_readonly("steps", result_of(&LoadPathResult::steps))
      .def_property_readonly("failed_steps", result_of(&LoadPathResult::failed_steps))
      .def_property_readonly("iterations", result_of(&LoadPathResult::newton_iterations))
      .def_property_readonly("sizes", sizes_of)
      .def_property_readonly("meshes", meshes_of)
      .def_property_readonly("end", [](const JudgedRun& run) { return text_of(run.end); })
      .def_property_readonly("last_estimate", [](const JudgedRun& run) { return run.rounds.back().error; })
      .def_readonly("times", &JudgedRun::times)
      .def("position", [](const JudgedRun& run, const std::string& point) {
        Vector3 place = position_of(run.simulation.scene(), point);
        const Vector3 moved = run.simulation.displacement(point);
        for (std::size_t i = 0; i < place.size(); ++i) place[i] += moved[i];
        return place;
      });
  py::class_<JudgedProblem>(module, "JudgedProblem")
      .def(py::init([](Application& app, const std::string& file, const std::string& load_case, double load_share,
                       const std::string& branch, const std::string& point, bool is_as_in_file) {
             return JudgedProblem(app, file, {load_case, load_share, branch, point, is_as_in_file});
           }),
           "app"_a, "file"_a, "load_case"_a, "load_share"_a, "branch"_a, "point"_a, "is_as_in_file"_a)
      .def("solve", &JudgedProblem::solve, "order"_a, "elements"_a, "is_full"_a = false, "threads"_a = std::nullopt,
           "most_seconds"_a = kNoLimit, "follows"_a = false)
      .def("solve_accurately", &JudgedProblem::solve_accurately)
      .def("estimated",
           [](const JudgedProblem& problem, const JudgedRun& run) {
             const RunWatch watch;
             const Errors errors = problem.estimated(run);
             return py::make_tuple(errors, watch.processor_seconds());
           })
      .def("check_expected", &JudgedProblem::check_expected)
      .def_property_readonly("own_elements", &JudgedProblem::own_elements)
      .def_property_readonly("members", &JudgedProblem::members)
      .def_property_readonly("expected_values", &JudgedProblem::expected_values)
      .def_property_readonly("point", &JudgedProblem::point);
  py::class_<JudgedReference>(module, "JudgedReference")
      .def(py::init<const JudgedProblem&, const JudgedRun&>())
      .def("errors_of", &JudgedReference::errors_of)
      .def("path_error_of", &JudgedReference::path_error_of);
}

}  // namespace mixbeam
