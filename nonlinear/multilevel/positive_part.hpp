/// The matrix of a network without what compression takes from its links: positive, at every load.
#pragma once

#include "nonlinear/multilevel/hierarchy.hpp"

namespace mixbeam {

/// Of each link and of each node's own block the part with positive eigenvalues. The original must not be gone by then.
class PositivePart {
 public:
  PositivePart(const NetworkMatrix& matrix, size_t links);
  NetworkMatrix matrix() const {
    return {self_, [this](int link, double* room) { return blocks(link, room); }};
  }

 private:
  LinkBlocks blocks(int link, double* room) const;

  LinkSource links_;
  KernelView<double*> self_;
  std::vector<std::vector<double>> positive_;  ///< (link): where it differs; column-major
};

}  // namespace mixbeam
