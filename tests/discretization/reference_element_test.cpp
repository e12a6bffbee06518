// The undeformed state of curved members: no residual, whatever curve, order and integration rule.
#include "discretization/mesh/reference_element.hpp"

#include "discretization/assembly/tangent.hpp"
#include "discretization/text/errors.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/worst_error.hpp"

namespace mixbeam::test::reference_element_test {
namespace {

constexpr unsigned kSeed = 20240611;
// Rows are strains and rotations of order one; every triad carries a few roundings, the jumps of a triad are multiplied
// by 2 j + 1.
constexpr double kStressFree = 1e-13;
constexpr ForceIntegration kRules[] = {ForceIntegration::full, ForceIntegration::axial_reduced,
                                       ForceIntegration::shear_reduced, ForceIntegration::both_reduced};

/// A clamped member from the origin to (6, 1, -2).
Scene clamped(const Curve& curve, int order, int elements, double twist = 0.0) {
  Scene scene = cantilever(section(1e3, 5e2, 1.0, 2.0), 1.0, order, elements);
  scene.points[1].position = {6, 1, -2};
  scene.members[0].curve = curve;
  scene.members[0].twist = twist;
  return scene;
}

Curve random_spline(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> component(-0.7, 0.7);
  Curve curve;
  curve.shape = CurveShape::spline;
  for (int i = 1; i <= 4; ++i)
    curve.through.push_back({1.2 * i + component(random), 0.2 * i + component(random), -0.4 * i + component(random)});
  return curve;
}

Curve formula_curve() {
  Curve curve;
  curve.shape = CurveShape::parametric;
  curve.formula = {"6*t", "t^2 + sin(5*t)/5", "-t - cos(3*t)/3 - t^2 + 1/3"};
  curve.range = {0.0, 1.0};
  return curve;
}

/// Largest residual of the elements in the undeformed state, unscaled.
double largest_row(const Scene& scene) {
  const Model model(scene, this_rank(), {});
  MixedVector rows = model.create_vector();
  element_rows(model, model.reference_state(), 0.0, ElementLoads::none, rows);
  double largest = 0.0;
  const auto see = [&](double row) {
    if (!(std::abs(row) <= largest)) largest = std::abs(row);
  };
  for (size_t i = 0; i < rows.vertex().extent(0); ++i) see(rows.vertex()(i));
  const auto interior = rows.interior();
  for (size_t i = 0; i < interior.extent(0); ++i) see(interior(i));
  return largest;
}

TEST(ReferenceElement, UndeformedStateIsFreeOfStress) {
  Curve helix;
  helix.shape = CurveShape::helix;
  helix.center = {0, 2, 0};
  helix.angle = 4.0;
  helix.rise = 1.5;
  WorstError worst;
  for (int order = 1; order <= kMaximumOrder; ++order)
    for (const ForceIntegration rule : kRules)
      for (int kind = 0; kind < 6; ++kind) {
        Scene scene = kind < 2   ? clamped(random_spline(kSeed + static_cast<unsigned>(kind)), order, 7, kind * 2.0)
                      : kind < 4 ? clamped(formula_curve(), order, 5, (kind - 2) * 3.0)
                                 : clamped(helix, order, 6, (kind - 4) * 3.0);
        if (kind > 1) scene.points.pop_back();
        scene.members[0].force_integration = rule;
        const bool is_mixed = rule == ForceIntegration::axial_reduced || rule == ForceIntegration::shear_reduced;
        if (is_mixed && kind % 2 == 1) continue;  // the others have shown the rule
        // constant curvature keeps the paper's exact tangents, which one constant triad cannot follow at two points
        if (kind == 4 && order == 1 && rule != ForceIntegration::both_reduced) continue;
        worst.see(largest_row(scene), "curve ", kind, ", order ", order, ", rule ", static_cast<int>(rule));
      }
  EXPECT_TRUE(worst.at_most(kStressFree));
}

TEST(ReferenceElement, UnequalElementsAreFreeOfStress) {
  Scene scene = clamped(random_spline(kSeed), 3, 4, 1.0);
  scene.members[0].stations = {0.0, 0.3, 0.45, 0.5, 1.0};
  scene.members[0].inner_points = {{"inner", 0.45}};
  EXPECT_LE(largest_row(scene), kStressFree);
}

TEST(ReferenceElement, WithoutTheJumpsTheStateIsNot) {
  // the exact curvature of the curve in place of that of the discrete fields, of order 2: the test above can fail
  const Scene scene = clamped(formula_curve(), 2, 5);
  Scene placed = scene;
  placed.points.pop_back();
  const Model model(placed, this_rank(), {});
  const ElementBlock& block = model.structure().blocks[0];
  const MeshMember& member = model.mesh().members[0];
  double points[3], weights[3];
  gauss_rule(3, points, weights);
  for (int q = 0; q < 3; ++q) {
    const Vec3<double> exact = member.curve.curvature(member.arc_length(2, points[q]));
    for (int i = 0; i < 3; ++i) block.reference(2, block.reference_layout.curvature(q) + i) = exact[i];
  }
  MixedVector rows = model.create_vector();
  element_rows(model, model.reference_state(), 0.0, ElementLoads::none, rows);
  double largest = 0.0;
  for (size_t i = 0; i < rows.interior().extent(0); ++i) largest = std::max(largest, std::abs(rows.interior()(i)));
  EXPECT_GT(largest, 1e-5);
}

TEST(ReferenceElement, TangentsAndEndTriadsAreExact) {
  const Scene scene = clamped(random_spline(kSeed), 4, 6, 1.0);
  const Mesh mesh = build_mesh(scene);
  const MeshMember& member = mesh.members[0];
  WorstError worst;
  double points[4], weights[4];
  gauss_rule(4, points, weights);
  for (int e = 0; e < member.elements; ++e) {
    const ReferenceElement element = make_reference_element(member, e, 4, ForceIntegration::both_reduced);
    for (int q = 0; q < 4; ++q) {
      Vec3<double> psi{{0, 0, 0}};
      double P[5];
      legendre(4, points[q], P);
      for (int j = 1; j < 4; ++j) psi += P[j] * element.relative_rotation[j];
      const Quaternion<double> triad = element.triad * exp_quaternion(psi);
      const double s = member.arc_length(e, points[q]);
      worst.see(norm(log_quaternion(conjugate(triad) * member.curve.triad(s))), "triad, element ", e);
      worst.see(norm(element.tangent[q] - member.curve.tangent(s)), "tangent, element ", e);
    }
    for (int end = 0; end < 2; ++end)
      worst.see(norm(log_quaternion(conjugate(element.end_triad[end]) *
                                    member.curve.triad(member.vertex_arc_length(e + end)))),
                "end, element ", e);
  }
  EXPECT_TRUE(worst.at_most(1e-14));
}

TEST(ReferenceElement, CurvatureConvergesToThatOfTheCurve) {
  // its mean over an element with the order of the interpolation; pointwise one order less
  const auto error = [](int elements) {
    Scene scene = clamped(formula_curve(), 3, elements);
    scene.points.pop_back();
    const Mesh mesh = build_mesh(scene);
    const MeshMember& member = mesh.members[0];
    double worst = 0.0, points[4], weights[4];
    gauss_rule(4, points, weights);
    for (int e = 0; e < member.elements; ++e) {
      const ReferenceElement element = make_reference_element(member, e, 3, ForceIntegration::both_reduced);
      for (int q = 0; q < 4; ++q)
        worst = std::max(worst, norm(element.curvature[q] - member.curve.curvature(member.arc_length(e, points[q]))));
    }
    return worst;
  };
  EXPECT_GT(std::log2(error(20) / error(40)), 2.5);
}

TEST(ReferenceElement, NamesTheElementThatTurnsTooFar) {
  Curve circle;
  circle.shape = CurveShape::parametric;
  circle.formula = {"cos(t)", "sin(t)", "0"};
  circle.range = {0.0, 12.0};
  Scene scene = clamped(circle, 2, 1);
  scene.points.clear();
  scene.supports[0].point = "tip";
  for (const int elements : {1, 2, 6}) {
    scene.members[0].elements = elements;
    const Mesh mesh = build_mesh(scene);
    try {
      build_structure(scene, mesh, 0, 1);
      EXPECT_EQ(elements, 6);
    } catch (const InputError& error) {
      EXPECT_LT(elements, 3);
      EXPECT_NE(std::string(error.what()).find("member \"beam\", element 1 of"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace mixbeam::test::reference_element_test
