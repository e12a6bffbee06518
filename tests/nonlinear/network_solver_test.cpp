// Lattices solved by conjugate gradients with coarse spaces: as many iterations as were measured by an independent
// program, the solution of the direct solver, the same bits for any number of threads, and refusals.
#include "nonlinear/multilevel/network_solver.hpp"

#include "kernels/execution/execution_space.hpp"
#include "tests/nonlinear/stability_fixture.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/solve.hpp"

#include <dlfcn.h>

#include <map>
#include <numeric>

namespace mixbeam::test {
namespace network_solver_test {

/// A block of struts on a clamped floor, pushed aside at the top; cell 1, EI = 1.
struct Block {
  std::vector<std::array<int, 3>> points, directions;  ///< points on a grid; struts lead along the directions
  double cell = 1.0;
  double slenderness = 20.0, displaced = 0.0, removed = 0.0;
  int floor_direction = 2;
  Vector3 load = {0.01, 0.02, 0.005};  ///< at each point of the top
};

std::vector<std::array<int, 3>> grid(int nx, int ny, int nz) {
  std::vector<std::array<int, 3>> points;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) points.push_back({i, j, k});
  return points;
}

Block cubic(int size, double slenderness) {
  return {grid(size, size, size), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1.0, slenderness};
}

Block body_centred(int size, double slenderness) {
  Block block{{}, {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {-1, 1, 1}}, 1.0 / std::sqrt(3.0), slenderness};
  for (const auto& [i, j, k] : grid(2 * size, 2 * size, 2 * size))
    if (i % 2 == j % 2 && j % 2 == k % 2) block.points.push_back({i, j, k});
  return block;
}

Block octet(int size, double slenderness) {
  Block block{{}, {{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}}, std::sqrt(0.5), slenderness};
  for (const auto& p : grid(2 * size, 2 * size, 2 * size))
    if ((p[0] + p[1] + p[2]) % 2 == 0) block.points.push_back(p);
  return block;
}

Block sheet(int size, double slenderness) {
  Block block{grid(size, size, 1), {{1, 0, 0}, {0, 1, 0}}, 1.0, slenderness};
  block.floor_direction = 0;
  return block;
}

Scene scene_of(const Block& block) {
  std::mt19937 random(7);
  const auto share = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  const double axial = block.slenderness * block.slenderness;
  Scene scene;
  scene.name = "lattice";
  scene.sections = {section(axial, 0.35 * axial, 0.8, 1.0)};
  std::map<std::array<int, 3>, std::string> name;
  int top = 0;
  for (const auto& p : block.points) top = std::max(top, p[block.floor_direction]);
  for (const auto& p : block.points) {
    name[p] = "p" + std::to_string(name.size());
    Vector3 position{};
    for (int c = 0; c < 3; ++c) position[c] = block.cell * p[c] + block.displaced * (2.0 * share() - 1.0);
    scene.points.push_back({name[p], position});
    const int height = p[block.floor_direction];
    if (height == 0) scene.supports.push_back(clamp(name[p]));
    if (height == top) scene.point_loads.push_back(dead_load(name[p], block.load));
  }
  for (const auto& p : block.points)
    for (const auto& d : block.directions) {
      const std::array<int, 3> q = {p[0] + d[0], p[1] + d[1], p[2] + d[2]};
      // along the first direction nothing is missing, so that nothing falls off
      if (name.count(q) == 0 || (d != block.directions.back() && share() < block.removed)) continue;
      scene.members.push_back(line("m" + std::to_string(scene.members.size()), name[p], name[q], 1, 1));
    }
  return scene;
}

/// A scene and its tangent where nothing has moved yet.
struct Tangents {
  explicit Tangents(const Scene& scene, const Communicator& ranks = this_rank()) : model(scene, ranks, options()) {
    MixedVector residual = model.create_vector();
    point.emplace(mixed_residual(model, model.reference_state(), 1.0, residual));
    tangent.emplace(model, *point, cap_for(model, point->scales), TangentKind{true});
    rows = Teuchos::rcp(new DofVector(tangent->condensed_rows(), Teuchos::Copy));
  }
  static ModelOptions options() {
    ModelOptions options;
    options.force_stiffness_cap = 1e12;  // the struts as they are
    return options;
  }
  DofVector solution(TangentSolver& solver) const {
    DofVector x(model.map());
    solver.factorize(*tangent);
    EXPECT_LE(solver.solve(*rows, x), 1e-8);
    return x;
  }
  const Model model;
  std::optional<EvaluationPoint> point;
  std::optional<Tangent> tangent;
  Teuchos::RCP<DofVector> rows;
};

/// A chain solver with the iterative one, which can be asked.
struct Iterative {
  explicit Iterative(const Model& model, double reduction = NetworkSolver::kReduction,
                     double most_fallback_entries = NetworkSolver::kMostFallbackEntries)
      : chains(model, kSparseSolver, 1e-8, [&](const CondensedSystem& system) {
          auto solver = make_network_solver(system, 1e-8, model.times(), false, reduction, most_fallback_entries);
          network = solver.get();
          return solver;
        }) {}
  NetworkSolver* network = nullptr;
  ChainSolver chains;
};

double relative_difference(const DofVector& x, const DofVector& y) {
  DofVector d(x, Teuchos::Copy);
  d.update(-1.0, y, 1.0);
  return d.norm2() / y.norm2();
}

int iterations(const Block& block) {
  const Tangents tangents(scene_of(block));
  Iterative solver(tangents.model);
  tangents.solution(solver.chains);
  EXPECT_EQ(solver.network->objection(), "");
  return solver.network->iterations();
}

/// Most iterations of an independent program (design notes: 16 to 31 at 8,000 to 20,000 junctions) for two levels.
constexpr int kMostIterations = 32;

TEST(NetworkSolver, IterationsDoNotGrowWithSlenderness) {
  for (double slenderness : {5.0, 20.0, 1000.0}) {
    EXPECT_LE(iterations(cubic(11, slenderness)), kMostIterations) << "cubic " << slenderness;
    EXPECT_LE(iterations(body_centred(8, slenderness)), kMostIterations) << "body-centred " << slenderness;
    EXPECT_LE(iterations(octet(7, slenderness)), kMostIterations) << "octet " << slenderness;
    EXPECT_LE(iterations(sheet(40, slenderness)), kMostIterations) << "sheet " << slenderness;
    Block irregular = cubic(11, slenderness);  // 30 % removed
    irregular.displaced = 0.2;
    irregular.removed = 0.45;
    EXPECT_LE(iterations(irregular), kMostIterations) << "irregular " << slenderness;
  }
}

/// Of the solutions: rounding, 1e-16, times the condition, which is the square of slenderness times that of size
/// and more: 1.0e-9 where nothing is fused.
constexpr double kAgreement = 2e-9;

TEST(NetworkSolver, SolutionOfTheDirectSolver) {
  for (const Block& block : {cubic(10, 100.0), sheet(40, 20.0)}) {
    const Tangents tangents(scene_of(block));
    Iterative solver(tangents.model, 1e-12);
    const auto direct = make_direct_tangent_solver(tangents.model, kChains, 1e-8);
    DofVector x = tangents.solution(solver.chains);
    const DofVector y = tangents.solution(*direct);
    EXPECT_LE(relative_difference(x, y), kAgreement);
    EXPECT_GT(solver.network->iterations(), 3) << "it was iterated";
    x.scale(1.0 + 2.0 * kAgreement);
    EXPECT_GT(relative_difference(x, y), kAgreement) << "the comparison sees an error";
  }
}

/// Largest difference between the displacements of vertices here and those of the same ones of one rank, relative to
/// the largest of those.
double largest_difference(const Tangents& together, const DofVector& x, const DofVector& alone) {
  const auto a = MixedVector::view_of(x), e = MixedVector::view_of(alone);
  const std::vector<int>& vertex = together.model.structure().local_vertex_to_global;
  double most = 0.0;
  for (int v = 0; v < static_cast<int>(a.extent(0)) / kVertexDofs; ++v)
    for (int c = 0; c < kVertexDofs; ++c)
      most = std::max(most, std::abs(a(vertex_row(v, c)) - e(vertex_row(vertex[v], c))));
  return maximum_over_ranks(*together.model.map()->getComm(), most) / alone.normInf();
}

/// Aggregates end where shares of ranks do: a few more of them are odd.
constexpr double kMoreOnRanks = 1.25;

TEST(MpiNetworkSolver, SolutionOfOneRank) {
  Block displaced = cubic(11, 100.0);
  displaced.displaced = 0.2;
  for (const Block& block : {cubic(12, 20.0), displaced, sheet(40, 20.0), cubic(4, 20.0)}) {
    const Tangents together(scene_of(block), all_ranks()), alone(scene_of(block));
    Iterative solver(together.model, 1e-12), of_one_rank(alone.model, 1e-12);
    const DofVector x = together.solution(solver.chains);
    DofVector y = alone.solution(of_one_rank.chains);
    EXPECT_EQ(solver.network->objection(), "");
    EXPECT_EQ(solver.network->negative_eigenvalues(), std::optional<long>(0));
    EXPECT_LE(solver.network->iterations(), kMoreOnRanks * of_one_rank.network->iterations());
    EXPECT_LE(largest_difference(together, x, y), kAgreement);
    y.scale(1.0 + 2.0 * kAgreement);
    EXPECT_GT(largest_difference(together, x, y), kAgreement) << "the comparison sees an error";
    const DofVector again = together.solution(solver.chains);
    EXPECT_TRUE(same_bits(MixedVector::view_of(x), MixedVector::view_of(again)));
  }
}

/// All ranks learn what one of them finds.
TEST(MpiNetworkSolver, LoadsThatTurnOnOneRankAreLeftToFactors) {
  Scene scene = scene_of(cubic(6, 20.0));
  scene.point_loads.push_back(
      follower_load(scene.members.back().end_point, scene.members.back().name, {0.5, 0.0, 0.0}, {0.0, 1.0, 0.5}));
  const Tangents together(scene, all_ranks()), alone(scene);
  Iterative solver(together.model);
  const auto direct = make_direct_tangent_solver(alone.model, kChains, 1e-8);
  const DofVector x = together.solution(solver.chains);
  EXPECT_NE(solver.network->objection().find("unsymmetric"), std::string::npos) << solver.network->objection();
  EXPECT_LE(largest_difference(together, x, alone.solution(*direct)), kAgreement);
}

/// Nodes of a lattice in no order, displaced at random, and its links.
std::pair<std::vector<Vector3>, LinkEnds> shuffled_lattice(int size, double displaced) {
  std::mt19937 random(11);
  const std::vector<std::array<int, 3>> points = grid(size, size, size);
  std::vector<int> number(points.size());
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), random);
  std::uniform_real_distribution<double> motion(-displaced, displaced);
  std::vector<Vector3> places(points.size());
  LinkEnds ends;
  for (size_t p = 0; p < points.size(); ++p)
    for (int c = 0, stride = size * size; c < 3; ++c, stride /= size) {
      places[number[p]][c] = points[p][c] + motion(random);
      if (points[p][c] + 1 < size) ends.push_back({number[p], number[p + stride]});
    }
  return {places, ends};
}

/// Aggregates of eight nodes that are cubes, which have twelve links inside.
int cubes(const std::vector<Vector3>& places, const LinkEnds& ends) {
  const Nesting nesting = nest(places, ends);
  const std::vector<int>& first = nesting.first.front();
  std::vector<int> aggregate(places.size()), links(first.size(), 0);
  for (size_t a = 0; a + 1 < first.size(); ++a)
    for (int k = first[a]; k < first[a + 1]; ++k) aggregate[nesting.order[k]] = static_cast<int>(a);
  for (const auto& [a, b] : ends)
    if (aggregate[a] == aggregate[b]) ++links[aggregate[a]];
  int count = 0;
  for (size_t a = 0; a + 1 < first.size(); ++a) count += first[a + 1] - first[a] == 8 && links[a] == 12 ? 1 : 0;
  return count;
}

/// Share of cubes in a lattice whose nodes are displaced by a tenth of a strut: rows begin where places say so.
constexpr double kMostly = 0.85;

TEST(NetworkSolver, AggregatesOfLatticesAreCubes) {
  const auto [even, even_links] = shuffled_lattice(12, 0.0);
  EXPECT_EQ(cubes(even, even_links), 6 * 6 * 6);
  const auto [displaced, displaced_links] = shuffled_lattice(12, 0.1);
  EXPECT_GE(cubes(displaced, displaced_links), kMostly * 6 * 6 * 6);
  const auto [odd, odd_links] = shuffled_lattice(13, 0.0);
  EXPECT_EQ(cubes(odd, odd_links), 5 * 5 * 5) << "what is left over of rows lies beside the last cubes";
  const std::vector<Vector3> nowhere(even.size(), Vector3{});
  EXPECT_LT(cubes(nowhere, even_links), kMostly * 6 * 6 * 6) << "places matter";
}

/// Between an error in energy and the same error in length: motions that differ in stiffness have different shares.
constexpr double kOtherNorm = 100.0;

TEST(NetworkSolver, LeavesOfTheErrorWhatIsEnough) {
  const Tangents tangents(scene_of(cubic(10, 20.0)));
  Iterative solver(tangents.model);
  const DofVector exact = tangents.solution(solver.chains);
  const int all = solver.network->iterations();
  DofVector x(tangents.model.map());
  for (double enough : {1e-3, 1e-6}) {
    solver.chains.solve(*tangents.rows, x, enough);
    const double error = relative_difference(x, exact);
    EXPECT_LE(error, kOtherNorm * enough);
    EXPECT_GE(error, enough / kOtherNorm) << "it stops there";
  }
  EXPECT_LT(solver.network->iterations(), all);
}

/// Positions, as far as the tolerance of the residual tells them.
constexpr double kSamePlace = 1e-9;

/// Increments with errors that the next iteration removes cost none.
TEST(NetworkSolver, NewtonsMethodTakesAsManyIterationsAsWithFactors) {
  Scene scene = scene_of(cubic(6, 20.0));
  for (PointLoad& load : scene.point_loads) load.force = {0.3, 0.6, 0.15};
  std::vector<Simulation> runs;
  for (const char* method : {kChains, kIterative}) {
    SolverParameters parameters;
    parameters.linear.method = method;
    parameters.analysis.stability = false;
    runs.emplace_back(solved(scene, parameters));
  }
  EXPECT_EQ(runs[0].result().newton_iterations, runs[1].result().newton_iterations);
  EXPECT_GT(runs[0].result().newton_iterations, 2) << "it is far from linear";
  const std::string corner = scene.point_loads.back().point;
  EXPECT_TRUE(agrees(runs[1].position(corner), runs[0].position(corner), kSamePlace));
  EXPECT_FALSE(agrees(scene.points.back().position, runs[0].position(corner), 0.1)) << "it has moved";
}

/// Solutions by 1, 2 and 4 threads; `most_fallback_entries`: GMRES where that is zero and the tangent unsymmetric.
void expect_same_bits_for_any_number_of_threads(const Scene& scene, double most_fallback_entries) {
  const int before = number_of_threads();
  const Tangents tangents(scene);
  std::vector<DofVector> x;
  for (int threads : {1, 2, 4}) {
    set_number_of_threads(threads);
    if (void* blas = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) reinterpret_cast<void (*)(int)>(blas)(threads);
    Iterative solver(tangents.model, NetworkSolver::kReduction, most_fallback_entries);
    x.push_back(tangents.solution(solver.chains));
    EXPECT_TRUE(same_bits(MixedVector::view_of(x.front()), MixedVector::view_of(x.back()))) << threads;
  }
  set_number_of_threads(before);
}

/// Of the usual cap: struts a hundred times softer along their axes.
constexpr double kSofter = 1e-7;

TEST(NetworkSolver, SpacesServeUntilIterationsGrow) {
  const Tangents tangents(scene_of(cubic(11, 20.0)));
  Iterative solver(tangents.model, 1e-12);
  const DofVector fresh = tangents.solution(solver.chains);
  const DofVector kept = tangents.solution(solver.chains);
  EXPECT_EQ(solver.network->spaces_made(), 1);
  EXPECT_TRUE(same_bits(MixedVector::view_of(fresh), MixedVector::view_of(kept)));
  const Cap cap = cap_for(tangents.model, tangents.point->scales, kSofter);
  ASSERT_TRUE(cap.cuts_off);
  const Tangent softer(tangents.model, *tangents.point, cap, {true});
  const auto direct = make_direct_tangent_solver(tangents.model, kChains, 1e-8);
  DofVector x(tangents.model.map()), y(tangents.model.map());
  direct->factorize(softer);
  direct->solve(*tangents.rows, y);
  for (int again = 0; again < 2; ++again) {
    solver.chains.factorize(softer);
    EXPECT_LE(solver.chains.solve(*tangents.rows, x), 1e-8);
    EXPECT_LE(relative_difference(x, y), kAgreement);
  }
  EXPECT_EQ(solver.network->spaces_made(), 2);
  solver.chains.reset_factors();
  const DofVector later = tangents.solution(solver.chains);
  EXPECT_EQ(solver.network->spaces_made(), 3);
  EXPECT_TRUE(same_bits(MixedVector::view_of(fresh), MixedVector::view_of(later)));
}

/// A sheared block with a follower force and moment, or the same dead, at each point of the top.
Scene pushed_block(LoadFrame frame) {
  Scene scene = scene_of(cubic(10, 20.0));
  std::map<std::string, std::string> ends_at;
  for (const Member& member : scene.members) ends_at[member.end_point] = member.name;
  const std::vector<PointLoad> top = scene.point_loads;
  for (const PointLoad& load : top) {
    scene.point_loads.push_back(follower_load(load.point, ends_at.at(load.point), {0.3, 0.2, -1.0}, {0.0, 0.3, 0.2}));
    scene.point_loads.back().frame = frame;
  }
  return scene;
}

/// The block with its top on planes at an angle, and points on hinges with skew axes.
Scene block_on_planes() {
  Scene scene = scene_of(cubic(10, 20.0));
  for (size_t k = 0; k < scene.point_loads.size(); ++k) {
    const bool turns = k % 3 != 0;
    Support held = support(scene.point_loads[k].point, {true, false, false}, {!turns, !turns, false});
    const double a = std::sqrt(1.0 / 3.0), b = std::sqrt(1.0 / 2.0), c = std::sqrt(1.0 / 6.0);
    held.axes = {{{a, a, a}, {b, -b, 0.0}, {c, c, -2.0 * c}}};
    scene.supports.push_back(held);
  }
  return scene;
}

/// The block with some members on joints.
Scene jointed_block() {
  Scene scene = scene_of(cubic(10, 20.0));
  for (size_t m = scene.members.size() / 2; scene.joints.size() < 3; m += 7) {
    if (scene.members[m].end_point == scene.supports.front().point) continue;
    const JointKind kind = scene.joints.empty() ? JointKind::ball : JointKind::hinge;
    scene.joints.push_back(
        {"joint " + std::to_string(m), scene.members[m].end_point, {scene.members[m].name}, kind, {1.0, 0.3, 0.2}});
  }
  return scene;
}

/// Where no factors are allowed: GMRES. Each joint adds some iterations, loads and supports none.
TEST(MpiNetworkSolver, UnsymmetricTangentsWithoutFactors) {
  const std::pair<Scene, int> cases[] = {
      {pushed_block(LoadFrame::follower), 0}, {block_on_planes(), 0}, {jointed_block(), 3 * kVertexDofs}};
  for (const auto& [scene, more] : cases) {
    const Tangents tangents(scene, all_ranks()), alone(scene);
    Iterative solver(tangents.model, 1e-12, 0.0);
    const auto direct = make_direct_tangent_solver(alone.model, kChains, 1e-8);
    DofVector x = tangents.solution(solver.chains);
    const DofVector y = alone.solution(*direct);
    EXPECT_NE(solver.network->objection().find("unsymmetric"), std::string::npos) << solver.network->objection();
    EXPECT_EQ(solver.chains.negative_eigenvalues(), std::nullopt) << "its sign is not known";
    EXPECT_LE(largest_difference(tangents, x, y), kAgreement);
    // next to rounding iterations are many or few by chance
    Iterative usual(tangents.model, NetworkSolver::kReduction, 0.0);
    tangents.solution(usual.chains);
    EXPECT_GT(usual.network->iterations(), 3) << "it was iterated";
    EXPECT_LE(usual.network->iterations(), kMostIterations + more);
    x.scale(1.0 + 2.0 * kAgreement);
    EXPECT_GT(largest_difference(tangents, x, y), kAgreement) << "the comparison sees an error";
  }
  const Tangents follower(pushed_block(LoadFrame::follower)), dead(pushed_block(LoadFrame::dead));
  const auto direct = make_direct_tangent_solver(follower.model, kChains, 1e-8);
  const auto other = make_direct_tangent_solver(dead.model, kChains, 1e-8);
  EXPECT_GT(relative_difference(dead.solution(*other), follower.solution(*direct)), kAgreement)
      << "the unsymmetric part matters";
}

/// Factors that fit come first where they are small, and where GMRES does not converge.
TEST(NetworkSolver, GmresBeforeLargeFactors) {
  const Tangents tangents(pushed_block(LoadFrame::follower));
  const double entries = factor_entries(CondensedSystem(tangents.model));
  for (const double most : {5.0 * entries, 100.0 * entries}) {
    Iterative solver(tangents.model, NetworkSolver::kReduction, most);
    tangents.solution(solver.chains);
    EXPECT_EQ(solver.network->iterations() > 0, most < 10.0 * entries) << most / entries;
  }
  const Tangents jointed(jointed_block());
  Iterative beyond_reach(jointed.model, 1e-300, 5.0 * factor_entries(CondensedSystem(jointed.model)));
  const auto direct = make_direct_tangent_solver(jointed.model, kChains, 1e-8);
  EXPECT_LE(relative_difference(jointed.solution(beyond_reach.chains), jointed.solution(*direct)), kAgreement);
}

TEST(NetworkSolver, AStructureBeyondBucklingIsToldUnstable) {
  Scene scene = scene_of(cubic(4, 20.0));
  const Tangents at_rest(scene);
  // shortened by a fifth between floor and ceiling, four times what a strut bears
  MixedVector motion = at_rest.model.create_vector();
  const auto vertex = motion.vertex();
  const Mesh& mesh = at_rest.model.mesh();
  for (int v = 0; v < mesh.vertices(); ++v) vertex(vertex_row(v, 2)) = -0.2 * mesh.vertex_position[v][2];
  MixedVector residual = at_rest.model.create_vector();
  State state = at_rest.model.apply(at_rest.model.reference_state(), motion, 1.0);
  // the strains that belong to it
  for (int k = 0; k < 2; ++k) {
    const EvaluationPoint point = mixed_residual(at_rest.model, state, 1.0, residual);
    Tangent tangent(at_rest.model, point, cap_for(at_rest.model, point.scales), {true});
    MixedVector interior = at_rest.model.create_vector();
    tangent.recover(interior);
    state = at_rest.model.apply(state, interior, k == 0 ? 1.0 : 0.0);
  }
  const EvaluationPoint point = mixed_residual(at_rest.model, state, 1.0, residual);
  const Tangent tangent(at_rest.model, point, cap_for(at_rest.model, point.scales), {true});
  Iterative solver(at_rest.model);
  solver.chains.factorize(tangent);
  DofVector x(at_rest.model.map());
  EXPECT_LE(solver.chains.solve(*at_rest.rows, x), 1e-8) << "solved by factors";
  EXPECT_NE(solver.network->objection(), "");
}

/// A lattice compressed by equal loads at its top, by default a cubic one of slenderness 20, where nothing bends.
class Compressed {
 public:
  explicit Compressed(int size, const Communicator& ranks = this_rank()) : Compressed(cubic(size, 20.0), ranks) {}
  explicit Compressed(const Block& block, const Communicator& ranks = this_rank())
      : fixture_(scene_of(loaded(block)), ranks) {
    MixedVector residual = model().create_vector();
    answer_.emplace(residual.clone(false));
    const EvaluationPoint point = mixed_residual(model(), model().reference_state(), 1.0, residual);
    Linearization(fixture_.problem(), point, cap_for(model(), point.scales), {}).newton_increment(*answer_);
  }
  const Model& model() { return fixture_.problem().model; }
  /// Where each point of the top carries `load`, by the strains of a small load.
  Tangent tangent(double load) {
    MixedVector residual = model().create_vector();
    const State state = model().apply(model().reference_state(), *answer_, load);
    const EvaluationPoint point = mixed_residual(model(), state, load, residual);
    return Tangent(model(), point, cap_for(model(), point.scales), {true});
  }
  /// Forces and moments that are parallel to no mode.
  DofVector forces(const Tangent& tangent) {
    DofVector b(model().map());
    const KernelView<double*> rows = MixedVector::view_of(b);
    for (size_t i = 0; i < rows.extent(0); ++i) rows(i) = 1.0 + 0.5 * std::sin(1.0 + i);
    tangent.project_on_free_motions(rows);
    return b;
  }

 private:
  static Block loaded(Block block) {
    block.load = {0.0, 0.0, -1.0};
    return block;
  }
  StabilityFixture fixture_;
  std::optional<MixedVector> answer_;
};

/// What prestress may add to the iterations: a third.
constexpr double kMoreUnderLoad = 4.0 / 3.0;

/// Iterations of conjugate gradients where a lattice carries `load`.
int iterations_under(Compressed& lattice, double load) {
  const Tangent tangent = lattice.tangent(load);
  Iterative solver(lattice.model());
  DofVector x(lattice.model().map());
  solver.chains.factorize(tangent);
  solver.chains.solve(lattice.forces(tangent), x);
  EXPECT_EQ(solver.network->objection(), "") << load;
  return solver.network->iterations();
}

/// First load whose tangent has an eigenvalue below zero, by counts of the direct solver, from below.
double first_critical_load(Compressed& lattice) {
  const auto direct = make_direct_tangent_solver(lattice.model(), kChains, 1e-8);
  const auto is_stable = [&](double load) {
    const Tangent tangent = lattice.tangent(load);
    direct->factorize(tangent);
    return direct->negative_eigenvalues() == 0L;
  };
  double stable = 0.0, unstable = 0.1;
  while (is_stable(unstable)) stable = unstable, unstable *= 2.0;
  constexpr int kHalvings = 6;  // to one per cent
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (stable + unstable);
    (is_stable(middle) ? stable : unstable) = middle;
  }
  return stable;
}

TEST(NetworkSolver, PrestressAddsFewIterations) {
  const Block even = cubic(10, 20.0);
  Block displaced = even;
  displaced.displaced = 0.2;
  Block removed = displaced;
  removed.removed = 0.45;
  for (const Block& block : {even, body_centred(7, 20.0), displaced, removed}) {
    Compressed lattice(block);
    const double critical = first_critical_load(lattice);
    const int without = iterations_under(lattice, 0.0);
    for (const double share : {0.5, 0.9})
      EXPECT_LE(iterations_under(lattice, share * critical), kMoreUnderLoad * without) << share;
  }
}

/// Rounding, which the small eigenvalue amplifies 0.2 % off the critical load: 4.1e-11.
constexpr double kAgreementNearCritical = 1e-10;

/// Signs and solutions from iteration alone, no factors are allowed: beyond the critical load an error says why, and
/// the next stable tangent is solved again.
TEST(MpiNetworkSolver, BothSidesOfACriticalLoadWithoutFactors) {
  Compressed lattice(6, all_ranks());
  const auto direct = make_direct_tangent_solver(lattice.model(), kChains, 1e-8);
  Iterative solver(lattice.model(), 1e-12, 0.0);
  int unstable = 0;
  for (double load : {0.0, 2.5, 4.9, 4.94, 4.96, 5.0, 10.0, 50.0, 2.5}) {
    const Tangent tangent = lattice.tangent(load);
    const DofVector b = lattice.forces(tangent);
    DofVector x(lattice.model().map()), y(lattice.model().map());
    direct->factorize(tangent);
    direct->solve(b, y);
    const bool is_stable = direct->negative_eigenvalues() == 0L;
    try {
      solver.chains.factorize(tangent);
      EXPECT_LE(solver.chains.solve(b, x), 1e-8) << load;
      EXPECT_TRUE(is_stable) << load;
      EXPECT_LE(relative_difference(x, y), kAgreementNearCritical) << load;
      x.scale(1.0 + 2.0 * kAgreementNearCritical);
      EXPECT_GT(relative_difference(x, y), kAgreementNearCritical) << "the comparison sees an error";
    } catch (const LinearSolverError& error) {
      EXPECT_FALSE(is_stable) << load << ": " << error.what();
      EXPECT_NE(std::string(error.what()).find("too large for factors"), std::string::npos) << error.what();
      ++unstable;
    }
    EXPECT_EQ(solver.network->negative_eigenvalues(), std::optional<long>(is_stable ? 0 : 1)) << load;
    EXPECT_EQ(solver.network->objection().empty(), is_stable) << load;
  }
  EXPECT_EQ(unstable, 4) << "the critical load lies between";
}

TEST(NetworkSolver, SameBitsForAnyNumberOfThreads) {
  Block block = cubic(11, 20.0);
  block.displaced = 0.1;
  expect_same_bits_for_any_number_of_threads(scene_of(block), NetworkSolver::kMostFallbackEntries);
  expect_same_bits_for_any_number_of_threads(pushed_block(LoadFrame::follower), 0.0);
}

TEST(NetworkSolver, LargeNetworksAreKnownBySeparators) {
  const Tangents small(scene_of(cubic(5, 20.0)));
  EXPECT_LT(factor_entries(CondensedSystem(small.model)), kMostFactorEntries);
  EXPECT_FALSE(make_tangent_solver(small.model, kAutomatic, 1e-8)->iterates());
  EXPECT_TRUE(make_tangent_solver(small.model, kIterative, 1e-8)->iterates());
  const Tangents thin(scene_of(sheet(50, 20.0)));
  EXPECT_LT(factor_entries(CondensedSystem(thin.model)), kMostFactorEntries);
  EXPECT_FALSE(make_tangent_solver(thin.model, kAutomatic, 1e-8)->tries_iteration());
}

/// Paths of two and of five vertices, and a grid of 3 x 4 between them: its rows or diagonals separate it.
TEST(NetworkSolver, SeparatorsAreThoseOfTheLargestComponent) {
  SparseMatrix graph{{0}, {}, {}};
  const auto add_path = [&](int vertices) {
    const int first = static_cast<int>(graph.row_start.size()) - 1;
    for (int v = 0; v < vertices; ++v) {
      for (const int w : {v - 1, v, v + 1})
        if (w >= 0 && w < vertices) graph.column.push_back(first + w);
      graph.row_start.push_back(static_cast<int>(graph.column.size()));
    }
  };
  add_path(2);
  const double thin = factor_entries(graph.row_start, graph.column);
  const int first = 2;
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 12; ++j)
      if (std::abs(i / 3 - j / 3) + std::abs(i % 3 - j % 3) <= 1) graph.column.push_back(first + j);
    graph.row_start.push_back(static_cast<int>(graph.column.size()));
  }
  add_path(5);
  EXPECT_EQ(factor_entries(graph.row_start, graph.column), 9.0 * thin);  // entries grow with the square
}

TEST(MpiNetworkSolver, FactorsAreForecastOfAllRanks) {
  const Scene scene = scene_of(cubic(6, 20.0));
  const Tangents together(scene, all_ranks()), alone(scene);
  EXPECT_EQ(factor_entries(CondensedSystem(together.model)), factor_entries(CondensedSystem(alone.model)));
}

}  // namespace network_solver_test
}  // namespace mixbeam::test
