#include "nonlinear/multilevel/positive_part.hpp"

#include "nonlinear/linear/blas_setup.hpp"

#include <algorithm>

extern "C" void dsyev_(const char*, const char*, const int*, double*, const int*, double*, double*, const int*, int*);

namespace mixbeam {

namespace {

constexpr int kNode = 6, kLink = 12;  ///< unknowns

/// Eigenvalues below zero by more than this share of the largest one are no rounding: those of rigid motions are zero.
constexpr double kNegative = 1e-12;

/// Takes the negative eigenvalues out of a symmetric matrix (n x n, at most kLink); false where there are none.
bool take_out_negative(int n, double* matrix) {
  double vectors[kLink * kLink], value[kLink], work[8 * kLink];
  std::copy_n(matrix, n * n, vectors);
  const int size = 8 * kLink;
  int info = 0;
  {
    const auto turn = turn_for_blas();
    dsyev_("V", "L", &n, vectors, &n, value, work, &size, &info);
  }
  if (info != 0) throw std::runtime_error("LAPACK's dsyev did not find the eigenvalues of a link");
  if (value[0] >= -kNegative * value[n - 1]) return false;
  for (int q = 0; q < n && value[q] < 0.0; ++q)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) matrix[n * j + i] -= value[q] * vectors[n * q + i] * vectors[n * q + j];
  return true;
}

}  // namespace

PositivePart::PositivePart(const NetworkMatrix& matrix, size_t links)
    : links_(matrix.links), self_(multilevel::numbers(matrix.self.extent(0))), positive_(links) {
  Kokkos::deep_copy(self_, matrix.self);
  multilevel::for_each(self_.extent(0) / (kNode * kNode),
                       [&](int v) { take_out_negative(kNode, self_.data() + kNode * kNode * static_cast<size_t>(v)); });
  multilevel::for_each(links, [&](int l) {
    double room[kLink * kLink], full[kLink * kLink];
    const LinkBlocks link = links_(l, room);
    for (int j = 0; j < kNode; ++j)
      for (int i = 0; i < kNode; ++i) {
        full[kLink * j + i] = link.first[link.first_stride * j + i];
        full[kLink * (kNode + j) + kNode + i] = link.second[link.second_stride * j + i];
        full[kLink * (kNode + j) + i] = full[kLink * i + kNode + j] =
            link.coupling[link.coupling_row * i + link.coupling_column * j];
      }
    if (take_out_negative(kLink, full)) positive_[l].assign(full, full + kLink * kLink);
  });
}

LinkBlocks PositivePart::blocks(int link, double* room) const {
  if (positive_[link].empty()) return links_(link, room);
  const double* first = positive_[link].data();
  const double* second = first + kLink * kNode;
  return {first, second, second + kNode, kLink, kLink, 1, kLink};
}

}  // namespace mixbeam
