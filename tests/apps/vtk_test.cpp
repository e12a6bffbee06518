/// VTK's own reader opens the results as a time series; its points and point data are the solver's, which are printed
/// here from the state, without the result file.
#include "discretization/parameters/validate.hpp"
#include "discretization/reading/read_scene.hpp"
#include "mixbeam_files.hpp"
#include "tests/support/solve.hpp"

#include "discretization/parameters/parameter_file.hpp"
#include "kernels/math/rotation.hpp"

#include <cstdio>

namespace mixbeam::vtk_test {
namespace {

constexpr int kNoReader = 77;  // as read_with_vtk.py says

void append(std::string& line, const Vec3<double>& v) {
  char text[96];
  std::snprintf(text, sizeof text, ",%.17g,%.17g,%.17g", v[0], v[1], v[2]);
  line += text;
}

/// One line of values for each sample, in the order of the mesh.
std::string values_of(const Simulation& simulation, int step) {
  const Structure& structure = simulation.model().structure();
  const Mesh& mesh = simulation.model().mesh();
  std::string lines;
  for (size_t e = 0; e < mesh.elements.size(); ++e) {
    const int member = mesh.elements[e].member;
    const int points = recorded_points(simulation.scene().members[member].order, mesh.elements_of(member));
    for (int i = 0; i < points; ++i) {
      const double xi = -1.0 + 2.0 * i / (points - 1);
      const PointSample sample = sample_element(structure, mesh, simulation.state(), structure.local_element(e), xi);
      const Mat3<double> triad = rotation_matrix(sample.triad);
      std::string line = std::to_string(step);
      append(line, sample.position);
      append(line, sample.displacement);
      append(line, triad * sample.force);
      append(line, triad * sample.moment);
      for (int j = 0; j < 3; ++j) append(line, {{triad(0, j), triad(1, j), triad(2, j)}});
      lines += line + "\n";
    }
  }
  return lines;
}

/// What the solver holds after each step of a scene file with default solver parameters.
std::string solved_values(const std::string& file) {
  const XmlParameters xml = read_parameters(file, {});
  const Scene scene = read_scene(xml.list->sublist("Scene"), xml.source);
  Simulation simulation(scene, SolverParameters(), test::this_rank());
  std::string text = "step,values\n";
  simulation.run([&](const StepReport& report, const State&) { text += values_of(simulation, report.step); });
  EXPECT_TRUE(simulation.result().finished);
  return text;
}

/// A Python whose VTK has XDMF readers: Debian's with python3-paraview, or the one that MIXBEAM_VTK_PYTHON names.
std::string python() {
  const char* given = std::getenv("MIXBEAM_VTK_PYTHON");
  return given == nullptr ? "/usr/bin/python3" : given;
}

class Vtk : public MixbeamTest {
 protected:
  Ended compare(const std::string& values) {
    write_text(folder_ / "values.csv", values);
    return run_process(
        python(),
        {std::string(MIXBEAM_SOURCE_DIR) + "/tests/apps/read_with_vtk.py", file("scene.xdmf"), file("values.csv")},
        folder_);
  }
};

TEST_F(Vtk, ReadsTheTimeSeriesAsTheSolverHasIt) {
  write_text(folder_ / "scene.xml", scene_of("fork"));
  const std::string scene = file("scene.xml");
  ASSERT_EQ(mixbeam({"run", scene, "--output", folder_.path().string()}).exit_code, 0);
  const std::string values = solved_values(scene);
  const Ended ended = compare(values);
  MIXBEAM_REQUIRE_TOOL(
      !(ended.exit_code == kNoReader || ended.err.find("No module named 'vtkmodules'") != std::string::npos),
      "VTK with an XDMF reader (Debian: python3-paraview): " + ended.out);
  EXPECT_EQ(ended.exit_code, 0) << ended.out << ended.err;
  expect_in(ended.out, {"3 steps, largest difference"});
  std::cout << ended.out;
  // the twin that must fail: one digit of one value of the last step
  std::string wrong = values;
  const std::size_t digit = wrong.rfind(',') + 4;
  wrong[digit] = wrong[digit] == '5' ? '6' : '5';
  EXPECT_EQ(compare(wrong).exit_code, 1);
}

}  // namespace
}  // namespace mixbeam::vtk_test
