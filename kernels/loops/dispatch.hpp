/// Dispatch from the run-time order of elements to compile-time sizes.
#pragma once

#include "kernels/element/layout.hpp"

#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace mixbeam {

/// Calls action(std::integral_constant<int, K>) for the order. Throws std::invalid_argument if it is out of range.
template <class Action, int K = 1>
void for_order(int order, Action&& action) {
  if (order == K) return action(std::integral_constant<int, K>());
  if constexpr (K < kMaximumOrder)
    for_order<Action, K + 1>(order, std::forward<Action>(action));
  else
    throw std::invalid_argument("element order " + std::to_string(order) + " is outside 1.." +
                                std::to_string(kMaximumOrder));
}

}  // namespace mixbeam
