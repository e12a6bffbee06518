#include "discretization/mechanism_check.hpp"

#include "discretization/curve_end.hpp"
#include "discretization/message_text.hpp"
#include "discretization/parameter_spec.hpp"
#include "discretization/vector_algebra.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <unordered_map>

namespace mixbeam {
namespace {

using namespace vector_algebra;

// A support that stands closer to the axis of a motion than 1e-6 of the structure's size does not count as blocking it:
// squared in the matrix below, which carries rounding errors of 1e-16.
constexpr double kBlockedShare = 1e-12;
constexpr double kPrintedZero = 1e-9;  // components of a motion below this share are rounding

/// Rigid motion about a reference point: displacement = translation + rotation x (position - reference) / size.
struct RigidMotion {
  Vector3 translation{};
  Vector3 rotation{};
};

using Row = std::array<double, 6>;  // translation x, y, z, rotation x, y, z
using Rows = std::vector<Row>;

/// Members, points and supports that hang together.
struct Part {
  std::vector<std::size_t> members, points, supports;
  Vector3 center{};
  double size = 0.0;
};

/// Sets that grow together (union-find with path halving).
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t group_of(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t i, std::size_t j) { parent_[group_of(i)] = group_of(j); }

 private:
  std::vector<std::size_t> parent_;
};

using PointIndex = std::unordered_map<std::string, std::size_t>;

PointIndex index_points(const Scene& scene) {
  PointIndex index;
  for (std::size_t i = 0; i < scene.points.size(); ++i) index.emplace(scene.points[i].name, i);
  return index;
}

void measure(Part& part, const Scene& scene, const PointIndex& index) {
  for (const std::size_t point : part.points) part.center = sum(part.center, scene.points[point].position);
  part.center = scaled(1.0 / static_cast<double>(part.points.size()), part.center);
  for (const std::size_t point : part.points) {
    part.size = std::max(part.size, norm(difference(scene.points[point].position, part.center)));
  }
  for (const std::size_t i : part.members) {  // a closed ring has one point only
    const Member& member = scene.members[i];
    const Vector3& start = scene.points[index.at(member.start_point)].position;
    const Vector3& end = scene.points[index.at(member.end_point)].position;
    if (member.start_point == member.end_point) part.size = std::max(part.size, curve_length(member.curve, start, end));
  }
}

std::vector<Part> connected_parts(const Scene& scene) {
  const PointIndex index = index_points(scene);
  Groups groups(scene.points.size());
  for (const Member& member : scene.members) {
    groups.join(index.at(member.start_point), index.at(member.end_point));
    for (const InnerPoint& inner : member.inner_points)
      groups.join(index.at(member.start_point), index.at(inner.point));
  }
  std::unordered_map<std::size_t, std::size_t> part_of_group;
  std::vector<Part> parts;
  const auto part_of = [&](const std::string& point) -> Part& {
    const auto [found, is_new] = part_of_group.emplace(groups.group_of(index.at(point)), parts.size());
    if (is_new) parts.emplace_back();
    return parts[found->second];
  };
  for (std::size_t i = 0; i < scene.members.size(); ++i) part_of(scene.members[i].start_point).members.push_back(i);
  for (std::size_t i = 0; i < scene.points.size(); ++i) part_of(scene.points[i].name).points.push_back(i);
  for (std::size_t i = 0; i < scene.supports.size(); ++i) part_of(scene.supports[i].point).supports.push_back(i);
  for (Part& part : parts) measure(part, scene, index);
  return parts;
}

Vector3 unit(std::size_t i) {
  Vector3 e{};
  e[i] = 1.0;
  return e;
}

/// What each fixed component sees of each of the six motions, as the matrix R^T R of those rows R.
Rows blocking_matrix(const Part& part, const Scene& scene, const PointIndex& index) {
  Rows rows;
  for (const std::size_t i : part.supports) {
    const Support& support = scene.supports[i];
    const Vector3& position = scene.points[index.at(support.point)].position;
    const Vector3 arm = scaled(1.0 / part.size, difference(position, part.center));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector3 e = unit(axis);
      const Vector3 lever = cross(arm, e);  // (rotation x arm) . e = rotation . (arm x e)
      if (support.displacement_fixed[axis]) rows.push_back({e[0], e[1], e[2], lever[0], lever[1], lever[2]});
      if (support.rotation_fixed[axis]) rows.push_back({0.0, 0.0, 0.0, e[0], e[1], e[2]});
    }
  }
  Rows matrix(6, Row{});
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < 6; ++j) matrix[i][j] += row[i] * row[j];
    }
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
      for (std::size_t i = 0; i < 6; ++i) rows[row][i] -= factor * rows[done][i];
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
  const std::vector<std::size_t> all = {0, 1, 2, 3, 4, 5};
  const std::vector<std::size_t> pivots = reduce(matrix, all, kBlockedShare * largest_entry(matrix));
  Rows motions;
  for (const std::size_t free : all) {
    if (std::find(pivots.begin(), pivots.end(), free) != pivots.end()) continue;
    Row motion{};
    motion[free] = 1.0;
    for (std::size_t row = 0; row < pivots.size(); ++row) motion[pivots[row]] = -matrix[row][free];
    motions.push_back(motion);
  }
  return motions;
}

/// The same space in plain words: rotations about as few axes as possible, and translations without any rotation.
std::vector<RigidMotion> plain_motions(Rows motions) {
  const double threshold = kPrintedZero * largest_entry(motions);
  const std::size_t rotations = reduce(motions, {3, 4, 5}, threshold).size();
  reduce(motions, {0, 1, 2}, threshold, rotations);
  std::vector<RigidMotion> plain;
  for (Row& row : motions) {
    for (double& entry : row) entry = std::abs(entry) < kPrintedZero ? 0.0 : entry;
    plain.push_back(RigidMotion{{row[0], row[1], row[2]}, {row[3], row[4], row[5]}});
  }
  return plain;
}

Vector3 displacement(const RigidMotion& motion, const Part& part, const Vector3& position) {
  const Vector3 arm = scaled(1.0 / part.size, difference(position, part.center));
  return sum(motion.translation, cross(motion.rotation, arm));
}

std::string rounded_text(const Vector3& v, double size) {
  std::string text = "(";
  for (std::size_t i = 0; i < 3; ++i) {
    // Six decimals relative to the size are enough to find the place.
    const double grid = size * 1e-6;
    const double rounded = std::round(v[i] / grid) * grid;
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%.6g", rounded == 0.0 ? 0.0 : rounded);
    text += (i == 0 ? "" : ", ") + std::string(digits.data());
  }
  return text + ")";
}

std::string described(const RigidMotion& motion, const Part& part) {
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

std::string point_moved_most(const RigidMotion& motion, const Part& part, const Scene& scene) {
  double largest = kPrintedZero;
  const Point* moved = nullptr;
  for (const std::size_t i : part.points) {
    const double distance = norm(displacement(motion, part, scene.points[i].position));
    // The first one of equals, whatever the rounding.
    if (distance > largest * (1.0 + kPrintedZero)) largest = distance, moved = &scene.points[i];
  }
  if (moved == nullptr) return "all its points lie on this axis and only turn";
  return "point \"" + excerpt(moved->name) + "\" moves most";
}

std::string member_names(const Part& part, const Scene& scene) {
  std::vector<std::string> names;
  for (const std::size_t i : part.members) names.push_back(scene.members[i].name);
  return (names.size() == 1 ? "member " : "connected members ") + quoted_list(names);
}

}  // namespace

void check_supports(const Scene& scene, const ParameterSource& source, const ParameterPath& path) {
  const PointIndex index = index_points(scene);
  for (const Part& part : connected_parts(scene)) {
    const std::vector<RigidMotion> free = plain_motions(null_space(blocking_matrix(part, scene, index)));
    if (free.empty()) continue;
    std::string motions;
    for (const RigidMotion& motion : free) {
      motions +=
          (motions.empty() ? "" : "; ") + described(motion, part) + " (" + point_moved_most(motion, part, scene) + ")";
    }
    throw source.error(child(path, "Supports"),
                       member_names(part, scene) + " can move without strain in " + std::to_string(free.size()) +
                           (free.size() == 1 ? " way: " : " ways: ") + motions +
                           "; allowed: supports that block all six rigid motions of every connected part");
  }
}

}  // namespace mixbeam
