// Rest shapes: closed forms, and structures that their loads deform into the shape that is drawn.
#include "nonlinear/run/rest_shape.hpp"
#include "discretization/checks/mechanism.hpp"
#include "tests/problems/random_scenes.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/scene_file.hpp"
#include "tests/support/solve.hpp"

#include <functional>
#include <optional>

namespace mixbeam::test::rest_shape_test {
namespace {

// Sums of a few products of size one.
constexpr double kRounding = 1e-14;
// Of the drawn state: rounding of the rows, which are divided by the largest force, strain or length.
constexpr double kResidual = 1e-12;
// Where Newton's method stops.
constexpr double kSolved = 1e-10;

const RestShapeParameters kTurned{}, kNatural{LoopForces::refused, false};

InputPlace place_of_list() {
  static const ParameterSource source("scene.xml");
  return {source, {"Inverse"}};
}

RestShape rest_shape(const Scene& scene, const RestShapeParameters& wanted = kTurned) {
  return find_rest_shape(scene, wanted, {}, this_rank(), place_of_list());
}

/// Largest displacement of a point of the scene after a run from the rest shape: there is none.
double missed(const Scene& scene, const RestShape& shape) {
  const Simulation run = solved(with_rest_shape(scene, shape));
  double largest = 0.0;
  for (const auto& [point, vertex] : run.model().mesh().vertex_of_point)
    largest = std::max(largest, vector_algebra::norm(run.displacement(point)));
  return largest;
}

/// Over the points of a table of curvatures: largest difference of a component.
double error_of(const NaturalMember& member, int component, const std::function<double(double s)>& right) {
  double error = 0.0;
  for (const FieldTable::Piece& piece : member.tables[1].pieces)
    for (std::size_t i = 0; i < piece.s.size(); ++i)
      error = std::max(error, std::abs(piece.value[i][component] - right(piece.s[i])));
  return error;
}

void expect_found(const Scene& scene, const RestShapeParameters& wanted = kTurned) {
  const RestShape shape = rest_shape(scene, wanted);
  EXPECT_LE(shape.residual, kResidual) << scene.name;
  EXPECT_LE(missed(scene, shape), kSolved) << scene.name;
}

/// Stiff in shear, EI = L = 1, along e1, under its weight.
Scene straight_rod(double weight_per_length, int order, int elements, double shear = kRigid) {
  Scene scene = cantilever(section(kRigid, shear, 1.0, 1.0), 1.0, order, elements);
  scene.distributed_loads = {{"beam", {0, -weight_per_length, 0}}};
  return scene;
}

// M = -w (L - s)^2 / 2 about e3, and the rest shape is bent upwards by it: kappa = w (L - s)^2 / (2 EI).
TEST(RestShape, OfStraightRodUnderItsWeight) {
  for (const double w : {0.1, 7.0, 60.0})
    for (const int order : {2, 3, 4, 8}) {
      const RestShape shape = rest_shape(straight_rod(w, order, 5));
      EXPECT_LE(error_of(shape.members[0], 2, [w](double s) { return 0.5 * w * (1.0 - s) * (1.0 - s); }), kRounding * w)
          << order << ", " << w;
      EXPECT_LE(shape.residual, kResidual);
      EXPECT_EQ(shape.redundancy, 0);
    }
}

TEST(RestShape, IsDeformedIntoTheDrawnShape) {
  for (const double w : {0.1, 7.0})
    for (const int order : {1, 2, 4}) {
      const Scene scene = straight_rod(w, order, 5);
      RestShape shape = rest_shape(scene);
      EXPECT_LE(missed(scene, shape), kSolved) << order << ", " << w;
      for (FieldTable::Piece& piece : shape.members[0].tables[1].pieces)
        for (Vector3& curvature : piece.value) curvature[2] *= 1.01;
      EXPECT_GE(missed(scene, shape), 1e3 * kSolved);  // the twin: a rest shape that is wrong by a hundredth
    }
}

// A section that turns by chi against the drawn axis bears Q = w (L - s) cos(chi), and sin(chi) = Q / GA.
TEST(RestShape, TurnsSectionsWhereShearIsSoft) {
  constexpr double w = 0.5, shear = 40.0;
  const Scene scene = straight_rod(w, 3, 5, shear);
  const RestShape shape = rest_shape(scene);
  const auto right = [&](double s) {
    const double tangent = w * (1.0 - s) / shear;
    return 0.5 * w * (1.0 - s) * (1.0 - s) - w / shear / (1.0 + tangent * tangent);
  };
  constexpr double kInterpolated = 1e-7;  // of the slope of that angle, whose quadratic an element has
  EXPECT_LE(error_of(shape.members[0], 2, right), kInterpolated);
  EXPECT_NEAR(std::abs(shape.members[0].end_turns[0][2]), std::atan(w / shear), kInterpolated);
  EXPECT_LE(shape.residual, kResidual);
  EXPECT_LE(missed(scene, shape), kSolved);
  const RestShape natural = rest_shape(scene, kNatural);
  EXPECT_LE(error_of(natural.members[0], 2, [](double s) { return 0.5 * w * (1.0 - s) * (1.0 - s); }), kRounding);
  EXPECT_NEAR(std::abs(natural.members[0].tables[0].pieces[0].value[0][1]),
              w * (1.0 - natural.members[0].tables[0].pieces[0].s[0]) / shear, kRounding);
  EXPECT_LE(missed(scene, natural), kSolved);
}

// Lateral buckling: Timoshenko, Gere, Theory of Elastic Stability, art. 6.3, w L^3 / sqrt(EI GIt) = 12.8538.
TEST(RestShape, CountsHowTheDrawnRodIsUnstable) {
  for (const auto& [w, negative] : {std::pair{12.852, 0}, std::pair{12.856, 1}}) {
    Scene scene = straight_rod(w, 4, 8);
    EXPECT_EQ(rest_shape(scene).negative, negative) << w;
  }
}

Scene tree(bool follows) {
  Scene scene = fork(3, 4);
  scene.sections = {section(900.0, 300.0, 80.0, 100.0)};
  scene.stages = 1;
  scene.point_loads = {dead_load("tine 1", {3, 5, 20}, {1, -2, 3}), dead_load("tine 2", {0, 10, -20})};
  if (follows) {
    scene.point_loads[1] = follower_load("tine 2", "right", {0, 10, -20}, {2, 0, 1});
    scene.distributed_loads = {{"left", {0, 4, -10}}};
    scene.distributed_loads[0].frame = LoadFrame::follower;
  }
  return scene;
}

TEST(RestShape, OfTreesKinksAndFollowers) {
  for (const RestShapeParameters& wanted : {kTurned, kNatural}) {
    Scene kinked = slope_discontinuity(3, 3), arc = arc_segment(20.0, 4, 6);
    for (Scene* scene : {&kinked, &arc}) {  // drawn shapes that are stable
      Vector3& force = scene->point_loads[0].force;
      force = vector_algebra::scaled(0.1, force);
    }
    expect_found(kinked, wanted);
    expect_found(arc, wanted);
    expect_found(tree(false), wanted);
    expect_found(tree(true), wanted);
  }
}

// Three hinges make a portal determinate; two leave one force free.
TEST(RestShape, OfPortalNeedsItsHinges) {
  Scene scene;
  scene.name = "portal";
  scene.sections = {section(5e3, 2e3, 10.0, 10.0)};
  scene.points = {{"a", {0, 0, 0}}, {"b", {0, 1, 0}}, {"m", {0.6, 1.2, 0}}, {"c", {1.5, 1, 0}}, {"d", {1.5, 0, 0}}};
  scene.members = {line("left", "a", "b", 3, 3), line("first", "b", "m", 3, 3), line("second", "m", "c", 3, 3),
                   line("right", "c", "d", 3, 3)};
  scene.supports = {hinged("a"), hinged("d")};
  scene.distributed_loads = {{"first", {0, -6, 0}}, {"second", {0, -9, 0}}, {"left", {2, 0, 0}}};
  EXPECT_THROW(rest_shape(scene), InputError);
  const RestShapeParameters least{LoopForces::least_energy, true};
  EXPECT_EQ(rest_shape(scene, least).redundancy, 1);
  expect_found(scene, least);
  scene.joints = {joint(JointKind::hinge, "m", {"second"}, {0, 0, 1})};
  EXPECT_EQ(rest_shape(scene).redundancy, 0);
  expect_found(scene);
}

/// A helix of a round wire that is drawn under a force and a moment at its tip.
Scene loaded_helix(int order, int elements, const Vector3& force, const Vector3& moment) {
  Scene scene = cantilever(section(kRigid, kRigid, 0.8, 1.0), 1.0, order, elements);
  scene.points = {{"clamp", {1, 0, 0}}};
  Curve& curve = scene.members[0].curve;
  curve.shape = CurveShape::helix;
  curve.angle = 4.0;
  curve.rise = 1.5;
  scene.point_loads = {dead_load("tip", force, moment)};
  return scene;
}

// M by statics, M(s) = m + (r(L) - r(s)) x f in space: the error of the elastic curvature falls with its order k + 1.
TEST(RestShape, OfSpatialRodHasTheMomentsOfStatics) {
  const Vector3 force{0.3, -0.4, 0.9}, moment{0.5, 0.2, -0.3};
  const auto error = [&](int order, int elements) {
    const Scene scene = loaded_helix(order, elements, force, moment);
    const RestShape shape = rest_shape(scene);
    const Mesh mesh = build_mesh(scene);
    const ReferenceCurve& curve = mesh.members[0].curve;
    const auto vector = [](const Vector3& v) { return Vec3<double>{{v[0], v[1], v[2]}}; };
    double largest = 0.0;
    for (const FieldTable::Piece& piece : shape.members[0].tables[1].pieces)
      for (std::size_t i = 0; i < piece.s.size(); ++i) {
        const Vec3<double> M =
            vector(moment) + cross(curve.position(curve.length) - curve.position(piece.s[i]), vector(force));
        const Vec3<double> right = transpose_times(rotation_matrix(curve.triad(piece.s[i])), M);
        const double stiffness[3] = {0.8, 1.0, 1.0};
        for (std::size_t c = 0; c < 3; ++c)
          largest = std::max(largest, std::abs(piece.value[i][c] + right[c] / stiffness[c]));
      }
    return largest;
  };
  for (const int order : {2, 3, 4}) {
    const double coarse = error(order, 8), fine = error(order, 16), rate = std::log2(coarse / fine);
    EXPECT_GE(rate, order + 0.8) << order;
  }
}

/// Two feet in space, clamped, with legs that lean and a beam that sags under loads from all sides.
Scene frame_in_space(double load) {
  Scene scene = structure({{"a", {0, 0, 0}}, {"b", {0.1, 0.3, 1}}, {"c", {1.2, 0.1, 1.1}}, {"d", {1.3, 0, 0}}},
                          {line("left", "a", "b", 3, 3), line("beam", "b", "c", 3, 4), line("right", "c", "d", 3, 3)},
                          {clamp("a"), clamp("d")}, {}, section(2e3, 8e2, 6.0, 10.0));
  scene.distributed_loads = {{"beam", {0, load, -3.0 * load}}, {"left", {load, 0, 0}}};
  return scene;
}

Scene clamped_arch(double load) {
  Scene scene = structure({{"a", {-0.6, 0.8, 0}}, {"b", {0.6, 0.8, 0}}},
                          {arc("arch", "a", "b", {0, 0, 0}, {0, 0, -1}, 2.0 * std::asin(0.6), 3, 8)},
                          {clamp("a"), clamp("b")}, {}, section(1e3, kRigid, 1.0, 1.0));
  scene.distributed_loads = {{"arch", {0.4 * load, -load, 0}}};
  return scene;
}

// The forward solver says what is left of forces without loads; Newton's method stops where its residual is 1e-11.
TEST(RestShape, OfLoopsIsFreeOfStressWithoutLoads) {
  constexpr double kNoStress = 1e-10, kStressOfLeastEnergy = 1e-3;
  const RestShapeParameters closed{LoopForces::closed, true}, least{LoopForces::least_energy, true};
  for (const Scene& scene : {clamped_arch(10.0), frame_in_space(5.0)}) {
    const RestShape shape = rest_shape(scene, closed);
    EXPECT_LE(shape.stress_left, kNoStress) << scene.name;
    EXPECT_LE(shape.residual, kResidual) << scene.name;
    EXPECT_GE(rest_shape(scene, least).stress_left, kStressOfLeastEnergy) << scene.name;
  }
}

/// Deformed members as splines through their samples, with the tangents of their ends.
Scene drawn_as_deformed(const Simulation& run, int order, int elements) {
  Scene scene = run.scene();
  const auto end_tangent = [](const TriadQuaternion& q) {
    const Vec3<double> tangent =
        rotation_matrix(Quaternion<double>{q[0], q[1], q[2], q[3]}) * Vec3<double>{{1.0, 0.0, 0.0}};
    return Vector3{tangent[0], tangent[1], tangent[2]};
  };
  const std::vector<MemberSamples> samples = run.samples(13);
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    Member& member = scene.members[m];
    member.order = order;
    member.elements = elements;
    member.curve.shape = CurveShape::spline;
    const MemberSamples& of = samples[m];
    for (std::size_t i = 1; i + 1 < of.size(); ++i)
      if (of.arc_length[i] > of.arc_length[i - 1]) member.curve.through.push_back(of.position[i]);
    member.curve.end_tangents = {end_tangent(of.triad.front()), end_tangent(of.triad.back())};
  }
  for (Point& point : scene.points) point.position = run.position(point.name);
  return scene;
}

/// A structure of straight members, inextensible and rigid in shear: natural strains and stiffnesses refer to drawn
/// lengths. Clamped at points whose names begin with "foot", hinged about e3 at those that begin with "hinge".
Scene straight_frame(const std::string& name, std::vector<Point> points,
                     const std::vector<std::pair<std::string, std::string>>& members, std::vector<PointLoad> loads) {
  Scene scene;
  scene.name = name;
  scene.sections = {section(kRigid, kRigid, 0.8, 1.0)};
  for (const auto& [start, end] : members) scene.members.push_back(line(start + " to " + end, start, end, 8, 16));
  for (const Point& point : points) {
    if (point.name.rfind("foot", 0) == 0) scene.supports.push_back(clamp(point.name));
    if (point.name.rfind("hinge", 0) == 0) scene.supports.push_back(hinged(point.name));
  }
  scene.points = std::move(points);
  scene.point_loads = std::move(loads);
  return scene;
}

std::vector<Scene> straight_frames() {
  std::vector<Scene> all;
  const auto bents = [&](const std::string& name, const std::vector<Vector3>& at, const std::vector<PointLoad>& loads,
                         const std::string& end = "foot") {
    all.push_back(straight_frame(name, {{end + " a", {0, 0, 0}}, {"b", at[0]}, {"c", at[1]}, {end + " d", at[2]}},
                                 {{end + " a", "b"}, {"b", "c"}, {"c", end + " d"}}, loads));
  };
  const std::vector<Vector3> portal{{0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
  bents("portal", portal, {dead_load("b", {2, -2, 0}), dead_load("c", {0, -2, 0})});
  bents("portal out of its plane", portal, {dead_load("b", {1, 0, 2}, {0, 1, 0})});
  bents("leaning portal", {{0.4, 1, 0}, {1, 0.8, 0}, {1.3, 0, 0}}, {dead_load("c", {4, 0, 0}, {0, 0, 1})});
  bents("portal on hinges", portal, {dead_load("b", {1, -1, 0})}, "hinge");
  bents("follower on a portal", portal, {follower_load("b", "b to c", {3, 0, 0})});
  bents("kinked beam between walls", {{0.6, 0.5, 0}, {1.1, 0.4, 0}, {1.6, 0, 0}},
        {dead_load("b", {0, -8, 0}), dead_load("c", {0, 5, 0}, {0, 0, 2})});
  bents("frame in space", {{0.1, 0.3, 1}, {1.2, 0.1, 1.1}, {1.3, 0, 0}},
        {dead_load("b", {1, 2, -1}), dead_load("c", {0, 2, 0}, {1, 0, 0})});
  bents("hook in space", {{0, 0, 1}, {0.8, 0, 1}, {0.8, 0.9, 1}},
        {dead_load("b", {3, 0, 0}), dead_load("c", {0, 0, -4})});
  all.push_back(straight_frame("two bays",
                               {{"foot a", {0, 0, 0}},
                                {"b", {0, 1, 0}},
                                {"c", {1, 1.1, 0}},
                                {"foot d", {1, 0, 0}},
                                {"e", {2.2, 1, 0}},
                                {"foot f", {2.2, 0.2, 0}}},
                               {{"foot a", "b"}, {"b", "c"}, {"c", "foot d"}, {"c", "e"}, {"e", "foot f"}},
                               {dead_load("b", {5, 0, 0}), dead_load("e", {2, 0, 0})}));
  all.push_back(straight_frame(
      "tripod",
      {{"foot a", {1, 0, 0}},
       {"foot b", {-0.5, 0.8, 0}},
       {"foot c", {-0.5, -0.9, 0}},
       {"knee", {0.9, 0.2, 0.8}},
       {"hip", {-0.4, 0.5, 0.9}},
       {"elbow", {-0.3, -0.7, 0.7}},
       {"top", {0, 0, 1.2}}},
      {{"foot a", "knee"}, {"knee", "top"}, {"foot b", "hip"}, {"hip", "top"}, {"foot c", "elbow"}, {"elbow", "top"}},
      {dead_load("top", {2, 1, 0}, {0, 0, 1})}));
  return all;
}

// Structures of straight members, made without force, are deformed by their loads; drawn so, their rest shapes are
// straight.
TEST(RestShape, ClosedIsTheInverseOfARun) {
  constexpr double kIdentity = 1e-9, kBentByLeastEnergy = 1e-6, kDeformed = 0.05;
  for (const Scene& made : straight_frames()) {
    const Simulation run = solved(made);
    double largest_motion = 0.0;
    for (const Point& point : made.points)
      largest_motion = std::max(largest_motion, vector_algebra::norm(run.displacement(point.name)));
    EXPECT_GE(largest_motion, kDeformed) << made.name;
    const Scene drawn = drawn_as_deformed(run, 4, 24);
    const Mesh mesh = build_mesh(drawn);
    const auto bent = [&](LoopForces loops) {
      const RestShape shape = rest_shape(drawn, {loops, true});
      double largest = 0.0;
      for (std::size_t m = 0; m < shape.members.size(); ++m) {
        const std::vector<NaturalStation> curve = natural_curve(mesh.members[m], shape.members[m], 2);
        for (const NaturalStation& station : curve)
          largest = std::max(largest, distance(station.triad[0], curve.front().triad[0]));
      }
      return largest;
    };
    EXPECT_LE(bent(LoopForces::closed), kIdentity) << made.name;
    EXPECT_GE(bent(LoopForces::least_energy), kBentByLeastEnergy) << made.name;
  }
}

// An inextensible beam between walls: its axial force has no part in its natural strains.
TEST(RestShape, OfRigidLoopsIsNotClosed) {
  Scene scene = straight_rod(1.0, 3, 4);
  scene.supports.push_back(clamp("tip"));
  EXPECT_THROW(rest_shape(scene, {LoopForces::closed, true}), ConvergenceError);
}

/// A random structure of lines, arcs, splines and joints, with what is offered: loads of one stage. None where joints
/// make a mechanism.
std::optional<Scene> random_structure(int number) {
  constexpr std::uint64_t kSeed = 39;
  Scene scene;
  try {
    XmlParameters file = parsed(RandomSceneMaker(kSeed, number, number % 2 == 0).make().text);
    scene = read_scene(file.list->sublist("Scene"), file.source);
    check_supports(scene, file.source);
  } catch (const InputError&) {
    return {};
  }
  scene.name = "random " + std::to_string(number);
  scene.eigenstrains.clear();
  scene.stages = 1;
  for (Joint& joint : scene.joints) joint.stiffness = 0.0;
  for (Support& support : scene.supports)
    for (Vector3* zero : {&support.prescribed_displacement, &support.prescribed_rotation,
                          &support.displacement_stiffness, &support.rotation_stiffness})
      *zero = {};
  const auto in_one_stage = [](auto& loads) {
    for (auto& load : loads) {
      load.stage = 1;
      load.amplitude.clear();
    }
  };
  in_one_stage(scene.point_loads);
  in_one_stage(scene.distributed_loads);
  return scene;
}

// Trees and loops with loads that turn members by angles of order one, and more.
TEST(RestShape, OfRandomStructures) {
  constexpr int kScenes = 16;
  // Sections of stiffnesses that differ a thousandfold: residuals are measured by the largest forces.
  constexpr double kResidualOfSpread = 1e-11;
  int trees = 0, loops = 0;
  for (int number = 0; number < kScenes; ++number) {
    const std::optional<Scene> scene = random_structure(number);
    if (!scene) continue;
    for (const bool turned : {true, false}) {
      const RestShape shape = rest_shape(*scene, {LoopForces::least_energy, turned});
      EXPECT_LE(shape.residual, kResidualOfSpread) << scene->name;
      (shape.redundancy == 0 ? trees : loops) += 1;
    }
  }
  EXPECT_GE(trees, 8);
  EXPECT_GE(loops, 8);
}

TEST(RestShape, RefusesWhatItDoesNotOffer) {
  const auto refuses = [](const std::function<void(Scene&)>& change) {
    Scene scene = straight_rod(1.0, 2, 4);
    change(scene);
    EXPECT_THROW(rest_shape(scene), InputError);
  };
  SolverParameters controlled;
  controlled.analysis.control = MonitoredComponent{"tip", 1, 0.1};
  EXPECT_THROW(find_rest_shape(straight_rod(1.0, 2, 4), kTurned, controlled, this_rank(), place_of_list()), InputError);
  refuses([](Scene& s) { s.eigenstrains = {{"beam", {0.1, 0, 0}}}; });
  refuses([](Scene& s) { s.supports[0].prescribed_displacement = {0, 0.1, 0}; });
  refuses([](Scene& s) { s.distributed_loads.clear(); });
  refuses([](Scene& s) { s.distributed_loads[0].amplitude = "t^2"; });
  refuses([](Scene& s) { s.supports.push_back(clamp("tip")); });
  refuses([](Scene& s) {
    s.supports.push_back(support("tip", {}, {}));
    s.supports.back().displacement_stiffness = {0, 1, 0};
  });
  refuses([](Scene& s) {
    s.sections[0].shear_stiffness = {50, 50};
    s.members[0].inner_points = {{"middle", 0.5}};
    s.point_loads = {dead_load("middle", {0, -1, 0})};
  });
}

}  // namespace
}  // namespace mixbeam::test::rest_shape_test
