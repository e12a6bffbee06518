#include "discretization/state/difference.hpp"

#include "kernels/element/element.hpp"
#include "kernels/math/constants.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

namespace {

constexpr int kNumbers = 5;  ///< of ElementDifference
static_assert(sizeof(ElementDifference) == kNumbers * sizeof(double), "sent as an array of doubles");

/// Displacement along an element in Legendre polynomials, which are orthogonal. From u = mean of both ends +
/// xi (u_b - u_a) / 2 + h/2 sum_j beta_j B_j and B_j = (P_{j+1} - P_{j-1}) / (2 j + 1).
struct LegendreDisplacement {
  Vec coefficient[kMaximumOrder + 1];

  KOKKOS_INLINE_FUNCTION LegendreDisplacement(const Vec& start, const Vec& end, double length, int order,
                                              const double* bubbles) {
    for (int j = 0; j <= order; ++j) coefficient[j] = Vec{{0.0, 0.0, 0.0}};
    coefficient[0] = 0.5 * (start + end);
    coefficient[1] = 0.5 * (end - start);
    for (int j = 1; j < order; ++j) {
      const Vec part = (0.5 * length / (2 * j + 1)) * load_vector(bubbles + 3 * (j - 1));
      coefficient[j + 1] += part;
      coefficient[j - 1] += -part;
    }
  }
};

/// int |sum_j (a_j - b_j) P_j|^2 ds
KOKKOS_INLINE_FUNCTION double squared_norm(double length, int order, const Vec* a, const Vec* b) {
  double sum = 0.0;
  for (int j = 0; j <= order; ++j) {
    const Vec d = a[j] - b[j];
    sum += length / (2 * j + 1) * dot(d, d);
  }
  return sum;
}

/// |u| at xi = 0, where P_2 = -1/2, P_4 = 3/8, ...
KOKKOS_INLINE_FUNCTION double middle(int order, const Vec* u) {
  double P[kMaximumOrder + 1];
  legendre(order, 0.0, P);
  Vec sum{{0.0, 0.0, 0.0}};
  for (int j = 0; j <= order; ++j) sum += P[j] * u[j];
  return norm(sum);
}

/// (element of the block, kNumbers)
void compare_elements(const ElementBlock& block, const StateViews& first, const StateViews& second,
                      const KernelView<double* [kNumbers]>& result) {
  const InteriorLayout layout = block.interior;
  const int order = block.order;
  const ElementPlaces place_of = block.unknowns_at();
  const KernelView<int* [2]> vertices = block.vertices;
  const KernelView<double**> reference = block.reference;
  const KernelView<double*[3]> u1 = first.vertex_displacement, u2 = second.vertex_displacement;
  const KernelView<double*> interior1 = first.interior, interior2 = second.interior;
  Kokkos::parallel_for(
      "mixbeam::difference", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), KOKKOS_LAMBDA(int e) {
        const double h = reference(e, 0);
        const int a = vertices(e, 0), b = vertices(e, 1);
        const double *x1 = interior1.data() + place_of(e), *x2 = interior2.data() + place_of(e);
        const LegendreDisplacement d1(load_vector(&u1(a, 0)), load_vector(&u1(b, 0)), h, order, x1 + layout.bubble(1));
        const LegendreDisplacement d2(load_vector(&u2(a, 0)), load_vector(&u2(b, 0)), h, order, x2 + layout.bubble(1));
        Vec m1[kMaximumOrder + 1], m2[kMaximumOrder + 1], zero[kMaximumOrder + 1];
        for (int j = 0; j <= order; ++j) {
          m1[j] = load_vector(x1 + layout.moment(j));
          m2[j] = load_vector(x2 + layout.moment(j));
          zero[j] = Vec{{0.0, 0.0, 0.0}};
        }
        result(e, 0) = squared_norm(h, order, d2.coefficient, d1.coefficient);
        result(e, 1) = squared_norm(h, order, m2, m1);
        result(e, 2) = squared_norm(h, order, d2.coefficient, zero);
        result(e, 3) = squared_norm(h, order, m2, zero);
        result(e, 4) = middle(order, d2.coefficient);
      });
}

/// The vertex of the largest change on all ranks, the first of equal ones.
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
  for (const ElementBlock& block : structure.blocks) {
    const KernelView<double* [kNumbers]> result(reinterpret_cast<double*>(found.elements.data() + block.first_element),
                                                block.count);
    compare_elements(block, first.views, second.views, result);
  }
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
/// Rotation vectors below this have an axis of too few digits: that of `near` serves, of which 20 bits are kept, so
/// that its rounding does not count.
constexpr double kNoAxis = 1e-3, kAxisSteps = 1 << 20;

/// The rotation vector of `turn` that is nearest to `near`.
KOKKOS_INLINE_FUNCTION Vec rotation_near(const Quat& turn, const Vec& near) {
  const Vec least = log_quaternion(turn);
  const double angle = norm(least), length = norm(near);
  if (length < 0.25 * kTurn) return least;
  Vec axis{{least[0] / angle, least[1] / angle, least[2] / angle}};
  if (!(angle > kNoAxis))
    for (int i = 0; i < 3; ++i) axis[i] = std::nearbyint(near[i] / length * kAxisSteps) / kAxisSteps;
  const double turns = std::nearbyint((dot(axis, near) - dot(axis, least)) / kTurn);
  return least + (turns * kTurn) * axis;
}

void store(const Vec& v, double* place) {
  for (int i = 0; i < 3; ++i) place[i] = v[i];
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
        store(load_vector(&b.vertex_displacement(v, 0)) - load_vector(&a.vertex_displacement(v, 0)), d);
        const Quat turn =
            load_quaternion(&b.vertex_rotation(v, 0)) * conjugate(load_quaternion(&a.vertex_rotation(v, 0)));
        store(rotation_near(turn, load_vector(d + 3)), d + 3);
      });
  for (const ElementBlock& block : structure.blocks) {
    const int unknowns = block.interior.unknowns(), first_element = block.first_element;
    const ElementPlaces from = block.unknowns_at(), to = block.increments_at();
    Kokkos::parallel_for(
        "mixbeam::increment_of_elements", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), KOKKOS_LAMBDA(int e) {
          double* d = interior.data() + to(e);
          for (int i = 0; i < unknowns; ++i) d[i] = b.interior(from(e) + i) - a.interior(from(e) + i);
          const Quat turn = conjugate(load_quaternion(&a.element_triad(first_element + e, 0))) *
                            load_quaternion(&b.element_triad(first_element + e, 0));
          store(rotation_near(turn, load_vector(d + unknowns)), d + unknowns);
        });
  }
  return increment;
}

namespace {

/// log(exp(-psi) Lambda_lo^T Lambda_V Lambda_0) at an end, see EndRotation.
KOKKOS_INLINE_FUNCTION Vec jump_at_end(int end, int order, const double* psi_modes, const Quat& triad,
                                       const Quat& vertex) {
  Vec psi{{0.0, 0.0, 0.0}};
  for (int j = 1; j < order; ++j) psi += end_value(end, j) * load_vector(psi_modes + 3 * (j - 1));
  return log_quaternion(conjugate(exp_quaternion(psi)) * conjugate(triad) * vertex);
}

/// `raised`: (local element).
void recover(const ElementBlock& block, const KernelView<const unsigned char*>& raised, const StateViews& state) {
  const InteriorLayout layout = block.interior;
  const int order = block.order,
            end_triad[2] = {block.reference_layout.end_triad(0), block.reference_layout.end_triad(1)};
  const int first_element = block.first_element;
  const ElementPlaces place_of = block.unknowns_at();
  const KernelView<int* [2]> vertices = block.vertices;
  const KernelView<double**> reference = block.reference;
  const KernelView<double*[4]> vertex_rotation = state.vertex_rotation, element_triad = state.element_triad;
  const KernelView<double*> interior = state.interior;
  Kokkos::parallel_for(
      "mixbeam::recovered_rotation", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), KOKKOS_LAMBDA(int e) {
        if (!raised(first_element + e)) return;
        double* x = interior.data() + place_of(e);
        const Quat triad = load_quaternion(&element_triad(first_element + e, 0));
        Vec top{{0.0, 0.0, 0.0}};
        for (int end = 0; end < 2; ++end) {
          const Quat vertex =
              load_quaternion(&vertex_rotation(vertices(e, end), 0)) * load_quaternion(&reference(e, end_triad[end]));
          top += (0.5 * end_value(end, order - 1)) *
                 jump_at_end(end, order, x + layout.relative_rotation(1), triad, vertex);
        }
        double* psi = x + layout.relative_rotation(order - 1);
        double* bubble = x + layout.bubble(order - 1);
        const Vec slope = rotation_matrix(triad) * cross(top, Vec{{1.0, 0.0, 0.0}});
        for (int i = 0; i < 3; ++i) {
          psi[i] += top[i];
          bubble[i] += slope[i];
        }
      });
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
  const KernelView<unsigned char*> marks("mixbeam::raised", structure.local_elements());
  for (int e = 0; e < structure.local_elements(); ++e) marks(e) = raised[structure.member_of(model.mesh(), e)];
  for (const ElementBlock& block : structure.blocks) recover(block, marks, recovered.views);
  return recovered;
}

}  // namespace mixbeam
