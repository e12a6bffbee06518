#include "kernels/math/gauss.hpp"
#include "kernels/math/constants.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace mixbeam {

namespace {

void compute_gauss_rule(int n, double* points, double* weights) {
  constexpr int newton_steps = 6;  // quadratic from below 1e-2: five updates reach round-off; the last gives the slope
  for (int i = 0; i < (n + 1) / 2; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (n + 0.5));
    double slope = 0.0;
    for (int step = 0; step < newton_steps; ++step) {
      double p = 1.0, before = 0.0;
      for (int j = 0; j < n; ++j) {
        const double next = ((2 * j + 1) * x * p - j * before) / (j + 1);
        before = p;
        p = next;
      }
      slope = n * (x * p - before) / (x * x - 1.0);
      if (step + 1 < newton_steps) x -= p / slope;
    }
    if (2 * i + 1 == n) x = 0.0;
    points[i] = -x;
    points[n - 1 - i] = x;
    weights[i] = weights[n - 1 - i] = 2.0 / ((1.0 - x * x) * slope * slope);
  }
}

/// Rules that elements and their samples request repeatedly.
constexpr int kMostPoints = 16;
struct GaussRules {
  std::array<std::array<double, kMostPoints>, kMostPoints + 1> points{}, weights{};
  GaussRules() {
    for (int n = 1; n <= kMostPoints; ++n) compute_gauss_rule(n, points[n].data(), weights[n].data());
  }
};

}  // namespace

void gauss_rule(int n, double* points, double* weights) {
  static const GaussRules rules;
  if (n > kMostPoints) return compute_gauss_rule(n, points, weights);
  std::copy_n(rules.points[n].data(), n, points);
  std::copy_n(rules.weights[n].data(), n, weights);
}

}  // namespace mixbeam
