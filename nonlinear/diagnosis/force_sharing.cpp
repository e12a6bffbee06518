#include "nonlinear/diagnosis/force_sharing.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "nonlinear/newton/step.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

namespace mixbeam {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Of what a member would carry if nothing but its own (capped) stiffness answered the strain. Where equilibrium or
/// bending determines the force, the answer is smaller by the cap, 1e5 as a rule.
constexpr double kSelfStress = 1e-2;

/// EA, GA2, GA3: the largest of a member's sections.
std::array<double, 3> stiffness_of(const Scene& scene, const Member& member) {
  std::array<double, 3> largest{};
  for (const Section& section : scene.sections) {
    if (section.name != member.section && section.name != member.end_section) continue;
    largest[0] = std::max(largest[0], section.axial_stiffness);
    for (int i = 0; i < 2; ++i) largest[i + 1] = std::max(largest[i + 1], section.shear_stiffness[i]);
  }
  return largest;
}

/// In [-1, 1], without any pattern that a structure could have, the same on any number of ranks.
double scattered(int element, int row) {
  std::uint64_t x = (static_cast<std::uint64_t>(element) << 8) + static_cast<std::uint64_t>(row);
  x += 0x9e3779b97f4a7c15ULL;  // splitmix64
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-52 - 1.0;
}

/// Vertices that are known to be connected.
class ConnectedVertices {
 public:
  /// False where they hung together before.
  bool join(int a, int b) {
    const int first = representative(a), second = representative(b);
    if (first == second) return false;
    parent_[second] = first;
    return true;
  }

 private:
  int representative(int vertex) {
    const auto [entry, is_new] = parent_.emplace(vertex, vertex);
    if (entry->second != vertex) entry->second = representative(entry->second);
    return entry->second;
  }
  std::map<int, int> parent_;
};

/// Whether equilibrium alone determines all forces: members, joints and supports close no loop (through the ground).
bool is_statically_determinate(const Scene& scene, const Mesh& mesh) {
  constexpr int ground = -1;
  ConnectedVertices vertices;
  bool no_loop = true;
  for (size_t m = 0; m < mesh.members.size(); ++m) {
    const MeshMember& member = mesh.members[m];
    const int start = mesh.elements[member.first_element].vertex[0],
              end = mesh.elements[member.first_element + member.elements - 1].vertex[1];
    no_loop = vertices.join(start, end) && no_loop;
    for (const InnerPoint& inner : scene.members[m].inner_points)
      no_loop = vertices.join(start, mesh.vertex_of_point.at(inner.point)) && no_loop;
  }
  for (const MeshJoint& joint : mesh.joints) no_loop = vertices.join(joint.master, joint.slave) && no_loop;
  for (const Support& support : scene.supports)
    no_loop = vertices.join(vertex_of(mesh, support.point), ground) && no_loop;
  return no_loop;
}

/// Visits every force of every element of this rank: element, row in it, index in interior vectors.
template <class Visit>
void for_each_force(const Structure& structure, const Visit& visit) {
  for_each_element(structure, [&](const ElementView& element) {
    const size_t first = element.block().increments_at()(element.index());
    for (int i = 0; i < element.layout().moment(0); ++i) visit(element, i, first + i);
  });
}

class Perturbation {
 public:
  Perturbation(BeamProblem& problem, const State& state, double load_factor)
      : problem_(problem),
        model_(problem.model),
        state_(state),
        load_factor_(load_factor),
        scales_(scales_of(model_, state, load_factor)) {}

  std::optional<UncertainForce> most_uncertain() {
    const Scene& scene = model_.scene();
    for (const Member& member : scene.members) stiffness_.push_back(stiffness_of(scene, member));
    if (!is_worth_a_look()) return std::nullopt;
    MixedVector residual = model_.create_vector();
    const EvaluationPoint point = mixed_residual(model_, state_, load_factor_, residual);
    const Cap cap = cap_for(model_, point.scales);
    Linearization linearization(problem_, point, cap, {true, false});
    MixedVector increment = model_.create_vector();
    linearization.solve(rounding_errors(), increment);
    if (const auto rigid = largest(increment, cap, true)) return rigid;
    if (cap.least_ratio > 0.0) remove_cap_compliance(linearization, cap.least_ratio, increment);
    return largest(increment, cap, false);
  }

 private:
  bool is_rigid(int member, int component) const { return std::isinf(stiffness_[member][component]); }

  bool is_worth_a_look() const {
    if (is_statically_determinate(model_.scene(), *model_.whole_mesh())) return false;
    for (const std::array<double, 3>& stiffness : stiffness_)
      if (*std::max_element(stiffness.begin(), stiffness.end()) * kEpsilon > kUncertain * scales_.force)
        return scales_.force > 0.0;
    return false;
  }

  /// N rows: what rounding makes of strains.
  MixedVector rounding_errors() const {
    MixedVector rows = model_.create_vector();
    rows.fill(0.0);
    const KernelView<double*> interior = rows.writable_interior(true);
    const Structure& structure = model_.structure();
    for_each_force(structure, [&](const ElementView& element, int i, size_t index) {
      interior(index) = kEpsilon * scattered(element.mesh_element(), i) / scales_.element_strain(element.length());
    });
    return rows;
  }

  /// Among components that are rigid, or among the others.
  std::optional<UncertainForce> largest(const MixedVector& increment, const Cap& cap, bool rigid) const {
    const Structure& structure = model_.structure();
    const KernelView<const double*> interior = increment.interior();
    std::array<double, 3> best{0.0, -1.0, 0.0};  // share, mesh element, change
    for_each_force(structure, [&](const ElementView& element, int i, size_t index) {
      const int member = structure.member_of(model_.mesh(), element.local());
      if (is_rigid(member, i % 3) != rigid) return;
      const double change = std::abs(interior(index)),
                   limit = cap.structure.sections(element.block().section(element.index())).force_stiffness_limit;
      const double share = rigid ? change / (kSelfStress * kEpsilon * limit) : change / (kUncertain * scales_.force);
      if (share > best[0]) best = {share, static_cast<double>(element.mesh_element()), change / scales_.force};
    });
    const Teuchos::Comm<int>& comm = *model_.map()->getComm();
    std::vector<double> all(3 * static_cast<size_t>(comm.getSize()));
    Teuchos::gatherAll(comm, 3, best.data(), static_cast<int>(all.size()), all.data());
    for (size_t r = 0; r < all.size(); r += 3)
      if (all[r] > best[0] || (all[r] == best[0] && all[r + 1] > best[1])) best = {all[r], all[r + 1], all[r + 2]};
    if (!(best[0] > 1.0)) return std::nullopt;
    const Mesh& mesh = model_.mesh();
    const int element = static_cast<int>(best[1]);
    return UncertainForce{model_.scene().members[mesh.member_of_element(element)].name, mesh.index_of_element(element),
                          rigid, best[2]};
  }

  BeamProblem& problem_;
  const Model& model_;
  const State& state_;
  double load_factor_;
  ResidualScales scales_;
  std::vector<std::array<double, 3>> stiffness_;  ///< (member of the scene)
};

}  // namespace

std::optional<UncertainForce> uncertain_force(BeamProblem& problem, const State& state, double load_factor) {
  try {
    return Perturbation(problem, state, load_factor).most_uncertain();
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
