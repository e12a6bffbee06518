// Stability of equilibria against closed forms, and the inertia of the reduced tangent against LAPACK.
#include "kernels/condensation/row_pivoting.hpp"
#include "tests/nonlinear/stability_fixture.hpp"
#include "tests/support/buckling_scenes.hpp"

#include <tuple>

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
    for (double beside : {1e-6, 1e-8}) {  // the usual cap alone shifts it by 1e-5
      EXPECT_EQ(fixture.spectrum((1.0 - beside) * exact, 1).stability.negative, 0) << beside;
      EXPECT_EQ(fixture.spectrum((1.0 + beside) * exact, 1).stability.negative, 1) << beside;
      EXPECT_EQ(fixture.count((1.0 - beside) * exact).negative, 0) << beside;
      EXPECT_EQ(fixture.count((1.0 + beside) * exact).negative, 1) << beside;
    }
    EXPECT_NEAR(fixture.critical(0.95 * exact, 0.98 * exact), exact, kCritical * exact);
  }
}

/// Nothing but the interior of elements is left to move.
TEST(Stability, VerticesThatAreAllFixed) {
  Scene scene = cantilever(section(400.0, 140.0, 0.8, 1.0), 1.0, 2, 1);
  scene.supports.push_back(clamp("tip"));
  StabilityFixture fixture(scene);
  const Spectrum spectrum = fixture.spectrum(1.0, 1);
  EXPECT_EQ(spectrum.stability.negative, 0);
  EXPECT_EQ(spectrum.stability.null, 0);
  EXPECT_TRUE(spectrum.modes.empty());
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

/// A space of modes taken far from the critical load sees that it is passed, and where; the double eigenvalue as one.
TEST(Stability, SpaceOfCriticalModes) {
  Scene scene = column(6, 4);
  scene.sections[0].bending_stiffness = {1.0, 1.0};
  StabilityFixture fixture(scene);
  const double exact = 0.25 * kPi * kPi;
  const CriticalSpace space = fixture.stability().space_of(fixture.equilibrium(0.5 * exact), 0.5 * exact, 1, 2);
  ASSERT_EQ(space.size, 2);
  const auto seen_at = [&](double share) {
    return fixture.stability().in_space(fixture.equilibrium(share * exact), share * exact, space);
  };
  const SpaceValues before = seen_at(1.0 - 1e-8), after = seen_at(1.0 + 1e-8);
  EXPECT_EQ(before.unseen, 0);
  EXPECT_EQ(after.unseen, 0);
  EXPECT_EQ(before.negative(), 0);
  EXPECT_EQ(after.negative(), 2);
  EXPECT_NEAR(after.modes[0].eigenvalue, after.modes[1].eigenvalue, 1e-9);
}

/// The twin: a space of other modes does not see it, and says so.
TEST(Stability, SpaceOfOtherModes) {
  StabilityFixture fixture(column(6, 4));
  const double exact = 0.25 * kPi * kPi;
  EXPECT_EQ(fixture.stability().space_of(fixture.equilibrium(0.5 * exact), 0.5 * exact, 40, 1).size, 0);
  CriticalSpace other = fixture.stability().space_of(fixture.equilibrium(0.5 * exact), 0.5 * exact, 1, 1);
  ASSERT_EQ(other.size, 1);
  for (size_t i = 0; i < other.vectors[0].size(); ++i) other.vectors[0][i] = i == 0 ? 1.0 : 0.0;  // stretched
  const auto seen_at = [&](double share) {
    return fixture.stability().in_space(fixture.equilibrium(share * exact), share * exact, other);
  };
  const SpaceValues before = seen_at(0.9), after = seen_at(1.1);
  EXPECT_EQ(before.negative(), after.negative());
  EXPECT_EQ(after.unseen - before.unseen, 1);
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

/// Clamped at both ends and twisted: M = 2 k EI/L with tan k = k, k = 4.493409457909064.
TEST(Stability, TwistedRod) {
  Scene scene = cantilever(section(kRigid, kRigid, 3.0, 1.0), 1.0, 6, 6);
  Support turned = clamp("tip");
  turned.prescribed_rotation = {1, 0, 0};
  turned.amplitude = "t";
  turned.displacement_fixed = {false, true, true};
  scene.supports.push_back(turned);
  StabilityFixture fixture(scene);
  const double exact = 2.0 * 4.493409457909064 / 3.0;
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

/// Hinged, under a line load that follows its axis and ends in the held base: M'' + q (L - x) M = 0, so that
/// 2/3 sqrt(q L^3 / EI) is a zero of J_{1/3}, the first (Pflueger, 1950) or the second: 2.902586, 6.032747.
TEST(Stability, LineLoadThatFollows) {
  for (int elements : {1, 3, 40}) {
    Scene scene = column(elements == 1 ? 6 : 3, elements, euler_columns()[2].supports);
    scene.sections[0].bending_stiffness[0] = 100.0;
    scene.point_loads.clear();
    scene.distributed_loads = {{scene.members[0].name, {-1, 0, 0}, {}, 1, LoadFrame::follower}};
    StabilityFixture fixture(scene);
    const double first = std::pow(1.5 * 2.902586, 2), second = std::pow(1.5 * 6.032747, 2);
    for (const auto& [load, sign] :
         {std::pair(0.99 * first, 1), {1.01 * first, -1}, {0.99 * second, -1}, {1.01 * second, 1}}) {
      const StabilityResult result = fixture.count(load);
      EXPECT_EQ(result.sign, sign) << elements << ", " << load;
      EXPECT_FALSE(result.symmetric);
    }
  }
}

/// A = L D L^T has the signs of D; also where the diagonal of A offers no pivot.
TEST(Stability, SignsOfAnInteriorWithoutDiagonal) {
  constexpr int n = 9;
  std::mt19937 random(20240229);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int sample = 0; sample < 50; ++sample) {
    double l[n][n] = {}, a[n][n] = {};
    int negative = 0;
    for (int k = 0; k < n; ++k) {
      const double d = uniform(random);
      negative += d < 0.0 ? 1 : 0;
      for (int i = k; i < n; ++i) l[i][k] = i == k ? 1.0 : uniform(random);
      for (int i = k; i < n; ++i)
        for (int j = k; j < n; ++j) a[i][j] += l[i][k] * d * l[j][k];
    }
    const InteriorSigns signs = count_negative<n, n>(a);
    EXPECT_EQ(signs.negative, negative) << sample;
    EXPECT_FALSE(signs.uncertain);
  }
  double hollow[4][4] = {{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, 0, 1e-3}, {0, 0, 1e-3, 0}};
  EXPECT_EQ((count_negative<4, 4>(hollow).negative), 2);
  double singular[2][2] = {{1, 1}, {1, 1}};
  EXPECT_TRUE((count_negative<2, 2>(singular).uncertain));
}

/// Clamped at both ends and round: n half waves pairs below (2 pi n)^2 and tan(kL/2) = kL/2 in between.
TEST(Stability, AnElementThatBucklesBetweenItsVertices) {
  const Scene clamped = column(8, 1, euler_columns()[4].supports);
  StabilityFixture fixture(clamped);
  EXPECT_EQ(fixture.count(39.0).negative, 0);
  EXPECT_EQ(fixture.count(60.0).negative, 1);  // 4 pi^2 = 39.478
  EXPECT_EQ(fixture.count(60.0).verdict(), Verdict::unstable);
  EXPECT_EQ(fixture.count(85.0).negative, 2);  // 80.763
}

// The twin that must fail: without the interiors nothing would be seen.
TEST(Stability, ItsVerticesAloneSeeNothing) {
  StabilityFixture fixture(column(8, 1, euler_columns()[4].supports));
  const StabilityResult complete = fixture.count(60.0);
  EXPECT_EQ(fixture.tangent(60.0).interior_count().negative, 1);
  EXPECT_EQ(complete.inside, 1);
  EXPECT_EQ(complete.negative - complete.inside, 0);
}

/// Critical loads (2 n - 1)^2 pi^2/4 EI of a cantilever, EI = 1 and 6.
int negative_of_cantilever(double load) {
  int count = 0;
  for (double stiffness : {1.0, 6.0})
    for (int n = 1; stiffness * std::pow((2 * n - 1) * kPi / 2.0, 2) < load; ++n) ++count;
  return count;
}

/// One element counts as many as sixteen, and as the closed form, wherever its order resolves the modes.
TEST(Stability, TheCountDoesNotDependOnTheMesh) {
  for (const auto& [order, elements, largest] :
       {std::tuple{2, 16, 120.0}, {4, 4, 120.0}, {5, 2, 60.0}, {6, 1, 55.0}, {8, 1, 120.0}})
    for (double load = 1.5; load < largest; load *= 1.37) {
      StabilityFixture fixture(column(order, elements));
      const StabilityResult result = fixture.count(load);
      EXPECT_EQ(result.negative, negative_of_cantilever(load)) << order << ' ' << elements << ' ' << load;
      EXPECT_EQ(result.sign, result.negative % 2 == 0 ? 1 : -1);
      EXPECT_EQ(fixture.spectrum(load, 2).stability.negative, result.negative) << order << ' ' << load;
    }
}

TEST(Stability, Verdicts) {
  StabilityFixture dead(column(4, 4));
  EXPECT_EQ(dead.count(2.0).verdict(), Verdict::stable);
  EXPECT_EQ(dead.count(3.0).verdict(), Verdict::unstable);
  EXPECT_EQ(dead.count(0.25 * kPi * kPi).verdict(), Verdict::neutral);
  StabilityFixture beck(partial_follower(1.0, 4, 4));
  EXPECT_EQ(beck.count(0.0).verdict(), Verdict::stable);
  EXPECT_EQ(beck.count(1.0).verdict(), Verdict::unknown);
  EXPECT_EQ(beck.count(1.0).sign, 1);
  StabilityFixture divergent(partial_follower(0.25, 4, 4));
  const double exact = std::pow(std::acos(-1.0 / 3.0), 2);
  EXPECT_EQ(divergent.count(0.99 * exact).verdict(), Verdict::unknown);
  EXPECT_EQ(divergent.count(1.01 * exact).verdict(), Verdict::unstable);
  EXPECT_STREQ(text_of(Verdict::neutral), "neutral");
}

/// A motion across the column that is held at its tip leaves the buckling load of the clamped and hinged one.
TEST(Stability, CountWhileAMotionIsHeld) {
  StabilityFixture fixture(column(6, 4));
  MixedVector motion = fixture.problem().model.create_vector();
  motion.fill(0.0);
  const auto rows = motion.vertex();
  rows(rows.extent(0) - kVertexDofs + 1) = 1.0;
  const double hinged = euler_columns()[3].critical;
  for (double load : {2.0, 3.0, 0.99 * hinged, 1.01 * hinged}) {
    const State& state = fixture.equilibrium(load);
    EXPECT_EQ(fixture.stability().ask({state, load, nullptr, &motion}, How::held)->negative,
              (load > hinged ? 1 : 0) + (load > 6 * 0.25 * kPi * kPi ? 1 : 0))
        << load;
  }
}

/// Far more modes than one space of the solver holds: bounded work, and each mode says what it is worth.
TEST(Stability, ManyModesComeWithTheirErrors) {
  StabilityFixture fixture(column(4, 16));
  const Spectrum spectrum = fixture.spectrum(2.0, 40);
  ASSERT_EQ(spectrum.modes.size(), 40u);
  EXPECT_TRUE(spectrum.modes.front().converged);
  EXPECT_LT(spectrum.modes.front().error, 1e-6);
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
    IndependentUnknowns unknowns(fixture.problem().model);
    const Tangent tangent = fixture.tangent(load);
    const SparseMatrix& matrix = unknowns.reduce(tangent);
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
  const Model& model = fixture.problem().model;
  const VertexMatrix matrix = whole_matrix(model);
  fixture.tangent(1.0).gather(matrix);
  for (const EigenMode& mode : spectrum.modes) {
    DofVector rows(model.map());
    matrix.matrix()->apply(mode.mode.vertex_dofs(), rows);
    const KernelView<double*> values = MixedVector::view_of(rows);
    double largest = 0.0;
    for (size_t i = 0; i < values.extent(0); ++i)
      if (model.fixed_rows()(i) != 0) largest = std::max(largest, std::abs(values(i)));
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
    const size_t first = fixture.problem().model.map()->getGlobalElement(0);
    for (size_t i = 0; i < mine.extent(0); ++i) EXPECT_NEAR(mine(i), all(first + i), 1e-8);
  }
}

}  // namespace
}  // namespace mixbeam::test
