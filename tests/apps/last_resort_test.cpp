// What a program that was asked to stop does with results that are written as a whole.

#include "apps/common/session/interrupt.hpp"
#include "tests/support/child.hpp"
#include "tests/support/files.hpp"

#include <chrono>
#include <thread>

namespace mixbeam::last_resort_test {
namespace {

constexpr int kOrderlyEnd = 7;
constexpr double kPromised = 2.0, kBusyMachine = 13.0, kTooLate = 20.0;  // seconds

/// Exit code of a process that is interrupted and needs so many seconds to its orderly end.
int exit_code_of(double seconds_to_its_end, const std::function<void()>& save) {
  return end_of(started([&]() -> int {
    watch_for_interrupts();
    {
      const LastResort rows(save);
      ::raise(SIGINT);
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds_to_its_end));
    }
    _exit(kOrderlyEnd);
  }));
}

TEST(LastResort, SavesWhatThereIsWithinTheTimeThatIsPromised) {
  const TemporaryFolder folder;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(exit_code_of(kTooLate, [&] { write_text(folder / "rows", "1\n"); }), kInterruptedExitCode);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), kPromised + kBusyMachine);
  EXPECT_EQ(text_of(folder / "rows"), "1\n");
}

TEST(LastResort, LeavesAnOrderlyEndAlone) {
  const TemporaryFolder folder;
  EXPECT_EQ(exit_code_of(0.0, [&] { write_text(folder / "rows", "1\n"); }), kOrderlyEnd);
  EXPECT_FALSE(fs::exists(folder / "rows"));
}

TEST(LastResort, SaysWhatCouldNotBeSaved) {
  EXPECT_EQ(exit_code_of(kTooLate, [] { throw std::runtime_error("the disk is full"); }), 2);
}

}  // namespace
}  // namespace mixbeam::last_resort_test
