/// Sections that other programs wrote: one known section, written in each format by its own order of axes.
#include "discretization/reading/blade_file.hpp"
#include "discretization/text/errors.hpp"
#include "tests/support/blade_texts.hpp"
#include "tests/support/errors.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
    return error_of<InputError>([&] { sections_of_blade(text, "s.K"); });
  };
  EXPECT_EQ(problem(vabs(known)), "no error");
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
