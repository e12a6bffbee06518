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
  for (int vertex : vertices) unloaded_.push_back({vertex});
}

int ConstraintRows::index_of(int vertex) const {
  const auto found = std::lower_bound(unloaded_.begin(), unloaded_.end(), vertex,
                                      [](const CarriedForce& f, int v) { return f.vertex < v; });
  return static_cast<int>(found - unloaded_.begin());
}

void ConstraintRows::mark_fixed(const KernelView<unsigned char*>& fixed) const {
  for (const VertexSupport& support : supports_) mark_fixed_rows(support, fixed);
  for (const VertexJoint& joint : joints_) mark_fixed_rows(joint, fixed);
}

void ConstraintRows::project(const State& state, const KernelView<double*>& rows) const {
  for (const VertexJoint& joint : joints_) join_rows(joint, state, rows);
  for (const VertexSupport& support : supports_) project_rows(support, state, rows);
}

void ConstraintRows::set(const State& state, double load_factor, const KernelView<double*>& rows) const {
  for (const VertexJoint& joint : joints_) set_joint_rows(joint, state, rows);
  for (const VertexSupport& support : supports_) set_support_rows(support, state, load_factor, rows);
}

void ConstraintRows::set_slopes(double load_factor, const KernelView<double*>& rows) const {
  for (const VertexSupport& support : supports_) set_support_slopes(support, load_factor, rows);
}

CarriedForces ConstraintRows::carried(const State& state, const KernelView<double*>& rows) const {
  CarriedForces carried = unloaded_;
  for (CarriedForce& f : carried) {
    f.force = rows_of(rows, f.vertex, kForcePart);
    f.moment = f.joined_moment = rows_of(rows, f.vertex, kMomentPart);
  }
  for (const VertexJoint& joint : joints_) {
    const CarriedForce& slave = carried[index_of(joint.slave)];
    carried[index_of(joint.master)].joined_moment += moment_on_master(joint, state, slave.force, slave.moment);
  }
  return carried;
}

void ConstraintRows::project(const State& state, const CarriedForces& carried, const MatrixRows& rows) const {
  // theory (44): beside second variations; loads have added their part
  for (const CarriedForce& f : carried) rows.add(f.vertex, kMomentPart, f.vertex, kMomentPart, -0.5 * hat(f.moment));
  for (const VertexJoint& joint : joints_) {
    const CarriedForce& slave = carried[index_of(joint.slave)];
    join_matrix_rows(joint, state, slave.force, slave.moment, rows);
  }
  for (const VertexSupport& support : supports_) {
    const Vec moment =
        turns_moment_rows(support) ? carried[index_of(support.vertex)].joined_moment : Vec{{0.0, 0.0, 0.0}};
    project_matrix_rows(support, state, moment, rows);
  }
}

}  // namespace mixbeam
