#include "apps/common/run/followed_points.hpp"

#include "apps/common/run/application.hpp"
#include "apps/common/run/quantity_values.hpp"
#include "discretization/text/result_names.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace mixbeam {

std::vector<std::string> followed_points(const Scene& scene) {
  // a scene may have thousands (a wall of supports); writing a time series for each would take longer than the run
  constexpr std::size_t kMostFollowedPoints = 100;
  std::vector<std::string> points;
  for (const PointLoad& load : scene.point_loads) points.push_back(load.point);
  for (const Support& support : scene.supports) points.push_back(support.point);
  std::set<std::string> known;
  const auto seen = [&known](const std::string& point) { return !known.insert(point).second; };
  points.erase(std::remove_if(points.begin(), points.end(), seen), points.end());
  points.resize(std::min(points.size(), kMostFollowedPoints));
  std::sort(points.begin(), points.end());
  return points;
}

namespace {

/// Adds forces and moments of the supports among the followed points to the time series.
void follow_reactions(const std::vector<std::string>& points, const std::vector<RecordedReaction>& reactions,
                      std::vector<MonitoredQuantity>& monitored) {
  std::map<std::string, std::array<Vector3, 2>> at;
  for (const RecordedReaction& reaction : reactions) {
    if (!std::binary_search(points.begin(), points.end(), reaction.point)) continue;
    std::array<Vector3, 2>& sum = at[reaction.point];
    for (int i = 0; i < 3; ++i) {
      sum[0][i] += reaction.force[i];
      sum[1][i] += reaction.moment[i];
    }
  }
  for (const auto& [point, sum] : at) {
    monitored.push_back({point + ".reaction_force", {sum[0].begin(), sum[0].end()}});
    monitored.push_back({point + ".reaction_moment", {sum[1].begin(), sum[1].end()}});
  }
}

}  // namespace

void follow_reactions(const std::vector<std::string>& points, StepRecord& record) {
  follow_reactions(points, record.reactions, record.monitored);
  for (RecordedCriticalPoint& point : record.critical_points)
    follow_reactions(points, point.reactions, point.monitored);
}

StoredRun with_all_series(const StoredRun& run, const Scene& scene, const QuantitySet* quantities,
                          Simulation& simulation) {
  const std::vector<std::string> points = followed_points(scene);
  const bool has_states = simulation.model().map()->getComm()->getRank() == 0;
  std::vector<MonitoredSeries> all;
  for (std::size_t i = 0; i < run.steps().size(); ++i) {
    const PathPoint& point = run.steps()[i];
    simulation.restore(has_states ? run.state(i) : StateSnapshot{}, point.load_factor, run.stability()[i], point.jumps);
    StepRecord record = simulation.record(stored_report(run, i), kPointsByOrder, points);
    follow_reactions(points, record);
    record.vibration = run.vibration()[i];
    if (quantities != nullptr)
      record.monitored.push_back({kQuantitySeries, values_of(*quantities, simulation, record)});
    all.resize(record.monitored.size());
    for (std::size_t q = 0; q < all.size(); ++q) {
      const MonitoredQuantity& quantity = record.monitored[q];
      all[q].name = quantity.name;
      all[q].columns = quantity.components.size();
      all[q].values.insert(all[q].values.end(), quantity.components.begin(), quantity.components.end());
    }
  }
  StoredRun whole = run;
  whole.complete(all);
  return whole;
}

}  // namespace mixbeam
