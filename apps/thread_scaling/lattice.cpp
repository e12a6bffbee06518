#include "apps/thread_scaling/lattice.hpp"

#include "apps/common/studies/variants.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace mixbeam {

namespace {

constexpr int kElementsOfStrut = 2;
constexpr double kSlenderness = 20.0;  ///< length over radius of gyration
/// Over EI / l^2: strains stay below a percent in cubes of a hundred cells.
constexpr double kForce = 1e-4;

/// Junctions are the places of a grid whose coordinates have an even sum, or all of them; struts lead from each along
/// these steps.
struct LatticeKind {
  std::vector<std::array<int, 3>> steps;
  bool even = false, flat = false;
  double struts_per_place = 0.0;  ///< in the interior
};

const std::map<std::string, LatticeKind>& kinds() {
  static const std::map<std::string, LatticeKind> all = {
      {"cubic", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, false, false, 3.0}},
      {"octet", {{{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}}, true, false, 3.0}},
      {"sheet", {{{1, 0, 0}, {0, 1, 0}}, false, true, 2.0}}};
  return all;
}

class Grid {
 public:
  Grid(const LatticeKind& kind, int side) : kind_(kind), side_(side), height_(kind.flat ? 1 : side) {}

  bool has(const std::array<int, 3>& at) const {
    const bool inside = at[0] >= 0 && at[0] < side_ && at[1] >= 0 && at[1] < side_ && at[2] >= 0 && at[2] < height_;
    return inside && (!kind_.even || (at[0] + at[1] + at[2]) % 2 == 0);
  }

  template <class Visit>
  void for_each(const Visit& visit) const {
    for (int i = 0; i < side_; ++i)
      for (int j = 0; j < side_; ++j)
        for (int k = 0; k < height_; ++k)
          if (has({i, j, k})) visit(std::array<int, 3>{i, j, k});
  }

  bool is_first(const std::array<int, 3>& at) const { return at[0] == 0; }
  bool is_last(const std::array<int, 3>& at) const { return at[0] == side_ - 1; }

 private:
  const LatticeKind& kind_;
  int side_, height_;
};

std::string name_of(const std::array<int, 3>& at) {
  return std::to_string(at[0]) + " " + std::to_string(at[1]) + " " + std::to_string(at[2]);
}

}  // namespace

const std::vector<std::string>& lattice_kinds() {
  static const std::vector<std::string> names = {"cubic", "octet", "sheet"};
  return names;
}

Scene lattice_scene(const Scene& scene, const std::string& name, int elements, int order) {
  const LatticeKind& kind = kinds().at(name);
  const double places = elements / (kElementsOfStrut * kind.struts_per_place);
  const Grid grid(kind, std::max(2, static_cast<int>(std::lround(kind.flat ? std::sqrt(places) : std::cbrt(places)))));
  const Section& section = scene.sections.front();
  const double bending = section.bending_stiffness[0];
  const double length = kSlenderness * std::sqrt(bending / section.axial_stiffness);
  const std::array<int, 3>& step = kind.steps.front();
  const double spacing = length / std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);

  Scene lattice;
  lattice.name = name;
  lattice.sections = {section};
  grid.for_each([&](const std::array<int, 3>& at) {
    lattice.points.push_back({name_of(at), {spacing * at[0], spacing * at[1], spacing * at[2]}});
    if (grid.is_first(at)) lattice.supports.push_back(support_of(name_of(at), {true, true, true}, {true, true, true}));
    if (grid.is_last(at)) {
      PointLoad load;
      load.point = name_of(at);
      load.force = {0, 0, kForce * bending / (length * length)};
      lattice.point_loads.push_back(load);
    }
    for (const std::array<int, 3>& way : kind.steps) {
      const std::array<int, 3> end = {at[0] + way[0], at[1] + way[1], at[2] + way[2]};
      if (!grid.has(end) || (grid.is_first(at) && grid.is_first(end))) continue;
      lattice.members.push_back(straight_member(name_of(at), name_of(end), section.name, order, kElementsOfStrut));
    }
  });
  return lattice;
}

}  // namespace mixbeam
