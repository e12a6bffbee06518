#include "discretization/state/member_stresses.hpp"

#include "discretization/scene/section_shape.hpp"
#include "kernels/execution/execution_space.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mixbeam {

KnownSection::KnownSection(const Section& section) {
  if (!has_stresses(section)) return;
  stresses.emplace(section);
  strength = strength_of(section);
  open_walls = section.shape &&
               (section.shape->kind == SectionShapeKind::i_section || consists_of_rectangles(section.shape->kind));
}

KnownSection SectionAlong::at(double arc_length) const {
  return plain != nullptr ? *plain : KnownSection(law.section(std::clamp(arc_length / length, 0.0, 1.0)));
}

const SectionAlong& StressedSections::of(std::size_t index) {
  if (member_ == index) return along_;
  member_ = index;
  if (sections_.empty())  // lazily: most cases of a batch request no stress
    for (const Section& section : scene_.sections) sections_.emplace(section.name, &section);
  const Member& member = scene_.members[index];
  const Section& section = *sections_.at(member.section);
  along_ = {nullptr, {}, mesh_.member_length[index], section.largest_strain};
  if (member.end_section.empty())
    along_.plain = &known_.try_emplace(member.section, section).first->second;
  else
    along_.law = SectionLaw(scene_, member);
  return along_;
}

namespace {

/// A member with fewer samples is not worth starting threads.
constexpr std::size_t kSamplesForThreads = 64;

/// Utilisation above which a material is stressed beyond its strength.
constexpr double kAllOfStrength = 1.0;

constexpr double kNoStress = std::numeric_limits<double>::quiet_NaN();

/// Largest of the force strains and of the strain at the edge of the section.
double largest_strain(const KnownSection& section, const Vector3& force, const Vector3& moment) {
  const double shear = std::max(std::abs(force[1]), std::abs(force[2]));
  if (!section.stresses) return std::max(std::abs(force[0]), shear);
  return std::max(section.stresses->largest_edge_strain(force[0], moment[1], moment[2]), shear);
}

/// Numbers of one sample that the summary compares.
struct SampleNumbers {
  double strain = 0.0, curvature = 0.0;
};

SectionForces forces_at(const MemberSamples& member, std::size_t i) {
  return {member.material_force[i], member.material_moment[i]};
}

SampleNumbers fill_sample(const SectionAlong& along, const ReferenceCurve& curve, std::size_t i,
                          MemberSamples& member) {
  const double s = member.arc_length[i];
  std::optional<KnownSection> local;
  if (along.plain == nullptr) local = along.at(s);
  const KnownSection& section = local ? *local : *along.plain;
  SampleNumbers numbers;
  numbers.strain = largest_strain(section, member.force_strain[i], member.moment_strain[i]);
  member.largest_normal_stress[i] = member.largest_shear_stress[i] = member.von_mises_stress[i] = kNoStress;
  member.utilisation[i] = kNoStress;
  if (!section.stresses) return numbers;
  const LargestStresses largest = section.stresses->largest(forces_at(member, i));
  member.largest_normal_stress[i] = largest.normal.value;
  member.largest_shear_stress[i] = largest.shear.value;
  member.von_mises_stress[i] = largest.von_mises.value;
  if (section.strength) member.utilisation[i] = largest.von_mises.value / *section.strength;
  const auto kappa = curve.curvature(s);
  numbers.curvature = section.stresses->curvature_error(kappa[1], kappa[2]);
  return numbers;
}

/// Share of the von Mises stress of an I section due to torque.
double torsion_share(const KnownSection& section, SectionForces forces, double with_torque) {
  if (!section.open_walls || !(with_torque > 0.0)) return 0.0;
  forces.moment[0] = 0.0;
  return 1.0 - section.stresses->largest(forces).von_mises.value / with_torque;
}

void keep_largest(LargestAlong& largest, const std::string& member, double arc_length, double value, double limit) {
  if (!(value * largest.limit > largest.value * limit) && !largest.member.empty()) return;
  largest = {member, arc_length, value, limit};
}

bool more_stressed(const StressedMember& a, const StressedMember& b) {
  return a.stresses.von_mises.value > b.stresses.von_mises.value;
}

/// Fills a member and updates the summary of this rank.
void fill_member(const SectionAlong& along, const ReferenceCurve& curve, MemberSamples& member,
                 StressSummary& summary) {
  const std::size_t count = member.size();
  for (auto* field :
       {&member.largest_normal_stress, &member.largest_shear_stress, &member.von_mises_stress, &member.utilisation})
    field->resize(count);
  std::vector<SampleNumbers> numbers(count);
  const auto fill = [&](std::size_t i) { numbers[i] = fill_sample(along, curve, i, member); };
  const bool shared = along.plain != nullptr && count >= kSamplesForThreads;  // formulas of tapers are not thread-safe
  for (std::size_t i = 0; i < count && !shared; ++i) fill(i);
  if (shared) Kokkos::parallel_for("mixbeam::stresses", Kokkos::RangePolicy<ExecutionSpace>(0, count), fill);
  std::size_t worst = count;
  for (std::size_t i = 0; i < count; ++i) {
    keep_largest(summary.strain, member.name, member.arc_length[i], numbers[i].strain, along.largest_strain);
    keep_largest(summary.curvature, member.name, member.arc_length[i], numbers[i].curvature, kCurvatureError);
    if (!std::isnan(member.utilisation[i]))
      keep_largest(summary.utilisation, member.name, member.arc_length[i], member.utilisation[i], kAllOfStrength);
    if (std::isnan(member.von_mises_stress[i])) continue;
    if (worst == count || member.von_mises_stress[i] > member.von_mises_stress[worst]) worst = i;
  }
  if (worst == count) return;
  const KnownSection section = along.at(member.arc_length[worst]);
  StressedMember stressed{member.name,  member.arc_length[worst],
                          along.length, section.stresses->largest(forces_at(member, worst)),
                          {},           0.0};
  const double von_mises = stressed.stresses.von_mises.value;
  if (section.strength) stressed.utilisation = von_mises / *section.strength;
  stressed.torsion_share = torsion_share(section, forces_at(member, worst), von_mises);
  const auto place = std::upper_bound(summary.members.begin(), summary.members.end(), stressed, more_stressed);
  summary.members.insert(place, std::move(stressed));
  if (summary.members.size() > kMostStressed) summary.members.pop_back();
}

/// Summary as numbers exchanged between ranks; members by their number in the scene, -1: none.
constexpr std::size_t kNumbersOfMember = 14, kNumbersOfLargest = 4;
constexpr std::size_t kNumbersOfSummary = kMostStressed * kNumbersOfMember + 3 * kNumbersOfLargest;

std::vector<double> numbers_of(const StressSummary& summary, const std::map<std::string, int>& index) {
  std::vector<double> numbers;
  const auto add_stress = [&](const LargestStress& s) {
    numbers.insert(numbers.end(), {s.value, s.point[0], s.point[1]});
  };
  for (const StressedMember& m : summary.members) {
    numbers.insert(numbers.end(), {static_cast<double>(index.at(m.member)), m.arc_length, m.length});
    for (const LargestStress* s : {&m.stresses.normal, &m.stresses.shear, &m.stresses.von_mises}) add_stress(*s);
    numbers.insert(numbers.end(), {m.utilisation.value_or(-1.0), m.torsion_share});
  }
  numbers.resize(kMostStressed * kNumbersOfMember, -1.0);
  for (const LargestAlong* l : {&summary.strain, &summary.curvature, &summary.utilisation})
    numbers.insert(numbers.end(), {l->member.empty() ? -1.0 : static_cast<double>(index.at(l->member)), l->arc_length,
                                   l->value, l->limit});
  return numbers;
}

void add_numbers(const double* n, const Scene& scene, StressSummary& summary) {
  const auto name = [&](double number) { return scene.members[static_cast<std::size_t>(number)].name; };
  for (std::size_t i = 0; i < kMostStressed; ++i, n += kNumbersOfMember) {
    if (n[0] < 0.0) continue;
    const auto stress = [n](std::size_t at) { return LargestStress{n[at], {n[at + 1], n[at + 2]}}; };
    StressedMember m{name(n[0]), n[1], n[2], {stress(3), stress(6), stress(9)}, {}, n[13]};
    if (n[12] >= 0.0) m.utilisation = n[12];
    const auto same = std::find_if(summary.members.begin(), summary.members.end(),
                                   [&](const StressedMember& other) { return other.member == m.member; });
    if (same == summary.members.end())
      summary.members.push_back(std::move(m));
    else if (more_stressed(m, *same))
      *same = std::move(m);
  }
  for (LargestAlong* l : {&summary.strain, &summary.curvature, &summary.utilisation}) {
    if (n[0] >= 0.0) keep_largest(*l, name(n[0]), n[1], n[2], n[3]);
    n += kNumbersOfLargest;
  }
}

/// Merges the summaries of all ranks, each over its own samples.
StressSummary over_ranks(const Teuchos::Comm<int>& comm, const Scene& scene, const SampledMembers& members,
                         const StressSummary& mine) {
  std::map<std::string, int> index;
  for (const MemberSamples& member : members) index.emplace(member.name, member.number);
  const std::vector<double> numbers = numbers_of(mine, index);
  std::vector<double> all(kNumbersOfSummary * comm.getSize());
  Teuchos::gatherAll(comm, static_cast<int>(numbers.size()), numbers.data(), static_cast<int>(all.size()), all.data());
  StressSummary summary;
  for (int rank = 0; rank < comm.getSize(); ++rank) add_numbers(&all[kNumbersOfSummary * rank], scene, summary);
  std::stable_sort(summary.members.begin(), summary.members.end(), more_stressed);
  if (summary.members.size() > kMostStressed) summary.members.resize(kMostStressed);
  return summary;
}

}  // namespace

StressSummary sample_stresses(const Scene& scene, const Mesh& mesh, const Communicator& comm, SampledMembers& members) {
  StressedSections sections(scene, mesh);
  StressSummary summary;
  for (MemberSamples& member : members)
    fill_member(sections.of(member.number), mesh.members[member.number].curve, member, summary);
  if (comm->getSize() > 1) summary = over_ranks(*comm, scene, members, summary);
  for (const Section& section : scene.sections) summary.has_strength |= strength_of(section).has_value();
  return summary;
}

}  // namespace mixbeam
