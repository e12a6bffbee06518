/// Bit for bit the same, where every other comparison would let a rounding pass.
#pragma once

#include <cstring>

namespace mixbeam::test {

/// Of arrays and views: anything whose numbers lie one behind the other.
template <class A, class B>
auto same_bits(const A& a, const B& b) -> decltype(a.data() == b.data()) {
  static_assert(sizeof(*a.data()) == sizeof(*b.data()), "numbers of the same type");
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(*a.data())) == 0;
}

}  // namespace mixbeam::test
