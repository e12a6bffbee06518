/// The parallel loops over a block: any number of threads gives the same bits, and increments mean what they say.
#include "kernels/execution/execution_space.hpp"
#include "tests/kernels/element_comparison.hpp"
#include "tests/support/same_bits.hpp"

#include <gtest/gtest.h>

#include <string>

namespace mixbeam::element_test {
namespace {

constexpr int kElements = 37;  // no number of threads divides it

/// Turning the given rows of u' to the element frame and the response back rounds once more than the own residual does.
constexpr double kTurningTolerance = 1e-12;

/// Elements with and without follower forces lie beside each other.
ElementSample loaded_element(int order, ForceIntegration rule, std::uint64_t e) {
  ElementSample sample = random_sample({order, rule, 100 + e});
  RandomNumbers random(200 + e);
  sample.element.line_force = random.vector(1.0);
  sample.element.line_couple = random.vector(1.0);
  if (e % 2 == 1) sample.element.follower_force = {random.vector(1.0), random.vector(1.0)};
  return sample;
}

SampleBlock many_elements(int order, ForceIntegration rule) {
  std::vector<ElementSample> samples;
  for (std::uint64_t e = 0; e < kElements; ++e) samples.push_back(loaded_element(order, rule, e));
  return SampleBlock(samples, true);
}

KernelView<double*> random_increments(const SampleBlock& samples, std::uint64_t seed) {
  const KernelView<double*> increment("increment", samples.interior_row(samples.block.count));
  RandomNumbers random(seed);
  for (size_t i = 0; i < increment.extent(0); ++i) increment(i) = random.between(-1.0, 1.0);
  return increment;
}

StateViews zero_copy(const StateViews& state) {
  return {KernelView<double* [3]>("displacement", state.vertex_displacement.extent(0)),
          KernelView<double* [4]>("rotation", state.vertex_rotation.extent(0)),
          KernelView<double* [4]>("triad", state.element_triad.extent(0)),
          KernelView<double*>("interior", state.interior.extent(0))};
}

/// Every number that the loops write, with the name of the view it is in.
struct NamedNumbers {
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;
  template <class View>
  void add(const std::string& name, const View& view) {
    names.push_back(name);
    values.emplace_back(view.data(), view.data() + view.size());
  }
};

NamedNumbers everything_written(int order, ForceIntegration rule) {
  const SampleBlock samples = many_elements(order, rule);
  const ElementEquations& equations = samples.equations;
  NamedNumbers numbers;
  evaluate_residual(samples.block, samples.structure, samples.state, equations);
  numbers.add("residual", equations.residual);
  numbers.add("interior residual", equations.interior_residual);
  numbers.add("largest end angle", equations.largest_end_angle);
  condense_right_hand_side(samples.block, samples.structure, samples.state, random_increments(samples, 1), equations);
  numbers.add("constants of a given right-hand side", equations.constants);
  evaluate_tangent(samples.block, samples.structure, samples.state, equations);
  numbers.add("condensed tangent", equations.condensed_tangent);
  numbers.add("condensed residual", equations.condensed_residual);
  numbers.add("response", equations.response);
  const KernelView<double* [6]> vertex_increment("vertex_increment", 2 * kElements);
  RandomNumbers random(2);
  for (size_t i = 0; i < vertex_increment.size(); ++i) vertex_increment.data()[i] = random.between(-1.0, 1.0);
  numbers.add("constants", equations.constants);
  const KernelView<double*> increment = equations.constants;
  recover_interior(samples.block, samples.structure, samples.state, equations, vertex_increment, increment);
  numbers.add("interior increment", increment);
  const StateViews to = zero_copy(samples.state);
  apply_interior_increment(samples.block, samples.state, increment, 0.5, to);
  numbers.add("interior", to.interior);
  numbers.add("triads", to.element_triad);
  return numbers;
}

class ElementLoops : public testing::TestWithParam<int> {
 protected:
  ElementLoops() : threads_before_(number_of_threads()) {}
  ~ElementLoops() override { set_number_of_threads(threads_before_); }

 private:
  int threads_before_;
};

TEST_P(ElementLoops, SameBitsWithAnyNumberOfThreads) {
  for (const ForceIntegration rule : kAllRules) {
    set_number_of_threads(1);
    const NamedNumbers expected = everything_written(GetParam(), rule);
    for (const int threads : {2, 4}) {
      set_number_of_threads(threads);
      const NamedNumbers found = everything_written(GetParam(), rule);
      for (size_t i = 0; i < expected.names.size(); ++i)
        EXPECT_TRUE(test::same_bits(found.values[i], expected.values[i]))
            << expected.names[i] << ", " << threads << " threads, order " << GetParam() << ", rule "
            << static_cast<int>(rule);
    }
  }
}

/// An element's numbers do not depend on the others in its block, and numbers before its offset belong to other blocks.
TEST_P(ElementLoops, EachElementIsAloneInItsRows) {
  const SampleBlock many = many_elements(GetParam(), ForceIntegration::both_reduced);
  evaluate_tangent(many.block, many.structure, many.state, many.equations);
  const int e = 17, rows = many.block.response_size();
  const ElementSample sample = loaded_element(GetParam(), ForceIntegration::both_reduced, e);
  const SampleBlock one({sample}, true);
  evaluate_tangent(one.block, one.structure, one.state, one.equations);
  const auto part = [](const double* begin, int size) { return std::vector<double>(begin, begin + size); };
  EXPECT_TRUE(test::same_bits(part(&many.equations.condensed_tangent(many.element_row(e), 0), 144),
                              part(&one.equations.condensed_tangent(one.element_row(0), 0), 144)));
  EXPECT_TRUE(test::same_bits(part(many.equations.response.data() + many.block.response_offset + e * rows, rows),
                              part(one.equations.response.data() + one.block.response_offset, rows)));
  for (size_t i = 0; i < many.block.response_offset; ++i) EXPECT_EQ(many.equations.response(i), 0.0);
  for (int i = 0; i < many.block.first_element; ++i) EXPECT_EQ(many.equations.condensed_tangent(i, 0), 0.0);
}

/// The own residual given as right-hand side: the same tangent, the same response, and the condensed residual without
/// its vertex rows, up to the rounding of turning rows into the element frame. No bits: the two are different functions
/// to the compiler, which fuses products and sums in each as it likes (for Zen not as for other processors).
TEST_P(ElementLoops, OwnResidualAsRightHandSide) {
  for (const ForceIntegration rule : kAllRules) {
    const SampleBlock own = many_elements(GetParam(), rule), given = many_elements(GetParam(), rule);
    evaluate_residual(own.block, own.structure, own.state, own.equations);
    evaluate_tangent(own.block, own.structure, own.state, own.equations);
    condense_right_hand_side(given.block, given.structure, given.state, own.equations.interior_residual,
                             given.equations);
    Difference response, tangent, residual;
    for (size_t i = own.block.response_offset; i < own.equations.response.size(); ++i)
      response.add(0, given.equations.response(i), own.equations.response(i));
    for (size_t i = 0; i < own.equations.constants.size(); ++i)
      response.add(1, given.equations.constants(i), own.equations.constants(i));
    for (size_t i = 0; i < own.equations.condensed_tangent.size(); ++i)
      tangent.add(0, given.equations.condensed_tangent.data()[i], own.equations.condensed_tangent.data()[i]);
    for (size_t i = 0; i < own.equations.residual.size(); ++i)
      residual.add(0, given.equations.condensed_residual.data()[i] + own.equations.residual.data()[i],
                   own.equations.condensed_residual.data()[i]);
    EXPECT_LE(response.relative(), kTurningTolerance) << "order " << GetParam();
    EXPECT_LE(tangent.relative(), kTurningTolerance) << "order " << GetParam();
    EXPECT_LE(residual.relative(), kTurningTolerance) << "order " << GetParam();
  }
}

/// interior + scale * increment, and Lambda_lo exp(scale w) for the triad.
TEST_P(ElementLoops, ApplyInteriorIncrement) {
  constexpr double a_few_roundings =
      2e-15;  // for each radian: sine and cosine of large angles see the rounding of the angle
  const SampleBlock samples = many_elements(GetParam(), ForceIntegration::both_reduced);
  const KernelView<double*> increment = random_increments(samples, 4);
  for (const double scale : {0.0, 1e-12, 0.3, 1.0, -1.0, 20.0}) {
    SampleBlock after = samples;
    after.state = zero_copy(samples.state);
    apply_interior_increment(samples.block, samples.state, increment, scale, after.state);
    Difference interior, triad;
    for (int e = 0; e < kElements; ++e) {
      const double* d = increment.data() + samples.interior_row(e);
      std::vector<double> scaled(kVertexIncrements, 0.0);
      for (int i = 0; i < samples.increments(); ++i) scaled.push_back(scale * d[i]);
      const Quaternion<double> expected = perturbed(samples.state_of(e), scaled.data()).element_triad;
      const Quaternion<double> found = after.state_of(e).element_triad;
      for (int i = 0; i < samples.block.interior.unknowns(); ++i)
        interior.add(0, after.interior(e)[i], samples.interior(e)[i] + scale * d[i]);
      triad.add(0, found.w, expected.w);
      for (const auto component : {&Quaternion<double>::x, &Quaternion<double>::y, &Quaternion<double>::z})
        triad.add(0, found.*component, expected.*component);
    }
    EXPECT_LE(interior.relative(), a_few_roundings) << "order " << GetParam() << ", scale " << scale;
    EXPECT_LE(triad.relative(), a_few_roundings * (1.0 + std::fabs(scale)))
        << "order " << GetParam() << ", scale " << scale;
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, ElementLoops, testing::Range(1, kMaximumOrder + 1));

}  // namespace
}  // namespace mixbeam::element_test
