#include "apps/python/solved_run.hpp"

#include "apps/common/run/scene_file.hpp"
#include "apps/common/session/interrupt.hpp"
#include "apps/common/session/machine_room.hpp"
#include "apps/common/session/mpi_session.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/found_scene.hpp"
#include "apps/mixbeam/mesh_report.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/message_text.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace mixbeam {

namespace {

void prepare(Application& app, std::ostream& report, bool force) {
  app.communicator = start_as_guest();
  app.terminal = &report;
  app.quiet = true;
  app.force = force;
}

/// Hash of a scene without its loads; scenes that differ only in these share a mesh.
std::size_t key_without_loads(const XmlParameters& xml) {
  Teuchos::ParameterList rest(*xml.list);
  for (const char* name : {"Quantities", "Expected"}) rest.remove(name, false);
  for (const char* name : {"Point Loads", "Distributed Loads", "Gravity", "Eigenstrains"})
    rest.sublist("Scene").remove(name, false);
  std::ostringstream text;
  rest.print(text);
  for (const auto& [file, content] : xml.source.files()) text << file << content;
  return std::hash<std::string>()(text.str());
}

struct KnownMesh {
  MeshChoice mesh{};
  std::string note{};
};
/// Meshes chosen in this process, by key_without_loads().
std::map<std::size_t, KnownMesh>& known_meshes() {
  static std::map<std::size_t, KnownMesh> meshes;
  return meshes;
}

/// Reuses a known mesh, as long as estimated errors stay small enough.
void choose_mesh_once(Application& app) {
  if (!app.mesh_is_free) return;
  KnownMesh& known = known_meshes()[key_without_loads(app.xml)];
  if (known.mesh.size() == app.scene.members.size()) return take_mesh(app, known.mesh, known.note);
  choose_mesh(app);
  known = {mesh_of(app.scene), app.mesh_note};
}

void forget_poor_mesh(const Application& app) {
  if (app.mesh_note.empty() || app.summary.estimated_errors.empty()) return;
  const EstimatedErrors& errors = app.summary.estimated_errors.back();
  if (errors.quantities.empty() || errors.quantities.front().relative > kAccuracyWithoutMesh)
    known_meshes().erase(key_without_loads(app.xml));
}

}  // namespace

XmlParameters parsed_scene(const std::string& text, const std::string& file, bool is_object) {
  if (format_of("", text) != FileFormat::xml) return parse_parameters(text, file, mixbeam_root_spec(), Mistakes::kept);
  XmlParameters scene = parse_xml(text, file, Mistakes::kept);  // regardless of the file name
  if (is_object) scene.source.set_language(InputLanguage::python);
  return scene;
}

SolvedRun::SolvedRun(XmlParameters parameters, const std::optional<int>& threads, bool force) {
  prepare(app_, report_, force);
  read_scene_file(app_, std::move(parameters), mixbeam_definition(), mixbeam_root_spec());
  refuse_rest_shape(app_);
  describe_run(app_, "mixbeam", threads);
  warn_of_scene(app_);
}

void SolvedRun::require_same_file() const {
  struct stat now {};
  const auto stamp = [](const struct stat& of) {
    return std::make_tuple(of.st_dev, of.st_ino, of.st_size, of.st_mtim.tv_sec, of.st_mtim.tv_nsec);
  };
  if (file_.empty() || (stat(file_.c_str(), &now) == 0 && stamp(now) == stamp(opened_))) return;
  throw InputError(file_.string() +
                   ": is another file than that of this run, or has gone on since; allowed: to open it again");
}

std::unique_ptr<SolvedRun> SolvedRun::from_file(const std::filesystem::path& file, const std::optional<int>& threads) {
  struct stat before {};
  stat(file.c_str(), &before);
  StoredRun stored(file);
  if (stored.header().property("program") != "mixbeam")
    throw InputError(file.string() + ": written by \"" + stored.header().property("program") +
                     "\", whose scenes are those of its study; allowed: results of mixbeam run");
  XmlParameters parameters = parsed_scene(stored.header().scene_xml, file.string() + " (scene)");
  parameters.source.set_root_name(stored.header().scene_name);
  parameters.source.set_files(stored.header().imported);
  auto run = std::make_unique<SolvedRun>(std::move(parameters), threads, true);
  Application& app = run->app_;
  app.load_case = stored.header().property("load_case");
  take_stored_mesh(app, stored);
  Scene scene = scene_of_case(app.scene, app.load_case);
  if (scene.accuracy) scene = on_mesh_of(stored, scene);
  run->simulation_.emplace(scene, app.solver, app.communicator);
  for (std::size_t i = 0; i < stored.steps().size(); ++i) {
    KeptStep& step = run->steps_.emplace_back();
    step.report = stored_report(stored, i);
    step.stability = stored.stability()[i];
  }
  run->stored_ = std::move(stored);
  run->file_ = std::filesystem::absolute(file);
  run->opened_ = before;
  return run;
}

void SolvedRun::solve(const std::string& load_case, const std::filesystem::path& file, const WritingOptions& writing,
                      const StoredRun* resume) {
  const GuestHeap heap;
  require_reachable(app_, {load_case});
  app_.output = file.parent_path();
  app_.watch = [this](const Simulation& simulation, const StepReport& report) { keep(simulation, report); };
  const CommandLine no_options;
  const int code = finish_runs(app_, no_options, [&] {
    WritingOptions locked = writing;
    if (!file.empty()) locked.lock = lock_or_warn(app_, file);
    if (!take_found_numbers(app_, file.empty() ? file : file.parent_path() / file.stem())) return RunEnd::interrupted;
    choose_mesh_once(app_);
    const RunEnd end = run_case(app_, load_case, file, locked, resume);
    if (end == RunEnd::arrived) fail_what_was_missed(app_, {load_case});
    if (file.empty()) return end;
    file_ = std::filesystem::absolute(file);
    stat(file_.c_str(), &opened_);
    return end;
  });
  interrupted_ = code == kInterruptedExitCode;
  forget_poor_mesh(app_);
}

void SolvedRun::keep(const Simulation& simulation, const StepReport& report) {
  const bool is_same_mesh = simulation_ && &simulation_->model() == &simulation.model();
  if (!is_same_mesh) {  // a scene with an accuracy continues on another mesh
    steps_.clear();
    stored_.reset();
  }
  simulation_ = simulation;
  steps_.push_back({report, simulation.state(), simulation.stability()});
  if (on_step_) on_step_();
}

void SolvedRun::write(const std::filesystem::path& file) const {
  Recording recording;
  recording.file = file;
  recording.properties = properties_of_case(app_.load_case);
  if (!app_.quantities.empty()) recording.quantities = &app_.quantities;
  recording.writing.lock = lock_result(file, *app_.communicator);
  std::vector<KeptStep> steps = steps_;
  for (std::size_t i = 0; stored_ && i < steps.size(); ++i) {
    Simulation simulation = at(static_cast<int>(i));
    steps[i].state = simulation.state();
    steps[i].report.critical_points = stored_critical_points(simulation, *stored_, i);
  }
  app_.write(at(-1), steps, recording);
}

std::size_t SolvedRun::place_of(int step) const {
  const int count = static_cast<int>(steps_.size()), place = step < 0 ? count + step : step;
  if (place < 0 || place >= count)
    throw InputError("step " + std::to_string(step) + "; allowed: 0 to " + std::to_string(count - 1) +
                     ", or -1 for the last one");
  return static_cast<std::size_t>(place);
}

Simulation SolvedRun::at(int step) const {
  const std::size_t place = place_of(step);
  // as in the run: a second thread costs a small structure far more than the evaluation
  set_number_of_threads(std::min(number_of_threads(), app_.threads_for(simulation_->scene(), app_.solver)));
  const KeptStep& kept = steps_[place];
  const int jumps = kept.report.point.jumps;
  if (!stored_) return simulation_->at(kept.state, kept.report.load_factor, kept.stability, jumps);
  Simulation simulation = *simulation_;
  require_same_file();
  simulation.restore(stored_->state(place), kept.report.load_factor, kept.stability, jumps);
  require_same_file();
  return simulation;
}

std::vector<CriticalPoint> SolvedRun::critical_points() const {
  std::vector<CriticalPoint> all;
  Simulation simulation = *simulation_;
  for (std::size_t i = 0; i < steps_.size(); ++i)
    for (const CriticalPoint& point :
         stored_ ? stored_critical_points(simulation, *stored_, i) : steps_[i].report.critical_points)
      all.push_back(point);
  return all;
}

std::string meant_case(const Scene& scene, const std::optional<std::string>& wanted) {
  const std::vector<std::string> known = alternatives(scene);
  if (!wanted && known.empty()) return "";
  const std::string name = wanted.value_or("");
  if (std::find(known.begin(), known.end(), name) != known.end()) return name;
  throw InputError((wanted ? "case \"" + excerpt(name) + "\"" : "no case is named") +
                   ", but load cases and combinations of the scene are " +
                   (known.empty() ? "none" : quoted_list(known)) + "; allowed: one of them" +
                   did_you_mean(name, known));
}

}  // namespace mixbeam
