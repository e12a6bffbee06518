#include "nonlinear/sensitivity/critical_gradient.hpp"

#include "discretization/text/errors.hpp"
#include "nonlinear/linear/linear_solver.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace mixbeam {

namespace {

/// Share by which the stresses of neighbouring states differ. The tangent of a critical state is singular; those of the
/// neighbours are solved with ten digits, and smooth results are interpolated to fourth order.
constexpr double kStressShare = 1e-5;
constexpr int kNeighbours = 4;
constexpr double kPlaces[kNeighbours] = {1.0, -1.0, 2.0, -2.0};
constexpr double kWeights[kNeighbours] = {4.0 / 6.0, 4.0 / 6.0, -1.0 / 6.0, -1.0 / 6.0};
/// Number of inverse iterations, each of which leaves that share of other modes.
constexpr int kInverseIterationsOfMode = 4;
/// Motion (largest rotation, or displacement over the length) in the smallest difference along a mode: eighth order
/// leaves 1e-14 of second derivatives, rounding 1e-12.
constexpr double kDifferenceAlongMode = 1.0 / 64.0;
constexpr int kStates = 8;
constexpr double kStateAt[kStates] = {1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0, -4.0};
constexpr double kFirst[kStates] = {4.0 / 5.0,   -4.0 / 5.0,   -1.0 / 5.0,   1.0 / 5.0,
                                    4.0 / 105.0, -4.0 / 105.0, -1.0 / 280.0, 1.0 / 280.0};
constexpr double kSecond[kStates] = {8.0 / 5.0,   8.0 / 5.0,   -1.0 / 5.0,   -1.0 / 5.0,
                                     8.0 / 315.0, 8.0 / 315.0, -1.0 / 560.0, -1.0 / 560.0};
constexpr double kSecondHere = -205.0 / 72.0;
/// Largest eigenvalue at a critical point, over the stresses N L^2/EI or M L/EI: points are located at least to a
/// hundredth of it.
constexpr double kNearZero = 1e-6;
/// Ratio up to which further modes belong to the cluster: derivatives of closer loads hold only for smaller changes.
constexpr double kOneCluster = 1e-4;
constexpr int kMostTogether = 6;
/// Largest third variation along a mode with largest motion one at a symmetric bifurcation, over the same stresses.
constexpr double kThirdVariation = 1e-6;
/// Motion along its modes (largest rotation, or displacement over the length) by which the state at a bifurcation may
/// deviate from the path: derivatives of the load change with its square.
constexpr double kAside = 1e-4;
/// Limit of steps of Newton's method orthogonal to the modes, and their size at convergence.
constexpr int kMostSettlings = 4;
constexpr double kSettledBesideModes = 1e-11;
/// Work of a number of an element in a mode with a largest motion of one, over the largest derivative of the load, up
/// to which it does not break the symmetry.
constexpr double kBreaksSymmetry = 1e-7;
/// Relative step of the load factor in differences.
constexpr double kStepOfLoad = 0.0005;

Adjoint scaled_adjoint(const Adjoint& of, double factor) {
  Adjoint result{of.field.clone(true), of.free, of.held};
  result.add(factor - 1.0, of);
  return result;
}

/// Increases the stresses of a state by a share.
State with_more_stress(const Model& model, const State& state, double share) {
  MixedVector more = model.create_vector();
  more.fill(0.0);
  const KernelView<double*> interior = more.writable_interior(true);
  for_each_element(model.structure(), state, [&](const ElementView& element) {
    std::copy_n(element.unknowns(), element.layout().relative_rotation(1), element.increments_in(interior));
  });
  return model.apply(state, more, share);
}

/// The singular tangent of a critical state, or its transpose: its null vectors, and its inverse orthogonal to them.
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
  /// Approximates the mode whose eigenvalue is next to theirs.
  Adjoint next_mode() const { return modes_of(*beside_.front(), static_cast<int>(modes_.size()) + 1).back(); }
  /// Solves for the adjoint of a quantity, without components in the modes.
  Adjoint solve(const StateDerivative& quantity, const DofVector& projected) {
    return extrapolated([&](int i) {
      Adjoint found = beside_[i]->solve(quantity, &projected);
      found.add(-1.0, in_modes(i, found));
      return found;
    });
  }

  /// Multiplies motions by tributary lengths, and displacements by 1 / L^2, L the length of the structure.
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
    for (int i = 1; i < kNeighbours; ++i) sum.add(kWeights[i], at(i));
    return sum;
  }

  /// Component of a motion in the modes of a neighbour.
  Adjoint in_modes(int i, const Adjoint& motion) const {
    Adjoint part = scaled_adjoint(motion, 0.0);
    for (const Adjoint& mode : modes_beside_[i]) part.add(product(mode, motion), mode);
    return part;
  }

  void orthonormalize(std::vector<Adjoint>& modes) const {
    for (std::size_t a = 0; a < modes.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) modes[a].add(-product(modes[b], modes[a]), modes[b]);
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

/// States along a motion, at multiples kStateAt of a step.
struct Curve {
  Adjoint motion;
  double step = 0.0;
  std::vector<State> states{};
};

class CriticalLoad {
 public:
  CriticalLoad(BeamProblem& problem, const CriticalPoint& point, const CriticalGradientRequest& request,
               bool transposed)
      : problem_(problem),
        model_(problem.model),
        request_(request),
        state_(point.state),
        load_factor_(point.load_factor) {
    find_modes(point, transposed);
  }

  std::vector<RecordedGradient> of_limit() {
    if (count() > 1) refuse("a limit point with a bifurcation beside it");
    const Adjoint& mode = tangent_->modes().front();
    NumberDerivatives by_load(tangent_->beside(), state_, {});
    by_load.add(scaled_adjoint(mode, 1.0), DofVector(model_.map()));
    const auto [work, noise] = by_load.by_load_factor(step_of_load()).front();
    if (!(std::abs(work) > noise)) refuse("its loads do no work in the motion of its mode");
    Adjoint left = scaled_adjoint(mode, -1.0 / work);
    RecordedGradient gradient = begin("load factor at ");
    if (request_.by_element) find_by_element(state_, StateDerivative(model_, state_), left, gradient);
    NumberDerivatives derivatives(tangent_->beside(), state_, {});
    derivatives.add(std::move(left), DofVector(model_.map()));
    std::vector<RecordedGradient> found{gradient};
    for (const SceneNumber& number : request_.numbers)
      add_number(number, found, [&] { found[0].derivative.back() = derivatives.by(number).front().value; });
    return found;
  }

  std::vector<RecordedGradient> of_bifurcation() {
    if (!tangent_->beside().is_symmetric()) refuse("a bifurcation of loads that have no potential");
    const NumberDerivatives derivatives = of_second_variations();
    take_slopes(derivatives.by_load_factor(step_of_load()));
    const int m = count();
    std::vector<RecordedGradient> found{begin("load factor at ")};
    if (m == 1)
      found.push_back(begin("imperfection sensitivity at "));
    else
      found[0].note = "of several modes at one load, but one for each direction";
    for (int k = 1; m > 1 && k <= m; ++k) {
      found.push_back(begin("load factor at "));
      found[k].quantity += ", direction " + std::to_string(k);
    }
    if (request_.by_element && m == 1) add_elements(derivatives.adjoint(1), found[0]);
    for (const SceneNumber& number : request_.numbers)
      add_number(number, found, [&] {
        const Derivatives by = derivatives.by(number);
        const double imperfection = imperfection_of(by);
        if (m == 1) found[1].derivative.back() = imperfection;
        const std::vector<double> values = imperfection == 0.0 ? values_of(by) : std::vector<double>{};
        for (int k = 0; k < m; ++k) {
          RecordedGradient& one = found[m == 1 ? 0 : k + 1];
          if (imperfection == 0.0)
            one.derivative.back() = values[k];
          else
            one.note = "of numbers that break the symmetry, whose imperfection sensitivity is not zero";
        }
      });
    return found;
  }

 private:
  using Derivatives = std::vector<NumberDerivatives::Derivative>;

  int count() const { return static_cast<int>(tangent_->modes().size()); }
  RecordedGradient begin(const std::string& what) const { return {what + request_.name, load_factor_}; }
  [[noreturn]] void refuse(const std::string& why) const {
    throw InputError("the gradient of the load factor at " + request_.name + ": " + why);
  }

  double step_of_load() const {
    const double to_stage = std::abs(load_factor_ - std::round(load_factor_));
    return std::min(kStepOfLoad * std::max(1e-3, std::abs(load_factor_)), to_stage > 0.0 ? 0.25 * to_stage : 1.0);
  }

  /// Eigenvalue of the order of stress_of(), in the units of SingularTangent::product().
  double eigenvalue_of_stress() const {
    const Structure& structure = model_.structure();
    return stress_of(model_, magnitude_of(model_, state_, load_factor_)) * structure.bending_reference /
           (structure.length * structure.length);
  }

  /// Finds the modes whose eigenvalues vanish, and those that nearly do.
  void find_modes(const CriticalPoint& point, bool transposed) {
    bool settles = point.kind == CriticalKind::bifurcation;
    double zero = kNearZero;
    for (int modes = point.modes;;) {
      tangent_ = std::make_unique<SingularTangent>(problem_, state_, load_factor_, modes, transposed);
      curves_.clear();
      double largest = 0.0;
      for (const Adjoint& mode : tangent_->modes()) {
        curves_.push_back(along(mode));
        largest = std::max(largest, std::abs(second_variation(curves_.back(), model_, load_factor_)));
      }
      if (!(largest <= zero * eigenvalue_of_stress())) {
        if (!state_.in_plane) refuse("its state has no eigenvalue next to zero");
        state_.in_plane = false;
        continue;
      }
      if (settles && tangent_->beside().is_symmetric() && settle()) {
        settles = false;
        continue;
      }
      const double next = second_variation(along(tangent_->next_mode()), model_, load_factor_);
      if (!(std::abs(next) <= kOneCluster * eigenvalue_of_stress())) return;
      if (++modes > kMostTogether) refuse("more modes vanish there than are separated");
      zero = kOneCluster;
    }
  }

  /// Largest rotation, or displacement over the length, of a motion.
  double size_of(const Adjoint& motion) const {
    const LargestParts size = largest_parts(*model_.map()->getComm(), motion.field.vertex());
    return std::max(size.moved / model_.structure().length, size.turned);
  }

  Curve along(const Adjoint& motion) const {
    Curve curve{scaled_adjoint(motion, 1.0), kDifferenceAlongMode / size_of(motion)};
    for (const double at : kStateAt)
      curve.states.push_back(NumberDerivatives::in_space(model_.apply(state_, motion.field, at * curve.step)));
    return curve;
  }

  /// Rows of a neighbouring state for work in the free motions of this one; without held rows.
  StateRows rows_beside(const Model& model, double load_factor, const State& there) const {
    StateRows rows = rows_at(model, there, load_factor);
    const auto projected = [&](const State& state) {
      DofVector forces(rows.spatial.vertex_dofs(), Teuchos::Copy);
      model.constraints().project(state, MixedVector::view_of(forces));
      return forces;
    };
    rows.constraints.update(1.0, projected(there), -1.0, projected(state_), 1.0);
    const KernelView<double*> vertex = MixedVector::view_of(rows.constraints);
    for (const VertexSupport& support : model.conditions().supports)
      for (int i = 0; i < kVertexDofs; ++i)
        if (support.fixed[i]) vertex(vertex_row(support.vertex, i)) = 0.0;
    return rows;
  }

  /// Computes psi . R_x psi.
  double second_variation(const Curve& along, const Model& model, double load_factor) const {
    const NumberDerivatives equations(tangent_->beside(), state_, {});
    double sum = 0.0, ignored = 0.0;
    for (int i = 0; i < kStates; ++i)
      sum += kFirst[i] / along.step *
             equations.work(along.motion, rows_beside(model, load_factor, along.states[i]), ignored);
    return sum;
  }

  /// Derivative of the second variation by the state: the second derivative of the rows along psi.
  StateRows slope_of_second_variation(const Curve& along) const {
    StateRows slope(model_);
    slope.add(kSecondHere / (along.step * along.step),
              rows_beside(model_, load_factor_, NumberDerivatives::in_space(state_)));
    for (int i = 0; i < kStates; ++i)
      slope.add(kSecond[i] / (along.step * along.step), rows_beside(model_, load_factor_, along.states[i]));
    return slope;
  }

  /// Solves for t of (82), which includes the motion of the state.
  Adjoint adjoint_of(const Curve& along) const {
    const StateRows slope = slope_of_second_variation(along);
    const NumberDerivatives equations(tangent_->beside(), state_, {});
    for (const Adjoint& mode : tangent_->modes()) {
      double ignored = 0.0;
      if (!(std::abs(amplitude(mode) * equations.work(mode, slope, ignored)) <=
            kThirdVariation * eigenvalue_of_stress()))
        refuse("a bifurcation that is not symmetric, whose derivatives are not offered");
    }
    return solve(slope);
  }

  /// Computes -R_x^-1 times rows, orthogonal to the modes.
  Adjoint solve(const StateRows& of) const {
    return tangent_->solve(derivative_of(model_, state_, of), of.constraints);
  }

  /// Newton's method orthogonal to the modes, since the states of bifurcations are located only to half of the digits.
  /// Returns whether the state has moved.
  bool settle() {
    bool moves = false;
    for (int i = 0; i < kMostSettlings; ++i) {
      const Adjoint step = solve(rows_beside(model_, load_factor_, NumberDerivatives::in_space(state_)));
      if (!(size_of(step) > kSettledBesideModes)) break;
      state_ = model_.apply(state_, step.field, 1.0);
      moves = true;
    }
    return moves;
  }

  /// Prepares derivatives of the work in the modes; then of second variations in each mode and in each sum of two.
  NumberDerivatives of_second_variations() {
    for (int a = 0; a < count(); ++a)
      for (int b = a + 1; b < count(); ++b) {
        Adjoint sum = scaled_adjoint(tangent_->modes()[a], 1.0);
        sum.add(1.0, tangent_->modes()[b]);
        curves_.push_back(along(sum));
      }
    NumberDerivatives derivatives(tangent_->beside(), state_, [this](const NumberDerivatives::Moved& moved) {
      std::vector<double> values(tangent_->modes().size(), 0.0);
      for (const Curve& curve : curves_) values.push_back(second_variation(curve, *moved.model, moved.load_factor));
      return values;
    });
    for (const Adjoint& mode : tangent_->modes()) derivatives.add(scaled_adjoint(mode, 1.0), DofVector(model_.map()));
    for (const Curve& curve : curves_) derivatives.add(adjoint_of(curve), DofVector(model_.map()));
    return derivatives;
  }

  /// Returns (mode, mode): the quadratic form with these second variations.
  std::vector<double> form_of(const Derivatives& by) const {
    const int m = count();
    std::vector<double> form(static_cast<std::size_t>(m) * m);
    for (int a = 0; a < m; ++a) form[a * (m + 1)] = by[m + a].value;
    for (int a = 0, next = 2 * m; a < m; ++a)
      for (int b = a + 1; b < m; ++b, ++next)
        form[a + b * m] = form[b + a * m] = 0.5 * (by[next].value - form[a * (m + 1)] - form[b * (m + 1)]);
    return form;
  }

  /// Finds S with S^T D S = 1 for the form D of the load, up to its sign, and the deviation c of the state from the
  /// path along the modes, from chi . R_lambda = D c.
  void take_slopes(const Derivatives& by_load) {
    const int m = count();
    std::vector<double> of_load = form_of(by_load);
    scale_ = small_eigenproblem(of_load, m);
    sign_ = of_load[0] < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < m; ++k) {
      const double value = sign_ * of_load[k * (m + 1)];
      if (!(value > by_load[m].noise)) refuse("its eigenvalues do not all change with the load in one direction");
      for (int i = 0; i < m; ++i) scale_[i + k * m] /= std::sqrt(value);
    }
    aside_.assign(m, 0.0);
    for (int k = 0; k < m; ++k)
      for (int i = 0; i < m; ++i)
        for (int j = 0; j < m; ++j) aside_[i] += sign_ * scale_[i + k * m] * scale_[j + k * m] * by_load[j].value;
    for (int a = 0; a < m; ++a)
      if (!(std::abs(aside_[a]) <= kAside * std::abs(amplitude(tangent_->modes()[a]))))
        refuse("the path does not pass through it");
  }

  /// Computes -D^-1 G: the derivative for one mode; for several, one for each direction, the smallest first.
  std::vector<double> values_of(const Derivatives& by) const {
    const int m = count();
    const std::vector<double> form = form_of(by);
    std::vector<double> scaled(form.size(), 0.0), values;
    for (int k = 0; k < m; ++k)
      for (int l = 0; l < m; ++l)
        for (int i = 0; i < m; ++i)
          for (int j = 0; j < m; ++j)
            scaled[k + l * m] -= sign_ * scale_[i + k * m] * form[i + j * m] * scale_[j + l * m];
    small_eigenproblem(scaled, m);
    for (int k = 0; k < m; ++k) values.push_back(scaled[k * (m + 1)]);
    std::sort(values.begin(), values.end());
    return values;
  }

  /// Computes chi . R_p, corrected for the deviation of the state from the path, over D for a largest motion of one;
  /// the largest of several modes.
  double imperfection_of(const Derivatives& by) const {
    const int m = count();
    const std::vector<double> form = form_of(by);
    double largest = 0.0;
    for (int a = 0; a < m; ++a) {
      double work = by[a].value, slope = 0.0;
      for (int b = 0; b < m; ++b) work -= form[a + b * m] * aside_[b];
      for (int k = 0; k < m; ++k) slope += scale_[a + k * m] * scale_[a + k * m];
      work *= sign_ * slope / amplitude(tangent_->modes()[a]);
      if (std::abs(work) > slope * by[a].noise / std::abs(amplitude(tangent_->modes()[a])) &&
          std::abs(work) > std::abs(largest))
        largest = work;
    }
    return largest;
  }

  /// Adds derivatives by elements for one mode, including products of its own N and M, theory (82).
  void add_elements(const Adjoint& adjoint, RecordedGradient& gradient) const {
    const double slope = sign_ / (scale_[0] * scale_[0]);
    const StateDerivative none(model_, state_);
    const Adjoint& mode = tangent_->modes().front();
    RecordedGradient own, breaking;
    find_by_element(state_, none, scaled_adjoint(adjoint, -1.0 / slope), gradient);
    find_by_element(state_, none, scaled_adjoint(mode, -1.0 / slope), own, &mode.field);
    find_by_element(state_, none, scaled_adjoint(mode, 1.0 / (amplitude(mode) * slope)), breaking);
    for (std::size_t e = 0; e < own.compliance.size(); ++e)
      for (int i = 0; i < 6; ++i) {
        gradient.compliance[e][i] += own.compliance[e][i];
        gradient.stiffness[e][i] += own.stiffness[e][i];
      }
    using Numbers = std::vector<std::array<double, 6>> RecordedGradient::*;
    forget_breaking<Numbers>(breaking, &RecordedGradient::compliance, gradient,
                             {&RecordedGradient::stiffness, &RecordedGradient::compliance});
    forget_breaking<Numbers>(breaking, &RecordedGradient::natural, gradient, {&RecordedGradient::natural});
  }

  /// Sets derivatives by numbers that break the symmetry to NaN, relative to the largest one of forces, or of moments.
  template <class Numbers>
  static void forget_breaking(const RecordedGradient& breaking, Numbers measured, RecordedGradient& gradient,
                              const std::vector<Numbers>& lost) {
    for (const std::size_t first : {0U, 3U}) {
      double largest = 0.0;
      for (const std::array<double, 6>& numbers : gradient.*measured)
        for (std::size_t i = first; i < first + 3; ++i) largest = std::max(largest, std::abs(numbers[i]));
      for (std::size_t e = 0; e < (breaking.*measured).size(); ++e)
        for (std::size_t i = first; i < first + 3; ++i)
          if (std::abs((breaking.*measured)[e][i]) > kBreaksSymmetry * largest)
            for (const Numbers numbers : lost) (gradient.*numbers)[e][i] = std::nan("");
    }
  }

  /// Factor that makes the largest rotation, or displacement over the length, one.
  double amplitude(const Adjoint& mode) const {
    MixedVector normal = mode.field.clone(true);
    normalize_mode(model_, normal);
    return normal.vertex_dofs().dot(mode.field.vertex_dofs()) / mode.field.vertex_dofs().dot(mode.field.vertex_dofs());
  }

  BeamProblem& problem_;
  const Model& model_;
  const CriticalGradientRequest& request_;
  State state_;
  double load_factor_;
  std::unique_ptr<SingularTangent> tangent_{};
  std::vector<Curve> curves_{};            ///< along the modes, then along their sums
  std::vector<double> scale_{}, aside_{};  ///< see take_slopes()
  double sign_ = 1.0;
};

}  // namespace

std::vector<RecordedGradient> critical_gradients_of(BeamProblem& problem, const CriticalPoint& point,
                                                    const CriticalGradientRequest& request, bool transposed) {
  require_differentiable(problem);
  if (point.kind == CriticalKind::flutter || !point.located)
    throw InputError("the gradient of the load factor at " + request.name +
                     ": it is no limit point and no bifurcation that was located");
  CriticalLoad load(problem, point, request, transposed);
  return point.kind == CriticalKind::limit_point ? load.of_limit() : load.of_bifurcation();
}

}  // namespace mixbeam
