// A rig and its run when something fails: what is refused, what is left open, what is told.
#include "assembly/rig.hpp"

#include "assembly/recorded_run.hpp"
#include "support/rig_tools.hpp"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <limits>
#include <thread>
#include <unistd.h>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDevice = "desktop-3axis";

/// What a device went through, known after its end too.
struct Story {
  bool open = false;
  int reads = 0;
};

/// Rests at the origin; from one read on it fails.
class WatchedDevice final : public HapticDevice {
 public:
  explicit WatchedDevice(Story& story, int fails_at = std::numeric_limits<int>::max())
      : story_(story), fails_at_(fails_at) {}
  [[nodiscard]] Expected<Done> open() override {
    story_.open = true;
    return Done{};
  }
  [[nodiscard]] Expected<Done> ready() override { return Done{}; }
  [[nodiscard]] Fault read(DeviceReading& reading, int) noexcept override {
    reading.q_m = AxisPosition(3);
    return story_.reads++ >= fails_at_ ? Fault::kDeviceRead : Fault::kNone;
  }
  [[nodiscard]] Fault write(const AxisEffort&) noexcept override { return Fault::kNone; }
  void close() noexcept override { story_.open = false; }

 private:
  Story& story_;
  int fails_at_;
};

std::unique_ptr<Rig> watched(Story& story, int fails_at = std::numeric_limits<int>::max(),
                             const RigOptions& options = {}) {
  return build(load(shippedFiles(kDevice)), std::make_unique<WatchedDevice>(story, fails_at),
               options);
}

/// A file name that nobody uses; what was written there vanishes with it.
class TemporaryFile {
 public:
  TemporaryFile()
      : path_(fs::temp_directory_path() / ("wholehand-rig-" + std::to_string(::getpid()) + ".h5")) {
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

TEST(BuildRig, UncertifiedAroundADeviceThatMayHoldAPerson_IsRefused) {
  RigOptions options;
  options.uncertified = true;
  Story story;
  const auto refused =
      buildRig(load(shippedFiles(kDevice)), std::make_unique<WatchedDevice>(story), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.errors().front().key, "uncertified");
  EXPECT_TRUE(buildRigThatMovesNobody(load(shippedFiles(kDevice)),
                                      std::make_unique<WatchedDevice>(story), options));
  Models models = load(shippedFiles(kDevice));
  EXPECT_TRUE(buildRig(models, Intention::throughWaypoints({{0.0, AxisPosition(3)}}), options));
}

void expectTooLarge(const Models& models, const std::string& key, const std::string& count) {
  SCOPED_TRACE(key);
  Story story;
  const Intention rest = Intention::throughWaypoints({{0.0, AxisPosition(3)}});
  const auto around = buildRig(models, std::make_unique<WatchedDevice>(story), {});
  const auto simulated = buildRig(models, rest, {});
  for (const auto* refused : {&around, &simulated}) {
    ASSERT_FALSE(*refused);
    ASSERT_EQ(refused->errors().size(), 1U);
    EXPECT_EQ(refused->errors().front().key, key);
    EXPECT_EQ(refused->errors().front().value, count);
  }
}

// The rooms are those of core/tick_record.hpp, core/axis_array.hpp, dynamics/articulated_body.hpp.
TEST(BuildRig, ModelsPushedBeyondTheTicksRoom_AreRefused) {
  Models full = load(shippedFiles(kDevice));
  for (int i = 0; i < 32; ++i) {
    full.scene.bodies.push_back(ball({0.3, -0.8 + 0.05 * i, 0.5}, 0.01, 0.0));
  }
  Story story;
  EXPECT_TRUE(buildRig(full, std::make_unique<WatchedDevice>(story), {}));  // just fits

  Models bodies = full;
  bodies.scene.bodies.push_back(bodies.scene.bodies.back());
  expectTooLarge(bodies, "bodies", "33");
  Models links = load(shippedFiles(kDevice));
  links.hand.links.resize(41);
  expectTooLarge(links, "links", "41");
  Models joints = load(shippedFiles(kDevice));
  joints.hand.joint_count = 33;
  expectTooLarge(joints, "joints", "33");
  Models axes = load(shippedFiles(kDevice));
  axes.device.axes.resize(17);
  expectTooLarge(axes, "axes", "17");
}

TEST(Rig, AtItsEnd_ClosesTheDevice) {
  Story story;
  auto rig = watched(story);
  ASSERT_TRUE(rig->renderer->arm());
  ASSERT_TRUE(story.open);
  rig.reset();
  EXPECT_FALSE(story.open);
}

TEST(Arm, Refused_LeavesTheDeviceClosed) {
  Story unreadable, buried;
  const auto rig = watched(unreadable, 0);
  EXPECT_FALSE(rig->renderer->arm());
  EXPECT_FALSE(unreadable.open);

  Models models = load(shippedFiles(kDevice));
  models.scene.bodies.push_back(fixedBox(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()));
  const auto in_a_box = build(std::move(models), std::make_unique<WatchedDevice>(buried));
  EXPECT_FALSE(in_a_box->renderer->arm());
  EXPECT_GT(buried.reads, 0);
  EXPECT_FALSE(buried.open);
}

TEST(RunAndRecord, WithoutAThreadOrAFile_ClosesTheDeviceAndLeavesNoRecording) {
  const TemporaryFile file;
  RunPlan plan;
  plan.duration_ticks = 10;
  plan.record = file.path();
  RigOptions too_fast;
  too_fast.period_s = 5e-6;  // below the thread's 10 µs
  Story story;
  const auto rig = watched(story, std::numeric_limits<int>::max(), too_fast);
  ASSERT_TRUE(rig->renderer->arm());
  const auto outcome = runAndRecord(*rig, plan);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.errors().front().key, "period_ns");
  EXPECT_FALSE(story.open);
  EXPECT_FALSE(fs::exists(file.path()));

  Story other;
  const auto second = watched(other);
  ASSERT_TRUE(second->renderer->arm());
  plan.record = file.path() + "/no/such/folder.h5";
  EXPECT_FALSE(runAndRecord(*second, plan));
  EXPECT_FALSE(other.open);
}

TEST(RunAndRecord, FaultWhoseRecordsWereDropped_IsNoSuccess) {
  Story story;
  const auto rig = watched(story, 41);  // arm() is the first read: tick 40
  ASSERT_TRUE(rig->renderer->arm());
  RunPlan plan;
  plan.duration_ticks = 5000;
  plan.queue_ticks = 4;
  bool first = true;
  std::uint64_t told = 0;
  plan.sink = [&](const TickRecord& r) {
    // As long as the run: all but the first five records are dropped.
    if (std::exchange(first, false)) std::this_thread::sleep_for(std::chrono::milliseconds(400));
    told += any(r.faults & kStopping) ? 1 : 0;
  };
  const RunOutcome outcome = orThrow(runAndRecord(*rig, plan));
  ASSERT_EQ(told, 0U);
  EXPECT_TRUE(outcome.faulted);
  EXPECT_GT(outcome.dropped_records, 0U);
  EXPECT_GT(outcome.summary.stopping_faults, 0U);
  EXPECT_NE(faultText(outcome.summary).find(faultName(0)), std::string::npos);
  // No tick went uncounted, whatever was dropped.
  EXPECT_EQ(outcome.summary.ticks, outcome.counters.ticks_run + outcome.summary.missed_deadlines);
  EXPECT_EQ(outcome.counters.ticks_run, outcome.summary.records + outcome.dropped_records);
  EXPECT_FALSE(story.open);
}

TEST(RunAndRecord, SinkThatThrows_IsToldAndTheLoopRunsOn) {
  Story story;
  const auto rig = watched(story);
  ASSERT_TRUE(rig->renderer->arm());
  RunPlan plan;
  plan.duration_ticks = 100;
  plan.sink = [](const TickRecord&) { throw std::runtime_error("no more paper"); };
  const RunOutcome outcome = orThrow(runAndRecord(*rig, plan));
  EXPECT_FALSE(outcome.faulted);
  EXPECT_GE(outcome.summary.ticks, 100U);
  ASSERT_EQ(outcome.failures.size(), 1U);
  EXPECT_EQ(outcome.failures.front(), "sink 1 threw: no more paper");
}

/// Runs 200 ticks on the simulated clock, is sent a signal in the 50th, and says whether it ended.
bool isStoppedBy(int signal) {
  Story story;
  const auto rig = watched(story);
  EXPECT_TRUE(rig->renderer->arm());
  RunPlan plan;
  plan.duration_ticks = 200;
  plan.simulated_clock = true;
  plan.sink = [&](const TickRecord& r) {
    if (r.tick == 50) {
      EXPECT_EQ(::raise(signal), 0);
    }
  };
  const RunOutcome outcome = orThrow(runAndRecord(*rig, plan));
  EXPECT_EQ(outcome.interrupted, outcome.summary.ticks < 200);
  return outcome.interrupted;
}

class Signals : public testing::TestWithParam<int> {};

TEST_P(Signals, WhileItRuns_StopItUnlessInheritedAsIgnored) {
  const auto before = std::signal(GetParam(), SIG_IGN);  // nohup and its like
  EXPECT_FALSE(isStoppedBy(GetParam()));
  std::signal(GetParam(), SIG_DFL);
  EXPECT_TRUE(isStoppedBy(GetParam()));
  EXPECT_EQ(std::signal(GetParam(), before), SIG_DFL);  // given back
}
INSTANTIATE_TEST_SUITE_P(AllFour, Signals, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGTSTP),
                         [](const auto& tested) {
                           return std::string("SIG") + ::sigabbrev_np(tested.param);
                         });

TEST(FaultText, WhatStopsNothing_IsToldApartFromFaults) {
  TickSummary summary;
  summary.faults[6] = 1;  // the bits of core/fault.hpp
  summary.faults[7] = 2;
  summary.faults[10] = 1;  // a request to stop is neither
  EXPECT_EQ(faultText(summary), "none");
  EXPECT_EQ(noticeText(summary), "effort limited in 1 tick, late tick in 2 ticks");
  summary.faults[0] = 3;
  EXPECT_EQ(faultText(summary), "device read failed in 3 ticks");
}

}  // namespace
}  // namespace wholehand::test
