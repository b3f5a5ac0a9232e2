// The doctor's verdicts on invented machines.
#include "apps/wholehand/doctor/doctor_findings.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sched.h>
#include <string>
#include <thread>
#include <unistd.h>

namespace wholehand {
namespace {

MachineFacts goodMachine() {
  MachineFacts m;
  m.kernel = "6.1.0-25-rt-amd64";
  m.real_time_kernel = true;
  m.cpus_allowed = m.cpus_online = 4;
  m.isolated = {3};
  m.governor = "performance";
  m.rtprio_limit = 99;
  m.memlock_limit_bytes = -1;
  return m;
}

WakeUpProbe goodLoop() {
  WakeUpProbe probe;
  probe.statistics.wake_ups = 3000;
  probe.statistics.p50_ns = 4'000;
  probe.statistics.p99_ns = 9'000;
  probe.statistics.p999_ns = 18'000;
  probe.statistics.max_ns = 41'000;
  probe.setup = {{"locked memory", true, "All memory is locked."},
                 {"real-time priority", true, "SCHED_FIFO, priority 80."}};
  return probe;
}

Verdict verdict(const MachineFacts& machine, const WakeUpProbe& probe, bool root = false) {
  Findings all = findingsAboutMachine(machine, root);
  const Findings loop = findingsAboutLoop(probe, 1'000'000);
  all.insert(all.end(), loop.begin(), loop.end());
  return verdictOf(all);
}

bool contains(const Verdict& v, const std::string& part) {
  return v.sentence.find(part) != std::string::npos;
}

/// Checks that the verdict is one sentence: one full stop at the end, no line break.
void expectOneSentence(const Verdict& v) {
  EXPECT_EQ(v.sentence.find('\n'), std::string::npos) << v.sentence;
  EXPECT_EQ(v.sentence.find(". "), std::string::npos) << v.sentence;
  EXPECT_EQ(v.sentence.back(), '.') << v.sentence;
}

TEST(Doctor, FullyEquippedMachine_MayDriveADeviceAndSaysWhy) {
  const Verdict v = verdict(goodMachine(), goodLoop());
  EXPECT_TRUE(v.fit) << v.sentence;
  expectOneSentence(v);
  EXPECT_TRUE(contains(v, "may drive a device")) << v.sentence;
  for (const char* why : {"PREEMPT_RT", "real-time priority is granted", "at most 41 µs late",
                          "p99.9 18 µs", "half a period, 500 µs", "governor is performance"}) {
    EXPECT_TRUE(contains(v, why)) << why << ": " << v.sentence;
  }
}

TEST(Doctor, WakeUpsLaterThanHalfAPeriod_MustNotDriveADevice) {
  WakeUpProbe probe = goodLoop();
  probe.statistics.max_ns = 500'000;  // half of 1 ms: no longer below
  const Verdict v = verdict(goodMachine(), probe);
  EXPECT_FALSE(v.fit);
  expectOneSentence(v);
  EXPECT_TRUE(contains(v, "must not drive a device")) << v.sentence;
  EXPECT_TRUE(contains(v, "up to 500 µs late (p99.9 18 µs; allowed is half a period, 500 µs)"))
      << v.sentence;
  EXPECT_TRUE(contains(v, "remedy: close other programs")) << v.sentence;
  EXPECT_FALSE(contains(v, "PREEMPT_RT")) << "what is well is no reason: " << v.sentence;
  probe.statistics.max_ns = 499'000;
  EXPECT_TRUE(verdict(goodMachine(), probe).fit);
  probe.statistics.skipped_periods = 1;
  EXPECT_FALSE(verdict(goodMachine(), probe).fit);
}

TEST(Doctor, NoRealTimePriority_MustNotDriveADeviceHoweverPunctual) {
  MachineFacts machine = goodMachine();
  machine.rtprio_limit = 0;
  WakeUpProbe probe = goodLoop();
  probe.setup[1] = {"real-time priority", false,
                    "The loop runs at normal priority (Operation not permitted): other programs "
                    "delay it. Remedy: Add '@realtime - rtprio 99'."};
  const Verdict v = verdict(machine, probe);
  EXPECT_FALSE(v.fit);
  expectOneSentence(v);
  EXPECT_EQ(v.sentence,
            "This machine must not drive a device, only simulate: real-time priority is not "
            "granted; remedy: grant rtprio 99.");
  // A process that may exceed the limit and is granted the priority is fit as well.
  EXPECT_TRUE(verdict(machine, goodLoop(), true).fit);
}

TEST(Doctor, EachMissingItem_IsAReasonWithItsRemedy) {
  struct Case {
    void (*corrupt)(MachineFacts&);
    const char *reason, *remedy;
  };
  const Case cases[] = {
      {[](MachineFacts& m) { m.real_time_kernel = false; }, "not PREEMPT_RT", "linux-image-rt"},
      {[](MachineFacts& m) { m.governor = "powersave"; }, "powersave", "governor performance"},
      {[](MachineFacts& m) { m.cpus_allowed = 1; }, "no core of its own", "second core"},
      {[](MachineFacts& m) { m.memlock_limit_bytes = 65536; }, "cannot be locked", "memlock"}};
  for (const Case& c : cases) {
    MachineFacts machine = goodMachine();
    c.corrupt(machine);
    const Verdict v = verdict(machine, goodLoop());
    EXPECT_FALSE(v.fit) << c.reason;
    expectOneSentence(v);
    EXPECT_TRUE(contains(v, c.reason)) << v.sentence;
    EXPECT_TRUE(contains(v, c.remedy)) << v.sentence;
  }
  MachineFacts bare = goodMachine();  // neither prevents driving a device
  bare.governor.clear();
  bare.isolated.clear();
  EXPECT_TRUE(verdict(bare, goodLoop()).fit);
}

TEST(Doctor, NoLoop_IsNotFit) {
  const Verdict v = verdictOf(findingsAboutNoLoop({fileFault("", "no thread", "check ulimit")}));
  EXPECT_FALSE(v.fit);
  EXPECT_TRUE(contains(v, "no thread")) << v.sentence;
}

class Adapters : public testing::Test {
 protected:
  void plug(const std::string& tty, const std::string& latency_timer) {
    const std::filesystem::path at = std::filesystem::path(folder_.path()) / tty;
    std::filesystem::create_directories(at);
    if (!latency_timer.empty()) std::ofstream(at / "latency_timer") << latency_timer << "\n";
  }
  test::Folder folder_;
};

TEST_F(Adapters, FtdiWithALatencyTimer_IsNamedWithTheTimerAndTheRemedy) {
  plug("ttyUSB1", "1");
  plug("ttyUSB0", "16");
  plug("ttyUSB2", "");  // another manufacturer's: it has no such timer
  const Findings found = findingsAboutAdapters(folder_.path());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].what, "ttyUSB0");
  EXPECT_FALSE(found[0].good);
  EXPECT_NE(found[0].fact.find("up to 16 ms"), std::string::npos) << found[0].fact;
  EXPECT_NE(found[0].remedy.find("echo 1 > " + folder_.path() + "/ttyUSB0/latency_timer"),
            std::string::npos)
      << found[0].remedy;
  EXPECT_EQ(found[1].what, "ttyUSB1");
  EXPECT_TRUE(found[1].good);
  EXPECT_TRUE(verdictOf(found).fit) << "it may belong to something else";
}

TEST_F(Adapters, NoAdapterOrNoFolder_FindsNothing) {
  EXPECT_TRUE(findingsAboutAdapters(folder_.path()).empty());
  EXPECT_TRUE(findingsAboutAdapters(folder_.file("none")).empty());
}

// Cores may have different governors; the governor of the loop's core counts.
TEST(Doctor, CoresWithDifferentGovernors_ReadsThatOfTheLoopsCore) {
  const test::Folder sys;
  for (long core = 0; core < sysconf(_SC_NPROCESSORS_CONF); ++core) {
    const std::string folder =
        sys.file("devices/system/cpu/cpu" + std::to_string(core) + "/cpufreq");
    std::filesystem::create_directories(folder);
    std::ofstream(folder + "/scaling_governor") << "of core " << core << "\n";
  }
  int core = 0;  // core 0 where the loop cannot have its own core
  std::thread loop([&core] {
    if (requestLastCore().granted) core = sched_getcpu();
  });
  loop.join();
  EXPECT_EQ(machineFacts(sys.path()).governor, "of core " + std::to_string(core));
}

}  // namespace
}  // namespace wholehand
