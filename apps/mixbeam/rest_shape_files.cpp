#include "apps/mixbeam/found_scene.hpp"

#include "apps/common/run/scene_file.hpp"
#include "apps/common/tables/csv_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/commands.hpp"
#include "discretization/parameters/parameter_file.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/text_file.hpp"
#include "kernels/execution/execution_space.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/run/rest_shape.hpp"

#include <algorithm>
#include <cctype>
#include <set>

namespace mixbeam {

namespace {

using List = Teuchos::ParameterList;

const std::string kInverse = "Inverse";
/// Stations of a natural curve per element, for splines.
constexpr int kStationsOfElement = 4;
/// Displacement over size of the structure: far above the error of Newton's method.
constexpr double kArrived = 1e-6;
/// Forces relative to those under loads: far above the error of Newton's method.
constexpr double kNoStress = 1e-8;

/// Unique file names for members.
class FileNames {
 public:
  std::string of(std::string member) {
    for (char& c : member)
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '.') c = '_';
    std::string name = member;
    for (int i = 2; !taken_.insert(name).second; ++i) name = member + "_" + std::to_string(i);
    return name;
  }

 private:
  std::set<std::string> taken_;
};

void write_table(const std::filesystem::path& file, const FieldTable& table) {
  CsvTable csv(file, {"element", "s", "1", "2", "3"}, Appears::when_closed);
  for (size_t e = 0; e < table.pieces.size(); ++e) {
    const FieldTable::Piece& piece = table.pieces[e];
    for (size_t i = 0; i < piece.s.size(); ++i)
      csv.add_row({e + 1, piece.s[i], piece.value[i][0], piece.value[i][1], piece.value[i][2]});
  }
  csv.close();
}

void write_curve(const std::filesystem::path& file, const std::vector<NaturalStation>& curve) {
  std::vector<std::string> columns = {"s", "natural s", "x", "y", "z"};
  for (const char* axis : {"axis 1", "axis 2", "axis 3"})
    for (const char* component : {" x", " y", " z"}) columns.push_back(std::string(axis) + component);
  CsvTable csv(file, columns, Appears::when_closed);
  for (const NaturalStation& station : curve) {
    std::vector<CsvCell> row = {station.arc_length, station.natural_length};
    row.insert(row.end(), station.position.begin(), station.position.end());
    for (const Vector3& axis : station.triad) row.insert(row.end(), axis.begin(), axis.end());
    csv.add_row(row);
  }
  csv.close();
}

Teuchos::Array<double> array_of(const Vector3& v) { return {v.begin(), v.end()}; }

/// Writes tables and curves of all members, and enters them in the list "Eigenstrains".
void write_members(const Application& app, const RestShape& shape, const std::string& name, List& eigenstrains) {
  FileNames names;
  const Mesh mesh = build_mesh(app.scene);
  for (size_t m = 0; m < shape.members.size(); ++m) {
    const NaturalMember& member = shape.members[m];
    const std::string file = names.of(member.name);
    const auto file_of = [&](const char* what) { return name + "-" + what + "-" + file + ".csv"; };
    write_table(app.output / file_of("strain"), member.tables[0]);
    write_table(app.output / file_of("curvature"), member.tables[1]);
    write_curve(app.output / file_of("natural"), natural_curve(mesh.members[m], member, kStationsOfElement));
    List& strain = eigenstrains.sublist("rest shape of " + member.name);
    strain.set("Member", member.name);
    strain.set("Strain Table", file_of("strain"));
    strain.set("Curvature Table", file_of("curvature"));
    if (!vector_algebra::is_zero(member.end_turns[0])) strain.set("Start Turn", array_of(member.end_turns[0]));
    if (!vector_algebra::is_zero(member.end_turns[1])) strain.set("End Turn", array_of(member.end_turns[1]));
    strain.set("Stage", shape.stage);
  }
}

void tell(Application& app, const RestShape& shape, const std::filesystem::path& scene) {
  double longer = 0.0;
  const Mesh mesh = build_mesh(app.scene);
  for (size_t m = 0; m < shape.members.size(); ++m)
    longer = std::max(longer, std::abs(shape.members[m].cut_length - mesh.member_length[m]));
  std::map<std::string, double>& numbers = app.summary.rest_shape;
  numbers = {{"largest elastic curvature", shape.largest_curvature},
             {"largest elastic strain", shape.largest_strain},
             {"largest turn of an end", shape.largest_turn},
             {"largest change of length", longer},
             {"redundant forces", shape.redundancy},
             {"residual of the drawn state", shape.residual},
             {"negative eigenvalues of the drawn state", shape.negative}};
  if (shape.redundancy > 0) numbers["stress left without loads"] = shape.stress_left;
  app.out() << "Rest shape: " << scene.string() << "\n";
  for (const auto& [word, value] : numbers) app.out() << "  " << word << formatted(" %.6g\n", value);
  if (!shape.stable.empty()) app.out() << "  drawn state stable: " << shape.stable << "\n";
  if (shape.negative > 0)
    app.warn("the drawn shape is an unstable equilibrium (negative eigenvalues: " + std::to_string(shape.negative) +
             "): the structure leaves it");
  if (shape.redundancy > 0 && !(shape.stress_left <= kNoStress))
    app.warn("the structure has loops, and with these natural strains it keeps stress without its loads: " +
             formatted("%.3g", shape.stress_left) +
             " of the forces that it has under them (\"Loops\" = \"closed\": none)");
}

/// Warns if the run does not end in the drawn shape, which may be unstable.
void watch_end(Application& app, const std::string& load_case) {
  app.watch = [&app, load_case](const Simulation& run, const StepReport& step) {
    if (app.load_case != load_case || !run.is_end_of_path(step.load_factor)) return;
    double missed = 0.0;
    for (const auto& [point, vertex] : run.model().mesh().vertex_of_point)
      missed = std::max(missed, vector_algebra::norm(run.displacement(point)));
    if (!(missed <= kArrived * characteristic_length(run.model().mesh())))
      app.warn("the run from the rest shape ends in another equilibrium, " + formatted("%.3g", missed) +
               " away from the drawn shape");
  };
}

RestShape found_rest_shape(const Application& app) {
  const ParameterSource& source = app.xml.source;
  set_number_of_threads(app.threads_for(app.scene, app.solver));
  try {
    return find_rest_shape(app.scene, read_rest_shape_parameters(app.xml.list->sublist(kInverse)), app.solver,
                           app.communicator, InputPlace(source, {kInverse}));
  } catch (const MemberError& error) {
    throw placed(app, error);
  } catch (const LinearSolverError& error) {
    throw ConvergenceError(std::string("the rest shape: ") + error.what());
  }
}

}  // namespace

void copy_imported(const ParameterSource& source, const std::filesystem::path& folder, const std::string& list) {
  for (const auto& [name, text] : source.files()) {
    const std::filesystem::path relative = std::filesystem::path(name).lexically_normal();
    if (relative.is_absolute()) continue;
    if (*relative.begin() == "..")
      throw source.error({list}, "given, but the scene names the table \"" + excerpt(name) +
                                     "\"; allowed: tables in its folder or below it, which are copied");
    const std::filesystem::path copy = folder / relative;
    std::error_code none;
    if (std::filesystem::exists(copy, none) && text_of_file(copy.string(), "a table") == text) continue;
    std::filesystem::create_directories(copy.parent_path(), none);
    replace_file(copy, text, false);
  }
}

void take_rest_shape(Application& app, const std::string& name, int jobs) {
  if (!app.xml.list->isSublist(kInverse)) return;
  const ParameterSource& source = app.xml.source;
  if (app.mesh_is_free)
    throw source.error({kInverse}, "given, but the scene names no mesh; allowed: with \"Elements\" of members");
  if (jobs > 1)
    throw source.error({kInverse}, "given with --jobs " + std::to_string(jobs) + "; allowed: one case after the other");
  const std::string load_case = app.xml.list->sublist(kInverse).get<std::string>("Case", "");
  const RestShape shape = found_rest_shape(app);
  const ListSpec& root = mixbeam_root_spec();
  const XmlParameters scene = parse_parameters(app.xml.text, source.file(), root);
  scene.list->remove(kInverse);
  write_members(app, shape, name, scene.list->sublist("Scene").sublist("Eigenstrains"));
  copy_imported(source, app.output, kInverse);
  const std::filesystem::path file = app.output / (name + "-forward.xml");
  replace_file(file, xml_text(*scene.list), false);
  tell(app, shape, file);
  const int threads = app.solver.threads;  // of the command line, or their limit
  read_scene_file(app, read_parameters(file.string(), root, Mistakes::kept), mixbeam_definition(), root);
  app.solver.threads = threads;
  watch_end(app, load_case);
  // displacements are rounding errors, whose accuracy has no meaning
  if (app.solver.analysis.error_estimate == ErrorEstimation::automatic)
    app.solver.analysis.error_estimate = ErrorEstimation::off;
}

void refuse_rest_shape(const Application& app) {
  if (app.xml.list->isSublist(kInverse))
    throw app.xml.source.error({kInverse},
                               "given, but this program solves scenes as they stand; allowed: mixbeam run "
                               "of this scene, and then the scene that it writes");
}

}  // namespace mixbeam
