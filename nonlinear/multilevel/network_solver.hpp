/// Chooses the solver for the tangents of a model; and the iterative one, for networks whose factors are too large:
/// conjugate gradients with a Hierarchy of coarse spaces, theory (64). Open this first.
#pragma once

#include "nonlinear/linear/chain_solver.hpp"
#include "nonlinear/multilevel/hierarchy.hpp"

namespace mixbeam {

/// Solves what chains leave by conjugate gradients, and by GMRES where the matrix is unsymmetric and its factors are
/// large. Aggregates are kept, and so are coarse spaces and their matrices until iterations have grown by half or
/// reset_factors() is called. Where neither can be done, in unstable states as a rule, and where the iteration does not
/// converge, factors are taken; a LinearSolverError says why where they are too large.
class NetworkSolver : public LinearSolver {
 public:
  /// Share of the error left, in energy, if no other number is given: Newton's method converges as with factors.
  static constexpr double kReduction = 1e-8;

  /// Factors with more entries are not taken: 8 GB.
  static constexpr double kMostFallbackEntries = 1e9;

  NetworkSolver(const CondensedSystem& system, double residual_tolerance, PhaseTimes& times,
                double reduction = kReduction, double most_fallback_entries = kMostFallbackEntries);

  /// Factors are at hand: iteration is for where it is allowed.
  void keep_factors_at_hand() { has_factors_at_hand_ = true; }

  void factorize() override;
  double solve(const DofVector& b, DofVector& x, double energy_reduction = 0.0) override;
  bool iterates() const override { return !has_factors_at_hand_; }
  bool tries_iteration() const override { return true; }
  void allow_iteration(bool allowed) override { may_iterate_ = allowed || !has_factors_at_hand_; }
  bool counts_by_solves() const override { return iterates() || method_ == Method::conjugate_gradients; }
  /// Counts by factors if there are some; else by the solves with the last matrix, which have met none, or at least
  /// one.
  std::optional<long> negative_eigenvalues() override;
  void reset_factors() override {
    has_spaces_ = false;
    if (direct_ != nullptr) direct_->reset_factors();
  }
  void adopt_factors_of(Solver& other) override;

  /// Iterations of the last solve.
  int iterations() const { return iterations_; }
  /// How often coarse spaces were made.
  int spaces_made() const { return spaces_made_; }
  /// Why factors were taken, or would have been if they were not too large; empty where the last matrix could be
  /// iterated with.
  const std::string& objection() const { return objection_; }

 private:
  void number_nodes();
  std::vector<unsigned char> free_rows() const;
  bool has_free_row(int vertex) const;
  Halo number_ghosts(int nodes);
  LinkEnds find_links();
  bool read_values();
  LinkBlocks link_blocks(int link, double* room) const;

  NetworkMatrix matrix() const;
  void set_matrix(const NetworkMatrix& matrix);
  void make_spaces(const NetworkMatrix& matrix);
  bool iterate_with_spaces(const DofVector& b, DofVector& x, double reduction);
  bool prefers_factors() const;
  void factorize_directly();
  void refuse(const std::string& why, bool is_unstable);

  struct Iteration;
  struct Column;
  void begin_solve(const DofVector& b, DofVector& x);
  void end_solve(DofVector& x);
  bool iterate(const DofVector& b, DofVector& x, double reduction, int most_iterations);
  bool conjugate_gradients(double reduction, int most_iterations);
  bool gmres(double reduction, int most_iterations);
  void multiply(const LevelVector& x, const LevelVector& y) const;
  /// Turns the spatial forces and moments of a vertex to the axes of a support at an angle, and its rows back, with
  /// stiff springs in place of prescribed motions.
  struct TurnedRows {
    int vertex = 0;  ///< among those that remain
    double projection[kVertexDofs][kVertexDofs] = {}, back[kVertexDofs][kVertexDofs] = {};
    bool keeps(const unsigned char* free) const;
  };
  void find_turned_rows();
  static void set_springs(TurnedRows& turned, const unsigned char* free, const double* stiffness, size_t width, int own,
                          double* left);
  void turn_rows(const LevelVector& rows) const;

  const CondensedSystem& system_;
  double tolerance_, reduction_, most_fallback_entries_;
  PhaseTimes& times_;
  std::vector<unsigned char> free_;    ///< (row, then column of other ranks): 1 where it is coupled with others
  std::vector<int> node_;              ///< (vertex of those): its place in the hierarchy, -1: has no free row
  std::vector<int> vertex_;            ///< (place)
  std::vector<int> link_;              ///< (link of the network): its number among those of the system
  std::vector<unsigned char> masked_;  ///< (link of the network): 1 where an end has a row that is not free
  std::vector<std::array<int, 2>> link_vertices_;
  LinkMatrices<kVertexDofs> matrices_;
  KernelView<double*> self_;
  LinkEnds ends_;  ///< of the network that hierarchy_ was made for
  std::unique_ptr<Hierarchy> hierarchy_;
  LevelVector r_, x_, z_, p_, q_;
  std::vector<TurnedRows> turned_;
  std::vector<int> turned_of_;  ///< (vertex that remains): -1 where none
  std::unique_ptr<LinearSolver> direct_;
  std::string objection_;
  enum class Method { none, conjugate_gradients, gmres, factors };
  Method method_ = Method::none;  ///< that solves with the last matrix
  bool is_unstable_ = false, has_solved_ = false;
  bool has_factors_at_hand_ = false, may_iterate_ = true;
  bool gmres_fails_ = false;  ///< with some earlier matrix
  int iterations_ = 0;
  bool has_spaces_ = false;  ///< that serve the next tangent
  bool are_fresh_ = false;   ///< made for the present one
  double usual_rate_ = 0.0;  ///< iterations for a digit, of the first solve with them
  int spaces_made_ = 0;
};

/// 8 bytes each: 0.8 GB, a cube of 26^3 junctions.
inline constexpr double kMostFactorEntries = 1e8;
/// Entries of the factors of what chains leave, roughly.
double factor_entries(const CondensedSystem& system);
/// Counts the entries of factors from the neighbours of each vertex alone: (vertex, and one more) first of them.
double factor_entries(const std::vector<int>& start, const std::vector<int>& next);
/// Whether stable states of a network with factors of that size take less time by iteration.
bool is_quicker_by_iteration(const CondensedSystem& system, double factor_entries);

/// The solver for the tangents of a model. `method`: kAutomatic, kIterative, or as make_direct_tangent_solver.
std::unique_ptr<TangentSolver> make_tangent_solver(const Model& model, const std::string& method,
                                                   double residual_tolerance);

}  // namespace mixbeam
