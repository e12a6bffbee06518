/// How the loads of a scene run with the load factor: formulas may turn back, and with them the path.
#pragma once

#include "discretization/scene/amplitude.hpp"
#include "discretization/scene/scene.hpp"

#include <vector>

namespace mixbeam {

class LoadHistory {
 public:
  explicit LoadHistory(const Scene& scene);

  /// Whether all loads, prescribed motions and eigenstrains change in proportion between two load factors, none turning
  /// back: always where there are no formulas.
  bool is_straight(double from, double to) const;

 private:
  std::vector<Amplitude> amplitudes_;  ///< different ones; empty: there are no formulas
};

}  // namespace mixbeam
