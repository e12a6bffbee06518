/// Stresses of the sections of a scene as quantities.
#pragma once

#include "discretization/mesh/mesh.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/stresses/section_stresses.hpp"

#include <map>
#include <memory>
#include <optional>
#include <string>

namespace mixbeam {

/// "normal stress" (the largest over the section, with its sign), "shear stress", "von Mises stress", "utilisation"
/// (von Mises stress over Strength).
bool is_stress(const std::string& kind);

/// Whether a member has such a quantity: stresses of its section are known (of a taper: by shapes), and a strength
/// where that counts.
bool has_stress(const Scene& scene, const Member& member, const std::string& kind);

/// Makes what sections need when they are first asked for. Scene and mesh must outlive it; not for concurrent threads.
class StressLookup {
 public:
  StressLookup(const Scene& scene, const Mesh& mesh) : scene_(scene), mesh_(mesh) {}

  /// At a point of a member (index in the scene); NaN where there is none.
  double of(const std::string& kind, const PointSample& sample, int member);

 private:
  struct Known {
    std::optional<SectionStresses> stresses{};
    double strength = 0.0;  ///< 0: not known
  };
  static Known known_of(const Section& section);
  const Known& section_at(const PointSample& sample, int member);

  const Scene& scene_;
  const Mesh& mesh_;
  std::map<std::string, Known> sections_{};
  std::map<int, SectionLaw> tapers_{};
  Known local_{};  ///< of a taper, where it was last asked for
};

}  // namespace mixbeam
