/// Sections that other programs wrote: one known section, written in each format by its own order of axes.
#include "discretization/reading/blade_file.hpp"
#include "discretization/text/errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <sstream>

namespace mixbeam::blade_file_test {
namespace {

/// Texts have 17 digits; sums of three products.
constexpr double kRounding = 1e-14;

/// About the reference point: centre at (0.3, -0.2), principal axes turned by 0.4.
struct Known {
  Matrix6 stiffness{}, mass{};
};

/// A^T D A with strains of the centre in principal axes = A times those of the reference point.
Known known_section() {
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
std::string rows_along_z(const Matrix6& m) {
  const int place[6] = {1, 2, 0, 4, 5, 3};
  std::ostringstream text;
  text << std::setprecision(17);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) text << "  " << m[place[i]][place[j]];
    text << "\n";
  }
  return text.str();
}

std::string rows_along_x(const Matrix6& m) {
  std::ostringstream text;
  text << std::setprecision(17);
  for (const auto& row : m) {
    for (const double entry : row) text << "   " << entry;
    text << "\n";
  }
  return text.str();
}

/// The upper triangle of rows_along_z() with commas.
std::string triangle(const Matrix6& m) {
  std::istringstream rows(rows_along_z(m));
  std::string text, word;
  for (int i = 0; i < 36; ++i) {
    rows >> word;
    if (i % 6 >= i / 6) text += (text.empty() ? "" : ", ") + word;
  }
  return text;
}

void expect_known(const BladeStation& station, const Known& known) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      EXPECT_NEAR(station.stiffness[i][j], known.stiffness[i][j], kRounding * 7e9) << i << " " << j;
      EXPECT_NEAR(station.mass[i][j], known.mass[i][j], kRounding * 300) << i << " " << j;
    }
}

std::string vabs(const Known& known) {
  const std::string bar = " ========================\n\n";
  return " The 6X6 Mass Matrix\n" + bar + rows_along_x(known.mass) + "\n The Mass Center of the Cross Section\n" + bar +
         " 0.3 -0.2\n\n Classical Stiffness Matrix (1-extension; 2-twist; 3,4-bending)\n" + bar +
         " 1 2 3 4\n 5 6 7 8\n\n Timoshenko Stiffness Matrix (1-extension; 2,3-shear, 4-twist; 5,6-bending)\n" + bar +
         rows_along_x(known.stiffness) + "\n Timoshenko Flexibility Matrix (1-extension)\n" + bar + " 9 9 9\n";
}

std::string becas(const Known& known) {
  return "*  BECAS 2.3  *\n\nStiffness matrix w.r.t. to the cross section reference point \nK=\n" +
         rows_along_z(known.stiffness) + "\nCompliance matrix w.r.t. to the cross section reference point \nF=\n 1\n" +
         "Mass matrix w.r.t. to the cross section reference point \nM=\n" + rows_along_z(known.mass);
}

std::string beamdyn(const Known& known) {
  const std::string matrices = rows_along_z(known.stiffness) + "\n" + rows_along_z(known.mass) + "\n";
  return "------- BEAMDYN V1.00.* INDIVIDUAL BLADE INPUT FILE ---\nA blade\n---- BLADE PARAMETERS ----\n"
         "2  station_total  - Number of blade input stations (-)\n1 damp_type - (switch)\n---- DAMPING COEFFICIENT "
         "---\n"
         "mu1 mu2\n(-) (-)\n0.001 0.001\n---- DISTRIBUTED PROPERTIES ----\n 0.0\n" +
         matrices + " 1.0\n" + matrices;
}

std::string windio(const Known& known) {
  const auto values = [](const std::string& numbers) { return "{grid: [0, 1], values: [" + numbers + "]}"; };
  return "components:\n  blade:\n    elastic_properties_mb:\n      six_x_six:\n"
         "        reference_axis: {x: " +
         values("0, -4") + ", y: " + values("0, 0") + ", z: " + values("0, 3") + "}\n" +
         "        twist: " + values("0.25, 0") + "\n        stiff_matrix: " +
         values("[" + triangle(known.stiffness) + "], [" + triangle(known.stiffness) + "]") +
         "\n        inertia_matrix: " + values("[" + triangle(known.mass) + "], [" + triangle(known.mass) + "]") + "\n";
}

TEST(BladeFile, EachFormatGivesTheSectionAboutItsReferencePoint) {
  const Known known = known_section();
  for (const std::string& text : {vabs(known), becas(known), beamdyn(known), windio(known)}) {
    const std::vector<BladeStation> stations = read_blade(text, "blade");
    ASSERT_EQ(stations.size(),
              text.find("BEAMDYN") == std::string::npos && text.find("blade:") == std::string::npos ? 1u : 2u);
    for (const BladeStation& station : stations) expect_known(station, known);
  }
  // The twin: axes in another order are another section.
  EXPECT_NE(read_blade(vabs(known), "blade")[0].stiffness[4][4],
            read_blade(becas({known.mass, known.stiffness}), "blade")[0].stiffness[4][4]);
}

TEST(BladeFile, MassesAreTakenToTheirCentre) {
  const Teuchos::ParameterList sections = sections_of_blade(vabs(known_section()), "a/root.K");
  const Teuchos::ParameterList& root = sections.sublist("root");
  EXPECT_NEAR(root.get<double>("Mass"), 300.0, kRounding * 300.0);
  const auto offset = root.get<Teuchos::Array<double>>("Mass Offset");
  EXPECT_NEAR(offset[0], 0.3, kRounding);
  EXPECT_NEAR(offset[1], -0.2, kRounding);
  const double c = std::cos(0.4), s = std::sin(0.4);
  const auto inertia = root.get<Teuchos::Array<double>>("Rotary Inertia");
  EXPECT_NEAR(inertia[0], 50.0, kRounding * 300.0);
  EXPECT_NEAR(inertia[1], 20.0 * c * c + 30.0 * s * s, kRounding * 300.0);
  EXPECT_NEAR(inertia[2], 20.0 * s * s + 30.0 * c * c, kRounding * 300.0);
  // J of the spin is (20 - 30) c s off the diagonal, which is minus the product of inertia.
  EXPECT_NEAR(root.get<double>("Inertia Product"), 10.0 * c * s, kRounding * 300.0);
}

TEST(BladeFile, WindIoTurnsAboutTheAxisTowardsTheRoot) {
  const std::vector<BladeStation> stations = read_blade(windio(known_section()), "blade");
  EXPECT_EQ(stations[0].twist, -0.25);
  EXPECT_EQ(stations[1].place, (Vector3{-4.0, 0.0, 3.0}));
}

TEST(BladeFile, SaysWhatIsWrong) {
  const Known known = known_section();
  const auto problem = [](const std::string& text) {
    try {
      sections_of_blade(text, "s.K");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(problem(vabs(known)), "none");
  EXPECT_NE(problem("nothing").find("allowed: VABS"), std::string::npos);
  std::string text = vabs(known);
  text.replace(text.find("300"), 3, "3x0");
  EXPECT_NE(problem(text).find("row 1, column 1 is \"3x0\""), std::string::npos) << problem(text);
  Known other = known;
  other.stiffness[4][5] *= -1.0;
  EXPECT_NE(problem(vabs(other)).find("is not symmetric"), std::string::npos);
  other = known;
  other.mass[4][4] = -1.0;
  EXPECT_NE(problem(vabs(other)).find("which no section has"), std::string::npos);
}

}  // namespace
}  // namespace mixbeam::blade_file_test
