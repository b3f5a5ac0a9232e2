// The safety supervisor's events in the record stream, on the simulated clock.
#include "rig/safety_log.hpp"

#include "loop/patient/player.hpp"
#include "loop/runtime/session.hpp"
#include "loop/runtime/statistics.hpp"
#include "support/contains.hpp"
#include "support/rig_tools.hpp"

#include <gtest/gtest.h>

namespace wholehand::test {
namespace {

/// A rig whose hand follows the script by read number and otherwise rests.
std::unique_ptr<Rig> scripted(ScriptedDevice::Script script) {
  return buildScripted(load(shippedFiles()), std::move(script));
}

std::vector<SafetyTransition> play(Rig& rig, int ticks,
                                   const std::function<void(const TickRecord&)>& at = {}) {
  std::vector<std::string> reported;
  SafetyLog log(rig.models.device, rig.options.period_s,
                [&reported](const SafetyTransition& t) { reported.push_back(describe(t)); });
  orThrow(rig.renderer->arm());
  runTicks(*rig.renderer, ticks, [&](const TickRecord& record) {
    log.add(record);
    if (at) at(record);
  });
  const auto transitions = log.transitions();
  EXPECT_EQ(reported.size(), transitions.size());
  EXPECT_EQ(log.state(), rig.renderer->safetyState());
  return transitions;
}

TEST(SafetyLog, RunThatIsStopped_ReportsEveryStateOnceAndTheCause) {
  for (const bool emergency : {false, true}) {
    const auto rig = scripted([](int) { return AxisPosition(6); });
    const auto transitions = play(*rig, 600, [&](const TickRecord& record) {
      if (record.tick != 399) return;
      if (emergency) rig->renderer->requestEmergencyStop();
      rig->renderer->requestStop();
    });
    ASSERT_EQ(transitions.size(), 3U);
    EXPECT_EQ(transitions[0].to, SafetyState::kArmed);
    EXPECT_EQ(transitions[0].tick, 0U);
    EXPECT_EQ(transitions[1].to, SafetyState::kRendering);
    EXPECT_EQ(transitions[2].to, SafetyState::kDisarmed);
    EXPECT_LE(transitions[2].time_s, 0.4 + 0.1) << "neutral within 100 ms";
    EXPECT_EQ(any(transitions[2].faults & Fault::kEmergencyStop), emergency);
    EXPECT_TRUE(contains(transitions[2].cause,
                         emergency ? "emergency stop at 0.400 s" : "stop requested at 0.400 s"));
  }
}

// 2 mm in 1 ms are 2 m/s; the file allows 1.5 m/s.
TEST(SafetyLog, AxisTooFast_IsReportedWithSpeedAndLimit) {
  const auto rig = scripted([](int read) {
    AxisPosition q(6);
    q[1] = read < 500 ? 0.0 : 0.002 * (read - 499);
    return q;
  });
  const auto transitions = play(*rig, 520);
  ASSERT_EQ(transitions.size(), 3U);
  const SafetyTransition& fault = transitions.back();
  EXPECT_EQ(fault.from, SafetyState::kRendering);
  EXPECT_EQ(fault.to, SafetyState::kFaulted);
  // arm() reads once: tick 499 is the first that is too fast, and two in a row are a fault.
  EXPECT_EQ(fault.tick, 500U);
  EXPECT_EQ(fault.axis, 1);
  EXPECT_NEAR(fault.value, 2.0, 1e-9);
  EXPECT_EQ(fault.limit, 1.5);
  EXPECT_EQ(fault.unit, "m/s");
  EXPECT_TRUE(
      contains(describe(fault), "rendering -> faulted: speed limit exceeded on y, 2 m/s of 1.5"));
}

/// Rests, but for one reading that is `spike_m` away on y. Not declared as simulated, so its
/// encoders are watched.
class SpikingDevice final : public RestingDevice {
 public:
  explicit SpikingDevice(double spike_m) : spike_m_(spike_m) {}
  [[nodiscard]] Fault read(DeviceReading& reading, int) noexcept override {
    reading.q_m = AxisPosition(6);
    if (++reads_ == 1500) reading.q_m[1] = spike_m_;  // at full authority
    return Fault::kNone;
  }

 private:
  double spike_m_;
  int reads_ = 0;
};

// The push that answers a reading of 1.4 mm elsewhere must not be called a stuck encoder.
TEST(SafetyLog, SpikeOfOneReading_IsReportedAsAJumpWithoutASpeed) {
  for (const double spike_m : {1.4e-3, -1.4e-3}) {
    const auto rig = build(load(shippedFiles()), std::make_unique<SpikingDevice>(spike_m));
    const auto transitions = play(*rig, 4000);
    ASSERT_EQ(transitions.size(), 3U);
    const SafetyTransition& fault = transitions.back();
    EXPECT_EQ(fault.faults, Fault::kEncoderJump) << describe(fault);
    EXPECT_EQ(fault.axis, 1);
    EXPECT_TRUE(describe(fault).ends_with("encoder jumped on y")) << describe(fault);
  }
}

// The axis leaves the range slowly by more than the margin of 5 mm.
TEST(SafetyLog, WorkspaceLeft_IsReportedWithPositionAndEnd) {
  const auto rig = scripted([](int read) {
    AxisPosition q(6);
    q[0] = -0.0001 * read;  // 0.1 m/s
    return q;
  });
  const auto transitions = play(*rig, 950);
  const SafetyTransition& fault = transitions.back();
  ASSERT_EQ(fault.to, SafetyState::kFaulted);
  EXPECT_EQ(fault.axis, 0);
  EXPECT_NEAR(fault.limit, -0.085 - 0.005, 1e-12);
  EXPECT_NEAR(fault.value, fault.limit, 2e-4);
  EXPECT_EQ(fault.unit, "m");
}

// After a fault a person arms again: the next stream starts in the state in which the last one
// ended.
TEST(SafetyLog, ArmedAfterAFault_GoesFromFaultedToArmed) {
  const DeviceModel device = load(shippedFiles()).device;
  SafetyLog log(device, 1e-3);
  TickRecord record;
  record.q_m = AxisPosition(6);
  record.tick = 5;
  record.safety_state = SafetyState::kFaulted;
  record.faults = Fault::kDeviceRead;
  log.add(record);
  EXPECT_EQ(log.fault().faults, Fault::kDeviceRead);
  record.tick = 0;
  record.safety_state = SafetyState::kArmed;
  record.faults = Fault::kNone;
  log.add(record);
  ASSERT_EQ(log.transitions().size(), 1U);
  EXPECT_EQ(log.transitions()[0].from, SafetyState::kFaulted);
  EXPECT_EQ(log.transitions()[0].to, SafetyState::kArmed);
  EXPECT_EQ(log.fault().to, SafetyState::kDisarmed) << "of this session there is none";
}

// The control client goes silent while the virtual patient squeezes: the records report it from
// that tick on, and the exercise has let go within the time that its description states.
TEST(SafetyLog, HolderSilent_IsRecordedAndTheExerciseFadesInItsTime) {
  const Models models = load(exerciseFiles("cocktail-bar"));
  std::unique_ptr<Player> player = models.exercise->makePlayer({1});
  Player& hand = *player;
  const auto rig = orThrow(buildRig(models, std::move(player), {}));
  orThrow(rig->renderer->arm());
  ListeningPlayer listening(hand);
  SessionConfig config;
  config.listener = &listening;
  config.queue_bytes = 0;
  config.duration_ticks = 10'000;
  Session session(*rig->renderer, config);
  const double fade_s = models.exercise->description().fade_out_s;
  std::uint64_t silent = 0, faded = 0;
  session.runSimulated([&](const TickRecord& record) {
    if (silent == 0 && record.exercise.alpha == 1.0) {
      Command command;
      command.type = CommandType::kHolderAlive;
      command.value = 0.0;
      EXPECT_TRUE(session.tryCommand(command));
      EXPECT_FALSE(any(record.faults & Fault::kHolderSilent));
      silent = record.tick + 1;
      return;
    }
    if (silent == 0) return;
    EXPECT_TRUE(any(record.faults & Fault::kHolderSilent)) << record.tick;
    EXPECT_FALSE(any(record.faults & kStoppingFaults)) << "it fades, the loop runs on";
    if (faded == 0 && record.exercise.alpha == 0.0) {
      faded = record.tick;
      session.requestStop();
    }
  });
  ASSERT_GT(silent, 0U) << "the patient never squeezed";
  ASSERT_GT(faded, 0U);
  const double took_s = static_cast<double>(faded - silent + 1) * 1e-3;
  figure("owner_silent_fade", took_s, "s");
  EXPECT_LE(took_s, fade_s + 1e-3);
  EXPECT_GT(took_s, 0.5 * fade_s) << "a fade, not a step";
}

std::vector<DeviceAxis> axesNamed(const std::vector<std::string>& names) {
  std::vector<DeviceAxis> axes;
  for (const std::string& name : names) {
    axes.emplace_back();
    axes.back().name = name;
  }
  return axes;
}

TEST(FaultText, FaultOfAnAxis_NamesTheAxis) {
  const std::vector<DeviceAxis> axes = axesNamed({"x", "y", "finger_flexion"});
  TickSummary summary;
  summary.faults[6] = 12;  // the bits of loop/core/fault.hpp
  summary.faults[7] = 3;
  summary.fault_axes[6][0] = 9;
  summary.fault_axes[6][2] = 2;  // in one tick another fault was first
  summary.faults[12] = 1;
  summary.fault_axes[12][1] = 1;
  EXPECT_EQ(noticeText(summary, axes),
            "effort limited in 12 ticks (x 9, finger_flexion 2), late tick in 3 ticks");
  EXPECT_EQ(faultText(summary, axes), "speed limit exceeded in 1 tick (y)");
  EXPECT_EQ(faultText(summary), "speed limit exceeded in 1 tick") << "the axes have no names";
}

TEST(FaultText, EveryLimitThatClampedAnEffort_IsReportedAsANotice) {
  TickSummary summary;
  summary.faults[14] = 1;  // the bits of loop/core/fault.hpp
  summary.faults[15] = 2;
  summary.fault_axes[15][0] = 2;
  summary.faults[22] = 3;
  EXPECT_EQ(noticeText(summary, axesNamed({"x"})), std::string(faultName(14)) + " in 1 tick, " +
                                                       faultName(15) + " in 2 ticks (x), " +
                                                       faultName(22) + " in 3 ticks");
  EXPECT_EQ(faultText(summary), "none");
}

}  // namespace
}  // namespace wholehand::test
