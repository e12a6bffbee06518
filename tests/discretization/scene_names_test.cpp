/// Names that the result file and its name cannot bear are refused where they stand in the scene.
#include "scene_text.hpp"

#include "discretization/text/result_names.hpp"

namespace mixbeam::scene_names_test {
namespace {

const std::string kPoints = "A: [0, 0, 0], B: [1, 0, 0], ";
const std::string kMember = member("m", "A", "B");

std::string with_cases(const std::string& names) { return scene_text(kPoints, kMember, "Load Cases: [" + names + "]"); }

TEST(SceneNames, OfPointsAndMembersMustSuitTheResultFile) {
  for (const std::string name : {"a/b", "/", ".", ".."}) {
    SCOPED_TRACE(name);
    expect_text_refused(scene_text(kPoints + name + ": [2, 0, 0], ", kMember + member("n", "B", name)),
                        {"scene.yaml:", "\"Scene / Points / " + name + "\"", "result file", "without \"/\""});
    expect_text_refused(scene_text(kPoints, member(name, "A", "B")),
                        {"scene.yaml:", "\"Scene / Members / " + name + "\"", "result file", "without \"/\""});
  }
  EXPECT_NO_THROW(scene_from(scene_text(kPoints, member("'a.b ... \\c (1, 2) \xC3\xA4'", "A", "B"))));
}

/// Points that members make need no entry in "Points".
TEST(SceneNames, OfPointsThatFollowFromMembers) {
  const std::string arc = curve("arc", "Center: [0, 1, 0], Axis: [0, 0, 1], Angle: 1");
  expect_text_refused(scene_text(kPoints, kMember + member("n", "B", "x/y", arc)),
                      {"\"Scene / Members / n / End\"", "\"x/y\"", "without \"/\""});
  expect_text_refused(scene_text(kPoints, member("m", "A", "B", "Inner Points: {..: 0.5}")),
                      {"\"Scene / Members / m / Inner Points / ..\"", "without \"/\""});
}

TEST(SceneNames, OfLoadCasesMustSuitAFileName) {
  const std::string longest(100, 'x');
  for (const std::string& name : {std::string("up/down"), std::string(".."), longest + "x", std::string("\"a\\nb\"")})
    expect_text_refused(with_cases("wind, " + name), {"scene.yaml:", "\"Scene / Load Cases\"", "allowed: "});
  EXPECT_NO_THROW(scene_from(with_cases("wind 1.5, " + longest)));
  EXPECT_FALSE(result_name_problem("").empty());
}

}  // namespace
}  // namespace mixbeam::scene_names_test
