#include "loop/device/simulated/simulated_device.hpp"

#include "devices/one_axis.hpp"
#include "loop/realtime/allocation_counter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace wholehand {
namespace {

using test::hold;
using test::nobody;
using test::oneAxisDevice;
using test::opened;
using test::personAt;
using test::personOf;
using test::stayAt;

constexpr double kPeriod_s = 1e-3;

TEST(SimulatedDevice, FirstRead_GivesTheStartWithoutElapsedTime) {
  const auto device = opened(oneAxisDevice(0.8), nobody(), stayAt(0.04));
  DeviceReading reading;
  ASSERT_EQ(device->write(AxisEffort(1, 5.0)), Fault::kNone);
  ASSERT_EQ(device->read(reading, 7), Fault::kNone);
  EXPECT_EQ(reading.q_m[0], 0.04);
  EXPECT_NEAR(personAt(*device).intention[0], 0.04,
              0.5 / 0x1p20);  // half a step of the reported resolution
  EXPECT_EQ(personAt(*device).effort[0], 0.0);
}

TEST(SimulatedDevice, ConstantEffort_MovesByHalfATSquared) {
  const auto device = opened(oneAxisDevice(0.5), nobody(), stayAt(0.0));
  hold(*device, 2.0, 1 + 250);
  EXPECT_NEAR(device->position()[0], 0.5 * (2.0 / 0.5) * 0.25 * 0.25, 1e-12);
  EXPECT_NEAR(device->velocity()[0], (2.0 / 0.5) * 0.25, 1e-12);
}

TEST(SimulatedDevice, OutputDelay_DelaysByExactlyThatManyTicks) {
  for (int delay = 0; delay <= 3; ++delay) {
    DeviceModel model = oneAxisDevice(1.0);
    model.output_delay_ticks = delay;
    const auto device = opened(model, nobody(), stayAt(0.0));
    DeviceReading reading;
    ASSERT_EQ(device->read(reading, 1), Fault::kNone);
    // One tick of 1 N, then none: one impulse of 1 mN·s, `delay` ticks late.
    ASSERT_EQ(device->write(AxisEffort(1, 1.0)), Fault::kNone);
    for (int tick = 1; tick <= 6; ++tick) {
      ASSERT_EQ(device->read(reading, 1), Fault::kNone);
      ASSERT_EQ(device->write(AxisEffort(1, 0.0)), Fault::kNone);
      EXPECT_DOUBLE_EQ(device->velocity()[0], tick > delay ? 1e-3 : 0.0)
          << "delay " << delay << ", tick " << tick;
    }
  }
}

TEST(SimulatedDevice, SkippedPeriods_EqualTheSameEffortHeld) {
  DeviceModel model = oneAxisDevice(0.8);
  model.output_delay_ticks = 2;
  model.axes[0].coulomb = 0.2;
  model.axes[0].damping = 6.0;
  const Intention way =
      Intention::throughWaypoints({{0.0, AxisPosition(1, 0.0)}, {0.05, AxisPosition(1, 0.03)}});
  PatientConfig patient = personOf({"x", 0.5, 6.0, 135.0});
  SimulatedDevice skipping(model, patient, way, kPeriod_s), steady(model, patient, way, kPeriod_s);
  ASSERT_TRUE(skipping.open().ok() && steady.open().ok());
  hold(skipping, 1.0, 5);
  hold(steady, 1.0, 5);
  DeviceReading skipped;
  ASSERT_EQ(skipping.write(AxisEffort(1, -3.0)), Fault::kNone);
  ASSERT_EQ(skipping.read(skipped, 4), Fault::kNone);
  const DeviceReading held = hold(steady, -3.0, 4);
  EXPECT_EQ(skipped.q_m[0], held.q_m[0]);  // bit for bit
  EXPECT_EQ(skipping.velocity()[0], steady.velocity()[0]);
  EXPECT_EQ(personAt(skipping).intention[0], personAt(steady).intention[0]);
  EXPECT_EQ(personAt(skipping).effort[0], personAt(steady).effort[0]);
}

TEST(SimulatedDevice, EffortBeyondTheLimit_Saturates) {
  DeviceModel model = oneAxisDevice(1.0);
  model.axes[0].effort_limit = 20.0;
  const auto device = opened(model, nobody(), stayAt(0.0));
  hold(*device, 1e6, 1 + 10);
  EXPECT_NEAR(device->velocity()[0], 20.0 * 0.01, 1e-12);
}

TEST(SimulatedDevice, Encoder_RoundsToItsStepOnly) {
  DeviceModel model = oneAxisDevice(1.0);
  model.axes[0].encoder_step = 1e-4;
  const auto device = opened(model, nobody(), stayAt(0.0));
  for (int i = 0; i < 200; ++i) {
    const DeviceReading reading = hold(*device, 0.7, 1);
    const double steps = reading.q_m[0] / 1e-4;
    ASSERT_NEAR(steps, std::round(steps), 1e-9);
    ASSERT_LE(std::abs(reading.q_m[0] - device->position()[0]), 0.5e-4 * (1 + 1e-9));
  }
  EXPECT_GT(device->position()[0], 0.01);
}

TEST(SimulatedDevice, OwnWeight_IsBalancedByNeutralAndFallsWithoutIt) {
  DeviceModel model = oneAxisDevice(0.8);
  model.axes[0].neutral_effort = 0.8 * 9.81;
  model.output_delay_ticks = 2;  // efforts in the delay line are neutral when the device opens
  const auto device = opened(model, nobody(), stayAt(0.0));
  DeviceReading reading;
  for (int i = 0; i < 500; ++i) ASSERT_EQ(device->read(reading, 1), Fault::kNone);
  EXPECT_EQ(device->position()[0], 0.0);  // open() holds neutral without a write
  hold(*device, 0.8 * 9.81, 500);
  EXPECT_EQ(device->position()[0], 0.0);
  hold(*device, 0.0, 2 + 100);
  EXPECT_NEAR(device->position()[0], -0.5 * 9.81 * 0.1 * 0.1, 1e-9);
}

/// The person follows a sinusoid: q/q_i = (k + jωB)/(k - ω²m + jω(b + B)).
TEST(SimulatedDevice, SinusoidalIntention_IsFollowedByTheTransferFunction) {
  constexpr double kHz = 2.0, kOmega = 2.0 * std::numbers::pi * kHz, kAmplitude = 0.03;
  DeviceModel model = oneAxisDevice(0.8);
  model.axes[0].damping = 6.0;
  PatientConfig patient = personOf({"x", 0.554, 6.45, 135.0});
  // A dense track of the sinusoid is needed: minimum jerk stops at each waypoint, a motion file
  // does not.
  MotionFile motion;
  motion.columns = {"x"};
  for (int i = 0; i <= 800; ++i) {
    motion.time_s.push_back(0.01 * i);
    motion.samples.push_back({kAmplitude * std::sin(kOmega * 0.01 * i)});
  }
  const MotionMapping as_it_is{
      .margin = 0.0, .speed_share = 1.0, .base_scale = 1.0, .center = false};
  const Intention intention =
      Intention::fromMotion(motion, as_it_is, model, AxisPosition(1), nullptr);
  const auto device = opened(model, patient, intention);
  // First harmonic of both signals over six whole periods, after four seconds to settle.
  std::complex<double> moved, wanted;
  DeviceReading reading;
  for (int i = 0; i < 7000; ++i) {
    ASSERT_EQ(device->read(reading, 1), Fault::kNone);
    if (i < 4000) continue;
    const std::complex<double> turn = std::polar(1.0, -kOmega * i * kPeriod_s);
    moved += device->position()[0] * turn;
    wanted += personAt(*device).intention[0] * turn;
  }
  const std::complex<double> j{0.0, 1.0};
  const std::complex<double> expected =
      (135.0 + j * kOmega * 6.45) /
      (135.0 - kOmega * kOmega * (0.8 + 0.554) + j * kOmega * (6.0 + 6.45));
  EXPECT_NEAR(std::abs(moved / wanted - expected), 0.0, 1e-4);
}

/// Largest speed in the last second of five of a rendered spring of stiffness K on a quantised
/// device, released off its rest position.
double lateSpeed(double stiffness, double coulomb, double encoder_step) {
  DeviceModel model = oneAxisDevice(0.8);
  model.axes[0].damping = 0.5;
  model.axes[0].coulomb = coulomb;
  model.axes[0].encoder_step = encoder_step;
  const auto device = opened(model, nobody(), stayAt(0.0042));
  DeviceReading reading;
  double fastest = 0.0;
  for (int i = 0; i < 5000; ++i) {
    EXPECT_EQ(device->read(reading, 1), Fault::kNone);
    EXPECT_EQ(device->write(AxisEffort(1, -stiffness * reading.q_m[0])), Fault::kNone);
    if (i >= 4000) fastest = std::max(fastest, std::abs(device->velocity()[0]));
  }
  return fastest;
}

TEST(SimulatedDevice, QuantisedSpringInsideAbbottOkamura_ComesToRest) {
  // Abbott and Okamura 2005: no limit cycle for K <= min(2b/T, 2 f_c/Δ) = min(1000, 1000) N/m here.
  EXPECT_EQ(lateSpeed(900.0, 0.2, 4e-4), 0.0);
  // Beyond the bound, and without the dry friction that holds the last encoder step, it keeps
  // moving.
  EXPECT_GT(lateSpeed(2000.0, 0.0, 4e-4), 1e-3);
}

/// Runs 1000 ticks after each of two openings.
void expectTheSameBitsTwice(SimulatedDevice& device, double amplitude) {
  std::vector<double> first, second;
  for (std::vector<double>* seen : {&first, &second}) {
    ASSERT_TRUE(device.open().ok());  // opening again restarts the device
    for (int i = 0; i < 1000; ++i) {
      const DeviceReading reading = hold(device, amplitude * std::sin(0.02 * i), 1);
      seen->push_back(reading.q_m[0]);
      seen->push_back(personAt(device).effort[0]);
    }
    device.close();
  }
  EXPECT_EQ(first, second);
}

TEST(SimulatedDevice, SameCallsTwice_GiveTheSameBits) {
  DeviceModel model = oneAxisDevice(0.8);
  model.axes[0].coulomb = 0.2;
  model.axes[0].encoder_step = 1e-5;
  model.output_delay_ticks = 1;
  const Intention way = Intention::throughWaypoints(
      {{0.0, AxisPosition(1, 0.0)}, {0.4, AxisPosition(1, 0.05)}, {0.9, AxisPosition(1, -0.05)}});
  expectTheSameBitsTwice(*opened(model, personOf({"x", 0.5, 8.0, 135.0}), way), 1.0);
  // The same with habits, which reserve all their memory when they begin.
  PatientConfig patient = personOf({"x", 0.5, 8.0, 135.0, 1.5, 4.0});
  patient.fight_reaction_s = 0.05;
  patient.letting_go.after_s = 0.7;
  const auto device = opened(model, patient, stayAt(0.02));
  expectTheSameBitsTwice(*device, 3.0);
  ASSERT_TRUE(device->open().ok());
  hold(*device, 1.0, 1);
  const AllocationScope count;
  hold(*device, 1.0, 1000);
  EXPECT_EQ(count.allocations(), 0U);
}

// ---- persons who act

TEST(SimulatedDevice, Tremor_MovesAFreeMassByTheIntegralOfItsForce) {
  constexpr double kAmplitude = 2.0, kHz = 5.0, kMass = 0.8;
  constexpr double kOmega = 2.0 * std::numbers::pi * kHz;
  PatientConfig patient = nobody();
  patient.axes[0].tremor = kAmplitude;
  patient.tremor.frequency_hz = kHz;
  const auto device = opened(oneAxisDevice(kMass), patient, stayAt(0.0));
  DeviceReading reading;
  ASSERT_EQ(device->read(reading, 1), Fault::kNone);
  const double first = personAt(*device).effort[0];
  double lowest = 0.0, highest = 0.0, before = first;
  for (int k = 1; k <= 1000; ++k) {
    ASSERT_EQ(device->read(reading, 1), Fault::kNone);
    // The effort is linear over a period, so its trapezoid is exact.
    const double v = device->velocity()[0];
    lowest = std::min(lowest, v);
    highest = std::max(highest, v);
    ASSERT_LE(std::abs(personAt(*device).effort[0] - before), kAmplitude * kOmega * kPeriod_s);
    before = personAt(*device).effort[0];
  }
  EXPECT_NEAR(before, first, 1e-9);  // five whole cycles later
  EXPECT_NEAR(device->velocity()[0], 0.0, 1e-9);
  EXPECT_NEAR(highest - lowest, 2.0 * kAmplitude / (kMass * kOmega), 1e-4);  // of 0.159 m/s
}

TEST(SimulatedDevice, PersonWhoLetsGo_LeavesTheBareMechanismToTheDevice) {
  PatientConfig patient = personOf({"x", 1.5, 20.0, 600.0});
  patient.letting_go.after_s = 3.0;
  DeviceModel model = oneAxisDevice(0.5);
  const auto device = opened(model, patient, stayAt(0.02));
  hold(*device, 2.0, 1 + 3000);
  const double rest = 0.02 + 2.0 / 600.0;  // the person's spring balances the effort
  EXPECT_NEAR(device->position()[0], rest, 1e-9);
  EXPECT_NEAR(personAt(*device).effort[0], -2.0, 1e-6);
  EXPECT_FALSE(device->person().hasLetGo());
  hold(*device, 2.0, 100);
  EXPECT_TRUE(device->person().hasLetGo());
  EXPECT_EQ(personAt(*device).effort[0], 0.0);
  // 0.5 kg remains: the person's mass, damper and spring are gone.
  EXPECT_NEAR(device->position()[0] - rest, 0.5 * (2.0 / 0.5) * 0.1 * 0.1, 1e-7);
  EXPECT_NEAR(device->velocity()[0], (2.0 / 0.5) * 0.1, 1e-6);
  ASSERT_TRUE(device->open().ok());  // the person holds it again from the start
  EXPECT_EQ(hold(*device, 0.0, 1).q_m[0], 0.02);
  EXPECT_FALSE(device->person().hasLetGo());
}

TEST(SimulatedDevice, LetGoInMotion_KeepsItsSpeed) {
  PatientConfig patient = personOf({"x", 1.0, 60.0, 900.0});
  patient.letting_go.after_s = 0.2;
  const Intention way =
      Intention::throughWaypoints({{0.0, AxisPosition(1, 0.0)}, {0.4, AxisPosition(1, 0.2)}});
  const auto device = opened(oneAxisDevice(0.5), patient, way);
  hold(*device, 0.0, 1 + 200);
  const double speed = device->velocity()[0], at = device->position()[0];
  EXPECT_GT(speed, 0.5);
  hold(*device, 0.0, 100);
  EXPECT_NEAR(device->velocity()[0], speed, 1e-12);
  EXPECT_NEAR(device->position()[0], at + 0.1 * speed, 1e-12);
}

TEST(SimulatedDevice, Slam_DrawsBackReachesItsSpeedLetsGoAndCoasts) {
  for (const bool upper : {true, false}) {
    DeviceModel model = oneAxisDevice(0.8);
    model.axes[0].lower = -0.085;
    model.axes[0].upper = 0.085;
    model.axes[0].damping = 6.0;
    model.axes[0].coulomb = 0.2;
    model.axes[0].effort_limit = 20.0;
    model.axes[0].speed_limit = 1.5;
    PatientConfig patient = nobody();
    patient.slam = {"x", upper, 0.1, 0.98, 2.0};
    const auto device = opened(model, patient, stayAt(0.0));
    const double sign = upper ? 1.0 : -1.0;
    double fastest = 0.0, furthest_back = 0.0, hardest = 0.0, let_go_at = 0.0;
    int ticks = 0;
    while (!device->person().hasLetGo() && ticks++ < 3000) {
      hold(*device, 0.0, 1);
      fastest = std::max(fastest, sign * device->velocity()[0]);
      furthest_back = std::min(furthest_back, sign * device->position()[0]);
      hardest = std::max(hardest, std::abs(personAt(*device).effort[0]));
      let_go_at = sign * device->position()[0];
    }
    ASSERT_LT(ticks, 3000);
    EXPECT_NEAR(fastest, 0.98 * 1.5, 0.003 * 1.5);  // reached, and never the limit itself
    EXPECT_LT(fastest, 1.5);
    EXPECT_NEAR(furthest_back, -0.085 + 0.05 * 0.17, 2e-3);
    EXPECT_LT(let_go_at, 0.05);  // room is left to coast
    EXPECT_LE(hardest, 2.0 * 20.0);
    // v' = -(b v + f_c)/m from there.
    const double v = sign * device->velocity()[0], decay = std::exp(-6.0 / 0.8 * 0.02);
    hold(*device, 0.0, 20);
    EXPECT_NEAR(sign * device->velocity()[0], (v + 0.2 / 6.0) * decay - 0.2 / 6.0, 1e-9);
  }
}

/// A person on a rendered spring of 1000 N/m: work in the last second [J] and largest speed in that
/// second.
struct Swing {
  double work = 0.0, fastest = 0.0;
};
Swing swingOf(double fight) {
  DeviceModel model = oneAxisDevice(0.8);
  model.axes[0].damping = 6.0;
  model.axes[0].speed_limit = 1.5;
  PatientConfig patient = nobody();
  patient.axes[0].fight = fight;
  const auto device = opened(model, patient, stayAt(0.01));
  DeviceReading reading;
  Swing swing;
  double before = 0.01;
  for (int k = 0; k < 6000; ++k) {
    EXPECT_EQ(device->read(reading, 1), Fault::kNone);
    if (k >= 5000) {
      swing.work += personAt(*device).effort[0] * (reading.q_m[0] - before);
      swing.fastest = std::max(swing.fastest, std::abs(device->velocity()[0]));
    }
    before = reading.q_m[0];
    EXPECT_EQ(device->write(AxisEffort(1, -1000.0 * reading.q_m[0])), Fault::kNone);
  }
  return swing;
}

TEST(SimulatedDevice, Fighter_KeepsASpringSwingingThatWouldOtherwiseRest) {
  EXPECT_LT(swingOf(0.0).fastest, 1e-6);
  const Swing fought = swingOf(12.0);
  // The first harmonic of a square wave in phase with the speed, against the damper less what the
  // sampled spring (K T/2) and the sampled sign put in: v = 4 A / (π b).
  EXPECT_NEAR(fought.fastest, 4.0 * 12.0 / (std::numbers::pi * 5.5), 0.3);
  EXPECT_NEAR(fought.work, 0.5 * 5.5 * fought.fastest * fought.fastest, 2.0);
}

TEST(SimulatedDevice, ClosedDeviceOrWrongSize_IsAFaultAndKeepsTheLastEffort) {
  SimulatedDevice device(oneAxisDevice(1.0), nobody(), stayAt(0.0), kPeriod_s);
  DeviceReading reading;
  EXPECT_EQ(device.read(reading, 1), Fault::kDeviceRead);
  EXPECT_EQ(device.write(AxisEffort(1, 1.0)), Fault::kDeviceWrite);
  ASSERT_TRUE(device.open().ok());
  hold(device, 1.0, 2);
  EXPECT_EQ(device.write(AxisEffort(1, std::numeric_limits<double>::quiet_NaN())),
            Fault::kDeviceWrite);
  EXPECT_EQ(device.write(AxisEffort(2, 1.0)), Fault::kDeviceWrite);
  ASSERT_EQ(device.read(reading, 1), Fault::kNone);
  EXPECT_NEAR(device.velocity()[0], 2e-3, 1e-15);
  device.close();
  device.close();
  EXPECT_EQ(device.acting()[0], 0.0);
  EXPECT_EQ(device.read(reading, 1), Fault::kDeviceRead);
}

}  // namespace
}  // namespace wholehand
