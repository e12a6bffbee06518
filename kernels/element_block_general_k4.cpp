#include "kernels/element_block_loops.hpp"

namespace mixbeam {

template void residual_loop<4, true>(const ElementBlock&, const StructureViews&, const StateViews&,
                                     const ElementEquations&);
template void tangent_loop<4, true>(const ElementBlock&, const StructureViews&, const StateViews&,
                                    const KernelView<const double*>&, const ElementEquations&);

}  // namespace mixbeam
