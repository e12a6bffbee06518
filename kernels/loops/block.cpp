#include "kernels/loops/block.hpp"

#include "kernels/element/section.hpp"
#include "kernels/loops/dispatch.hpp"

#include <cmath>

namespace mixbeam {

template <int K, bool General, int W>
void residual_loop(const ElementBlock&, const StructureViews&, const StateViews&, const ElementEquations&);
template <int K, bool General, int W>
void tangent_loop(const ElementBlock&, const StructureViews&, const StateViews&, const KernelView<const double*>&,
                  const ElementEquations&);
template <int K, bool General, int W>
void recover_loop(const ElementBlock&, const StructureViews&, const StateViews&, const ElementEquations&,
                  const KernelView<const double* [6]>&, const KernelView<double*>&);

namespace {

/// Dispatches on the kind of section as well: action(order, std::bool_constant<General>).
template <class Action>
void for_kind(const ElementBlock& block, Action&& action) {
  for_order(block.order, [&](auto order) {
    if (block.general_section)
      action(order, std::true_type());
    else
      action(order, std::false_type());
  });
}

}  // namespace

void evaluate_residual(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                       const ElementEquations& equations) {
  for_kind(block, [&](auto order, auto general) {
    residual_loop<order.value, general.value, kLanes>(block, structure, state, equations);
  });
}

void evaluate_tangent(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                      const ElementEquations& equations) {
  condense_right_hand_side(block, structure, state, KernelView<const double*>(), equations);
}

void condense_right_hand_side(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                              const KernelView<const double*>& rhs_interior, const ElementEquations& equations) {
  for_kind(block, [&](auto order, auto general) {
    tangent_loop<order.value, general.value, kLanes>(block, structure, state, rhs_interior, equations);
  });
}

void recover_interior(const ElementBlock& block, const StructureViews& structure, const StateViews& state,
                      const ElementEquations& equations, const KernelView<const double* [6]>& vertex_increment,
                      const KernelView<double*>& increment) {
  for_kind(block, [&](auto order, auto general) {
    recover_loop<order.value, general.value, kLanes>(block, structure, state, equations, vertex_increment, increment);
  });
}

namespace {

// Difference between the equations and their capped tangent, theory (37): the compliance added by the cap where a
// section is (nearly) rigid, times increments of N and M.

/// Compliance that the tangent adds to the diagonal of S (capped_compliance): zero unless capped.
KOKKOS_INLINE_FUNCTION Vec cap_compliance(const Mat& compliance, double limit) {
  Vec added{{0.0, 0.0, 0.0}};
  for (int i = 0; i < 3; ++i)
    if (compliance(i, i) < 1.0 / limit) added[i] = 1.0 / limit - compliance(i, i);
  return added;
}

KOKKOS_INLINE_FUNCTION Vec scaled_by(const Vec& factor, const Vec& v) {
  return {{factor[0] * v[0], factor[1] * v[1], factor[2] * v[2]}};
}

/// `d`, `rows`: increments layout of one element; `rows` is zero on entry.
template <int K>
KOKKOS_INLINE_FUNCTION void add_cap_compliance(const SectionConstants& section, const InteriorLayout& layout,
                                               const ElementTables<K>& tables, double length, const double* d,
                                               double* rows) {
  const Vec force = load_vector(section.force_cap_compliance), moment = load_vector(section.moment_cap_compliance);
  for (int q = 0; q < layout.force_points; ++q) {
    const Vec masked{{tables.axial[q] * force[0], tables.shear[q] * force[1], tables.shear[q] * force[2]}};
    store_vector(scaled_by(masked, load_vector(d + layout.force(q))), rows + layout.force(q));
  }
  for (int j = 0; j <= K; ++j)
    store_vector((length / (2 * j + 1)) * scaled_by(moment, load_vector(d + layout.moment(j))),
                 rows + layout.moment(j));
}
template <int K>
KOKKOS_INLINE_FUNCTION void add_cap_compliance(const GeneralSection<>& section, const InteriorLayout& layout,
                                               const ElementTables<K>& tables, double length, const double* d,
                                               double* rows) {
  for (int q = 0; q < layout.force_points; ++q) {
    const Vec added = cap_compliance(section.force_force(q), section.force_stiffness_limit);
    store_vector(scaled_by(added, load_vector(d + layout.force(q))), rows + layout.force(q));
  }
  for (int q = 0; q <= K; ++q) {
    const Vec added = cap_compliance(section.moment_moment(q), section.moment_stiffness_limit);
    const double* P = tables.moment_legendre[q];
    Vec moment{{0.0, 0.0, 0.0}};
    for (int j = 0; j <= K; ++j) moment += P[j] * load_vector(d + layout.moment(j));
    const Vec strain = (0.5 * length * tables.moment_weight[q]) * scaled_by(added, moment);
    for (int j = 0; j <= K; ++j)
      for (int i = 0; i < 3; ++i) rows[layout.moment(j) + i] += P[j] * strain[i];
  }
}

template <int K, bool General>
struct CapComplianceLoop {
  ElementBlock block;
  StructureViews structure;
  KernelView<const double*> increment;
  KernelView<double*> rows;
  ElementTables<K> tables{block.force_integration};

  KOKKOS_INLINE_FUNCTION void operator()(int e) const { compute(e, rows.data() + block.increments_at()(e)); }
  KOKKOS_INLINE_FUNCTION void compute(int e, double* out) const {
    const double* d = increment.data() + block.increments_at()(e);
    const double length = block.reference(e, 0);
    for (int i = 0; i < block.interior.increments(); ++i) out[i] = 0.0;
    const SectionConstants& constants = structure.sections(block.section(e));
    if constexpr (General) {
      const GeneralSection<> general{&block.compliance(e, 0),
                                     {block.interior.order, block.interior.force_points},
                                     constants.force_stiffness_limit,
                                     constants.moment_stiffness_limit};
      add_cap_compliance<K>(general, block.interior, tables, length, d, out);
    } else {
      add_cap_compliance<K>(constants, block.interior, tables, length, d, out);
    }
  }
};

/// Finds the largest row, divided by its scale, without storing the rows.
template <int K, bool General>
struct LargestCapRowLoop {
  CapComplianceLoop<K, General> cap;
  ResidualScales scales;

  KOKKOS_INLINE_FUNCTION void operator()(int e, double& largest) const {
    double row[InteriorLayout{K, ElementTables<K>::kMaximumForcePoints}.increments()];
    cap.compute(e, row);
    scale_interior_rows(cap.block.interior, scales, cap.block.reference(e, 0), false, row);
    for (int i = 0; i < cap.block.interior.relative_rotation(1); ++i) {
      const double a = row[i] < 0.0 ? -row[i] : row[i];
      if (!(a <= largest)) largest = a == a ? a : HUGE_VAL;
    }
  }
};

}  // namespace

void cap_compliance_rows(const ElementBlock& block, const StructureViews& structure,
                         const KernelView<const double*>& increment, const KernelView<double*>& rows) {
  for_kind(block, [&](auto order, auto general) {
    const CapComplianceLoop<order.value, general.value> loop{block, structure, increment, rows};
    Kokkos::parallel_for("mixbeam::elements::cap_compliance", Kokkos::RangePolicy<ExecutionSpace>(0, block.count),
                         loop);
  });
}

double largest_cap_row(const ElementBlock& block, const StructureViews& structure,
                       const KernelView<const double*>& increment, const ResidualScales& scales) {
  double largest = 0.0;
  for_kind(block, [&](auto order, auto general) {
    const LargestCapRowLoop<order.value, general.value> loop{{block, structure, increment, KernelView<double*>()},
                                                             scales};
    Kokkos::parallel_reduce("mixbeam::elements::largest_cap_row", Kokkos::RangePolicy<ExecutionSpace>(0, block.count),
                            loop, Kokkos::Max<double>(largest));
  });
  return largest;
}

}  // namespace mixbeam
