// What a host says about its drive, by a simulated clock: a drive that lets go is shown, and comes
// back only when a loop arms.
#include "devices/host/device_host.hpp"
#include "devices/host/host_segment.hpp"
#include "devices/plain_driver.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

constexpr std::int64_t kCycle_ns = 250'000;
constexpr std::int64_t kShownWithin_ns = 50'000'000;

std::int64_t simulated_ns = 0;

/// A drive of three axes with a stop button and a watchdog.
class StoppableDrive final : public PlainDriver {
 public:
  StoppableDrive() : PlainDriver({"x", "y", "z"}, plainAxis()) {}
  [[nodiscard]] bool enablesAtNeutral() const noexcept override { return true; }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double) override {
    if (verb == WH_DISABLE) ++disabled_times;
    on = false;
    if (verb == WH_DISABLE) silenced = false;
    return Done{};
  }
  [[nodiscard]] Expected<Done> enable(const wh_command&) override {
    ++enabled_times;
    if (button) return fileFault(where(), "its stop button is pressed", "release it");
    on = true;
    if (clears_at_enable) silenced = false;
    return Done{};
  }
  [[nodiscard]] int read(wh_sample& sample) noexcept override {
    if (unplugged) return WH_FAILED;
    if (button) on = false;
    if (!still) ++samples_;
    sample.sequence = samples_;
    sample.monotonic_ns = simulated_ns;  // also where nothing is new
    sample.status = WH_HOMED;
    if (on) sample.status |= WH_ENABLED;
    if (silenced) sample.status |= WH_SILENCED;
    if (fault) sample.status |= WH_DRIVE_FAULT;
    sample.valid = 7;
    return still ? WH_NOTHING_NEW : WH_OK;
  }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    if (!on || silenced || refuses) return WH_FAILED;
    held_x = command.effort[0];
    return WH_OK;
  }

  bool on = false, button = false, silenced = false, fault = false, unplugged = false;
  bool still = false, refuses = false;
  bool clears_at_enable = true;  ///< false: its watchdog needs WH_DISABLE
  int enabled_times = 0, disabled_times = 0;
  double held_x = 0.0;

 private:
  std::uint64_t samples_ = 0;
};

/// Where the drive lets go.
enum class Where { kHeld, kWaiting, kRendering };

/// A host of a device whose x weighs 0.5 N, and a loop.
class HostBench {
 public:
  HostBench() {
    simulated_ns = 1'000'000'000;
    config_.neutral = AxisEffort(3);
    config_.neutral[0] = 0.5;
    config_.limit = AxisEffort(3, 8.0);
    config_.most_change = AxisEffort(3, 8.0);
    config_.period_s = static_cast<double>(kCycle_ns) * 1e-9;
    host_ = std::make_unique<DeviceHost>(drive, *frame_, config_,
                                         []() noexcept { return simulated_ns; });
  }
  void cycle() {
    if (commands_) sendCommand();
    (void)host_->cycle(1);
    HostEvent event;
    while (host_->nextEvent(event)) events.push_back(event);
    simulated_ns += kCycle_ns;
  }
  void cycles(int count) {
    for (int i = 0; i < count; ++i) cycle();
  }
  HostAnswer ask(std::uint32_t verb) {
    if (verb == WH_DISABLE) commands_ = false;
    frame_->request.publish({++requests_, 1, verb, 0.0});
    HostAnswer answer{};
    for (int i = 0; i < 1000 && answer.number != requests_; ++i) {
      cycle();
      (void)frame_->answer.take(answer);
    }
    EXPECT_EQ(answer.number, requests_) << "no answer";
    if (verb == WH_ENABLE && answer.ok == 1) session_ = answer.session;
    return answer;
  }
  void sendCommand() {
    HostCommand command{};
    command.session = session_;
    command.sequence = ++sequence_;
    command.monotonic_ns = simulated_ns;
    command.axes = 3;
    command.effort[0] = 0.5;
    frame_->command.publish(command);
    commands_ = true;
  }
  void stopCommands() { commands_ = false; }
  /// Sends a message of no session, with an effort that nobody may get.
  void probe(double effort) {
    HostCommand probe{};
    probe.session = kNoSession;
    probe.sequence = ++probes_;
    probe.monotonic_ns = simulated_ns;
    probe.axes = 3;
    probe.effort[0] = effort;
    frame_->command.publish(probe);
  }
  void bringTo(Where where) {
    EXPECT_EQ(ask(WH_ENABLE).ok, 1);
    if (where == Where::kWaiting) return;
    sendCommand();
    cycles(40);
    if (where == Where::kRendering) return;
    EXPECT_EQ(ask(WH_DISABLE).ok, 1);
  }
  HostSample sample() {
    HostSample sample{};
    EXPECT_TRUE(frame_->sample.take(sample));
    return sample;
  }
  /// The state that `wholehand device list` shows.
  std::string shown() {
    const HostSample now = sample();
    HostFacts facts;
    facts.lives = true;
    facts.sample_age_s = 0.0;
    facts.phase = now.phase;
    facts.drive = now.drive;
    facts.held = now.held != 0;
    return stateOf(facts);
  }

  StoppableDrive drive;
  std::vector<HostEvent> events;

 private:
  std::unique_ptr<SharedFrame> frame_ = std::make_unique<SharedFrame>();
  GuardConfig config_;
  std::unique_ptr<DeviceHost> host_;
  std::uint64_t requests_ = 0, session_ = 0, sequence_ = 0, probes_ = 0;
  bool commands_ = false;
};

struct Ending {
  const char* name;
  bool StoppableDrive::*defect;
  DriveState state;
  std::int64_t heard_ns;  ///< largest age of what it said last
};

class DriveThatLetsGo : public testing::TestWithParam<Ending> {};

TEST_P(DriveThatLetsGo, AtAnyTime_IsShownWithItsAgeWithin50msAndNeverEnabledByTheHost) {
  const Ending& ending = GetParam();
  auto random = seededRandom(5873);
  std::int64_t most_ns = 0;
  for (const Where where : {Where::kHeld, Where::kWaiting, Where::kRendering}) {
    for (int run = 0; run < 20; ++run) {
      HostBench bench;
      bench.bringTo(where);
      bench.cycles(1 + static_cast<int>(random() % 400));  // the next sample shows the enabling
      ASSERT_EQ(bench.sample().drive, DriveState::kOn);
      const int enabled = bench.drive.enabled_times;
      bench.events.clear();
      bench.drive.*ending.defect = true;
      const std::int64_t off_ns = simulated_ns;
      while (bench.sample().drive == DriveState::kOn &&
             simulated_ns < off_ns + 2 * kShownWithin_ns) {
        bench.cycle();
      }
      const HostSample now = bench.sample();
      most_ns = std::max(most_ns, simulated_ns - off_ns);
      ASSERT_EQ(now.drive, ending.state);
      ASSERT_LE(simulated_ns - off_ns, kShownWithin_ns);
      ASSERT_LE(now.monotonic_ns - now.drive_heard_ns, ending.heard_ns);
      ASSERT_EQ(now.monotonic_ns, now.drive_since_ns);
      ASSERT_EQ(bench.shown(), std::string("its drive ") + describe(ending.state));
      while (simulated_ns < off_ns + kShownWithin_ns) bench.cycle();
      const auto told =
          std::count_if(bench.events.begin(), bench.events.end(),
                        [&](const HostEvent& e) { return e.of_drive && e.drive == ending.state; });
      ASSERT_EQ(told, 1) << "people are told once";
      // Whatever the drive does next, only a loop's request enables it.
      for (int k = 0; k < 20; ++k) {
        bench.drive.*ending.defect = random() % 2 == 0;
        bench.cycles(100);
      }
      ASSERT_EQ(bench.drive.enabled_times, enabled);
    }
  }
  figure(std::string("drive behind a host, ") + ending.name + ", shown at most after",
         static_cast<double>(most_ns) * 1e-6, "ms");
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, DriveThatLetsGo,
    testing::Values(
        Ending{"button", &StoppableDrive::button, DriveState::kOff, 0},
        Ending{"watchdog", &StoppableDrive::silenced, DriveState::kSilenced, 0},
        Ending{"fault", &StoppableDrive::fault, DriveState::kFault, 0},
        Ending{"refuses", &StoppableDrive::refuses, DriveState::kRefuses, 0},
        Ending{"unplugged", &StoppableDrive::unplugged, DriveState::kUnreadable, kCycle_ns},
        Ending{"still", &StoppableDrive::still, DriveState::kStill, 20'000'000 + kCycle_ns}),
    [](const auto& tested) { return std::string(tested.param.name); });

// The loop's arming is the person's order. The watchdogs of some drives need WH_DISABLE before.
TEST(HeldDrive, DriveThatLetGo_IsEnabledAgainWhenALoopArms) {
  for (bool StoppableDrive::*defect : {&StoppableDrive::button, &StoppableDrive::silenced}) {
    for (const bool clears : {true, false}) {
      HostBench bench;
      bench.drive.clears_at_enable = clears;
      bench.bringTo(Where::kHeld);
      bench.drive.*defect = true;
      bench.cycles(100);
      if (defect == &StoppableDrive::button) bench.drive.button = false;
      bench.cycles(100);
      ASSERT_NE(bench.sample().drive, DriveState::kOn);
      EXPECT_EQ(bench.ask(WH_ENABLE).ok, 1);
      bench.cycles(2);
      EXPECT_EQ(bench.sample().drive, DriveState::kOn);
      EXPECT_EQ(bench.shown(), "enabled, at neutral");
      EXPECT_EQ(bench.drive.held_x, 0.5) << "it carries its weight";
    }
  }
}

TEST(HeldDrive, DriveWhoseButtonIsStillPressed_RefusesTheLoopAndIsShownUntilItIsEnabled) {
  HostBench bench;
  bench.bringTo(Where::kHeld);
  bench.drive.button = true;
  bench.cycles(100);
  for (int attempt = 0; attempt < 3; ++attempt) {
    const HostAnswer answer = bench.ask(WH_ENABLE);
    EXPECT_EQ(answer.ok, 0);
    EXPECT_NE(std::string(answer.text).find("stop button"), std::string::npos) << answer.text;
    (void)bench.ask(WH_DISABLE);  // as a loop does after a refusal
    bench.cycles(2);
    EXPECT_EQ(bench.shown(), std::string("its drive ") + describe(DriveState::kOff));
  }
  bench.drive.button = false;
  EXPECT_EQ(bench.ask(WH_ENABLE).ok, 1);
  bench.cycles(2);
  EXPECT_EQ(bench.sample().drive, DriveState::kOn);
}

// The echo from which the loop measures the way of its commands (devices/plugin/transport.hpp).
TEST(HostEcho, CommandsAndProbesInEveryPhase_ComeBackWithTheirTimesAndProbesMoveNothing) {
  for (const Where where : {Where::kHeld, Where::kWaiting, Where::kRendering}) {
    HostBench bench;
    bench.probe(7.0);
    const std::int64_t sent_ns = simulated_ns;
    simulated_ns += kCycle_ns / 3;
    bench.cycle();
    HostSample now = bench.sample();
    EXPECT_EQ(now.command, 1U);
    EXPECT_EQ(now.command_sent_ns, sent_ns);
    EXPECT_EQ(now.command_arrived_ns, sent_ns + kCycle_ns / 3);
    bench.cycles(5);
    EXPECT_EQ(bench.sample().command_arrived_ns, now.command_arrived_ns) << "it arrived once";
    bench.bringTo(where);
    bench.cycle();
    const double held = bench.drive.held_x;
    const HostPhase phase = bench.sample().phase;
    bench.stopCommands();
    for (int i = 0; i < 20; ++i) {
      bench.probe(7.0);
      bench.cycle();
      now = bench.sample();
      EXPECT_EQ(now.command, static_cast<std::uint64_t>(2 + i));
      EXPECT_EQ(now.command_arrived_ns - now.command_sent_ns, 0);
    }
    EXPECT_EQ(bench.drive.held_x, held);
    EXPECT_EQ(now.phase, phase);
  }
}

TEST(HeldDrive, DriveThatIsOn_IsNeitherDisabledNorEnabledAnewByTheNextLoop) {
  HostBench bench;
  bench.cycles(1000);  // off before it is enabled, which nobody needs to be told
  for (int session = 0; session < 5; ++session) {
    bench.bringTo(Where::kHeld);
    EXPECT_EQ(bench.shown(), "enabled, at neutral, between two sessions");
    bench.cycles(1000);
  }
  EXPECT_EQ(bench.drive.enabled_times, 1);
  EXPECT_EQ(bench.drive.disabled_times, 0) << "an arm that it carries would fall";
  EXPECT_TRUE(std::none_of(bench.events.begin(), bench.events.end(),
                           [](const HostEvent& e) { return e.of_drive; }));
}

}  // namespace
}  // namespace wholehand::test
