#include "discretization/assembly/rotating_elements.hpp"

#include "discretization/mesh/element_view.hpp"
#include "discretization/mesh/reference_element.hpp"
#include "discretization/scene/mass.hpp"
#include "kernels/math/vector_algebra.hpp"

#include <algorithm>

namespace mixbeam {

void fill_masses(const Scene& scene, const Mesh& mesh, const Structure& structure, const ElementBlock& block,
                 const KernelView<double**>& mass) {
  const GaussPoints& rule = gauss_points(block.order + 1);
  int member = -1;
  SectionLaw law;
  std::array<double, kMassNumbers> factor{};
  for (int e = 0; e < block.count; ++e) {
    const MeshElement& element = mesh.elements[ElementView(structure, block, e).mesh_element()];
    const Member& of = scene.members[element.member];
    if (element.member != member) {
      member = element.member;
      law = SectionLaw(scene, of);
      factor = mass_factor(law.section(0.0));
    }
    const double length = mesh.members[member].curve.length;
    for (size_t q = 0; q < rule.xi.size(); ++q) {
      if (!of.end_section.empty()) factor = mass_factor(law.section(mesh.arc_length(element, rule.xi[q]) / length));
      std::copy(factor.begin(), factor.end(), &mass(e, static_cast<int>(q) * kMassNumbers));
    }
  }
}

RotatingElements::RotatingElements(const Scene& scene, const Mesh& mesh, const Structure& structure,
                                   const FrameSpin& spin)
    : spin_(spin) {
  for (const ElementBlock& block : structure.blocks) {
    FrameViews views;
    views.mass = KernelView<double**>("mixbeam::frame::mass", block.count, kMassNumbers * (block.order + 1));
    views.place = KernelView<double**>("mixbeam::frame::place", block.count, 3 * (block.order + 1));
    fill_masses(scene, mesh, structure, block, views.mass);
    const GaussPoints& rule = gauss_points(block.order + 1);
    for (int e = 0; e < block.count; ++e) {
      const MeshElement& element = mesh.elements[ElementView(structure, block, e).mesh_element()];
      const ReferenceCurve& curve = mesh.members[element.member].curve;
      for (int q = 0; q <= block.order; ++q) {
        const Vec place = curve.position(mesh.arc_length(element, rule.xi[q])) - spin_.point();
        store_vector(place, &views.place(e, 3 * q));
        const double root = views.mass(e, kMassNumbers * q);  // of the mass per length
        const double force = root * root * norm(cross(spin_.full(), cross(spin_.full(), place)));
        largest_force_ = std::max(largest_force_, force * curve.length);
      }
    }
    blocks_.push_back(views);
  }
}

void RotatingElements::add_rows(const Structure& structure, const State& state, const Vec& spin, double factor,
                                const ElementEquations& to) const {
  for (size_t b = 0; b < blocks_.size(); ++b)
    add_centrifugal_rows(structure.blocks[b], frame(b, spin), state.views, factor,
                         to.scales_interior ? &to.interior_scales : nullptr, to.interior_residual, to.residual);
}

double RotatingElements::energy(const Structure& structure, const State& state, double load_factor) const {
  const KernelView<double*> energies("mixbeam::frame::energies", structure.local_elements());
  for (size_t b = 0; b < blocks_.size(); ++b)
    centrifugal_energies(structure.blocks[b], frame(b, spin_.at(load_factor)), state.views, energies);
  double sum = 0.0;
  for_each_owned_element(structure, state, [&](const ElementView& element) { sum += energies(element.local()); });
  return sum;
}

std::unique_ptr<const RotatingElements> rotating_elements(const Scene& scene, const Mesh& mesh,
                                                          const Structure& structure, const FrameSpin& spin) {
  const auto has_mass = [](const Section& section) { return section.mass > 0.0; };
  if (!spin.turns() || std::none_of(scene.sections.begin(), scene.sections.end(), has_mass)) return nullptr;
  return std::make_unique<RotatingElements>(scene, mesh, structure, spin);
}

}  // namespace mixbeam
