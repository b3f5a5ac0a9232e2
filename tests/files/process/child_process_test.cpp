#include "files/process/child_process.hpp"

#include "loop/core/compiler.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <functional>
#include <string>
#include <unistd.h>

namespace wholehand::test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

ChildResult runScript(const std::string& script, const ChildLimits& limits,
                      const std::function<bool()>& stop = {}) {
  return runChild("/bin/sh", {"-c", script}, limits, stop);
}

TEST(ChildProcess, OutputOfAChild_ArrivesCompletelyWithItsExitCode) {
  // 300,000 bytes are more than a pipe holds.
  const ChildResult child =
      runScript("head -c 300000 /dev/zero; exit 7", {.output_bytes = 1 << 20});
  EXPECT_EQ(child.ending, ChildEnding::kExited);
  EXPECT_EQ(child.code, 7);
  EXPECT_EQ(child.output, std::string(300000, '\0'));
}

TEST(ChildProcess, Signal_IsReported) {
  const ChildResult child = runScript("kill -SEGV $$", {.output_bytes = 100});
  EXPECT_EQ(child.ending, ChildEnding::kSignal);
  EXPECT_EQ(child.code, SIGSEGV);
}

TEST(ChildProcess, MemoryBeyondTheLimit_IsRefusedToTheChild) {
  if (WHOLEHAND_SANITIZED != 0) GTEST_SKIP() << "a sanitizer's shadow is larger than any limit";
  const auto ask = [](const char* bytes) {
    return runChild("/usr/bin/python3",
                    {"-c", std::string("import time; time.sleep(0.5); bytearray(") + bytes + ")"},
                    {.time = 60s, .memory_bytes = 256U << 20U});
  };
  EXPECT_EQ(ask("1 << 20").code, 0);
  EXPECT_EQ(ask("1 << 29").code, 1);  // Python's exit code for an exception: MemoryError
}

TEST(ChildProcess, ChildThatNeverEnds_IsEndedAtItsTimeLimit) {
  const auto began = Clock::now();
  // Once with a child that writes nothing, once with one that has closed its output.
  for (const char* script : {"exec sleep 60", "exec sleep 60 >&-"}) {
    const ChildResult child = runScript(script, {.time = 200ms, .output_bytes = 100});
    EXPECT_EQ(child.ending, ChildEnding::kLate) << script;
  }
  EXPECT_LT(Clock::now() - began, 30s);
}

TEST(ChildProcess, ChildThatWritesWithoutEnd_IsEndedAtItsOutputLimit) {
  const ChildResult child = runScript("exec cat /dev/zero", {.time = 60s, .output_bytes = 1 << 20});
  EXPECT_EQ(child.ending, ChildEnding::kTooMuchOutput);
}

TEST(ChildProcess, StopRequest_EndsTheChild) {
  const auto began = Clock::now();
  const ChildResult child = runScript("exec sleep 60", {}, [] { return true; });
  EXPECT_EQ(child.ending, ChildEnding::kStopped);
  EXPECT_LT(Clock::now() - began, 30s);
}

TEST(ChildProcess, MissingProgram_IsReportedByErrno) {
  const ChildResult child = runChild("/nowhere/program", {}, {});
  EXPECT_EQ(child.ending, ChildEnding::kNotStarted);
  EXPECT_EQ(child.code, ENOENT);
}

TEST(ChildProcess, OpenFilesOfThisProcess_AreNotInherited) {
  const int mine = ::dup(0);  // a descriptor without O_CLOEXEC
  ASSERT_GE(mine, 3);
  // Not in a pipe: a shell that starts one has additional descriptors meanwhile.
  const ChildResult child =
      runScript("test -e /proc/$$/fd/" + std::to_string(mine) + " && echo open || echo closed",
                {.output_bytes = 100});
  EXPECT_EQ(child.output, "closed\n");
  ::close(mine);
}

}  // namespace
}  // namespace wholehand::test
