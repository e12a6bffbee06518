#include "nonlinear/run/needs.hpp"

#include "discretization/linear_system/chain_structure.hpp"
#include "discretization/mesh/row_lists.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/scene/what_acts.hpp"
#include "discretization/state/sampling.hpp"
#include "kernels/chains/level.hpp"
#include "kernels/vibration/vibration.hpp"
#include "nonlinear/multilevel/network_solver.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

// Numbers that do not follow from the layouts are rounded from peaks of RSS over that of an empty run
// (apps/docs/large_scale.md).

/// States and vectors alive at the peak of a load step: the groups of NOX and LOCA, their copies, our own.
constexpr double kCopiesAlive = 6.0;
/// Per element: mesh, adjacency, rows of vertices and numbering of chains; per member: names, curve, fields. [byte]
constexpr double kBytesOfElement = 350.0, kBytesOfMember = 1800.0;
/// Share of these and of the factors that each of several ranks holds.
constexpr double kShareEverywhere = 0.33;
/// Share of a run's own memory that it still holds while its error is estimated on a richer mesh.
constexpr double kShareDuringEstimate = 0.5;
/// Networks: entries of factors, with the fronts of MUMPS; entries of the matrix, with its copies and gathering; with
/// iteration entries of the matrix, levels of each junction, and the coarsest level. [byte]
constexpr double kBytesOfFactorEntry = 16.0, kBytesOfMatrixEntry = 60.0, kBytesOfIteratedEntry = 14.0,
                 kBytesOfIteratedJunction = 5000.0, kBytesOfCoarsestLevel = 1.5e8;
/// Nested dissection of V junctions with a separator of s: blocks of 6 x 6 over V log2 V, besides factor_entries() of
/// s; operations over entries^(3/2) of the latter; passes over a factor during factorisation.
constexpr double kBlocksOfSheets = 1.0, kOperationsOfSeparators = 0.1, kPassesOfFactor = 15.0;
/// Operations per junction for coarse spaces and conjugate gradients in a Newton iteration without factors.
constexpr double kOperationsOfIteratedJunction = 5e6;

/// Bytes of a sample in MemberSamples, and in the file in a step and once; of a member and a step in the file. [byte]
constexpr double kSampleBytes = 212.0, kFileBytesOfSample = 296.0, kFileBytesOfPlace = 40.0, kFileBytesOfMember = 250.0,
                 kFileBytesOfStep = 12000.0, kStressBytes = 4.0 * sizeof(double);

/// Vectors of momenta per mode in a search: those of its space, and the modes; factor on their numbers if velocities
/// cause forces; bytes of a mode in the file at a sample.
constexpr double kVectorsOfMode = 3.5, kVectorsWithVelocities = 11.0, kFileBytesOfMode = 3.0 * sizeof(double);

/// Kind of an element: orders, and whether its section is coupled or varies along the member.
struct Kind {
  int order = 1, force_points = 1;
  bool general = false, rotating = false;

  InteriorLayout interior() const { return {order, force_points}; }
  /// Numbers of its tangent, and of the data that recover its interior.
  double tangent() const {
    if (rotating) return kFullTangent + vibrating();
    if (general) return kFullTangent + kResponseColumns * interior().increments();
    return kSymmetricTangent + ResponseLayout{order}.size();
  }
  /// Numbers of a VibratingBlock and its rows.
  double vibrating() const {
    const VibrationLayout layout{order, force_points};
    const double motions = layout.motions(), inside = layout.interior(), stresses = layout.stresses();
    return kMassNumbers * (order + 1.0) + (stresses + layout.velocities() + motions) * motions +
           3.0 * (general ? stresses * stresses : stresses) + (inside + 12.0) * inside + interior().increments();
  }
  /// Numbers during a search for `modes` modes; `complex`: factor on the vectors kept; `followed`: vectors kept from
  /// one state to the next.
  double searched(int modes, double complex, int followed) const {
    const double momenta = VibrationLayout{order, force_points}.velocities();
    return vibrating() + kFullTangent + vertex_factor_size(kSpatialDofs) +
           momenta * (complex * kVectorsOfMode * modes + followed);
  }
  /// Bytes of it and its end vertex while a path is followed, without samples. Planar scenes take a quarter less.
  double bytes() const {
    const double state = 7 + 4 + interior().unknowns(), vector = 6 + interior().increments();
    const double reference = ReferenceLayout{order, force_points}.size(),
                 section = general ? GeneralSectionLayout{order, force_points}.size() : 0;
    return kBytesOfElement + sizeof(double) * (kCopiesAlive * (state + vector) + reference + section + tangent() +
                                               (rotating ? vertex_factor_size : free_factor_size)(kSpatialDofs));
  }
  /// Bytes of the elements that replace it in the error estimate: one of higher order, or two.
  double estimate_bytes() const {
    if (order == kMaximumOrder) return 2.0 * bytes();
    return Kind{order + 1, force_points + (force_points > order ? 2 : 1), general, rotating}.bytes();
  }
};

long long elements_of(const Member& member) {
  return std::max<long long>(member.elements, static_cast<long long>(member.inner_points.size()) + 1);
}

int least_steps(const Scene& scene, const SolverParameters& parameters) {
  const LoadPathParameters& path = parameters.load_path;
  if (parameters.analysis.control) return 2;
  const double of_stage = path.method == LoadPathMethod::fixed ? path.steps : std::ceil(1.0 / path.maximum_step);
  return 1 + static_cast<int>(std::min(1e9, of_stage * scene.stages));
}

/// Graph of points and joined ends, with each member as one link; the remaining system of chains over junctions,
/// supports and loaded points, and its factor.
struct Junctions {
  long long vertices = 0;  ///< points and joined ends
  double count = 0.0, unknowns = 0.0;
  double matrix = 0.0;      ///< numbers in the matrix, both triangles
  double separators = 0.0;  ///< factor_entries()

  explicit Junctions(const Scene& scene) {
    const Mesh mesh = mesh_of_points(scene);
    vertices = mesh.vertices();
    std::vector<unsigned char> kept(static_cast<std::size_t>(vertices), 0);  // not inside a chain
    std::vector<int> free(kept.size(), kSpatialDofs);                        // unknowns that no support prescribes
    std::vector<std::array<int, 2>> links, pairs;
    for (const MeshElement& element : mesh.elements) links.push_back({element.vertex[0], element.vertex[1]});
    for (const MeshJoint& joint : mesh.joints) {
      pairs.push_back({joint.master, joint.slave});
      kept[joint.master] = kept[joint.slave] = 1;
    }
    for (const PointLoad& load : scene.point_loads) kept[vertex_of(mesh, load.point)] = 1;
    for (const Support& support : scene.supports) {
      const int held = vertex_of(mesh, support.point);
      kept[held] = 1;
      for (int i = 0; i < 3; ++i) free[held] -= support.displacement_fixed[i] + support.rotation_fixed[i];
    }
    const ChainStructure chains(links, kept);
    for (const RemainingLink& link : chains.remaining()) pairs.push_back(link.vertex);
    count_pairs(free, std::move(pairs));
  }
  /// Entries of the factor, at most those of a full matrix.
  double entries() const {
    const double sheets = kBlocksOfSheets * kSpatialDofs * kSpatialDofs * count * std::log2(std::max(count, 1.0));
    return std::min(0.5 * unknowns * (unknowns + 1.0), separators + sheets);
  }

 private:
  void count_pairs(const std::vector<int>& free, std::vector<std::array<int, 2>> pairs) {
    std::vector<int> number(free.size(), -1);
    for (std::array<int, 2>& pair : pairs)
      for (int& end : pair) {
        if (number[end] < 0) {
          number[end] = static_cast<int>(count++);
          unknowns += free[end];
        }
        end = number[end];
      }
    const Graph<int> graph = joined_links<int>(static_cast<int>(count), [&pairs](const auto& add) {
      for (const auto& [a, b] : pairs) {
        add(a, {b, 1});
        add(b, {a, 1});
      }
    });
    matrix = kSpatialDofs * kSpatialDofs * (count + static_cast<double>(graph.neighbour.size()));
    separators = factor_entries(graph.start, graph.neighbour);
  }
};

bool iterates_with(const Junctions& junctions, const std::string& method) {
  return method == kIterative || (method == kAutomatic && junctions.separators > kMostFactorEntries);
}

}  // namespace

double bytes_of(const Scene& scene) {
  constexpr double kAllocations = 1.5;  // blocks of the heap, long names
  double numbers = 0.0;
  for (const Member& member : scene.members) numbers += static_cast<double>(member.stations.size());
  const auto bytes = [](const auto& list) { return static_cast<double>(list.size() * sizeof(list[0])); };
  double acting = 0.0;
  for_each_kind([&](auto kind) { acting += bytes(scene.*kind.list); });
  return sizeof(double) * numbers + kAllocations * (sizeof scene + bytes(scene.sections) + bytes(scene.points) +
                                                    bytes(scene.members) + bytes(scene.joints) + acting);
}

Scene coarse_scene(const Scene& scene, long long most) {
  long long elements = 0;
  for (const Member& member : scene.members) elements += elements_of(member);
  if (elements <= most) return scene;
  constexpr long long kLeastElements = 4;  // of a member
  const long long each = std::max(kLeastElements, most / static_cast<long long>(scene.members.size()));
  Scene coarse = scene;
  for (Member& member : coarse.members) {
    if (member.elements <= each) continue;
    member.elements = static_cast<int>(each);
    member.stations.clear();
  }
  return coarse;
}

Needs needs_of(const Scene& scene, const SolverParameters& parameters) {
  const Junctions junctions(scene);
  Needs needs;
  needs.members = static_cast<long long>(scene.members.size());
  needs.vertices = junctions.vertices;
  double run = 0.0, estimate = 0.0, samples = 0.0, state = 0.0, search = 0.0;
  const ModesParameters& modes = parameters.analysis.modes;
  const bool follows = modes.every_step || !modes.load_factors.empty();
  const bool are_complex = !scene.rotating_frames.empty() ||
                           std::any_of(scene.sections.begin(), scene.sections.end(), [](const Section& section) {
                             return section.mass_damping > 0.0 || section.stiffness_damping > 0.0;
                           });
  for (const Member& member : scene.members) {
    const Kind kind = {member.order, force_point_count(member.order, member.force_integration),
                       has_general_section(scene, member), !scene.rotating_frames.empty()};
    const long long elements = elements_of(member);
    const double n = static_cast<double>(elements);
    needs.elements += elements;
    needs.vertices += elements - 1 - static_cast<long long>(member.inner_points.size());
    needs.interior += elements * kind.interior().increments();
    run += n * kind.bytes();
    estimate += n * kind.estimate_bytes();
    if (modes.number > 0)
      search += n * sizeof(double) *
                kind.searched(modes.number, are_complex ? kVectorsWithVelocities : 1.0,
                              (follows ? 2 * modes.number : 0) * (are_complex ? 2 : 1));
    samples += n * recorded_points(kind.order, elements);
    state += n * (4 + kind.interior().unknowns());
  }
  const bool iterates = iterates_with(junctions, parameters.linear.method);
  const double vertices = static_cast<double>(needs.vertices), elements = static_cast<double>(needs.elements),
               members = static_cast<double>(needs.members), entries = iterates ? 0.0 : junctions.entries();
  if (samples > kMostSmoothSamples) samples = 2.0 * elements;
  const double of_stresses = parameters.analysis.stresses == StressesOf::every_step ? kStressBytes : 0.0;
  needs.memory = run + (kSampleBytes + of_stresses) * samples;
  if (estimates_error(parameters.analysis, static_cast<size_t>(needs.elements)))
    needs.memory = std::max(needs.memory, kShareDuringEstimate * run + estimate);
  if (modes.number > 0)
    needs.memory = std::max(needs.memory, kShareDuringEstimate * run + kSampleBytes * samples + search);
  needs.memory += kBytesOfMember * members +
                  (iterates ? kBytesOfIteratedEntry : kBytesOfMatrixEntry) * junctions.matrix +
                  kBytesOfFactorEntry * entries;
  if (iterates) needs.memory += kBytesOfIteratedJunction * junctions.count + kBytesOfCoarsestLevel;
  needs.everywhere =
      kShareEverywhere * (kBytesOfElement * elements + kBytesOfMember * members + kBytesOfFactorEntry * entries);
  needs.factors = sizeof(double) * (free_factor_size(kSpatialDofs) * elements + entries);
  needs.file = kFileBytesOfPlace * samples + kFileBytesOfMember * members;
  needs.file_per_step = (kFileBytesOfSample + of_stresses + kFileBytesOfMode * modes.number) * samples +
                        sizeof(double) * (7 * vertices + state) + kFileBytesOfStep;
  needs.steps = least_steps(scene, parameters);
  needs.network_operations = iterates
                                 ? kOperationsOfIteratedJunction * junctions.count
                                 : kOperationsOfSeparators * std::pow(std::min(entries, junctions.separators), 1.5);
  needs.network_bytes = kPassesOfFactor * kBytesOfFactorEntry * entries;
  return needs;
}

}  // namespace mixbeam
