// Grouping of the cases of a batch that are solved side by side.
#include "apps/mixbeam/batch_solver.hpp"

#include "apps/common/run/room_check.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace mixbeam {

namespace {

using vector_algebra::largest_component;

/// Diagonal of the box around all points, with centres of arcs for structures that have one point (a closed ring).
double length_of(const Scene& scene) {
  vector_algebra::Box box;
  for (const Point& point : scene.points) box.enclose(point.position);
  for (const Member& member : scene.members) {
    if (member.curve.shape == CurveShape::circular_arc) box.enclose(member.curve.center);
    for (const Vector3& point : member.curve.through) box.enclose(point);
  }
  const double length = box.diagonal();
  return length > 0.0 && std::isfinite(length) ? length : 1.0;
}

double bending_stiffness_of(const Scene& scene) {
  double stiffness = 0.0;
  for (const Section& section : scene.sections)
    for (const double ei : section.bending_stiffness)
      if (std::isfinite(ei)) stiffness = std::max(stiffness, ei);
  return stiffness > 0.0 ? stiffness : 1.0;
}

/// Largest load as a force; moments, prescribed motions and strains are converted.
double load_of(const Scene& scene, double length, double stiffness) {
  double load = 0.0;
  const auto raise = [&load](double value) { load = std::max(load, value); };
  for (const PointLoad& point : scene.point_loads)
    raise(std::max(largest_component(point.force), largest_component(point.moment) / length));
  for (const DistributedLoad& line : scene.distributed_loads)
    raise(std::max(largest_component(line.force) * length, largest_component(line.couple)));
  for (const Support& support : scene.supports)
    raise(stiffness * std::max(largest_component(support.prescribed_displacement) / length,
                               largest_component(support.prescribed_rotation)));
  for (const Eigenstrain& strain : scene.eigenstrains)
    raise(stiffness * std::max(largest_component(strain.strain), largest_component(strain.curvature) * length));
  return load;
}

/// Index of the range of ratio kLikeness that contains a size.
long range_of(double size) {
  return size > 0.0 ? std::lround(std::floor(std::log(size) / std::log(kLikeness))) : std::numeric_limits<long>::min();
}

/// Properties that must agree within a group.
struct CaseLikeness {
  std::vector<long> structure{};                     ///< stages, numbers of entities, mesh
  double length = 0.0, load = 0.0, stiffness = 0.0;  ///< load and EI / L^2 as forces
  int elements = 0;
};

CaseLikeness likeness_of(const Scene& scene) {
  CaseLikeness result;
  result.structure = {scene.stages,
                      static_cast<long>(scene.supports.size()),
                      static_cast<long>(scene.point_loads.size()),
                      static_cast<long>(scene.distributed_loads.size()),
                      static_cast<long>(scene.eigenstrains.size()),
                      static_cast<long>(scene.joints.size())};
  for (const Member& member : scene.members) {
    result.structure.push_back(member.elements);
    result.structure.push_back(member.order);
    result.elements += member.elements;
  }
  result.length = length_of(scene);
  result.stiffness = bending_stiffness_of(scene) / (result.length * result.length);
  result.load = load_of(scene, result.length, result.stiffness);
  return result;
}

/// Ranges that must agree within a group.
auto key_of(const CaseLikeness& c) {
  return std::make_tuple(range_of(c.length), range_of(c.load), range_of(c.stiffness));
}

bool is_alike(const CaseLikeness& a, const CaseLikeness& b) {
  return key_of(a) == key_of(b) && a.structure == b.structure;
}

CaseGroups group_cases(const std::vector<CaseLikeness>& cases) {
  std::vector<std::size_t> order(cases.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&cases](std::size_t i, std::size_t j) {
    const CaseLikeness &a = cases[i], &b = cases[j];
    const auto key_a = key_of(a), key_b = key_of(b);
    return std::tie(a.structure, key_a, a.load, i) < std::tie(b.structure, key_b, b.load, j);
  });
  CaseGroups groups;
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    double elements = 0.0;
    for (; end < order.size() && is_alike(cases[order[begin]], cases[order[end]]); ++end)
      elements += cases[order[end]].elements;
    const auto count = static_cast<std::size_t>(std::ceil(elements / kElementsPerGroup));
    for (std::size_t g = 0; g < count; ++g) {
      const std::size_t from = begin + (end - begin) * g / count, to = begin + (end - begin) * (g + 1) / count;
      if (from < to) groups.emplace_back(order.begin() + from, order.begin() + to);
    }
    begin = end;
  }
  return groups;
}

}  // namespace

CaseGroups grouped_cases(CaseScenes& scenes, std::size_t cases) {
  std::vector<CaseLikeness> likeness;
  likeness.reserve(cases);
  for (std::size_t i = 0; i < cases; ++i) {
    Scene scene = scenes.scene_of(i);
    likeness.push_back(likeness_of(scene));
    scenes.keep(i, std::move(scene));
  }
  return group_cases(likeness);
}

void require_memory_of_cases(const Application& app, const Scene& scene, std::size_t cases, const Communicator& ranks) {
  constexpr double kBytesOfCase = 600.0;  // values, likeness and result, measured
  const double count = static_cast<double>(cases), processes = ranks->getSize();
  const double together =
      std::clamp(static_cast<double>(kElementsPerGroup) / static_cast<double>(elements_of(scene)), 1.0, count);
  const double kept = std::ceil(static_cast<double>(CaseScenes::kMostKept) / static_cast<double>(scene.members.size()));
  const double scenes = app.scene.imperfection_modes.empty() ? std::min(together + kept, count) : count;
  require_memory(app,
                 processes * (count * kBytesOfCase + scenes * bytes_of(scene)) +
                     std::min(processes * together, count) * needs_of(scene, app.solver).memory,
                 std::to_string(cases) + " cases", ranks);
}

}  // namespace mixbeam
