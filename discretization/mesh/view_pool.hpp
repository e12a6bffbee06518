/// Reuse of arrays that are allocated in every iteration: fresh pages of the system cost more than the computations in
/// them.
#pragma once

#include <Kokkos_Core.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace mixbeam {

/// Keeps every array that it has handed out until release_idle(). An array is free once no one else holds it. Call from
/// outside of kernels, from one thread at a time.
template <class View>
class ViewPool {
 public:
  /// Array of `size` rows (and one column, if the type leaves their number open); not initialised.
  View take(const std::string& label, size_t size) {
    for (const View& view : views_)
      if (view.use_count() == 1 && view.extent(0) == size) return view;
    constexpr bool has_columns = View::rank_dynamic == 2;
    if constexpr (has_columns)
      views_.emplace_back(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), size, 1);
    else
      views_.emplace_back(Kokkos::view_alloc(label, Kokkos::WithoutInitializing), size);
    return views_.back();
  }

  /// Frees the unused arrays.
  void release_idle() {
    const auto is_idle = [](const View& view) { return view.use_count() == 1; };
    views_.erase(std::remove_if(views_.begin(), views_.end(), is_idle), views_.end());
  }

 private:
  std::vector<View> views_;
};

}  // namespace mixbeam
