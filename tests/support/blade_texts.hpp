/// A known section of a blade, written as each program writes it.
#pragma once

#include "discretization/scene/scene.hpp"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

namespace mixbeam::blade_texts {

/// About the reference point: centre at (0.3, -0.2), principal axes turned by 0.4.
struct Known {
  Matrix6 stiffness{}, mass{};
};

/// A^T D A with strains of the centre in principal axes = A times those of the reference point.
inline Known known_section() {
  const double a = 0.3, b = -0.2, c = std::cos(0.4), s = std::sin(0.4);
  const double at_centre[6][6] = {{1, 0, 0, 0, b, -a}, {0, 1, 0, -b, 0, 0}, {0, 0, 1, a, 0, 0},
                                  {0, 0, 0, 1, 0, 0},  {0, 0, 0, 0, 1, 0},  {0, 0, 0, 0, 0, 1}};
  const auto principal = [&](int row, int column) {
    const auto turned = [&](int i) {
      return i % 3 == 0   ? at_centre[i][column]
             : i % 3 == 1 ? c * at_centre[i][column] + s * at_centre[i + 1][column]
                          : c * at_centre[i][column] - s * at_centre[i - 1][column];
    };
    return turned(row);
  };
  const double stiff[6] = {7e9, 2e9, 3e9, 4e7, 5e7, 6e8}, heavy[6] = {300, 300, 300, 50, 20, 30};
  Known known;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k) {
        known.stiffness[i][j] += principal(k, i) * stiff[k] * principal(k, j);
        known.mass[i][j] += principal(k, i) * heavy[k] * principal(k, j);
      }
  return known;
}

/// Rows of a matrix whose axes (1, 2, 3) are (z, x, y): of forces along x, y, z, then moments about them.
inline std::string rows_along_z(const Matrix6& m) {
  const int place[6] = {1, 2, 0, 4, 5, 3};
  std::ostringstream text;
  text << std::setprecision(17);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) text << "  " << m[place[i]][place[j]];
    text << "\n";
  }
  return text.str();
}

inline std::string rows_along_x(const Matrix6& m) {
  std::ostringstream text;
  text << std::setprecision(17);
  for (const auto& row : m) {
    for (const double entry : row) text << "   " << entry;
    text << "\n";
  }
  return text.str();
}

/// The upper triangle of rows_along_z() with commas.
inline std::string triangle(const Matrix6& m) {
  std::istringstream rows(rows_along_z(m));
  std::string text, word;
  for (int i = 0; i < 36; ++i) {
    rows >> word;
    if (i % 6 >= i / 6) text += (text.empty() ? "" : ", ") + word;
  }
  return text;
}

inline std::string vabs(const Known& known) {
  const std::string bar = " ========================\n\n";
  return " The 6X6 Mass Matrix\n" + bar + rows_along_x(known.mass) + "\n The Mass Center of the Cross Section\n" + bar +
         " 0.3 -0.2\n\n Classical Stiffness Matrix (1-extension; 2-twist; 3,4-bending)\n" + bar +
         " 1 2 3 4\n 5 6 7 8\n\n Timoshenko Stiffness Matrix (1-extension; 2,3-shear, 4-twist; 5,6-bending)\n" + bar +
         rows_along_x(known.stiffness) + "\n Timoshenko Flexibility Matrix (1-extension)\n" + bar + " 9 9 9\n";
}

inline std::string becas(const Known& known) {
  return "*  BECAS 2.3  *\n\nStiffness matrix w.r.t. to the cross section reference point \nK=\n" +
         rows_along_z(known.stiffness) + "\nCompliance matrix w.r.t. to the cross section reference point \nF=\n 1\n" +
         "Mass matrix w.r.t. to the cross section reference point \nM=\n" + rows_along_z(known.mass);
}

inline std::string anba(const Known& known) {
  return "[[" + rows_along_z(known.stiffness) + "]]\n" + rows_along_z(known.mass);
}

/// About the centre of known_section(): K, then a set that nobody asked for.
inline std::string hawc2(bool full) {
  const std::string row = full ? "300 0.3 -0.2 0.2581988897471611 0.31622776601683794 22.918311805232928 0.3 -0.2 "
                                 "2e9 0 0 0 0 0  3e9 0 0 0 0  7e9 0 0 0  5e7 0 0  6e8 0  4e7"
                               : "300 0.3 -0.2 0.2581988897471611 0.31622776601683794 0.3 -0.2 7e9 5e9 "
                                 "0.007142857142857143 0.08571428571428572 0.008 0.4 0.6 1 22.918311805232928 0.3 -0.2";
  return "2 number of sets\n------\n#1 blade\nr m x_cg y_cg ...\n$1 2\n 0 " + row + "\n 10.5\t" + row +
         "\n$2 2 stiff\n 0 1\n 1 1\n";
}

inline std::string beamdyn(const Known& known) {
  const std::string matrices = rows_along_z(known.stiffness) + "\n" + rows_along_z(known.mass) + "\n";
  return "------- BEAMDYN V1.00.* INDIVIDUAL BLADE INPUT FILE ---\nA blade\n---- BLADE PARAMETERS ----\n"
         "2  station_total  - Number of blade input stations (-)\n1 damp_type - (switch)\n---- DAMPING COEFFICIENT "
         "---\n"
         "mu1 mu2\n(-) (-)\n0.001 0.001\n---- DISTRIBUTED PROPERTIES ----\n 0.0\n" +
         matrices + " 1.0\n" + matrices;
}

inline std::string windio(const Known& known) {
  const auto values = [](const std::string& numbers) { return "{grid: [0, 1], values: [" + numbers + "]}"; };
  return "components:\n  blade:\n    elastic_properties_mb:\n      six_x_six:\n"
         "        reference_axis: {x: " +
         values("0, -4") + ", y: " + values("0, 0") + ", z: " + values("0, 3") + "}\n" +
         "        twist: " + values("0.25, 0") + "\n        stiff_matrix: " +
         values("[" + triangle(known.stiffness) + "], [" + triangle(known.stiffness) + "]") +
         "\n        inertia_matrix: " + values("[" + triangle(known.mass) + "], [" + triangle(known.mass) + "]") + "\n";
}

/// Version 2: a list for each entry of the matrix.
inline std::string windio_2(const Known& known) {
  const auto twice = [](const std::string& name, const std::string& value) {
    return ", " + name + ": [" + value + ", " + value + "]";
  };
  std::istringstream entries(triangle(known.stiffness));
  std::string stiffness, entry;
  for (int i = 1; i <= 6; ++i)
    for (int j = i; j <= 6 && std::getline(entries, entry, ','); ++j)
      stiffness += twice("K" + std::to_string(i) + std::to_string(j), entry);
  std::ostringstream mass;
  mass << std::setprecision(17) << twice("mass", "300") << twice("cm_x", "0.3") << twice("cm_y", "-0.2");
  const char* names[4] = {"i_edge", "i_flap", "i_plr", "i_cp"};
  const double moments[4] = {known.mass[4][4], known.mass[5][5], known.mass[3][3], -known.mass[4][5]};
  for (int i = 0; i < 4; ++i) mass << ", " << names[i] << ": [" << moments[i] << ", " << moments[i] << "]";
  return "components:\n  blade:\n    reference_axis: {grid: [0, 1], x: [0, -4], y: [0, 0], z: [0, 3]}\n"
         "    outer_shape: {twist: {grid: [0, 1], values: [10, 0]}}\n    structure:\n      elastic_properties:\n"
         "        stiffness_matrix: {grid: [0, 1]" +
         stiffness + "}\n        inertia_matrix: {grid: [0, 1]" + mass.str() + "}\n";
}

}  // namespace mixbeam::blade_texts
