#include "kernels/planar_block_loops.hpp"

namespace mixbeam {

template void allocate_planar_block<2>(const ElementBlock&, PlanarBlock&);
template void planar_residual_loop<2>(const ElementBlock&, const PlanarBlock&, const StructureViews&, const StateViews&,
                                      const ElementEquations&);
template void planar_tangent_loop<2>(const ElementBlock&, const PlanarBlock&, const StructureViews&, const StateViews&,
                                     const KernelView<const double*>&, const PlanarTangents&, const ElementEquations&);
template void planar_recover_loop<2>(const ElementBlock&, const PlanarBlock&, const KernelView<const double* [6]>&,
                                     const KernelView<double*>&);

}  // namespace mixbeam
