#include "discretization/state/difference.hpp"

#include "discretization/mesh/element_view.hpp"
#include "kernels/element/element.hpp"
#include "kernels/math/constants.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

/// Displacement along an element in Legendre polynomials, which are orthogonal: from u = mean of both ends + xi (u_b -
/// u_a) / 2 + h/2 sum_j beta_j B_j and B_j = (P_{j+1} - P_{j-1}) / (2 j + 1).
struct LegendreDisplacement {
  Vec coefficient[kMaximumOrder + 1];

  explicit LegendreDisplacement(const ElementView& element) {
    for (int j = 0; j <= element.order(); ++j) coefficient[j] = Vec{{0.0, 0.0, 0.0}};
    coefficient[0] = 0.5 * (element.displacement(0) + element.displacement(1));
    coefficient[1] = 0.5 * (element.displacement(1) - element.displacement(0));
    for (int j = 1; j < element.order(); ++j) {
      const Vec part = (0.5 * element.length() / (2 * j + 1)) * element.bubble(j);
      coefficient[j + 1] += part;
      coefficient[j - 1] += -part;
    }
  }
};

/// int |sum_j (a_j - b_j) P_j|^2 ds
double squared_norm(double length, int order, const Vec* a, const Vec* b) {
  double sum = 0.0;
  for (int j = 0; j <= order; ++j) {
    const Vec d = a[j] - b[j];
    sum += length / (2 * j + 1) * dot(d, d);
  }
  return sum;
}

/// |u| at xi = 0, where P_2 = -1/2, P_4 = 3/8, ...
double middle(int order, const Vec* u) {
  double P[kMaximumOrder + 1];
  legendre(order, 0.0, P);
  Vec sum{{0.0, 0.0, 0.0}};
  for (int j = 0; j <= order; ++j) sum += P[j] * u[j];
  return norm(sum);
}

ElementDifference compared(const ElementView& first, const ElementView& second) {
  const int order = first.order();
  const double h = first.length();
  const LegendreDisplacement d1(first), d2(second);
  Vec m1[kMaximumOrder + 1], m2[kMaximumOrder + 1], zero[kMaximumOrder + 1];
  for (int j = 0; j <= order; ++j) {
    m1[j] = first.moment(j);
    m2[j] = second.moment(j);
    zero[j] = Vec{{0.0, 0.0, 0.0}};
  }
  return {squared_norm(h, order, d2.coefficient, d1.coefficient), squared_norm(h, order, m2, m1),
          squared_norm(h, order, d2.coefficient, zero), squared_norm(h, order, m2, zero),
          middle(order, d2.coefficient)};
}

/// Vertex of the largest change on all ranks, the first of equal ones.
int farthest_of_ranks(const Teuchos::Comm<int>& comm, double mine, double largest, int vertex) {
  if (comm.getSize() == 1) return vertex;
  int candidate = mine == largest ? vertex : std::numeric_limits<int>::max(), first = candidate;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MIN, candidate, Teuchos::outArg(first));
  return first;
}

}  // namespace

StateDifference difference(const Model& model, const State& first, const State& second) {
  const Structure& structure = model.structure();
  StateDifference found;
  double change = 0.0;
  found.elements.resize(structure.local_elements());
  for_each_element_on_threads("mixbeam::difference", structure, first.views, [&](const ElementView& element) {
    found.elements[element.local()] = compared(element, element.in(second.views));
  });
  for (const ElementDifference& element : found.elements)
    found.largest_displacement = std::max(found.largest_displacement, element.middle);
  const auto &a = first.views.vertex_displacement, &b = second.views.vertex_displacement;
  for (int v = 0; v < structure.owned_vertices; ++v) {
    found.vertex_displacement.push_back({b(v, 0) - a(v, 0), b(v, 1) - a(v, 1), b(v, 2) - a(v, 2)});
    const Vector3& moved = found.vertex_displacement.back();
    found.largest_displacement = std::max(found.largest_displacement, std::hypot(b(v, 0), b(v, 1), b(v, 2)));
    const double here = std::hypot(moved[0], moved[1], moved[2]);
    if (!(here > change)) continue;
    change = here;
    found.farthest_vertex = structure.local_vertex_to_global[v];
  }
  const auto& comm = *model.map()->getComm();
  double largest[2] = {found.largest_displacement, change};
  maxima_over_ranks(comm, largest, 2);
  found.largest_displacement = largest[0];
  found.largest_change = largest[1];
  found.farthest_vertex = farthest_of_ranks(comm, change, largest[1], found.farthest_vertex);
  return found;
}

namespace {

constexpr double kTurn = 2.0 * kPi;
/// The axis of a smaller rotation vector has too few digits: that of `near` is used instead, rounded to 20 bits so that
/// its rounding does not matter.
constexpr double kNoAxis = 1e-3, kAxisSteps = 1 << 20;

/// Rotation vector of `turn` that is closest to `near`.
Vec rotation_near(const Quat& turn, const Vec& near) {
  const Vec least = log_quaternion(turn);
  const double angle = norm(least), length = norm(near);
  if (length < 0.25 * kTurn) return least;
  Vec axis{{least[0] / angle, least[1] / angle, least[2] / angle}};
  if (!(angle > kNoAxis))
    for (int i = 0; i < 3; ++i) axis[i] = std::nearbyint(near[i] / length * kAxisSteps) / kAxisSteps;
  const double turns = std::nearbyint((dot(axis, near) - dot(axis, least)) / kTurn);
  return least + (turns * kTurn) * axis;
}

}  // namespace

MixedVector increment_between(const Model& model, const State& first, const State& second, const MixedVector& near) {
  const Structure& structure = model.structure();
  MixedVector increment = near.clone(true);
  const KernelView<double*> rows = increment.vertex(), interior = increment.writable_interior(true);
  const StateViews a = first.views, b = second.views;
  Kokkos::parallel_for(
      "mixbeam::increment_of_vertices", Kokkos::RangePolicy<ExecutionSpace>(0, structure.owned_vertices),
      KOKKOS_LAMBDA(int v) {
        double* d = rows.data() + static_cast<size_t>(kVertexDofs) * v;
        store_vector(load_vector(&b.vertex_displacement(v, 0)) - load_vector(&a.vertex_displacement(v, 0)), d);
        const Quat turn =
            load_quaternion(&b.vertex_rotation(v, 0)) * conjugate(load_quaternion(&a.vertex_rotation(v, 0)));
        store_vector(rotation_near(turn, load_vector(d + 3)), d + 3);
      });
  for_each_element_on_threads("mixbeam::increment_of_elements", structure, a, [&](const ElementView& from) {
    const ElementView to = from.in(b);
    const int unknowns = from.layout().unknowns();
    double* d = from.increments_in(interior);
    for (int i = 0; i < unknowns; ++i) d[i] = to.unknowns()[i] - from.unknowns()[i];
    const Quat turn = conjugate(from.triad()) * to.triad();
    store_vector(rotation_near(turn, load_vector(d + unknowns)), d + unknowns);
  });
  return increment;
}

namespace {

/// log(exp(-psi) Lambda_lo^T Lambda_V Lambda_0) at an end, see EndRotation.
Vec jump_at_end(const ElementView& element, int end) {
  Vec psi{{0.0, 0.0, 0.0}};
  for (int j = 1; j < element.order(); ++j) psi += end_value(end, j) * element.relative_rotation(j);
  return log_quaternion(conjugate(exp_quaternion(psi)) * conjugate(element.triad()) * element.end_triad(end));
}

void recover(const ElementView& element) {
  const int order = element.order();
  Vec top{{0.0, 0.0, 0.0}};
  for (int end = 0; end < 2; ++end) top += (0.5 * end_value(end, order - 1)) * jump_at_end(element, end);
  double* psi = element.unknowns() + element.layout().relative_rotation(order - 1);
  double* bubble = element.unknowns() + element.layout().bubble(order - 1);
  const Vec slope = rotation_matrix(element.triad()) * cross(top, Vec{{1.0, 0.0, 0.0}});
  for (int i = 0; i < 3; ++i) {
    psi[i] += top[i];
    bubble[i] += slope[i];
  }
}

}  // namespace

State with_recovered_rotations(const Model& model, const State& state, const std::vector<unsigned char>& raised) {
  State recovered = allocate_state(model.structure());
  Kokkos::deep_copy(recovered.views.vertex_displacement, state.views.vertex_displacement);
  Kokkos::deep_copy(recovered.views.vertex_rotation, state.views.vertex_rotation);
  Kokkos::deep_copy(recovered.views.element_triad, state.views.element_triad);
  Kokkos::deep_copy(recovered.views.interior, state.views.interior);
  recovered.in_plane = state.in_plane;
  recovered.turns = state.turns;
  const Structure& structure = model.structure();
  for_each_element_on_threads("mixbeam::recovered_rotation", structure, recovered.views,
                              [&](const ElementView& element) {
                                if (raised[structure.member_of(model.mesh(), element.local())]) recover(element);
                              });
  return recovered;
}

}  // namespace mixbeam
