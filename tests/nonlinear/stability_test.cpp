// Stability of equilibria against closed forms, and the inertia of the reduced tangent against LAPACK.
#include "tests/nonlinear/buckling_scenes.hpp"
#include "tests/nonlinear/stability_fixture.hpp"

#include <Teuchos_LAPACK.hpp>

namespace mixbeam::test {
namespace {

/// What is asked of critical loads: rounding in tangents with a cap of 1e5 leaves 1e-10.
constexpr double kCritical = 1e-9;

TEST(Stability, CriticalLoadsOfEulersColumns) {
  for (const ColumnEnds& ends : euler_columns()) {
    SCOPED_TRACE(ends.name);
    StabilityFixture fixture(column(6, 4, ends.supports));
    const double exact = ends.critical;
    EXPECT_EQ(fixture.count(0.99 * exact).negative, 0);
    EXPECT_EQ(fixture.count(1.01 * exact).negative, 1);
    EXPECT_EQ(fixture.spectrum((1.0 - 1e-7) * exact, 1).stability.negative, 0);  // where the capped tangent is wrong
    EXPECT_EQ(fixture.spectrum((1.0 + 1e-7) * exact, 1).stability.negative, 1);
    EXPECT_NEAR(fixture.critical(0.95 * exact, 0.98 * exact), exact, kCritical * exact);
  }
}

// The twin that must fail: the tangent as it is, capped, counts wrongly so near to the critical load.
TEST(Stability, TheCapWouldBeSeen) {
  StabilityFixture fixture(column(6, 4));
  EXPECT_EQ(fixture.count((1.0 - 1e-7) * 0.25 * kPi * kPi).negative, 1);
}

/// With compression and shear: EI theta'' + P (1 - P/EA + P/GA) theta = 0, from M' = -P w' with w' = (1 - P/EA) theta +
/// P theta/GA (dead load, no transverse force).
TEST(Stability, AnySlenderness) {
  for (double slenderness : {1e2, 1e4, 1e6}) {
    Scene scene = column(6, 4);
    const double axial = slenderness * slenderness, shear = 0.4 * axial;
    scene.sections[0].axial_stiffness = axial;
    scene.sections[0].shear_stiffness = {shear, shear};
    const double euler = 0.25 * kPi * kPi;
    double load = euler;  // EI k^2 = P (1 - P/EA + P/GA), k L = pi/2
    for (int i = 0; i < 50; ++i) load = euler / (1.0 - load / axial + load / shear);
    StabilityFixture fixture(scene);
    EXPECT_NEAR(fixture.critical(0.95 * load, 0.98 * load), load, kCritical * load) << slenderness;
  }
}

TEST(Stability, ModesOfAColumn) {
  Scene scene = column(4, 8);
  scene.sections[0].bending_stiffness = {1.0, 1.0};
  StabilityFixture fixture(scene);
  const double exact = 0.25 * kPi * kPi;
  const Spectrum spectrum = fixture.spectrum(1.1 * exact, 3);
  EXPECT_EQ(spectrum.stability.negative, 2);
  ASSERT_EQ(spectrum.modes.size(), 3u);
  EXPECT_NEAR(spectrum.modes[0].eigenvalue, spectrum.modes[1].eigenvalue, 1e-9);
  EXPECT_GT(spectrum.modes[2].eigenvalue, 0.1);
  for (int k = 0; k < 2; ++k) {  // 1 - cos(pi x / 2) in some plane through the axis
    const auto rows = spectrum.modes[k].mode.vertex();
    const size_t tip = rows.extent(0) - kVertexDofs, middle = (rows.extent(0) / kVertexDofs / 2) * kVertexDofs;
    const double tip_size = std::hypot(rows(tip + 1), rows(tip + 2));
    EXPECT_NEAR(rows(tip), 0.0, 1e-7);
    EXPECT_NEAR(std::hypot(rows(middle + 1), rows(middle + 2)) / tip_size, 1.0 - std::cos(0.25 * kPi), 1e-3);
    double largest = 0.0;
    for (size_t i = 0; i < rows.extent(0); ++i) largest = std::max(largest, std::abs(rows(i)));
    EXPECT_DOUBLE_EQ(largest, 1.0);
  }
  const Spectrum again = fixture.stability().spectrum(fixture.state(), 1.1 * exact, 3);
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(same_bits(again.modes[k].mode, spectrum.modes[k].mode));
}

TEST(Stability, OneElement) {
  for (int order : {1, 2, 4}) {
    StabilityFixture fixture(column(order, 1));
    EXPECT_EQ(fixture.count(2.0).negative, 0);
    EXPECT_EQ(fixture.count(3.5).negative, 1);
    EXPECT_EQ(fixture.spectrum(2.0, 20).modes.size(), 6u);  // all there are
  }
}

TEST(Stability, JointsWithSprings) {
  for (double spring : {0.3, 2.0, 50.0}) {
    const double exact = jointed_column_load(spring);
    StabilityFixture fixture(jointed_column(spring, 6, 2));
    EXPECT_EQ(fixture.count(0.99 * exact).negative, 0);
    EXPECT_EQ(fixture.count(1.01 * exact).negative, 1);
    EXPECT_NEAR(fixture.critical(0.95 * exact, 0.98 * exact), exact, kCritical * exact) << spring;
  }
}

TEST(Stability, LateralBuckling) {
  StabilityFixture cantilever(narrow_cantilever(6, 6));
  EXPECT_NEAR(cantilever.critical(3.9, 3.95), kNarrowCantilever, 1e-9 * kNarrowCantilever);
  StabilityFixture beam(uniform_moment(6, 6));
  EXPECT_TRUE(beam.count(1.0).symmetric);
  EXPECT_NEAR(beam.critical(3.0, 3.05), kPi, 1e-9 * kPi);
}

/// Clamped at both ends and twisted: M = 8.9868189158181 EI/L (cases.md).
TEST(Stability, TwistedRod) {
  Scene scene = cantilever(section(kRigid, kRigid, 3.0, 1.0), 1.0, 6, 6);
  Support turned = clamp("tip");
  turned.prescribed_rotation = {1, 0, 0};
  turned.amplitude = "t";
  turned.displacement_fixed = {false, true, true};
  scene.supports.push_back(turned);
  StabilityFixture fixture(scene);
  const double exact = 8.9868189158181 / 3.0;
  fixture.equilibrium(1.5);
  EXPECT_EQ(fixture.count(2.9).negative, 0);
  EXPECT_EQ(fixture.count(3.1).negative, 2);
  EXPECT_NEAR(fixture.critical(2.9, 2.95), exact, 1e-9 * exact);
}

TEST(Stability, FollowerForces) {
  StabilityFixture beck(partial_follower(1.0, 4, 4));  // no divergence at any load
  for (double load : {1.0, 5.0, 15.0, 25.0}) {
    const StabilityResult result = beck.count(load);
    EXPECT_FALSE(result.symmetric);
    EXPECT_EQ(result.negative, 0) << load;
  }
  const double eta = 0.25, exact = std::pow(std::acos(-eta / (1.0 - eta)), 2);
  StabilityFixture fixture(partial_follower(eta, 6, 4));
  EXPECT_EQ(fixture.count(0.99 * exact).negative, 0);
  EXPECT_EQ(fixture.count(1.01 * exact).negative, 1);
  EXPECT_FALSE(fixture.count(1.01 * exact).symmetric);
  EXPECT_NEAR(fixture.critical(0.95 * exact, 0.98 * exact), exact, kCritical * exact);
}

int negative_by_lapack(const SparseMatrix& sparse, double shift = 0.0) {
  const int n = sparse.rows();
  std::vector<double> dense(static_cast<size_t>(n) * n, 0.0), values(n), work(4 * n);
  for (int i = 0; i < n; ++i) {
    for (int k = sparse.row_start[i]; k < sparse.row_start[i + 1]; ++k)
      dense[i + size_t(n) * sparse.column[k]] = sparse.value[k];
    dense[i * (size_t(n) + 1)] += shift;
  }
  int info = 0;
  Teuchos::LAPACK<int, double>().SYEV('N', 'L', n, dense.data(), n, values.data(), work.data(), 4 * n, &info);
  EXPECT_EQ(info, 0);
  return static_cast<int>(std::count_if(values.begin(), values.end(), [](double x) { return x < 0.0; }));
}

/// Joints and supports of every kind, conservative loads only.
Scene conservative_portal() {
  Scene scene = portal_of_joints(2, 3);
  scene.point_loads = {dead_load("B", {2, -3, 1}), dead_load("C", {1, -5, 2}), dead_load("G", {-1, -4, 3})};
  return scene;
}

TEST(Stability, ReducedTangentOfAllJointsIsSymmetricAndHasTheInertiaOfLapack) {
  StabilityFixture fixture(conservative_portal());
  for (double load : {0.0, 1.0, 4.0}) {
    const StabilityResult result = fixture.count(load);
    EXPECT_TRUE(result.symmetric);
    EXPECT_LT(result.asymmetry, 1e-11);
    IndependentUnknowns unknowns(fixture.problem().assembler);
    const SparseMatrix& matrix = unknowns.reduce(fixture.problem().assembler, fixture.state());
    EXPECT_EQ(result.negative, negative_by_lapack(matrix)) << load;
    // with a shift there are negative eigenvalues to count
    for (double shift : {-20.0, -1e3}) {
      SparseMatrix shifted = matrix;
      for (int i = 0; i < matrix.rows(); ++i)
        for (int k = matrix.row_start[i]; k < matrix.row_start[i + 1]; ++k)
          if (matrix.column[k] == i) shifted.value[k] += shift;
      InertiaSolver solver(InertiaSolver::Kind::symmetric, shifted);
      const int expected = negative_by_lapack(matrix, shift);
      EXPECT_GT(expected, 0);
      const InertiaSolver::Signs signs = solver.factorize(shifted);
      EXPECT_EQ(signs.negative, expected);
      EXPECT_EQ(signs.determinant_sign, expected % 2 == 0 ? 1 : -1);
    }
  }
}

/// Motions of the independent unknowns keep the constraints: the constraint rows of the tangent vanish on them.
TEST(Stability, ModesKeepTheConstraints) {
  StabilityFixture fixture(conservative_portal());
  const Spectrum spectrum = fixture.spectrum(1.0, 3);
  Assembler& assembler = fixture.problem().assembler;
  for (const EigenMode& mode : spectrum.modes) {
    DofVector rows(assembler.map());
    assembler.apply_matrix(mode.mode.vertex_dofs(), rows);
    const KernelView<double*> values = MixedVector::view_of(rows);
    double largest = 0.0;
    for (size_t i = 0; i < values.extent(0); ++i)
      if (assembler.fixed_rows()(i) != 0) largest = std::max(largest, std::abs(values(i)));
    EXPECT_LT(largest, 1e-11);
  }
}

TEST(Stability, UnitsDoNotMatter) {
  const Spectrum here = StabilityFixture(conservative_portal()).spectrum(1.0, 3);
  const Spectrum there = StabilityFixture(in_other_units(conservative_portal(), 1e3, 1e-4)).spectrum(1.0, 3);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(there.modes[k].eigenvalue, here.modes[k].eigenvalue, 1e-8 * std::abs(here.modes[k].eigenvalue));
}

TEST(MpiStability, TheSameOnAnyNumberOfRanks) {
  StabilityFixture fixture(column(4, 7), all_ranks());
  StabilityFixture alone(column(4, 7));
  const double exact = 0.25 * kPi * kPi;
  EXPECT_EQ(fixture.count(1.1 * exact).negative, 1);
  const Spectrum here = fixture.spectrum(0.9 * exact, 2), there = alone.spectrum(0.9 * exact, 2);
  ASSERT_EQ(here.modes.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(here.modes[k].eigenvalue, there.modes[k].eigenvalue, 1e-10);
    const auto mine = here.modes[k].mode.vertex(), all = there.modes[k].mode.vertex();
    const size_t first = fixture.problem().assembler.map()->getGlobalElement(0);
    for (size_t i = 0; i < mine.extent(0); ++i) EXPECT_NEAR(mine(i), all(first + i), 1e-8);
  }
}

}  // namespace
}  // namespace mixbeam::test
