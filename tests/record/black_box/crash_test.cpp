#include "record/black_box/box_tools.hpp"
#include "record/black_box/child_tools.hpp"
#include "record/crash_guard.hpp"

#include <climits>

#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <functional>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

namespace wholehand::test {
namespace {

using synthetic::Folder;

void expectBox(const std::string& path, int signal, std::uint64_t ticks) {
  const auto read = opened(path);
  ASSERT_NE(read, nullptr);
  EXPECT_EQ(read->cause().signal, signal);
  EXPECT_EQ(read->size(), ticks);
  EXPECT_EQ(read->inputTicks(), ticks);
  std::mt19937_64 random(1);
  TickRecord got;
  for (std::uint64_t i = 0; i < ticks; ++i) {
    ASSERT_TRUE(read->read(i, got));
    ASSERT_EQ(bytesOf(got), bytesOf(tickAt(i, random))) << i;
  }
}

void tickTimes(BlackBox& box, std::uint64_t count) {
  std::mt19937_64 random(1);
  for (std::uint64_t i = 0; i < count; ++i) giveTick(box, tickAt(i, random));
}

volatile int g_deepest = INT_MAX;
volatile int g_sum = 0;

[[gnu::noinline]] int dig(int depth) {
  volatile char room[4096];
  room[0] = static_cast<char>(depth);
  return depth < g_deepest ? dig(depth + 1) + room[0] : 0;
}

void breakHere() {
#if defined(__x86_64__)
  __asm__ volatile("int3");
#else
  ::raise(SIGTRAP);
#endif
}

// A system call that a service's filter traps.
void callARefusedOne() {
  std::array<sock_filter, 4> steps{{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_getppid, 0, 1),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  }};
  const sock_fprog filter{steps.size(), steps.data()};
  ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter);
  ::syscall(SYS_getppid);
}

struct Crash {
  const char* name;
  int signal;
  std::function<void()> happen;
};

std::vector<Crash> crashes() {
  return {
      {"null pointer", SIGSEGV, writeToNowhere},
      {"abort", SIGABRT, [] { std::abort(); }},
      {"exception that nobody catches", SIGABRT, [] { std::terminate(); }},
      {"sent SIGBUS", SIGBUS, [] { ::raise(SIGBUS); }},
      {"sent SIGFPE", SIGFPE, [] { ::raise(SIGFPE); }},
      {"no instruction", SIGILL, [] { __builtin_trap(); }},
      {"breakpoint", SIGTRAP, breakHere},
      {"sent SIGTRAP", SIGTRAP, [] { ::raise(SIGTRAP); }},
      {"refused system call", SIGSYS, callARefusedOne},
      {"sent SIGSYS", SIGSYS, [] { ::raise(SIGSYS); }},
      {"sent SIGSEGV", SIGSEGV, [] { ::kill(::getpid(), SIGSEGV); }},
      {"stack overflow", SIGSEGV, [] { g_sum = dig(0); }},
  };
}

TEST(CrashedProcess, EverySignalInTheTickingThread_LeavesAReadableFileAndTheSignal) {
  for (const Crash& crash : crashes()) {
    SCOPED_TRACE(crash.name);
    const Folder folder;
    const std::string path = folder.file("new/a.wbb");
    const int status = inChild([&] {
      auto box = armed(planFor(path));
      std::thread loop([&] {
        tickTimes(*box, 700);
        crash.happen();
      });
      loop.join();
    });
    expectDiedOf(crash.signal, status);
    expectBox(path, crash.signal, 700);
    EXPECT_FALSE(opened(path)->cause().within_tick);
  }
}

TEST(CrashedProcess, CrashInTheMiddleOfATick_IsReported) {
  const Folder folder;
  const int status = inChild([&] {
    auto box = armed(planFor(folder.file("a.wbb")));
    tickTimes(*box, 50);
    box->beforeTick(TickRecord{});
    std::abort();
  });
  expectDiedOf(SIGABRT, status);
  expectBox(folder.file("a.wbb"), SIGABRT, 50);
  EXPECT_TRUE(opened(folder.file("a.wbb"))->cause().within_tick);
}

TEST(CrashedProcess, CrashBeforeTheFirstTickOrAfterTheEnd_LeavesNoFile) {
  const Folder folder;
  expectDiedOf(SIGABRT, inChild([&] {
                 auto box = armed(planFor(folder.file("a.wbb")));
                 std::abort();
               }));
  expectDiedOf(SIGABRT, inChild([&] {
                 auto box = armed(planFor(folder.file("a.wbb")));
                 tickTimes(*box, 50);
                 box.reset();
                 std::abort();
               }));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(CrashedProcess, CrashOfManyThreadsAtOnce_LeavesOneCompleteFile) {
  const Folder folder;
  const int status = inChild([&] {
    auto box = armed(planFor(folder.file("a.wbb")));
    tickTimes(*box, 300);
    std::atomic<int> ready{0};
    std::vector<std::thread> threads;
    for (int i = 0; i < 6; ++i) {
      threads.emplace_back([&ready] {
        for (++ready; ready < 6;) std::this_thread::yield();
        ::raise(SIGSEGV);
      });
    }
    for (auto& t : threads) t.join();
  });
  expectDiedOf(SIGSEGV, status);
  expectBox(folder.file("a.wbb"), SIGSEGV, 300);
}

/// Crashes again while a crash is being handled.
class CrashingWitness final : public CrashHandler {
 public:
  void crashed(int) noexcept override { writeToNowhere(); }
};

TEST(CrashGuard, HandlerThatCrashes_EndsTheProcessWithoutALoop) {
  const int status = inChild([] {
    CrashingWitness witness;
    const CrashGuard guard(witness);
    std::abort();
  });
  EXPECT_TRUE(!WIFSIGNALED(status) || WTERMSIG(status) != SIGALRM) << "it went on for a minute";
  expectDiedOf(SIGSEGV, status);
}

TEST(CrashGuard, AfterTheLastGuard_EarlierSignalHandlersAreRestored) {
  struct sigaction before {
  }, after{};
  ::sigaction(SIGSEGV, nullptr, &before);
  {
    CrashingWitness witness;
    const CrashGuard first(witness), second(witness);
    EXPECT_TRUE(first.stands() && second.stands());
  }
  ::sigaction(SIGSEGV, nullptr, &after);
  EXPECT_EQ(before.sa_handler, after.sa_handler);
}

}  // namespace
}  // namespace wholehand::test
