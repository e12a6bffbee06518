#include "kernels/element_block_loops.hpp"
#include "kernels/element_recovery.hpp"

namespace mixbeam {

template void residual_loop<6, true>(const ElementBlock&, const StructureViews&, const StateViews&,
                                     const ElementEquations&);
template void tangent_loop<6, true>(const ElementBlock&, const StructureViews&, const StateViews&,
                                    const KernelView<const double*>&, const ElementEquations&);
template void recover_loop<6, true>(const ElementBlock&, const StateViews&, const ElementEquations&,
                                    const KernelView<const double* [6]>&, const KernelView<double*>&);

}  // namespace mixbeam
