#include "discretization/mesh/element_compliance.hpp"

#include "discretization/text/errors.hpp"

#include <stdexcept>

namespace mixbeam {

namespace {

/// One 3 x 3 block of the compliance, row-major.
void store_block(const Matrix6& compliance, int first_row, int first_column, double* out) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out[3 * i + j] = compliance[first_row + i][first_column + j];
}

/// `compliance_at(xi)` of one element, written as GeneralSectionLayout has it.
template <class ComplianceAt>
void fill_element(const GeneralSectionLayout& layout, const ComplianceAt& compliance_at, double* row) {
  double xi[kMaximumOrder + 1], weight[kMaximumOrder + 1];
  gauss_rule(layout.force_points, xi, weight);
  for (int q = 0; q < layout.force_points; ++q) {
    const Matrix6 compliance = compliance_at(xi[q]);
    store_block(compliance, 0, 0, row + layout.force_force(q));
    store_block(compliance, 0, 3, row + layout.force_moment(q));
  }
  gauss_rule(layout.order + 1, xi, weight);
  for (int q = 0; q <= layout.order; ++q) store_block(compliance_at(xi[q]), 3, 3, row + layout.moment_moment(q));
}

[[noreturn]] void fail(const Member& member, const std::string& what) {
  throw InputError("member \"" + member.name + "\": " + what);
}

}  // namespace

MemberLaws member_laws(const Scene& scene) {
  MemberLaws laws(scene.members.size());
  for (size_t m = 0; m < scene.members.size(); ++m) {
    const Member& member = scene.members[m];
    if (!has_general_section(scene, member)) continue;
    if (member.force_integration != ForceIntegration::both_reduced)
      fail(member, "coupled and tapered sections need the force integration \"both reduced\"");
    try {
      laws[m] = std::make_shared<const SectionLaw>(scene, member);
    } catch (const std::invalid_argument& error) {
      fail(member, error.what());
    }
  }
  return laws;
}

void fill_compliance(const Scene& scene, const Mesh& mesh, const MemberLaws& laws, const int* mesh_element,
                     ElementBlock& block) {
  const GeneralSectionLayout layout{block.order, block.interior.force_points};
  block.compliance = KernelView<double**>("mixbeam::compliance", block.count, layout.size());
  for (int e = 0; e < block.count; ++e) {
    const MeshElement& element = mesh.elements[mesh_element[e]];
    const double length = mesh.members[element.member].curve.length;
    const SectionLaw& law = *laws[element.member];
    try {
      fill_element(
          layout, [&](double xi) { return law.compliance(mesh.arc_length(element, xi) / length); },
          &block.compliance(e, 0));
    } catch (const std::invalid_argument& error) {
      fail(scene.members[element.member], error.what());
    }
  }
}

}  // namespace mixbeam
