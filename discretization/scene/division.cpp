#include "discretization/scene/division.hpp"

#include "discretization/text/errors.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <string>

namespace mixbeam {
namespace {

/// Ends of the pieces between inner points: 0, the inner points, 1.
std::vector<double> piece_ends(const Member& member) {
  std::vector<double> ends = {0.0};
  for (const InnerPoint& inner : member.inner_points) {
    require(inner.position > ends.back() && inner.position < 1.0,
            "The position of the inner point \"" + inner.point + "\" must ascend between 0 and 1.");
    ends.push_back(inner.position);
  }
  ends.push_back(1.0);
  return ends;
}

/// Number of elements in each piece: one, and each further one where they are longest.
std::vector<int> share_out(int elements, const std::vector<double>& ends) {
  struct Piece {
    double length;
    std::size_t index;
    int elements;
    double element_length() const { return length / elements; }
    bool operator<(const Piece& other) const {  // of equals the first one comes first
      return element_length() != other.element_length() ? element_length() < other.element_length()
                                                        : index > other.index;
    }
  };
  const std::size_t pieces = ends.size() - 1;
  std::priority_queue<Piece> queue;
  for (std::size_t i = 0; i < pieces; ++i) queue.push({ends[i + 1] - ends[i], i, 1});
  for (std::size_t used = pieces; used < static_cast<std::size_t>(elements); ++used) {
    Piece longest = queue.top();
    queue.pop();
    ++longest.elements;
    queue.push(longest);
  }
  std::vector<int> count(pieces);
  for (; !queue.empty(); queue.pop()) count[queue.top().index] = queue.top().elements;
  return count;
}

ElementDivision divide_pieces(const Member& member) {
  const std::vector<double> ends = piece_ends(member);
  const std::vector<int> count = share_out(member.elements, ends);
  ElementDivision division;
  division.is_equal = count.size() == 1;
  division.station = {0.0};
  for (std::size_t piece = 0; piece < count.size(); ++piece) {
    if (piece > 0) division.inner_vertex.push_back(division.elements());
    const double first = ends[piece], length = ends[piece + 1] - first;
    for (int i = 1; i < count[piece]; ++i) division.station.push_back(first + length * i / count[piece]);
    division.station.push_back(ends[piece + 1]);
  }
  return division;
}

int nearest_station(const std::vector<double>& station, double position) {
  const auto above = std::lower_bound(station.begin() + 1, station.end() - 1, position);
  const auto nearest = position - *(above - 1) < *above - position ? above - 1 : above;
  return static_cast<int>(nearest - station.begin());
}

ElementDivision divide_at_stations(const Member& member) {
  const std::vector<double>& station = member.stations;
  require(station.size() == static_cast<std::size_t>(member.elements) + 1,
          "There are " + std::to_string(station.size()) + " stations; " + std::to_string(member.elements) +
              " elements have " + std::to_string(member.elements + 1) + ".");
  require(station.front() == 0.0 && station.back() == 1.0, "The first station must be 0 and the last one 1.");
  for (std::size_t i = 1; i < station.size(); ++i)
    require(station[i] > station[i - 1], "Station " + std::to_string(i + 1) + " does not exceed the one before it.");
  ElementDivision division;
  division.station = station;
  piece_ends(member);  // checks the positions
  for (const InnerPoint& inner : member.inner_points) {
    const int vertex = nearest_station(station, inner.position);
    require(std::abs(station[static_cast<std::size_t>(vertex)] - inner.position) <= kStationTolerance,
            "The inner point \"" + inner.point + "\" is none of the stations.");
    require(division.inner_vertex.empty() || vertex > division.inner_vertex.back(),
            "The inner point \"" + inner.point + "\" is at the station of the one before it.");
    division.inner_vertex.push_back(vertex);
  }
  return division;
}

}  // namespace

ElementDivision divide(const Member& member) {
  require(member.elements >= 1, "A member has at least one element.");
  return member.stations.empty() ? divide_pieces(member) : divide_at_stations(member);
}

}  // namespace mixbeam
