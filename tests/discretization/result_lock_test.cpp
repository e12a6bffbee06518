/// One writer for each result file: in one process, in two, after a kill.
#include "discretization/results/result_lock.hpp"

#include "discretization/results/result_file.hpp"
#include "tests/support/child.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/files.hpp"

#include <algorithm>

namespace mixbeam::result_lock_test {
namespace {

class ResultLocks : public ::testing::Test {
 protected:
  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

std::string problem_of(const fs::path& file) {
  return error_of<ResultFileError>([&] { const ResultLock lock(file); });
}

TEST_F(ResultLocks, TheSecondOneIsToldWhoWrites) {
  const fs::path file = folder_ / "run.h5";
  {
    const ResultLock first(file);
    EXPECT_EQ(first.warning(), "");
    expect_in(problem_of(file), {file.string(), "process " + std::to_string(getpid()) + " on "});
    EXPECT_EQ(problem_of(folder_ / "other.h5"), "no error") << "other files of the folder are free";
  }
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(problem_of(file), "no error");
}

TEST_F(ResultLocks, EndsWithTheProcess) {
  const fs::path file = folder_ / "run.h5";
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = started([&]() -> int {
    const ResultLock lock(file);
    if (write(ready[1], "x", 1) != 1) _exit(1);
    for (;;) pause();
  });
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  expect_in(problem_of(file), {"process " + std::to_string(child) + " on "});
  kill(child, SIGKILL);
  end_of(child);
  close(ready[0]);
  close(ready[1]);
  EXPECT_TRUE(fs::exists(folder_ / ".run.h5.lock")) << "left by the killed one";
  EXPECT_EQ(problem_of(file), "no error");
}

TEST_F(ResultLocks, ASecondResultFileTouchesNothing) {
  const fs::path file = folder_ / "run.h5";
  const ResultHeader header{"scene", "<xml/>", "1", {}};
  const auto names = [&] {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder_)) found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  };
  ResultFile first(file, header);
  std::ofstream(folder_ / "run.xdmf") << "of an earlier run";
  const auto before = names();
  EXPECT_THROW(ResultFile(file, header), ResultFileError);
  EXPECT_THROW(ResultFile(folder_ / "." / "run.h5", header), ResultFileError) << "by another name";
  EXPECT_EQ(names(), before);
  first.close();
  EXPECT_NO_THROW(ResultFile(file, header));
}

/// Somebody has put links where hidden files are made.
TEST_F(ResultLocks, NothingIsWrittenThroughLinks) {
  const fs::path file = folder_ / "run.h5", precious = folder_ / "precious", nowhere = folder_ / "nowhere";
  std::ofstream(precious) << "process of mine";  // begins as a lock does
  for (const fs::path& target : {precious, nowhere}) {
    fs::create_symlink(target, folder_ / ".run.h5.lock");
    expect_in(problem_of(file), {"cannot create the file"});
    fs::remove(folder_ / ".run.h5.lock");
  }
  fs::create_hard_link(precious, folder_ / ".run.h5.lock");
  expect_in(problem_of(file), {"several names"});
  fs::remove(folder_ / ".run.h5.lock");
  for (const char* hidden : {".run.h5.a", ".run.h5.b", ".run.h5.new"}) fs::create_symlink(precious, folder_ / hidden);
  fs::create_symlink(nowhere, folder_ / ".run.xdmf.new");
  EXPECT_EQ(problem_of(file), "no error") << "the twin";
  EXPECT_NO_THROW(ResultFile(file, {"scene", "<xml/>", "1", {}}).close());
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(file)));
  EXPECT_EQ(text_of(precious), "process of mine");
  EXPECT_FALSE(fs::exists(nowhere));
}

}  // namespace
}  // namespace mixbeam::result_lock_test
