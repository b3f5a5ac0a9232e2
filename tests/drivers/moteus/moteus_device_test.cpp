// The driver on a simulated clock, with fake drives.
#include "moteus/moteus_device.hpp"

#include "fake_drive.hpp"
#include "hand_settings.hpp"
#include "support/contains.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace wholehand::moteus {
namespace {

constexpr double kTurn_rad = 2.0 * std::numbers::pi;

class MoteusDrives : public testing::Test {
 protected:
  MoteusDrives() {
    for (int id = 1; id <= 3; ++id) bus.drives.emplace_back(id);
    device = std::make_unique<MoteusDevice>(
        test::handSettings(), std::make_unique<test::FakeBus>(bus, time),
        std::make_unique<test::SimulatedClock>(time),
        [this](const std::string& line) { said += line + "\n"; });
  }
  void enable() {
    const auto checked = device->check();
    ASSERT_TRUE(checked) << format(checked.errors());
    ASSERT_EQ(device->control(WH_ENABLE), WH_OK) << said;
  }
  // One period of the loop: read, write, 1 ms.
  int tick(const std::array<double, 3>& effort_nm) {
    const int read = device->read(sample);
    wrote = write(effort_nm);
    pass(1'000'000);
    return read;
  }
  int write(const std::array<double, 3>& effort_nm) {
    wh_command command{};
    command.size = sizeof command;
    command.axes = 3;
    std::copy(effort_nm.begin(), effort_nm.end(), command.effort);
    return device->write(command);
  }
  void pass(std::int64_t ns) {
    for (const std::int64_t until_ns = time.now_ns + ns; time.now_ns < until_ns;) {
      time.now_ns += 50'000;
      bus.deliver(time.now_ns);
    }
  }
  std::uint32_t statusAfter(int ticks) {
    for (int i = 0; i < ticks; ++i) (void)tick({});
    return sample.status;
  }

  test::SimulatedTime time;
  test::FakeBusState bus;
  std::unique_ptr<MoteusDevice> device;
  std::string said;
  wh_sample sample{};
  int wrote = 0;
};

// A passport is valid for these drives in this order; another drive changes the serial number.
TEST_F(MoteusDrives, Identity_CoversAllDrives) {
  const auto serialOf = [this] {
    wh_identity identity{};
    identity.size = sizeof identity;
    device->identify(identity);
    EXPECT_STREQ(identity.firmware, identity.serial[0] == 0 ? "" : "100");
    return std::string(identity.serial);
  };
  const std::string first = serialOf();
  EXPECT_EQ(first.rfind("3 drives ", 0), 0U) << first;
  EXPECT_EQ(first.size(), std::string("3 drives ").size() + 16);
  EXPECT_EQ(serialOf(), first);
  bus.drives[1].serial_word = 99;
  EXPECT_NE(serialOf(), first);
  bus.drives[1].firmware = 0x0101;  // a drive that was updated no longer matches the measurement
  wh_identity identity{};
  identity.size = sizeof identity;
  device->identify(identity);
  EXPECT_STREQ(identity.firmware, "100+101+100");
  bus.drives[1].firmware = 0x0100;
  bus.drives[1].answers = false;
  EXPECT_EQ(serialOf(), "");
}

TEST_F(MoteusDrives, Axes_AreThoseOfTheSettings) {
  std::array<wh_axis, WH_MAX_AXES> axes{};
  std::uint32_t count = 0;
  device->describe(axes.data(), WH_MAX_AXES, count);
  ASSERT_EQ(count, 3U);
  EXPECT_STREQ(axes[1].name, "thumb_circumduction");
  EXPECT_EQ(axes[1].kind, WH_ROTATION);
  EXPECT_NEAR(axes[1].resolution, 5e-5 / 1.5, 1e-12);
  EXPECT_EQ(axes[2].effort_limit, 0.8);
  EXPECT_EQ(axes[2].silence_s, 0.02);
}

TEST_F(MoteusDrives, UnsafeSetting_IsRefusedAndSaysHowToSetIt) {
  struct Unsafe {
    const char* setting;
    const char* value;
    const char* expected;
  };
  auto& conf = bus.drives[1].conf;
  const auto safe = conf;
  for (const Unsafe& unsafe : {Unsafe{"servo.default_timeout_s", "nan", "conf set"},
                               {"servo.default_timeout_s", "1.000000", "at most 0.1 s"},
                               {"servo.default_timeout_s", "-1", "at most 0.1 s"},
                               {"servo.timeout_mode", "10", "holds or brakes"},
                               {"servo.timeout_mode", "15", "holds or brakes"},
                               {"servo.timeout_max_torque_Nm", "5.000000", "above max_torque_nm"},
                               {"servo.timeout_max_torque_Nm", "nan", "above max_torque_nm"},
                               {"servo.fixed_voltage_mode", "1", "ignores torques"},
                               {"servo.inertia_feedforward", "0.010000", "adds to the torque"},
                               {"servo.timeout_mode", "ERR error reading", "is no number"}}) {
    conf = safe;
    conf[unsafe.setting] = unsafe.value;
    const auto checked = device->check();
    ASSERT_FALSE(checked) << unsafe.setting << " = " << unsafe.value;
    EXPECT_EQ(checked.errors().size(), 1U) << format(checked.errors());
    for (const char* part : {"drive 2 (thumb base)", unsafe.setting, unsafe.expected}) {
      EXPECT_TRUE(test::contains(format(checked.errors()), part));
    }
  }
}

// An adapter loses frames just after it was plugged in, and occasionally one later.
TEST_F(MoteusDrives, LostFrame_IsRepeatedAndNotRefused) {
  const auto refusedWhereLost = [this](int from, int frames) {
    bus.loses_from = bus.frames + from;
    bus.loses = frames;
    const auto checked = device->check();
    return checked ? "" : format(checked.errors());
  };
  EXPECT_EQ(refusedWhereLost(0, 4 * 3), "") << "four rounds of five, of three drives";
  const int before = bus.frames;
  EXPECT_EQ(refusedWhereLost(0, 0), "");
  const int all = bus.frames - before;
  ASSERT_GT(all, 3 * 5) << "five settings of each drive, at least";
  for (int lost = 0; lost < all; ++lost) EXPECT_EQ(refusedWhereLost(lost, 1), "") << lost;
  EXPECT_NE(refusedWhereLost(0, 1'000'000), "");
}

TEST_F(MoteusDrives, SilentDrive_IsRefusedByNameAndTheOthersAreStillChecked) {
  bus.drives[2].answers = false;
  bus.drives[0].conf["servo.timeout_mode"] = "10";
  const auto checked = device->check();
  ASSERT_FALSE(checked);
  const std::string why = format(checked.errors());
  EXPECT_TRUE(test::contains(why, "drive 3 (thumb tip): does not answer"));
  EXPECT_TRUE(test::contains(why, "drive 1 (fingers) servo.timeout_mode"));
}

TEST_F(MoteusDrives, EnabledDrives_HaveNoTorqueUntilTheFirstCommand) {
  enable();
  pass(1'000'000'000);  // the time until the loop starts
  ASSERT_GE(device->read(sample), 0);
  pass(1'000'000);
  ASSERT_EQ(device->read(sample), WH_OK);
  EXPECT_EQ(sample.status, WH_ENABLED | WH_HOMED);
  for (const auto& drive : bus.drives) EXPECT_EQ(drive.torque_nm(), 0.0);
}

TEST_F(MoteusDrives, UnhomedDrive_IsReportedByNameAndNotEnabled) {
  bus.drives[1].home = 1;
  EXPECT_EQ(device->control(WH_ENABLE), WH_FAILED);
  EXPECT_EQ(device->control(WH_ENABLE), WH_FAILED);
  EXPECT_TRUE(test::contains(said, "drive 2 (thumb base) is not homed"));
  EXPECT_EQ(write({}), WH_FAILED);
  for (const auto& drive : bus.drives) EXPECT_EQ(drive.mode, 0);
}

// Computed by hand from the settings: fingers 1; base -(tau_c + 0.4 tau_f) / 1.5; tip 1.
TEST_F(MoteusDrives, Efforts_AreTheOnlyTorqueOfTheMotors) {
  enable();
  for (int i = 0; i < 5; ++i) (void)tick({0.5, -0.3, 0.2});
  EXPECT_NEAR(bus.drives[0].torque_nm(), 0.5, 1e-7);
  EXPECT_NEAR(bus.drives[1].torque_nm(), -(-0.3 + 0.4 * 0.2) / 1.5, 1e-7);
  EXPECT_NEAR(bus.drives[2].torque_nm(), 0.2, 1e-7);
  EXPECT_NEAR(sample.effort[0], 0.5, 1e-6);
  EXPECT_NEAR(sample.effort[1], -0.3, 1e-6);
  EXPECT_NEAR(sample.effort[2], 0.2, 1e-6);
}

// Computed by hand: (m + 1.5) / 1; -(m - 1) / 1.5; (m - 0.2) + 0.4 q_1.
TEST_F(MoteusDrives, Positions_AreConvertedToTheAxes) {
  bus.drives[0].position_rev = -0.1;
  bus.drives[1].position_rev = 0.05;
  bus.drives[2].position_rev = 0.125;
  enable();
  (void)tick({});
  ASSERT_EQ(tick({}), WH_OK);
  const double base = -(0.05 * kTurn_rad - 1.0) / 1.5;
  EXPECT_NEAR(sample.position[0], -0.1 * kTurn_rad + 1.5, 1e-6);
  EXPECT_NEAR(sample.position[1], base, 1e-6);
  EXPECT_NEAR(sample.position[2], 0.125 * kTurn_rad - 0.2 + 0.4 * base, 1e-6);
  EXPECT_EQ(sample.valid, 7U);
  EXPECT_EQ(sample.temperature_c[0], 25.0);
}

TEST_F(MoteusDrives, UnknownPositionOfADrive_IsNotValid) {
  enable();
  bus.drives[1].position_rev = std::nan("");
  for (int i = 0; i < 3; ++i) (void)tick({});
  EXPECT_EQ(sample.valid, 1U) << "nor is that of the axis which it shifts";
}

TEST_F(MoteusDrives, StoppedLoop_IsReleasedByTheDrivesUntilEnabledAgain) {
  enable();
  for (int i = 0; i < 5; ++i) (void)tick({0.5, 0.0, 0.0});
  ASSERT_GT(bus.drives[0].torque_nm(), 0.4);
  pass(18'000'000);
  EXPECT_GT(bus.drives[0].torque_nm(), 0.4) << "20 ms after the last command, not earlier";
  pass(3'000'000);
  EXPECT_EQ(bus.drives[0].torque_nm(), 0.0);
  EXPECT_NE(statusAfter(4) & WH_SILENCED, 0U);
  EXPECT_EQ(sample.status & WH_ENABLED, 0U);
  for (int i = 0; i < 50; ++i) (void)tick({0.5, 0.0, 0.0});
  EXPECT_EQ(bus.drives[0].torque_nm(), 0.0) << "commands do not wake it";
  ASSERT_EQ(device->control(WH_ENABLE), WH_OK);
  EXPECT_TRUE(test::contains(said, "has let go"));
  EXPECT_EQ(statusAfter(3), WH_ENABLED | WH_HOMED);
}

TEST_F(MoteusDrives, DroppedWatchdog_LetsGoWhileTheLoopWrites) {
  enable();
  for (int i = 0; i < 5; ++i) (void)tick({0.5, 0.0, 0.0});
  ASSERT_EQ(device->control(WH_DROP_WATCHDOG), WH_OK);
  for (int i = 0; i < 25; ++i) {
    (void)tick({0.5, 0.0, 0.0});
    EXPECT_EQ(wrote, WH_OK);
  }
  EXPECT_NE(sample.status & WH_SILENCED, 0U);
  EXPECT_EQ(bus.drives[0].torque_nm(), 0.0);
}

TEST_F(MoteusDrives, DriveFault_IsReportedWithItsCodeAndItsReason) {
  enable();
  (void)statusAfter(3);
  bus.drives[2].mode = 1;
  bus.drives[2].fault = 38;
  const std::uint32_t status = statusAfter(2);
  EXPECT_NE(status & WH_DRIVE_FAULT, 0U);
  EXPECT_EQ(status & WH_ENABLED, 0U);
  EXPECT_EQ(sample.vendor_code, 38);
  EXPECT_EQ(wrote, WH_OK) << "the others are ramped";
  EXPECT_EQ(said, "") << "the tick says nothing";
  ASSERT_EQ(device->control(WH_DISABLE), WH_OK);
  EXPECT_TRUE(
      test::contains(said, "drive 3 (thumb tip) has stopped itself: fault 38, over temperature"));
}

TEST_F(MoteusDrives, LimitsOfADrive_AreNoFault) {
  enable();
  bus.drives[0].fault = 99;
  EXPECT_EQ(statusAfter(3), WH_ENABLED | WH_HOMED | WH_SATURATED);
  EXPECT_EQ(sample.vendor_code, 99);
  bus.drives[0].fault = 100;
  EXPECT_EQ(statusAfter(3), WH_ENABLED | WH_HOMED | WH_DERATING);
}

TEST_F(MoteusDrives, RestartedDrive_IsNeitherHomedNorEnabled) {
  enable();
  (void)statusAfter(3);
  bus.drives[1].restart();
  EXPECT_EQ(statusAfter(2) & (WH_ENABLED | WH_HOMED), 0U);
}

TEST_F(MoteusDrives, AnswerOfAnotherDrive_IsIgnoredAndCounted) {
  enable();
  (void)statusAfter(3);
  const double before = sample.position[0];
  bus.inject(0x0700, {0x2c, 0x01, 0x01, 0x00, 0x00, 0x80, 0x3f}, time.now_ns);
  bus.inject(0x8001, {0x50}, time.now_ns);
  bus.inject(0x0100, {0x2c, 0x01, 0x01, 0x00}, time.now_ns);  // from our drive, truncated
  EXPECT_EQ(statusAfter(3), WH_ENABLED | WH_HOMED);
  EXPECT_EQ(sample.position[0], before);
  EXPECT_EQ(device->round().foreign(), 2U);
  EXPECT_EQ(device->round().malformed(), 1U);
}

TEST_F(MoteusDrives, SilentDrive_FreezesTheSamples) {
  enable();
  (void)statusAfter(3);
  bus.drives[0].answers = false;
  (void)statusAfter(2);
  const std::uint64_t sequence = sample.sequence;
  for (int i = 0; i < 30; ++i) EXPECT_EQ(tick({}), WH_NOTHING_NEW);
  EXPECT_EQ(sample.sequence, sequence);  // PluginDevice reports it as a stale sample
  bus.drives[0].answers = true;
  (void)statusAfter(5);
  EXPECT_GT(sample.sequence, sequence);
}

// The position encodes its time of measurement; a late answer must not look new.
TEST_F(MoteusDrives, SampleTimeOnADelayingBus_IsNeverAfterTheMeasurement) {
  constexpr std::int64_t kHealthy_ns = 800'000;
  for (const std::int64_t late_ns : {2'500'000, 3'500'000, 5'000'000, 12'000'000, 20'000'000}) {
    SCOPED_TRACE(late_ns);
    bus.latency_ns = kHealthy_ns;
    enable();
    const std::int64_t begun_ns = time.now_ns;
    for (int i = 0; i < 300; ++i) {
      const int delays = i % 100;  // delays a single round, then many
      bus.latency_ns = delays == 10 || (delays > 40 && delays < 80) ? late_ns : kHealthy_ns;
      (void)device->read(sample);
      (void)write({});
      const double measured_s = (sample.position[0] - 1.5) / kTurn_rad;
      if (i > 2) {
        ASSERT_LE(static_cast<double>(sample.monotonic_ns - begun_ns), measured_s * 1e9 + 1e3) << i;
      }
      for (int k = 0; k < 20; ++k) {
        bus.drives[0].position_rev = static_cast<double>(time.now_ns - begun_ns) * 1e-9;
        pass(50'000);
      }
    }
  }
}

TEST_F(MoteusDrives, LateAnswersOfTheBus_GiveNoSampleThatLooksNew) {
  enable();
  (void)statusAfter(3);
  bus.latency_ns = 12'000'000;
  (void)statusAfter(8);
  for (int i = 0; i < 100; ++i) {
    (void)device->read(sample);
    ASSERT_GE(time.now_ns - sample.monotonic_ns, 6'000'000) << i;
    (void)tick({});
  }
  EXPECT_EQ(device->control(WH_ENABLE), WH_FAILED);
  EXPECT_TRUE(test::contains(said, "later than 3 ms"));
  bus.latency_ns = 800'000;
  pass(20'000'000);
  EXPECT_EQ(device->control(WH_ENABLE), WH_OK);
}

// The answer to a later request is not taken for the lost one.
TEST_F(MoteusDrives, LostAnswer_DoesNotAgeLaterSamples) {
  bus.latency_ns = 800'000;
  enable();
  (void)statusAfter(3);
  const auto age_ns = [this] {
    (void)device->read(sample);
    return time.now_ns - sample.monotonic_ns;
  };
  ASSERT_EQ(age_ns(), 1'000'000);
  (void)device->read(sample);
  (void)write({});
  pass(500'000);
  ASSERT_EQ(bus.answers.size(), 3U);
  bus.answers.pop_front();
  pass(500'000);
  EXPECT_EQ(age_ns(), 2'000'000) << "one answer is missing";
  (void)statusAfter(5);
  for (int i = 0; i < 50; ++i) {
    (void)tick({});
    ASSERT_EQ(age_ns(), 1'000'000) << i;
  }
}

TEST_F(MoteusDrives, HostAtFourKilohertz_QueriesTheBusOncePerRoundTrip) {
  bus.latency_ns = 800'000;
  enable();
  const int before = bus.frames;
  for (int i = 0; i < 4000; ++i) {
    (void)device->read(sample);
    ASSERT_EQ(write({0.1, 0.0, 0.0}), WH_OK);
    pass(250'000);
  }
  EXPECT_LE(bus.frames - before, 3 * 1250) << "a round takes 0.8 ms";
  EXPECT_GE(bus.frames - before, 3 * 900);
  EXPECT_EQ(sample.status, WH_ENABLED | WH_HOMED);
  EXPECT_NEAR(bus.drives[0].torque_nm(), 0.1, 1e-7);
}

TEST_F(MoteusDrives, ImpossibleCommands_AreRefusedOrClamped) {
  enable();
  EXPECT_EQ(write({std::nan(""), 0.0, 0.0}), WH_FAILED);
  wh_command short_command{};
  short_command.axes = 2;
  EXPECT_EQ(device->write(short_command), WH_FAILED);
  short_command.axes = 4;
  EXPECT_EQ(device->write(short_command), WH_FAILED) << "nobody knows which axis is which";
  for (int i = 0; i < 3; ++i) (void)tick({100.0, 0.0, 0.0});
  EXPECT_NEAR(bus.drives[0].torque_nm(), 0.8, 1e-6);
}

TEST_F(MoteusDrives, DisabledDrives_HaveNoTorqueAndRefuseCommands) {
  enable();
  for (int i = 0; i < 3; ++i) (void)tick({0.5, 0.0, 0.0});
  ASSERT_EQ(device->control(WH_DISABLE), WH_OK);
  EXPECT_EQ(bus.drives[0].mode, 0);
  EXPECT_EQ(write({}), WH_FAILED);
  EXPECT_EQ(device->control(WH_HOME), WH_UNSUPPORTED);
}

TEST_F(MoteusDrives, ClosedDrives_AreStopped) {
  enable();
  for (int i = 0; i < 3; ++i) (void)tick({0.5, 0.0, 0.0});
  device.reset();
  for (const auto& drive : bus.drives) EXPECT_EQ(drive.mode, 0);
}

TEST_F(MoteusDrives, UnpluggedAdapter_FailsReadsAndWrites) {
  enable();
  (void)statusAfter(3);
  bus.unplugged = true;
  EXPECT_EQ(tick({}), WH_FAILED);
  EXPECT_EQ(wrote, WH_FAILED);
  bus.unplugged = false;
  EXPECT_EQ(tick({}), WH_FAILED) << "what was lost in between is not known";
}

}  // namespace
}  // namespace wholehand::moteus
