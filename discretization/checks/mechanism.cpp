#include "discretization/checks/mechanism.hpp"

#include "discretization/mesh/vertex_partition.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/scene/joined_ends.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/message_text.hpp"
#include "discretization/text/number_text.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace mixbeam {
namespace {

using namespace vector_algebra;

// The structure as rigid parts that joints connect, which move without any strain.

/// Members that are rigidly joined, with the points and supports on them. A point with joints is on several parts; its
/// support is on the part of the members that the joints do not list.
struct RigidPart {
  std::vector<std::size_t> members;   ///< in Scene::members
  std::vector<std::size_t> supports;  ///< in Scene::supports
  std::vector<std::string> points;    ///< names, in the order in which the members meet them
  std::vector<Vector3> positions;     ///< of `points`
  Vector3 center{};                   ///< mean of the positions
  double size = 0.0;                  ///< largest distance from the centre
};

/// One end of a member at a joint, or several that stay together.
struct RigidLink {
  std::size_t master = 0, slave = 0;  ///< parts of the assembly
  std::size_t joint = 0;              ///< in Scene::joints
  Vector3 position{};
};

/// Parts that are connected through joints; without joints a single part.
struct RigidAssembly {
  std::vector<RigidPart> parts;
  std::vector<RigidLink> links;
};

/// Name of the point of each vertex.
std::vector<std::string> names_of_vertices(const Mesh& mesh) {
  std::vector<std::string> names(static_cast<std::size_t>(mesh.vertices()));
  for (const auto& [name, vertex] : mesh.vertex_of_point) names[vertex] = name;
  for (const MeshJoint& joint : mesh.joints) names[joint.slave] = names[joint.master];
  return names;
}

void measure(RigidPart& part) {
  for (const Vector3& position : part.positions) part.center = sum(part.center, position);
  part.center = scaled(1.0 / static_cast<double>(part.positions.size()), part.center);
  for (const Vector3& position : part.positions)
    part.size = std::max(part.size, norm(difference(position, part.center)));
}

/// Rigid parts of a scene; none if the numbers of a member make no curve. Throws like build_mesh for members without a
/// place and joints that join nothing.
std::vector<RigidAssembly> rigid_assemblies(const Scene& scene) try {
  const Mesh mesh = mesh_of_points(scene);
  const std::vector<std::string> names = names_of_vertices(mesh);
  const std::vector<int> part_of = connected_parts(mesh, {}), assembly_at = connected_parts(mesh, mesh.joints);

  struct Place {
    int assembly = -1, part = -1;
  };
  std::vector<RigidAssembly> all;
  std::vector<Place> place_of(names.size());  // (part)
  std::vector<int> assembly_of(names.size(), -1);
  std::vector<unsigned char> is_seen(names.size(), 0);
  const auto part_at = [&](int vertex) -> RigidPart& {
    Place& place = place_of[part_of[vertex]];
    if (place.part < 0) {
      int& assembly = assembly_of[assembly_at[vertex]];
      if (assembly < 0) {
        assembly = static_cast<int>(all.size());
        all.emplace_back();
      }
      place = {assembly, static_cast<int>(all[assembly].parts.size())};
      all[assembly].parts.emplace_back();
    }
    return all[place.assembly].parts[place.part];
  };
  for (std::size_t m = 0; m < scene.members.size(); ++m) {
    const MeshMember& member = mesh.members[m];
    RigidPart& part = part_at(mesh.elements[member.first_element].vertex[0]);
    part.members.push_back(m);
    for (int e = 0; e < member.elements; ++e)
      for (const int vertex : mesh.elements[member.first_element + e].vertex) {
        if (std::exchange(is_seen[vertex], 1) != 0) continue;
        part.points.push_back(names[vertex]);
        part.positions.push_back(mesh.vertex_position[vertex]);
      }
  }
  for (std::size_t i = 0; i < scene.supports.size(); ++i) {
    const auto found = mesh.vertex_of_point.find(scene.supports[i].point);
    if (found != mesh.vertex_of_point.end()) part_at(found->second).supports.push_back(i);
  }
  std::vector<MeshJoint> joints = mesh.joints;
  std::sort(joints.begin(), joints.end(), [&names](const MeshJoint& a, const MeshJoint& b) {
    return std::tie(names[a.slave], a.member) < std::tie(names[b.slave], b.member);
  });
  for (const MeshJoint& joint : joints) {
    const Place master = place_of[part_of[joint.master]], slave = place_of[part_of[joint.slave]];
    all[slave.assembly].links.push_back({static_cast<std::size_t>(master.part), static_cast<std::size_t>(slave.part),
                                         static_cast<std::size_t>(joint.joint), mesh.vertex_position[joint.slave]});
  }
  for (RigidAssembly& assembly : all)
    for (RigidPart& part : assembly.parts) {
      measure(part);
      for (const std::size_t m : part.members)  // a closed ring has one point only
        if (scene.members[m].start_point == scene.members[m].end_point)
          part.size = std::max(part.size, mesh.members[m].curve.length);
    }
  return all;
} catch (const MemberError&) {  // numbers too extreme for a curve: reported where the elements are made
  return {};
}

// A support closer to the axis of a motion than 1e-6 of the structure's size does not block it; squared, as the matrix
// below is, which has rounding errors of 1e-16.
constexpr double kBlockedShare = 1e-12;
constexpr double kPrintedZero = 1e-9;  // components of a motion below this share are rounding
// The elimination is dense: this many parts take a second or two.
constexpr std::size_t kMostParts = 150;

/// Rigid motion about a reference point: displacement = translation + rotation x (position - reference) / size.
struct RigidMotion {
  Vector3 translation{};
  Vector3 rotation{};
};

using Row = std::vector<double>;  // of each part: translation x, y, z, rotation x, y, z
using Rows = std::vector<Row>;

/// Adds factor * (displacement of a point of a part . e) to a row.
void add_displacement(Row& row, double factor, const RigidPart& part, std::size_t index, const Vector3& position,
                      const Vector3& e) {
  const Vector3 lever = cross(scaled(1.0 / part.size, difference(position, part.center)), e);
  for (std::size_t i = 0; i < 3; ++i) {
    row[6 * index + i] += factor * e[i];
    row[6 * index + 3 + i] += factor * lever[i];  // (rotation x arm) . e = rotation . (arm x e)
  }
}

void add_rotation(Row& row, double factor, std::size_t index, const Vector3& e) {
  for (std::size_t i = 0; i < 3; ++i) row[6 * index + 3 + i] += factor * e[i];
}

/// Adds the rows of each fixed or elastic component of the supports.
void add_support_rows(const RigidAssembly& assembly, const Scene& scene, Rows& rows) {
  const std::size_t n = 6 * assembly.parts.size();
  for (std::size_t p = 0; p < assembly.parts.size(); ++p) {
    const RigidPart& part = assembly.parts[p];
    for (const std::size_t s : part.supports) {
      const Support& support = scene.supports[s];
      const auto place = std::find(part.points.begin(), part.points.end(), support.point);
      const Vector3& position = part.positions[static_cast<std::size_t>(place - part.points.begin())];
      for (std::size_t i = 0; i < 3; ++i) {
        if (support.displacement_fixed[i] || support.displacement_stiffness[i] > 0.0)
          add_displacement(rows.emplace_back(n, 0.0), 1.0, part, p, position, support.axes[i]);
        if (support.rotation_fixed[i] || support.rotation_stiffness[i] > 0.0)
          add_rotation(rows.emplace_back(n, 0.0), 1.0, p, support.axes[i]);
      }
    }
  }
}

/// Adds the rows of each joint for the relative motion of its two parts.
void add_joint_rows(const RigidAssembly& assembly, const Scene& scene, Rows& rows) {
  const std::size_t n = 6 * assembly.parts.size();
  for (const RigidLink& link : assembly.links) {
    Joint joint = scene.joints[link.joint];
    const RigidPart &master = assembly.parts[link.master], &slave = assembly.parts[link.slave];
    const double size = std::min(master.size, slave.size);  // rotations are stored times the size of their part
    if (joint.kind == JointKind::ball) joint.axis = {0, 0, 1};
    const Axes frame = joint_frame(joint);
    const int sprung = !(joint.stiffness > 0.0) || joint.kind == JointKind::ball ? -1
                       : joint.kind == JointKind::slider                         ? 2
                                                                                 : 5;
    for (const int c : {0, 3, 1, 4, 2, 5}) {
      if (!joint_holds(joint.kind, c) && c != sprung) continue;
      Row& row = rows.emplace_back(n, 0.0);
      const Vector3& axis = frame[static_cast<std::size_t>(c % 3)];
      if (c < 3) {
        add_displacement(row, 1.0, slave, link.slave, link.position, axis);
        add_displacement(row, -1.0, master, link.master, link.position, axis);
      } else {
        add_rotation(row, size / slave.size, link.slave, axis);
        add_rotation(row, -size / master.size, link.master, axis);
      }
    }
  }
}

/// R^T R of all rows R: a motion that it maps to zero is held by nothing.
Rows blocking_matrix(const RigidAssembly& assembly, const Scene& scene) {
  Rows rows;
  add_support_rows(assembly, scene, rows);
  add_joint_rows(assembly, scene, rows);
  const std::size_t n = 6 * assembly.parts.size();
  Rows matrix(n, Row(n, 0.0));
  std::vector<std::size_t> entries;
  for (const Row& row : rows) {
    entries.clear();
    for (std::size_t i = 0; i < n; ++i)
      if (row[i] != 0.0) entries.push_back(i);
    for (const std::size_t i : entries)
      for (const std::size_t j : entries) matrix[i][j] += row[i] * row[j];
  }
  return matrix;
}

/// Gauss-Jordan elimination with full pivoting over the given columns. Afterwards the first rows have a one in their
/// pivot column, where all other rows are zero. Returns the pivot columns in the order of the rows.
std::vector<std::size_t> reduce(Rows& rows, const std::vector<std::size_t>& columns, double threshold,
                                std::size_t first_row = 0) {
  std::vector<std::size_t> pivots;
  for (std::size_t done = first_row; done < rows.size(); ++done) {
    std::size_t best_row = done, best_column = columns.front();
    for (std::size_t row = done; row < rows.size(); ++row) {
      for (const std::size_t column : columns) {
        if (std::abs(rows[row][column]) > std::abs(rows[best_row][best_column])) best_row = row, best_column = column;
      }
    }
    const double pivot = rows[best_row][best_column];
    if (std::abs(pivot) <= threshold) break;
    std::swap(rows[done], rows[best_row]);
    for (double& entry : rows[done]) entry /= pivot;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const double factor = rows[row][best_column];
      if (row == done) continue;
      if (factor == 0.0) continue;
      for (std::size_t i = 0; i < rows[row].size(); ++i) rows[row][i] -= factor * rows[done][i];
    }
    pivots.push_back(best_column);
  }
  return pivots;
}

double largest_entry(const Rows& rows) {
  double largest = 0.0;
  for (const Row& row : rows) {
    for (const double entry : row) largest = std::max(largest, std::abs(entry));
  }
  return largest;
}

/// Motions that the matrix maps to zero.
Rows null_space(Rows matrix) {
  std::vector<std::size_t> all(matrix.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::vector<std::size_t> pivots = reduce(matrix, all, kBlockedShare * largest_entry(matrix));
  std::vector<bool> is_pivot(all.size(), false);
  for (const std::size_t pivot : pivots) is_pivot[pivot] = true;
  Rows motions;
  for (const std::size_t free : all) {
    if (is_pivot[free]) continue;
    Row motion(all.size(), 0.0);
    motion[free] = 1.0;
    for (std::size_t row = 0; row < pivots.size(); ++row) motion[pivots[row]] = -matrix[row][free];
    motions.push_back(motion);
  }
  return motions;
}

/// Spans the same space by plain motions: rotations about as few axes as possible, translations without any rotation.
Rows plain_motions(Rows motions) {
  if (motions.empty()) return motions;
  const double threshold = kPrintedZero * largest_entry(motions);
  std::vector<std::size_t> translations, rotations;
  for (std::size_t i = 0; i < motions.front().size(); ++i) (i % 6 < 3 ? translations : rotations).push_back(i);
  const std::size_t turning = reduce(motions, rotations, threshold).size();
  reduce(motions, translations, threshold, turning);
  for (Row& row : motions) {
    const double largest = largest_entry({row});
    for (double& entry : row) entry = std::abs(entry) < kPrintedZero * largest ? 0.0 : entry;
  }
  return motions;
}

RigidMotion motion_of_part(const Row& row, std::size_t part) {
  const double* m = &row[6 * part];
  return {{m[0], m[1], m[2]}, {m[3], m[4], m[5]}};
}

bool moves(const RigidMotion& motion) { return !is_zero(motion.translation) || !is_zero(motion.rotation); }

Vector3 displacement(const RigidMotion& motion, const RigidPart& part, const Vector3& position) {
  const Vector3 arm = scaled(1.0 / part.size, difference(position, part.center));
  return sum(motion.translation, cross(motion.rotation, arm));
}

std::string rounded_text(const Vector3& v, double size) {
  std::string text = "(";
  for (std::size_t i = 0; i < 3; ++i) {
    // Six decimals relative to the size are enough to find the place.
    const double grid = size * 1e-6;
    const double on_grid = std::round(v[i] / grid) * grid;
    text += (i == 0 ? "" : ", ") + rounded(on_grid == 0.0 ? 0.0 : on_grid, 6);
  }
  return text + ")";
}

std::string described(const RigidMotion& motion, const RigidPart& part) {
  const double turn = norm(motion.rotation);
  if (turn == 0.0) {
    return "translation along " + rounded_text(scaled(1.0 / norm(motion.translation), motion.translation), 1.0);
  }
  const Vector3 direction = scaled(1.0 / turn, motion.rotation);
  const Vector3 to_axis = scaled(part.size / turn, cross(direction, motion.translation));
  const double along = dot(direction, motion.translation) / turn;
  std::string text = "rotation about " + rounded_text(direction, 1.0) + " through " +
                     rounded_text(sum(part.center, to_axis), std::max(part.size, norm(part.center)));
  if (std::abs(along) > kPrintedZero) text += " with a translation along it, like a screw";
  return text;
}

std::string point_moved_most(const RigidMotion& motion, const RigidPart& part) {
  double largest = kPrintedZero;
  const std::string* moved = nullptr;
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    const double distance = norm(displacement(motion, part, part.positions[i]));
    // The first one of equals, whatever the rounding.
    if (distance > largest * (1.0 + kPrintedZero)) largest = distance, moved = &part.points[i];
  }
  if (moved == nullptr)
    return "all its points lie on this axis, about which it rotates; a hinge in place of a ball, or a fixed rotation, "
           "prevents it";
  return "point \"" + excerpt(*moved) + "\" moves most";
}

std::vector<std::string> names_of(const std::vector<std::size_t>& members, const Scene& scene) {
  std::vector<std::string> names;
  for (const std::size_t i : members) names.push_back(scene.members[i].name);
  return names;
}

std::string member_names(const std::vector<std::size_t>& members, const Scene& scene, const std::string& several) {
  constexpr std::size_t kMostNames = 6;  // those that move are named one by one behind them
  return (members.size() == 1 ? "member " : several) + quoted_list(names_of(members, scene), kMostNames);
}

/// Describes a motion by the part that moves most; in a joined structure, names the members of that part.
std::string described(const Row& row, const RigidAssembly& assembly, const Scene& scene) {
  std::size_t most = 0, moving = 0;
  double largest = 0.0;
  for (std::size_t p = 0; p < assembly.parts.size(); ++p) {
    const RigidMotion motion = motion_of_part(row, p);
    moving += moves(motion) ? 1 : 0;
    const double size = std::hypot(norm(motion.translation), norm(motion.rotation));
    if (size > largest * (1.0 + kPrintedZero)) largest = size, most = p;
  }
  const RigidPart& part = assembly.parts[most];
  const RigidMotion motion = motion_of_part(row, most);
  const std::string words = described(motion, part) + " (" + point_moved_most(motion, part) + ")";
  if (assembly.parts.size() == 1) return words;
  return member_names(part.members, scene, "members ") + " by " + words +
         (moving > 1 ? ", others with it through the joints" : "");
}

std::vector<std::size_t> all_members(const RigidAssembly& assembly) {
  std::vector<std::size_t> members;
  for (const RigidPart& part : assembly.parts) members.insert(members.end(), part.members.begin(), part.members.end());
  std::sort(members.begin(), members.end());
  return members;
}

/// The assembly with every joint locked, which must be held at least.
RigidAssembly locked(const RigidAssembly& assembly) {
  RigidAssembly single;
  RigidPart& whole = single.parts.emplace_back();
  for (const RigidPart& part : assembly.parts) {
    whole.members.insert(whole.members.end(), part.members.begin(), part.members.end());
    whole.supports.insert(whole.supports.end(), part.supports.begin(), part.supports.end());
    whole.points.insert(whole.points.end(), part.points.begin(), part.points.end());
    whole.positions.insert(whole.positions.end(), part.positions.begin(), part.positions.end());
  }
  measure(whole);
  return single;
}

/// Text on how an assembly can move without strain; empty if it cannot.
std::string motions_of(const RigidAssembly& assembly, const Scene& scene) {
  const Rows free = plain_motions(null_space(blocking_matrix(assembly, scene)));
  if (free.empty()) return "";
  constexpr std::size_t kMostMotions = 6;
  std::string motions;
  for (std::size_t i = 0; i < std::min(free.size(), kMostMotions); ++i)
    motions += (motions.empty() ? "" : "; ") + described(free[i], assembly, scene);
  if (free.size() > kMostMotions) motions += "; and " + std::to_string(free.size() - kMostMotions) + " more";
  return member_names(all_members(assembly), scene, "connected members ") + " can move without strain in " +
         std::to_string(free.size()) + (free.size() == 1 ? " way: " : " ways: ") + motions;
}

std::string allowed_for(const RigidAssembly& assembly) {
  return assembly.parts.size() > 1 ? "; allowed: supports, springs and joints that leave no motion without strain"
                                   : "; allowed: supports that block all six rigid motions of every connected part";
}

/// Mechanisms found: the first in full, a member of each of the others.
struct Mechanisms {
  std::string first, allowed;
  std::vector<std::string> others{};

  void note(const RigidAssembly& assembly, const Scene& scene) {
    const std::string motions = motions_of(assembly, scene);
    if (motions.empty()) return;
    if (!first.empty()) return others.push_back(scene.members[all_members(assembly).front()].name);
    first = motions;
    allowed = allowed_for(assembly);
  }
  std::string text() const {
    if (others.empty()) return first + allowed;
    const std::string how_many =
        others.size() == 1 ? "one more connected part is" : std::to_string(others.size()) + " more connected parts are";
    return first + "; " + how_many + " not supported either, with member " + quoted_list(others) + allowed;
  }
};

}  // namespace

std::string check_supports(const Scene& scene, const ParameterSource& source, const ParameterPath& path) {
  std::string skipped;
  Mechanisms mechanisms;
  for (const RigidAssembly& assembly : rigid_assemblies(scene)) {
    const bool is_small = assembly.parts.size() <= kMostParts;
    mechanisms.note(is_small ? assembly : locked(assembly), scene);
    if (!is_small)
      skipped = "whether joints let a part of the structure move without strain was not checked: " +
                std::to_string(assembly.parts.size()) + " parts are joined, and the check takes " +
                std::to_string(kMostParts) + " at most";
  }
  if (!mechanisms.first.empty()) throw source.error(child(path, "Supports"), mechanisms.text());
  return skipped;
}

LooseStructure loose_structure(const Scene& scene) {
  LooseStructure loose;
  loose.part_of_member.assign(scene.members.size(), 0);
  int number = 0;
  for (const RigidAssembly& whole : rigid_assemblies(scene)) {
    const RigidAssembly assembly = whole.parts.size() <= kMostParts ? whole : locked(whole);
    for (const std::size_t member : all_members(assembly)) loose.part_of_member[member] = number;
    ++number;
    for (const Row& row : plain_motions(null_space(blocking_matrix(assembly, scene)))) {
      if (loose.motions.size() == kMostShownMotions) break;
      std::vector<RigidVelocity>& velocities = loose.motions.emplace_back(scene.members.size());
      for (std::size_t p = 0; p < assembly.parts.size(); ++p) {
        const RigidPart& part = assembly.parts[p];
        const RigidMotion motion = motion_of_part(row, p);
        for (const std::size_t member : part.members)
          velocities[member] = {motion.translation, scaled(1.0 / part.size, motion.rotation), part.center};
      }
    }
  }
  return loose;
}

}  // namespace mixbeam
