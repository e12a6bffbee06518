#include "discretization/state/recovered_rotation.hpp"

#include "kernels/element/kinematics.hpp"

namespace mixbeam {

namespace {

/// log(exp(-psi) Lambda_lo^T Lambda_V Lambda_0) at an end, see EndRotation.
KOKKOS_INLINE_FUNCTION Vec jump_at_end(int end, int order, const double* psi_modes, const Quat& triad,
                                       const Quat& vertex) {
  Vec psi{{0.0, 0.0, 0.0}};
  for (int j = 1; j < order; ++j) psi += end_value(end, j) * load_vector(psi_modes + 3 * (j - 1));
  return log_quaternion(conjugate(exp_quaternion(psi)) * conjugate(triad) * vertex);
}

void recover(const ElementBlock& block, const KernelView<const unsigned char*>& raised, const StateViews& state) {
  const InteriorLayout layout = block.interior;
  const int order = block.order,
            end_triad[2] = {block.reference_layout.end_triad(0), block.reference_layout.end_triad(1)};
  const int first_element = block.first_element;
  const size_t offset = block.interior_offset;
  const KernelView<int*> member = block.member;
  const KernelView<int* [2]> vertices = block.vertices;
  const KernelView<double**> reference = block.reference;
  const KernelView<double*[4]> vertex_rotation = state.vertex_rotation, element_triad = state.element_triad;
  const KernelView<double*> interior = state.interior;
  Kokkos::parallel_for(
      "mixbeam::recovered_rotation", Kokkos::RangePolicy<ExecutionSpace>(0, block.count), KOKKOS_LAMBDA(int e) {
        if (!raised(member(e))) return;
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
  const KernelView<unsigned char*> marks("mixbeam::raised", raised.size());
  for (size_t m = 0; m < raised.size(); ++m) marks(m) = raised[m];
  for (const ElementBlock& block : model.structure().blocks) recover(block, marks, recovered.views);
  return recovered;
}

}  // namespace mixbeam
