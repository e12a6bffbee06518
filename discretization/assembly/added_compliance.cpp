#include "discretization/assembly/added_compliance.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <vector>

namespace mixbeam {

namespace {

/// Quadrature weights of the force points and of the moment points, on [-1, 1].
struct Weights {
  std::vector<double> force, moment;

  explicit Weights(const ElementBlock& block) {
    const int k = block.order, axial = axial_points(k, block.force_integration),
              shear = shear_points(k, block.force_integration);
    append(axial, force);
    if (axial != shear) append(shear, force);
    append(k + 1, moment);
  }

 private:
  static void append(int n, std::vector<double>& weights) {
    std::vector<double> xi(n), w(n);
    gauss_rule(n, xi.data(), w.data());
    weights.insert(weights.end(), w.begin(), w.end());
  }
};

double added(double compliance, double limit) { return compliance < 1.0 / limit ? 1.0 / limit - compliance : 0.0; }

double plain_element(const InteriorLayout& layout, const Weights& weights, double length,
                     const SectionConstants& section, const double* a, const double* b) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double force = added(section.force_compliance[i], section.force_stiffness_limit);
    for (int q = 0; q < layout.force_points; ++q)
      sum += 0.5 * length * weights.force[q] * force * a[layout.force(q) + i] * b[layout.force(q) + i];
    const double moment = added(section.moment_compliance[i], section.moment_stiffness_limit);
    for (int j = 0; j <= layout.order; ++j)
      sum += length / (2 * j + 1) * moment * a[layout.moment(j) + i] * b[layout.moment(j) + i];
  }
  return sum;
}

/// Legendre coefficients of component i of M, evaluated at xi.
double moment_at(const InteriorLayout& layout, double xi, int i, const double* row) {
  double P[kMaximumOrder + 1], sum = 0.0;
  legendre(layout.order, xi, P);
  for (int j = 0; j <= layout.order; ++j) sum += P[j] * row[layout.moment(j) + i];
  return sum;
}

double general_element(const InteriorLayout& layout, const Weights& weights, double length,
                       const SectionConstants& section, const double* compliance, const double* a, const double* b) {
  const GeneralSectionLayout stored{layout.order, layout.force_points};
  double sum = 0.0, xi[kMaximumOrder + 1], w[kMaximumOrder + 1];
  gauss_rule(layout.order + 1, xi, w);
  for (int i = 0; i < 3; ++i) {
    for (int q = 0; q < layout.force_points; ++q)
      sum += 0.5 * length * weights.force[q] *
             added(compliance[stored.force_force(q) + 4 * i], section.force_stiffness_limit) * a[layout.force(q) + i] *
             b[layout.force(q) + i];
    for (int q = 0; q <= layout.order; ++q)
      sum += 0.5 * length * weights.moment[q] *
             added(compliance[stored.moment_moment(q) + 4 * i], section.moment_stiffness_limit) *
             moment_at(layout, xi[q], i, a) * moment_at(layout, xi[q], i, b);
  }
  return sum;
}

void plain_strains(const InteriorLayout& layout, double length, const SectionConstants& section, const double* x,
                   double* rows) {
  for (int i = 0; i < 3; ++i) {
    const double force = added(section.force_compliance[i], section.force_stiffness_limit);
    for (int q = 0; q < layout.force_points; ++q) rows[layout.force(q) + i] = force * x[layout.force(q) + i];
    if (section.moment_compliance[i] != 0.0) continue;
    for (int j = 0; j <= layout.order; ++j)
      rows[layout.moment(j) + i] = length / (2 * j + 1) / section.moment_stiffness_limit * x[layout.moment(j) + i];
  }
}

void general_strains(const InteriorLayout& layout, double length, const SectionConstants& section,
                     const double* compliance, const double* x, double* rows) {
  const GeneralSectionLayout stored{layout.order, layout.force_points};
  double xi[kMaximumOrder + 1], w[kMaximumOrder + 1], P[kMaximumOrder + 1];
  gauss_rule(layout.order + 1, xi, w);
  for (int i = 0; i < 3; ++i) {
    for (int q = 0; q < layout.force_points; ++q)
      rows[layout.force(q) + i] =
          added(compliance[stored.force_force(q) + 4 * i], section.force_stiffness_limit) * x[layout.force(q) + i];
    for (int q = 0; q <= layout.order; ++q) {
      const double strain = 0.5 * length * w[q] *
                            added(compliance[stored.moment_moment(q) + 4 * i], section.moment_stiffness_limit) *
                            moment_at(layout, xi[q], i, x);
      legendre(layout.order, xi[q], P);
      for (int j = 0; j <= layout.order; ++j) rows[layout.moment(j) + i] += P[j] * strain;
    }
  }
}

double block_sum(const Structure& structure, const ElementBlock& block, const double* a, const double* b) {
  const Weights weights(block);
  double sum = 0.0;
  for (int e = 0; e < block.count; ++e) {
    if (block.vertices(e, 0) >= structure.owned_vertices) continue;  // counted by the rank that owns the vertex
    const size_t first = block.increment_offset + static_cast<size_t>(e) * block.interior.increments();
    const SectionConstants& section = structure.views.member_section(block.member(e));
    const double length = block.reference(e, block.reference_layout.length());
    sum += block.general_section ? general_element(block.interior, weights, length, section, &block.compliance(e, 0),
                                                   a + first, b + first)
                                 : plain_element(block.interior, weights, length, section, a + first, b + first);
  }
  return sum;
}

}  // namespace

double added_compliance(const Assembler& assembler, const MixedVector& a, const MixedVector& b) {
  double mine = 0.0;
  for (const ElementBlock& block : assembler.structure().blocks)
    mine += block_sum(assembler.structure(), block, a.interior().data(), b.interior().data());
  double all = mine;
  Teuchos::reduceAll(*assembler.map()->getComm(), Teuchos::REDUCE_SUM, mine, Teuchos::outArg(all));
  return all;
}

void added_strains(const Assembler& assembler, const MixedVector& increment, MixedVector& scaled_rhs) {
  scaled_rhs.fill(0.0);
  const Structure& structure = assembler.structure();
  const double strain = assembler.scales().strain, rotation = assembler.scales().rotation;
  const KernelView<const double*> x = increment.interior();
  const KernelView<double*> rows = scaled_rhs.writable_interior(true);
  for (const ElementBlock& block : structure.blocks)
    for (int e = 0; e < block.count; ++e) {
      const size_t first = block.increment_offset + static_cast<size_t>(e) * block.interior.increments();
      const SectionConstants& section = structure.views.member_section(block.member(e));
      const double length = block.reference(e, block.reference_layout.length());
      double* row = &rows(first);
      if (block.general_section)
        general_strains(block.interior, length, section, &block.compliance(e, 0), &x(first), row);
      else
        plain_strains(block.interior, length, section, &x(first), row);
      for (int i = 0; i < block.interior.moment(0); ++i) row[i] /= strain;
      for (int i = block.interior.moment(0); i < block.interior.relative_rotation(1); ++i) row[i] /= rotation;
    }
}

}  // namespace mixbeam
