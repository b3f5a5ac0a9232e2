// Judgements of watched_main.cpp on failures: this program runs itself with one failing test.
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <string>
#include <sys/wait.h>
#include <unistd.h>

namespace wholehand::test {
namespace {

/// Stops this whole process, including the sleepers, for 50 ms; a child process continues it.
void standStill() {
  seesRealTime();
  const pid_t stopped = ::getpid();
  const pid_t child = ::fork();
  for (int i = 0; child == 0 && i < 1000; ++i) {
    ::usleep(50'000);
    ::kill(stopped, SIGCONT);
  }
  if (child == 0) ::_exit(0);
  ::kill(stopped, SIGSTOP);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

TEST(WatchedMainCase, DISABLED_FailsAtOnce) {
  seesRealTime();
  FAIL() << "at once";
}
TEST(WatchedMainCase, DISABLED_FailsAfterAStall) {
  standStill();
  EXPECT_EQ(1, 2) << "late";
}
TEST(WatchedMainCase, DISABLED_FailsWhateverTheMachineDoes) {
  standStill();
  EXPECT_EQ(1, 2) << kAlways << "late";
}
TEST(WatchedMainCase, DISABLED_FailsAfterAStallInATestWithoutRealTime) {
  standStill();
  g_sees_real_time = false;
  FAIL() << "by itself";
}
TEST(WatchedMainCase, DISABLED_CrashesAfterAStall) {
  standStill();
  ::raise(SIGKILL);
}
TEST(WatchedMainCase, DISABLED_PassesAfterAStall) {
  standStill();
}

struct Ran {
  int status = -1;
  std::string said;
};

Ran ranItself(const std::string& filter) {
  seesRealTime();
  const std::string command = "exec '" + std::string("/proc/") + std::to_string(::getpid()) +
                              "/exe' --gtest_also_run_disabled_tests --gtest_filter='" + filter +
                              "' 2>&1";
  ::unsetenv("GTEST_TOTAL_SHARDS");
  ::unsetenv("GTEST_SHARD_INDEX");
  Ran ran;
  std::FILE* out = ::popen(command.c_str(), "r");
  if (out == nullptr) return ran;
  std::array<char, 4096> part{};
  for (std::size_t n; (n = std::fread(part.data(), 1, part.size(), out)) > 0;) {
    ran.said.append(part.data(), n);
  }
  ran.status = ::pclose(out);
  return ran;
}

struct Case {
  const char* test;
  bool fails;
  const char* expected;
};

TEST(WatchedMain, FailedTest_IsExcusedOnlyByAStall) {
  const std::array<Case, 5> cases{{
      {"FailsAtOnce", true, "real time: 1 judged, 0 not judged"},
      {"FailsAfterAStall", false, "real time: 0 judged, 1 not judged"},
      {"FailsWhateverTheMachineDoes", true, "real time: 1 judged, 0 not judged"},
      {"FailsAfterAStallInATestWithoutRealTime", true, "real time: 0 judged, 0 not judged"},
      {"PassesAfterAStall", false, "real time: 1 judged, 0 not judged"},
  }};
  for (const Case& c : cases) {
    const Ran ran = ranItself(std::string("WatchedMainCase.DISABLED_") + c.test);
    ASSERT_TRUE(WIFEXITED(ran.status)) << ran.said;
    EXPECT_EQ(WEXITSTATUS(ran.status) != 0, c.fails) << c.test << "\n" << ran.said;
    EXPECT_NE(ran.said.find(c.expected), std::string::npos) << c.test << "\n" << ran.said;
  }
}

TEST(WatchedMain, TestNotJudged_IsNamedOnOneLineWithTheReason) {
  const Ran ran = ranItself("WatchedMainCase.DISABLED_FailsAfterAStall");
  const std::size_t at = ran.said.find(
      "not judged: WatchedMainCase.DISABLED_FailsAfterAStall: this machine kept a sleeper waiting "
      "for ");
  ASSERT_NE(at, std::string::npos) << ran.said;
  const std::string line = ran.said.substr(at, ran.said.find('\n', at) - at);
  EXPECT_NE(line.find("watched_main_test.cpp:"), std::string::npos) << line;
}

TEST(WatchedMain, Crash_IsNeverExcused) {
  const Ran ran = ranItself("WatchedMainCase.DISABLED_CrashesAfterAStall");
  EXPECT_TRUE(!WIFEXITED(ran.status) || WEXITSTATUS(ran.status) != 0);
}

TEST(WatchedMain, OneOfTwoExcused_StillFailsForTheOther) {
  const Ran ran =
      ranItself("WatchedMainCase.DISABLED_Fails*At*:WatchedMainCase.DISABLED_Fails*Stall");
  ASSERT_TRUE(WIFEXITED(ran.status));
  EXPECT_EQ(WEXITSTATUS(ran.status), 1) << ran.said;
}

}  // namespace
}  // namespace wholehand::test
