// Counts floating-point operations and bytes of the phases of an iteration for each element of a chain, by running the
// kernels on numbers that count, and writes the table that the studies of cost read. With the path of that table:
// compares.
#include "tests/support/counted_number.hpp"

#include "apps/common/studies/phase_costs.hpp"
#include "kernels/chains/elimination.hpp"
#include "kernels/chains/level.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/loops/dispatch.hpp"
#include "kernels/loops/element_loops.hpp"
#include "kernels/loops/planar_block.hpp"
#include "kernels/loops/planar_loops.hpp"
#include "kernels/math/rotation.hpp"

#include <fstream>
#include <iostream>
#include <sstream>

namespace mixbeam {

namespace {

/// Floating-point operations of one element with a plain section, all force parts reduced, and without line fields.
struct ElementOperations {
  double residual = 0.0, tangent = 0.0, recovery = 0.0;
};

constexpr int kCounted = 0;  ///< lanes of a CountedNumber

/// A straight, stress-free element of length one along x; what the numbers are makes no difference to the count.
struct CountedElement {
  ElementBlock block;
  StructureViews structure{KernelView<SectionConstants*>("section", 1)};
  StateViews state;
  ElementEquations equations;
  KernelView<double* [6]> vertex_increment { "vertex_increment", 2 };
  KernelView<double*> increment;
  PlanarBlock planar;
  PlanarTangents planar_tangents{"planar_tangents", 1};

  explicit CountedElement(int order) : increment("increment", InteriorLayout{order, order}.increments()) {
    block.order = order;
    block.count = 1;
    block.interior = {order, order};
    block.reference_layout = {order, order};
    block.reference = KernelView<double**>("reference", 1, block.reference_layout.size());
    block.vertices = KernelView<int* [2]>("vertices", 1);
    block.vertices(0, 1) = 1;
    block.section = KernelView<int*>("section", 1);
    block.reference(0, block.reference_layout.length()) = 1.0;
    for (int end = 0; end < 2; ++end) block.reference(0, block.reference_layout.end_triad(end)) = 1.0;
    for (int q = 0; q < order; ++q) block.reference(0, block.reference_layout.tangent(q)) = 1.0;
    Kokkos::deep_copy(structure.sections, ones());
    state = {KernelView<double* [3]>("displacement", 2), KernelView<double* [4]>("rotation", 2),
             KernelView<double* [4]>("triad", 1), KernelView<double*>("interior", block.interior.unknowns())};
    state.vertex_rotation(0, 0) = state.vertex_rotation(1, 0) = state.element_triad(0, 0) = 1.0;
    equations.residual = equations.condensed_residual = KernelView<double* [12]>("residual", 1);
    equations.planar_rows = KernelView<double* [4]>("planar_rows", 1);
    equations.interior_residual = increment;
    equations.condensed_tangent = KernelView<double**>("tangent", 1, kSymmetricTangent);
    equations.response = KernelView<double*>("response", block.response_size());
    equations.constants = increment;
    equations.largest_end_angle = KernelView<double*>("end_angle", 1);
    planar = make_planar_block(block, {{{1.0, 0.0, 0.0}}, {{0.0, 1.0, 0.0}}, {{0.0, 0.0, 1.0}}}, 1);
  }

 private:
  static SectionConstants ones() {
    SectionConstants section{};
    for (int i = 0; i < SectionConstants::kCount; ++i) section.numbers()[i] = 1.0;
    return section;
  }
};

template <class Loop>
double flops_of(const Loop& loop) {
  return static_cast<double>(operations_of([&] { loop(0); }).flops());
}

template <int K>
ElementOperations operations_in_space(const CountedElement& e) {
  const ElementGather<K, false, kCounted> gather(e.block, e.structure, e.state);
  return {flops_of(ResidualLoop<K, false, kCounted>{gather, e.equations}),
          flops_of(TangentLoop<K, false, kCounted>{gather, e.equations, {}}),
          flops_of(RecoverLoop<K, false, kCounted>{gather, e.equations.response, e.vertex_increment, e.increment})};
}

template <int K>
ElementOperations operations_in_plane(const CountedElement& e) {
  const PlanarGather<K, kCounted> gather(e.block, e.planar, e.structure, e.state);
  return {flops_of(PlanarResidualLoop<K, kCounted>{gather, e.equations}),
          flops_of(PlanarTangentLoop<K, kCounted>{gather, e.planar_tangents, e.equations.planar_rows, {}, {}}),
          flops_of(PlanarRecoverLoop<K, kCounted>{e.planar, e.block, e.vertex_increment, e.increment})};
}

/// Counted by running the kernels of that order on CountedNumber. In a plane without the projection of displacements,
/// triads and stresses on its axes, which is done by element and not by order.
ElementOperations element_operations(bool spatial, int order) {
  ElementOperations result{};
  const CountedElement element(order);
  for_order(order, [&](auto k) {
    result = spatial ? operations_in_space<k.value>(element) : operations_in_plane<k.value>(element);
  });
  return result;
}

constexpr int kDofs = 6;  ///< of a vertex in states, rows and increments, which are spatial also for planar scenes
constexpr int kVertexState = 3 + 4, kTriad = 4;

double bytes_of(double numbers, double integers = 0.0) { return sizeof(double) * numbers + sizeof(int) * integers; }

/// What a vertex has on either side when it goes between the spatial layout and that of the chains.
template <int N>
constexpr int kTurnedToPlane = N == kPlanarDofs ? kDofs + kPlanarDofs : 0;

template <int N>
FreeLinkMatrix<N, CountedNumber> any_link() {
  FreeLinkMatrix<N, CountedNumber> link;
  for (int i = 0; i < N; ++i) link.second[triangle(i, i)] = 1.0;
  for (int i = 0; i < link.kTurned; ++i) link.first[triangle(i, i)] = 1.0;
  return link;
}

/// Elimination of one vertex, and of its rows on the way. The tree of runs eliminates all vertices but the last,
/// whatever the lengths of the runs.
template <int N>
PhaseCost condense_cost() {
  FreeLinkMatrix<N, CountedNumber> chain = any_link<N>();
  const auto next = any_link<N>();
  FreeVertexFactors<N, CountedNumber> factors;
  PivotWatch<CountedNumber> watch;
  CountedNumber b[N], first[N], second[N];
  const auto count = operations_of([&] {
    eliminate_vertex<N>(chain, next, factors, watch);
    eliminate_rows<N>(factors, next, b, first, second);
  });
  const int numbers = TangentLayout<N>::kSymmetric + free_factor_size(N) + 2 * N;
  return {static_cast<double>(count.flops() + N), bytes_of(numbers + kTurnedToPlane<N>, 3)};
}

/// Solution outwards.
template <int N>
PhaseCost solve_cost() {
  FreeVertexFactors<N, CountedNumber> factors;
  const auto next = any_link<N>();
  CountedNumber b[N], first[N], second[N];
  const auto count = operations_of([&] { follow_neighbours(factors, next, first, second, b); });
  const int numbers = free_factor_size(N) + TangentLayout<N>::kSymmetric + 2 * N;
  return {static_cast<double>(count.flops()), bytes_of(numbers + kTurnedToPlane<N>, 3)};
}

/// b - K x and |K| X + |b| with the matrices of the elements on both sides of a vertex, N rows each over u_b - u_a and
/// both spins.
template <int N>
PhaseCost check_cost() {
  constexpr double entries = 2 * N * TangentLayout<N>::kReduced;
  return {4.0 * entries, bytes_of(TangentLayout<N>::kSymmetric + 3 * kDofs + kTurnedToPlane<N>, 4)};
}

struct Layouts {
  InteriorLayout interior;
  ReferenceLayout reference;
  int response, constants, tangent, vertex_rows, input_numbers;
  Layouts(const std::string& kind, int order)
      : interior{order, force_point_count(order, ForceIntegration::both_reduced)},
        reference{order, interior.force_points},
        response(ResponseLayout{order}.size()),
        constants(interior.increments()),
        tangent(kSymmetricTangent),
        vertex_rows(2 * kDofs),
        input_numbers(reference.size()) {
    if (kind == "spatial") return;
    response = planar_response_size(order);
    constants = 0;
    tangent = kPlanarTangent;
    vertex_rows = 4;
    input_numbers = planar_constants_size(order);
  }
  /// State, reference and numbers of vertices and member.
  double input() const { return bytes_of(kVertexState + kTriad + interior.unknowns() + input_numbers, 3); }
};

/// Condensed residuals, gathered by vertex.
PhaseCost assemble_cost(const Layouts& layouts) { return {2.0 * kDofs, bytes_of(layouts.vertex_rows + kDofs, 4)}; }

/// The element writes its rows, scaled inside, those of vertices are gathered and scaled; sizes are found before.
PhaseCost residual_cost(const Layouts& layouts, double element_flops) {
  const int interior = layouts.interior.increments();
  const int written = layouts.vertex_rows + interior + 1, gathered = layouts.vertex_rows / 2 + kDofs;
  const int magnitude = kVertexState + layouts.interior.unknowns(), scaled = 2 * kDofs;
  const double flops = element_flops + 2.0 * kDofs + interior + kDofs;
  return {flops, layouts.input() + bytes_of(written + gathered + magnitude + scaled)};
}

PhaseCost tangent_cost(const Layouts& layouts, double element_flops) {
  return {element_flops,
          layouts.input() + bytes_of(layouts.vertex_rows + layouts.tangent + layouts.response + layouts.constants)};
}

/// In space N and M follow from the state once more; in the plane all rows are kept.
PhaseCost recover_cost(const std::string& kind, const Layouts& layouts, double element_flops) {
  const double input = kind == "spatial" ? layouts.input() : bytes_of(0, 3);
  return {element_flops,
          input + bytes_of(layouts.response + layouts.constants + kDofs + layouts.interior.increments())};
}

/// x + step d; rotations of element and vertex are composed.
PhaseCost update_cost(const Layouts& layouts) {
  const int unknowns = layouts.interior.unknowns();
  Quaternion<CountedNumber> q{1.0, 0.0, 0.0, 0.0};
  const Vec3<CountedNumber> spin{{0.1, 0.1, 0.1}};
  const auto count = operations_of([&] { q = normalized(q * exp_quaternion(CountedNumber(1.0) * spin)); });
  const double flops = 2.0 * count.flops() + 2.0 * (unknowns + 3);
  return {flops, bytes_of(3 * unknowns + 3 + 2 * kTriad + 2 * kVertexState + kDofs)};
}

template <int N>
std::map<std::string, PhaseCost> linear_costs() {
  return {{"condense chains", condense_cost<N>()}, {"solve", solve_cost<N>()}, {"check of the solve", check_cost<N>()}};
}

std::map<std::string, PhaseCost> counted_costs(const std::string& kind, int order) {
  const bool spatial = kind == "spatial";
  const Layouts layouts(kind, order);
  const ElementOperations element = element_operations(spatial, order);
  std::map<std::string, PhaseCost> costs = spatial ? linear_costs<kSpatialDofs>() : linear_costs<kPlanarDofs>();
  costs["residual"] = residual_cost(layouts, element.residual);
  costs["element tangent"] = tangent_cost(layouts, element.tangent);
  costs["recover"] = recover_cost(kind, layouts, element.recovery);
  costs["update"] = update_cost(layouts);
  costs["assemble"] = assemble_cost(layouts);
  return costs;
}

/// A line for each kind and order: flops and bytes of kCountedPhases, for an initialiser.
std::string counted_table() {
  std::ostringstream table;
  for (const char* kind : {"spatial", "planar"})
    for (int order = 1; order <= kMaximumOrder; ++order) {
      table << "{\"" << kind << "\", " << order << ", {";
      const std::map<std::string, PhaseCost> costs = counted_costs(kind, order);
      for (const char* phase : kCountedPhases)
        table << (phase == kCountedPhases.front() ? "{" : ", {") << static_cast<long>(costs.at(phase).flops) << ", "
              << static_cast<long>(costs.at(phase).bytes) << "}";
      table << "}},\n";
    }
  return table.str();
}

}  // namespace

}  // namespace mixbeam

int main(int argc, char** argv) {
  const Kokkos::ScopeGuard kokkos(argc, argv);
  const std::string table = mixbeam::counted_table();
  if (argc < 2) {
    std::cout << table;
    return 0;
  }
  std::stringstream known;
  known << std::ifstream(argv[1]).rdbuf();
  if (known.str() == table) return 0;
  std::cerr << argv[1] << " is not what the kernels do; allowed: the output of " << argv[0] << "\n";
  return 1;
}
