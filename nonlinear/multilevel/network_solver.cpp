#include "nonlinear/multilevel/network_solver.hpp"

#include "nonlinear/linear/blas_setup.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Where the residual is still too large then: twice the digits.
constexpr double kSmallReduction = 1e-13;
constexpr int kMostIterations = 300;
/// The same for MINRES and GMRES: at twice the critical load of a cubic lattice of 10,648 junctions MINRES takes 933.
constexpr int kMostKrylovIterations = 1000;
/// Spaces of an earlier tangent serve as long as they need at most so many times the iterations of fresh ones. (They
/// cost about as much as 40 iterations.)
constexpr double kMostGrowth = 1.5;
/// A solve with them that needs this many times as many is begun anew with fresh ones.
constexpr int kGivenUp = 3;

}  // namespace

NetworkSolver::NetworkSolver(const CondensedSystem& system, double residual_tolerance, PhaseTimes& times,
                             double reduction, double most_fallback_entries)
    : system_(system),
      tolerance_(residual_tolerance),
      reduction_(reduction),
      most_fallback_entries_(most_fallback_entries),
      times_(times) {
  set_up_blas();  // LAPACK finds the modes of aggregates
}

void NetworkSolver::factorize() {
  objection_.clear();
  is_direct_ = is_unstable_ = has_solved_ = by_krylov_ = false;
  try {
    number_nodes();
    read_values();
    set_matrix(matrix());
  } catch (const std::runtime_error& error) {
    refuse(error);
    give_up_conjugate_gradients();
  }
}

/// Coarse spaces of earlier tangents serve where there are some.
void NetworkSolver::set_matrix(const NetworkMatrix& matrix) {
  if (has_spaces_) {
    PhaseTimer timer(times_, "multilevel: finest level");
    hierarchy_->set_finest(matrix);
    are_fresh_ = false;
  } else
    make_spaces(matrix);
}

void NetworkSolver::take_over(LinearSolver& other) {
  auto* from = dynamic_cast<NetworkSolver*>(&other);
  if (from == nullptr || !from->has_spaces_) return;
  hierarchy_ = std::move(from->hierarchy_);
  ends_ = std::move(from->ends_);
  usual_rate_ = from->usual_rate_;
  has_spaces_ = true;
  free_.clear();
  from->has_spaces_ = false;
  from->free_.clear();
}

NetworkMatrix NetworkSolver::matrix() const {
  return {self_, [this](int link, double* room) { return link_blocks(link, room); }};
}

void NetworkSolver::make_spaces(const NetworkMatrix& matrix) {
  PhaseTimer timer(times_, "multilevel: coarse spaces");
  has_spaces_ = false;
  hierarchy_->set(matrix);
  has_spaces_ = are_fresh_ = true;
  usual_rate_ = {};
  ++spaces_made_;
}

void NetworkSolver::factorize_directly() {
  if (direct_ == nullptr) {
    if (factor_entries(system_) > most_fallback_entries_) throw LinearSolverError(objection_);
    direct_ = make_direct_solver(system_.matrix(), kSparseSolver, tolerance_, times_);
  }
  direct_->factorize();
  is_direct_ = true;
}

void NetworkSolver::refuse(const std::runtime_error& why) {
  objection_ = why.what();
  is_unstable_ = dynamic_cast<const NegativeCurvature*>(&why) != nullptr;
}

std::optional<long> NetworkSolver::negative_eigenvalues() const {
  if (is_direct_) return direct_->negative_eigenvalues();
  if (is_unstable_) return 1;
  return has_solved_ && !by_krylov_ ? std::optional<long>(0) : std::nullopt;
}

bool NetworkSolver::iterate(const DofVector& b, DofVector& x, double reduction, int most_iterations) {
  PhaseTimer timer(times_, "multilevel: iterations");
  begin_solve(b, x);
  const Level& finest = hierarchy_->finest();
  iterations_ = 0;
  double energy = 0.0, first = 0.0;
  bool converged = false;
  for (int k = 0; k <= most_iterations; ++k) {
    hierarchy_->precondition(r_, z_);
    const double last = energy;
    energy = finest.dot(r_, z_);
    if (k == 0) first = energy;
    if (energy <= reduction * reduction * first) {
      converged = energy >= 0.0;
      break;
    }
    if (k == 0)
      Kokkos::deep_copy(p_, z_);
    else {
      const double beta = energy / last;
      double* p = p_.data();
      const double* z = z_.data();
      multilevel::for_each(p_.extent(0), [=](int i) { p[i] = z[i] + beta * p[i]; });
    }
    finest.apply(p_, q_);
    const double curvature = finest.dot(p_, q_);
    if (!(curvature > 0.0))
      throw NegativeCurvature("the tangent has an eigenvalue below zero, the structure is unstable");
    ++iterations_;
    multilevel::add(energy / curvature, p_, x_);
    multilevel::add(-energy / curvature, q_, r_);
  }
  end_solve(x);
  return converged;
}

/// With spaces of an earlier tangent as long as they serve. `why` it does not converge.
bool NetworkSolver::iterate_with_spaces(const DofVector& b, DofVector& x, double reduction, std::string& why) {
  const double digits = -std::log10(reduction);
  const int most = by_krylov_ ? kMostKrylovIterations : kMostIterations;
  const auto converges = [&](int within) {
    return by_krylov_ ? iterate_krylov(b, x, reduction, within) : iterate(b, x, reduction, within);
  };
  double& usual = usual_rate_[by_krylov_ ? 1 : 0];
  if (!are_fresh_) {
    if (converges(usual > 0.0 ? std::min(most, static_cast<int>(kGivenUp * usual * digits)) : most)) {
      if (usual == 0.0) usual = iterations_ / digits;
      if (iterations_ > kMostGrowth * usual * digits) has_spaces_ = false;
      return true;
    }
    has_spaces_ = false;
    by_krylov_ ? begin_krylov() : make_spaces(matrix());
  }
  if (converges(most)) {
    if (usual == 0.0) usual = iterations_ / digits;
    return true;
  }
  const std::string method = !by_krylov_ ? "conjugate gradients" : (is_unstable_ ? "MINRES" : "GMRES");
  why = method + " did not converge in " + std::to_string(most) + " iterations";
  return false;
}

double NetworkSolver::solve(const DofVector& b, DofVector& x, double enough) {
  while (objection_.empty() || by_krylov_) {
    std::string why = "the iterative solver does not reach the tolerance of the residual";
    try {
      for (double reduction : {std::max(reduction_, enough), kSmallReduction}) {
        if (!iterate_with_spaces(b, x, reduction, why)) break;
        const double error = backward_error(*system_.matrix(), x, b);
        if (error > std::max(tolerance_, enough)) continue;
        has_solved_ = true;
        return error;
      }
    } catch (const NegativeCurvature& error) {
      refuse(error);
      give_up_conjugate_gradients();
      continue;
    }
    if (by_krylov_) {
      if (is_unstable_ || factor_entries(system_) > most_fallback_entries_)
        throw LinearSolverError(objection_ + "; " + why);
      give_up_gmres();
      break;
    }
    objection_ = why;
  }
  if (!is_direct_) factorize_directly();
  return direct_->solve(b, x);
}

}  // namespace mixbeam
