/// Stresses along members from their sampled forces.
#pragma once

#include "discretization/mesh/communicator.hpp"
#include "discretization/mesh/mesh.hpp"
#include "discretization/scene/section_law.hpp"
#include "discretization/state/member_samples.hpp"

#include <map>
#include <optional>
#include <string>

namespace mixbeam {

/// Number of members in a report.
inline constexpr std::size_t kMostStressed = 5;

/// Error of the bending stress of a curved member above which to warn.
inline constexpr double kCurvatureError = 0.05;

/// Stresses of one section, if known.
struct KnownSection {
  std::optional<SectionStresses> stresses{};
  std::optional<double> strength{};
  bool open_walls = false;  ///< I section

  KnownSection() = default;
  explicit KnownSection(const Section& section);
};

/// Section of a member at any place: constant, or from its taper.
struct SectionAlong {
  const KnownSection* plain = nullptr;
  SectionLaw law{};
  double length = 0.0, largest_strain = 0.0;

  KnownSection at(double arc_length) const;
};

/// Sections of the members of a scene, created on first use. Scene and mesh must outlive it; not thread-safe.
class StressedSections {
 public:
  StressedSections(const Scene& scene, const Mesh& mesh) : scene_(scene), mesh_(mesh) {}
  /// Section of a member (index in the scene), valid until the next call.
  const SectionAlong& of(std::size_t member);

 private:
  const Scene& scene_;
  const Mesh& mesh_;
  std::map<std::string, const Section*> sections_{};
  std::map<std::string, KnownSection> known_{};
  std::optional<std::size_t> member_{};
  SectionAlong along_{};
};

/// Computes the stresses of all samples that this rank holds, for the section at the sample (tapers), and finds the
/// largest ones of the structure. A few microseconds per sample, in parallel; the same bits for any number of threads.
/// Collective.
StressSummary sample_stresses(const Scene& scene, const Mesh& mesh, const Communicator& comm, SampledMembers& members);

}  // namespace mixbeam
