#include "discretization/assembly/cap.hpp"

#include "discretization/assembly/workspace.hpp"
#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "discretization/mesh/vertex_partition.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>

namespace mixbeam {

namespace {

/// Elements that lock carry parasitic forces of the order of their stiffness, far above the loads: with the cap of
/// other elements Newton's method needs hundreds of steps. Studies of locking trade condition for convergence.
constexpr double kCapForLockingElements = 1e3;

/// Rounding errors of the assembled and factorised tangent act like springs to the ground, eps * cap / h each. They
/// disturb an increment by 3e-12 * cap * L/h (measured on chains of 1e3 to 1e6 elements), which must stay well below
/// one for fast convergence of Newton's method.
constexpr double kCapTimesElements = 1e9;
/// Cap times elements of networks, whose members share the disturbance: sheets of 60 and 100 struts a side, slenderness
/// 20 to 1000, take no more iterations with it, and fewer factorisations where it does not cut off any stiffness.
constexpr double kCapTimesElementsOfNetworks = 1e11;

/// A lower cap would slow Newton's method more than rounding errors do; a mesh whose shortest element is 1e-9 of its
/// length needs no lower one.
constexpr double kLeastCap = 1e3;

/// Members of a network share forces by their stiffness, so the compliance of the cap must be corrected with each
/// tangent, up to twenty times. The cap of networks is therefore higher, as far as rounding errors permit: above the
/// stiffness of most members.
constexpr double kRaiseOfNetworks = 1e3;

/// Each iteration leaves a strain of (change of N)/cap. The cap must thus be large compared with the acting forces, but
/// no larger: the condition of the condensed tangent grows with it, and with it the error of every increment. Where
/// forces are shared by stiffness the strain would remain; cap_compliance_rows() computes it.
double cap_stiffness(const Model& model, const ResidualScales& scales, double raise) {
  const Structure& structure = model.structure();
  const double bending = structure.bending_reference / (structure.length * structure.length);
  const double elements = structure.length / structure.shortest_element;
  const double usual = model.options().force_stiffness_cap;
  double factor = raise * std::min(usual, std::max(kLeastCap, kCapTimesElements / elements));
  if (independent_loops(model.mesh()) >= kLeastLoopsOfNetwork) {
    const double most = std::max(kLeastCap, kCapTimesElementsOfNetworks / elements);
    factor = std::max(factor, std::min(raise, 1.0) * std::min(kRaiseOfNetworks * usual, most));
  }
  return factor * std::max(bending, scales.force);
}

/// Compliance that a limit of the stiffness adds to one.
double added(double compliance, double limit) { return compliance < 1.0 / limit ? 1.0 / limit - compliance : 0.0; }

/// Sets stiffness and added compliance of a component.
void cap_component(double limit, double compliance, double& more, double& stiffness) {
  more = added(compliance, limit);
  stiffness = more > 0.0 ? limit : 1.0 / compliance;
}

}  // namespace

Cap cap_for(const Model& model, const ResidualScales& scales, double raise) {
  Workspace& workspace = model.workspace();
  const double stiffness = cap_stiffness(model, scales, raise);
  const double moment_limit = stiffness * model.structure().length * model.structure().length;  // above any EI or GIt
  const KernelView<const SectionConstants*> uncapped = model.structure().views.sections;
  Cap cap{stiffness};
  const auto note = [&cap](double compliance, double limit) {
    if (added(compliance, limit) == 0.0) return;
    const double ratio = compliance * limit;
    cap.cuts_off = true;
    if (ratio > 0.0 && (cap.least_ratio == 0.0 || ratio < cap.least_ratio)) cap.least_ratio = ratio;
  };
  cap.structure.sections = workspace.sections.take("mixbeam::capped_sections", uncapped.extent(0));
  for (size_t s = 0; s < uncapped.extent(0); ++s) {
    SectionConstants& section = cap.structure.sections(s) = uncapped(s);
    const bool locks = model.structure().section_locks[s] != 0;
    section.force_stiffness_limit = locks ? kCapForLockingElements * stiffness : stiffness;
    section.moment_stiffness_limit = moment_limit;
    const double* least = &model.structure().least_compliance[6 * s];
    for (int i = 0; i < 3; ++i) {
      cap_component(section.force_stiffness_limit, section.force_compliance[i], section.force_cap_compliance[i],
                    section.tangent_force_stiffness[i]);
      cap_component(moment_limit, section.moment_compliance[i], section.moment_cap_compliance[i],
                    section.moment_stiffness[i]);
      note(least[i], section.force_stiffness_limit);
      note(least[3 + i], moment_limit);
    }
  }
  return cap;
}

void cap_compliance_rows(const Model& model, const Cap& cap, const ResidualScales& scales, const MixedVector& increment,
                         MixedVector& rows) {
  Kokkos::deep_copy(rows.vertex(), 0.0);
  {
    const KernelView<double*> interior = rows.writable_interior(false);
    for (const ElementBlock& block : model.structure().blocks)
      cap_compliance_rows(block, cap.structure, increment.interior(), interior);
  }  // a view still held would count as another owner, and the rows would be copied
  scale_rows(model, scales, rows);
}

double largest_cap_compliance_row(const Model& model, const Cap& cap, const ResidualScales& scales,
                                  const MixedVector& increment) {
  double largest = 0.0;
  for (const ElementBlock& block : model.structure().blocks)
    largest = std::max(largest, largest_cap_row(block, cap.structure, increment.interior(), scales));
  return maximum_over_ranks(*model.map()->getComm(), largest);
}

namespace {

/// Form of (capped compliance - true compliance) in the increments a and b of one element.
double form_of_element(const ElementView& element, const SectionConstants& section, const double* a, const double* b) {
  const InteriorLayout& layout = element.layout();
  const int order = element.order();
  const bool is_general = element.block().general_section;
  const GeneralSectionLayout stored{order, layout.force_points};
  const double* compliance = is_general ? &element.block().compliance(element.index(), 0) : nullptr;
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    for_each_force_rule(order, element.block().force_integration, [&](int first, int count, int begin, int end) {
      for (int q = first; q < first + count && begin <= i && i < end; ++q) {
        const double own = is_general ? compliance[stored.force_force(q) + 4 * i] : section.force_compliance[i];
        sum += 0.5 * element.length() * gauss_points(count).weight[q - first] *
               added(own, section.force_stiffness_limit) * a[layout.force(q) + i] * b[layout.force(q) + i];
      }
    });
    for (int j = 0; j <= order && !is_general; ++j)
      sum += element.length() / (2 * j + 1) * added(section.moment_compliance[i], section.moment_stiffness_limit) *
             a[layout.moment(j) + i] * b[layout.moment(j) + i];
  }
  if (!is_general) return sum;
  const GaussPoints& rule = gauss_points(order + 1);
  for (int q = 0; q <= order; ++q) {
    double P[kMaximumOrder + 1];
    legendre(order, rule.xi[q], P);
    for (int i = 0; i < 3; ++i) {
      double at_a = 0.0, at_b = 0.0;
      for (int j = 0; j <= order; ++j) {
        at_a += P[j] * a[layout.moment(j) + i];
        at_b += P[j] * b[layout.moment(j) + i];
      }
      sum += 0.5 * element.length() * rule.weight[q] *
             added(compliance[stored.moment_moment(q) + 4 * i], section.moment_stiffness_limit) * at_a * at_b;
    }
  }
  return sum;
}

}  // namespace

double cap_compliance_form(const Model& model, const Cap& cap, const MixedVector& a, const MixedVector& b) {
  double mine = 0.0;
  for_each_element(model.structure(), [&](const ElementView& element) {
    if (!element.is_owned()) return;  // counted by the rank that owns its first vertex
    mine += form_of_element(element, cap.structure.sections(element.block().section(element.index())),
                            element.increments_in(a.interior()), element.increments_in(b.interior()));
  });
  return sum_over_ranks(*model.map()->getComm(), mine);
}

}  // namespace mixbeam
