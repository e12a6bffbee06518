/// Elements that vibrate: velocities against derivatives of their motion, stiffness and recovery against those of
/// Newton's tangent, which eliminates in another order.
#include "kernels/vibration/vibration.hpp"
#include "tests/kernels/element_comparison.hpp"
#include "tests/kernels/element_derivatives.hpp"
#include "tests/kernels/general_section_energy.hpp"

#include <gtest/gtest.h>

namespace mixbeam::element_test::vibration_test {
namespace {

/// Sums of a few hundred products, and pivots of another order.
constexpr double kRounding = 1e-12, kElimination = 1e-10;
constexpr double kNoLimit = 1e300;

struct VibratingSample {
  SampleBlock samples;
  VibratingBlock vibrating;
  KernelView<double**> tangent;

  explicit VibratingSample(const SampleBlock& from, double shift = 0.0)
      : samples(from),
        vibrating(allocate_vibrating_block(
            samples.block,
            KernelView<double**>("mass", samples.block.count, kMassNumbers * (samples.block.order + 1)))),
        tangent("tangent", samples.block.first_element + samples.block.count, kFullTangent) {
    RandomNumbers random(77);
    for (size_t i = 0; i < vibrating.mass.size(); ++i) vibrating.mass.data()[i] = random.between(-1.0, 1.0);
    evaluate_vibration(vibrating, samples.structure, samples.state, shift, VibrationUse::counted, tangent);
  }
};

std::vector<double> random_motion(int size, std::uint64_t seed) {
  RandomNumbers random(seed);
  std::vector<double> motion(size);
  for (double& x : motion) x = random.between(-1.0, 1.0);
  return motion;
}

/// Motions of both vertices and increments of the interior of the only element as kernels take them.
struct Motion {
  KernelView<double* [6]> vertex { "vertex", 2 };
  KernelView<double*> interior;
  Motion(const SampleBlock& samples, const std::vector<double>& motion)
      : interior("interior", samples.interior_row(0) + samples.increments()) {
    for (int i = 0; i < 12; ++i) vertex(samples.vertex(0, i / 6), i % 6) = motion[i];
    for (int i = 0; i < samples.increments(); ++i) interior(samples.interior_row(0) + i) = motion[12 + i];
  }
};

/// Velocity and spin along the axes of the section at xi while the increments grow as `motion` times t, by
/// differentiation of position and triad.
std::array<double, 6> velocity(const ElementSample& sample, const std::vector<double>& motion, double xi) {
  std::vector<Fad> increments;
  for (const double x : motion) increments.push_back(Fad(kChunk, 0, 0.0) * x);
  const EnergyState<Fad> moved = perturbed(sample.state, increments.data());
  const Vec3<Fad> place = displacement_at(sample.element, moved, xi);
  const Quaternion<Fad> turn = element_rotation_at(moved, xi);
  const Quaternion<double> here{turn.w.val(), turn.x.val(), turn.y.val(), turn.z.val()};
  const Quaternion<double> rate{turn.w.dx(0), turn.x.dx(0), turn.y.dx(0), turn.z.dx(0)};
  const Quaternion<double> spin = conjugate(here) * rate;
  const Vec du = transpose_times(rotation_matrix(here), Vec{{place[0].dx(0), place[1].dx(0), place[2].dx(0)}});
  return {du[0], du[1], du[2], 2.0 * spin.x, 2.0 * spin.y, 2.0 * spin.z};
}

class Vibration : public testing::TestWithParam<int> {};

TEST_P(Vibration, MomentaAreThoseOfTheMotion) {
  const int k = GetParam();
  const ElementSample sample = random_sample({k, ForceIntegration::both_reduced, 5});
  const VibratingSample made{SampleBlock({sample})};
  const std::vector<double> motion = random_motion(12 + made.samples.increments(), 6);
  const Motion moved(made.samples, motion);
  const KernelView<double**> momenta("momenta", made.samples.block.first_element + 1,
                                     made.vibrating.layout().velocities());
  rows_of_motion(made.vibrating, MotionRow::momentum, moved.vertex, moved.interior, momenta);
  std::vector<double> xi(k + 1), weight(k + 1);
  gauss_rule(k + 1, xi.data(), weight.data());
  Difference d;
  for (int q = 0; q <= k; ++q) {
    const std::array<double, 6> rate = velocity(sample, motion, xi[q]);
    for (int i = 0; i < 6; ++i) {
      double sum = 0.0;
      for (int j = i; j < 6; ++j) sum += made.vibrating.mass(0, kMassNumbers * q + triangle(j, i)) * rate[j];
      d.add(0, momenta(made.samples.element_row(0), 6 * q + i),
            std::sqrt(0.5 * sample.element.curve.length * weight[q]) * sum);
    }
  }
  EXPECT_LE(d.relative(), kRounding);
}

/// x . G^T p = G x . p
TEST_P(Vibration, RowsAreTheTransposeOfMomenta) {
  const ElementSample sample = random_sample({GetParam(), ForceIntegration::full, 7});
  const VibratingSample made{SampleBlock({sample})};
  const int count = made.vibrating.layout().velocities(), element = made.samples.element_row(0);
  const std::vector<double> motion = random_motion(12 + made.samples.increments(), 8), p = random_motion(count, 9);
  const Motion moved(made.samples, motion), rows(made.samples, motion);
  const KernelView<double**> momenta("momenta", element + 1, count);
  const KernelView<double* [12]> ends("ends", element + 1);
  rows_of_motion(made.vibrating, MotionRow::momentum, moved.vertex, moved.interior, momenta);
  double left = 0.0, right = 0.0;
  for (int i = 0; i < count; ++i) left += std::exchange(momenta(element, i), p[i]) * p[i];
  rows_of_momenta(made.vibrating, momenta, rows.interior, ends);
  for (int i = 0; i < 12; ++i) right += ends(element, i) * motion[i];
  for (int i = 0; i < made.samples.increments(); ++i)
    right += rows.interior(made.samples.interior_row(0) + i) * motion[12 + i];
  EXPECT_NEAR(left, right, kRounding * std::max(1.0, std::abs(left)));
}

void expect_tangent_of_newton(const SampleBlock& samples, const std::string& text) {
  const VibratingSample made{samples};
  evaluate_tangent(samples.block, samples.structure, samples.state, samples.equations);
  Difference d;
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j)
      d.add(2 * (i / 3 % 2) + j / 3 % 2, made.tangent(samples.element_row(0), 12 * i + j),
            samples.equations.condensed_tangent(samples.element_row(0), 12 * i + j));
  EXPECT_LE(d.relative(), kElimination) << text;
}

TEST_P(Vibration, StiffnessIsThatOfTheTangent) {
  for (const ForceIntegration rule : kAllRules)
    expect_tangent_of_newton(SampleBlock({random_sample({GetParam(), rule, 10})}),
                             "rule " + std::to_string(static_cast<int>(rule)));
  GeneralSample general = general_sample(GetParam(), 11);
  expect_tangent_of_newton(general_block(general, kNoLimit, kNoLimit), "general section");
  set_rigid(general.law, {0, 4});
  expect_tangent_of_newton(general_block(general, 1e4, 1e4), "rigid components");
}

TEST_P(Vibration, LoadsAlongTheElementAddToTheStiffness) {
  for (const LineField kind : {LineField::dead_couple, LineField::follower_force, LineField::follower_couple}) {
    ElementSample sample = random_sample({GetParam(), ForceIntegration::both_reduced, 15});
    add_fields(sample.element, bit(kind), 16);
    const SampleBlock samples({sample}, true);
    expect_tangent_of_newton(samples, "field " + std::to_string(static_cast<int>(kind)));
    const VibratingSample made{samples};
    double asymmetry = 0.0, largest = 0.0;
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j) {
        const double here = made.tangent(samples.element_row(0), 12 * i + j);
        asymmetry = std::max(asymmetry, std::abs(here - made.tangent(samples.element_row(0), 12 * j + i)));
        largest = std::max(largest, std::abs(here));
      }
    EXPECT_GT(asymmetry, 1e3 * kElimination * largest);  // the twin: without the loads it is symmetric
  }
}

/// Under the same interior rows; Newton's are residuals, of N without weights.
TEST_P(Vibration, RecoversAsTheTangent) {
  GeneralSample general = general_sample(GetParam(), 12);
  ElementSample follower = random_sample({GetParam(), ForceIntegration::both_reduced, 17});
  add_fields(follower.element, bit(LineField::follower_force) | bit(LineField::follower_couple), 18);
  for (const SampleBlock& samples : {SampleBlock({random_sample({GetParam(), ForceIntegration::both_reduced, 12})}),
                                     general_block(general, kNoLimit, kNoLimit), SampleBlock({follower}, true)}) {
    const VibratingSample made{samples};
    const std::vector<double> motion = random_motion(12 + samples.increments(), 13);
    const Motion residual(samples, motion), rows(samples, motion), expected(samples, motion), found(samples, motion);
    condense_right_hand_side(samples.block, samples.structure, samples.state, residual.interior, samples.equations);
    Kokkos::deep_copy(expected.interior, samples.equations.constants);
    recover_interior(samples.block, samples.structure, samples.state, samples.equations, residual.vertex,
                     expected.interior);
    double* own = rows.interior.data() + samples.interior_row(0);
    std::vector<double> xi(GetParam()), weight(GetParam());
    gauss_rule(GetParam(), xi.data(), weight.data());
    for (int i = 0; i < samples.increments(); ++i)
      if (i < samples.block.interior.moment(0))
        own[i] *= 0.5 * samples.block.reference(0, 0) * weight[i / 3];
      else if (i >= made.vibrating.layout().stresses())
        own[i] = -own[i];
    recover_motion(made.vibrating, rows.interior, residual.vertex, found.interior);
    const KernelView<double* [12]> vertex("vertex", samples.block.first_element + 1);
    condense_rows(made.vibrating, rows.interior, vertex);
    Difference d;
    for (int i = 0; i < 12; ++i)
      d.add(3 + i / 3 % 2, -vertex(samples.element_row(0), i),
            samples.equations.condensed_residual(samples.element_row(0), i));
    for (int i = 0; i < samples.increments(); ++i)
      d.add(i < samples.block.interior.moment(0)     ? 0
            : i < made.vibrating.layout().stresses() ? 1
                                                     : 2,
            found.interior(samples.interior_row(0) + i), expected.interior(samples.interior_row(0) + i));
    EXPECT_LE(d.relative(), kElimination);
  }
}

/// Some columns of momenta, or of rows of stresses, against the way of one: random motions of the vertices.
struct ColumnSample {
  static constexpr int kCount = 6;  // more than lanes, and no multiple of them
  VibratingSample made;
  int momenta, stresses, element;
  std::vector<double> given, moved, out;
  std::vector<const double*> places;
  MomentumColumns of;

  ColumnSample(const SampleBlock& samples, bool has_spins) : made(samples), element(samples.element_row(0)) {
    made.vibrating = allocate_vibrating_block(samples.block, made.vibrating.mass, has_spins);
    allocate_columns(made.vibrating, samples.structure);
    evaluate_vibration(made.vibrating, samples.structure, samples.state, 0.7, VibrationUse::columns, made.tangent);
    momenta = made.vibrating.momenta();
    stresses = static_cast<int>(made.vibrating.capped.extent(0));
    given = random_motion(momenta * kCount, 21);
    moved = random_motion(12 * kCount, 22);
    out.resize(given.size());
    for (int j = 0; j < kCount; ++j) places.push_back(&moved[12 * j]);
    of = {kCount,    static_cast<size_t>(momenta), momenta, KernelView<int*>("place", element + 1), given.data(),
          out.data()};
    of.ends = KernelView<double**>("ends", element + 1, 12 * kCount);
    of.moved = places.data();
    of.stresses = stresses;
    of.excess = KernelView<double**>("excess", element + 1, stresses * kCount);
  }

  /// Interior rows of column j, and those of the vertices beside them.
  KernelView<double*> rows(int j, const KernelView<double* [12]>& ends) const {
    const KernelView<double*> interior("rows", made.samples.interior_row(0) + made.samples.increments());
    const KernelView<double**> own("momenta", element + 1, momenta);
    for (int i = 0; i < momenta && of.forces != nullptr; ++i) own(element, i) = given[momenta * j + i];
    rows_of_momenta(made.vibrating, own, interior, ends);
    for (int i = 0; i < stresses && of.forces == nullptr; ++i)
      interior(made.samples.interior_row(0) + made.vibrating.capped(i)) = of.excess(element, stresses * j + i);
    return interior;
  }
  /// Both passes; `d` takes ends, momenta and excess rows.
  void compare(Difference& d) const {
    std::vector<KernelView<double*>> all;
    condense_columns(made.vibrating, of);
    for (int j = 0; j < kCount; ++j) {
      const KernelView<double* [12]> ends("ends", element + 1);
      all.push_back(rows(j, ends));
      condense_rows(made.vibrating, all.back(), ends);
      for (int i = 0; i < 12; ++i) d.add(i / 3 % 2, of.ends(element, 12 * j + i), ends(element, i));
    }
    recover_columns(made.vibrating, of);
    for (int j = 0; j < kCount; ++j) {
      std::vector<double> motion(moved.begin() + 12 * j, moved.begin() + 12 * (j + 1));
      const KernelView<const double* [6]> vertex(motion.data(), 2);
      const KernelView<double*> found("found", all[j].extent(0)), excess("excess", all[j].extent(0));
      const KernelView<double**> own("momenta", element + 1, momenta);
      recover_motion(made.vibrating, all[j], vertex, found);
      rows_of_motion(made.vibrating, MotionRow::momentum, vertex, found, own);
      excess_rows(made.vibrating, found, excess);
      for (int i = 0; i < momenta; ++i) d.add(2, out[momenta * j + i], own(element, i));
      for (int i = 0; i < stresses; ++i)
        d.add(3, of.excess(element, stresses * j + i), excess(made.samples.interior_row(0) + made.vibrating.capped(i)));
    }
  }
};

TEST_P(Vibration, ColumnsAreOnesOfTheirOwn) {
  const SampleBlock plain({random_sample({GetParam(), ForceIntegration::both_reduced, 23})});
  SectionConstants& section = plain.structure.sections(plain.block.section(0));
  for (const int i : {0, 2}) {
    section.force_cap_compliance[i] = 0.5 * section.force_compliance[i];
    section.tangent_force_stiffness[i] = 1.0 / (1.5 * section.force_compliance[i]);
  }
  ElementSample follower = random_sample({GetParam(), ForceIntegration::axial_reduced, 24});
  add_fields(follower.element, bit(LineField::follower_force) | bit(LineField::follower_couple), 25);
  GeneralSample general = general_sample(GetParam(), 26);
  set_rigid(general.law, {0, 4});
  for (const SampleBlock& samples : {plain, SampleBlock({follower}, true), general_block(general, 1e4, 1e4)})
    for (const bool has_spins : {true, false}) {
      ColumnSample columns(samples, has_spins);
      Difference of_momenta, of_stresses;
      columns.compare(of_momenta);
      EXPECT_LE(of_momenta.relative(), kElimination);
      columns.of.forces = nullptr;
      if (columns.stresses > 0) columns.compare(of_stresses);
      EXPECT_LE(of_stresses.relative(), kElimination);
      columns.of.forces = columns.given.data();
      columns.made.vibrating.passed(0, 0) *= 1.01;  // the twin
      Difference wrong;
      columns.compare(wrong);
      EXPECT_GT(wrong.relative(), kElimination);
    }
}

/// Of (shift M) alone the condensed form of a rigid translation is its mass; interiors at rest have no negative pivot,
/// far above their own frequencies all of them that carry mass.
TEST_P(Vibration, InteriorsBecomeNegativeAboveTheirFrequencies) {
  ElementSample sample = random_sample({GetParam(), ForceIntegration::both_reduced, 14, 0.1, 0.1});
  for (auto* field : {&sample.state.force, &sample.state.moment})
    for (auto& value : *field) value = Vec3<double>{{0.0, 0.0, 0.0}};
  EXPECT_EQ((VibratingSample{SampleBlock({sample})}.vibrating.negative(0)), 0);
  EXPECT_EQ((VibratingSample{SampleBlock({sample}), -1e9}.vibrating.negative(0)), 3 * (2 * GetParam() - 1));
}

/// The frame of one element: masses of any kind anywhere.
struct FrameSample {
  FrameViews views;

  FrameSample(int k, std::uint64_t seed) {
    RandomNumbers random(seed);
    views.mass = KernelView<double**>("mass", 1, kMassNumbers * (k + 1));
    views.place = KernelView<double**>("place", 1, 3 * (k + 1));
    for (const auto& view : {views.mass, views.place})
      for (size_t i = 0; i < view.size(); ++i) view.data()[i] = random.between(-1.0, 1.0);
    views.spin = Vec{{0.7, -1.1, 0.4}};
  }
};

/// -1/2 |L^T (velocity, spin)|^2 of what the frame carries.
template <class S>
S centrifugal_energy(const ElementSample& sample, const FrameViews& frame, const EnergyState<S>& state) {
  const int points = sample.element.order + 1;
  std::vector<double> xi(points), weight(points);
  gauss_rule(points, xi.data(), weight.data());
  const Vec3<S> spin{{S(frame.spin[0]), S(frame.spin[1]), S(frame.spin[2])}};
  S sum(0.0);
  for (int q = 0; q < points; ++q) {
    Vec3<S> place = displacement_at(sample.element, state, xi[q]);
    for (int i = 0; i < 3; ++i) place[i] += frame.place(0, 3 * q + i);
    const Mat3<S> triad = rotation_matrix(element_rotation_at(state, xi[q]));
    const Vec3<S> velocity = transpose_times(triad, cross(spin, place)), turning = transpose_times(triad, spin);
    for (int i = 0; i < 6; ++i) {
      S momentum(0.0);
      for (int j = i; j < 6; ++j)
        momentum += frame.mass(0, kMassNumbers * q + triangle(j, i)) * (j < 3 ? velocity[j] : turning[j - 3]);
      sum -= 0.25 * sample.element.curve.length * weight[q] * momentum * momentum;
    }
  }
  return sum;
}

/// Places of motions among the increments of tests, which begin with the vertices.
int increment_of_motion(const VibrationLayout& layout, int motion) {
  return motion < layout.interior() ? 12 + layout.stresses() + motion : motion - layout.interior();
}

TEST_P(Vibration, CentrifugalRowsAreTheGradientOfTheirEnergy) {
  const ElementSample sample = random_sample({GetParam(), ForceIntegration::both_reduced, 31});
  const SampleBlock samples({sample});
  const FrameSample frame(GetParam(), 32);
  const Motion rows(samples, std::vector<double>(12 + samples.increments(), 0.0));
  const KernelView<double* [12]> ends("ends", samples.block.first_element + 1);
  add_centrifugal_rows(samples.block, frame.views, samples.state, 2.0, nullptr, rows.interior, ends);
  const std::vector<double> expected = gradient_at_zero(12 + samples.increments(), [&](const Fad* x) {
    return centrifugal_energy(sample, frame.views, perturbed(sample.state, x));
  });
  Difference d;
  for (int i = 0; i < 12; ++i) d.add(0, ends(samples.element_row(0), i), 2.0 * expected[i]);
  for (int i = 0; i < samples.increments(); ++i)
    d.add(1, rows.interior(samples.interior_row(0) + i), 2.0 * expected[12 + i]);
  EXPECT_LE(d.relative(), kRounding);
  const KernelView<double*> energy("energy", samples.block.first_element + 1);
  centrifugal_energies(samples.block, frame.views, samples.state, energy);
  const double exact = centrifugal_energy(sample, frame.views, sample.state);
  EXPECT_NEAR(energy(samples.element_row(0)), exact, kRounding * std::abs(exact));
}

TEST_P(Vibration, CentrifugalStiffnessIsTheSecondVariationOfTheirEnergy) {
  const ElementSample sample = random_sample({GetParam(), ForceIntegration::both_reduced, 33});
  const SampleBlock samples({sample});
  const FrameSample frame(GetParam(), 34);
  const VibratingSample at_rest{samples}, turning{samples};
  evaluate_vibration(turning.vibrating, samples.structure, samples.state, 0.0, VibrationUse::condensed, turning.tangent,
                     frame.views);
  const Dense expected = hessian_at_zero(12 + samples.increments(), [&](const FadOfFad* x) {
    return centrifugal_energy(sample, frame.views, perturbed(sample.state, x));
  });
  const VibrationLayout layout = turning.vibrating.layout();
  Difference d;
  for (int i = 0; i < layout.motions(); ++i)
    for (int j = 0; j < layout.motions(); ++j) {
      const int place = i * layout.motions() + j;
      d.add(0, turning.vibrating.geometric(0, place) - at_rest.vibrating.geometric(0, place),
            expected(increment_of_motion(layout, i), increment_of_motion(layout, j)));
    }
  EXPECT_LE(d.relative(), kElimination);
}

/// L W L^T = sum over particles of 2 m v . (o x v'), which is what Coriolis forces do in velocities v of a body that
/// consists of them.
TEST_P(Vibration, CoriolisForcesAreThoseOfParticles) {
  const int k = GetParam();
  const ElementSample sample = random_sample({k, ForceIntegration::both_reduced, 35});
  const SampleBlock samples({sample});
  FrameSample frame(k, 36);
  const std::vector<Vec> particles = {{{0, 0.3, 0}}, {{0, -0.1, 0.4}}, {{0.2, 0, -0.5}}, {{-0.1, 0.6, 0.1}}};
  const auto velocity_of = [](const Vec& at, int i) {
    Vec unit{};
    unit[i % 3] = 1.0;
    return i < 3 ? unit : cross(unit, at);
  };
  double mass[6][6] = {}, factor[kMassNumbers] = {};
  for (const Vec& at : particles)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) mass[i][j] += dot(velocity_of(at, i), velocity_of(at, j));
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) {
      double rest = mass[i][j];
      for (int l = 0; l < j; ++l) rest -= factor[triangle(i, l)] * factor[triangle(j, l)];
      factor[triangle(i, j)] = i == j ? std::sqrt(rest) : rest / factor[triangle(j, j)];
    }
  for (int q = 0; q <= k; ++q) std::copy_n(factor, kMassNumbers, &frame.views.mass(0, kMassNumbers * q));
  const KernelView<double**> found("found", 1, 36 * (k + 1));
  coriolis_matrices(samples.block, frame.views, samples.state, found);
  std::vector<double> xi(k + 1), weight(k + 1);
  gauss_rule(k + 1, xi.data(), weight.data());
  Difference d;
  for (int q = 0; q <= k; ++q) {
    const Vec spin = transpose_times(rotation_matrix(element_rotation_at(sample.state, xi[q])), frame.views.spin);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        double expected = 0.0, here = 0.0;
        for (const Vec& at : particles) expected += 2.0 * dot(velocity_of(at, i), cross(spin, velocity_of(at, j)));
        for (int a = 0; a <= i; ++a)
          for (int b = 0; b <= j; ++b)
            here += factor[triangle(i, a)] * found(0, 36 * q + 6 * a + b) * factor[triangle(j, b)];
        d.add(0, here, expected);
      }
  }
  EXPECT_LE(d.relative(), kRounding);
}

INSTANTIATE_TEST_SUITE_P(Orders, Vibration, testing::Range(1, kMaximumOrder + 1));

}  // namespace
}  // namespace mixbeam::element_test::vibration_test
