#include "nonlinear/multilevel/network_solver.hpp"

#include "nonlinear/linear/blas_setup.hpp"

#include <algorithm>
#include <cmath>

namespace mixbeam {

namespace {

/// Share of the error left if the residual is still too large then: twice the digits.
constexpr double kSmallReduction = 1e-13;
constexpr int kMostIterations = 300;
/// Most iterations of GMRES, to which each joint adds some.
constexpr int kMostOfGmres = 1000;
/// Factors of unsymmetric tangents up to this share of the largest are taken before GMRES is tried: a cube of 26^3
/// junctions.
constexpr double kBeforeGmres = 0.1;
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
  is_unstable_ = has_solved_ = false;
  method_ = Method::none;
  if (!may_iterate_) return factorize_directly();
  bool is_symmetric = true;
  try {
    number_nodes();
    is_symmetric = read_values();
    if (!is_symmetric)
      refuse("joints, supports at an angle, moments or loads that follow make the tangent unsymmetric", false);
    if (is_symmetric || !prefers_factors()) {
      set_matrix(matrix());
      method_ = is_symmetric ? Method::conjugate_gradients : Method::gmres;
    }
  } catch (const NegativeCurvature& error) {
    refuse(error.what(), is_symmetric);
  } catch (const std::runtime_error& error) {
    refuse(error.what(), false);
  }
  if (method_ == Method::none) factorize_directly();
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

void NetworkSolver::adopt_factors_of(Solver& other) {
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

/// Factors of large unsymmetric tangents take twice as long, GMRES as long as conjugate gradients.
bool NetworkSolver::prefers_factors() const {
  return direct_ != nullptr || factor_entries(system_) <= (gmres_fails_ ? 1.0 : kBeforeGmres) * most_fallback_entries_;
}

void NetworkSolver::factorize_directly() {
  method_ = Method::none;
  if (direct_ == nullptr) {
    if (factor_entries(system_) > most_fallback_entries_)
      throw LinearSolverError(objection_ + "; the network is too large for factors, which solve such states");
    direct_ = make_direct_solver(system_.matrix(), kSparseSolver, tolerance_, times_);
  }
  direct_->factorize();
  method_ = Method::factors;
}

void NetworkSolver::refuse(const std::string& why, bool is_unstable) {
  objection_ = objection_.empty() ? why : objection_ + "; " + why;
  is_unstable_ = is_unstable;
}

std::optional<long> NetworkSolver::negative_eigenvalues() {
  if (method_ == Method::factors) return direct_->negative_eigenvalues();
  if (is_unstable_) return 1;
  return has_solved_ && method_ == Method::conjugate_gradients ? std::optional<long>(0) : std::nullopt;
}

/// With spaces of an earlier tangent as long as they serve.
bool NetworkSolver::iterate_with_spaces(const DofVector& b, DofVector& x, double reduction) {
  const double digits = -std::log10(reduction);
  const int most = method_ == Method::gmres ? kMostOfGmres : kMostIterations;
  for (;;) {
    const bool may_begin_anew = !are_fresh_ && usual_rate_ > 0.0;
    const bool converged = iterate(
        b, x, reduction, may_begin_anew ? std::min(most, static_cast<int>(kGivenUp * usual_rate_ * digits)) : most);
    if (converged && usual_rate_ == 0.0) usual_rate_ = iterations_ / digits;
    if (converged && !are_fresh_ && iterations_ > kMostGrowth * usual_rate_ * digits) has_spaces_ = false;
    if (converged || are_fresh_) return converged;
    make_spaces(matrix());
  }
}

double NetworkSolver::solve(const DofVector& b, DofVector& x, double energy_reduction) {
  if (method_ == Method::conjugate_gradients || method_ == Method::gmres) {
    try {
      std::string why = "the iterative solver does not reach the tolerance of the residual";
      for (double reduction : {std::max(reduction_, energy_reduction), kSmallReduction}) {
        if (!iterate_with_spaces(b, x, reduction)) {
          why = std::string(method_ == Method::gmres ? "GMRES" : "conjugate gradients") + " did not converge";
          break;
        }
        const double error = backward_error(*system_.matrix(), x, b);
        if (error > std::max(tolerance_, energy_reduction)) continue;
        has_solved_ = true;
        return error;
      }
      refuse(why, false);
    } catch (const NegativeCurvature& error) {
      refuse(error.what(), method_ == Method::conjugate_gradients);
    }
    gmres_fails_ = gmres_fails_ || method_ == Method::gmres;
    method_ = Method::none;
  }
  if (method_ == Method::none) factorize_directly();
  return direct_->solve(b, x);
}

}  // namespace mixbeam
