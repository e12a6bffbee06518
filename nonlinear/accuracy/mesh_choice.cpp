#include "nonlinear/accuracy/mesh_choice.hpp"

#include "discretization/scene/division.hpp"
#include "discretization/scene/formula_pieces.hpp"
#include "kernels/element/layout.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <unordered_set>

namespace mixbeam {

namespace {

/// Returns (member): with additional inner points where its formulas need vertices, except for members with fixed
/// elements. Only positions of inner points are meaningful. Empty if no formula needs any.
std::vector<Member> members_with_places(const Scene& scene) {
  std::vector<Member> members;
  std::optional<Mesh> mesh;
  const auto curve = [&](size_t m) -> const ReferenceCurve& {
    if (!mesh) mesh = build_mesh(scene);
    return mesh->members[m].curve;
  };
  for (const FormulaAlong& formula : formulas_along(
           scene, [](const Member& member) { return !member.keeps_elements; }, curve, true)) {
    if (members.empty() && !formula.pieces->places.empty()) members = scene.members;
    for (const double place : formula.pieces->places) {
      std::vector<InnerPoint>& inner = members[formula.member].inner_points;
      const auto after =
          std::find_if(inner.begin(), inner.end(), [&](const InnerPoint& p) { return p.position > place; });
      const double before = after == inner.begin() ? 0.0 : (after - 1)->position;
      const double next = after == inner.end() ? 1.0 : after->position;
      if (std::min(place - before, next - place) > kNearestPlaces) inner.insert(after, {"", place});
    }
  }
  return members;
}

/// Divides a member at all its places: each piece between two of them into equally many elements, with the remaining
/// ones where elements are longest.
void divide_at_places(const Member& with_places, Member& member) {
  Member finer = with_places;
  finer.stations.clear();
  finer.inner_points.clear();
  const int pieces = static_cast<int>(with_places.inner_points.size()) + 1,
            parts = std::max(1, member.elements / pieces);
  double from = 0.0;
  for (int piece = 0; piece < pieces; ++piece) {
    const double to = piece + 1 < pieces ? with_places.inner_points[piece].position : 1.0;
    for (int i = 1; i <= parts; ++i)
      if (piece + 1 < pieces || i < parts)
        finer.inner_points.push_back({"", i < parts ? from + (to - from) * i / parts : to});
    from = to;
  }
  finer.elements = member.elements;
  member.stations = divide(finer).station;
  member.elements = static_cast<int>(member.stations.size()) - 1;
}

/// Rotation c at which the relative error (theta / c)^(k+1) of an element of order k that rotates by theta is one: from
/// errors of meshes of 16 scenes, with c from 14 (order 4) to 20 (order 8). [radian]
constexpr double kTurningScale = 16.0;
/// Share of the wanted error at which a start mesh aims. A digit more costs 10 % more time, another mesh 50 %.
constexpr double kAim = 0.1;
/// Limit of the rotation along an element, below pi at its vertices: beyond, Newton's method finds other solutions too.
constexpr double kLargestTurning = 2.5;
/// Factor f such that a member of length L under a force F with a lever d has errors as if it rotated evenly by f
/// sqrt(F d L / EI): its curvature is at most sqrt(2 F / EI). Measured with the elastica, arcs and frames: f is 1.7 to
/// 2.1, and small loads leave errors as if it rotated by 2. A force rotates a member at most into its own direction; a
/// hundred coils by moments are few enough to try. [radian]
constexpr double kTurningByForce = 2.0, kLeastTurningByLoad = 2.0, kMostTurningByForce = 8.0,
                 kMostTurningByMoment = 600.0;
/// Members up to which every load is assumed to bend each one, otherwise its neighbours; limit of levers in lengths of
/// a member.
constexpr std::size_t kMembersOfAFrame = 8;
constexpr double kLeverInLengths = 3.0;
/// Lowest orders that pay, see apps/docs/trade.md.
constexpr int kLeastOrder = 2, kLeastStartOrder = 3;

/// Microseconds of a Newton iteration for one element of order 1 to 8 (64 elements in space on one thread), and with
/// coupled sections, whose kernels have matrices instead of diagonals.
constexpr std::array<double, kMaximumOrder + 1> kElementCost = {0.0, 2.0, 3.3, 5.0, 6.5, 9.0, 11.5, 15.0, 20.0};
constexpr std::array<double, kMaximumOrder + 1> kGeneralCost = {0.0, 6.0, 11.0, 24.0, 42.0, 60.0, 90.0, 130.0, 165.0};
/// Number of elements computed together, except with coupled sections: fewer cost as much.
constexpr int kPack = 4;

/// Limit of elements of a member of a start mesh: a low fixed order would need any number for a high accuracy.
constexpr int kMostStartElements = 20'000;
/// Largest factor by which elements of a member decrease from mesh to mesh.
constexpr int kLargestCoarsening = 2;
/// Ratio of successive candidates for the number of elements.
constexpr double kElementRatio = 1.15;
/// Displacements over the length of the structure: rounding, 1e-14 to 1e-12 if nothing moves (columns, rings rotated by
/// 4 pi), for which a relative error has no meaning; and size above which they are certainly significant.
constexpr double kRoundedDisplacement = 1e-11, kSmallDisplacement = 1e-3;
/// Largest q h for an error that has not begun to fall yet.
constexpr double kUnresolved = 0.7;

int pieces_between(const Member& member) { return static_cast<int>(member.inner_points.size()) + 1; }

using OrderCosts = std::array<double, kMaximumOrder + 1>;  ///< of one element

const OrderCosts& costs_of(const Scene& scene, const Member& member) {
  return has_general_section(scene, member) ? kGeneralCost : kElementCost;
}

double angle_between(const double* p, const double* q) {
  const double w = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
  double difference = 0.0, sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    difference += (p[i] - std::copysign(1.0, w) * q[i]) * (p[i] - std::copysign(1.0, w) * q[i]);
    sum += (p[i] + std::copysign(1.0, w) * q[i]) * (p[i] + std::copysign(1.0, w) * q[i]);
  }
  return 4.0 * std::atan2(std::sqrt(difference), std::sqrt(sum));
}

/// Total angle by which the triad of the undeformed member rotates from start to end.
double reference_turning(const ReferenceCurve& curve) {
  const auto norm_of = [](const Vec3<double>& v) { return std::hypot(v[0], v[1], v[2]); };
  if (curve.has_constant_curvature()) return norm_of(curve.start_curvature) * curve.length;
  constexpr int kChords = 64;
  double angle = 0.0;
  Vec3<double> before = curve.tangent(0.0);
  for (int i = 1; i <= kChords; ++i) {
    const Vec3<double> here = curve.tangent(curve.length * i / kChords);
    const double chord = norm_of(here - before);
    angle += 2.0 * std::asin(std::min(1.0, 0.5 * chord));
    before = here;
  }
  return std::hypot(angle, curve.twist_rate * curve.length);
}

/// Compliance of a member in bending and torsion: the larger of 1 / EI and 1 / GIt.
double bending_compliance(const Scene& scene, const Member& member) {
  for (const Section& section : scene.sections)
    if (section.name == member.section)
      return 1.0 / std::min({section.bending_stiffness[0], section.bending_stiffness[1], section.torsional_stiffness});
  return 1.0;
}

/// Magnitude of the loads that bend a member, whatever their directions; formulas are ignored until the first estimate.
struct LoadSize {
  double force = 0.0, moment = 0.0;
};

LoadSize load_size(const Scene& scene, const Mesh& mesh) {
  LoadSize size;
  const auto add = [&](const Vector3& force, const Vector3& moment, double length) {
    const double f = length * vector_algebra::norm(force), m = length * vector_algebra::norm(moment);
    const bool is_frame = scene.members.size() <= kMembersOfAFrame;
    size = is_frame ? LoadSize{size.force + f, size.moment + m}
                    : LoadSize{std::max(size.force, f), std::max(size.moment, m)};
  };
  for (const PointLoad& load : scene.point_loads) add(load.force, load.moment, 1.0);
  for (const DistributedLoad& load : scene.distributed_loads)
    add(load.force, load.couple, mesh.members[member_index(scene, load.member)].curve.length);
  return size;
}

/// Guesses (member): effective rotation from start to end in the deformed structure, as it determines the errors of
/// elements, without a solution. [radian]
std::vector<double> expected_turning(const Scene& scene, const Mesh& mesh) {
  const LoadSize load = load_size(scene, mesh);
  vector_algebra::Box box;
  for (const Vector3& position : mesh.vertex_position) box.enclose(position);
  std::vector<double> turning;
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    const double length = mesh.members[m].curve.length,
                 lever = std::max(0.5 * length, std::min(kLeverInLengths * length, box.diagonal())),
                 compliance = length * bending_compliance(scene, scene.members[m]);
    const double by_forces =
                     std::min(kMostTurningByForce, kTurningByForce * std::sqrt(load.force * lever * compliance)),
                 by_moments = std::min(kMostTurningByMoment, load.moment * compliance);
    turning.push_back(reference_turning(mesh.members[m].curve) +
                      std::max(kLeastTurningByLoad, std::hypot(by_forces, by_moments)));
  }
  for (const Eigenstrain& strain : scene.eigenstrains) {
    const int m = member_index(scene, strain.member);
    turning[m] += std::min(kMostTurningByMoment, vector_algebra::norm(strain.curvature) * mesh.members[m].curve.length);
  }
  return turning;
}

double squared(const Vector3& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// Mean square of the error of vertices interpolated linearly along an element.
double carried(const Vector3& a, const Vector3& b) {
  return (squared(a) + squared(b) + a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / 3.0;
}

/// Rate q in error = (q h)^power with h = 1 / elements.
double rate_of(double error, int power, int elements) {
  return error > 0.0 ? elements * std::min(kUnresolved, std::pow(error, 1.0 / power)) : 0.0;
}

struct Candidate {
  MemberMesh mesh;
  double cost = 0.0, inside = 0.0, vertex = 0.0;
};

std::vector<int> element_numbers(const Member& member, int present) {
  if (member.keeps_elements) return {present};
  std::vector<int> numbers;
  int n = std::max(pieces_between(member), (present + kLargestCoarsening - 1) / kLargestCoarsening);
  for (; n <= kLargestRefinement * present; n = std::max(n + 1, static_cast<int>(n * kElementRatio)))
    numbers.push_back(n);
  return numbers;
}

std::vector<Candidate> candidates_of(const Scene& scene, const Member& member, const MemberMesh& present,
                                     const ErrorOfMember& error) {
  std::vector<Candidate> list;
  const int first = member.keeps_order ? present.order : kLeastOrder;
  const int last = member.keeps_order ? present.order : kMaximumOrder;
  const std::vector<int> numbers = element_numbers(member, present.elements);
  const OrderCosts& costs = costs_of(scene, member);
  const double inside = rate_of(error.inside, present.order + 1, present.elements);
  const double vertex = rate_of(error.vertex, 2 * present.order, present.elements);
  for (int k = first; k <= last; ++k)
    for (const int n : numbers)
      list.push_back({{k, n}, n * costs[k], std::pow(inside / n, k + 1), std::pow(vertex / n, 2 * k)});
  return list;
}

/// Candidate with the least cost plus price of the remaining error.
const Candidate& best_of(const std::vector<Candidate>& list, double price, double aim) {
  const auto value = [&](const Candidate& c) {
    return c.cost + price * (c.inside * c.inside / (aim * aim) + c.vertex / aim);
  };
  const Candidate* best = &list.front();
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& candidate : list) {
    const double here = value(candidate);
    if (here < least) {
      least = here;
      best = &candidate;
    }
  }
  return *best;
}

using Candidates = std::vector<std::vector<Candidate>>;

MeshChoice choose(const Candidates& members, double price, double aim, double& error) {
  MeshChoice choice;
  double inside = 0.0, vertex = 0.0;
  for (const std::vector<Candidate>& list : members) {
    const Candidate& best = best_of(list, price, aim);
    choice.push_back(best.mesh);
    inside += best.inside * best.inside;
    vertex += best.vertex;
  }
  error = std::sqrt(inside + vertex * vertex);
  return choice;
}

}  // namespace

namespace {

/// Whether `keeps` holds for a member other than rigid arms, whose mesh is fixed when they are made.
template <class Keeps>
bool any_but_arms(const Scene& scene, const Keeps& keeps) {
  std::unordered_set<std::string> rigid;
  for (const Section& section : scene.sections)
    if (std::isinf(section.bending_stiffness[0])) rigid.insert(section.name);
  return std::any_of(scene.members.begin(), scene.members.end(),
                     [&](const Member& member) { return keeps(member) && rigid.count(member.section) == 0; });
}

}  // namespace

bool names_no_mesh(const Scene& scene) {
  return !scene.accuracy &&
         !any_but_arms(scene, [](const Member& member) { return member.keeps_order || member.keeps_elements; });
}

bool keeps_some_mesh(const Scene& scene) {
  return any_but_arms(scene, [](const Member& member) { return member.keeps_order && member.keeps_elements; });
}

MeshChoice mesh_of(const Scene& scene) {
  MeshChoice mesh;
  for (const Member& member : scene.members) mesh.push_back({member.order, member.elements});
  return mesh;
}

MeshChoice joined(MeshChoice one, const MeshChoice& other) {
  for (size_t m = 0; m < one.size(); ++m)
    one[m] = {std::max(one[m].order, other[m].order), std::max(one[m].elements, other[m].elements)};
  return one;
}

Scene on_mesh(const Scene& scene, const MeshChoice& choice) {
  Scene changed = scene;
  const std::vector<Member> with_places = members_with_places(scene);
  for (size_t m = 0; m < choice.size(); ++m) {
    Member& member = changed.members[m];
    if (!member.keeps_order) member.order = choice[m].order;
    if (!member.keeps_elements) member.elements = choice[m].elements;
    if (m < with_places.size() && with_places[m].inner_points.size() > member.inner_points.size())
      divide_at_places(with_places[m], member);
  }
  return changed;
}

double least_displacement(double length, double accuracy) {
  return length * std::min(kSmallDisplacement, kRoundedDisplacement / accuracy);
}

ErrorEstimate with_least_displacement(ErrorEstimate estimate, double least) {
  for (RecordedError* quantity : {&estimate.largest_displacement, &estimate.displacement})
    quantity->size = std::max(quantity->size, least);
  return estimate;
}

double judged_error(const ErrorEstimate& estimate) {
  return std::max(estimate.largest_displacement.relative(), estimate.displacement.relative());
}

double allowed_turning(int order, double accuracy, bool of_vertices) {
  const int power = of_vertices ? 2 * order : order + 1;
  return std::min(kLargestTurning, kTurningScale * std::pow(kAim * accuracy, 1.0 / power));
}

MeshChoice start_mesh(const Scene& scene, double accuracy, bool of_vertices) {
  const Mesh mesh = build_mesh(scene);
  const std::vector<double> expected = expected_turning(scene, mesh);
  const int pack = std::max(1, kPack / static_cast<int>(scene.members.size()));
  const std::vector<Member> with_places = members_with_places(scene);
  MeshChoice choice;
  for (size_t m = 0; m < scene.members.size(); ++m) {
    const Member& member = with_places.empty() ? scene.members[m] : with_places[m];
    const double turning = expected[m];
    const int first = member.keeps_order ? member.order : kLeastStartOrder;
    const int last = member.keeps_order ? member.order : kMaximumOrder;
    const OrderCosts& costs = costs_of(scene, member);
    const int least_elements = std::max(pieces_between(member), has_general_section(scene, member) ? 1 : pack);
    MemberMesh best;
    double least = std::numeric_limits<double>::infinity();
    for (int k = first; k <= last; ++k) {
      int n = mesh.members[m].elements;
      if (!member.keeps_elements)
        n = std::max(least_elements,
                     static_cast<int>(std::min<double>(
                         kMostStartElements, std::ceil(turning / allowed_turning(k, accuracy, of_vertices)))));
      // An order that misses the accuracy on fixed elements costs as much as the elements that it would need.
      const double needed = std::max<double>(n, turning / allowed_turning(k, accuracy, of_vertices));
      const double cost = needed * costs[k];
      if (cost >= least) continue;
      least = cost;
      best = {k, n};
    }
    choice.push_back(best);
  }
  return choice;
}

std::vector<double> element_turning(const Scene& scene, const Mesh& mesh, const std::vector<double>& vertex_rotation) {
  std::vector<double> turning;
  for (size_t m = 0; m < mesh.members.size(); ++m) {
    const MeshMember& member = mesh.members[m];
    const int power = scene.members[m].order + 1;
    double sum = 0.0;
    for (int i = 0; i < member.elements; ++i) {
      const MeshElement& element = mesh.elements[member.first_element + i];
      sum += std::pow(angle_between(&vertex_rotation[4 * static_cast<size_t>(element.vertex[0])],
                                    &vertex_rotation[4 * static_cast<size_t>(element.vertex[1])]),
                      power);
    }
    turning.push_back(std::pow(sum / member.elements, 1.0 / power));
  }
  return turning;
}

MeshChoice mesh_for_turning(const Scene& scene, const MeshChoice& present, const std::vector<double>& turning,
                            double accuracy, bool of_vertices) {
  MeshChoice choice = present;
  for (size_t m = 0; m < choice.size(); ++m) {
    const double growth = turning[m] / allowed_turning(choice[m].order, accuracy, of_vertices);
    if (growth > 1.0 && !scene.members[m].keeps_elements)
      choice[m].elements =
          static_cast<int>(std::ceil(choice[m].elements * std::min<double>(kLargestRefinement, growth)));
  }
  return choice;
}

MeshChoice doubled(const Scene& scene, const MeshChoice& present) {
  MeshChoice choice = present;
  for (size_t m = 0; m < choice.size(); ++m)
    if (!scene.members[m].keeps_elements) choice[m].elements *= 2;
  return choice;
}

MeshChoice richer(const Scene& scene, const MeshChoice& present) {
  MeshChoice choice = present;
  for (size_t m = 0; m < choice.size(); ++m)
    if (!scene.members[m].keeps_order && choice[m].order < kMaximumOrder)
      ++choice[m].order;
    else if (!scene.members[m].keeps_elements)
      choice[m].elements *= 2;
  return choice;
}

bool contains(const MeshChoice& larger, const MeshChoice& smaller) {
  return std::equal(larger.begin(), larger.end(), smaller.begin(), [](const MemberMesh& a, const MemberMesh& b) {
    return a.order >= b.order && a.elements >= b.elements;
  });
}

std::vector<ErrorOfMember> errors_of_members(const Scene& scene, const Mesh& mesh, const ErrorEstimate& estimate) {
  double length = 0.0, moments = 0.0;
  for (const MeshMember& member : mesh.members) length += member.curve.length;
  std::vector<ErrorOfMember> errors(mesh.members.size());
  std::vector<double> compliance;
  for (const Member& member : scene.members) compliance.push_back(bending_compliance(scene, member));
  for (size_t e = 0; e < mesh.elements.size(); ++e) {
    const MeshElement& element = mesh.elements[e];
    const double whole = estimate.element_displacement[e] * estimate.element_displacement[e];
    const double of_vertices =
        carried(estimate.vertex_displacement[element.vertex[0]], estimate.vertex_displacement[element.vertex[1]]) *
        mesh.element_length(element) / length;
    const double moment = estimate.element_moment[e] * estimate.element_moment[e] * compliance[element.member];
    errors[element.member].inside += std::max(0.0, whole - of_vertices);
    errors[element.member].vertex += moment;
    moments += moment;
  }
  for (ErrorOfMember& error : errors) {
    error.inside = estimate.displacement.size > 0.0 ? std::sqrt(error.inside) / estimate.displacement.size : 0.0;
    error.vertex = moments > 0.0 ? estimate.largest_displacement.relative() * error.vertex / moments : 0.0;
  }
  return errors;
}

double error_of_kept(const Scene& scene, const Mesh& mesh, const ErrorEstimate& estimate) {
  const std::vector<ErrorOfMember> errors = errors_of_members(scene, mesh, estimate);
  double inside = 0.0, vertex = 0.0;
  for (size_t m = 0; m < errors.size(); ++m) {
    if (!scene.members[m].keeps_order || !scene.members[m].keeps_elements) continue;
    inside += errors[m].inside * errors[m].inside;
    vertex += errors[m].vertex;
  }
  return std::max(std::sqrt(inside), vertex);
}

MeshChoice next_mesh(const Scene& scene, const Mesh& mesh, const MeshChoice& present,
                     const std::vector<ErrorOfMember>& errors, double aim) {
  const std::vector<Member> with_places = members_with_places(scene);
  Candidates members;
  for (size_t m = 0; m < present.size(); ++m)
    members.push_back(candidates_of(scene, with_places.empty() ? scene.members[m] : with_places[m],
                                    {present[m].order, mesh.members[m].elements}, errors[m]));
  // Prices range from that of a single coarse element to one that leaves no error, in steps of a sufficient resolution.
  constexpr double kFirstPrice = 1e-3, kLastPrice = 1e30, kPriceRatio = 4.0;
  MeshChoice choice;
  double error = std::numeric_limits<double>::infinity();
  for (double price = kFirstPrice; error > aim && price < kLastPrice; price *= kPriceRatio)
    choice = choose(members, price, aim, error);
  return choice;
}

}  // namespace mixbeam
