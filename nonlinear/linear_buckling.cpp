#include "nonlinear/linear_buckling.hpp"

#include "discretization/added_compliance.hpp"
#include "nonlinear/block_krylov.hpp"

#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace mixbeam {

namespace {

/// Of N L^2/EI and M L/EI in the states that tell a first estimate: far below buckling, which begins near ten.
constexpr double kFirstStress = 0.02;
/// Of the load factor nearest to zero, in the final differences: their error is its fourth power (times a small
/// number), and rounding grows with its inverse.
constexpr double kStep = 0.02;
/// Each repetition gains as much as the cap is above the forces at work, five digits: three reach rounding.
constexpr int kRefinements = 3;
/// See Stability.
constexpr double kNearlySymmetric = 1e-9, kNearlyReal = 1e-8;

class LinearBuckling {
 public:
  explicit LinearBuckling(BeamProblem& problem)
      : problem_(problem),
        assembler_(problem.assembler),
        unknowns_(assembler_),
        reference_(assembler_.reference_state()),
        scales_(assembler_.scales_of(reference_, 0.0)),
        response_(assembler_.create_vector()),
        work_(assembler_.create_vector()) {
    stiffness_ = tangent_at(reference_, 0.0);
    factorize();
    find_response();
  }

  std::vector<EigenMode> modes(int count) {
    const double stress = largest_stress();
    if (stress == 0.0) return {};
    std::vector<EigenMode> found = modes(1, kFirstStress / stress);
    if (found.empty()) return found;
    return modes(count, kStep * std::abs(found.front().eigenvalue));
  }

 private:
  /// All tangents have the cap of the reference state: else their differences would be those of their caps.
  std::vector<double> tangent_at(const State& state, double load_factor) {
    assembler_.residual(state, load_factor, work_);
    assembler_.use_scales(scales_);
    assembler_.tangent(state, load_factor);
    return unknowns_.reduce(assembler_, state).value;
  }
  State state_at(double load_factor) { return assembler_.apply(reference_, response_, load_factor); }

  void factorize() {
    on_root(unknowns_.root(), [&] {
      symmetric_ = asymmetry(unknowns_.matrix()) <= kNearlySymmetric;
      matrix_ = unknowns_.matrix();
      const auto kind = symmetric_ ? InertiaSolver::Kind::symmetric : InertiaSolver::Kind::general;
      solver_ = std::make_unique<InertiaSolver>(kind, matrix_);
      const InertiaSolver::Signs signs = solver_->factorize(matrix_);
      if (signs.null > 0 || signs.negative > 0)
        throw LinearSolverError("linear buckling needs a structure that is stable without loads");
    });
  }

  /// dx / d(load factor) at the reference state. Solved with the capped tangent and refined to the true one: where
  /// forces are shared according to stiffness the cap would shift them.
  void find_response() {
    problem_.linear_solver->factorize();
    MixedVector rhs = assembler_.create_vector();
    assembler_.load_derivative(reference_, 0.0, rhs);
    solve(rhs, response_);
    MixedVector correction = response_.clone(true);
    for (int i = 0; i < kRefinements; ++i) {
      added_strains(assembler_, correction, rhs);
      solve(rhs, correction);
      response_.update(1.0, correction, 1.0);
    }
  }
  void solve(const MixedVector& rhs, MixedVector& solution) {
    assembler_.use_scales(scales_);
    assembler_.condense(reference_, 0.0, rhs);
    DofVector& condensed = assembler_.condensed_residual();
    condensed.scale(-1.0);
    problem_.linear_solver->solve(condensed, solution.vertex_dofs());
    assembler_.recover(reference_, solution);
  }

  /// Largest of N L^2/EI and M L/EI per load factor.
  double largest_stress() const {
    const Structure& structure = assembler_.structure();
    const double L = structure.length, EI = structure.bending_reference;
    double largest = 0.0;
    for (const ElementBlock& block : structure.blocks)
      for (int e = 0; e < block.count; ++e) {
        const double* row =
            response_.interior().data() + block.increment_offset + static_cast<size_t>(e) * block.interior.increments();
        for (int i = 0; i < block.interior.relative_rotation(1); ++i)
          largest = std::max(largest, std::abs(row[i]) * (i < block.interior.moment(0) ? L * L : L) / EI);
      }
    return maximum_over_ranks(*assembler_.map()->getComm(), largest);
  }

  /// K_g = (4 D(t) - D(2t))/3 with central differences D of the internal part; loads are evaluated at factor zero there
  /// because a ramp has no negative side, and their own part, linear in the factor, comes from the reference state.
  std::vector<double> geometric_stiffness(double t) {
    std::vector<double> result(stiffness_.size(), 0.0);
    const auto add = [&](double factor, const std::vector<double>& k) {
      for (size_t i = 0; i < result.size(); ++i) result[i] += factor * k[i];
    };
    for (double sign : {1.0, -1.0}) {
      add(sign * 4.0 / (6.0 * t), tangent_at(state_at(sign * t), 0.0));
      add(-sign / (12.0 * t), tangent_at(state_at(sign * 2.0 * t), 0.0));
    }
    const double load_factor = std::min(t, 1.0);
    std::vector<double> by_loads = tangent_at(reference_, load_factor);
    for (size_t i = 0; i < by_loads.size(); ++i) result[i] += (by_loads[i] - stiffness_[i]) / load_factor;
    return result;
  }

  std::vector<EigenMode> modes(int count, double t) {
    const std::vector<double> geometric = geometric_stiffness(t);
    std::vector<double> inverse_factor;
    std::vector<std::vector<double>> y;
    int symmetric = 1;
    on_root(unknowns_.root(), [&] {
      SparseMatrix prestress = matrix_;
      prestress.value = geometric;
      symmetric = symmetric_ && asymmetry_of(prestress, t) <= kNearlySymmetric ? 1 : 0;
      KrylovProblem eigen;
      eigen.unknowns = unknowns_.count();
      eigen.symmetric = symmetric != 0;
      eigen.apply = [&](double* block, int columns) { apply(prestress, block, columns); };
      if (eigen.symmetric) eigen.inner = [&](const double* x, double* kx) { matrix_.multiply(x, kx); };
      for (RitzPair& pair : largest_eigenpairs(eigen, count)) {
        if (pair.value == 0.0 || std::abs(pair.imaginary) > kNearlyReal * std::abs(pair.value)) continue;
        inverse_factor.push_back(pair.value);
        y.push_back(std::move(pair.vector));
      }
    });
    int found = static_cast<int>(y.size());
    MPI_Bcast(&found, 1, MPI_INT, 0, unknowns_.root().communicator());
    MPI_Bcast(&symmetric, 1, MPI_INT, 0, unknowns_.root().communicator());
    inverse_factor.resize(found);
    y.resize(found);
    MPI_Bcast(inverse_factor.data(), found, MPI_DOUBLE, 0, unknowns_.root().communicator());
    if (found == 0) return {};
    return symmetric != 0 ? corrected(inverse_factor, y, t) : uncorrected(inverse_factor, y);
  }

  /// -K^-1 K_g
  void apply(const SparseMatrix& prestress, double* block, int columns) {
    const size_t n = unknowns_.count();
    std::vector<double> image(n * columns);
    for (int j = 0; j < columns; ++j) prestress.multiply(block + j * n, image.data() + j * n);
    std::transform(image.begin(), image.end(), block, [](double x) { return -x; });
    solver_->solve(block, columns);
  }

  /// That of K + t K_g: K_g alone has no scale.
  double asymmetry_of(const SparseMatrix& prestress, double t) {
    SparseMatrix together = matrix_;
    for (size_t i = 0; i < together.value.size(); ++i) together.value[i] += t * prestress.value[i];
    return asymmetry(together);
  }

  /// Weights of the compliance that the cap adds, between all modes, at one state: lower triangle, column-major.
  std::vector<double> added_at(const State& state, const std::vector<std::vector<double>>& y) {
    tangent_at(state, 0.0);
    const int m = static_cast<int>(y.size());
    std::vector<MixedVector> motion;
    for (const std::vector<double>& one : y) motion.push_back(complete_motion(assembler_, unknowns_, state, one));
    std::vector<double> weights(static_cast<size_t>(m) * m, 0.0);
    for (int j = 0; j < m; ++j)
      for (int i = j; i < m; ++i)
        weights[i + static_cast<size_t>(j) * m] = added_compliance(assembler_, motion[i], motion[j]);
    return weights;
  }

  /// Rayleigh-Ritz in the modes found (K-orthonormal), with the true compliance in K and in K_g.
  std::vector<EigenMode> corrected(const std::vector<double>& inverse_factor, const std::vector<std::vector<double>>& y,
                                   double t) {
    const int m = static_cast<int>(y.size());
    const std::vector<double> plus = added_at(state_at(t), y), minus = added_at(state_at(-t), y);
    std::vector<double> stiffness = added_at(reference_, y), prestress(stiffness.size());
    for (size_t i = 0; i < prestress.size(); ++i) prestress[i] = -(plus[i] - minus[i]) / (2.0 * t);
    for (int i = 0; i < m; ++i) {
      stiffness[i * (m + 1)] += 1.0;
      prestress[i * (m + 1)] += inverse_factor[i];
    }
    std::vector<double> values(m), work(4 * m + 1);
    int info = 0;
    Teuchos::LAPACK<int, double>().SYGV(1, 'V', 'L', m, prestress.data(), m, stiffness.data(), m, values.data(),
                                        work.data(), 4 * m + 1, &info);
    if (info != 0) throw LinearSolverError("the small eigenvalue problem failed: dsygv " + std::to_string(info));
    return sorted_modes(values, prestress, y);
  }

  /// Not symmetric: the factors stay low by what the cap does, about 1e-5 of them.
  std::vector<EigenMode> uncorrected(const std::vector<double>& inverse_factor,
                                     const std::vector<std::vector<double>>& y) {
    const int m = static_cast<int>(y.size());
    std::vector<double> identity(static_cast<size_t>(m) * m, 0.0);
    for (int i = 0; i < m; ++i) identity[i * (m + 1)] = 1.0;
    tangent_at(reference_, 0.0);
    return sorted_modes(inverse_factor, identity, y);
  }

  /// At the reference state.
  std::vector<EigenMode> sorted_modes(const std::vector<double>& inverse_factor, const std::vector<double>& weights,
                                      const std::vector<std::vector<double>>& y) {
    const int m = static_cast<int>(y.size());
    std::vector<MixedVector> motion;
    for (const std::vector<double>& one : y) motion.push_back(complete_motion(assembler_, unknowns_, reference_, one));
    std::vector<EigenMode> result;
    for (int k = 0; k < m; ++k) {
      MixedVector mode = combination(motion, &weights[static_cast<size_t>(k) * m]);
      normalize_mode(assembler_, mode);
      result.push_back({1.0 / inverse_factor[k], std::move(mode)});
    }
    std::stable_sort(result.begin(), result.end(), [](const EigenMode& a, const EigenMode& b) {
      return std::abs(a.eigenvalue) < std::abs(b.eigenvalue);
    });
    return result;
  }

  BeamProblem& problem_;
  Assembler& assembler_;
  IndependentUnknowns unknowns_;
  State reference_;
  ResidualScales scales_;
  MixedVector response_, work_;
  bool symmetric_ = true;  ///< rank 0
  std::vector<double> stiffness_;
  SparseMatrix matrix_;
  std::unique_ptr<InertiaSolver> solver_;
};

}  // namespace

std::vector<EigenMode> linear_buckling(BeamProblem& problem, int count) { return LinearBuckling(problem).modes(count); }

}  // namespace mixbeam
