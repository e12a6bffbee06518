#include "discretization/constraints/constraint_rows.hpp"

#include <algorithm>
#include <set>

namespace mixbeam {

ConstraintRows::ConstraintRows(const Conditions& conditions)
    : supports_(conditions.supports), joints_(conditions.joints) {
  std::set<int> vertices;
  for (const VertexSupport& support : supports_)
    if (turns_moment_rows(support)) vertices.insert(support.vertex);
  for (const VertexJoint& joint : joints_) vertices.insert({joint.master, joint.slave});
  for (int vertex : vertices) watched_.push_back({vertex});
}

int ConstraintRows::watched_index(int vertex) const {
  const auto found =
      std::lower_bound(watched_.begin(), watched_.end(), vertex, [](const Watched& w, int v) { return w.vertex < v; });
  return static_cast<int>(found - watched_.begin());
}

void ConstraintRows::mark_fixed(const KernelView<unsigned char*>& fixed) const {
  for (const VertexSupport& support : supports_) mark_fixed_rows(support, fixed);
  for (const VertexJoint& joint : joints_) mark_fixed_rows(joint, fixed);
}

void ConstraintRows::turn(const State& state, const KernelView<double*>& rows) const {
  for (const VertexJoint& joint : joints_) join_rows(joint, state, rows);
  for (const VertexSupport& support : supports_) turn_rows(support, state, rows);
}

void ConstraintRows::set(const State& state, double load_factor, const KernelView<double*>& rows) const {
  for (const VertexJoint& joint : joints_) set_joint_rows(joint, state, rows);
  for (const VertexSupport& support : supports_) set_support_rows(support, state, load_factor, rows);
}

void ConstraintRows::set_slopes(double load_factor, const KernelView<double*>& rows) const {
  for (const VertexSupport& support : supports_) set_support_slopes(support, load_factor, rows);
}

void ConstraintRows::remember(const State& state, double load_factor, const KernelView<double*>& rows) {
  if (watched_.empty()) return;
  for (Watched& w : watched_) {
    w.force = rows_of(rows, w.vertex, kForcePart);
    w.moment = w.joined_moment = rows_of(rows, w.vertex, kMomentPart);
  }
  for (const VertexJoint& joint : joints_) {
    const Watched& slave = watched_[watched_index(joint.slave)];
    Vec& moment = watched_[watched_index(joint.master)].joined_moment;
    moment += moment_on_master(joint, state, slave.force, slave.moment);
  }
  remembered_ = state;
  remembered_load_factor_ = load_factor;
}

bool ConstraintRows::remembers(const State& state, double load_factor) const {
  return watched_.empty() || (remembered_.views.vertex_displacement.data() == state.views.vertex_displacement.data() &&
                              remembered_load_factor_ == load_factor);
}

void ConstraintRows::turn(const State& state, const MatrixRows& rows) const {
  // theory (44): beside second variations; loads have added their part
  for (const Watched& w : of_tangent_) rows.add(w.vertex, kMomentPart, w.vertex, kMomentPart, -0.5 * hat(w.moment));
  for (const VertexJoint& joint : joints_) {
    const Watched& slave = of_tangent_[watched_index(joint.slave)];
    join_matrix_rows(joint, state, slave.force, slave.moment, rows);
  }
  for (const VertexSupport& support : supports_) {
    const int w = turns_moment_rows(support) ? watched_index(support.vertex) : -1;
    turn_matrix_rows(support, state, w < 0 ? Vec{{0.0, 0.0, 0.0}} : of_tangent_[w].joined_moment, rows);
  }
}

}  // namespace mixbeam
