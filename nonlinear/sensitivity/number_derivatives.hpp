/// Derivatives of quantities with known adjoints with respect to numbers of a scene, theory (80): differences of the
/// equations at a fixed state.
#pragma once

#include "discretization/mesh/element_view.hpp"
#include "discretization/quantities/quantity_set.hpp"
#include "nonlinear/sensitivity/adjoint_operator.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

/// A number of a scene that can be varied on the same mesh.
struct SceneNumber {
  std::string name{};
  double step = 0.0;  ///< for differences of the equations at a fixed state
  /// Makes the scene with the number increased by `more`. Throws InputError for values that are not allowed.
  std::function<std::shared_ptr<const Scene>(double more)> scene_with{};
  /// Makes the quantities with the number increased by `more` in their formulas; empty: none of them contains it.
  std::function<QuantitySet(double more)> quantities_with{};
  bool is_of_pattern = false;  ///< named by a pattern, which omits it if it cannot vary to both sides
};

/// Residual of the equations of a state in a scene: rows of elements with loads, and of constraints.
struct StateRows {
  MixedVector spatial;    ///< rows of vertices not projected; those of N weighted
  DofVector constraints;  ///< contribution of supports and joints to projected rows

  explicit StateRows(const Model& model) : spatial(model.create_vector()), constraints(model.map()) {
    spatial.fill(0.0);
  }
  void add(double factor, const StateRows& other) {
    spatial.update(factor, other.spatial, 1.0);
    constraints.update(factor, other.constraints, 1.0);
  }
};

StateRows rows_at(const Model& model, const State& state, double load_factor);
/// Right-hand side of their spatial part.
StateDerivative derivative_of(const Model& model, const State& state, const StateRows& rows);

/// Differentiates quantities with respect to numbers: by one adjoint for each quantity; or directly, with an operator
/// that is not transposed and sizes of values, by the motion x_p of the state with the number for all quantities.
class NumberDerivatives {
 public:
  /// The equations with an increased number, or load factor (null).
  struct Moved {
    std::shared_ptr<const Model> model;
    double load_factor = 0.0;
    const SceneNumber* number = nullptr;
    double more = 0.0;
    const State* state = nullptr;  ///< fixed, or moved with the number
  };
  /// Evaluates q at the state of the equations, in the order in which adjoints are added.
  using Values = std::function<std::vector<double>(const Moved&)>;

  /// `at`: for the motions of the state, must outlive this object; `values`: empty if all are zero.
  NumberDerivatives(AdjointOperator& at, const State& state, Values values)
      : model_(at.model()), state_(in_space(state)), operator_(at), values_(std::move(values)) {}

  /// Adds the adjoint of the next quantity, with AdjointOperator::held_motion().
  void add(Adjoint adjoint, DofVector held);
  /// Adds the size of the next quantity for direct differentiation; its rounding is a share of the size.
  void add(double size);
  const Adjoint& adjoint(std::size_t which) const { return adjoints_[which]; }

  /// Derivative dq/dp of a quantity, and a bound of its error by rounding and by residuals of the equations.
  struct Derivative {
    double value = 0.0, noise = 0.0;
  };
  /// Differentiates every quantity. Throws InputError if the equations are not a smooth function of the number.
  std::vector<Derivative> by(const SceneNumber& number) const;
  std::vector<Derivative> by_load_factor(double step) const;

  static State in_space(State state) {
    state.in_plane = false;
    return state;
  }
  /// Computes t . rows; adds the magnitudes of its terms to `sizes`.
  double work(const Adjoint& adjoint, const StateRows& rows, double& sizes) const;

 private:
  using Move = std::function<Moved(double more)>;
  struct Differences;

  std::vector<Derivative> by(const std::string& name, double step, const Move& move) const;
  Differences differentiate(double step, const Move& move) const;
  Adjoint motion_under(const StateRows& rows) const;
  void require_alike(const Model& moved, const std::string& number) const;
  bool pair(const Differences& by, double step, std::vector<Derivative>& derivatives) const;
  double work_of_scales(const Adjoint& adjoint) const;
  double work_of_held(const Adjoint& adjoint, const DofVector& constraints) const;

  const Model& model_;
  State state_;
  AdjointOperator& operator_;
  Values values_;
  std::vector<Adjoint> adjoints_{};
  std::vector<DofVector> held_{};
  std::vector<double> rounding_{};  ///< (quantity): rounding of its derivative, times the step
};

}  // namespace mixbeam
