// Drawings of scenes before they are solved.
#include "apps/common/run/scene_file.hpp"
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/checks/mechanism.hpp"
#include "discretization/scene/load_cases.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <sstream>

namespace mixbeam {

namespace {

using Teuchos::ParameterList;

/// Parts of a scene to omit, increased until the rest can be drawn.
enum class LeftOut { nothing, conditions, curves };
constexpr const char* kDrawn[] = {"", "The picture leaves out supports, joints and loads.",
                                  "The picture shows chords of members between points; all else is left out."};

/// Keeps only the lists that define the geometry of members.
void keep_structure(ParameterList& root) {
  const ParameterList scene = root.sublist("Scene");
  const std::string name = root.name();
  root = ParameterList(name);
  for (const char* kept : {"Sections", "Points", "Members", "Import", "Patterns"})
    if (scene.isSublist(kept)) root.sublist("Scene").sublist(kept) = scene.sublist(kept);
  if (scene.isParameter("Units")) root.sublist("Scene").setEntry("Units", scene.getEntry("Units"));
}

/// Replaces members by straight lines of one section between existing points.
void keep_chords(ParameterList& scene) {
  const ParameterList members = scene.sublist("Members");
  scene.remove("Sections", false);
  scene.remove("Patterns", false);
  ParameterList& section = scene.sublist("Sections").sublist("line");
  for (const char* stiffness : {"EA", "GIt", "EI2", "EI3"}) section.set(stiffness, 1.0);
  section.set("Shear Rigid", true);
  scene.sublist("Members") = ParameterList();
  const ParameterList& points = scene.sublist("Points");
  for (auto entry = members.begin(); entry != members.end(); ++entry) {
    if (!members.isSublist(members.name(entry))) continue;
    const ParameterList& member = members.sublist(members.name(entry));
    const auto has = [&](const char* end) {
      return member.isType<std::string>(end) && points.isParameter(member.get<std::string>(end));
    };
    if (!has("Start") || !has("End")) continue;
    ParameterList& chord = scene.sublist("Members").sublist(members.name(entry));
    for (const char* end : {"Start", "End"}) chord.set(end, member.get<std::string>(end));
    chord.set("Section", std::string("line"));
  }
}

/// "0*3 1*2": three members of part 0 before two of part 1.
std::string run_lengths(const std::vector<int>& numbers) {
  constexpr std::size_t kLongest = 60'000;  // of an attribute in HDF5
  std::ostringstream text;
  for (std::size_t i = 0, end = 0; i < numbers.size(); i = end) {
    while (end < numbers.size() && numbers[end] == numbers[i]) ++end;
    text << (i > 0 ? " " : "") << numbers[i] << "*" << end - i;
  }
  return text.str().size() > kLongest ? "" : text.str();
}

/// Free motions as buckling modes at load factor 0.
std::vector<RecordedBucklingMode> modes_of(const LooseStructure& loose, const std::vector<MemberSamples>& samples) {
  using namespace vector_algebra;
  std::vector<RecordedBucklingMode> modes;
  for (const std::vector<RigidVelocity>& velocities : loose.motions) {
    RecordedBucklingMode& mode = modes.emplace_back();
    for (std::size_t m = 0; m < samples.size(); ++m)
      for (const Vector3& position : samples[m].reference_position)
        mode.mode.push_back(
            sum(velocities[m].translation, cross(velocities[m].rotation, difference(position, velocities[m].center))));
  }
  return modes;
}

/// Points per element for smooth curves of coarse meshes.
int points_per_element(const Scene& scene) {
  constexpr int kMostSamples = 3000, kMostPoints = 17;
  const auto points = static_cast<long>(kMostSamples / std::max(elements_of(scene), 1LL));
  return points <= kMaximumOrder ? kPointsByOrder : static_cast<int>(std::min<long>(points, kMostPoints));
}

void write_case(Application& app, const std::filesystem::path& file, const std::string& load_case, LeftOut left_out) {
  Scene scene = scene_of_case(app.scene, load_case);
  if (scene.accuracy) scene = on_mesh(scene, start_mesh(scene, *scene.accuracy));
  const Simulation simulation(scene, app.solver, app.communicator);
  const LooseStructure loose = loose_structure(scene);
  Recording recording;
  recording.file = file;
  recording.points_per_element = points_per_element(scene);
  recording.properties = properties_of_case(load_case);
  recording.properties["drawn"] = kDrawn[static_cast<int>(left_out)];
  recording.properties["connected_parts"] = run_lengths(loose.part_of_member);
  if (left_out == LeftOut::nothing)
    recording.motions = modes_of(loose, simulation.samples(recording.points_per_element));
  KeptStep undeformed;
  undeformed.state = simulation.state();
  app.write(simulation, {undeformed}, recording);
}

}  // namespace

void write_undeformed(const std::function<XmlParameters()>& read, const Communicator& communicator,
                      const std::filesystem::path& folder, const std::string& name,
                      const std::optional<std::string>& load_case) {
  if (communicator->getSize() > 1)
    throw InputError("--output of mixbeam check under mpirun, which draws nothing; allowed: one rank");
  std::string first_problem;
  for (const LeftOut left_out : {LeftOut::nothing, LeftOut::conditions, LeftOut::curves}) {
    std::ostringstream nowhere;
    std::string loose;
    Application app;
    app.communicator = communicator;
    app.terminal = &nowhere;
    app.loose = &loose;
    app.name = "mixbeam";
    try {
      XmlParameters parameters = read();
      if (left_out != LeftOut::nothing) keep_structure(*parameters.list);
      if (left_out == LeftOut::curves) keep_chords(parameters.list->sublist("Scene"));
      read_scene_file(app, std::move(parameters), mixbeam_definition(), mixbeam_root_spec());
      app.solver.analysis.buckling_modes = 0;
      app.solver.analysis.modes = {};
      prepare_output_folder(folder);
      const bool has_cases = !alternatives(app.scene).empty();
      for (const std::string& one : chosen_cases(app.scene, has_cases ? load_case : std::nullopt))
        write_case(app, result_file_of(folder, name, one), one, left_out);
      return;
    } catch (const InputError& error) {
      if (first_problem.empty()) first_problem = error.what();
    }
  }
  throw InputError(first_problem);
}

}  // namespace mixbeam
