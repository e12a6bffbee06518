#include "discretization/state/transfer.hpp"

#include "discretization/state/element_polynomials.hpp"
#include "kernels/element/layout.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

namespace mixbeam {

namespace {

/// Largest distance of two vertices considered equal in two meshes, relative to the elements there: stations are
/// written with a dozen digits, and no element is that short compared with its neighbours.
constexpr double kSamePlace = 1e-6;
constexpr double kAllowedMean = 1e-12;  ///< of psi in an element of the new mesh: rounding [radian]
constexpr double kSameLength = 1e-12;   ///< of a member in two meshes, relative

/// Discrete rotations of an undeformed element, in the polynomials of its order.
struct UndeformedRotation {
  int order;
  ReferenceElement reference;

  UndeformedRotation(const Discretization& d, int member, int index)
      : order(d.scene.members[member].order),
        reference(
            make_reference_element(d.mesh.members[member], index, order, d.scene.members[member].force_integration)) {}
  Quat at(double xi) const { return reference.triad * exp_quaternion(relative_rotation(reference, order, xi)); }
};

/// True if the undeformed rotations are Lambda_0(s) in elements of this order.
bool has_exact_undeformed_rotation(const ReferenceCurve& curve, int order) {
  return curve.has_constant_curvature() && (order > 1 || dot(curve.start_curvature, curve.start_curvature) == 0.0);
}

/// Point at which fields are transferred.
struct FieldPoint {
  double xi = 0.0, weight = 0.0;  ///< in the new element; weights add up to 2
  Vec slope, force, moment;
  Quat rotation;  ///< Lambda_E, or its change Lambda_E Lambda_E0^T
};

/// Old fields on one member.
class MemberFields {
 public:
  MemberFields(const Discretization& d, const StateNumbers<const double>& state, int member)
      : d_(d), state_(state), member_(member), mesh_(d.mesh.members[member]) {}

  int order() const { return d_.scene.members[member_].order; }
  int elements() const { return mesh_.elements; }
  double start(int index) const { return mesh_.vertex_arc_length(index); }
  double length(int index) const { return mesh_.element_length(index); }
  /// Element that contains the point just after s.
  int element_behind(double s) const { return mesh_.element_behind(s); }
  /// Vertex (0 .. elements) at this arc length, or -1.
  int vertex_at(double s) const {
    const int index = element_behind(s);
    const double allowed = kSamePlace * length(index);
    if (std::abs(s - start(index)) <= allowed) return index;
    if (std::abs(s - start(index + 1)) <= allowed) return index + 1;
    return -1;
  }
  int mesh_vertex(int vertex) const {
    const MeshElement* first = &d_.mesh.elements[mesh_.first_element];
    return vertex == 0 ? first->vertex[0] : first[vertex - 1].vertex[1];
  }
  const ElementPolynomials& element(int index) {
    if (index == polynomials_of_) return polynomials_;
    const int e = mesh_.first_element + index;
    const MeshElement& at = d_.mesh.elements[e];
    polynomials_ = polynomials_of(d_.scene.members[member_], length(index), state_.displacement(at, e, 0),
                                  state_.displacement(at, e, 1), state_.triad(e), state_.interior(e));
    polynomials_of_ = index;
    return polynomials_;
  }
  double xi_of(int index, double s) const {
    return std::clamp(-1.0 + 2.0 * (s - start(index)) / length(index), -1.0, 1.0);
  }
  Vec displacement(int index, double xi) {
    const ElementPolynomials& fields = element(index);
    double B[kMaximumOrder + 1];
    integrated_legendre(kMaximumOrder, xi, B);
    Vec u = fields.start + (0.5 * length(index) * (1.0 + xi)) * fields.slope[0];
    for (int j = 1; j < order(); ++j) u += (0.5 * length(index) * B[j]) * fields.slope[j];
    return u;
  }
  FieldPoint point(int index, double xi, bool with_change) {
    const ElementPolynomials& fields = element(index);
    double P[kMaximumOrder + 1];
    legendre(kMaximumOrder, xi, P);
    FieldPoint at;
    at.slope = value_at(fields.slope, order() - 1, P);
    at.force = value_at(fields.force, order(), P);
    at.moment = value_at(fields.moment, order(), P);
    at.rotation = fields.triad * exp_quaternion(value_at(fields.psi, order() - 1, P));
    if (with_change) at.rotation = at.rotation * conjugate(undeformed(index).at(xi));
    return at;
  }

 private:
  const UndeformedRotation& undeformed(int index) {
    if (index != undeformed_of_) undeformed_.emplace(d_, member_, index);
    undeformed_of_ = index;
    return *undeformed_;
  }

  const Discretization& d_;
  const StateNumbers<const double>& state_;
  int member_;
  const MeshMember& mesh_;
  // of the element evaluated last
  int polynomials_of_ = -1, undeformed_of_ = -1;
  ElementPolynomials polynomials_;
  std::optional<UndeformedRotation> undeformed_;
};

/// Transfers the state of one member.
class MemberTransfer {
 public:
  MemberTransfer(const Discretization& from, const StateNumbers<const double>& state, const Discretization& to,
                 int member, const StateNumbers<double>& result)
      : fields_(from, state, member),
        state_(state),
        to_(to),
        index_(member),
        member_(to.scene.members[member]),
        mesh_(to.mesh.members[member]),
        result_(result),
        same_undeformed_(has_exact_undeformed_rotation(mesh_.curve, fields_.order()) &&
                         has_exact_undeformed_rotation(mesh_.curve, member_.order)) {}

  void run() {
    for (int vertex = 0; vertex <= mesh_.elements; ++vertex) carry_vertex(vertex);
    for (int element = 0; element < mesh_.elements; ++element) carry_element(element);
  }

  void carry_element(int index) {
    const double start = mesh_.vertex_arc_length(index), end = mesh_.vertex_arc_length(index + 1);
    const int first = fields_.vertex_at(start);
    const bool coincides = first >= 0 && first < fields_.elements() && fields_.vertex_at(end) == first + 1;
    ElementPolynomials element;
    if (coincides) element = fields_.element(first);  // Legendre series truncated or extended by zeros
    if (!coincides || !same_undeformed_) {
      collect_points(start, end);
      if (!coincides) project(element);
      fit_rotations(index, element);
    }
    const int e = mesh_.first_element + index;
    store_polynomials(member_, element, result_.triad(e), result_.interior(e));
  }

 private:
  void carry_vertex(int vertex) {
    const double s = mesh_.vertex_arc_length(vertex);
    const int old = vertex == 0 ? 0 : vertex == mesh_.elements ? fields_.elements() : fields_.vertex_at(s);
    const MeshElement* first = &to_.mesh.elements[mesh_.first_element];
    const int here = vertex == 0 ? first->vertex[0] : first[vertex - 1].vertex[1];
    double *u = result_.displacement(here), *q = result_.rotation(here);
    if (old >= 0) {
      const int there = fields_.mesh_vertex(old);
      std::copy_n(state_.displacement(there), 3, u);
      std::copy_n(state_.rotation(there), 4, q);
      return;
    }
    const int element = fields_.element_behind(s);
    const double xi = fields_.xi_of(element, s);
    store_vector(fields_.displacement(element, xi), u);
    store_quaternion(normalized(fields_.point(element, xi, true).rotation), q);
  }

  /// Collects Gauss points in every piece of the new element between old vertices, enough to integrate products of old
  /// and new polynomials, and of undeformed rotations and new polynomials, exactly.
  void collect_points(double start, double end) {
    points_.clear();
    const GaussPoints& rule = gauss_points(std::max((fields_.order() + member_.order) / 2 + 1, member_.order));
    const double length = end - start, least = kSamePlace * length;
    double from = start;
    for (int old = fields_.element_behind(start + least); old < fields_.elements() && end - from > least; ++old) {
      const double old_end = fields_.start(old + 1);
      const double to = end - old_end > least ? old_end : end;
      for (size_t q = 0; q < rule.xi.size(); ++q) {
        const double s = from + 0.5 * (1.0 + rule.xi[q]) * (to - from);
        FieldPoint point = fields_.point(old, fields_.xi_of(old, s), !same_undeformed_);
        point.xi = -1.0 + 2.0 * (s - start) / length;
        point.weight = rule.weight[q] * (to - from) / length;
        points_.push_back(point);
      }
      from = to;
    }
  }

  void project(ElementPolynomials& element) const {
    for (const FieldPoint& point : points_) {
      double P[kMaximumOrder + 1];
      legendre(member_.order, point.xi, P);
      for (int j = 0; j <= member_.order; ++j) {
        const double factor = 0.5 * (2 * j + 1) * point.weight * P[j];
        element.slope[j] += factor * point.slope;
        element.force[j] += factor * point.force;
        element.moment[j] += factor * point.moment;
      }
    }
  }

  /// Fits Lambda_lo and psi to the rotations at the points, applied to the undeformed rotations of the new element.
  void fit_rotations(int index, ElementPolynomials& element) {
    std::vector<Quat> target;
    std::vector<double> xi, weight;
    for (const FieldPoint& point : points_) {
      target.push_back(point.rotation);
      xi.push_back(point.xi);
      weight.push_back(point.weight);
    }
    if (!same_undeformed_) {
      const UndeformedRotation undeformed(to_, index_, index);
      for (size_t q = 0; q < target.size(); ++q) target[q] = target[q] * undeformed.at(xi[q]);
    }
    for (Quat& rotation : target) rotation = normalized(rotation);
    const FittedRotation fit = fit_rotation(target[target.size() / 2], target, xi, weight, member_.order);
    if (!(fit.mean <= kAllowedMean))
      throw std::invalid_argument("member \"" + member_.name +
                                  "\": the state turns too far inside an element of the mesh that is to take it over");
    element.triad = fit.triad;
    std::copy(fit.psi.begin(), fit.psi.end(), element.psi.begin());
  }

  MemberFields fields_;
  const StateNumbers<const double>& state_;
  const Discretization& to_;
  int index_;
  const Member& member_;
  const MeshMember& mesh_;
  const StateNumbers<double>& result_;
  bool same_undeformed_;            ///< if so, rotations themselves are transferred, not their change
  std::vector<FieldPoint> points_;  ///< of the current element
};

void require_same_members(const Discretization& from, const Discretization& to) {
  bool same = from.mesh.members.size() == to.mesh.members.size();
  for (size_t m = 0; same && m < from.mesh.members.size(); ++m) {
    const double length = from.mesh.member_length[m];
    same = from.scene.members[m].name == to.scene.members[m].name &&
           std::abs(to.mesh.member_length[m] - length) <= kSameLength * length;
  }
  if (!same) throw std::invalid_argument("a state can be carried over between meshes of the same members only");
}

}  // namespace

StateSnapshot transfer(const Discretization& from, const StateSnapshot& state, const Discretization& to) {
  require_same_members(from, to);
  const std::vector<size_t> from_places = interior_places(from.scene, from.mesh),
                            to_places = interior_places(to.scene, to.mesh);
  StateSnapshot result;
  result.vertex_displacement.resize(3 * static_cast<size_t>(to.mesh.vertices()));
  result.vertex_rotation.resize(4 * static_cast<size_t>(to.mesh.vertices()));
  result.element_triad.resize(4 * to.mesh.elements.size());
  result.interior.resize(to_places.back());
  const StateNumbers<const double> old(state, from_places);
  const StateNumbers<double> carried(result, to_places);
  for (size_t m = 0; m < to.mesh.members.size(); ++m) MemberTransfer(from, old, to, static_cast<int>(m), carried).run();
  return result;
}

namespace {

/// True if every rank has the same vertices and elements of both. Collective.
bool have_same_shares(const Model& a, const Model& b) {
  const Mesh &mesh = a.mesh(), &other = b.mesh();
  bool same = mesh.first_element == other.first_element && mesh.member_length == other.member_length &&
              a.structure().local_vertex_to_global == b.structure().local_vertex_to_global &&
              a.structure().local_elements() == b.structure().local_elements();
  for (size_t m = 0; same && m < mesh.members.size(); ++m) {
    same = mesh.members.keeps(m) == other.members.keeps(m);
    if (same && mesh.members.keeps(m)) same = mesh.members[m].stations == other.members[m].stations;
  }
  for (const int element : a.structure().local_element_to_mesh)
    same = same && b.structure().local_element(element) >= 0;
  const int mine = same ? 1 : 0;
  int all = mine;
  Teuchos::reduceAll(*a.map()->getComm(), Teuchos::REDUCE_MIN, mine, Teuchos::outArg(all));
  return all == 1;
}

/// Transfers without communication, for coinciding elements.
State transfer_share(const Model& from, const State& state, const Model& to) {
  State carried = allocate_state(to.structure());
  Kokkos::deep_copy(carried.views.vertex_displacement, state.views.vertex_displacement);
  Kokkos::deep_copy(carried.views.vertex_rotation, state.views.vertex_rotation);
  const StateNumbers<const double> old(state.views, from.structure());
  const StateNumbers<double> result(carried.views, to.structure());
  const Discretization source{from.scene(), from.mesh()}, target{to.scene(), to.mesh()};
  std::optional<MemberTransfer> transfer;
  int member = -1;
  for (const int local : to.structure().elements_in_order) {
    const MeshElement& element = to.mesh().elements[to.structure().local_element_to_mesh[local]];
    if (element.member != member) transfer.emplace(source, old, target, element.member, result);
    member = element.member;
    transfer->carry_element(element.index);
  }
  return carried;
}

}  // namespace

State transfer(const Model& from, const State& state, const Model& to) {
  const Teuchos::Comm<int>& comm = *from.map()->getComm();
  require_same_members({from.scene(), from.mesh()}, {to.scene(), to.mesh()});
  const bool is_by_shares = have_same_shares(from, to);
  const StateSnapshot old = is_by_shares ? StateSnapshot{} : snapshot_of(from, state);
  StateSnapshot result;
  State carried;
  std::string problem;
  try {
    if (is_by_shares) {
      carried = transfer_share(from, state, to);
    } else if (comm.getRank() == 0) {
      const auto source = from.whole_mesh(), target = to.whole_mesh();
      result = transfer(Discretization{from.scene(), *source}, old, Discretization{to.scene(), *target});
    }
  } catch (const std::invalid_argument& error) {
    problem = error.what();
  }
  const int failed = problem.empty() ? 0 : 1;
  int fails = failed;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, failed, Teuchos::outArg(fails));
  if (fails != 0)
    throw std::invalid_argument(problem.empty() ? "the state cannot be carried over to the other mesh" : problem);
  if (!is_by_shares) carried = restore(to, result);
  carried.in_plane = state.in_plane && to.plane().has_value();
  if (from.constraints().counts()) {  // the ranks may distribute supports and joints differently
    from.constraints().keep_turns(state, carried);
    const std::vector<int> mine = carried.turns;
    Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, static_cast<int>(mine.size()), mine.data(), carried.turns.data());
  }
  return carried;
}

}  // namespace mixbeam
