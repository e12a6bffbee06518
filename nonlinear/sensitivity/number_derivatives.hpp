/// Derivatives by numbers of a scene, of numbers whose adjoints are known, theory (80): differences of the equations of
/// a state that stays as it is.
#pragma once

#include "discretization/mesh/element_view.hpp"
#include "discretization/quantities/quantity_set.hpp"
#include "nonlinear/sensitivity/adjoint_operator.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

/// A number of a scene: what the scene is with other values of it, on the same mesh.
struct SceneNumber {
  std::string name{};
  double step = 0.0;  ///< for differences of the equations of a state that stays as it is
  /// With that much more of it. Throws InputError for values that are not allowed.
  std::function<std::shared_ptr<const Scene>(double more)> scene_with{};
  /// The same quantities with that much more of it in their formulas; empty: none of them has it.
  std::function<QuantitySet(double more)> quantities_with{};
  bool is_of_pattern = false;  ///< which leaves it out where it cannot move to both sides
};

/// The equations of a state in a scene as they stand: rows of elements with loads, and of constraints.
struct StateRows {
  MixedVector spatial;    ///< rows of vertices not projected; those of N weighted
  DofVector constraints;  ///< what supports and joints put into projected rows

  explicit StateRows(const Model& model) : spatial(model.create_vector()), constraints(model.map()) {
    spatial.fill(0.0);
  }
  void add(double factor, const StateRows& other) {
    spatial.update(factor, other.spatial, 1.0);
    constraints.update(factor, other.constraints, 1.0);
  }
};

StateRows rows_at(const Model& model, const State& state, double load_factor);
/// The right-hand side that their spatial part makes.
StateDerivative derivative_of(const Model& model, const State& state, const StateRows& rows);

/// In the direct way (an operator that is not transposed, and sizes of values) one solution for all quantities: the
/// motion x_p of the state with the number, along which they are differentiated. Else one adjoint for each.
class NumberDerivatives {
 public:
  /// The same equations with more of a number, or of the load factor (null).
  struct Moved {
    std::shared_ptr<const Model> model;
    double load_factor = 0.0;
    const SceneNumber* number = nullptr;
    double more = 0.0;
    const State* state = nullptr;  ///< as it is, or moved with the number
  };
  /// Of q with the state of the equations, in the order in which adjoints are added.
  using Values = std::function<std::vector<double>(const Moved&)>;

  /// `at`, of the same motions as the state, must outlive it; `values` may be empty, of numbers that are zero.
  NumberDerivatives(AdjointOperator& at, const State& state, Values values)
      : model_(at.model()), state_(in_space(state)), operator_(at), values_(std::move(values)) {}

  /// Takes the adjoint of the next quantity, and the motion of its part that supports hold.
  void add(Adjoint adjoint, DofVector held);
  /// Takes the size of the next quantity in the direct way, whose rounding is a share of it.
  void add(double size);
  const Adjoint& adjoint(std::size_t which) const { return adjoints_[which]; }

  /// dq/dp of a quantity, and how much of it may be rounding and what is left of the equations.
  struct Derivative {
    double value = 0.0, noise = 0.0;
  };
  /// Of every quantity. Throws InputError for a number of which the equations are no smooth function.
  std::vector<Derivative> by(const SceneNumber& number) const;
  std::vector<Derivative> by_load_factor(double step) const;

  static State in_space(State state) {
    state.in_plane = false;
    return state;
  }
  /// t . rows; adds the sizes of its terms to `sizes`.
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
  std::vector<double> rounding_{};  ///< (quantity): of its derivative, times the step
};

}  // namespace mixbeam
