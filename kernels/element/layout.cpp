#include "kernels/element/layout.hpp"

namespace mixbeam {

template struct ElementTables<1>;
template struct ElementTables<2>;
template struct ElementTables<3>;
template struct ElementTables<4>;
template struct ElementTables<5>;
template struct ElementTables<6>;
template struct ElementTables<7>;
template struct ElementTables<8>;

}  // namespace mixbeam
