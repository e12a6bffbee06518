#include "nonlinear/sensitivity/critical_gradient.hpp"

#include "discretization/text/errors.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace mixbeam {

namespace {

/// The tangent of a critical state cannot be solved with. States beside it whose stresses are smaller or larger by this
/// share can, with ten digits, and what varies smoothly with it is extrapolated to fourth order.
constexpr double kStressShare = 1e-5;
constexpr int kNeighbours = 4;
constexpr double kPlaces[kNeighbours] = {1.0, -1.0, 2.0, -2.0};
constexpr double kWeights[kNeighbours] = {4.0 / 6.0, 4.0 / 6.0, -1.0 / 6.0, -1.0 / 6.0};
/// Each of which leaves that share of other modes.
constexpr int kInverseIterationsOfMode = 4;
/// Motion (largest rotation, or displacement over the length) of the smallest of the differences along a mode: eighth
/// order leaves 1e-14 of second derivatives, rounding 1e-12.
constexpr double kStepAlongMode = 1.0 / 64.0;
constexpr double kSecond[kStencil] = {8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0}, kSecondHere = -205.0 / 72.0;
/// Share of the stresses, N L^2/EI or M L/EI, that the eigenvalue at a critical point may have: points are located to a
/// hundredth of it at least.
constexpr double kNearZero = 1e-6;
/// Steps of the load factor in differences.
constexpr double kStepOfLoad = 0.005;

void add_adjoint(double factor, const Adjoint& other, Adjoint& sum) {
  sum.field.update(factor, other.field, 1.0);
  for (std::size_t i = 0; i < sum.free.size(); ++i) sum.free[i] += factor * other.free[i];
  for (std::size_t i = 0; i < sum.held.size(); ++i) sum.held[i] += factor * other.held[i];
}

Adjoint scaled_adjoint(const Adjoint& of, double factor) {
  Adjoint result{of.field.clone(true), of.free, of.held};
  add_adjoint(factor - 1.0, of, result);
  return result;
}

/// With stresses larger by a share.
State with_more_stress(const Model& model, const State& state, double share) {
  MixedVector more = model.create_vector();
  more.fill(0.0);
  const KernelView<double*> interior = more.writable_interior(true);
  for_each_element(model.structure(), state, [&](const ElementView& element) {
    std::copy_n(element.unknowns(), element.layout().relative_rotation(1), element.increments_in(interior));
  });
  return model.apply(state, more, share);
}

/// The tangent of a critical state, or its transpose: motions that it takes to no forces, and its inverse in others.
class SingularTangent {
 public:
  SingularTangent(BeamProblem& problem, const State& state, double load_factor, int modes, bool transposed)
      : model_(problem.model), state_(state), lengths_(vertex_lengths(model_.structure())) {
    for (const double place : kPlaces) {
      beside_.push_back(std::make_unique<AdjointOperator>(
          problem, with_more_stress(model_, state, place * kStressShare), load_factor, transposed));
      modes_beside_.push_back(modes_of(*beside_.back(), modes));
    }
    for (int a = 0; a < modes; ++a)
      modes_.push_back(extrapolated([&](int i) { return in_modes(i, modes_beside_.front()[a]); }));
    orthonormalize(modes_);
  }

  AdjointOperator& beside() { return *beside_.front(); }
  const std::vector<Adjoint>& modes() const { return modes_; }
  /// The adjoint of a quantity, without parts of modes.
  Adjoint solve(const StateDerivative& quantity) {
    return extrapolated([&](int i) {
      Adjoint found = beside_[i]->solve(quantity);
      add_adjoint(-1.0, in_modes(i, found), found);
      return found;
    });
  }

  /// Length of member times rotations, displacements over the length of the structure.
  MixedVector measured(const MixedVector& motion) const {
    MixedVector rows = motion.clone(false);
    rows.fill(0.0);
    const double unit = 1.0 / (model_.structure().length * model_.structure().length);
    for (std::size_t i = 0; i < rows.vertex().extent(0); ++i)
      rows.vertex()(i) = lengths_[i / kVertexDofs] * (i % kVertexDofs < 3 ? unit : 1.0) * motion.vertex()(i);
    return rows;
  }
  double product(const Adjoint& a, const Adjoint& b) const {
    return measured(a.field).vertex_dofs().dot(b.field.vertex_dofs());
  }

 private:
  template <class Action>
  Adjoint extrapolated(const Action& at) {
    Adjoint sum = scaled_adjoint(at(0), kWeights[0]);
    for (int i = 1; i < kNeighbours; ++i) add_adjoint(kWeights[i], at(i), sum);
    return sum;
  }

  /// The part of a motion in the modes beside.
  Adjoint in_modes(int i, const Adjoint& motion) const {
    Adjoint part = scaled_adjoint(motion, 0.0);
    for (const Adjoint& mode : modes_beside_[i]) add_adjoint(product(mode, motion), mode, part);
    return part;
  }

  void orthonormalize(std::vector<Adjoint>& modes) const {
    for (std::size_t a = 0; a < modes.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) add_adjoint(-product(modes[b], modes[a]), modes[b], modes[a]);
      modes[a] = scaled_adjoint(modes[a], 1.0 / std::sqrt(product(modes[a], modes[a])));
    }
  }

  std::vector<Adjoint> modes_of(AdjointOperator& at, int count) const {
    std::minstd_rand random;
    std::vector<MixedVector> rows;
    for (int a = 0; a < count; ++a) {
      MixedVector any = model_.create_vector();
      any.fill(0.0);
      for (std::size_t i = 0; i < any.vertex().extent(0); i += 3) {
        Vec forces{{1.0 * random(), 1.0 * random(), 1.0 * random()}};
        if (state_.in_plane) {
          const Vec across = dot(model_.plane()->n, forces) * model_.plane()->n;
          forces = i % kVertexDofs == 0 ? forces - across : across;
        }
        store_vector((1.0 / random.max()) * forces, &any.vertex()(i));
      }
      rows.push_back(measured(any));
    }
    std::vector<Adjoint> modes;
    for (int k = 0; k < kInverseIterationsOfMode; ++k) {
      modes.clear();
      for (const MixedVector& of : rows) {
        StateDerivative quantity(model_, state_);
        quantity.add_rows(of);
        modes.push_back(at.solve(quantity));
      }
      orthonormalize(modes);
      for (int a = 0; a < count; ++a) rows[a] = measured(modes[a].field);
    }
    return modes;
  }

  const Model& model_;
  State state_;
  std::vector<double> lengths_;
  std::vector<std::unique_ptr<AdjointOperator>> beside_{};
  std::vector<std::vector<Adjoint>> modes_beside_{};  ///< (neighbour, mode)
  std::vector<Adjoint> modes_{};
};

/// States along a motion, at one to four steps forward and back.
struct Curve {
  double step = 0.0;
  std::vector<State> states[2]{};
};

class CriticalLoad {
 public:
  CriticalLoad(BeamProblem& problem, const CriticalPoint& point, bool transposed)
      : problem_(problem), model_(problem.model), state_(point.state), load_factor_(point.load_factor) {
    find_modes(point.modes, transposed);
  }

  std::vector<QuantityGradient> of_limit(const CriticalGradientRequest& request) {
    Adjoint left = scaled_adjoint(tangent_->modes().front(), -1.0 / by_load_factor(tangent_->modes().front()));
    QuantityGradient gradient{"load factor at " + request.name, load_factor_};
    if (request.by_element) gradient.elements = element_gradients(state_, StateDerivative(model_, state_), left);
    NumberDerivatives derivatives(tangent_->beside(), state_, {});
    derivatives.add(std::move(left), DofVector(model_.map()));
    for (const SceneNumber& number : request.numbers)
      gradient.by_number.push_back(derivatives.by(number).front().value);
    return {gradient};
  }

 private:
  /// chi . R_lambda.
  double by_load_factor(const Adjoint& mode) {
    NumberDerivatives derivatives(tangent_->beside(), state_, {});
    derivatives.add(scaled_adjoint(mode, 1.0), DofVector(model_.map()));
    const auto [value, noise] = derivatives.by_load_factor(step_of_load()).front();
    if (!(std::abs(value) > noise))
      throw InputError("the gradient of a limit load: the loads do no work in the motion of its mode");
    return value;
  }

  double step_of_load() const {
    const double to_stage = std::abs(load_factor_ - std::round(load_factor_));
    return std::min(kStepOfLoad * std::max(1e-3, std::abs(load_factor_)),
                    to_stage > 0.0 ? to_stage / (kStencil + 1) : 1.0);
  }

  void find_modes(int count, bool transposed) {
    for (;; state_.in_plane = false) {
      tangent_ = std::make_unique<SingularTangent>(problem_, state_, load_factor_, count, transposed);
      double largest = 0.0;
      for (const Adjoint& mode : tangent_->modes())
        largest = std::max(largest, std::abs(value_and_slope(mode, mode)[0]));
      const double unit = model_.structure().bending_reference / model_.structure().length / model_.structure().length;
      const double zero = kNearZero * stress_of(model_, magnitude_of(model_, state_, load_factor_));
      if (largest <= zero * unit) return;
      if (!state_.in_plane)
        throw LinearSolverError("the gradient of a critical load: its state has no eigenvalue next to zero");
    }
  }

  Curve along(const MixedVector& motion) const {
    const LargestParts size = largest_parts(*model_.map()->getComm(), motion.vertex());
    Curve curve{kStepAlongMode / std::max(size.moved / model_.structure().length, size.turned)};
    for (int side = 0; side < 2; ++side)
      for (int k = 1; k <= kStencil; ++k)
        curve.states[side].push_back(
            NumberDerivatives::in_space(model_.apply(state_, motion, (side == 0 ? k : -k) * curve.step)));
    return curve;
  }

  /// chi . R_x phi and its derivative along phi.
  std::array<double, 2> value_and_slope(const Adjoint& left, const Adjoint& right) {
    const Curve curve = along(right.field);
    const NumberDerivatives equations(tangent_->beside(), state_, {});
    double ignored = 0.0;
    const auto at = [&](const State& state) {
      return equations.work(left, rows_at(model_, state, load_factor_), ignored);
    };
    std::array<double, 2> found{0.0, kSecondHere * at(NumberDerivatives::in_space(state_))};
    for (int k = 0; k < kStencil; ++k) {
      const double forward = at(curve.states[0][k]), back = at(curve.states[1][k]);
      found[0] += kEighth[k] * (forward - back) / curve.step;
      found[1] += kSecond[k] * (forward + back);
    }
    found[1] /= curve.step * curve.step;
    return found;
  }

  BeamProblem& problem_;
  const Model& model_;
  State state_;
  double load_factor_;
  std::unique_ptr<SingularTangent> tangent_{};
};

}  // namespace

std::vector<QuantityGradient> critical_gradients_of(BeamProblem& problem, const CriticalPoint& point,
                                                    const CriticalGradientRequest& request, bool transposed) {
  require_differentiable(problem);
  if (point.kind != CriticalKind::limit_point || point.modes != 1)
    throw InputError("the gradient of the load factor at " + request.name + ": it is no limit point with one mode");
  CriticalLoad load(problem, point, transposed);
  return load.of_limit(request);
}

}  // namespace mixbeam
