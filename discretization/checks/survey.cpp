#include "discretization/checks/survey.hpp"

#include "discretization/geometry/vector_algebra.hpp"

#include <algorithm>

namespace mixbeam {

SceneSurvey::SceneSurvey(const Scene& surveyed) : scene(surveyed), names(surveyed) {
  for (const Section& section : scene.sections) sections.emplace(section.name, &section);
  Vector3 low = scene.points.front().position, high = low;
  for (const Point& point : scene.points) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], point.position[i]);
      high[i] = std::max(high[i], point.position[i]);
    }
  }
  size = vector_algebra::norm(vector_algebra::difference(high, low));
  curves.reserve(scene.members.size());
  for (const Member& member : scene.members) {
    curves.push_back(
        make_reference_curve(member, names.position(member.start_point), names.position(member.end_point)));
    size = std::max(size, curves.back().length);
  }
}

std::array<double, 2> SceneSurvey::element_lengths(std::size_t member) const {
  const std::vector<double>& stations = scene.members[member].stations;
  const double length = curves[member].length;
  if (stations.empty()) return {length / scene.members[member].elements, length / scene.members[member].elements};
  double shortest = 1.0, longest = 0.0;
  for (std::size_t i = 1; i < stations.size(); ++i) {
    shortest = std::min(shortest, stations[i] - stations[i - 1]);
    longest = std::max(longest, stations[i] - stations[i - 1]);
  }
  return {shortest * length, longest * length};
}

double SceneSurvey::end_element_length(std::size_t member, int end) const {
  const std::vector<double>& stations = scene.members[member].stations;
  const double length = curves[member].length;
  if (stations.size() < 2) return length / scene.members[member].elements;
  const std::size_t last = stations.size() - 1;
  return length * (end == 0 ? stations[1] - stations[0] : stations[last] - stations[last - 1]);
}

}  // namespace mixbeam
