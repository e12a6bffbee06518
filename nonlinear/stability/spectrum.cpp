// Modes and their corrected eigenvalues: the part of Stability that looks at more than signs.
#include "nonlinear/stability/nearest_eigenvalue.hpp"
#include "nonlinear/stability/stability.hpp"

#include "discretization/mesh/element_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace mixbeam {

namespace {

/// A Ritz value is real when its imaginary part is rounding.
constexpr double kReal = 1e-8;
/// Where rounding leaves less of an eigenvalue than this share of what counts as zero, its critical load is known to
/// ten digits.
constexpr double kRoundingMatters = 0.1;
/// Motion (largest rotation, or displacement over the length) of the largest of the differences below, and these: parts
/// of it and their weights, which leave an error of its sixth power over 64 * 7!. Rounding is multiplied by 200.
constexpr double kDifferenceMotion = 1.0 / 32.0;
constexpr std::array<std::array<double, 2>, 3> kDifferences = {
    {{1.0, 1.0 / 45.0}, {0.5, -20.0 / 45.0}, {0.25, 64.0 / 45.0}}};
/// What is left of an error, of what counts as zero: states are equilibria to 1e-11.
constexpr double kVariationError = 1e-2;
/// Residuals of modes as results, and of those that only span a space.
constexpr double kExactModes = 1e-9, kRoughModes = 1e-2;

/// Inverse iterations with the vectors of a space before eigenvalues are taken in it.
constexpr int kSpaceIterations = 2;

bool is_real(const RitzPair& pair) { return std::abs(pair.imaginary) <= kReal * std::abs(pair.value); }

}  // namespace

/// Numbers of rank 0 on every rank; vectors stay there.
void Stability::share(Pairs& pairs) const {
  MPI_Comm communicator = unknowns_->root().communicator();
  int found = static_cast<int>(pairs.size());
  MPI_Bcast(&found, 1, MPI_INT, 0, communicator);
  pairs.resize(found);
  for (Pair& pair : pairs) {
    double numbers[3] = {pair.value, pair.error, pair.converged ? 1.0 : 0.0};
    MPI_Bcast(numbers, 3, MPI_DOUBLE, 0, communicator);
    pair.value = numbers[0];
    pair.error = numbers[1];
    pair.converged = numbers[2] == 1.0;
  }
}

/// Uses the factors that inertia() left.
Stability::Pairs Stability::nearest(const StabilityResult& stability, int count, double tolerance) {
  Pairs pairs;
  on_root(unknowns_->root(), [&] {
    InertiaSolver& factors = solver(stability);
    const double shift = stability.shift;
    KrylovProblem problem;
    problem.unknowns = unknowns_->count();
    problem.symmetric = stability.symmetric;
    problem.tolerance = tolerance;
    problem.apply = [&](double* block, int columns) { factors.solve(block, columns); };
    std::vector<RitzPair> right = largest_eigenpairs(problem, count);
    right.erase(std::remove_if(right.begin(), right.end(), [](const RitzPair& p) { return !is_real(p); }), right.end());
    for (const RitzPair& pair : right)
      pairs.push_back({1.0 / pair.value - shift,
                       pair.error / std::abs(pair.value) + rounding_level(unknowns_->matrix(), pair.vector),
                       pair.converged, pair.vector});
    if (stability.symmetric) return;
    problem.apply = [&](double* block, int columns) { factors.solve(block, columns, true); };
    const std::vector<RitzPair> left = largest_eigenpairs(problem, count);
    for (size_t i = 0; i < right.size(); ++i) {
      const auto distance = [&](const RitzPair& pair) { return std::abs(pair.value - right[i].value); };
      pairs[i].left = std::min_element(left.begin(), left.end(), [&](const RitzPair& a, const RitzPair& b) {
                        return distance(a) < distance(b);
                      })->vector;
      pairs[i].error /= std::max(kReal, std::abs(dot_product(pairs[i].left, pairs[i].vector)));
    }
  });
  share(pairs);
  return pairs;
}

namespace {

/// Of those that StabilityResult::negative counts before eigenvalues are corrected.
template <class Pairs>
int number_counted(const Pairs& pairs, const StabilityResult& stability) {
  return static_cast<int>(
      std::count_if(pairs.begin(), pairs.end(), [&](const auto& pair) { return pair.value < -stability.shift; }));
}

/// Eigenvalues as corrected in place of those of the capped tangent, `before` of them negative, and those that are zero
/// apart.
void recount(int before, double zero, Spectrum& spectrum) {
  StabilityResult& stability = spectrum.stability;
  stability.negative = std::max(0, stability.negative - before);  // rounding may turn the sign of an inverse
  stability.null = 0;
  for (const EigenMode& mode : spectrum.modes) {
    if (std::abs(mode.eigenvalue) <= std::max(zero, mode.error))
      ++stability.null;
    else if (mode.eigenvalue < 0.0)
      ++stability.negative;
  }
  stability.sign = sign_of(stability.negative, stability.null);
}

/// The real eigenvalues known to be negative; the sign of the determinant tells whether one is missing.
void recount_unsymmetric(Spectrum& spectrum) {
  StabilityResult& stability = spectrum.stability;
  stability.negative = 0;
  for (const EigenMode& mode : spectrum.modes)
    if (mode.eigenvalue < -mode.error) ++stability.negative;
  const bool is_odd = stability.negative % 2 == 1;
  if (stability.sign != 0 && is_odd != (stability.sign < 0)) ++stability.negative;
}

}  // namespace

Spectrum Stability::spectrum(const State& state, double load_factor, int count) {
  const Look look = assemble(state, load_factor);
  Spectrum result{inertia(look), {}};
  Pairs pairs = nearest(result.stability, count, kExactModes);
  const auto is_zero = [&](const Pair& pair) { return std::abs(pair.value) <= std::max(look.zero, pair.error); };
  if (result.stability.symmetric && !pairs.empty() && is_zero(pairs.front()) && result.stability.shift == 0.0) {
    result.stability = inertia(look, kShiftBesideZero);  // all others are lost in the rounding of so large an inverse
    pairs = nearest(result.stability, count, kExactModes);
  }
  result.modes = corrected_modes(look, result.stability, pairs);
  if (!result.stability.symmetric)
    recount_unsymmetric(result);
  else if (std::all_of(pairs.begin(), pairs.end(), [](const Pair& pair) { return pair.converged; }))
    recount(number_counted(pairs, result.stability), look.zero, result);
  return result;
}

namespace {

/// Derivative of the equations of equilibrium, unscaled, by differences of the residual, which holds compliances and no
/// stiffness: no large entries in whose rounding small ones are lost. Rows of N and M are zero.
MixedVector derivative_along(const Model& model, const State& state, double load_factor, const MixedVector& motion) {
  const Structure& structure = model.structure();
  const LargestParts size = largest_parts(*model.map()->getComm(), motion.vertex());
  const double unit = kDifferenceMotion / std::max(size.moved / structure.length, size.turned);
  MixedVector sum = model.create_vector(), rows = model.create_vector();
  for (const auto& [part, weight] : kDifferences)
    for (double step : {part * unit, -part * unit}) {
      const EvaluationPoint point = mixed_residual(model, model.apply(state, motion, step), load_factor, rows);
      unscale_rows(model, point.scales, rows);
      sum.update(0.5 * weight / step, rows, 1.0);
    }
  const KernelView<double*> interior = sum.writable_interior(true);
  for_each_element(structure, [&](const ElementView& element) {
    std::fill_n(element.increments_in(interior), element.layout().relative_rotation(1), 0.0);
  });
  return sum;
}

}  // namespace

/// Of the mixed potential in motions that complete_motion() made of the vectors of `pairs`, as a matrix; symmetric
/// tangents only. Their rows of N and M are solved with the compliance of the tangent, which leaves that of the cap.
std::vector<double> Stability::second_variations(const Tangent& tangent, const std::vector<MixedVector>& motions,
                                                 const Pairs& pairs) const {
  const int m = static_cast<int>(motions.size());
  const Model& model = tangent.model();
  const EvaluationPoint& point = tangent.point();
  std::vector<double> form(static_cast<size_t>(m) * m, 0.0), of_vertices(form.size(), 0.0);
  for (int j = 0; j < m; ++j) {
    const MixedVector derivative = derivative_along(model, point.state, point.load_factor, motions[j]);
    const std::vector<double> rows = unknowns_->reduced_rows(derivative.vertex_dofs());
    derivative.vertex_dofs().putScalar(0.0);
    for (int i = 0; i < m; ++i) {
      if (unknowns_->is_root()) of_vertices[i + static_cast<size_t>(j) * m] = dot_product(pairs[i].vector, rows);
      form[i + static_cast<size_t>(j) * m] =
          motions[i].inner_product(derivative) + cap_compliance_form(model, tangent.cap(), motions[i], motions[j]);
    }
  }
  MPI_Bcast(of_vertices.data(), m * m, MPI_DOUBLE, 0, unknowns_->root().communicator());
  for (size_t i = 0; i < form.size(); ++i) of_vertices[i] += form[i];
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < m; ++j) form[i + j * m] = 0.5 * (of_vertices[i + j * m] + of_vertices[j + i * m]);
  return form;
}

/// Rayleigh-Ritz in the modes found, with the true compliance: degenerate modes separate as they should.
std::vector<EigenMode> Stability::corrected_modes(const Look& look, const StabilityResult& stability,
                                                  const Pairs& pairs) {
  const Model& model = problem_.model;
  const Tangent& tangent = look.tangent;
  const double zero = look.zero;
  const auto of_cap = [&](const MixedVector& a, const MixedVector& b) {
    return cap_compliance_form(model, tangent.cap(), a, b);
  };
  const int m = static_cast<int>(pairs.size());
  std::vector<MixedVector> found;
  std::vector<double> values, error, weights(static_cast<size_t>(m) * m, 0.0);
  for (const Pair& pair : pairs) {
    found.push_back(complete_motion(tangent, *unknowns_, pair.vector));
    values.push_back(pair.value);
    error.push_back(pair.error);
  }
  if (stability.symmetric) {
    std::vector<double> form = weights;
    if (m > 0 && zero > 0.0 && error.front() > kRoundingMatters * zero) {
      form = second_variations(tangent, found, pairs);
      for (double& e : error) e = std::min(e, kVariationError * zero);
    } else {
      for (int i = 0; i < m; ++i) {
        for (int j = 0; j < m; ++j) form[i + j * m] = of_cap(found[i], found[j]);
        form[i * (m + 1)] += values[i];
      }
    }
    weights = small_eigenproblem(form, m);
    for (int i = 0; i < m; ++i) values[i] = form[i * (m + 1)];
  } else {
    for (int i = 0; i < m; ++i) {
      weights[i * (m + 1)] = 1.0;
      const double overlap =
          number_of_root(unknowns_->root(), [&] { return dot_product(pairs[i].left, pairs[i].vector); });
      values[i] += of_cap(complete_motion(tangent, *unknowns_, pairs[i].left), found[i]) / overlap;
    }
  }
  std::vector<int> order(m);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return std::abs(values[a]) < std::abs(values[b]); });
  std::vector<EigenMode> modes;
  for (int k : order) {
    MixedVector mode = combination(found, &weights[static_cast<size_t>(k) * m]);
    normalize_mode(model, mode);
    modes.push_back({values[k], std::move(mode), error[k], pairs[k].converged});
  }
  return modes;
}

namespace {

/// Places of the eigenvalues number first .. first + count - 1 among those found.
template <class Pairs>
std::vector<int> places_of(const Pairs& found, const StabilityResult& stability, int first, int count) {
  std::vector<int> order(found.size()), places;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return found[a].value < found[b].value; });
  const int lowest = stability.negative - number_counted(found, stability);
  for (int k = first - 1 - lowest; k < first - 1 - lowest + count; ++k)
    if (k >= 0 && k < static_cast<int>(order.size())) places.push_back(order[k]);
  return places;
}

}  // namespace

int SpaceValues::negative() const {
  return static_cast<int>(
      std::count_if(modes.begin(), modes.end(), [](const EigenMode& mode) { return mode.eigenvalue < 0.0; }));
}

CriticalSpace Stability::space_of(const State& state, double load_factor, int first, int count) {
  constexpr int kMore = 2;  // negative ones may be nearer to zero than those that come next
  const StabilityResult result = inertia(assemble(state, load_factor));
  if (!result.symmetric) return {};
  Pairs pairs = nearest(result, count + kMore, kRoughModes);
  CriticalSpace space;
  for (int place : places_of(pairs, result, first, count)) space.vectors.push_back(std::move(pairs[place].vector));
  space.size = static_cast<int>(space.vectors.size());
  return space.size == count ? space : CriticalSpace{};
}

namespace {

/// Gram-Schmidt, twice for its rounding; `images` are those under a linear operator and stay so.
void orthonormalize(std::vector<std::vector<double>>& columns, std::vector<std::vector<double>>& images) {
  for (size_t j = 0; j < columns.size(); ++j)
    for (int pass = 0; pass <= 2; ++pass) {
      const double scale = 1.0 / std::sqrt(dot_product(columns[j], columns[j]));
      for (std::vector<double>* v : {&columns[j], &images[j]})
        for (double& x : *v) x *= scale;
      for (size_t i = 0; i < j && pass < 2; ++i) {
        const double share = -dot_product(columns[i], columns[j]);
        add_multiple(share, columns[i], columns[j]);
        add_multiple(share, images[i], images[j]);
      }
    }
}

}  // namespace

/// Rayleigh-Ritz in K^-p B, theory (60), with the factors that inertia() left.
Stability::Pairs Stability::ritz_values(const StabilityResult& stability, const CriticalSpace& space) {
  const size_t m = space.size;
  Pairs pairs;
  on_root(unknowns_->root(), [&] {
    const size_t n = unknowns_->count();
    std::vector<std::vector<double>> columns = space.vectors, images;
    for (int i = 0; i < kSpaceIterations; ++i) {
      images = columns;
      std::vector<double> block;
      for (const std::vector<double>& x : columns) block.insert(block.end(), x.begin(), x.end());
      solver(stability).solve(block.data(), space.size);
      for (size_t j = 0; j < m; ++j) columns[j].assign(&block[j * n], &block[j * n] + n);
      orthonormalize(columns, images);
    }
    std::vector<double> projected(m * m);
    for (size_t i = 0; i < m; ++i)
      for (size_t j = 0; j < m; ++j) projected[i + j * m] = dot_product(columns[i], images[j]);
    const std::vector<double> weights = small_eigenproblem(projected, space.size);
    for (size_t k = 0; k < m; ++k) {
      std::vector<double> y(n, 0.0);
      for (size_t j = 0; j < m; ++j)
        for (size_t i = 0; i < n; ++i) y[i] += weights[j + k * m] * columns[j][i];
      const double error = rounding_level(unknowns_->matrix(), y);
      pairs.push_back({projected[k * (m + 1)] - stability.shift, error, true, std::move(y)});
    }
  });
  share(pairs);
  return pairs;
}

SpaceValues Stability::in_space(const State& state, double load_factor, const CriticalSpace& space) {
  const Look look = assemble(state, load_factor);
  const StabilityResult stability = inertia(look);
  if (!stability.symmetric) return {};
  const Pairs pairs = ritz_values(stability, space);
  SpaceValues seen{corrected_modes(look, stability, pairs), stability.negative - number_counted(pairs, stability)};
  std::stable_sort(seen.modes.begin(), seen.modes.end(),
                   [](const EigenMode& a, const EigenMode& b) { return a.eigenvalue < b.eigenvalue; });
  return seen;
}

}  // namespace mixbeam
