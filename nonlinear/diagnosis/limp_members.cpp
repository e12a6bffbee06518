#include "nonlinear/diagnosis/limp_members.hpp"

#include "discretization/assembly/residual.hpp"
#include "discretization/scene/section_law.hpp"

#include <algorithm>
#include <limits>

namespace mixbeam {

double bending_of(const Section& section) {
  const auto stiffness = diagonal(section);
  return section.matrix ? std::numeric_limits<double>::infinity() : std::min(stiffness[4], stiffness[5]);
}

bool is_limp(const Section& section, double load, double length) {
  // A load at the end of such a cantilever bends it into its direction over less than a hundredth of the length.
  constexpr double kLimp = 5e-5;
  return bending_of(section) < kLimp * load * length * length;
}

bool has_limp_members(const Model& model, const State& state, double load_factor) {
  const double load = magnitude_of(model, state, load_factor).load_force, length = model.structure().length;
  const std::vector<Section>& sections = model.scene().sections;
  return std::any_of(sections.begin(), sections.end(),
                     [&](const Section& section) { return is_limp(section, load, length); });
}

}  // namespace mixbeam
