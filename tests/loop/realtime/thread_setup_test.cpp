#include "loop/realtime/thread_setup.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace wholehand {
namespace {

const SetupLine* find(const SetupReport& report, const std::string& what) {
  for (const SetupLine& line : report) {
    if (line.what == what) {
      return &line;
    }
  }
  return nullptr;
}

TEST(CpuList, KernelNotation_GivesEveryCpu) {
  EXPECT_EQ(parseCpuList("0-2,5"), (std::vector<int>{0, 1, 2, 5}));
  EXPECT_EQ(parseCpuList("3"), std::vector<int>{3});
  EXPECT_EQ(parseCpuList(""), std::vector<int>{});
  EXPECT_EQ(parseCpuList("\n"), std::vector<int>{});
  EXPECT_EQ(parseCpuList("x,1"), std::vector<int>{1});
}

// A fresh thread, so its settings end with it.
TEST(ThreadSetup, AnyGrantedRights_AreReportedTruly) {
  SetupReport report;
  int policy = -1;
  int cpus = 0;
  std::thread thread([&] {
    ThreadSetupConfig config;
    config.lock_memory = false;
    report = setUpThread(config);
    policy = sched_getscheduler(0);
    cpu_set_t set;
    CPU_ZERO(&set);
    sched_getaffinity(0, sizeof set, &set);
    cpus = CPU_COUNT(&set);
  });
  thread.join();
  const SetupLine* priority = find(report, "real-time priority");
  ASSERT_NE(priority, nullptr);
  EXPECT_EQ(priority->granted, policy == SCHED_FIFO);
  const SetupLine* core = find(report, "own core");
  ASSERT_NE(core, nullptr);
  if (core->granted) {
    EXPECT_EQ(cpus, 1);
  }
  EXPECT_EQ(find(report, "locked memory"), nullptr);
  for (const SetupLine& line : report) {
    EXPECT_EQ(line.sentence.back(), '.') << line.what;
    if (!line.granted && line.what != "heap" && line.what != "denormal numbers") {
      EXPECT_NE(line.sentence.find("Remedy: "), std::string::npos) << line.sentence;
    }
  }
}

// The loop and its monitor each have a core if there are two.
TEST(ThreadSetup, CoreBeforeTheLast_DiffersFromTheLastWhereThereAreTwo) {
  const auto coreOf = [](int cores_before_last) {
    int core = -1;
    std::thread thread([&] {
      if (!requestLastCore(cores_before_last).granted) return;
      cpu_set_t set;
      CPU_ZERO(&set);
      sched_getaffinity(0, sizeof set, &set);
      for (int i = 0; i < CPU_SETSIZE && core < 0; ++i) core = CPU_ISSET(i, &set) ? i : -1;
    });
    thread.join();
    return core;
  };
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
  const std::size_t isolated = isolatedCpus().size();
  if (CPU_COUNT(&allowed) < 2 || isolated == 1) GTEST_SKIP() << "one core";
  const int last = coreOf(0);
  ASSERT_GE(last, 0);
  EXPECT_GE(coreOf(1), 0);
  EXPECT_LT(coreOf(1), last);
  EXPECT_GE(coreOf(1000), 0) << "the first, where there are not so many";
}

TEST(ThreadSetup, Denormals_AreFlushedToZero) {
  double halved = 1.0;
  bool flushed = false;
  std::thread thread([&] {
    flushed = flushDenormals();
    volatile double smallest_normal = 2.2250738585072014e-308;
    halved = smallest_normal / 2.0;
  });
  thread.join();
  if (flushed) {
    EXPECT_EQ(halved, 0.0);
  } else {
    EXPECT_GT(halved, 0.0);
  }
}

// Runs in a child process, since a lock and a limit belong to the whole process. With MCL_FUTURE
// under a limit the kernel grants the lock and then refuses the 64 MB: std::bad_alloc in the middle
// of loading.
TEST(ThreadSetup, LimitedMemlock_DoesNotBreakLaterAllocations) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const rlimit limit{8U << 20U, 8U << 20U};
    setrlimit(RLIMIT_MEMLOCK, &limit);
    // Becomes an ordinary user, for whom alone the limit binds. Has no effect if the user is one
    // already.
    if (getuid() == 0 && setuid(65534) != 0) {
      _exit(2);
    }
    const SetupLine line = requestLockedMemory();
    std::vector<unsigned char> large(64U << 20U, 1);
    _exit(large.back() == 1 && !line.sentence.empty() ? 0 : 3);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace wholehand
