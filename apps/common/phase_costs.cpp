#include "apps/common/phase_costs.hpp"

#include "apps/common/element_operations.hpp"
#include "kernels/chain_elimination.hpp"
#include "kernels/chain_level.hpp"
#include "kernels/counted_number.hpp"
#include "kernels/element_layout.hpp"
#include "kernels/rotation.hpp"

namespace mixbeam {

namespace {

constexpr int kDofs = 6;  ///< of a vertex
constexpr int kVertexState = 3 + 4, kTriad = 4;

double bytes_of(double numbers, double integers = 0.0) { return sizeof(double) * numbers + sizeof(int) * integers; }

LinkMatrix<kDofs, CountedNumber> any_link() {
  LinkMatrix<kDofs, CountedNumber> link;
  for (int i = 0; i < kDofs; ++i) link.first[triangle(i, i)] = link.second[triangle(i, i)] = 1.0;
  return link;
}

/// Elimination of one vertex. The tree of runs eliminates all vertices but the last, whatever the lengths of the runs.
PhaseCost condense_cost() {
  LinkMatrix<kDofs, CountedNumber> chain = any_link();
  const auto next = any_link();
  VertexFactors<kDofs, CountedNumber> factors;
  PivotWatch<CountedNumber> watch;
  const double flops = operations_of([&] { eliminate_vertex<kDofs>(chain, next, factors, watch); }).flops();
  return {flops, bytes_of(kSymmetricTangent + vertex_factor_size(kDofs), 2)};
}

/// Right-hand side inwards, solution outwards.
PhaseCost solve_cost() {
  VertexFactors<kDofs, CountedNumber> factors;
  CountedNumber b[kDofs], neighbour[kDofs];
  const auto count = operations_of([&] {
    pass_on<kDofs>(factors.left, b, neighbour);
    pass_on<kDofs>(factors.right, b, neighbour);
    solve_block<kDofs>(factors.factor, b);
    follow<kDofs>(factors.left, neighbour, b);
    follow<kDofs>(factors.right, neighbour, b);
  });
  const int inwards = vertex_factor_size(kDofs) + 2 * kDofs, outwards = 2 * kDofs * kDofs + 2 * kDofs;
  return {static_cast<double>(count.flops() + kDofs), bytes_of(inwards + outwards, 3)};
}

/// b - K x and |K| X + |b| with the matrices of the elements on both sides of a vertex, six rows of nine numbers each.
PhaseCost check_cost() {
  constexpr double rows = 2 * kDofs * 9;
  return {4.0 * rows, bytes_of(kSymmetricTangent + 3 * kDofs, 4)};
}

/// Condensed residuals, gathered by vertex.
PhaseCost assemble_cost() { return {2.0 * kDofs, bytes_of(3 * kDofs, 4)}; }

struct Layouts {
  InteriorLayout interior;
  ReferenceLayout reference;
  ResponseLayout response;
  explicit Layouts(int order)
      : interior{order, force_point_count(order, ForceIntegration::both_reduced)},
        reference{order, interior.force_points},
        response{order, interior.force_points} {}
  /// State, reference and numbers of vertices and member.
  double input() const { return bytes_of(kVertexState + kTriad + interior.unknowns() + reference.size(), 3); }
};

/// The element writes its rows, which are gathered by vertex and all divided by their scales; sizes are found before.
PhaseCost residual_cost(const Layouts& layouts, double element_flops) {
  const int interior = layouts.interior.increments();
  const int written = 2 * kDofs + interior + 1, gathered = 3 * kDofs;
  const int magnitude = kVertexState + layouts.interior.unknowns(), scaled = 2 * (interior + kDofs);
  const double flops = element_flops + 2.0 * kDofs + interior + kDofs;
  return {flops, layouts.input() + bytes_of(written + gathered + magnitude + scaled)};
}

PhaseCost tangent_cost(const Layouts& layouts, double element_flops) {
  return {element_flops, layouts.input() + bytes_of(2 * kDofs + kSymmetricTangent + layouts.response.size())};
}

PhaseCost recover_cost(const Layouts& layouts, double element_flops) {
  return {element_flops, layouts.input() + bytes_of(layouts.response.size() + kDofs + layouts.interior.increments())};
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

PhaseCost operator+(const PhaseCost& a, const PhaseCost& b) { return {a.flops + b.flops, a.bytes + b.bytes}; }

}  // namespace

std::map<std::string, PhaseCost> phase_costs(const std::string& kind, int order) {
  if (kind != "spatial") return {};
  const Layouts layouts(order);
  const ElementOperations element = element_operations(order);
  std::map<std::string, PhaseCost> costs = {{"residual", residual_cost(layouts, element.residual)},
                                            {"element tangent", tangent_cost(layouts, element.tangent)},
                                            {"recover", recover_cost(layouts, element.recovery)},
                                            {"update", update_cost(layouts)},
                                            {"condense chains", condense_cost()},
                                            {"assemble", assemble_cost()},
                                            {"solve", solve_cost()},
                                            {"check of the solve", check_cost()}};
  costs[kElementWork] = costs["residual"] + costs["element tangent"] + costs["recover"] + costs["update"];
  costs[kLinearSolver] = costs["condense chains"] + costs["solve"] + costs["check of the solve"];
  costs[kWholeIteration] = costs[kElementWork] + costs[kLinearSolver] + costs["assemble"];
  return costs;
}

}  // namespace mixbeam
