/// The command line that all applications share.
#include "apps/common/session/command_line.hpp"

#include "discretization/text/errors.hpp"

#include <gtest/gtest.h>

namespace mixbeam {
namespace {

CommandLine line_of(std::vector<const char*> words) {
  words.insert(words.begin(), "program");
  return read_command_line(static_cast<int>(words.size()), words.data());
}

TEST(CommandLine, ReadsWhatItSays) {
  const CommandLine empty = line_of({});
  EXPECT_FALSE(empty.scene_file || empty.output || empty.summary || empty.threads || empty.single || empty.quiet);
  const CommandLine line =
      line_of({"--quiet", "scene.xml", "--single", "--threads", "3", "--output", "here", "--summary", "s.json"});
  EXPECT_TRUE(line.single && line.quiet);
  EXPECT_EQ(line.scene_file, "scene.xml");
  EXPECT_EQ(line.threads, 3);
  EXPECT_EQ(line.output, "here");
  EXPECT_EQ(line.summary, "s.json");
  EXPECT_TRUE(line_of({"-h"}).help);
}

TEST(CommandLine, RefusesTheRest) {
  EXPECT_THROW(line_of({"--threads", "1.5"}), InputError);
  EXPECT_THROW(line_of({"--threads"}), InputError);
  EXPECT_THROW(line_of({"--output", ""}), InputError);
  EXPECT_THROW(line_of({""}), InputError);
  EXPECT_THROW(line_of({"--Single2"}), InputError);
  EXPECT_THROW(line_of({"a.xml", "b.xml"}), InputError);
}

}  // namespace
}  // namespace mixbeam
