// The measurement of thread scaling in a tiny size, so that it cannot rot; its times are not judged.
#include "tests/apps/process.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

TEST(ThreadScalingApplication, TinySizeWritesEveryPhase) {
  const auto folder = folder_for("thread_scaling_tiny");
  const std::string end_of_file = "</ParameterList>\n</ParameterList>\n";
  const std::string study = R"xml(</ParameterList>
  <ParameterList name="Study">
    <Parameter name="Elements" type="Array(int)" value="{40}"/>
    <Parameter name="Orders" type="Array(int)" value="{1, 3}"/>
    <Parameter name="Threads" type="Array(int)" value="{1, 2}"/>
    <Parameter name="Repetitions" type="int" value="1"/>
    <Parameter name="Repetitions of Runs" type="int" value="1"/>
  </ParameterList>
</ParameterList>
)xml";
  const std::string scene = changed_scene("thread_scaling", end_of_file, study, folder);
  ASSERT_EQ(run_program("thread_scaling", scene, folder), 0) << text_of(folder / "output.txt");
  const std::string table = text_of(folder / "thread_scaling.csv");
  for (const char* phase : {"residual", "element tangent", "assemble", "numeric factorisation", "solve", "recover",
                            "update", "element work", "whole iteration", "run, per iteration"})
    for (const char* key : {"40,1,1,", "40,3,2,"}) {
      const std::string text = phase;
      const std::string cell = text.find(',') == std::string::npos ? text : "\"" + text + "\"";
      EXPECT_NE(table.find(key + cell + ","), std::string::npos) << key << phase << "\n" << table;
    }
  EXPECT_NE(text_of(folder / "machine.csv").find("processor"), std::string::npos);
}

}  // namespace
}  // namespace mixbeam
