#include "discretization/state/difference.hpp"

#include "kernels/element/element.hpp"
#include "kernels/math/constants.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>

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
  const size_t offset = block.interior_offset;
  const KernelView<int* [2]> vertices = block.vertices;
  const KernelView<double**> reference = block.reference;
  const KernelView<double*[3]> u1 = first.vertex_displacement, u2 = second.vertex_displacement;
  const KernelView<double*> interior1 = first.interior, interior2 = second.interior;
  Kokkos::parallel_for(
      "mixbeam::difference", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), KOKKOS_LAMBDA(int e) {
        const double h = reference(e, 0);
        const int a = vertices(e, 0), b = vertices(e, 1);
        const size_t place = offset + static_cast<size_t>(e) * layout.unknowns();
        const double* x1 = interior1.data() + place;
        const double* x2 = interior2.data() + place;
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

/// Every number is zero on all ranks but one.
void share(const Teuchos::Comm<int>& comm, std::vector<double>& numbers) {
  if (comm.getSize() == 1) return;
  std::vector<double> mine = numbers;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, static_cast<int>(mine.size()), mine.data(), numbers.data());
}

std::vector<double> compare_owned_elements(const Model& model, const State& first, const State& second) {
  const Structure& structure = model.structure();
  std::vector<double> numbers(kNumbers * model.mesh().elements.size(), 0.0);
  for (const ElementBlock& block : structure.blocks) {
    const KernelView<double* [kNumbers]> result("mixbeam::element_difference", block.count);
    compare_elements(block, first.views, second.views, result);
    for (int e = 0; e < block.count; ++e) {
      if (block.vertices(e, 0) >= structure.owned_vertices) continue;
      const auto element = static_cast<size_t>(structure.local_element_to_mesh[block.first_element + e]);
      std::copy_n(&result(e, 0), kNumbers, &numbers[kNumbers * element]);
    }
  }
  return numbers;
}

/// (vertex, 6): difference, displacement of the second state.
std::vector<double> compare_owned_vertices(const Model& model, const State& first, const State& second) {
  const Structure& structure = model.structure();
  std::vector<double> numbers(6 * static_cast<size_t>(model.mesh().vertices()), 0.0);
  for (int v = 0; v < structure.owned_vertices; ++v) {
    double* place = &numbers[6 * static_cast<size_t>(structure.local_vertex_to_global[v])];
    for (int i = 0; i < 3; ++i) {
      place[i] = second.views.vertex_displacement(v, i) - first.views.vertex_displacement(v, i);
      place[3 + i] = second.views.vertex_displacement(v, i);
    }
  }
  return numbers;
}

}  // namespace

StateDifference difference(const Model& model, const State& first, const State& second) {
  const auto& comm = *model.map()->getComm();
  std::vector<double> elements = compare_owned_elements(model, first, second);
  std::vector<double> vertices = compare_owned_vertices(model, first, second);
  share(comm, elements);
  share(comm, vertices);
  StateDifference all;
  all.elements.resize(elements.size() / kNumbers);
  std::copy(elements.begin(), elements.end(), reinterpret_cast<double*>(all.elements.data()));
  for (const ElementDifference& element : all.elements)
    all.largest_displacement = std::max(all.largest_displacement, element.middle);
  for (size_t v = 0; v < vertices.size(); v += 6) {
    all.vertex_displacement.push_back({vertices[v], vertices[v + 1], vertices[v + 2]});
    all.largest_displacement =
        std::max(all.largest_displacement, std::hypot(vertices[v + 3], vertices[v + 4], vertices[v + 5]));
  }
  return all;
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
    const size_t from = block.interior_offset, to = block.increment_offset;
    Kokkos::parallel_for(
        "mixbeam::increment_of_elements", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), KOKKOS_LAMBDA(int e) {
          double* d = interior.data() + to + static_cast<size_t>(e) * (unknowns + 3);
          const size_t place = from + static_cast<size_t>(e) * unknowns;
          for (int i = 0; i < unknowns; ++i) d[i] = b.interior(place + i) - a.interior(place + i);
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
  const size_t offset = block.interior_offset;
  const KernelView<int* [2]> vertices = block.vertices;
  const KernelView<double**> reference = block.reference;
  const KernelView<double*[4]> vertex_rotation = state.vertex_rotation, element_triad = state.element_triad;
  const KernelView<double*> interior = state.interior;
  Kokkos::parallel_for(
      "mixbeam::recovered_rotation", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), KOKKOS_LAMBDA(int e) {
        if (!raised(first_element + e)) return;
        double* x = interior.data() + offset + static_cast<size_t>(e) * layout.unknowns();
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
  const Structure& structure = model.structure();
  const KernelView<unsigned char*> marks("mixbeam::raised", structure.local_elements());
  for (int e = 0; e < structure.local_elements(); ++e) marks(e) = raised[structure.member_of(model.mesh(), e)];
  for (const ElementBlock& block : structure.blocks) recover(block, marks, recovered.views);
  return recovered;
}

}  // namespace mixbeam
