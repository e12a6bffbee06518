/// The order of pivots in a sparse factorisation.
#pragma once

#include "nonlinear/linear/sparse_matrix.hpp"

#include <vector>

namespace mixbeam {

/// Place of each row in the order of pivots, counted from one, by nested dissection (METIS) of groups of rows that have
/// the same columns; empty where that has no use.
std::vector<int> dissection_order(const SparseMatrix& a);

}  // namespace mixbeam
