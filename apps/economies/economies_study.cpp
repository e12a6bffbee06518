// What the features that a scene does not use would cost: one long rod solved as it is, and with each of them in it at
// rest. Both ways must give the same answer; times are shown, not judged.
#include "apps/common/studies/study.hpp"
#include "apps/common/studies/variants.hpp"
#include "discretization/geometry/vector_algebra.hpp"

#include <limits>

namespace mixbeam {

namespace {

/// What Newton's tolerance leaves of a displacement, with a margin for soft structures.
constexpr double kSameSolution = 1e-9;
/// Inner points that carry a load of zero.
constexpr int kInnerPoints = 1000;
constexpr int kLoadSteps = 10;
/// A line load below rounding; one of zero would be ignored.
constexpr double kNothing = 1e-200;
/// Stiffness beside which 1 is bending: its strain is that of rounding.
constexpr double kNearlyRigid = 1e14;

/// One way to get at an answer, and what was measured of it.
struct Way {
  const char* description = "";
  Scene scene;
  SolverParameters solver;
  bool estimates = false;              ///< the discretization error at the end
  bool records = false;                ///< a result file
  std::vector<Quantity> quantities{};  ///< followed in it
  std::vector<double> seconds{};       ///< wall time from the scene to the answer, reading left out
  int iterations = 0;
  Vector3 tip{};  ///< displacement
};

/// As shipped, and the general way.
struct Economy {
  const char* name;
  Way plain, other;
};

template <class Value, class Change>
Value changed(Value value, const Change& change) {
  change(value);
  return value;
}

const std::string& tip_of(const Scene& scene) { return scene.point_loads.at(0).point; }

/// The same straight line from the origin along x, as any curve may be given.
Scene by_formula(Scene scene) {
  Curve& curve = scene.members.at(0).curve;
  curve.shape = CurveShape::parametric;
  curve.formula = {"t", "0", "0"};
  curve.range = {0.0, position_of(scene, tip_of(scene))[0]};
  return scene;
}

Scene with_line_load_of_nothing(Scene scene, LoadFrame frame) {
  DistributedLoad& load = scene.distributed_loads.emplace_back();
  load.member = scene.members.at(0).name;
  load.frame = frame;
  load.force[1] = kNothing;
  return scene;
}

Scene with_matrix(Scene scene) {
  Section& section = scene.sections.at(0);
  auto& matrix = section.matrix.emplace();
  matrix[0][0] = section.axial_stiffness;
  matrix[3][3] = section.torsional_stiffness;
  for (int i = 0; i < 2; ++i) {
    matrix[1 + i][1 + i] = section.shear_stiffness[i];
    matrix[4 + i][4 + i] = section.bending_stiffness[i];
  }
  return scene;
}

/// The same stiffnesses from a shape, so that stresses are known.
Scene with_shape(Scene scene) {
  SectionShape& shape = scene.sections.at(0).shape.emplace();
  shape.kind = SectionShapeKind::rectangle;
  shape.size2 = shape.size3 = 0.01;
  shape.youngs_modulus = 1.0;
  return scene;
}

Scene with_inner_points(Scene scene, bool loaded) {
  for (int i = 1; i <= kInnerPoints; ++i) {
    const std::string name = "inner " + std::to_string(i);
    scene.members.at(0).inner_points.push_back({name, i / (kInnerPoints + 1.0)});
    if (loaded) scene.point_loads.emplace_back().point = name;
  }
  return scene;
}

/// Axial force and shear cannot strain it.
Scene with_force_stiffness(Scene scene, double stiffness) {
  scene.sections.at(0).axial_stiffness = stiffness;
  scene.sections.at(0).shear_stiffness = {stiffness, stiffness};
  return scene;
}

/// Half as long again, without any load on the new part.
Scene with_overhang(Scene scene, int order, int elements) {
  Vector3 end = position_of(scene, tip_of(scene));
  end[0] *= 1.5;
  scene.points.push_back({"end", end});
  scene.members.push_back(straight_member(tip_of(scene), "end", scene.members.at(0).section, order, elements));
  return scene;
}

/// A quarter each: displacements and moments at places of the rod, distances to its tip, extremes along all of it.
std::vector<Quantity> hundred_quantities(const Scene& rod) {
  const std::array<std::string, 4> along = {"material force", "material moment", "spatial moment",
                                            "material curvature"};
  const std::string& member = rod.members.at(0).name;
  std::vector<Quantity> all(100);
  for (std::size_t i = 0; i < all.size(); ++i) {
    Quantity& one = all[i];
    one.name = "q" + std::to_string(i);
    one.kind = std::array<std::string, 4>{"displacement", "material moment", "distance", along[i / 4 % 4]}[i % 4];
    if (i % 4 < 3) {
      one.point = member + "@" + std::to_string(i) + "%";
      if (i % 4 == 2) one.other_point = tip_of(rod);
    } else {
      one.member = member;
      one.component = one.kind == along[2] ? "z" : "3";
      one.take = Take::largest_size;
    }
  }
  return all;
}

/// `rod`: a long straight cantilever with a load at its tip that bends and twists it.
std::vector<Economy> unused_features(const Scene& rod, const SolverParameters& given) {
  const auto solver = changed(given, [](auto& s) {
    s.analysis.stability = false;
    s.analysis.error_estimate = ErrorEstimation::off;  // but where it is what is measured
  });
  const auto in_space = changed(solver, [](auto& s) { s.planar = false; });
  const auto counting = changed(solver, [](auto& s) { s.analysis.stability = true; });
  const auto without_stresses = changed(solver, [](auto& s) { s.analysis.stresses = StressesOf::none; });
  const auto sparse = changed(solver, [](auto& s) { s.linear.method = "KLU2"; });
  const auto loose = changed(solver, [](auto& s) { s.linear.residual_tolerance = 1e-3; });
  const auto steps = with_fixed_steps(solver, kLoadSteps);
  const Scene planar = changed(rod, [](Scene& s) {  // loads that keep the rod in the plane of x and y
    PointLoad& load = s.point_loads.at(0);
    load.force[2] = load.moment[0] = load.moment[1] = 0.0;
  });
  const Scene with_held_twist = changed(planar, [](Scene& s) {  // at the tip, where nothing turns it
    s.supports.push_back(support_of(tip_of(s), {false, false, false}, {true, false, false}));
  });
  Quantity displacement;
  displacement.name = "tip";
  displacement.kind = "displacement";
  displacement.point = tip_of(rod);
  const double rigid = std::numeric_limits<double>::infinity();
  const int order = rod.members.at(0).order, elements = rod.members.at(0).elements;
  return {
      {"plane", {"rod in a plane, three unknowns for each vertex", planar, solver}, {"six unknowns", planar, in_space}},
      {"straight",
       {"straight line", rod, solver},
       {"the same line as a parametric curve, triads and curvature by formula", by_formula(rod), solver}},
      {"line_loads",
       {"no line load", rod, solver},
       {"dead line load of 1e-200: with loops over loads", with_line_load_of_nothing(rod, LoadFrame::dead), solver}},
      {"potential",
       {"all forces have a potential: symmetric tangents, chains condensed", rod, solver},
       {"follower line load of 1e-200: unsymmetric tangents, sparse solver",
        with_line_load_of_nothing(rod, LoadFrame::follower), solver}},
      {"section", {"six stiffnesses", rod, solver}, {"the same as a 6 x 6 matrix", with_matrix(rod), solver}},
      {"point_loads",
       {"1000 inner points without loads", with_inner_points(rod, false), solver},
       {"loads of zero there: none of these vertices is eliminated in a chain", with_inner_points(rod, true), solver}},
      {"rotation_support",
       {"free end", planar, in_space},
       {"rotation about the axis fixed there: one row that depends on the rotation", with_held_twist, in_space}},
      {"rigid",
       {"inextensible and shear rigid", with_force_stiffness(rod, rigid), solver},
       {"EA = GA = 1e14", with_force_stiffness(rod, kNearlyRigid), solver}},
      {"one_step", {"one load step", rod, solver}, {"ten equal load steps", rod, steps}},
      {"stability",
       {"stability not asked for", rod, solver},
       {"negative eigenvalues counted in every state", rod, counting}},
      {"estimate", {"error not estimated", rod, solver}, {"estimate at the end", rod, solver, true}},
      {"result_file", {"no result file", rod, solver}, {"HDF5 and XDMF written", rod, solver, false, true}},
      {"quantities",
       {"no quantities asked for, result file written", rod, solver, false, true},
       {"100 quantities, 25 of them extremes along the rod", rod, solver, false, true, hundred_quantities(rod)}},
      {"one_quantity",
       {"no quantity asked for, result file written", rod, solver, false, true},
       {"displacement of the tip asked for", rod, solver, false, true, {displacement}}},
      {"stresses",
       {"stresses along members off, result file written", with_shape(rod), without_stresses, false, true},
       {"stresses at the end, of a rectangle", with_shape(rod), solver, false, true}},
      {"no_stresses",
       {"stresses off, section given by its stiffnesses", rod, without_stresses, false, true},
       {"stresses where they are known, which is nowhere", rod, solver, false, true}},
      {"mesh_by_member",
       {"overhang without load: one element of order 1", with_overhang(rod, 1, 1), solver},
       {"overhang divided like the rest", with_overhang(rod, order, elements / 2), solver}},
      {"chains", {"chains condensed to their ends", rod, solver}, {"KLU2 on the whole matrix", rod, sparse}},
      {"loose", {"linear solves checked to 1e-8", rod, solver}, {"to 1e-3", rod, loose}},
  };
}

void run_once(Application& app, Way& way) {
  const RunWatch watch;
  const ParameterSource no_file;
  const QuantitySet quantities(way.quantities, way.scene, {no_file, {}});
  Recording recording;
  recording.file = app.output / "recorded.h5";
  if (!quantities.empty()) recording.quantities = &quantities;
  const Simulation simulation =
      way.records ? app.record(way.scene, way.solver, recording) : app.try_to_solve(way.scene, way.solver);
  if (way.estimates) simulation.estimate_error();
  way.seconds.push_back(watch.seconds());
  if (!simulation.result().finished)
    throw ConvergenceError(std::string(way.description) + ": no equilibrium was found");
  way.iterations = simulation.result().newton_iterations;
  way.tip = simulation.displacement(tip_of(way.scene));
}

/// Both ways in turn, so that a machine that slows down for a while does so for both; the first round warms up.
void measure(Application& app, Economy economy, StudyTable& table) {
  auto& [name, plain, other] = economy;
  for (int round = 0; round <= app.study().get<int>("Rounds"); ++round) {
    if (round == 1) plain.seconds = other.seconds = {};
    run_once(app, plain);
    run_once(app, other);
  }
  const double difference =
      vector_algebra::norm(vector_algebra::difference(plain.tip, other.tip)) / vector_algebra::norm(plain.tip);
  const Member& rod = app.scene.members.front();
  std::vector<double> ratios;  // of neighbours in time: what the machine does beside is the same for both
  for (size_t i = 0; i < plain.seconds.size(); ++i) ratios.push_back(other.seconds[i] / plain.seconds[i]);
  table.add_row({name, median(plain.seconds), median(other.seconds), median(ratios), plain.iterations, other.iterations,
                 difference, plain.description, other.description, rod.order, rod.elements});
  app.summary.check_upper_bound(std::string(name) + ": difference of the two ways", difference, kSameSolution,
                                "the same scene, solved the other way");
}

ListSpec economies_spec() {
  ListSpec spec("How both ways are timed.");
  spec.add(count("Rounds", 5, 1000, "Timed runs of each way, in turn."));
  spec.add(count("Threads", 1, 1024, "OpenMP threads."));
  return spec;
}

void run_economies_study(Application& app) {
  if (app.scene.point_loads.size() != 1 || app.scene.members.size() != 1)
    throw app.xml.source.error({"Scene"}, std::to_string(app.scene.members.size()) + " members and " +
                                              std::to_string(app.scene.point_loads.size()) +
                                              " point loads; allowed: one rod along x from the origin with one load at "
                                              "its end, to which the study adds what it compares");
  StudyTable table(app, "economies.csv",
                   words("name,plain_seconds,other_seconds,ratio,plain_iterations,other_iterations,difference,plain,"
                         "other,order,elements"),
                   7);
  app.quiet = true;  // hundreds of runs
  app.solver.threads = app.study().get<int>("Threads");
  for (const Economy& economy : unused_features(app.scene, app.solver)) measure(app, economy, table);
  write_machine(app);
  if (!app.writes_files()) return;
  std::filesystem::remove(app.output / "recorded.h5");
  std::filesystem::remove(app.output / "recorded.xdmf");
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  return mixbeam::run_study(
      argc, argv, "economies",
      "one long rod solved as it is, and with the features that it does not use: times and results.",
      mixbeam::economies_spec(), mixbeam::run_economies_study);
}
