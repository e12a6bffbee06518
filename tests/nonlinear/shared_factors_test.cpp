// Factors of a network that several ranks make together, against those that one rank makes.
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/linear/network_factors.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/solve.hpp"

namespace mixbeam::test {
namespace shared_factors_test {

/// Rounding, 1e-16, times the condition of the lattices, below 1e5.
constexpr double kRanksAgree = 1e-11;
constexpr int kPoints = 6, kHeldRows = kVertexDofs * kPoints * kPoints;

/// A lattice without chains, so that every vertex remains, whatever the ranks; its tangent in a state that has moved.
class Network {
 public:
  Network(const Scene& scene, const Communicator& comm, double motion = 0.02)
      : model(scene, comm, {}),
        point(moved_by(motion)),
        tangent(model, point, cap_for(model, point.scales), {true}),
        system(model),
        factors(system.matrix(), model.times()),
        b(system.matrix()->getRowMap()),
        x(system.matrix()->getRowMap()) {
    gather();
    const auto rows = MixedVector::view_of(b);
    for (size_t i = 0; i < rows.extent(0); ++i) rows(i) = std::cos(2.0 + 1.7 * global(i));
  }

  void gather() { system.condense(tangent); }
  template <class Action>
  void for_each_entry(const Action& action) {
    const auto local = system.matrix()->getLocalMatrixHost();
    for (int i = 0; i < local.numRows(); ++i)
      for (size_t k = local.graph.row_map(i); k < local.graph.row_map(i + 1); ++k)
        action(global(i), global(local.graph.entries(k)), local.values(k));
  }
  /// Twists that soften every seventh vertex until its stiffness is negative.
  void soften() {
    for_each_entry([](int row, int column, double& value) {
      if (row == column && row / kVertexDofs % 7 == 3 && value != 1.0) value *= row % kVertexDofs == 4 ? -0.5 : 1.0;
    });
  }
  void solve() {
    factors.factorize();
    factors.solve(b, x);
  }
  /// Row of the same unknown in the matrix of one rank.
  int global(size_t local) const {
    return kVertexDofs * model.structure().local_vertex_to_global[local / kVertexDofs] +
           static_cast<int>(local % kVertexDofs);
  }

  const Model model;
  EvaluationPoint point;
  Tangent tangent;
  CondensedSystem system;
  NetworkFactors factors;
  DofVector b, x;

 private:
  EvaluationPoint moved_by(double size) const {
    MixedVector motion = model.create_vector(), residual = model.create_vector();
    const auto vertex = motion.vertex();
    for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) = size * std::sin(1.0 + 0.3 * global(i));
    return mixed_residual(model, model.apply(model.reference_state(), motion, 1.0), 0.5, residual);
  }
};

/// Largest difference between rows here and the same ones of `alone`, relative to the largest of those.
double difference(const Network& together, const Network& alone) {
  const auto a = MixedVector::view_of(together.x), e = MixedVector::view_of(alone.x);
  double most = 0.0;
  for (size_t i = 0; i < a.extent(0); ++i) most = std::max(most, std::abs(a(i) - e(together.global(i))));
  return maximum_over_ranks(*together.model.map()->getComm(), most) / alone.x.normInf();
}

/// Points of one side only: a sheet in a plane, bent out of it. Braces at its free corners leave no chain there either.
Scene sheet() {
  Scene scene = side_of_lattice(kPoints);
  const std::string last = std::to_string(kPoints - 1), inner = std::to_string(kPoints - 2);
  scene.members.push_back(line("left brace", "0,0," + last, "1,0," + inner, 1, 1));
  scene.members.push_back(line("right brace", last + ",0," + last, inner + ",0," + inner, 1, 1));
  return scene;
}
Scene under_followers() {
  Scene scene = lattice(kPoints);
  for (PointLoad& load : scene.point_loads) {
    load.frame = LoadFrame::follower;
    load.force = {0.3, 0.1, -0.2};
    for (const Member& member : scene.members)
      if (member.end_point == load.point) load.member = member.name;
  }
  return scene;
}

TEST(MpiSharedFactors, SolveAndCountAsOneRankDoes) {
  for (const Scene& scene : {lattice(kPoints), shuffled(lattice(kPoints)), sheet(), under_followers()})
    for (bool softened : {false, true}) {
      Network together(scene, all_ranks()), alone(scene, this_rank());
      for (Network* network : {&together, &alone}) {
        if (softened) network->soften();
        network->solve();
      }
      EXPECT_LE(difference(together, alone), kRanksAgree);
      EXPECT_EQ(together.factors.unknowns(), alone.factors.unknowns());
      EXPECT_EQ(together.factors.is_symmetric(), alone.factors.is_symmetric());
      const std::optional<long> negative = alone.factors.negative_eigenvalues();
      EXPECT_EQ(together.factors.negative_eigenvalues(), negative);
      EXPECT_EQ(negative.has_value(), alone.factors.is_symmetric());
      EXPECT_EQ(negative.value_or(softened ? 1 : 0) > 0, softened);
      // the twin: what differs by a little more than rounding
      alone.b.scale(1.0 + 10.0 * kRanksAgree);
      alone.solve();
      EXPECT_GT(difference(together, alone), kRanksAgree);
    }
}

/// An entry whose transpose another rank holds.
TEST(MpiSharedFactors, NoticeWhatIsUnsymmetricAcrossRanks) {
  Network network(lattice(kPoints), all_ranks());
  network.factors.factorize();
  EXPECT_TRUE(network.factors.is_symmetric());
  const VertexPartition& partition = network.model.structure().partition;
  int changed = all_ranks()->getRank();  // by rank 0 alone: another one might change the transpose
  network.for_each_entry([&](int row, int column, double& value) {
    if (partition.owns(column / kVertexDofs) || row < kHeldRows || value == 0.0 || changed > 0) return;
    value *= 1.001;
    ++changed;
  });
  network.factors.factorize();
  EXPECT_EQ(network.factors.is_symmetric(), all_ranks()->getSize() == 1);
}

/// Only the last rank sees what is wrong.
TEST(MpiSharedFactors, ErrorsReachEveryRank) {
  Network network(lattice(kPoints), all_ranks());
  const int last = static_cast<int>(network.system.matrix()->getGlobalNumRows()) - 1;
  network.solve();
  for (double wrong : {0.0, std::numeric_limits<double>::quiet_NaN()}) {
    network.for_each_entry([&](int row, int column, double& value) {
      if (row == last || column == last) value *= wrong;
    });
    EXPECT_THROW(network.factors.factorize(), LinearSolverError);
    network.gather();
    network.solve();
    EXPECT_LE(backward_error(*network.system.matrix(), network.x, network.b), kRanksAgree);
  }
}

/// Conjugate gradients with factors of an earlier matrix.
TEST(MpiSharedFactors, ServeTheNextMatrix) {
  constexpr int kWorthIterating = 15;  // points along an edge: a factorisation takes as long as 16 solves
  Network network(lattice(kWorthIterating), all_ranks(), 0.0);
  network.solve();
  const auto stiffness = network.tangent.elements().condensed_tangent;
  for (size_t e = 0; e < stiffness.extent(0); ++e)  // elements between ranks are those of both
    for (size_t k = 0; network.model.structure().local_element_to_mesh[e] % 7 == 0 && k < stiffness.extent(1); ++k)
      stiffness(e, k) *= 1.01;
  network.gather();
  network.solve();
  EXPECT_EQ(network.factors.factorizations(), 1);
  EXPECT_GT(network.factors.iterations(), 0);
  constexpr double kLeft = 1e-8;  // of the error, which is 1e-9 in energy
  EXPECT_LE(backward_error(*network.system.matrix(), network.x, network.b), kLeft);
  const std::optional<long> negative = network.factors.negative_eigenvalues();
  EXPECT_EQ(network.factors.factorizations(), 2);
  EXPECT_EQ(negative, 0);
}

}  // namespace shared_factors_test
}  // namespace mixbeam::test
