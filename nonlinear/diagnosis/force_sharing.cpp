#include "nonlinear/diagnosis/force_sharing.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/vertex_partition.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/newton/step.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace mixbeam {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Response to a strain, over that of the member's own (capped) stiffness alone, from which on it is a self-stress. If
/// equilibrium or bending determines the force, the response is smaller by the cap, usually 1e5.
constexpr double kSelfStress = 1e-2;

/// Largest EA, GA2, GA3 of a member's sections.
std::array<double, 3> stiffness_of(const Scene& scene, const Member& member) {
  std::array<double, 3> largest{};
  for (const Section& section : scene.sections) {
    if (section.name != member.section && section.name != member.end_section) continue;
    largest[0] = std::max(largest[0], section.axial_stiffness);
    for (int i = 0; i < 2; ++i) largest[i + 1] = std::max(largest[i + 1], section.shear_stiffness[i]);
  }
  return largest;
}

/// Pseudo-random number in [-1, 1], independent of the number of ranks.
double scattered(int element, int row) {
  std::uint64_t x = (static_cast<std::uint64_t>(element) << 8) + static_cast<std::uint64_t>(row);
  x += 0x9e3779b97f4a7c15ULL;  // splitmix64
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-52 - 1.0;
}

/// Whether equilibrium alone determines all forces: members, joints and supports form no loop (through the ground).
bool is_statically_determinate(const Scene& scene, const Mesh& mesh) {
  const std::vector<int> part = connected_parts(mesh);
  std::vector<unsigned char> is_held(1 + *std::max_element(part.begin(), part.end()), 0);
  if (mesh.elements.size() + mesh.joints.size() + is_held.size() > part.size()) return false;
  for (const Support& support : scene.supports)
    if (std::exchange(is_held[part[vertex_of(mesh, support.point)]], 1) == 1) return false;
  return true;
}

/// Visits every force of every element of this rank: element, row in it, index in interior vectors.
template <class Visit>
void for_each_force(const Structure& structure, const Visit& visit) {
  for_each_element(structure, [&](const ElementView& element) {
    const size_t first = element.block().increments_at()(element.index());
    for (int i = 0; i < element.layout().moment(0); ++i) visit(element, i, first + i);
  });
}

/// Rounding errors of strains, in the rows of N.
MixedVector rounding_errors(const Model& model, const ResidualScales& scales) {
  MixedVector rows = model.create_vector();
  rows.fill(0.0);
  const KernelView<double*> interior = rows.writable_interior(true);
  for_each_force(model.structure(), [&](const ElementView& element, int i, size_t index) {
    interior(index) = kEpsilon * scattered(element.mesh_element(), i) / scales.element_strain(element.length());
  });
  return rows;
}

double largest_of(const Model& model, double own) {
  double largest = own;
  Teuchos::reduceAll(*model.map()->getComm(), Teuchos::REDUCE_MAX, own, Teuchos::outArg(largest));
  return largest;
}

using Stiffnesses = std::vector<std::array<double, 3>>;  ///< (member of the scene)

/// Finds the least certain force among rigid components, or among the others. Collective.
std::optional<UncertainForce> least_certain(const Model& model, const Stiffnesses& stiffness, double force,
                                            const MixedVector& increment, const Cap& cap, bool rigid) {
  const KernelView<const double*> interior = increment.interior();
  double own_share = 0.0, own_element = -1.0;
  for_each_force(model.structure(), [&](const ElementView& element, int i, size_t index) {
    const int member = model.structure().member_of(model.mesh(), element.local());
    if (std::isinf(stiffness[member][i % 3]) != rigid) return;
    const double limit = cap.structure.sections(element.block().section(element.index())).force_stiffness_limit;
    const double share = std::abs(interior(index)) / (rigid ? kSelfStress * kEpsilon * limit : kUncertain * force);
    if (share > own_share) {
      own_share = share;
      own_element = element.mesh_element();
    }
  });
  const double share = largest_of(model, own_share);
  const int element = static_cast<int>(largest_of(model, own_share == share ? own_element : -1.0));
  if (!(share > 1.0)) return std::nullopt;
  const Mesh& mesh = model.mesh();
  return UncertainForce{model.scene().members[mesh.member_of_element(element)].name, mesh.index_of_element(element),
                        rigid, kUncertain * share};
}

std::optional<UncertainForce> find_uncertain_force(BeamProblem& problem, const State& state, double load_factor) {
  const Model& model = problem.model;
  const double force = scales_of(model, state, load_factor).force;
  Stiffnesses stiffness;
  double largest = 0.0;
  for (const Member& member : model.scene().members) {
    stiffness.push_back(stiffness_of(model.scene(), member));
    largest = std::max(largest, *std::max_element(stiffness.back().begin(), stiffness.back().end()));
  }
  if (!(force > 0.0 && largest * kEpsilon > kUncertain * force)) return std::nullopt;
  if (is_statically_determinate(model.scene(), *model.whole_mesh())) return std::nullopt;
  MixedVector increment = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, state, load_factor, increment);
  const Cap cap = cap_for(model, point.scales);
  Linearization linearization(problem, point, cap, {true, false});
  linearization.solve(rounding_errors(model, point.scales), increment);
  if (const auto rigid = least_certain(model, stiffness, force, increment, cap, true)) return rigid;
  if (cap.least_ratio > 0.0) remove_cap_compliance(linearization, cap.least_ratio, increment);
  return least_certain(model, stiffness, force, increment, cap, false);
}

}  // namespace

std::optional<UncertainForce> uncertain_force(BeamProblem& problem, const State& state, double load_factor) {
  try {
    return find_uncertain_force(problem, state, load_factor);
  } catch (const LinearSolverError&) {
    return std::nullopt;
  }
}

std::string text_of(const UncertainForce& force) {
  const std::string where = "member \"" + excerpt(force.member) + "\", element " + std::to_string(force.element) + ": ";
  if (force.rigid)
    return where +
           "the forces in rigid members are statically indeterminate here: one of many solutions is given (finite "
           "stiffnesses make them unique)";
  const std::string share = force.change < 1.0 ? rounded(100.0 * force.change, 1) + " % of the largest force"
                                               : "as much as the largest force";
  return where +
         "redundant members of this stiffness share forces by strains as small as their rounding errors, which may "
         "shift " +
         share + " (larger loads, or a stiffness closer to the bending of the others, determine them)";
}

}  // namespace mixbeam
