// Gradients of critical loads against closed forms, and against differences of whole runs.
#include "nonlinear/sensitivity/critical_gradient.hpp"
#include "tests/support/buckling_scenes.hpp"
#include "tests/support/scene_numbers.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test::critical_gradients_test {
namespace {

/// Differences of whole runs of fourth order: eight digits.
constexpr double kOfDifferences = 1e-8, kStep = 0.003;
/// Tangents beside a critical state are solved with ten digits, as kStressShare of critical_gradient.cpp has it.
constexpr double kClosedForm = 1e-9;
/// Two ways to the same derivative.
constexpr double kSame = 1e-11;
/// Error of the gradient under followers with the mode in place of the left null vector, at least.
constexpr double kNotLeft = 1e-3;

/// Those up to the first of the kind.
CriticalPoint first_point(const Scene& scene, CriticalKind kind, const SolverParameters& parameters = {}) {
  Simulation simulation(scene, parameters, this_rank());
  std::vector<CriticalPoint> found;
  PathControl control;
  control.stop = [&] { return !found.empty(); };
  simulation.run(
      [&](const StepReport& report, const State&) {
        for (const CriticalPoint& point : report.critical_points)
          if (point.kind == kind) found.push_back(point);
      },
      control);
  if (found.empty()) throw std::runtime_error(scene.name + ": no " + name_of(kind));
  return found.front();
}

std::vector<RecordedGradient> gradients(const Scene& scene, const CriticalPoint& point,
                                        const std::vector<Parameter>& parameters, bool by_element = false,
                                        bool transposed = true) {
  CriticalGradientRequest request{"critical point 1", {}, by_element};
  for (const Parameter& parameter : parameters) request.numbers.push_back(number_of(scene, parameter));
  BeamProblem problem(scene, this_rank(), {});
  return critical_gradients_of(problem, point, request, transposed);
}

/// Of the first critical point of the kind, by runs.
double difference(const Scene& scene, CriticalKind kind, const Parameter& parameter) {
  const auto load = [&](double more) { return first_point(with(scene, parameter, more), kind).load_factor; };
  const double h = parameter.step;
  return (8.0 * (load(h) - load(-h)) - (load(2.0 * h) - load(-2.0 * h))) / (12.0 * h);
}

void expect_as_differences(const Scene& scene, CriticalKind kind, const std::vector<Parameter>& parameters) {
  const RecordedGradient found = gradients(scene, first_point(scene, kind), parameters).front();
  for (size_t i = 0; i < parameters.size(); ++i) {
    const double wanted = difference(scene, kind, parameters[i]);
    EXPECT_NEAR(found.derivative[i] / wanted, 1.0, kOfDifferences)
        << scene.name << " by " << parameters[i].name << ": " << found.derivative[i] << " " << wanted;
  }
}

/// Its bars have the height h and the length l with l^3 = l_0 a^2 at the limit point, whose load is stationary with
/// them.
TEST(CriticalGradients, OfTheLimitLoadOfAToggle) {
  const Scene scene = shallow_truss(2.0);
  const CriticalPoint point = first_point(scene, CriticalKind::limit_point);
  const RecordedGradient found =
      gradients(scene, point, {of_stiffness(scene, 0, kStep), of_place(scene, 1, 1, kStep * kTrussRise)}).front();
  const double length0 = std::hypot(kTrussHalfSpan, kTrussRise),
               length = std::cbrt(length0 * kTrussHalfSpan * kTrussHalfSpan),
               height = std::sqrt(length * length - kTrussHalfSpan * kTrussHalfSpan);
  const double force = 2.0 * kTrussAxial * (1.0 / length - 1.0 / length0) * height;
  EXPECT_NEAR(found.value, force / 2.0, kClosedForm);
  EXPECT_NEAR(found.derivative[0], force / 2.0 / kTrussAxial, kClosedForm * force / kTrussAxial);
  EXPECT_NEAR(found.derivative[1], kTrussAxial * height * kTrussRise / std::pow(length0, 3), kClosedForm * force);
}

TEST(CriticalGradients, OfTheLimitLoadOfAnArch) {
  const Scene scene = loaded_arch(hinged("left"), true, 60.0);
  expect_as_differences(scene, CriticalKind::limit_point,
                        {of_stiffness(scene, 0, kStep), of_stiffness(scene, 5, kStep)});
  const CriticalPoint point = first_point(scene, CriticalKind::limit_point);
  const RecordedGradient found =
      gradients(scene, point, {of_stiffness(scene, 0, kStep), of_stiffness(scene, 5, kStep)}, true).front();
  double axial = 0.0, bending = 0.0;
  for (const std::array<double, 6>& stiffness : found.stiffness) {
    axial += stiffness[0];
    bending += stiffness[5];
  }
  EXPECT_NEAR(axial, found.derivative[0], kSame);
  EXPECT_NEAR(bending, found.derivative[1], kSame);
}

/// At its crown, along its left half.
TEST(CriticalGradients, OfLimitLoadsThatFollow) {
  Scene scene = loaded_arch(hinged("left"), false, 0.0);
  scene.name = "point load";
  scene.point_loads = {follower_load("crown", "left half", {10.0, 100.0, 0})};
  expect_as_differences(scene, CriticalKind::limit_point, {of_stiffness(scene, 5, kStep)});
  const CriticalPoint point = first_point(scene, CriticalKind::limit_point);
  const double left = gradients(scene, point, {of_stiffness(scene, 5, kStep)}).front().derivative[0],
               right = gradients(scene, point, {of_stiffness(scene, 5, kStep)}, false, false).front().derivative[0];
  EXPECT_GT(std::abs(right / left - 1.0), kNotLeft) << left << " " << right;
  scene.name = "line load";
  scene.point_loads.clear();
  DistributedLoad along;
  along.member = "left half";
  along.force = {0, 100.0, 0};
  along.frame = LoadFrame::follower;
  scene.distributed_loads = {along};
  expect_as_differences(scene, CriticalKind::limit_point, {of_stiffness(scene, 5, kStep)});
}

/// Loads are P / 2 P: that of EI is P / EI, that of the length -2 P / L.
TEST(CriticalGradients, OfEulersColumns) {
  for (const ColumnEnds& ends : euler_columns()) {
    Scene scene = column(4, 4, ends.supports);
    scene.name = ends.name;
    scene.point_loads[0].force[0] = -2.0 * ends.critical;
    const CriticalPoint point = first_point(scene, CriticalKind::bifurcation);
    const std::vector<RecordedGradient> found =
        gradients(scene, point,
                  {of_stiffness(scene, 5, kStep), of_place(scene, 1, 0, 0.003), of_stiffness(scene, 4, kStep)}, true);
    EXPECT_NEAR(found[0].derivative[0] / point.load_factor, 1.0, kClosedForm) << ends.name;
    EXPECT_NEAR(found[0].derivative[1] / point.load_factor, -2.0, 2.0 * kClosedForm) << ends.name;
    EXPECT_NEAR(found[0].derivative[2], 0.0, kClosedForm) << ends.name;
    double sum = 0.0;
    for (const std::array<double, 6>& stiffness : found[0].stiffness) sum += stiffness[5];
    for (const std::array<double, 6>& natural : found[0].natural) EXPECT_TRUE(std::isnan(natural[5])) << ends.name;
    EXPECT_NEAR(sum / point.load_factor, 1.0, kClosedForm) << ends.name;
    for (const double imperfection : found[1].derivative) EXPECT_EQ(imperfection, 0.0);
  }
}

/// A force q across the tip deflects it by q (tan k - k) / (k P), whose pole at k = pi / 2, on the mode 1 - cos(k x) of
/// the largest rotation k, has the residue 16 lambda_c^2 / pi^3 for a force that grows with the load.
TEST(CriticalGradients, RefusesANumberThatBreaksTheSymmetry) {
  Scene scene = column(4, 4);
  scene.point_loads[0].force[0] = -0.5 * kPi * kPi;
  const Parameter across = {"across", 0.0, 0.01,
                            [](Scene& changed, double value) { changed.point_loads[0].force[1] = value; }};
  const std::vector<RecordedGradient> found = gradients(scene, first_point(scene, CriticalKind::bifurcation), {across});
  EXPECT_TRUE(std::isnan(found[0].derivative[0]));
  EXPECT_FALSE(found[0].note.empty());
  EXPECT_NEAR(std::abs(found[1].derivative[0]), 16.0 * found[0].value * found[0].value / std::pow(kPi, 3), kClosedForm);
}

TEST(CriticalGradients, OfAColumnWithAJoint) {
  const double spring = 2.0;
  Scene scene = jointed_column(spring, 4, 4);
  scene.point_loads[0].force[0] = -20.0;
  const CriticalPoint point = first_point(scene, CriticalKind::bifurcation);
  const auto set = [](Scene& changed, double value) { changed.joints[0].stiffness = value; };
  const double found = gradients(scene, point, {{"spring", spring, kStep * spring, set}}).front().derivative[0];
  const double k = std::sqrt(jointed_column_load(spring)), tangent = std::tan(0.5 * k);
  const double wanted = 2.0 * k * 2.0 / (tangent + 0.5 * k * (1.0 + tangent * tangent));
  EXPECT_NEAR(20.0 * found / wanted, 1.0, kOfDifferences);
}

/// Out of the plane of the load: P goes with sqrt(EI GIt).
TEST(CriticalGradients, OfAStripThatRollsOver) {
  Scene scene = narrow_cantilever(4, 8);
  scene.point_loads[0].force[1] = -2.0 * kNarrowCantilever;
  const CriticalPoint point = first_point(scene, CriticalKind::bifurcation);
  const RecordedGradient found =
      gradients(scene, point, {of_stiffness(scene, 3, kStep), of_stiffness(scene, 4, kStep)}).front();
  EXPECT_NEAR(found.derivative[0] * scene.sections[0].torsional_stiffness / point.load_factor, 0.5, kOfDifferences);
  EXPECT_NEAR(found.derivative[1] * scene.sections[0].bending_stiffness[0] / point.load_factor, 0.5, kOfDifferences);
}

TEST(CriticalGradients, OfArchesThatSway) {
  for (const bool is_deep : {false, true}) {
    Scene scene = is_deep ? loaded_arch(hinged("left"), false, 40.0, 1.4) : loaded_arch(hinged("left"), false, 60.0);
    scene.sections.push_back(scene.sections[0]);
    scene.sections[1].name = "right";
    scene.members[1].section = "right";
    const auto both = [](Scene& changed, double value) {
      for (Section& section : changed.sections) section.bending_stiffness[1] = value;
    };
    const auto spread = [](Scene& changed, double value) { changed.supports[1].prescribed_displacement[0] = value; };
    std::vector<Parameter> parameters = {{"EI", 1.0, kStep, both}};
    if (!is_deep) parameters.push_back({"spread", 0.0, 0.1 * kStep, spread});
    expect_as_differences(scene, CriticalKind::bifurcation, parameters);
    const std::vector<RecordedGradient> found =
        gradients(scene, first_point(scene, CriticalKind::bifurcation), {of_stiffness(scene, 5, kStep, 1)});
    EXPECT_TRUE(std::isnan(found[0].derivative[0]));
    EXPECT_GT(std::abs(found[1].derivative[0]), kNotLeft);
  }
}

/// A hinged column with a spring of 16 pi^2 at its middle has two modes at 4 pi^2. The stiffness of a half: 8 pi^2 / 3
/// and none; the spring: dP/dc = 1 / 6 of the symmetric mode, c (1/2 - tan(k/2) / k) = 2 k^2, and none.
TEST(CriticalGradients, OfTwoModesAtOneLoad) {
  constexpr double kForce = 60.0, kSpring = 16.0 * kPi * kPi;
  Scene scene = column(4, 4, euler_columns()[2].supports);
  scene.points.push_back({"middle", {0.5, 0, 0}});
  scene.sections.push_back(scene.sections[0]);
  scene.sections[1].name = "upper";
  scene.members = {line("lower", "clamp", "middle", 4, 8), line("upper", "middle", "tip", 4, 8)};
  for (Member& member : scene.members) member.second_axis = {0, 1, 0};
  scene.members[1].section = "upper";
  scene.supports.push_back(support("middle", {}, {}));
  scene.supports.back().displacement_stiffness = {0, kSpring, 0};
  scene.point_loads[0].force[0] = -kForce;
  const auto set = [](Scene& changed, double value) { changed.supports.back().displacement_stiffness[1] = value; };
  const std::vector<RecordedGradient> found = gradients(
      scene, first_point(scene, CriticalKind::bifurcation),
      {of_stiffness(scene, 5, kStep), of_stiffness(scene, 5, kStep, 1), {"spring", kSpring, kStep * kSpring, set}});
  ASSERT_EQ(found.size(), 3u);
  const double wanted[] = {8.0 * kPi * kPi / 3.0, 8.0 * kPi * kPi / 3.0, 1.0 / 6.0};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(std::isnan(found[0].derivative[i]));
    EXPECT_NEAR(kForce * found[1].derivative[i], 0.0, kOfDifferences);
    EXPECT_NEAR(kForce * found[2].derivative[i] / wanted[i], 1.0, kOfDifferences);
  }
}

}  // namespace
}  // namespace mixbeam::test::critical_gradients_test
