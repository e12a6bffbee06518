#include "apps/fork/displacement_error.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <cmath>

namespace mixbeam {

std::vector<Vector3> displacement_field(const Simulation& simulation, int elements_per_member, int points_per_member) {
  const int intervals = (points_per_member - 1) / elements_per_member;
  std::vector<Vector3> sampled;  // both ends of each element: vertices inside a member twice
  for (const MemberSamples& member : simulation.samples(intervals + 1))
    sampled.insert(sampled.end(), member.displacement.begin(), member.displacement.end());
  std::vector<Vector3> field;
  const int elements = static_cast<int>(sampled.size()) / (intervals + 1);
  for (int element = 0; element < elements; ++element) {
    const int first = element % elements_per_member == 0 ? 0 : 1;  // a vertex inside a member once
    for (int i = first; i <= intervals; ++i) field.push_back(sampled[element * (intervals + 1) + i]);
  }
  return field;
}

double mean_difference(const std::vector<Vector3>& a, const std::vector<Vector3>& b, int points_per_member,
                       const Communicator& communicator) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    const auto place = static_cast<int>(i) % points_per_member;
    const double weight = place == 0 || place == points_per_member - 1 ? 0.5 : 1.0;  // trapezoidal rule
    const double distance = std::hypot(a[i][0] - b[i][0], a[i][1] - b[i][1], a[i][2] - b[i][2]);
    sum += weight * distance * distance;
    weights += weight;
  }
  double mean = std::sqrt(sum / weights);
  Teuchos::broadcast(*communicator, 0, &mean);
  return mean;
}

}  // namespace mixbeam
