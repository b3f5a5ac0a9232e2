#include "loop/realtime/system_call_counter.hpp"

#include "loop/realtime/monotonic_clock.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

namespace wholehand {
namespace {

class SystemCallCounter : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why_not = watchSystemCalls(); !why_not.empty()) {
      GTEST_SKIP() << why_not;
    }
    before_ = threadSystemCalls();
  }
  [[nodiscard]] std::uint64_t counted() const { return threadSystemCalls() - before_; }

 private:
  std::uint64_t before_ = 0;
};

TEST_F(SystemCallCounter, WhileCounting_EachCallIsCountedAndDoesItsWork) {
  int ends[2] = {};
  ASSERT_EQ(pipe(ends), 0);
  char got[6] = {};
  countSystemCalls(true);
  const bool all = write(ends[1], "hello", 5) == 5 && read(ends[0], got, 5) == 5;
  const long process = syscall(SYS_getpid);
  errno = 0;
  const int bad = close(-1);
  const int why = errno;
  countSystemCalls(false);
  EXPECT_EQ(counted(), 4U);
  EXPECT_EQ(threadSystemCalls(SYS_close), 1U);
  EXPECT_TRUE(all);
  EXPECT_STREQ(got, "hello");
  EXPECT_EQ(process, getpid());
  EXPECT_EQ(bad, -1);
  EXPECT_EQ(why, EBADF);
  close(ends[0]);
  close(ends[1]);
  EXPECT_EQ(counted(), 4U) << "counted on";
}

TEST_F(SystemCallCounter, Sleep_IsCountedByItsNumber) {
  const std::uint64_t sleeps = threadSystemCalls(SYS_clock_nanosleep);
  const std::int64_t began_ns = monotonicNow_ns();
  countSystemCalls(true);
  std::this_thread::sleep_for(std::chrono::milliseconds(2));
  countSystemCalls(false);
  EXPECT_GE(monotonicNow_ns() - began_ns, 2'000'000);
  EXPECT_EQ(threadSystemCalls(SYS_clock_nanosleep) - sleeps, 1U);
}

TEST_F(SystemCallCounter, CpuClock_IsACallAndArithmeticIsNot) {
  const std::uint64_t clocks = threadSystemCalls(SYS_clock_gettime);
  volatile double x = 1.0;
  countSystemCalls(true);
  for (int i = 0; i < 1000; ++i) x = x * 1.0000001;
  const bool none = counted() == 0;
  (void)threadCpuNow_ns();
  countSystemCalls(false);
  EXPECT_TRUE(none);
  EXPECT_EQ(threadSystemCalls(SYS_clock_gettime) - clocks, 1U);
}

TEST_F(SystemCallCounter, OtherThreads_AreNotCounted) {
  std::atomic<bool> go{false};
  std::thread other([&] {
    while (!go) std::this_thread::sleep_for(std::chrono::microseconds(100));
  });
  countSystemCalls(true);
  for (int i = 0; i < 1'000'000; ++i) {
    asm volatile("" : : : "memory");
  }
  countSystemCalls(false);
  go = true;
  other.join();
  EXPECT_EQ(counted(), 0U);
}

TEST(ThreadUsage, FreshPageAndSleep_AreCounted) {
  constexpr std::size_t kPages = 8;
  const ThreadUsage before = threadUsage();
  auto* pages = static_cast<volatile char*>(
      mmap(nullptr, kPages * 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(pages, MAP_FAILED);
  (void)madvise(const_cast<char*>(pages), kPages * 4096, MADV_NOHUGEPAGE);
  for (std::size_t i = 0; i < kPages; ++i) pages[i * 4096] = 1;
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const ThreadUsage after = threadUsage();
  munmap(const_cast<char*>(pages), kPages * 4096);
  EXPECT_GE(after.minor_faults - before.minor_faults, std::int64_t{kPages});
  EXPECT_GE(after.voluntary_switches - before.voluntary_switches, 1);
}

}  // namespace
}  // namespace wholehand
