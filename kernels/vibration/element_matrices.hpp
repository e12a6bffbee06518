/// Second variation and velocities of one element as dense matrices over all of its motions, the basis of vibrations. N
/// and M are kept as separate unknowns, so that a compliance of zero needs no special case; nothing is condensed before
/// the mass has been added.
#pragma once

#include "kernels/condensation/line_fields_tangent.hpp"
#include "kernels/condensation/tangent.hpp"

namespace mixbeam {

/// Sizes and offsets. Stresses are N and M as in InteriorLayout. Motions, the columns, are psi | beta | w as there,
/// then u_a | theta_a | u_b | theta_b, spatial. Velocities are those of the section (along its axes) and its spin at
/// each of the k + 1 moment points.
struct VibrationLayout {
  int order = 0, force_points = 0;
  constexpr int stresses() const { return 3 * (force_points + order + 1); }
  constexpr int interior() const { return 3 * (2 * order - 1); }
  constexpr int motions() const { return interior() + 12; }
  constexpr int velocities() const { return 6 * (order + 1); }
};

/// Columns of the blocks of the reduced system: an m x 3 block contributes to one or more blocks of motions.
template <int K>
struct MotionColumns {
  Mat back;  ///< Lambda_lo^T
  double inverse_length;

  static constexpr int kInterior = FullSystem<K>::kInteriorSize;
  template <class Add>
  void spread(int block, const Mat& m, const Add& add) const {
    using Blocks = ReducedBlocks<K>;
    if (block == Blocks::spin()) {
      add(kInterior - 3, m);
    } else if (block < K) {
      add(3 * (block - 1), m);
    } else if (block < Blocks::kInterior) {
      add(3 * (block - 1), m * back);
    } else if (block == Blocks::slope(0)) {
      const Mat by_end = inverse_length * (m * back);
      add(kInterior, -1.0 * by_end);
      add(kInterior + 6, by_end);
    } else {
      add(kInterior + 3 + 6 * (block - Blocks::vertex(0)), m * back);
    }
  }
};

/// Rows of a matrix whose columns are all motions.
struct MotionRows {
  double* numbers;
  int columns;

  double* row(int i) const { return numbers + static_cast<size_t>(i) * columns; }
  void add(int first_row, int first_column, const Mat& m) const {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) row(first_row + i)[first_column + j] += m(i, j);
  }
};

/// Adds du and the spin w + T(psi) dpsi at a moment point along the axes of the section, theory (8), (19).
template <int K>
void add_velocity(int q, const PointRotation<K>& rotation, double length, const ElementTables<K>& tables,
                  const MotionColumns<K>& columns, const MotionRows& velocity) {
  using Blocks = ReducedBlocks<K>;
  const Mat turned = transpose(rotation.exp), mean = 0.5 * (turned * columns.back);
  const int moved = 6 * q, turning = moved + 3;
  const auto spread = [&](int row, int block, const Mat& m) {
    columns.spread(block, m, [&](int column, const Mat& part) { velocity.add(row, column, part); });
  };
  for (int end = 0; end < 2; ++end) velocity.add(moved, MotionColumns<K>::kInterior + 6 * end, mean);
  for (int j = 0; j < K; ++j) spread(moved, Blocks::slope(j), (0.5 * length * tables.moment_bubble[q][j]) * turned);
  spread(turning, Blocks::spin(), turned);
  for (int j = 1; j < K; ++j)
    spread(turning, Blocks::psi(j), tables.moment_legendre[q][j] * transpose(rotation.tangent));
}

/// Weighted compliance of the stresses: capped as in the tangent, the true one, and the excess of the former. One
/// number per stress of a plain section, else a matrix.
struct StressCompliance {
  double *capped, *own, *excess;
};

/// Inverts a positive definite matrix in place.
inline void invert_positive(double* a, int n) {
  for (int k = 0; k < n; ++k) {
    const double inverse = 1.0 / a[k * n + k];
    a[k * n + k] = 1.0;
    for (int j = 0; j < n; ++j) a[k * n + j] *= inverse;
    for (int i = 0; i < n; ++i) {
      if (i == k) continue;
      const double factor = a[i * n + k];
      a[i * n + k] = 0.0;
      for (int j = 0; j < n; ++j) a[i * n + j] -= factor * a[k * n + j];
    }
  }
}

/// Matrices of one element; all zero on entry.
template <int K>
struct ElementMatrices {
  const ElementTables<K>& tables;
  const InteriorLayout& layout;
  const ReferenceLayout& reference;
  MotionRows strain;     ///< changes of weighted strains, (stress, motion)
  MotionRows geometric;  ///< contribution of the current stresses to the second variation
  MotionRows velocity;   ///< (velocity, motion); null: not needed

  void evaluate(const ElementInput<double>& in) const {
    const ElementKinematics<K> kinematics(in, layout);
    const MotionColumns<K> columns{transpose(kinematics.triad), 1.0 / kinematics.length};
    ReducedSystem<K> system;
    MomentRows<K> moments;
    system.clear();
    moments.clear(tables);
    const SectionNumbers<double> no_section{};
    for (int q = 0; q < tables.force_points; ++q) {
      const ForcePoint<K> point(q, in, kinematics, tables, layout, reference, no_section);
      add_force_tangent(point, Vec{{0.0, 0.0, 0.0}}, tables.force_legendre[q], system);
      add_force_strain(q, point, columns);
    }
    for (int q = 0; q <= K; ++q) {
      const MomentPoint<K> point(q, in, kinematics, tables, layout, reference);
      add_moment_tangent(q, point, tables, kinematics.length, moments, system);
      if (velocity.numbers != nullptr) add_velocity(q, point.rotation, kinematics.length, tables, columns, velocity);
    }
    for (int end = 0; end < 2; ++end)
      add_end_tangent(end, EndRotation<K>(end, in, kinematics, layout, reference), moments, system);
    add_moment_strain(moments, columns);
    add_geometric(system, columns);
  }

  /// Adds the tangent of line loads to the rows of all motions, theory (25); not symmetric.
  void add_loads(const ElementInput<double>& in, const ElementFields<>& fields, const MotionRows& loads) const {
    const ElementKinematics<K> kinematics(in, layout);
    const MotionColumns<K> columns{transpose(kinematics.triad), 1.0 / kinematics.length};
    ReducedSystem<K> none;
    none.clear();
    FullSystem<K> system(none, [](double x) { return x; });
    MeanRows<K, double> mean;
    add_field_tangent(fields, kinematics, tables, system, mean);
    const auto block = [](const auto& matrix, int I, int J) {
      Mat m{};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) m(i, j) = matrix[3 * I + i][3 * J + j];
      return m;
    };
    for (int I = 0; I < Blocks::kCount; ++I)
      for (int J = 0; J < Blocks::kCount; ++J)
        columns.spread(J, block(system.matrix, I, J), [&](int column, const Mat& half) {
          columns.spread(I, transpose(half),
                         [&](int row, const Mat& part) { loads.add(row, column, transpose(part)); });
        });
    for (int J = 0; J < K && mean.used; ++J)
      columns.spread(J, 0.5 * (kinematics.triad * block(mean.row, 0, J)), [&](int column, const Mat& part) {
        for (int end = 0; end < 2; ++end) loads.add(MotionColumns<K>::kInterior + 6 * end, column, part);
      });
  }

 private:
  using Blocks = ReducedBlocks<K>;

  void spread(const MotionRows& rows, int first_row, int block, const Mat& m, const MotionColumns<K>& columns) const {
    columns.spread(block, m, [&](int column, const Mat& part) { rows.add(first_row, column, part); });
  }
  /// Adds the rows of theory (15).
  void add_force_strain(int q, const ForcePoint<K>& point, const MotionColumns<K>& columns) const {
    const double* P = tables.force_legendre[q];
    const Mat by_slope = point.weight * transpose(point.rotation.exp);
    const Mat by_psi = point.weight * (hat(point.pulled_back) * transpose(point.rotation.tangent));
    for (int j = 0; j < K; ++j) spread(strain, layout.force(q), Blocks::slope(j), P[j] * by_slope, columns);
    spread(strain, layout.force(q), Blocks::spin(), times_hat(by_slope, point.p), columns);
    for (int j = 1; j < K; ++j) spread(strain, layout.force(q), Blocks::psi(j), P[j] * by_psi, columns);
  }
  void add_moment_strain(const MomentRows<K>& moments, const MotionColumns<K>& columns) const {
    for (int j = 0; j <= K; ++j) {
      for (int i = 1; i < K; ++i) spread(strain, layout.moment(j), Blocks::psi(i), moments.psi[j][i], columns);
      for (int end = 0; end < 2; ++end) {
        const Mat by_spin = signed_end_value(end, j) * moments.end[end];
        spread(strain, layout.moment(j), Blocks::vertex(end), by_spin, columns);
        spread(strain, layout.moment(j), Blocks::spin(), -1.0 * by_spin, columns);
      }
    }
  }
  void add_geometric(const ReducedSystem<K>& system, const MotionColumns<K>& columns) const {
    for (int I = 0; I < Blocks::kCount; ++I)
      for (int J = 0; J <= I; ++J)
        columns.spread(J, system(I, J), [&](int column, const Mat& half) {
          columns.spread(I, transpose(half), [&](int row, const Mat& part) {
            geometric.add(row, column, transpose(part));
            if (I != J) geometric.add(column, row, part);
          });
        });
  }
};

/// Compliance of a plain section: one number per stress, `capped` inverted.
template <int K>
void stress_compliance(const SectionConstants& section, const InteriorLayout& layout, const ElementTables<K>& tables,
                       double length, const StressCompliance& to) {
  for (int i = 0; i < 3; ++i) {
    for (int q = 0; q < tables.force_points; ++q) {
      const double mask = i == 0 ? tables.axial[q] : tables.shear[q];
      const double weight = 0.5 * length * tables.force_weight[q];
      to.capped[layout.force(q) + i] = mask * section.tangent_force_stiffness[i] / weight;
      to.own[layout.force(q) + i] = mask * weight * section.force_compliance[i];
      to.excess[layout.force(q) + i] = mask * weight * section.force_cap_compliance[i];
    }
    for (int j = 0; j <= K; ++j) {
      const double weight = length / (2 * j + 1);
      to.capped[layout.moment(j) + i] = section.moment_stiffness[i] / weight;
      to.own[layout.moment(j) + i] = weight * section.moment_compliance[i];
      to.excess[layout.moment(j) + i] = weight * section.moment_cap_compliance[i];
    }
  }
}

/// Compliance of a general section: matrices, zero on entry, `capped` inverted.
template <int K>
void stress_compliance(const GeneralSection<>& section, const InteriorLayout& layout, const ElementTables<K>& tables,
                       double length, const StressCompliance& to) {
  const int n = layout.relative_rotation(1);
  const auto add = [n](double* matrix, int row, int column, double factor, const Mat& m) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) matrix[(row + i) * n + column + j] += factor * m(i, j);
  };
  for (int q = 0; q < tables.force_points; ++q) {
    const double weight = 0.5 * length * tables.force_weight[q];
    const Mat own = section.force_force(q), capped = capped_compliance(own, section.force_stiffness_limit);
    add(to.capped, layout.force(q), layout.force(q), weight, capped);
    add(to.own, layout.force(q), layout.force(q), weight, own);
    add(to.excess, layout.force(q), layout.force(q), weight, capped - own);
    for (int j = 0; j < K; ++j) {
      const double factor = weight * tables.force_legendre[q][j];
      for (double* matrix : {to.capped, to.own}) {
        add(matrix, layout.force(q), layout.moment(j), factor, section.force_moment(q));
        add(matrix, layout.moment(j), layout.force(q), factor, transpose(section.force_moment(q)));
      }
    }
  }
  for (int q = 0; q <= K; ++q) {
    const Mat own = section.moment_moment(q), capped = capped_compliance(own, section.moment_stiffness_limit);
    const double* P = tables.moment_legendre[q];
    for (int j = 0; j <= K; ++j)
      for (int l = 0; l <= K; ++l) {
        const double factor = 0.5 * length * tables.moment_weight[q] * P[j] * P[l];
        add(to.capped, layout.moment(j), layout.moment(l), factor, capped);
        add(to.own, layout.moment(j), layout.moment(l), factor, own);
        add(to.excess, layout.moment(j), layout.moment(l), factor, capped - own);
      }
  }
  invert_positive(to.capped, n);
}

}  // namespace mixbeam
