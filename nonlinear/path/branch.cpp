#include "nonlinear/path/branch.hpp"

#include "discretization/state/sampling.hpp"
#include "nonlinear/path/thresholds.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace mixbeam {

namespace {

/// Vertices with weights, whose sum is a displacement.
using VertexWeights = std::vector<std::pair<int, double>>;

/// Sums of the weighted displacements over the length of the structure: (component, mode).
std::array<std::vector<double>, 3> displacements(const Model& model, const VertexWeights& weights,
                                                 const std::vector<MixedVector>& modes) {
  const VertexPartition& partition = model.structure().partition;
  std::array<std::vector<double>, 3> sums;
  for (int c = 0; c < 3; ++c) {
    std::vector<double> mine(modes.size(), 0.0);
    for (size_t m = 0; m < modes.size(); ++m) {
      const KernelView<const double*> rows = modes[m].vertex();
      for (const auto& [vertex, weight] : weights)
        if (const int local = partition.place(vertex); local >= 0)
          mine[m] += weight * rows(static_cast<size_t>(kVertexDofs) * local + c);
    }
    sums[c].resize(modes.size());
    Teuchos::reduceAll(*model.map()->getComm(), Teuchos::REDUCE_SUM, static_cast<int>(modes.size()), mine.data(),
                       sums[c].data());
    for (double& sum : sums[c]) sum /= model.structure().length;
  }
  return sums;
}

/// Weights of the mean over elements first .. last - 1 of the mesh.
VertexWeights mean_of(const Mesh& mesh, int first, int last) {
  double length = 0.0;
  for (int e = first; e < last; ++e) length += mesh.element_length(mesh.elements[e]);
  VertexWeights weights;
  for (int e = first; e < last; ++e)
    for (int vertex : mesh.elements[e].vertex)
      weights.emplace_back(vertex, 0.5 * mesh.element_length(mesh.elements[e]) / length);
  return weights;
}

double norm(const std::vector<double>& v) {
  double sum = 0.0;
  for (double x : v) sum += x * x;
  return std::sqrt(sum);
}

/// First component that is nearly the largest; -1 if none moves.
int leading(const std::array<std::vector<double>, 3>& sums) {
  const double largest = std::max({norm(sums[0]), norm(sums[1]), norm(sums[2])});
  for (int c = 0; c < 3 && largest > path_limit.moves; ++c)
    if (norm(sums[c]) >= path_limit.nearly_largest * largest) return c;
  return -1;
}

/// Coefficients of the modes in the direction; empty: the rule finds none.
std::vector<double> shares_by_rule(const Model& model, const std::vector<MixedVector>& modes) {
  const auto whole = model.whole_mesh();
  const Mesh& mesh = *whole;
  const auto of_all = displacements(model, mean_of(mesh, 0, static_cast<int>(mesh.elements.size())), modes);
  if (leading(of_all) >= 0) return of_all[leading(of_all)];
  for (const MeshMember& member : mesh.members) {
    const int half = std::max(1, member.elements / 2);
    const auto sums = displacements(model, mean_of(mesh, member.first_element, member.first_element + half), modes);
    if (leading(sums) >= 0) return sums[leading(sums)];
  }
  return {};
}

}  // namespace

std::vector<MixedVector> orthonormal(const PathMeasure& measure, const std::vector<MixedVector>& space) {
  std::vector<MixedVector> result;
  for (const MixedVector& given : space) {
    MixedVector v = given.clone(true);
    for (const MixedVector& other : result) v.update(-measure.motion(v, other), other, 1.0);
    const double size = measure.motion(v);
    if (!(size > 0.0)) continue;
    v.scale(1.0 / size);
    result.push_back(std::move(v));
  }
  return result;
}

std::optional<MixedVector> branch_direction(const BeamProblem& problem, const AnalysisParameters& analysis,
                                            const PathMeasure& measure, const std::vector<MixedVector>& eigenspace) {
  const Model& model = problem.model;
  const std::vector<MixedVector> modes = orthonormal(measure, eigenspace);
  if (modes.empty()) return std::nullopt;
  std::vector<double> shares;
  if (analysis.branch_point) {
    const int vertex = vertex_of(model.mesh(), analysis.branch_point->point);
    shares = displacements(model, {{vertex, 1.0}}, modes)[analysis.branch_point->component];
    if (!(norm(shares) > path_limit.moves)) return std::nullopt;
  } else {
    shares = shares_by_rule(model, modes);
    if (shares.empty()) {
      shares.assign(modes.size(), 0.0);
      shares.front() = 1.0;
    }
  }
  MixedVector direction = model.create_vector();
  direction.fill(0.0);
  const double sign = analysis.branch == Branch::negative ? -1.0 : 1.0;
  for (size_t m = 0; m < modes.size(); ++m) direction.update(sign * shares[m] / norm(shares), modes[m], 1.0);
  return direction;
}

std::optional<BranchPoint> first_point_of_branch(const BeamProblem& problem, Corrector& corrector,
                                                 const PathMeasure& measure, const CriticalPoint& from,
                                                 const MixedVector& direction,
                                                 const std::function<bool(const Correction&)>& is_taken) {
  const LargestParts parts = largest_parts(*problem.model.map()->getComm(), direction.vertex());
  const double size = 1.0 / std::max(parts.moved / problem.model.structure().length, parts.turned);
  const PathDirection unit{direction.clone(true), 0.0};
  double amplitude = path_limit.branch_amplitude * size;
  for (int i = 0; i < path_limit.branch_attempts; ++i, amplitude *= 0.5) {
    const PathDirection guess = scaled(unit, amplitude);
    Correction found =
        corrector.on_row({from.state, from.load_factor, &guess.x}, measure.row(unit, from.load_factor, amplitude),
                         path_limit.most_iterations_onto_branch);
    if (is_taken(found) && measure.cosine(direction, found.moved) >= path_limit.same_direction)
      return BranchPoint{std::move(found), amplitude};
  }
  return std::nullopt;
}

}  // namespace mixbeam
