/// Sections that other programs wrote: one known section, written in each format by its own order of axes.
#include "discretization/reading/blade_file.hpp"
#include "discretization/text/errors.hpp"
#include "tests/support/blade_texts.hpp"
#include "tests/support/errors.hpp"

namespace mixbeam::blade_file_test {
namespace {

using namespace blade_texts;

/// Texts have 17 digits; sums of three products.
constexpr double kRounding = 1e-14;

void expect_known(const BladeStation& station, const Known& known) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      EXPECT_NEAR(station.stiffness[i][j], known.stiffness[i][j], kRounding * 7e9) << i << " " << j;
      EXPECT_NEAR(station.mass[i][j], known.mass[i][j], kRounding * 300) << i << " " << j;
    }
}

TEST(BladeFile, EachFormatGivesTheSectionAboutItsReferencePoint) {
  const Known known = known_section();
  for (const std::string& text : {vabs(known), becas(known), anba(known), beamdyn(known), windio(known),
                                  windio_2(known), hawc2(true), hawc2(false)}) {
    const std::vector<BladeStation> stations = read_blade(text, "blade");
    const BladeFormat format = blade_format(text);
    const bool is_single = format == BladeFormat::vabs || format == BladeFormat::becas || format == BladeFormat::anba;
    ASSERT_EQ(stations.size(), is_single ? 1u : 2u);
    for (const BladeStation& station : stations) expect_known(station, known);
  }
  // The twin: axes in another order are another section.
  EXPECT_NE(read_blade(vabs(known), "blade")[0].stiffness[4][4],
            read_blade(becas({known.mass, known.stiffness}), "blade")[0].stiffness[4][4]);
}

// Against what is written out here: tension at the point (x, y) is that of the axis and of both curvatures.
TEST(BladeFile, TablesOfHawc2AreAboutElasticAndShearCentres) {
  const std::string row = " 4 0.5 0 1 1 0.25 -0.5 8 2 3 5 7 0.5 0.25 1 90 0.5 0.125\n";
  const std::vector<BladeStation> stations = read_blade("#1\n$1 2\n0" + row + "6" + row, "blade");
  const Matrix6 &k = stations[1].stiffness, &m = stations[1].mass;
  EXPECT_EQ(stations[1].place[2], 6.0);
  // Axis x of the ellipse of inertia is axis y here, so that k_x = 0.5 shears along y.
  EXPECT_NEAR(k[1][1], 0.25 * 2.0, kRounding);
  EXPECT_NEAR(k[2][2], 0.5 * 2.0, kRounding);
  EXPECT_NEAR(k[2][3], 1.0 * 0.25, kRounding);
  EXPECT_NEAR(k[1][3], 0.5 * 0.5, kRounding);
  EXPECT_NEAR(k[3][3], 2.0 * 7.0 + 1.0 * 0.25 * 0.25 + 0.5 * 0.5 * 0.5, 14.0 * kRounding);
  EXPECT_NEAR(k[0][4], 8.0 * 0.125, kRounding);
  EXPECT_NEAR(k[0][5], -8.0 * 0.5, kRounding);
  EXPECT_NEAR(k[4][4], 8.0 * 5.0 + 8.0 * 0.125 * 0.125, 40.0 * kRounding);
  EXPECT_NEAR(k[5][5], 8.0 * 3.0 + 8.0 * 0.5 * 0.5, 40.0 * kRounding);
  EXPECT_NEAR(m[0][5], -4.0 * 0.5, kRounding);
  EXPECT_NEAR(m[5][5], 4.0 * 1.0 + 4.0 * (0.5 * 0.5 - 0.0), 40.0 * kRounding);
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
    return error_of<InputError>([&] { sections_of_blade(text, "s.K"); });
  };
  EXPECT_EQ(problem(vabs(known)), "no error");
  EXPECT_NE(problem("nothing").find("allowed: VABS"), std::string::npos);
  EXPECT_NE(problem("1 2 3\n").find("\"stiffness\": row 1, column 4"), std::string::npos) << problem("1 2 3\n");
  EXPECT_NE(problem("#1\n$1\t2\n0 1 2\n").find("row 1 has 3 numbers"), std::string::npos);
  EXPECT_NE(problem(hawc2(true) + hawc2(false)).find("several sets"), std::string::npos);
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
