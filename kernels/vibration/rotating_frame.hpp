/// Masses at rest in a rotating frame: centrifugal energy, its variations and the Coriolis forces of small motions,
/// theory (75), (76).
#pragma once

#include "kernels/condensation/condensed_layout.hpp"
#include "kernels/loops/block.hpp"
#include "kernels/vibration/element_matrices.hpp"

namespace mixbeam {

/// Size of a symmetric 6 x 6 matrix: the lower factor of the mass per length of (velocity, spin) at one point.
constexpr int kMassNumbers = 21;

/// Symmetric or skew matrix over (velocity, spin) along the axes of a mass.
struct MotionForm {
  Mat moved, mixed, turned;  ///< rows of velocity; velocity times spin; rows of spin
  bool is_skew = false;

  double entry(int i, int j) const {
    if (i < 3 && j < 3) return moved(i, j);
    if (i >= 3 && j >= 3) return turned(i - 3, j - 3);
    return i < 3 ? mixed(i, j - 3) : (is_skew ? -mixed(j, i - 3) : mixed(j, i - 3));
  }
};

/// M = L L^T from its lower factor L.
inline MotionForm mass_of_factor(const double* factor) {
  MotionForm mass{};
  const auto product = [factor](int i, int j) {
    double sum = 0.0;
    for (int k = 0; k <= (i < j ? i : j); ++k) sum += factor[triangle(i, k)] * factor[triangle(j, k)];
    return sum;
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      mass.moved(i, j) = product(i, j);
      mass.mixed(i, j) = product(i, 3 + j);
      mass.turned(i, j) = product(3 + i, 3 + j);
    }
  return mass;
}

/// Velocity v and spin o of a mass M at rest in the frame, along the axes of the mass, and its momenta f, h: V = -1/2
/// (v . f + o . h). Small motions z = (du, dtheta) along the same axes change (v, o) by B z, B = ((hat o, hat v), (0,
/// hat o)).
class CarriedMass {
 public:
  CarriedMass(const MotionForm& mass, const Vec& velocity, const Vec& spin)
      : mass_(mass),
        v_(velocity),
        o_(spin),
        f_(mass.moved * v_ + mass.mixed * o_),
        h_(transpose_times(mass.mixed, v_) + mass.turned * o_) {}

  double energy() const { return -0.5 * (dot(v_, f_) + dot(o_, h_)); }
  /// Derivatives of V with respect to du and dtheta.
  Vec force_row() const { return cross(o_, f_); }
  Vec moment_row() const { return cross(v_, f_) + cross(o_, h_); }
  /// Second variation of V for motions with constant dtheta.
  MotionForm second_variation() const {
    const Mat spun = hat(o_), moved = hat(v_);
    const Mat of_velocity = mass_.moved * moved + mass_.mixed * spun;          // M B, rows of velocity
    const Mat of_spin = transpose(mass_.mixed) * moved + mass_.turned * spun;  // rows of spin
    const Mat along = hat(f_) * spun, turned = hat(f_) * moved + hat(h_) * spun;
    return {spun * (mass_.moved * spun), spun * of_velocity - transpose(along),
            symmetric_part(moved * of_velocity + spun * of_spin - turned)};
  }
  /// Forces due to velocities z: M B - B^T M minus the rotation of the momenta.
  MotionForm coriolis() const {
    const Mat spun = hat(o_), moved = hat(v_);
    const Mat uu = mass_.moved * spun, us = mass_.moved * moved + mass_.mixed * spun;
    const Mat su = transpose(mass_.mixed) * spun, ss = transpose(mass_.mixed) * moved + mass_.turned * spun;
    return {uu - transpose(uu), us - transpose(su) - hat(f_), ss - transpose(ss) - hat(h_), true};
  }

 private:
  const MotionForm& mass_;
  Vec v_, o_, f_, h_;
};

/// Angular velocity of the frame, and masses and places of the elements of a block in it.
struct FrameViews {
  KernelView<double**> mass{};   ///< (element of the block, point * kMassNumbers); empty: no rotation
  KernelView<double**> place{};  ///< (element of the block, point * 3): undeformed, from a point on the axis
  Vec spin{};

  bool turns() const { return mass.extent(0) > 0 && dot(spin, spin) > 0.0; }
};

/// One element in the rotating frame, at its moment points.
template <int K>
struct CarriedElement {
  static constexpr int kOrder = K;
  const ElementTables<K>& tables;
  const ElementKinematics<K>& kinematics;
  Vec mean;                     ///< (u_a + u_b)/2
  const double *factor, *from;  ///< masses and places of its points
  Vec spin;

  /// Calls action(mass, weight) for one point.
  template <class Action>
  void at(int q, const PointRotation<K>& rotation, const Action& action) const {
    Vec u{{0.0, 0.0, 0.0}};
    for (int j = 0; j < K; ++j) u += tables.moment_bubble[q][j] * kinematics.slope[j];
    const Vec place = load_vector(from + 3 * q) + mean + (0.5 * kinematics.length) * (kinematics.triad * u);
    const Mat axes = kinematics.triad * rotation.exp;
    const MotionForm mass = mass_of_factor(factor + kMassNumbers * q);
    action(CarriedMass(mass, transpose_times(axes, cross(spin, place)), transpose_times(axes, spin)),
           0.5 * kinematics.length * tables.moment_weight[q]);
  }
  PointRotation<K> rotation_at(int q) const {
    return PointRotation<K>(kinematics.relative_rotation(tables.moment_legendre[q]));
  }

  /// Computes the velocities of all motions, as in ElementMatrices; zero on entry.
  void fill_velocity(const MotionRows& velocity) const {
    const MotionColumns<K> columns{transpose(kinematics.triad), 1.0 / kinematics.length};
    for (int q = 0; q <= K; ++q) add_velocity(q, rotation_at(q), kinematics.length, tables, columns, velocity);
  }

  double energy() const {
    double sum = 0.0;
    for (int q = 0; q <= K; ++q)
      at(q, rotation_at(q), [&](const CarriedMass& mass, double weight) { sum += weight * mass.energy(); });
    return sum;
  }
  /// `velocity`: rows of ElementMatrices, without masses; `rows`: over all motions.
  void add_rows(const MotionRows& velocity, double* rows) const {
    for (int q = 0; q <= K; ++q)
      at(q, rotation_at(q), [&](const CarriedMass& mass, double weight) {
        const Vec force = weight * mass.force_row(), moment = weight * mass.moment_row();
        for (int i = 0; i < 3; ++i)
          for (int c = 0; c < velocity.columns; ++c)
            rows[c] += force[i] * velocity.row(6 * q + i)[c] + moment[i] * velocity.row(6 * q + 3 + i)[c];
      });
  }
  void add_second_variation(const MotionRows& velocity, const MotionRows& to) const {
    constexpr int spin_column = 3 * (2 * K - 2);
    for (int q = 0; q <= K; ++q) {
      const PointRotation<K> rotation = rotation_at(q);
      at(q, rotation, [&](const CarriedMass& mass, double weight) {
        add_product(mass.second_variation(), weight, velocity, 6 * q, to);
        if constexpr (K > 1) {  // w and psi rotate each other's spin
          const double* P = tables.moment_legendre[q];
          const Vec moment = mass.moment_row();  // - n
          const Mat by_spin = (-0.5 * weight) * (rotation.exp * hat(moment) * transpose(rotation.tangent));
          const Mat by_psi = weight * symmetric_part(tangent_map_derivative(rotation.psi, moment, rotation.c));
          for (int i = 1; i < K; ++i) {
            to.add(spin_column, 3 * (i - 1), P[i] * by_spin);
            to.add(3 * (i - 1), spin_column, P[i] * transpose(by_spin));
            for (int j = 1; j < K; ++j) to.add(3 * (i - 1), 3 * (j - 1), (P[i] * P[j]) * by_psi);
          }
        }
      });
    }
  }

 private:
  /// Adds weight V^T form V, V six rows of velocities.
  static void add_product(const MotionForm& form, double weight, const MotionRows& velocity, int first,
                          const MotionRows& to) {
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const double number = weight * form.entry(i, j);
        if (number == 0.0) continue;
        for (int r = 0; r < to.columns; ++r) {
          const double factor = number * velocity.row(first + i)[r];
          for (int c = 0; c < to.columns; ++c) to.row(r)[c] += factor * velocity.row(first + j)[c];
        }
      }
  }
};

/// W with L W L^T = form: acts on momenta L^T z as the form acts on velocities. Directions without inertia give zero.
inline void on_momenta(const MotionForm& form, const double* factor, double* w) {
  const auto divide = [factor](double* x, int stride) {  // L^-1 x
    for (int i = 0; i < 6; ++i) {
      double rest = x[i * stride];
      for (int k = 0; k < i; ++k) rest -= factor[triangle(i, k)] * x[k * stride];
      const double pivot = factor[triangle(i, i)];
      x[i * stride] = pivot > 0.0 ? rest / pivot : 0.0;
    }
  };
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) w[6 * i + j] = form.entry(i, j);
  for (int j = 0; j < 6; ++j) divide(w + j, 6);
  for (int i = 0; i < 6; ++i) divide(w + 6 * i, 1);
}

}  // namespace mixbeam
