/// `mixbeam run` of scenes with the list "Inverse": its files, and the scene that runs forward.
#include "apps/mixbeam/commands.hpp"
#include "apps/mixbeam/found_scene.hpp"
#include "mixbeam_files.hpp"
#include "tests/support/ranks.hpp"

namespace mixbeam::rest_shape_test {
namespace {

constexpr const char* kRod = R"(Name: rod
Scene:
  Import: {Points File: points.csv}
  Sections: {rod: {EA: 4000, GA2: 300, GA3: 300, GIt: 1, EI2: 1, EI3: 1}}
  Members: {rod: {Start: a, End: b, Order: 3, Elements: 4}}
  Patterns: {more: {Kind: repeat, Members: [rod], Vector: [0, 0, 1], Count: 2, Copy: all}}
  Supports: {wall: {Point: a, Fixed Displacement: [x, y, z], Fixed Rotation: [x, y, z]}}
  Distributed Loads: {weight: {Member: rod, Force: [0, -2, 0.5]}}
Quantities: {sag: {Quantity: displacement, Point: b, Component: y}}
Expected: {sag: {Quantity: sag, Value: 0, Absolute Tolerance: 1e-10, Source: as drawn}}
Inverse: {}
)";

class RestShapeFiles : public MixbeamTest {
 protected:
  RestShapeFiles() { write_text(folder_ / "points.csv", "name,x,y,z\na,0,0,0\nb,1,0.2,0\n"); }
  bool is_there(const std::string& name) const { return fs::exists(folder_ / "results" / name); }
};

TEST_F(RestShapeFiles, RunForwardToTheDrawnShape) {
  expect_code(kOk, run_scene(kRod));
  for (const char* file : {"scene-curvature-rod.csv", "scene-strain-rod.csv", "scene-natural-rod.csv", "scene.h5"})
    EXPECT_TRUE(is_there(file)) << file;
  EXPECT_NE(text("summary.json").find("\"negative eigenvalues of the drawn state\": 0"), std::string::npos);
  // by itself, and wrong without its tables
  const std::string forward = text("results/scene-forward.xml");
  fs::create_directories(folder_ / "other");
  const auto run_other = [&](const std::string& text) {
    for (const auto& entry : fs::directory_iterator(folder_ / "results"))
      if (entry.path().extension() == ".csv")
        fs::copy_file(entry.path(), folder_ / "other" / entry.path().filename(), fs::copy_options::overwrite_existing);
    write_text(folder_ / "other/forward.xml", text);
    return mixbeam({"run", "other/forward.xml", "--output", "twin"}).exit_code;
  };
  EXPECT_EQ(run_other(forward), 0);
  EXPECT_EQ(run_other(changed(forward, "\"Curvature Table\"", "\"Strain Table\"")), 2);
  const std::string first = "name=\"Curvature Table\" type=\"string\" value=\"scene-curvature-rod.csv\"";
  EXPECT_EQ(run_other(changed(forward, "<Parameter " + first + "/>", "")), 1);
}

TEST_F(RestShapeFiles, KeepTheThreadsOfTheCommandLine) {
  std::ostringstream said;
  Application app;
  app.communicator = test::this_rank();
  app.terminal = &said;
  app.output = folder_.path();
  read_scene_file(app, write_scene(kRod), mixbeam_definition());
  app.solver.threads = 1;
  take_rest_shape(app, "scene", 1);
  EXPECT_EQ(app.solver.threads, 1);
}

TEST_F(RestShapeFiles, RefusalsSayWhatIsAllowed) {
  const std::string clamp = "Fixed Rotation: [x, y, z]}";
  const std::string loop = changed(kRod, clamp, clamp + ", far: {Point: b}");
  expect_refused(run_scene(loop), {"12 force(s)"});
  expect_code(kOk, run_scene(changed(loop, "Inverse: {}", "Inverse: {Loops: closed}")));
  expect_refused(run_scene(changed(kRod, "Inverse: {}", "Inverse: {Case: wind}")), {"the scene has no cases"});
  const std::string batch = "Batch: {Vary: {x: {Parameter: Sections/rod/EA, First: 4000, Last: 5000, Count: 2}}}\n";
  expect_refused(mixbeam({"batch", write_scene(kRod + batch)}), {"mixbeam run"});
  expect_refused(run_scene(changed(kRod, "Elements: 4", "Elements: 4, Force Integration: full")),
                 {"Force Integration"});
}

}  // namespace
}  // namespace mixbeam::rest_shape_test
