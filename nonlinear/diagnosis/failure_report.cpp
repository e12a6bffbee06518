#include "nonlinear/diagnosis/failure_report.hpp"

#include "discretization/constraints/swing.hpp"
#include "discretization/scene/what_acts.hpp"
#include "kernels/math/constants.hpp"
#include "nonlinear/linear/condition_estimate.hpp"
#include "nonlinear/stability/stability.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>

namespace mixbeam {

namespace {

/// Angle between an element and its vertices beyond which another step may pass pi, where rotations become ambiguous.
constexpr double kWideAngle = 0.75 * kPi;
/// Angle in a failed attempt that is a cause: iterates pass through large angles, and only one close to pi matters.
constexpr double kWideAngleOfAttempt = 0.95 * kPi;
/// Angle at the end of the path for which elements are suggested: half of the range.
constexpr double kComfortableAngle = 0.5 * kPi;
/// Limit of the extrapolated growth of angles with the load: a path that ended at its start says little about its end.
constexpr double kLargestAngleGrowth = 4.0;
constexpr std::size_t kMostAngles = 5;

/// Relative eigenvalue of a nearly singular tangent. Before a fold the smallest eigenvalue falls like the root of the
/// remaining load: the smallest step of 1e-4 of a stage leaves 1e-2, times a factor of order one.
constexpr double kNearlySingular = 0.05;
/// Eigenvalue of a mechanism, in units of EI/L of the stiffest member: members softer by six decades are far above
/// this, and a motion without strain has 1e-10 from rounding.
constexpr double kNoStiffness = 1e-8;
constexpr int kModes = 2;
constexpr int kVerticesOfMode = 3;

/// Reduction of the residual with which an attempt, still at its lowest, would have converged after more iterations.
constexpr double kFallen = 1e-2;

/// Displacement over the length that is negligible: inextensible members sag by 1e-5 within the tolerance of strains.
constexpr double kHardlyMoved = 1e-3;

/// Rounding of load factors, which are sums of rounded steps.
constexpr double kFactorRounding = 1e-9;

bool is_wide_in(const std::vector<WideAngle>& angles, const std::string& member) {
  return std::any_of(angles.begin(), angles.end(), [&](const WideAngle& a) { return a.member == member; });
}

WideAngle wide_angle(const Model& model, const EndAngle& angle, bool converged, double growth) {
  WideAngle wide;
  wide.member = angle.member;
  wide.element = angle.element;
  wide.elements = model.mesh().elements_of(member_index(model.scene(), angle.member));
  wide.angle = angle.angle;
  wide.converged = converged;
  const double needed = wide.elements * angle.angle * growth / kComfortableAngle;
  wide.suggested_elements = std::max(wide.elements + 1, static_cast<int>(std::ceil(needed)));
  return wide;
}

/// Wide angles at the last equilibrium, and in failed attempts.
std::vector<WideAngle> wide_angles(const Model& model, const PathEnd& end, const std::vector<FailedAttempt>& failed) {
  MixedVector residual = model.create_vector();
  const EvaluationPoint point = mixed_residual(model, end.state, end.load_factor, residual);
  const double whole = model.scene().stages;
  const double growth = end.load_factor > 0.0 ? std::min(kLargestAngleGrowth, whole / end.load_factor) : 1.0;
  std::vector<WideAngle> wide;
  for (const EndAngle& angle : end_angles_of_members(model, point))
    if (angle.angle > kWideAngle) wide.push_back(wide_angle(model, angle, true, growth));
  for (const FailedAttempt& attempt : failed)
    if (attempt.end_angle.angle > kWideAngleOfAttempt && !is_wide_in(wide, attempt.end_angle.member))
      wide.push_back(wide_angle(model, attempt.end_angle, false, 1.0));
  std::stable_sort(wide.begin(), wide.end(), [](const WideAngle& a, const WideAngle& b) {
    return a.converged != b.converged ? a.converged : a.angle > b.angle;
  });
  if (wide.size() > kMostAngles) wide.erase(wide.begin() + kMostAngles, wide.end());
  return wide;
}

/// Supports with springs about several axes whose rotation vector is close to its limit of 2 pi.
std::vector<std::pair<std::string, double>> spent_springs(const Model& model, const PathEnd& end) {
  constexpr double kSpent = 0.9 * 2.0 * kPi;
  const Scene& scene = model.scene();
  std::vector<double> mine(scene.supports.size() + 1), angle(mine.size());
  for (const VertexSupport& support : model.conditions().supports)
    if (support.rotation_kind == SupportRotation::vector && norm(support.rotation_stiffness) > 0.0)
      mine[support.index] = norm(continued_log(load_quaternion(&end.state.views.vertex_rotation(support.vertex, 0))));
  Teuchos::reduceAll(*model.map()->getComm(), Teuchos::REDUCE_MAX, static_cast<int>(mine.size()), mine.data(),
                     angle.data());
  std::vector<std::pair<std::string, double>> spent;
  for (size_t i = 0; i < scene.supports.size() && spent.size() < kMostAngles; ++i)
    if (angle[i] > kSpent) spent.emplace_back(scene.supports[i].point, angle[i]);
  return spent;
}

/// Motion of a vertex: size, vertex, displacement and rotation.
using Motion = std::array<double, 8>;

/// Keeps the largest motions, largest first; of equal ones the vertex of lower number.
void keep_largest(std::vector<Motion>& motions) {
  std::sort(motions.begin(), motions.end(),
            [](const Motion& a, const Motion& b) { return a[0] != b[0] ? a[0] > b[0] : a[1] < b[1]; });
  motions.resize(kVerticesOfMode, Motion{0.0, -1.0});
}

std::vector<Motion> largest_motions(const Model& model, const MixedVector& mode) {
  const KernelView<const double*> rows = mode.vertex();
  const double length = model.structure().length;
  std::vector<Motion> mine;
  for (int v = 0; v < model.structure().owned_vertices; ++v) {
    const double* d = &rows(static_cast<size_t>(kVertexDofs) * v);
    const double moves = std::hypot(d[0], d[1], d[2]) / length, turns = std::hypot(d[3], d[4], d[5]);
    mine.push_back({std::max(moves, turns), static_cast<double>(model.structure().local_vertex_to_global[v]), d[0],
                    d[1], d[2], d[3], d[4], d[5]});
  }
  keep_largest(mine);
  const Teuchos::Comm<int>& comm = *model.map()->getComm();
  std::vector<Motion> all(static_cast<std::size_t>(kVerticesOfMode) * comm.getSize());
  constexpr int kNumbers = kVerticesOfMode * static_cast<int>(std::tuple_size<Motion>::value);
  Teuchos::gatherAll(comm, kNumbers, mine.front().data(), kNumbers * comm.getSize(), all.front().data());
  keep_largest(all);
  return all;
}

CriticalMode described(const Model& model, const EigenMode& mode, double undeformed) {
  CriticalMode result;
  result.eigenvalue = mode.eigenvalue;
  result.relative = undeformed != 0.0 ? mode.eigenvalue / std::abs(undeformed) : 0.0;
  const std::vector<Motion> motions = largest_motions(model, mode.mode);
  for (const Motion& motion : motions) {
    if (motion[1] < 0.0 || motion[0] == 0.0) continue;
    MovingVertex vertex;
    vertex.place = place_of_vertex(model, static_cast<int>(motion[1]));
    const double moves = std::hypot(motion[2], motion[3], motion[4]),
                 turns = std::hypot(motion[5], motion[6], motion[7]);
    vertex.turns = turns > moves / model.structure().length;
    const int first = vertex.turns ? 5 : 2;
    for (int i = 0; i < 3; ++i) vertex.direction[i] = motion[first + i] / (vertex.turns ? turns : moves);
    vertex.share = motion[0] / motions.front()[0];
    result.vertices.push_back(vertex);
  }
  return result;
}

TangentReport tangent_report(BeamProblem& problem, const PathEnd& end) {
  TangentReport report;
  try {
    Stability stability(problem);
    const Spectrum undeformed = stability.spectrum(problem.model.reference_state(), 0.0, 1);
    const Spectrum present = stability.spectrum(end.state, end.load_factor, kModes);
    report.negative = present.stability.negative;
    report.null = present.stability.null;
    const double lowest = undeformed.modes.empty() ? 0.0 : undeformed.modes.front().eigenvalue;
    report.mechanism = undeformed.stability.null > 0 || std::abs(lowest) < kNoStiffness;
    for (const EigenMode& mode : present.modes) report.modes.push_back(described(problem.model, mode, lowest));
    const bool is_small = !report.modes.empty() && std::abs(report.modes.front().relative) < kNearlySingular;
    report.nearly_singular = report.null > 0 || is_small;
    report.known = true;
  } catch (const std::exception& error) {
    report.unknown_because = error.what();
  }
  return report;
}

/// Estimates the condition number; none if the tangent cannot be factorised.
std::optional<double> condition_of_tangent(BeamProblem& problem, const SolverParameters& parameters,
                                           const PathEnd& end) {
  try {
    return condition_of_tangent(problem.model, end.state, end.load_factor, sparse_solver_of(parameters.linear.method));
  } catch (const std::exception&) {
    return {};
  }
}

/// Whether even the smallest step leaves strains in a rigid, or nearly rigid, member.
bool is_rigid_where_it_fails(const FailureReport& report, const Model& model, const PathEnd& end) {
  const FailedAttempt& last = report.attempts.back();
  if (!report.step_at_minimum || !last.peak || last.peak->place.kind != RowKind::element_force) return false;
  const int section = model.structure().member_section[member_index(model.scene(), last.peak->place.member)];
  const Cap cap = cap_for(model, scales_of(model, end.state, end.load_factor));
  return cap.cuts_off_force(section, last.peak->place.component);
}

/// Whether the structure has hardly moved and a straight member would have to stretch.
bool is_taut(const FailureReport& report, const Model& model, const PathEnd& end) {
  const EquationPlace& place = report.attempts.back().peak->place;
  const Member& member = model.scene().members[member_index(model.scene(), place.member)];
  const double moved = magnitude_of(model, end.state, end.load_factor).displacement;
  return place.component == 0 && member.curve.shape == CurveShape::line &&
         moved < kHardlyMoved * model.structure().length;
}

FailureCause cause_of(const FailureReport& report, const Model& model, const PathEnd& end) {
  if (report.attempts.empty() || report.steps_used_up) return FailureCause::steps_used_up;
  const FailedAttempt& last = report.attempts.back();
  const bool lost = last.end == AttemptEnd::not_finite;
  if (lost && last.not_finite->source == NotFinite::Source::load) return FailureCause::load_not_finite;
  if (report.tangent.known && report.tangent.mechanism) return FailureCause::mechanism;
  if (!report.wide_angles.empty() && report.wide_angles.front().converged) return FailureCause::end_angle;
  if (report.tangent.known && report.tangent.nearly_singular) return FailureCause::critical_point;
  if (lost && last.not_finite->source == NotFinite::Source::load_factor) return FailureCause::linear_solver;
  if (lost) return FailureCause::overflow;
  if (last.end == AttemptEnd::linear_solver) return FailureCause::linear_solver;
  if (last.end == AttemptEnd::refused) return FailureCause::path_lost;
  if (is_rigid_where_it_fails(report, model, end)) {
    if (imposes_deformation(model.scene())) return FailureCause::incompatible;
    if (is_taut(report, model, end)) return FailureCause::taut;
  }
  const bool falls = last.last_residual == last.smallest_residual && last.last_residual < kFallen * last.first_residual;
  return falls ? FailureCause::slow : FailureCause::wandering;
}

}  // namespace

FailureReport report_failure(BeamProblem& problem, const SolverParameters& parameters, const PathEnd& end) {
  FailureReport report;
  report.last_step = end.step;
  report.last_load_factor = end.load_factor;
  report.stages = problem.model.scene().stages;
  report.minimum_step = end.minimum_step;
  report.failures = problem.attempts.failures();
  report.attempts = problem.attempts.attempts();
  report.steps_used_up = end.steps_used_up;
  report.lost_at = end.lost_at;
  if (!report.attempts.empty()) {
    const double tried = std::abs(report.attempts.back().load_factor - end.load_factor);
    report.step_at_minimum = tried > 0.0 && tried <= end.minimum_step * (1.0 + kFactorRounding) + kFactorRounding;
  }
  report.wide_angles = wide_angles(problem.model, end, report.attempts);
  report.spent_springs = spent_springs(problem.model, end);
  report.tangent = tangent_report(problem, end);
  report.tangent.condition = condition_of_tangent(problem, parameters, end);
  report.cause = cause_of(report, problem.model, end);
  report.next = advice_for(report, problem, parameters);
  return report;
}

}  // namespace mixbeam
