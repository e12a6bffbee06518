// Fields of configurations that are known at every point.
#include "discretization/state/sampling.hpp"

#include "kernels/element/layout.hpp"
#include "kernels/math/gauss.hpp"
#include "kernels/math/legendre.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/worst_error.hpp"

namespace mixbeam::test::sampling_test {
namespace {

// Sums of a dozen products of numbers of size one to ten.
constexpr double kFewRoundings = 1e-14;

constexpr double kLength = 6.0;
constexpr int kOrder = 3, kElements = 2;
constexpr double kElementLength = kLength / kElements;

/// A cubic displacement, its slope, a cubic moment, a quadratic force: all of them in the spaces of order three.
Vec3<double> displacement(double s) { return {{0.1 * s, 0.2 * s * s - 1.0, 0.3 - 0.01 * s * s * s}}; }
Vec3<double> slope(double s) { return {{0.1, 0.4 * s, -0.03 * s * s}}; }
Vec3<double> moment(double s) { return {{1.0 + s, s * s, 0.5 * s * s * s - 2.0}}; }
Vec3<double> force(double s) { return {{2.0 - s * s, 1.0 + s, 0.5 * s}}; }
constexpr double kTriadSlope = 0.2;  // the relative rotation grows linearly about e3

/// Coefficient of the Legendre polynomial of degree j.
template <class Field>
Vec3<double> legendre_coefficient(int j, double start, const Field& field) {
  constexpr int kPoints = 6;
  double xi[kPoints], weight[kPoints], P[kPoints];
  gauss_rule(kPoints, xi, weight);
  Vec3<double> sum{};
  for (int q = 0; q < kPoints; ++q) {
    legendre(j, xi[q], P);
    sum += (0.5 * (2 * j + 1) * weight[q] * P[j]) * field(start + 0.5 * kElementLength * (1.0 + xi[q]));
  }
  return sum;
}

Scene scene() {
  Scene beam = cantilever(section(2.0, 3.0, 4.0, 5.0), kLength, kOrder, kElements);
  beam.sections[0].shear_stiffness[1] = kRigid;
  return beam;
}

State known_state(const Model& model) {
  const State state = model.reference_state();
  for (int v = 0; v <= kElements; ++v)
    store_vector(displacement(v * kElementLength), &state.views.vertex_displacement(v, 0));
  const ElementBlock& block = model.structure().blocks.front();
  for (int e = 0; e < kElements; ++e) {
    const double start = e * kElementLength;
    double* interior = &state.views.interior(block.interior_offset + e * block.interior.unknowns());
    double xi[kOrder], weight[kOrder];
    gauss_rule(kOrder, xi, weight);
    for (int q = 0; q < kOrder; ++q)
      store_vector(force(start + 0.5 * kElementLength * (1.0 + xi[q])), interior + block.interior.force(q));
    for (int j = 0; j <= kOrder; ++j)
      store_vector(legendre_coefficient(j, start, moment), interior + block.interior.moment(j));
    for (int j = 1; j < kOrder; ++j)
      store_vector(legendre_coefficient(j, start, slope), interior + block.interior.bubble(j));
    store_vector(Vec3<double>{{0, 0, 0.5 * kElementLength * kTriadSlope}},
                 interior + block.interior.relative_rotation(1));
  }
  return state;
}

double difference(const Vec3<double>& a, const Vec3<double>& b) { return norm(a - b); }

TEST(Sampling, PolynomialsOfTheElementSpacesAreExact) {
  const Model model(scene(), this_rank(), {});
  const State state = known_state(model);
  WorstError worst;
  for (int e = 0; e < kElements; ++e)
    for (double xi : {-1.0, -0.6, 0.0, 0.3, 1.0}) {
      const PointSample p = sample_element(model.structure(), model.mesh(), state, e, xi);
      const double s = kElementLength * (e + 0.5 * (1.0 + xi));
      worst.see(std::abs(p.arc_length - s), "arc length");
      worst.see(difference(p.reference_position, {{s, 0, 0}}), "reference position");
      worst.see(difference(p.displacement, displacement(s)), "displacement");
      worst.see(difference(p.position, Vec3<double>{{s, 0, 0}} + displacement(s)), "position");
      worst.see(difference(p.force, force(s)) / 36.0, "force, s = ", s);
      worst.see(difference(p.moment, moment(s)) / 108.0, "moment, s = ", s);
      const Vec3<double> angle = log_quaternion(p.triad);
      worst.see(difference(angle, {{0, 0, kTriadSlope * 0.5 * kElementLength * xi}}), "triad, s = ", s);
      const Vec3<double> n = force(s), m = moment(s);
      worst.see(difference(p.force_strain, {{n[0] / 2.0, n[1] / 3.0, 0.0}}) / 36.0, "force strain, s = ", s);
      worst.see(difference(p.moment_strain, {{m[0] / 4.0, m[1] / 5.0, m[2] / 5.0}}) / 108.0, "moment strain, s = ", s);
    }
  EXPECT_TRUE(worst.at_most(kFewRoundings));
}

TEST(Sampling, AxialAndShearForcesMayHaveTheirOwnPoints) {
  for (ForceIntegration rule : {ForceIntegration::axial_reduced, ForceIntegration::shear_reduced}) {
    Scene beam = scene();
    beam.members[0].force_integration = rule;
    const Model model(beam, this_rank(), {});
    const State state = model.reference_state();
    const ElementBlock& block = model.structure().blocks.front();
    const int axial = axial_points(kOrder, rule), shear = shear_points(kOrder, rule);
    std::vector<double> xi(axial + shear), weight(axial + shear);
    gauss_rule(axial, xi.data(), weight.data());
    gauss_rule(shear, xi.data() + axial, weight.data() + axial);
    for (int q = 0; q < axial + shear; ++q) {
      Vec3<double> n = force(0.5 * kElementLength * (1.0 + xi[q]));
      const double nonsense = 1e6;  // masked components must not matter
      if (q < axial)
        n[1] = n[2] = nonsense;
      else
        n[0] = nonsense;
      store_vector(n, &state.views.interior(block.interior_offset + block.interior.force(q)));
    }
    for (double x : {-1.0, 0.4}) {
      const PointSample p = sample_element(model.structure(), model.mesh(), state, 0, x);
      EXPECT_LE(difference(p.force, force(p.arc_length)), kFewRoundings * 10) << "xi " << x;
    }
  }
}

TEST(Sampling, MembersAreSampledFromEndToEnd) {
  const Model model(scene(), this_rank(), {});
  const std::vector<MemberSamples> members = sample_members(model.scene(), model, known_state(model), 4);
  ASSERT_EQ(members.size(), 1u);
  const MemberSamples& beam = members[0];
  EXPECT_EQ(beam.name, "beam");
  EXPECT_TRUE(beam.is_complete());
  ASSERT_EQ(beam.size(), 8u);
  for (size_t i = 0; i < beam.size(); ++i) {
    const double s = static_cast<double>(i / 4) * kElementLength + static_cast<double>(i % 4) * kElementLength / 3.0;
    EXPECT_NEAR(beam.arc_length[i], s, kFewRoundings);
    EXPECT_EQ(beam.element[i], static_cast<int>(i / 4));
    const Vec3<double> u = displacement(s);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(beam.displacement[i][c], u[c], kFewRoundings);
  }
}

/// A thousand chords are a smooth curve, whatever elements they belong to; fewer elements are drawn one by one.
TEST(Sampling, LongMembersHaveFewerPointsInEachElement) {
  for (const int order : {1, 4}) {
    EXPECT_EQ(recorded_points(order, 1), smooth_points(order));
    EXPECT_EQ(recorded_points(order, 500), 3);
    for (const int elements : {1000, 1001, 1000000}) EXPECT_EQ(recorded_points(order, elements), 2);
    for (int elements = 1; elements < 3000; elements += 7)
      EXPECT_TRUE((recorded_points(order, elements) - 1) * elements >= 1000 ||
                  recorded_points(order, elements) == smooth_points(order));
  }
}

TEST(Sampling, L2NormOfKnownFields) {
  const Model model(fork(2, 3), this_rank(), {});
  const State state = model.reference_state();
  const auto norm_of = [&](const auto& field) { return l2_norm(model, state, 4, field); };
  const auto constant = [](const PointSample&, int) { return Vec3<double>{{2.0, -3.0, 6.0}}; };
  EXPECT_NEAR(norm_of(constant), 7.0, kFewRoundings * 7.0);
  const auto zero = [](const PointSample& p, int) { return p.displacement; };
  EXPECT_EQ(norm_of(zero), 0.0);
  // arc length of the three members of lengths 1, pi/2, pi/2: int s^2 = (1 + 2 (pi/2)^3) / 3
  const auto arc_length = [](const PointSample& p, int) { return Vec3<double>{{0.0, p.arc_length, 0.0}}; };
  const double expected = std::sqrt((1.0 + 2.0 * std::pow(kPi / 2.0, 3)) / 3.0 / (1.0 + kPi));
  EXPECT_NEAR(norm_of(arc_length), expected, kFewRoundings);
  // one member only
  const auto of_shaft = [](const PointSample&, int member) {
    return Vec3<double>{{member == 0 ? 1.0 : 0.0, 0.0, 0.0}};
  };
  EXPECT_NEAR(norm_of(of_shaft), std::sqrt(1.0 / (1.0 + kPi)), kFewRoundings);
}

TEST(Sampling, StrainEnergyOfConstantForcesAndMoments) {
  for (ForceIntegration rule : {ForceIntegration::full, ForceIntegration::axial_reduced,
                                ForceIntegration::shear_reduced, ForceIntegration::both_reduced}) {
    Scene beam = scene();
    beam.members[0].force_integration = rule;
    const Model model(beam, this_rank(), {});
    const State state = model.reference_state();
    const ElementBlock& block = model.structure().blocks.front();
    const Vec3<double> n{{2.0, 3.0, 4.0}}, m{{1.0, 2.0, 3.0}};
    for (int e = 0; e < kElements; ++e) {
      double* interior = &state.views.interior(block.interior_offset + e * block.interior.unknowns());
      for (int q = 0; q < block.interior.force_points; ++q) store_vector(n, interior + block.interior.force(q));
      store_vector(m, interior + block.interior.moment(0));
    }
    const StrainEnergy energy = strain_energy(model, state);
    EXPECT_NEAR(energy.force, 0.5 * kLength * (4.0 / 2.0 + 9.0 / 3.0), 100 * kFewRoundings);  // GA3 is rigid
    EXPECT_NEAR(energy.moment, 0.5 * kLength * (1.0 / 4.0 + 4.0 / 5.0 + 9.0 / 5.0), 100 * kFewRoundings);
  }
}

TEST(Sampling, MotionOfAVertex) {
  const Model model(scene(), this_rank(), {});
  const State state = known_state(model);
  const Vec3<double> rotation{{0.5, -2.0, 1.0}};
  store_quaternion(exp_quaternion(rotation), &state.views.vertex_rotation(1, 0));
  const auto motion = vertex_motion(model, state, 1);
  const Vec3<double> u = displacement(kElementLength);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(motion[i], u[i]);
    EXPECT_NEAR(motion[3 + i], rotation[i], kFewRoundings);
  }
}

}  // namespace
}  // namespace mixbeam::test::sampling_test
