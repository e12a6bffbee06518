// Condensed chains give the solution of the whole matrix; where they cannot, the whole matrix is solved.
#include "nonlinear/linear/chain_solver.hpp"

#include "kernels/execution/execution_space.hpp"
#include "nonlinear/linear/network_factors.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace {

constexpr double kCheckTolerance = 1e-8;  // of the solver's own check: its default
/// Two eliminations in different orders: rounding of the entries, 1e-16, times the square of the number of elements
/// (300 at most) times the ratio of axial to bending stiffness (1e3 per element) in the softest motion.
constexpr double kAgreement = 1e-8;

/// Of a solution by another elimination in the rows of chains: rounding of 1e-16 times the ratio of stiffnesses per
/// element, 1e4, and a margin.
constexpr double kResidual = 1e-11;

EvaluationPoint moved_point(const Model& model) {
  MixedVector motion = model.create_vector(), residual = model.create_vector();
  const auto vertex = motion.vertex();
  const double length = model.structure().length;
  for (size_t i = 0; i < vertex.extent(0); ++i)
    vertex(i) = 0.05 * std::sin(1.0 + 0.3 * model.map()->getGlobalElement(static_cast<int>(i))) *
                (i % kVertexDofs < 3 ? 0.02 * length : 1.0);
  return mixed_residual(model, model.apply(model.reference_state(), motion, 1.0), 0.5, residual);
}

/// A scene in a state off equilibrium and away from the reference, with its tangent in space.
class MovedScene {
 public:
  MovedScene(const Scene& scene, const Communicator& comm)
      : model(scene, comm, {}), point(moved_point(model)), tangent(model, point, cap_for(model, point.scales), {true}) {
    b = Teuchos::rcp(new DofVector(model.map()));
    const auto rows = MixedVector::view_of(*b);
    for (size_t i = 0; i < rows.extent(0); ++i) rows(i) = std::cos(2.0 + 1.7 * global(i));
  }

  DofVector solution(TangentSolver& solver) const {
    DofVector x(model.map());
    solver.factorize(tangent);
    EXPECT_LE(solver.solve(*b, x), kCheckTolerance);
    return x;
  }
  DofVector solution_of_the_whole() const {
    const auto solver = make_direct_tangent_solver(model, "KLU2", kCheckTolerance);
    return solution(*solver);
  }
  /// The largest difference of displacements and of rotations, each relative to the largest of its kind.
  double difference(const DofVector& x, const DofVector& y) const {
    DofVector d(x, Teuchos::Copy);
    d.update(-1.0, y, 1.0);
    double worst = 0.0;
    for (int part : {kForcePart, kMomentPart}) worst = std::max(worst, largest(d, part) / largest(y, part));
    return worst;
  }

  const Model model;
  EvaluationPoint point;
  Tangent tangent;
  Teuchos::RCP<DofVector> b;

 private:
  double largest(const DofVector& x, int part) const {
    const LargestParts parts = largest_parts(*model.map()->getComm(), MixedVector::view_of(x));
    return part == kForcePart ? parts.moved : parts.turned;
  }
  double global(size_t local) const {
    return static_cast<double>(model.map()->getGlobalElement(static_cast<int>(local)));
  }
};

/// Two members that meet where nothing else happens, the second one drawn backwards, from a free end.
Scene backward_member(int elements) {
  Scene scene = cantilever(section(1e4, 5e3, 2.0, 1.0), 1.0, 2, elements);
  scene.points.push_back({"free", {1.5, 0.7, 0.2}});
  scene.members.push_back(line("back", "free", "tip", 1, elements));
  return scene;
}

/// Loads where a chain goes on: a dead force, which adds no tangent, and one with a moment or that follows, which does.
Scene loaded_inside(int elements) {
  Scene scene = backward_member(elements);
  Member& member = scene.members.back();
  member.inner_points = {{"dead", 0.2}, {"moment", 0.5}, {"follower", 0.7}};
  scene.point_loads = {{"tip", {1.0, 2.0, 3.0}, {}},
                       {"dead", {-3.0, 1.0, 0.5}, {}},
                       {"moment", {}, {0.3, 0.1, -0.2}},
                       {"follower", {2.0, 0.0, 1.0}, {}}};
  scene.point_loads.back().frame = LoadFrame::follower;
  scene.point_loads.back().member = member.name;
  return scene;
}

/// A network: with a potential, with hinges, and with spatial moments, which have none.
constexpr int kNetworkPoints = 6;
Scene hinged_lattice() {
  Scene scene = lattice(kNetworkPoints);
  for (const auto& [point, next] : {std::pair("2,2,2", "2,2,3"), {"3,3,3", "4,3,3"}, {"4,1,2", "4,2,2"}})
    scene.joints.push_back(joint(JointKind::hinge, point, {std::string(point) + " to " + next}, {0, 1, 2}));
  return scene;
}
Scene lattice_under_moments() {
  Scene scene = lattice(kNetworkPoints);
  for (PointLoad& load : scene.point_loads) load.moment = {0.3, 0.1, -0.2};
  return scene;
}

/// Line loads without potential on a member that is drawn backwards, and one with a potential on the other.
Scene under_followers(int elements) {
  Scene scene = backward_member(elements);
  scene.distributed_loads = {{"back", {40, -60, 70}, {2, -1, 3}, 1, LoadFrame::follower},
                             {"back", {}, {20, 10, -30}, 1},
                             {scene.members[0].name, {0, 30, 0}, {}, 1}};
  return scene;
}

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  for (int elements : {1, 2, 3, 5, 8, 9, 33, 70, 300})
    all.push_back(cantilever(section(1e4, 5e3, 2.0, 1.0), 1.0, 1, elements));
  for (int elements : {1, 4, 17}) all.push_back(backward_member(elements));
  all.push_back(loaded_inside(17));
  for (int elements : {1, 3, 12}) all.push_back(fork(2, elements));
  for (int elements : {1, 3, 12, 300}) all.push_back(under_followers(elements));
  all.push_back(portal_of_joints(2, 5));
  all.push_back(lattice(kNetworkPoints, 1, 2));
  all.push_back(hinged_lattice());
  all.push_back(lattice_under_moments());
  return all;
}

void expect_solution_of_the_whole(const Communicator& comm) {
  for (const Scene& scene : scenes()) {
    const MovedScene moved(scene, comm);
    ChainSolver chains(moved.model, kSparseSolver, kCheckTolerance);
    const DofVector x = moved.solution(chains), y = moved.solution_of_the_whole();
    EXPECT_LE(moved.difference(x, y), kAgreement) << scene.name << ", " << scene.members[0].elements;
    EXPECT_EQ(chains.fallback_factorizations(), 0);
    // a later right-hand side uses the same factors
    moved.b->scale(-3.0);
    DofVector again(moved.model.map());
    chains.solve(*moved.b, again);
    again.scale(-1.0 / 3.0);
    EXPECT_LE(moved.difference(again, y), kAgreement);
  }
}
TEST(ChainSolver, SolutionOfTheWhole) { expect_solution_of_the_whole(this_rank()); }
TEST(MpiChainSolver, SolutionOfTheWhole) { expect_solution_of_the_whole(all_ranks()); }

/// A right-hand side that is known when chains are eliminated goes along with them.
TEST(ChainSolver, FirstSolveHasTheBitsOfALaterOne) {
  for (const Scene& scene : scenes()) {
    const MovedScene moved(scene, this_rank());
    ChainSolver chains(moved.model, kSparseSolver, kCheckTolerance);
    const DofVector later = moved.solution(chains);
    DofVector first(moved.model.map());
    first.putScalar(std::numeric_limits<double>::quiet_NaN());
    chains.factorize(moved.tangent, {moved.b.get(), &first});
    const auto half = MixedVector::view_of(std::as_const(first));
    const auto done = std::count_if(half.data(), half.data() + half.extent(0), [](double x) { return x == x; });
    EXPECT_EQ(done, kVertexDofs * chains.system().eliminated_vertices()) << "half done inside chains";
    chains.solve(*moved.b, first);
    EXPECT_EQ(moved.difference(first, later), 0.0) << scene.name << ", " << scene.members[0].elements;
  }
}

/// One chain of three: its place among them does not matter.
TEST(ChainSolver, NotANumberInAnyChainIsUnreliable) {
  const MovedScene moved(fork(2, 3), this_rank());
  CondensedSystem system(moved.model);
  EXPECT_TRUE(system.condense(moved.tangent));
  const auto stiffness = moved.tangent.elements().condensed_tangent;
  for (size_t e = 0; e < stiffness.extent(0); ++e) {
    const double entry = stiffness(e, 0);
    stiffness(e, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(system.condense(moved.tangent)) << "element " << e;
    stiffness(e, 0) = entry;
  }
}

/// Who writes to it nevertheless is found out by the check.
TEST(ChainSolver, AFirstSolveOfOtherRowsIsCorrected) {
  const MovedScene moved(fork(2, 12), this_rank());
  ChainSolver chains(moved.model, kSparseSolver, kCheckTolerance);
  const DofVector x = moved.solution(chains);
  DofVector twice(moved.model.map());
  chains.factorize(moved.tangent, {moved.b.get(), &twice});
  moved.b->scale(2.0);
  EXPECT_LE(chains.solve(*moved.b, twice), kCheckTolerance);
  EXPECT_GT(moved.difference(twice, x), 0.5);
  twice.scale(0.5);
  EXPECT_LE(moved.difference(twice, x), kAgreement);
}

bool is_factorized_as_symmetric(const Scene& scene, int* factorized = nullptr) {
  const MovedScene moved(scene, this_rank());
  CondensedSystem system(moved.model);
  system.condense(moved.tangent);
  NetworkFactors factors(system.matrix(), moved.model.times());
  factors.factorize();
  if (factorized != nullptr) *factorized = factors.unknowns();
  return factors.is_symmetric();
}
TEST(NetworkFactors, SymmetricWhereTheTangentIs) {
  int unknowns = 0;
  EXPECT_TRUE(is_factorized_as_symmetric(lattice(kNetworkPoints), &unknowns));
  // those of clamped points are taken out
  EXPECT_EQ(unknowns, kVertexDofs * (kNetworkPoints - 1) * kNetworkPoints * kNetworkPoints);
  EXPECT_FALSE(is_factorized_as_symmetric(hinged_lattice()));
  EXPECT_FALSE(is_factorized_as_symmetric(lattice_under_moments()));
}

TEST(NetworkFactors, KeptForTheSameMatrix) {
  const MovedScene moved(lattice(kNetworkPoints), this_rank());
  CondensedSystem system(moved.model);
  NetworkFactors factors(system.matrix(), moved.model.times());
  DofVector b(system.matrix()->getRangeMap()), x(b.getMap()), again(b.getMap());
  b.putScalar(1.0);
  const auto solve = [&](DofVector& solution) {
    system.condense(moved.tangent);
    factors.factorize();
    factors.solve(b, solution);
    return factors.factorizations();
  };
  EXPECT_EQ(solve(x), 1);
  EXPECT_EQ(solve(again), 1);
  again.update(-1.0, x, 1.0);
  EXPECT_EQ(again.normInf(), 0.0);
  moved.tangent.elements().condensed_tangent(5, 0) *= 1.01;
  EXPECT_EQ(solve(again), 2);
  again.update(-1.0, x, 1.0);
  EXPECT_GT(again.normInf(), 0.0);
}

/// Factors of an earlier matrix precondition the next one; signs are told by its own, and what is too different, or
/// what may not know of earlier ones, is factorised.
TEST(NetworkFactors, ServeTheNextMatrix) {
  constexpr int kWorthIterating = 15;  // points along an edge: a factorisation takes as long as 16 solves
  const Model model(lattice(kWorthIterating), this_rank(), {});
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, model.reference_state(), 0.0, residual);
  const Tangent tangent(model, point, cap_for(model, point.scales), {true});
  CondensedSystem system(model);
  NetworkFactors factors(system.matrix(), model.times());
  DofVector b(system.matrix()->getRangeMap()), x(b.getMap()), own(b.getMap());
  const auto rows = MixedVector::view_of(b);
  for (size_t i = 0; i < rows.extent(0); ++i) rows(i) = std::cos(2.0 + 1.7 * static_cast<double>(i));
  const auto solve = [&](double stiffening) {
    const auto stiffness = tangent.elements().condensed_tangent;
    for (size_t e = 0; e < stiffness.extent(0); e += 7)
      for (size_t k = 0; k < stiffness.extent(1); ++k) stiffness(e, k) *= stiffening;
    system.condense(tangent);
    factors.factorize();
    factors.solve(b, x);
    return factors.factorizations();
  };
  const auto expect_own_solution = [&] {
    NetworkFactors fresh(system.matrix(), model.times());
    fresh.factorize();
    fresh.solve(b, own);
    own.update(-1.0, x, 1.0);
    EXPECT_LE(own.normInf(), 1e-8 * x.normInf());
    EXPECT_EQ(factors.negative_eigenvalues(), fresh.negative_eigenvalues());
  };
  EXPECT_EQ(solve(1.0), 1);
  EXPECT_EQ(solve(1.01), 1);
  EXPECT_GT(factors.iterations(), 0);
  expect_own_solution();
  EXPECT_EQ(factors.factorizations(), 2) << "signs are those of an earlier matrix";
  EXPECT_EQ(solve(1e3), 3) << "iterated far away";
  expect_own_solution();
  factors.reset_factors();
  EXPECT_EQ(solve(1.01), 4);
}

/// In the plane of a scene three unknowns of each vertex stand alone.
TEST(NetworkFactors, PlanarTangentsHaveHalfTheUnknowns) {
  const Model model(side_of_lattice(kNetworkPoints), this_rank(), {});
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, model.reference_state(), 0.5, residual);
  for (bool in_space : {false, true}) {
    const Tangent tangent(model, point, cap_for(model, point.scales), {in_space});
    CondensedSystem system(model);
    system.condense(tangent);
    NetworkFactors factors(system.matrix(), model.times());
    factors.factorize();
    // at the two free corners two members end: they are eliminated with them
    EXPECT_EQ(factors.unknowns(), (in_space ? 6 : 3) * (kNetworkPoints * (kNetworkPoints - 1) - 2));
  }
}

TEST(ChainSolver, OnlyEndsJunctionsAndConditionsRemain) {
  const MovedScene moved(backward_member(20), this_rank());
  const CondensedSystem system(moved.model);
  // the clamp and the free end
  EXPECT_EQ(system.matrix()->getNodeNumRows(), size_t{2} * kVertexDofs);
  EXPECT_EQ(system.eliminated_vertices(), moved.model.mesh().vertices() - 2);
}

/// A dead force is a right-hand side alone; what adds to the tangent keeps its vertex: moments, followers.
TEST(ChainSolver, AVertexUnderADeadForceIsEliminated) {
  const auto kept = [](const Vector3& force, const Vector3& moment, LoadFrame frame) {
    Scene scene = backward_member(20);
    PointLoad load{"tip", force, moment};
    load.frame = frame;
    load.member = scene.members.front().name;
    scene.point_loads = {load};
    const MovedScene moved(scene, this_rank());
    return moved.model.mesh().vertices() - CondensedSystem(moved.model).eliminated_vertices();
  };
  EXPECT_EQ(kept({1.0, 2.0, 3.0}, {}, LoadFrame::dead), 2);
  EXPECT_EQ(kept({}, {0.0, 0.0, 1.0}, LoadFrame::dead), 3);
  EXPECT_EQ(kept({1.0, 2.0, 3.0}, {}, LoadFrame::follower), 3);
}

/// Line loads without potential leave nothing behind, and their chains are not taken for symmetric ones.
TEST(ChainSolver, ChainsWithoutSymmetry) {
  const MovedScene moved(under_followers(12), this_rank()), dead(backward_member(12), this_rank());
  CondensedSystem system(moved.model);
  EXPECT_EQ(system.matrix()->getNodeNumRows(), CondensedSystem(dead.model).matrix()->getNodeNumRows());
  const DofVector x = moved.solution_of_the_whole();
  DofVector half(moved.model.map()), rows(system.matrix()->getRangeMap());
  const auto error_of_chains = [&](bool symmetric_part) {
    EXPECT_TRUE(system.condense(moved.tangent, symmetric_part));
    system.condense_rows(*moved.b, rows, half);
    return system.chain_error(*moved.b, x);
  };
  EXPECT_LE(error_of_chains(false), kResidual);
  EXPECT_GT(error_of_chains(true), 1e5 * kResidual);
}

TEST(ChainSolver, AWrongTangentWouldBeNoticed) {
  const MovedScene moved(fork(2, 12), this_rank());
  ChainSolver chains(moved.model, kSparseSolver, kCheckTolerance);
  const DofVector x = moved.solution(chains);
  moved.tangent.elements().condensed_tangent(5, 0) *= 1.01;
  const auto whole = make_direct_tangent_solver(moved.model, kSparseSolver, kCheckTolerance);
  EXPECT_GT(moved.difference(x, moved.solution(chains)), 1e3 * kAgreement);
}

TEST(ChainSolver, ErrorIsSeenInEveryRowOfAChain) {
  const MovedScene moved(fork(1, 12), this_rank());
  CondensedSystem system(moved.model);
  ChainSolver chains(moved.model, kSparseSolver, kCheckTolerance);
  const DofVector x = moved.solution(chains);
  ASSERT_TRUE(system.condense(moved.tangent));
  DofVector half(moved.model.map()), rows(system.matrix()->getRangeMap());
  system.condense_rows(*moved.b, rows, half);
  EXPECT_LE(system.chain_error(*moved.b, x), 1e-13);
  for (int vertex : {0, 3, 12, 20}) {
    DofVector wrong(x, Teuchos::Copy);
    MixedVector::view_of(wrong)(vertex_row(vertex, 1)) *= 1.0 + 1e-4;
    MixedVector::view_of(wrong)(vertex_row(vertex, 1)) += 1e-6;
    EXPECT_GT(system.chain_error(*moved.b, wrong), 1e-9) << vertex;
  }
}

/// What a refinement works on: b - K x at vertices inside chains.
TEST(ChainSolver, ResidualIsWhereTheErrorIs) {
  const MovedScene moved(fork(1, 12), this_rank());
  CondensedSystem system(moved.model);
  ChainSolver chains(moved.model, kSparseSolver, kCheckTolerance);
  const DofVector x = moved.solution(chains);
  ASSERT_TRUE(system.condense(moved.tangent));
  DofVector half(moved.model.map()), rows(system.matrix()->getRangeMap()), residual(moved.model.map());
  system.condense_rows(*moved.b, rows, half);
  const auto largest = [&](const DofVector& of) {
    system.chain_residual(*moved.b, of, residual);
    return largest_parts(*moved.model.map()->getComm(), MixedVector::view_of(residual)).moved;
  };
  DofVector wrong(x, Teuchos::Copy);
  MixedVector::view_of(wrong)(vertex_row(3, 1)) += 1e-6;
  const double at_solution = largest(x);
  EXPECT_GT(largest(wrong), 1e3 * at_solution) << "at the solution " << at_solution;
}

/// Lets both links at an inner vertex of a straight row cancel in the diagonal entry of its first unknown, so that the
/// first pivot there is as good as zero; its neighbours still hold it. (An exact zero is too much for KLU2 as well.)
void make_pivot_zero(const MovedScene& moved, int vertex) {
  const auto adjacency = moved.model.adjacency();
  const auto tangents = moved.tangent.elements().condensed_tangent;
  ASSERT_EQ(tangents.extent(1), size_t{kSymmetricTangent});
  const int a = adjacency.element(adjacency.start(vertex), 0), b = adjacency.element(adjacency.start(vertex) + 1, 0);
  tangents(b, 0) = -tangents(a, 0) * (1.0 - 1e-15);
}

TEST(ChainSolver, ZeroPivotInAChainIsSolvedAsAWhole) {
  const MovedScene moved(fork(1, 12), this_rank());
  make_pivot_zero(moved, 4);  // the first one in a run of three
  ChainSolver chains(moved.model, kSparseSolver, kCheckTolerance);
  const DofVector x = moved.solution(chains);
  EXPECT_EQ(chains.fallback_factorizations(), 1);
  EXPECT_LE(moved.difference(x, moved.solution_of_the_whole()), kAgreement);
}

// Chains give a mechanism away. What the whole matrix makes of it depends on its rounding errors: it is refused, or the
// free motion is seen in the solution. The twin is the same rod, held.
TEST(ChainSolver, MechanismIsReported) {
  constexpr double kFreeMotion = 1e6;  // far beyond the condition of the rod that is held
  for (const bool held : {true, false}) {
    Scene scene = cantilever(section(1e4, 5e3, 2.0, 1.0), 1.0, 1, 12);
    scene.supports[0].displacement_fixed[0] = held;  // else free along the rod
    const MovedScene moved(scene, this_rank());
    ChainSolver chains(moved.model, kSparseSolver, kCheckTolerance);
    chains.factorize(moved.tangent);
    DofVector x(moved.model.map());
    bool reported = false;
    try {
      chains.solve(*moved.b, x);
      reported = x.normInf() > kFreeMotion * moved.b->normInf();
    } catch (const LinearSolverError&) {
      reported = true;
    }
    EXPECT_EQ(reported, !held);
    EXPECT_EQ(chains.fallback_factorizations(), held ? 0 : 1);
  }
}

TEST(ChainSolver, SameBitsForAnyNumberOfThreads) {
  const int before = number_of_threads();
  for (const Scene& scene : {fork(2, 150), lattice(kNetworkPoints, 2, 2)}) {
    const MovedScene moved(scene, this_rank());
    ChainSolver chains(moved.model, kSparseSolver, kCheckTolerance);
    set_number_of_threads(1);
    const DofVector x = moved.solution(chains);
    for (int threads : {2, 4}) {
      set_number_of_threads(threads);
      const DofVector y = moved.solution(chains);
      EXPECT_EQ(moved.difference(x, y), 0.0);
    }
  }
  set_number_of_threads(before);
}

}  // namespace
}  // namespace mixbeam::test
