/// `mixbeam run` of scenes with the list "Inverse": its files, and the scene that runs forward.
#include "mixbeam_files.hpp"

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

class RestShapeFiles : public ::testing::Test {
 protected:
  RestShapeFiles() { write_text(folder_ / "points.csv", "name,x,y,z\na,0,0,0\nb,1,0.2,0\n"); }
  Ended run(const std::string& text, const std::string& command = "run") {
    write_text(folder_ / "scene.yaml", text);
    return run_process(program("mixbeam"), {command, "scene.yaml", "--output", "out", "--summary", "summary.json"},
                       folder_);
  }
  bool is_there(const std::string& name) const { return fs::exists(folder_ / "out" / name); }

  TemporaryFolder folder_;
};

TEST_F(RestShapeFiles, RunForwardToTheDrawnShape) {
  const Ended ended = run(kRod);
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  for (const char* file : {"scene-curvature-rod.csv", "scene-strain-rod.csv", "scene-natural-rod.csv", "scene.h5"})
    EXPECT_TRUE(is_there(file)) << file;
  EXPECT_NE(text_of(folder_ / "summary.json").find("\"negative eigenvalues of the drawn state\": 0"),
            std::string::npos);
  // by itself, and wrong without its tables
  const std::string forward = text_of(folder_ / "out/scene-forward.xml");
  fs::create_directories(folder_ / "other");
  const auto run_other = [&](const std::string& text) {
    for (const auto& entry : fs::directory_iterator(folder_ / "out"))
      if (entry.path().extension() == ".csv")
        fs::copy_file(entry.path(), folder_ / "other" / entry.path().filename(), fs::copy_options::overwrite_existing);
    write_text(folder_ / "other/forward.xml", text);
    return run_process(program("mixbeam"), {"run", "other/forward.xml", "--output", "twin"}, folder_).exit_code;
  };
  EXPECT_EQ(run_other(forward), 0);
  EXPECT_EQ(run_other(changed(forward, "\"Curvature Table\"", "\"Strain Table\"")), 2);
  const std::string first = "name=\"Curvature Table\" type=\"string\" value=\"scene-curvature-rod.csv\"";
  EXPECT_EQ(run_other(changed(forward, "<Parameter " + first + "/>", "")), 1);
}

TEST_F(RestShapeFiles, RefusalsSayWhatIsAllowed) {
  const auto refused = [this](const Ended& ended, const std::string& part) {
    EXPECT_EQ(ended.exit_code, 2) << ended.out;
    EXPECT_NE(ended.err.find(part), std::string::npos) << ended.err;
  };
  const std::string clamp = "Fixed Rotation: [x, y, z]}";
  const std::string loop = changed(kRod, clamp, clamp + ", far: {Point: b}");
  refused(run(loop), "12 force(s)");
  EXPECT_EQ(run(changed(loop, "Inverse: {}", "Inverse: {Loops: closed}")).exit_code, 0);
  refused(run(changed(kRod, "Inverse: {}", "Inverse: {Case: wind}")), "the scene has no cases");
  refused(run(changed(kRod, "Inverse: {}",
                      "Inverse: {}\nBatch: {Vary: {x: {Parameter: Sections/rod/EA, First: 4000, "
                      "Last: 5000, Count: 2}}}"),
              "batch"),
          "mixbeam run");
  refused(run(changed(kRod, "Elements: 4", "Elements: 4, Force Integration: full")), "Force Integration");
}

}  // namespace
}  // namespace mixbeam::rest_shape_test
