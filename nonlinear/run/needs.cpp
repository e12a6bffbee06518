#include "nonlinear/run/needs.hpp"

#include "discretization/assembly/model.hpp"
#include "discretization/scene/joined_ends.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/text/errors.hpp"
#include "kernels/chains/level.hpp"
#include "kernels/loops/planar_block.hpp"
#include "nonlinear/accuracy/error_estimate.hpp"
#include "nonlinear/multilevel/network_solver.hpp"
#include "nonlinear/run/junction_factor.hpp"

#include <Teuchos_DefaultSerialComm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

namespace mixbeam {

namespace {

// The peak of RSS over that of an empty run was measured for chains of 5e4 to 2e5 elements (apps/docs/large_scale.md);
// what the layouts do not tell follows from that.

/// States and vectors that are alive at the peak of a load step: the groups of NOX and LOCA, their copies, our own.
constexpr double kCopiesAlive = 10.5;
/// Mesh, adjacency, rows of vertices and numbering of chains. [byte per element]
constexpr double kPlainBytes = 340.0;
/// The same where no factors are made and idle ones are given back, from heaps of cubes of 30 and 40 junctions a side.
constexpr double kCopiesIterated = 3.8;
/// Its names and numbers, curve, fields of samples and their places in a file. [byte per member]
constexpr double kBytesOfMember = 1750.0;
/// What of that every rank holds: the scene once more while the error is estimated; of each element its estimated
/// error; and the share of factors by which ranks together need more. From a sheet of 224 and a cube of 20 junctions a
/// side and a chain of 2e5 elements on one, two and four ranks.
constexpr double kBytesOfMemberEverywhere = 600.0, kBytesOfElementEverywhere = 90.0, kFactorsEverywhere = 0.35;
/// Numbers of each element beside its tangent and response while stability is looked at.
constexpr double kStabilityNumbers = 127.0;
/// Share of a run's own memory that it still holds while its error is estimated on a richer mesh.
constexpr double kShareDuringEstimate = 0.5;

/// Factors of networks, with the fronts from which MUMPS makes them; matrix, its copies and what gathers it. [byte]
constexpr double kBytesOfFactorEntry = 16.0, kBytesOfMatrixEntry = 60.0;
/// Where it is iterated with: the matrix, and of each junction its rows of all levels; the coarsest level is as large
/// in every network. [byte]
constexpr double kBytesOfIteratedEntry = 14.0, kBytesOfIteratedJunction = 4100.0, kBytesOfCoarsestLevel = 1.5e8;
/// A factorisation by MUMPS with OpenBLAS, from cubes of 10, 15 and 20 junctions a side (27 ms, 0.22 s, 1.4 s) and
/// sheets of 60 and 100 (54 ms, 0.3 s): of each multiplication, and of each number of the factor. [s]
constexpr double kSecondsOfOperation = 5e-11, kSecondsOfFactorEntry = 2.4e-8;
/// Of an iteration where there are no factors, coarse spaces and conjugate gradients, for each
/// junction: 1.2e-4, 1.0e-4, 1.4e-4 and 1.3e-4 in cubes of 20, 30, 40 and 70 junctions a side, slenderness 20. [s]
constexpr double kSecondsOfIteratedJunction = 1.2e-4;
/// Slender struts leave more soft modes, on every level: at slenderness 100 cubes of 20, 40 and 70 junctions a side
/// take 1.5, 3.1 and 4.0 times as long (one thread, processor time), at 300 the first one 1.8 times. From 8,000
/// junctions on:
constexpr double kSlender = 40.0, kTimesSlender = 1.6, kJunctionsOfThat = 8000.0, kGrowthOfSlender = 0.27;

/// What MemberSamples hold of a sample, what a step of the file does, and what its members do. [byte]
constexpr double kSampleBytes = 212.0, kFileBytesOfSample = 296.0, kFileBytesOfPlace = 40.0;
/// Stresses of a sample, in memory and in a step of the file. [byte]
constexpr double kStressBytes = 4.0 * sizeof(double);
/// HDF5's own. [byte]
constexpr double kFileBytesOfMember = 250.0, kFileBytesOfStep = 12000.0;

/// Seconds of an iteration for an element of order k: first + k * second, from the table of performance.md.
constexpr double kSpatialSeconds[2] = {0.7e-6, 1.0e-6}, kPlanarSeconds[2] = {0.25e-6, 0.22e-6};

/// Elements of one kind.
struct Kind {
  int order = 1, force_points = 1;
  bool general = false;  ///< section: coupled, or varying along the member
  long long elements = 0;

  InteriorLayout interior() const { return {order, force_points}; }
};

long long elements_of(const Member& member) {
  return std::max<long long>(member.elements, static_cast<long long>(member.inner_points.size()) + 1);
}

/// Names of sections that couple forces and moments.
std::set<std::string> coupled_sections(const Scene& scene) {
  std::set<std::string> names;
  for (const Section& section : scene.sections)
    if (section.matrix) names.insert(section.name);
  return names;
}

Kind kind_of(const Member& member, bool general) {
  return {member.order, force_point_count(member.order, member.force_integration), general, elements_of(member)};
}

/// Numbers of the undeformed element.
double reference_numbers(const Kind& kind, bool planar) {
  const double common = ReferenceLayout{kind.order, kind.force_points}.size();
  if (planar) return common + planar_constants_size(kind.order);
  return kind.general ? common + GeneralSectionLayout{kind.order, kind.force_points}.size() : common;
}

/// Numbers of its tangent, and of what recovers its interior.
double tangent_numbers(const Kind& kind, bool planar) {
  if (planar) return planar_response_size(kind.order) + kPlanarTangent;
  if (kind.general) return kFullTangent + kResponseColumns * kind.interior().increments();
  return kSymmetricTangent + ResponseLayout{kind.order, kind.force_points}.size();
}

/// Numbers of the factors of the chains, nearly all of whose vertices are eliminated.
double chain_factor(bool planar) { return vertex_factor_size(planar ? kPlanarDofs : kSpatialDofs); }

/// Bytes of an element with the vertex behind it while a path is followed, without samples.
double run_bytes(const Kind& kind, bool planar, double copies) {
  const double state = 7 + 4 + kind.interior().unknowns(), vector = 6 + kind.interior().increments();
  const double constant = reference_numbers(kind, planar) + tangent_numbers(kind, planar) + chain_factor(planar);
  return kPlainBytes + sizeof(double) * (copies * (state + vector) + constant);
}

double stability_bytes(const Kind& kind) { return sizeof(double) * (tangent_numbers(kind, false) + kStabilityNumbers); }

/// Of the elements that the error estimate puts in place of one: of one order more, or two.
double estimate_bytes(const Kind& kind, bool planar, double copies) {
  if (kind.order == kMaximumOrder) return 2.0 * run_bytes(kind, planar, copies);
  const int more = kind.force_points > kind.order ? 2 : 1;
  return run_bytes({kind.order + 1, kind.force_points + more, kind.general, kind.elements}, planar, copies);
}

/// Points that members, loads and supports name, and ends that joints give a vertex of their own.
long long points_in_use(const Scene& scene) {
  std::set<std::string> points;
  for (const Member& member : scene.members) {
    points.insert(member.start_point);
    points.insert(member.end_point);
    for (const InnerPoint& inner : member.inner_points) points.insert(inner.point);
  }
  long long count = static_cast<long long>(points.size());
  for (const auto& [point, ends] : joined_ends(scene))
    for (const JoinedEnd& end : ends) count += end.shares ? 0 : 1;
  return count;
}

/// Elements in which the plane of a scene is looked for.
constexpr long long kElementsForPlane = 2000;
/// A scene of more members counts as one in space: to look would take seconds.
constexpr std::size_t kMostMembersForPlane = 1000;

/// The plane does not depend on order and elements. Where the coarse mesh bends too much nothing is known, and space
/// takes more.
bool is_planar(const Scene& scene, const SolverParameters& parameters) {
  if (!parameters.planar || !scene.distributed_loads.empty() || !scene.eigenstrains.empty() ||
      scene.members.size() > kMostMembersForPlane)
    return false;
  Scene coarse = coarse_scene(scene, kElementsForPlane);
  for (Member& member : coarse.members) member.order = 1;
  try {
    return Model(coarse, Teuchos::rcp(new Teuchos::SerialComm<int>()), {}).plane().has_value();
  } catch (const InputError&) {
    return false;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

int least_steps(const Scene& scene, const SolverParameters& parameters) {
  const LoadPathParameters& path = parameters.load_path;
  if (parameters.analysis.control) return 2;
  const double of_stage = path.method == LoadPathMethod::fixed ? path.steps : std::ceil(1.0 / path.maximum_step);
  return 1 + static_cast<int>(std::min(1e9, of_stage * scene.stages));
}

/// Whether most members are longer than kSlender times the radius of gyration of their section.
bool is_slender(const Scene& scene) {
  std::unordered_map<std::string, const Vector3*> place;
  for (const Point& point : scene.points) place[point.name] = &point.position;
  std::unordered_map<std::string, double> radius;
  for (const Section& section : scene.sections)
    radius[section.name] =
        std::sqrt(std::min(section.bending_stiffness[0], section.bending_stiffness[1]) / section.axial_stiffness);
  std::size_t slender = 0;
  for (const Member& member : scene.members) {
    const Vector3 &a = *place.at(member.start_point), &b = *place.at(member.end_point);
    const double length = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    if (length > kSlender * radius.at(member.section)) ++slender;
  }
  return 2 * slender > scene.members.size();
}

double seconds_iterated(double junctions, bool slender) {
  const double more = slender ? kTimesSlender * std::pow(junctions / kJunctionsOfThat, kGrowthOfSlender) : 1.0;
  return junctions * kSecondsOfIteratedJunction * std::max(more, 1.0);
}

/// See junction_factor().
double most_factor_entries(const std::string& method) {
  if (method == kIterative) return 0.0;
  return method == kAutomatic ? kMostFactorEntries : std::numeric_limits<double>::infinity();
}

/// Sums over all members.
struct Sums {
  double samples = 0.0, state = 0.0;  ///< of the file; numbers of a state
  double run = 0.0, stability = 0.0, estimate = 0.0, seconds = 0.0;

  void add(const Kind& kind, bool planar, int points, double copies) {
    const double n = static_cast<double>(kind.elements);
    samples += n * points;
    state += n * (4 + kind.interior().unknowns());
    run += n * run_bytes(kind, planar, copies);
    stability += n * stability_bytes(kind);
    estimate += n * estimate_bytes(kind, planar, copies);
    const double* of_kind = planar ? kPlanarSeconds : kSpatialSeconds;
    seconds += n * (of_kind[0] + kind.order * of_kind[1]);
  }
};

}  // namespace

double bytes_of(const Scene& scene) {
  constexpr double kAllocations = 1.5;  // blocks of the heap, long names
  double numbers = 0.0;
  for (const Member& member : scene.members) numbers += static_cast<double>(member.stations.size());
  const auto bytes = [](const auto& list) { return static_cast<double>(list.size() * sizeof(list[0])); };
  return sizeof(double) * numbers +
         kAllocations * (sizeof scene + bytes(scene.sections) + bytes(scene.points) + bytes(scene.members) +
                         bytes(scene.supports) + bytes(scene.point_loads) + bytes(scene.distributed_loads) +
                         bytes(scene.joints) + bytes(scene.eigenstrains));
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
  Needs needs;
  needs.members = static_cast<long long>(scene.members.size());
  needs.planar = is_planar(scene, parameters);
  needs.vertices = points_in_use(scene);
  const std::set<std::string> coupled = coupled_sections(scene);
  std::vector<Kind> kinds;
  double smooth_samples = 0.0;
  for (const Member& member : scene.members) {
    const bool varies = !member.end_section.empty() || !member.taper.empty();
    kinds.push_back(kind_of(member, varies || coupled.count(member.section) > 0));
    const Kind& kind = kinds.back();
    needs.elements += kind.elements;
    needs.vertices += kind.elements - 1 - static_cast<long long>(member.inner_points.size());
    needs.interior += kind.elements * kind.interior().increments();
    smooth_samples += static_cast<double>(kind.elements) * smooth_points(kind.order);
  }
  const JunctionFactor junctions = junction_factor(scene, most_factor_entries(parameters.linear.method));
  const bool iterates = junctions.is_larger;
  Sums sums;
  for (const Kind& kind : kinds)
    sums.add(kind, needs.planar, smooth_samples <= kMostSmoothSamples ? smooth_points(kind.order) : 2,
             iterates ? kCopiesIterated : kCopiesAlive);
  const double vertices = static_cast<double>(needs.vertices), elements = static_cast<double>(needs.elements),
               members = static_cast<double>(needs.members);
  // critical points are looked for in smaller structures even where the stability of steps is not asked for
  const bool counts =
      !iterates && (needs.vertices <= kVerticesForStability || parameters.analysis.stability.value_or(false));
  const double of_stresses = parameters.analysis.stresses == StressesOf::every_step ? kStressBytes : 0.0;
  const double samples = (kSampleBytes + of_stresses) * sums.samples, stability = counts ? sums.stability : 0.0;
  // each of two meshes has its own
  const double of_mesh =
      kBytesOfMember * members + (iterates ? kBytesOfIteratedEntry : kBytesOfMatrixEntry) * junctions.matrix;
  needs.memory = sums.run + samples + stability;
  if (estimates_error(parameters.analysis, static_cast<size_t>(needs.elements)))
    needs.memory = std::max(needs.memory, iterates ? sums.run + sums.estimate + of_mesh
                                                   : kShareDuringEstimate * sums.run + sums.estimate + stability);
  needs.memory += of_mesh + kBytesOfFactorEntry * junctions.entries;
  needs.everywhere = kBytesOfMemberEverywhere * members + kBytesOfElementEverywhere * elements +
                     kFactorsEverywhere * kBytesOfFactorEntry * junctions.entries;
  if (iterates) needs.memory += kBytesOfIteratedJunction * junctions.junctions + kBytesOfCoarsestLevel;
  needs.factors = sizeof(double) * (chain_factor(needs.planar) * elements + junctions.entries);
  needs.file = kFileBytesOfPlace * sums.samples + kFileBytesOfMember * members;
  needs.file_per_step = (kFileBytesOfSample + of_stresses) * sums.samples +
                        sizeof(double) * (7 * vertices + sums.state) + kFileBytesOfStep;
  needs.steps = least_steps(scene, parameters);
  needs.seconds = sums.seconds + junctions.operations * kSecondsOfOperation + junctions.entries * kSecondsOfFactorEntry;
  if (iterates) needs.seconds += seconds_iterated(junctions.junctions, is_slender(scene));
  return needs;
}

}  // namespace mixbeam
