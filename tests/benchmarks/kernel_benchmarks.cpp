/// Micro-benchmarks of what Newton's method calls for each point, element and vertex, on one thread and with data that
/// stay in the cache: rotation maps, element residual and tangent of every order, elimination of one vertex.
#include "kernels/chains/elimination.hpp"
#include "kernels/execution/execution_space.hpp"
#include "kernels/math/rotation.hpp"
#include "tests/kernels/general_section_energy.hpp"

#include <benchmark/benchmark.h>

#include <array>

namespace mixbeam {
namespace {

using element_test::RandomNumbers;

/// Different arguments in turn, so that no branch is always the same; few enough for the first cache.
constexpr int kArguments = 64;
/// Fills all lanes and packs several times, and a state of order 8 still fits into the second cache.
constexpr int kElements = 32;
constexpr std::uint64_t kSeed = 1;

std::array<Vec3<double>, kArguments> rotation_vectors() {
  RandomNumbers random(kSeed);
  std::array<Vec3<double>, kArguments> vectors;
  for (auto& v : vectors) v = random.between(0.0, 3.1) * random.direction();
  return vectors;
}

/// map(argument) for every argument in turn; the rate is that of single calls.
template <class Argument, class Map>
void call_in_turn(benchmark::State& state, const std::array<Argument, kArguments>& arguments, const Map& map) {
  for (auto _ : state)
    for (const Argument& argument : arguments) {
      auto result = map(argument);
      benchmark::DoNotOptimize(result);
    }
  state.SetItemsProcessed(state.iterations() * kArguments);
}

void exp_of_a_rotation_vector(benchmark::State& state) {
  call_in_turn(state, rotation_vectors(), [](const Vec3<double>& psi) { return exp_quaternion(psi); });
}
BENCHMARK(exp_of_a_rotation_vector);

void log_of_a_quaternion(benchmark::State& state) {
  std::array<Quaternion<double>, kArguments> quaternions;
  const auto vectors = rotation_vectors();
  for (int i = 0; i < kArguments; ++i) quaternions[i] = exp_quaternion(vectors[i]);
  call_in_turn(state, quaternions, [](const Quaternion<double>& q) { return log_quaternion(q); });
}
BENCHMARK(log_of_a_quaternion);

void tangent_map_of_a_rotation_vector(benchmark::State& state) {
  call_in_turn(state, rotation_vectors(), [](const Vec3<double>& psi) { return tangent_map(psi); });
}
BENCHMARK(tangent_map_of_a_rotation_vector);

void inverse_tangent_map_of_a_rotation_vector(benchmark::State& state) {
  call_in_turn(state, rotation_vectors(), [](const Vec3<double>& psi) { return inverse_tangent_map(psi); });
}
BENCHMARK(inverse_tangent_map_of_a_rotation_vector);

/// Second argument of benchmarks of elements.
enum Sections { plain, tapered, coupled };

element_test::SampleBlock elements_of_order(int order, int sections) {
  std::vector<element_test::ElementSample> all;
  std::vector<element_test::GeneralSample> general;
  for (std::uint64_t e = 0; e < kElements; ++e) {
    all.push_back(element_test::random_sample({order, ForceIntegration::both_reduced, kSeed + e}));
    general.push_back(element_test::general_sample(order, kSeed + e));
    if (sections == tapered) element_test::uncouple(general.back().law);
  }
  return sections == plain ? element_test::SampleBlock(all) : element_test::general_block(general, 1e4, 1e4);
}

/// What an element takes.
template <class Evaluate>
void each_element(benchmark::State& state, const Evaluate& evaluate) {
  const auto samples = elements_of_order(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  for (auto _ : state) evaluate(samples);
  state.SetItemsProcessed(state.iterations() * kElements);
}
const std::vector<std::vector<int64_t>> kOrdersAndSections = {benchmark::CreateDenseRange(1, kMaximumOrder, 1),
                                                              {plain, tapered, coupled}};

void element_residual(benchmark::State& state) {
  each_element(state, [](const auto& s) { evaluate_residual(s.block, s.structure, s.state, s.equations); });
}
BENCHMARK(element_residual)->ArgsProduct(kOrdersAndSections);

void element_tangent(benchmark::State& state) {
  each_element(state, [](const auto& s) { evaluate_tangent(s.block, s.structure, s.state, s.equations); });
}
BENCHMARK(element_tangent)->ArgsProduct(kOrdersAndSections);

void element_recovery(benchmark::State& state) {
  const KernelView<double* [6]> vertices("vertices", 2 * kElements);
  each_element(state, [&](const auto& s) {
    recover_interior(s.block, s.structure, s.state, s.equations, vertices, s.equations.interior_residual);
  });
}
BENCHMARK(element_recovery)->ArgsProduct(kOrdersAndSections);

/// A link with positive pivots, the same in all lanes.
template <int N>
FreeLinkMatrix<N, Pack<kLanes>> sample_link() {
  RandomNumbers random(kSeed);
  FreeLinkMatrix<N, Pack<kLanes>> link;
  const auto fill = [&](int n, auto& block) {
    for (int i = 0; i < n; ++i)
      for (int j = 0; j <= i; ++j) block[triangle(i, j)] = random.between(-1.0, 1.0) + (i == j ? 4.0 * N : 0.0);
  };
  fill(link.kTurned, link.first);
  fill(N, link.second);
  for (auto& row : link.coupling)
    for (auto& number : row) number = random.between(-1.0, 1.0);
  return link;
}

/// kLanes chains side by side, N unknowns for each vertex: 6 in space, 3 in a plane.
template <int N>
void elimination_of_one_vertex(benchmark::State& state) {
  const auto link = sample_link<N>();
  FreeVertexFactors<N, Pack<kLanes>> factors;
  PivotWatch<Pack<kLanes>> watch;
  auto chain = link;
  for (auto _ : state) {
    chain.second[0] = link.second[0];  // keeps the chain from being computed once for all
    eliminate_vertex<N>(chain, link, factors, watch);
    benchmark::DoNotOptimize(factors);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * kLanes);
}
BENCHMARK_TEMPLATE(elimination_of_one_vertex, 6);
BENCHMARK_TEMPLATE(elimination_of_one_vertex, 3);

}  // namespace
}  // namespace mixbeam

int main(int argc, char** argv) {
  Kokkos::initialize(argc, argv);
  mixbeam::set_number_of_threads(1);
  benchmark::Initialize(&argc, argv);
  const bool understood = !benchmark::ReportUnrecognizedArguments(argc, argv);
  if (understood) benchmark::RunSpecifiedBenchmarks();
  Kokkos::finalize();
  return understood ? 0 : 1;
}
