#include "kernels/vibration/vibration.hpp"

#include "kernels/condensation/row_pivoting.hpp"
#include "kernels/execution/pack.hpp"
#include "kernels/loops/dispatch.hpp"

#include <cmath>
#include <utility>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

/// y += A x, A of `rows` x `columns` with row stride `stride`; x holds numbers or several columns.
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_product(const double* a, int rows, int columns, int stride, const Real* x,
                                             Real* y) {
  for (int i = 0; i < rows; ++i) {
    if constexpr (std::is_same_v<Real, double>) {
      double sum = 0.0;
#pragma omp simd reduction(+ : sum)
      for (int j = 0; j < columns; ++j) sum += a[i * stride + j] * x[j];
      y[i] += sum;
    } else {
      for (int j = 0; j < columns; ++j) y[i] += a[i * stride + j] * x[j];
    }
  }
}
/// y += A^T x
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void add_transposed_product(const double* a, int rows, int columns, int stride,
                                                        const Real* x, Real* y) {
  for (int i = 0; i < rows; ++i)
#pragma omp simd
    for (int j = 0; j < columns; ++j) y[j] += a[i * stride + j] * x[i];
}

/// Symmetric matrix over the stresses: diagonal or full.
struct StressMatrix {
  const double* numbers;
  int size;
  bool is_diagonal;

  double entry(int i, int j) const { return is_diagonal ? (i == j ? numbers[i] : 0.0) : numbers[i * size + j]; }
  void multiply(const double* x, double* y) const {
    for (int i = 0; i < size; ++i) y[i] = is_diagonal ? numbers[i] * x[i] : 0.0;
    if (!is_diagonal) add_product(numbers, size, size, size, x, y);
  }
};

StressMatrix of_element(const VibratingBlock& vibrating, const KernelView<double**>& numbers, int e) {
  return {&numbers(e, 0), vibrating.layout().stresses(), !vibrating.block.general_section};
}

constexpr int kMostStresses = 3 * (2 * kMaximumOrder + 1 + kMaximumOrder + 1);
constexpr int kMostMotions = VibrationLayout{kMaximumOrder, 0}.motions();

/// L U with row pivoting of an n x n matrix; `pivots` records the row exchanges.
void factorize(double* a, int n, int* pivots) {
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::fabs(a[i * n + k]) > std::fabs(a[pivot * n + k])) pivot = i;
    pivots[k] = pivot;
    for (int j = 0; j < n && pivot != k; ++j) std::swap(a[k * n + j], a[pivot * n + j]);
    const double inverse = 1.0 / a[k * n + k];
    for (int i = k + 1; i < n; ++i) {
      const double factor = a[i * n + k] *= inverse;
      for (int j = k + 1; j < n; ++j) a[i * n + j] -= factor * a[k * n + j];
    }
  }
}
template <class Real>
KOKKOS_FORCEINLINE_FUNCTION void solve_factors(const double* a, int n, const int* pivots, Real* x) {
  for (int k = 0; k < n; ++k) std::swap(x[k], x[pivots[k]]);  // all before any: rows of L were exchanged too
  for (int k = 0; k < n; ++k)
    for (int i = k + 1; i < n; ++i) x[i] -= a[i * n + k] * x[k];
  for (int k = n - 1; k >= 0; --k) {
    for (int j = k + 1; j < n; ++j) x[k] -= a[k * n + j] * x[j];
    x[k] = x[k] / a[k * n + k];
  }
}

/// Solves with the transpose.
void solve_transposed_factors(const double* a, int n, const int* pivots, double* x) {
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < k; ++i) x[k] -= a[i * n + k] * x[i];
    x[k] /= a[k * n + k];
  }
  for (int k = n - 1; k >= 0; --k)
    for (int i = k + 1; i < n; ++i) x[k] -= a[i * n + k] * x[i];
  for (int k = n - 1; k >= 0; --k) std::swap(x[k], x[pivots[k]]);
}

/// `count` momenta of a point: velocities times roots of mass and weight.
void scale_velocities(const double* mass, double root, int columns, const double* velocities, int count, double* rows) {
  for (int i = 0; i < count; ++i)
    for (int c = 0; c < columns; ++c) {
      double sum = 0.0;
      for (int j = i; j < 6; ++j) sum += mass[triangle(j, i)] * velocities[j * columns + c];
      rows[i * columns + c] = root * sum;
    }
}

ElementInput<double> input_of(const ElementBlock& block, const StateViews& state, int e) {
  ElementInput<double> in;
  for (int end = 0; end < 2; ++end) {
    const int vertex = block.vertices(e, end);
    in.displacement[end] = load_vector(&state.vertex_displacement(vertex, 0));
    in.vertex_rotation[end] = load_quaternion(&state.vertex_rotation(vertex, 0));
  }
  in.triad = load_quaternion(&state.element_triad(block.first_element + e, 0));
  in.interior = state.interior.data() + block.unknowns_at()(e);
  in.reference = &block.reference(e, 0);
  return in;
}

template <int K>
CarriedElement<K> carried(const FrameViews& frame, int e, const ElementTables<K>& tables,
                          const ElementInput<double>& in, const ElementKinematics<K>& kinematics) {
  return {tables,    kinematics, 0.5 * (in.displacement[0] + in.displacement[1]), &frame.mass(e, 0), &frame.place(e, 0),
          frame.spin};
}

/// Row j among those of VibratingBlock::rows().
const double* row_of(const VibratingBlock& vibrating, int e, int j, int motions) {
  const int capped = j - vibrating.momenta();
  return capped < 0 ? &vibrating.momentum(e, j * motions) : &vibrating.strain(e, vibrating.capped(capped) * motions);
}

template <int K>
struct VibrationLoop {
  VibratingBlock vibrating;
  StructureViews structure;
  StateViews state;
  double shift;
  VibrationUse use;
  KernelView<double**> tangent;
  FrameViews frame;
  ElementTables<K> tables{vibrating.block.force_integration};

  static constexpr int kInterior = FullSystem<K>::kInteriorSize, kMotions = kInterior + 12;

  void operator()(int e) const {
    const ElementBlock& block = vibrating.block;
    const bool has_inertia = vibrating.momentum.extent(0) > 0, moves = has_inertia || frame.turns();
    double matrix[kMotions * kMotions] = {}, velocity[6 * (K + 1) * kMotions];
    double* strain = &vibrating.strain(e, 0);
    std::fill_n(strain, vibrating.layout().stresses() * kMotions, 0.0);
    if (moves) std::fill_n(velocity, 6 * (K + 1) * kMotions, 0.0);
    const MotionRows velocities{moves ? velocity : nullptr, kMotions};
    const ElementInput<double> in = input_of(block, state, e);
    const ElementMatrices<K> matrices{
        tables, block.interior, block.reference_layout, {strain, kMotions}, {matrix, kMotions}, velocities};
    matrices.evaluate(in);
    if (frame.turns()) {
      const ElementKinematics<K> kinematics(in, block.interior);
      carried(frame, e, tables, in, kinematics).add_second_variation(velocities, {matrix, kMotions});
    }
    const double length = block.reference(e, 0);
    const int own = vibrating.velocities_of_point();
    for (int q = 0; q <= K && has_inertia; ++q)
      scale_velocities(&vibrating.mass(e, kMassNumbers * q), std::sqrt(0.5 * length * tables.moment_weight[q]),
                       kMotions, velocities.row(6 * q), own, &vibrating.momentum(e, own * q * kMotions));
    std::copy_n(matrix, kMotions * kMotions, &vibrating.geometric(e, 0));
    set_compliance(e, length);
    const bool unsymmetric = block.is_unsymmetric(e);
    if (use == VibrationUse::matrices) {
      if (unsymmetric && !has_inertia) add_loads(matrices, in, e, matrix);
      return;
    }
    add_stiffness(of_element(vibrating, vibrating.compliance, e), strain, matrix);
    for (int v = 0; v < own * (K + 1) && shift != 0.0; ++v) {
      const double* momentum = &vibrating.momentum(e, v * kMotions);
      for (int i = 0; i < kMotions; ++i)
        for (int j = 0; j < kMotions; ++j) matrix[i * kMotions + j] += shift * momentum[i] * momentum[j];
    }
    if (unsymmetric) add_loads(matrices, in, e, matrix);
    if (use == VibrationUse::counted) count(e, matrix);
    condense(e, matrix, unsymmetric);
    if (use == VibrationUse::columns) pass(e);
  }

 private:
  /// Adds the loads, also to the stored H if the block has no inertia.
  void add_loads(const ElementMatrices<K>& matrices, const ElementInput<double>& in, int e, double* matrix) const {
    if (vibrating.momentum.extent(0) > 0) return matrices.add_loads(in, fields(e), {matrix, kMotions});
    double loads[kMotions * kMotions] = {};
    matrices.add_loads(in, fields(e), {loads, kMotions});
    for (int i = 0; i < kMotions; ++i)
      for (int j = 0; j < kMotions; ++j) {
        const double load = vibrating.transposed ? loads[j * kMotions + i] : loads[i * kMotions + j];
        matrix[i * kMotions + j] += load;
        vibrating.geometric(e, i * kMotions + j) += load;
      }
  }
  ElementFields<> fields(int e) const {
    ElementFields<> result;
    for (int i = 0; i < kLineFields; ++i)
      if (const int row = vibrating.block.field_row(e, i); row >= 0) result.values[i] = &structure.field_value(row, 0);
    return result;
  }
  void set_compliance(int e, double length) const {
    const ElementBlock& block = vibrating.block;
    const SectionConstants& constants = structure.sections(block.section(e));
    const StressCompliance to{&vibrating.compliance(e, 0), &vibrating.own(e, 0), &vibrating.excess(e, 0)};
    if (block.general_section) {
      std::fill_n(to.capped, vibrating.compliance.extent(1), 0.0);
      std::fill_n(to.own, vibrating.own.extent(1), 0.0);
      std::fill_n(to.excess, vibrating.excess.extent(1), 0.0);
      stress_compliance<K>(GeneralSection<>{&block.compliance(e, 0),
                                            {block.interior.order, block.interior.force_points},
                                            constants.force_stiffness_limit,
                                            constants.moment_stiffness_limit},
                           block.interior, tables, length, to);
    } else {
      stress_compliance<K>(constants, block.interior, tables, length, to);
    }
  }
  /// + D^T S^-1 D
  static void add_stiffness(const StressMatrix& compliance, const double* strain, double* matrix) {
    for (int s = 0; s < compliance.size; ++s)
      for (int t = compliance.is_diagonal ? s : 0; t < (compliance.is_diagonal ? s + 1 : compliance.size); ++t) {
        const double c = compliance.entry(s, t);
        for (int i = 0; i < kMotions; ++i) {
          const double factor = c * strain[s * kMotions + i];
          if (factor == 0.0) continue;
          for (int j = 0; j < kMotions; ++j) matrix[i * kMotions + j] += factor * strain[t * kMotions + j];
        }
      }
  }
  void count(int e, const double* matrix) const {
    double interior[kInterior][kInterior];
    for (int i = 0; i < kInterior; ++i)
      for (int j = 0; j < kInterior; ++j) interior[i][j] = matrix[i * kMotions + j];
    const InteriorSigns signs = count_negative<kInterior, kInterior>(interior);
    vibrating.negative(e) = signs.uncertain ? kUncertainCount : signs.negative;
  }
  void condense(int e, const double* matrix, bool unsymmetric) const {
    double *factors = &vibrating.factors(e, 0), *response = &vibrating.response(e, 0);
    int* pivots = &vibrating.pivots(e, 0);
    for (int i = 0; i < kInterior; ++i)
      for (int j = 0; j < kInterior; ++j) factors[i * kInterior + j] = matrix[i * kMotions + j];
    factorize(factors, kInterior, pivots);
    for (int c = 0; c < 12; ++c) {
      double x[kInterior];
      for (int i = 0; i < kInterior; ++i) x[i] = -matrix[i * kMotions + kInterior + c];
      solve_factors(factors, kInterior, pivots, x);
      for (int i = 0; i < kInterior; ++i) response[i * 12 + c] = x[i];
    }
    for (int c = 0; c < 12 && vibrating.left.extent(0) > 0; ++c) {
      double x[kInterior];
      for (int i = 0; i < kInterior; ++i) x[i] = -matrix[(kInterior + c) * kMotions + i];
      solve_transposed_factors(factors, kInterior, pivots, x);
      for (int i = 0; i < kInterior; ++i) vibrating.left(e, i * 12 + c) = x[i];
    }
    double condensed[12][12];
    for (int r = 0; r < 12; ++r)
      for (int c = 0; c < 12; ++c) {
        double sum = matrix[(kInterior + r) * kMotions + kInterior + c];
        for (int i = 0; i < kInterior; ++i) sum += matrix[(kInterior + r) * kMotions + i] * response[i * 12 + c];
        condensed[r][c] = sum;
      }
    double* out = &tangent(vibrating.block.first_element + e, 0);
    for (int r = 0; r < 12; ++r)
      for (int c = 0; c < 12; ++c)
        out[12 * r + c] = unsymmetric ? condensed[r][c] : 0.5 * (condensed[r][c] + condensed[c][r]);
  }
  void pass(int e) const {
    const int rows = vibrating.rows();
    const auto add_ends = [&](const double* row, const KernelView<double**>& response, double* to) {
      std::copy_n(row + kInterior, 12, to);
      add_transposed_product(&response(e, 0), kInterior, 12, 12, row, to);
    };
    for (int j = 0; j < rows; ++j) {
      const double* row = row_of(vibrating, e, j, kMotions);
      double x[kInterior];
      std::copy_n(row, kInterior, x);
      solve_factors(&vibrating.factors(e, 0), kInterior, &vibrating.pivots(e, 0), x);
      for (int i = 0; i < rows; ++i) {
        double sum = 0.0;
        add_product(row_of(vibrating, e, i, kMotions), 1, kInterior, kInterior, x, &sum);
        vibrating.passed(e, rows * i + j) = sum;
      }
      add_ends(row, vibrating.response, &vibrating.by_ends(e, 12 * j));
      if (vibrating.left.extent(0) > 0) add_ends(row, vibrating.left, &vibrating.left_by_ends(e, 12 * j));
    }
  }
};

/// Calls action(element, its layout) for each element of a block, with sizes known at compile time.
template <class Action>
void for_each_of(const char* label, const VibratingBlock& vibrating, const Action& action) {
  const int points = vibrating.block.interior.force_points;
  for_order(vibrating.block.order, [&](auto order) {
    Kokkos::parallel_for(label, Range(0, vibrating.block.count), [=](int e) {
      action(e, VibrationLayout{decltype(order)::value, points});
    });
  });
}

/// Motions of both vertices of an element.
void load_ends(const VibratingBlock& vibrating, const KernelView<const double* [6]>& vertex, int e, double* ends) {
  for (int end = 0; end < 2; ++end)
    for (int i = 0; i < 6; ++i) ends[6 * end + i] = vertex(vibrating.block.vertices(e, end), i);
}

/// Loads all motions of an element; returns its stresses.
const double* load_motions(const VibratingBlock& vibrating, int e, const VibrationLayout& layout,
                           const KernelView<const double* [6]>& vertex, const KernelView<const double*>& increment,
                           double* motions) {
  const double* stress = increment.data() + vibrating.block.increments_at()(e);
  std::copy_n(stress + layout.stresses(), layout.interior(), motions);
  load_ends(vibrating, vertex, e, motions + layout.interior());
  return stress;
}

/// Eliminates the stresses from the rows of all motions: dN = S^-1 (D dx + r) leaves f - D^T S^-1 r.
KOKKOS_FORCEINLINE_FUNCTION void eliminate_stresses(const VibratingBlock& vibrating, int e,
                                                    const VibrationLayout& layout, const double* rows,
                                                    double* motions) {
  const double* end = rows + layout.stresses();
  if (std::all_of(rows, end, [](double x) { return x == 0.0; })) return;
  double stress[kMostStresses];
  of_element(vibrating, vibrating.compliance, e).multiply(rows, stress);
  const double* strain = &vibrating.strain(e, 0);
  for (int s = 0; s < layout.stresses(); ++s) {
    const double factor = stress[s];
    if (factor == 0.0) continue;
#pragma omp simd
    for (int i = 0; i < layout.motions(); ++i) motions[i] -= strain[s * layout.motions() + i] * factor;
  }
}

}  // namespace

ElementBlock part_of(const ElementBlock& block, int first, int count) {
  const auto rows = std::make_pair(first, first + count);
  ElementBlock part = block;
  part.first_element += first;
  part.count = count;
  part.interior_offset = block.unknowns_at()(first);
  part.increment_offset = block.increments_at()(first);
  part.response_offset += static_cast<size_t>(first) * static_cast<size_t>(block.response_size());
  part.reference = block.reference.part(rows);
  part.vertices = Kokkos::subview(block.vertices, rows, Kokkos::ALL);
  part.section = Kokkos::subview(block.section, rows);
  if (block.general_section) part.compliance = Kokkos::subview(block.compliance, rows, Kokkos::ALL);
  if (block.field_row.extent(0) > 0) part.field_row = Kokkos::subview(block.field_row, rows, Kokkos::ALL);
  return part;
}

VibratingBlock allocate_static_block(const ElementBlock& block, int count, bool condenses) {
  VibratingBlock made{block};
  const VibrationLayout layout = made.layout();
  const int n = layout.interior(), m = layout.motions(), s = layout.stresses();
  const int numbers = block.general_section ? s * s : s;
  made.strain = KernelView<double**>("mixbeam::vibration::strain", count, s * m);
  made.geometric = KernelView<double**>("mixbeam::vibration::geometric", count, m * m);
  made.compliance = KernelView<double**>("mixbeam::vibration::compliance", count, numbers);
  made.own = KernelView<double**>("mixbeam::vibration::own", count, numbers);
  made.excess = KernelView<double**>("mixbeam::vibration::excess", count, numbers);
  if (!condenses) return made;
  made.factors = KernelView<double**>("mixbeam::vibration::factors", count, n * n);
  made.response = KernelView<double**>("mixbeam::vibration::response", count, 12 * n);
  for (int e = 0; e < block.count && made.left.extent(0) == 0; ++e)
    if (block.is_unsymmetric(e)) made.left = KernelView<double**>("mixbeam::vibration::left", count, 12 * n);
  made.pivots = KernelView<int**>("mixbeam::vibration::pivots", count, n);
  made.negative = KernelView<int*>("mixbeam::vibration::negative", count);
  return made;
}

VibratingBlock allocate_vibrating_block(const ElementBlock& block, const KernelView<double**>& mass, bool has_spins) {
  VibratingBlock made = allocate_static_block(block, block.count, true);
  made.mass = mass;
  made.has_spins = has_spins;
  made.momentum =
      KernelView<double**>("mixbeam::vibration::momentum", block.count, made.momenta() * made.layout().motions());
  return made;
}

void allocate_columns(VibratingBlock& vibrating, const StructureViews& structure) {
  const ElementBlock& block = vibrating.block;
  const VibrationLayout layout = vibrating.layout();
  bool forces[3] = {}, moments[3] = {};
  for (int e = 0; e < block.count; ++e)
    for (int i = 0; i < 3; ++i) {
      const SectionConstants& section = structure.sections(block.section(e));
      forces[i] = forces[i] || block.general_section || section.force_cap_compliance[i] != 0.0;
      moments[i] = moments[i] || block.general_section || section.moment_cap_compliance[i] != 0.0;
    }
  std::vector<int> capped;
  for_order(block.order, [&](auto order) {
    const ElementTables<order.value> tables(block.force_integration);
    for (int s = 0; s < layout.stresses(); ++s) {
      const int q = s / 3, i = s % 3;
      const bool is_force = q < layout.force_points;
      const bool is_used = block.general_section || !is_force || (i == 0 ? tables.axial : tables.shear)[q] != 0.0;
      if (is_used && (is_force ? forces : moments)[i]) capped.push_back(s);
    }
  });
  vibrating.capped = KernelView<int*>("mixbeam::vibration::capped", capped.size());
  std::copy(capped.begin(), capped.end(), vibrating.capped.data());
  const size_t rows = vibrating.rows();
  if (vibrating.passed.extent(1) == rows * rows) return;
  vibrating.passed = KernelView<double**>("mixbeam::vibration::passed", block.count, rows * rows);
  vibrating.by_ends = KernelView<double**>("mixbeam::vibration::by_ends", block.count, 12 * rows);
  if (vibrating.left.extent(0) > 0)
    vibrating.left_by_ends = KernelView<double**>("mixbeam::vibration::by_ends", block.count, 12 * rows);
}

void evaluate_vibration(const VibratingBlock& vibrating, const StructureViews& structure, const StateViews& state,
                        double shift, VibrationUse use, const KernelView<double**>& tangent, const FrameViews& frame) {
  for_order(vibrating.block.order, [&](auto order) {
    const VibrationLoop<order.value> loop{vibrating, structure, state, shift, use, tangent, frame};
    Kokkos::parallel_for("mixbeam::vibration::condense", Range(0, vibrating.block.count), loop);
  });
}

void rows_of_motion(const VibratingBlock& vibrating, MotionRow row, const KernelView<const double* [6]>& vertex,
                    const KernelView<const double*>& interior, const KernelView<double**>& to) {
  const bool are_strains = row == MotionRow::strain;
  const KernelView<double**>& matrix = are_strains ? vibrating.strain : vibrating.momentum;
  for_each_of("mixbeam::vibration::rows", vibrating, [=](int e, const VibrationLayout layout) {
    double motions[kMostMotions];
    load_motions(vibrating, e, layout, vertex, interior, motions);
    const int rows = are_strains ? layout.stresses() : vibrating.momenta();
    double* out = &to(vibrating.block.first_element + e, 0);
    std::fill_n(out, rows, 0.0);
    add_product(&matrix(e, 0), rows, layout.motions(), layout.motions(), motions, out);
  });
}

void rows_of_momenta(const VibratingBlock& vibrating, const KernelView<double**>& momenta,
                     const KernelView<double*>& interior, const KernelView<double* [12]>& vertex) {
  for_each_of("mixbeam::vibration::rows", vibrating, [=](int e, const VibrationLayout layout) {
    double motions[kMostMotions] = {};
    add_transposed_product(&vibrating.momentum(e, 0), vibrating.momenta(), layout.motions(), layout.motions(),
                           &momenta(vibrating.block.first_element + e, 0), motions);
    double* out = interior.data() + vibrating.block.increments_at()(e);
    std::fill_n(out, layout.stresses(), 0.0);
    std::copy_n(motions, layout.interior(), out + layout.stresses());
    std::copy_n(motions + layout.interior(), 12, &vertex(vibrating.block.first_element + e, 0));
  });
}

void condense_rows(const VibratingBlock& vibrating, const KernelView<const double*>& interior,
                   const KernelView<double* [12]>& vertex) {
  for_each_of("mixbeam::vibration::condense_rows", vibrating, [=](int e, const VibrationLayout layout) {
    const double* rows = interior.data() + vibrating.block.increments_at()(e);
    double motions[kMostMotions] = {};
    std::copy_n(rows + layout.stresses(), layout.interior(), motions);
    eliminate_stresses(vibrating, e, layout, rows, motions);
    double* out = &vertex(vibrating.block.first_element + e, 0);
    for (int i = 0; i < 12; ++i) out[i] += motions[layout.interior() + i];
    const KernelView<double**>& from = vibrating.left.extent(0) > 0 ? vibrating.left : vibrating.response;
    add_transposed_product(&from(e, 0), layout.interior(), 12, 12, motions, out);
  });
}

void recover_motion(const VibratingBlock& vibrating, const KernelView<const double*>& interior_rows,
                    const KernelView<const double* [6]>& vertex, const KernelView<double*>& increment) {
  for_each_of("mixbeam::vibration::recover", vibrating, [=](int e, const VibrationLayout layout) {
    const double* rows = interior_rows.data() + vibrating.block.increments_at()(e);
    double motions[kMostMotions] = {}, stress[kMostStresses];
    std::copy_n(rows + layout.stresses(), layout.interior(), motions);
    eliminate_stresses(vibrating, e, layout, rows, motions);
    solve_factors(&vibrating.factors(e, 0), layout.interior(), &vibrating.pivots(e, 0), motions);
    double* ends = motions + layout.interior();
    load_ends(vibrating, vertex, e, ends);
    add_product(&vibrating.response(e, 0), layout.interior(), 12, 12, ends, motions);
    std::copy_n(rows, layout.stresses(), stress);
    add_product(&vibrating.strain(e, 0), layout.stresses(), layout.motions(), layout.motions(), motions, stress);
    double* out = increment.data() + vibrating.block.increments_at()(e);
    of_element(vibrating, vibrating.compliance, e).multiply(stress, out);
    std::copy_n(motions, layout.interior(), out + layout.stresses());
  });
}

namespace {

/// Columns per pass through the matrices of an element, one in each lane; a pass with fewer costs the same.
constexpr int kColumns = 4;
using Columns = Pack<kColumns>;

/// A group of columns of one element.
template <int K>
struct ElementColumns {
  static constexpr VibrationLayout kLargest{K, 2 * K + 1};
  static constexpr int kStresses = kLargest.stresses(), kRows = kLargest.velocities() + kStresses;
  const VibratingBlock& vibrating;
  const MomentumColumns& of;
  int e, first, count;  ///< element of the block; columns

  int local() const { return vibrating.block.first_element + e; }
  template <class Place>
  void load(int numbers, const Place& place, Columns* x) const {
    for (int i = 0; i < numbers; ++i)
      x[i] = Columns::gathered([&](int lane) { return lane < count ? place(first + lane)[i] : 0.0; });
  }
  template <class Place>
  void store(int numbers, const Columns* x, const Place& place) const {
    for (int lane = 0; lane < count; ++lane)
      for (int i = 0; i < numbers; ++i) place(first + lane)[i] = x[i][lane];
  }
  double* ends(int column) const { return &of.ends(local(), 12 * column); }
  double* excess(int column) const { return &of.excess(local(), of.stresses * column); }
  double* momenta(int column) const { return of.momenta + of.momenta_of_column * column + of.place(local()); }
  const double* forces(int column) const { return of.forces + of.momenta_of_column * column + of.place(local()); }
  /// Multiplies over the stresses `capped`, which are all if the section is general.
  void multiply(const KernelView<double**>& matrix, const Columns* x, Columns* y) const {
    const StressMatrix m = of_element(vibrating, matrix, e);
    for (size_t i = 0; i < vibrating.capped.extent(0); ++i)
      y[i] = m.is_diagonal ? m.numbers[vibrating.capped(i)] * x[i] : Columns(0.0);
    if (!m.is_diagonal) add_product(m.numbers, m.size, m.size, m.size, x, y);
  }

  /// Given rows and their range in vibrating.rows(): momenta, or the effect of eliminated rows of stresses.
  struct Given {
    Columns x[kRows];
    int begin, count;
  };
  Given given() const {
    Given result;
    result.begin = of.forces != nullptr ? 0 : vibrating.momenta();
    result.count = of.forces != nullptr ? vibrating.momenta() : vibrating.rows() - vibrating.momenta();
    const bool are_momenta = of.forces != nullptr;
    load(
        result.count, [&](int column) { return are_momenta ? forces(column) : excess(column); }, result.x);
    if (are_momenta) return result;
    Columns stress[kStresses];
    multiply(vibrating.compliance, result.x, stress);
    for (int i = 0; i < result.count; ++i) result.x[i] = -stress[i];
    return result;
  }

  void condense() const {
    const Given rows = given();
    const KernelView<double**>& by = vibrating.left.extent(0) > 0 ? vibrating.left_by_ends : vibrating.by_ends;
    Columns sum[12];
    std::fill_n(sum, 12, Columns(0.0));
    add_transposed_product(&by(e, 12 * rows.begin), rows.count, 12, 12, rows.x, sum);
    store(12, sum, [&](int column) { return ends(column); });
  }
  void recover() const {
    const Given rows = given();
    Columns moved[12], out[kRows];
    for (int end = 0; end < 2; ++end)
      load(
          6, [&](int column) { return of.moved[column] + 6 * vibrating.block.vertices(e, end); }, moved + 6 * end);
    std::fill_n(out, vibrating.rows(), Columns(0.0));
    add_product(&vibrating.passed(e, rows.begin), vibrating.rows(), rows.count, vibrating.rows(), rows.x, out);
    add_product(&vibrating.by_ends(e, 0), vibrating.rows(), 12, 12, moved, out);
    store(vibrating.momenta(), out, [&](int column) { return momenta(column); });
    for (int column = first; column < first + count; ++column)
      std::fill(momenta(column) + vibrating.momenta(), momenta(column) + of.of_element, 0.0);
    if (of.excess.extent(0) > 0) recover_excess(out + vibrating.momenta());
  }
  /// Computes the excess rows from the strains of `capped`.
  void recover_excess(Columns* strain) const {
    const int capped = static_cast<int>(vibrating.capped.extent(0));
    Columns stress[kStresses];
    if (of.forces == nullptr)
      load(
          capped, [&](int column) { return excess(column); }, stress);
    for (int i = 0; i < capped && of.forces == nullptr; ++i) strain[i] += stress[i];
    multiply(vibrating.compliance, strain, stress);
    multiply(vibrating.excess, stress, strain);
    store(capped, strain, [&](int column) { return excess(column); });
  }
};

/// Calls action(group of columns of an element) for all of a block.
template <class Action>
void for_each_of_columns(const char* label, const VibratingBlock& vibrating, const MomentumColumns& of,
                         const Action& action) {
  for_order(vibrating.block.order, [&](auto order) {
    Kokkos::parallel_for(label, Range(0, vibrating.block.count), [=](int e) {
      for (int first = 0; first < of.columns; first += kColumns)
        action(ElementColumns<decltype(order)::value>{vibrating, of, e, first, std::min(kColumns, of.columns - first)});
    });
  });
}

}  // namespace

void condense_columns(const VibratingBlock& vibrating, const MomentumColumns& of) {
  for_each_of_columns("mixbeam::vibration::condense_columns", vibrating, of,
                      [](const auto& columns) { columns.condense(); });
}

void recover_columns(const VibratingBlock& vibrating, const MomentumColumns& of) {
  for_each_of_columns("mixbeam::vibration::recover_columns", vibrating, of,
                      [](const auto& columns) { columns.recover(); });
}

namespace {

/// Equations of one element without inertia, with the true compliance.
struct StiffnessEquations {
  const double* stress;
  double motions[kMostMotions], strains[kMostStresses], forces[kMostMotions] = {};  ///< D dx - S dN; D^T dN + H dx

  StiffnessEquations(const VibratingBlock& vibrating, int e, const VibrationLayout& layout,
                     const KernelView<const double* [6]>& vertex, const KernelView<const double*>& increment)
      : stress(load_motions(vibrating, e, layout, vertex, increment, motions)) {
    const int n = layout.motions(), m = layout.stresses();
    of_element(vibrating, vibrating.own, e).multiply(stress, strains);
    for (int s = 0; s < m; ++s) strains[s] = -strains[s];
    add_product(&vibrating.strain(e, 0), m, n, n, motions, strains);
    add_transposed_product(&vibrating.strain(e, 0), m, n, n, stress, forces);
    add_product(&vibrating.geometric(e, 0), n, n, n, motions, forces);
  }
};

}  // namespace

void stiffness_forms(const VibratingBlock& vibrating, const KernelView<const double* [6]>& vertex,
                     const KernelView<const double*>& increment, const KernelView<double*>& forms) {
  for_each_of("mixbeam::vibration::forms", vibrating, [=](int e, const VibrationLayout layout) {
    const StiffnessEquations own(vibrating, e, layout, vertex, increment);
    double sum = 0.0;
    for (int s = 0; s < layout.stresses(); ++s) sum += own.stress[s] * own.strains[s];
    for (int i = 0; i < layout.motions(); ++i) sum += own.motions[i] * own.forces[i];
    forms(vibrating.block.first_element + e) = sum;
  });
}

void add_equations(const VibratingBlock& vibrating, const KernelView<const double* [6]>& vertex,
                   const KernelView<const double*>& increment, const KernelView<double*>& rows,
                   const KernelView<double* [12]>& vertex_rows) {
  for_order(vibrating.block.order, [&](auto order) {
    const ElementTables<order.value> tables(vibrating.block.force_integration);
    const VibrationLayout layout{order.value, tables.force_points};
    Kokkos::parallel_for("mixbeam::vibration::equations", Range(0, vibrating.block.count), [=](int e) {
      const StiffnessEquations own(vibrating, e, layout, vertex, increment);
      double* out = rows.data() + vibrating.block.increments_at()(e);
      for (int s = 0; s < layout.stresses(); ++s) {
        const int q = s / 3;
        const double length = vibrating.block.reference(e, 0);
        out[s] += own.strains[s] / (q < layout.force_points ? 0.5 * length * tables.force_weight[q] : 1.0);
      }
      for (int i = 0; i < layout.interior(); ++i) out[layout.stresses() + i] += own.forces[i];
      std::copy_n(own.forces + layout.interior(), 12, &vertex_rows(vibrating.block.first_element + e, 0));
    });
  });
}

void excess_rows(const VibratingBlock& vibrating, const KernelView<const double*>& increment,
                 const KernelView<double*>& rows) {
  for_each_of("mixbeam::vibration::excess", vibrating, [=](int e, const VibrationLayout layout) {
    double* out = rows.data() + vibrating.block.increments_at()(e);
    of_element(vibrating, vibrating.excess, e).multiply(increment.data() + vibrating.block.increments_at()(e), out);
    std::fill_n(out + layout.stresses(), layout.interior(), 0.0);
  });
}

void take_residual(const VibratingBlock& vibrating, const KernelView<double*>& interior,
                   const KernelView<double* [12]>& vertex) {
  for_order(vibrating.block.order, [&](auto order) {
    const ElementTables<order.value> tables(vibrating.block.force_integration);
    const ElementBlock& block = vibrating.block;
    Kokkos::parallel_for("mixbeam::vibration::residual", Range(0, block.count), [=](int e) {
      double* row = interior.data() + block.increments_at()(e);
      for (int q = 0; q < tables.force_points; ++q)
        for (int i = 0; i < 3; ++i) row[3 * q + i] *= 0.5 * block.reference(e, 0) * tables.force_weight[q];
      for (int i = block.interior.relative_rotation(1); i < block.interior.increments(); ++i) row[i] = -row[i];
      for (int i = 0; i < 12; ++i) vertex(block.first_element + e, i) = -vertex(block.first_element + e, i);
    });
  });
}

namespace {

/// Calls action(element, carried element).
template <class Action>
void for_each_carried(const char* label, const ElementBlock& block, const FrameViews& frame, const StateViews& state,
                      const Action& action) {
  for_order(block.order, [&](auto order) {
    constexpr int K = order.value;
    const ElementTables<K> tables(block.force_integration);
    Kokkos::parallel_for(label, Range(0, block.count), [=](int e) {
      const ElementInput<double> in = input_of(block, state, e);
      const ElementKinematics<K> kinematics(in, block.interior);
      action(e, carried(frame, e, tables, in, kinematics));
    });
  });
}

}  // namespace

void add_centrifugal_rows(const ElementBlock& block, const FrameViews& frame, const StateViews& state, double factor,
                          const ResidualScales* scales, const KernelView<double*>& interior,
                          const KernelView<double* [12]>& vertex) {
  const ResidualScales by = scales == nullptr ? ResidualScales{} : *scales;
  const bool scaled = scales != nullptr;
  for_each_carried("mixbeam::frame::rows", block, frame, state, [=](int e, const auto& element) {
    constexpr int K = std::decay_t<decltype(element)>::kOrder;
    constexpr VibrationLayout layout{K, 0};
    constexpr int n = layout.motions();
    double velocity[layout.velocities() * n] = {}, rows[n] = {};
    element.fill_velocity({velocity, n});
    element.add_rows({velocity, n}, rows);
    double all[InteriorLayout{K, ElementTables<K>::kMaximumForcePoints}.increments()] = {};
    double* moved = all + block.interior.relative_rotation(1);
    for (int i = 0; i < layout.interior(); ++i) moved[i] = factor * rows[i];
    if (scaled) scale_interior_rows(block.interior, by, block.reference(e, 0), false, all);
    double* out = interior.data() + block.increments_at()(e);
    for (int i = block.interior.relative_rotation(1); i < block.interior.increments(); ++i) out[i] += all[i];
    for (int i = 0; i < 12; ++i) vertex(block.first_element + e, i) += factor * rows[layout.interior() + i];
  });
}

void centrifugal_energies(const ElementBlock& block, const FrameViews& frame, const StateViews& state,
                          const KernelView<double*>& energy) {
  for_each_carried("mixbeam::frame::energy", block, frame, state,
                   [=](int e, const auto& element) { energy(block.first_element + e) = element.energy(); });
}

void coriolis_matrices(const ElementBlock& block, const FrameViews& frame, const StateViews& state,
                       const KernelView<double**>& matrices) {
  for_each_carried("mixbeam::frame::coriolis", block, frame, state, [=](int e, const auto& element) {
    for (int q = 0; q <= block.order; ++q)
      element.at(q, element.rotation_at(q), [&](const CarriedMass& mass, double) {
        on_momenta(mass.coriolis(), element.factor + kMassNumbers * q, &matrices(e, 36 * q));
      });
  });
}

}  // namespace mixbeam
