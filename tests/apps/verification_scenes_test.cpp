/// Reference values from outside the paper, each from a plain scene file: the program runs it and compares.
#include "process.hpp"

#include <algorithm>
#include <cctype>

namespace mixbeam::verification_scenes_test {
namespace {

constexpr int kAllChecksPassed = 0, kCheckFailed = 1;

std::vector<fs::path> scenes() {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(fs::path(MIXBEAM_SOURCE_DIR) / "apps/verification"))
    if (entry.path().extension() == ".xml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

Ended run_scene(const fs::path& scene, const TemporaryFolder& folder) {
  return run_process(program("mixbeam"),
                     {"run", scene.string(), "--quiet", "--threads", "1", "--output", folder.path().string()}, folder);
}

class VerificationScene : public ::testing::TestWithParam<fs::path> {};

TEST_P(VerificationScene, GivesItsReferenceValues) {
  const TemporaryFolder folder;
  const Ended ended = run_scene(GetParam(), folder);
  EXPECT_EQ(ended.exit_code, kAllChecksPassed) << ended.out << ended.err;
}

/// The first expected value changed in its eighth digit or before is noticed.
TEST_P(VerificationScene, NoticesAnotherValue) {
  const TemporaryFolder folder;
  std::string text = text_of(GetParam());
  const std::string begin = "name=\"Value\" type=\"double\" value=\"";
  const std::size_t value = text.find(begin);
  ASSERT_NE(value, std::string::npos);
  const std::size_t first = value + begin.size(), end = text.find('"', first);
  const double reference = std::stod(text.substr(first, end - first));
  std::ostringstream other;
  other.precision(15);
  other << reference * (1.0 + 1e-7);
  write_text(folder / "other.xml", text.replace(first, end - first, other.str()));
  EXPECT_EQ(run_scene(folder / "other.xml", folder).exit_code, kCheckFailed);
}

INSTANTIATE_TEST_SUITE_P(Scenes, VerificationScene, ::testing::ValuesIn(scenes()), [](const auto& scene) {
  std::string name = scene.param.stem().string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

}  // namespace
}  // namespace mixbeam::verification_scenes_test
