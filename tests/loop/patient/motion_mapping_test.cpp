#include "files/patient/motion_file.hpp"
#include "loop/patient/motion.hpp"
#include "support/constants.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <filesystem>

namespace wholehand::test {
namespace {

DeviceAxis axisOf(const char* name, AxisKind kind, double lower, double upper, double speed) {
  DeviceAxis axis{.name = name, .kind = kind, .lower = lower, .upper = upper, .speed_limit = speed};
  if (std::string(name).find('_') != std::string::npos) axis.group = AxisGroup::kHand;
  return axis;
}

/// The ranges and speed limits of the paper's device.
DeviceModel sixAxes() {
  DeviceModel device;
  device.name = "six-axes";
  constexpr AxisKind kT = AxisKind::kTranslation, kR = AxisKind::kRotation;
  device.axes = {axisOf("x", kT, -0.085, 0.085, 1.5),
                 axisOf("y", kT, -0.12, 0.12, 1.5),
                 axisOf("z", kT, -0.12, 0.12, 1.5),
                 axisOf("finger_flexion", kR, 0.0, kPi, 10.0),
                 axisOf("thumb_circumduction", kR, 0.0, kPi / 2, 10.0),
                 axisOf("thumb_flexion", kR, 0.0, 80.0 / 180.0 * kPi, 10.0)};
  return device;
}

DeviceModel onlyAxis(DeviceAxis axis) {
  DeviceModel device;
  device.name = "one-axis";
  device.axes = {std::move(axis)};
  return device;
}

/// One column sampled at 100 Hz.
template <class Function>
MotionFile sampled(const char* column, double length_s, Function&& f) {
  MotionFile motion;
  motion.columns = {column};
  const int n = static_cast<int>(std::lround(length_s * 100.0));
  for (int i = 0; i <= n; ++i) {
    motion.time_s.push_back(0.01 * i);
    motion.samples.push_back({f(0.01 * i)});
  }
  return motion;
}

double positionAt(const Intention& intention, double time_s, int axis = 0) {
  AxisPosition q;
  AxisVelocity qd;
  intention.evaluate(time_s, q, qd);
  return q[axis];
}

std::string joined(const std::vector<std::string>& lines) {
  std::string all;
  for (const std::string& line : lines) all += line + "\n";
  return all;
}

#define EXPECT_CONTAINS(text, part) \
  EXPECT_TRUE(contains((text), part)) << "it says instead:\n" << (text)

/// Checks what every intention guarantees: inside the range, within the speed limit, no jump in
/// velocity, at rest at both ends.
void expectPlayable(const Intention& intention, const DeviceModel& device, double speed_share) {
  AxisPosition q, q_before;
  AxisVelocity qd, qd_before;
  constexpr double kStep_s = 0.5e-3;
  intention.evaluate(0.0, q_before, qd_before);
  for (int k = 0; k < device.axisCount(); ++k) EXPECT_EQ(qd_before[k], 0.0);
  for (double t_s = kStep_s; t_s < intention.duration_s() + 0.01; t_s += kStep_s) {
    intention.evaluate(t_s, q, qd);
    for (int k = 0; k < device.axisCount(); ++k) {
      const DeviceAxis& axis = device.axes[k];
      ASSERT_GE(q[k], axis.lower) << axis.name << " at " << t_s;
      ASSERT_LE(q[k], axis.upper) << axis.name << " at " << t_s;
      ASSERT_LE(std::abs(qd[k]), speed_share * axis.speed_limit * (1.0 + 1e-9)) << axis.name;
      // Positions follow the velocities: the error of the trapezoid rule is jerk · h³ / 12.
      ASSERT_NEAR(q[k] - q_before[k], 0.5 * kStep_s * (qd[k] + qd_before[k]),
                  2e-6 * speed_share * axis.speed_limit);
      // Knots at 100 Hz: reaching full speed from rest takes at least one interval.
      ASSERT_LE(std::abs(qd[k] - qd_before[k]), 0.1 * axis.speed_limit) << axis.name << t_s;
    }
    q_before = q;
    qd_before = qd;
  }
  for (int k = 0; k < device.axisCount(); ++k) EXPECT_EQ(qd[k], 0.0);
}

TEST(MotionMapping, EveryRecordingOnThePapersDevice_IsPlayable) {
  const DeviceModel device = sixAxes();
  const MotionMapping mapping;
  for (const auto& entry :
       std::filesystem::directory_iterator(WHOLEHAND_SOURCE_DIR "/data/human-motion")) {
    if (entry.path().extension() != ".csv") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const MotionFile motion = orThrow(loadMotionFile(entry.path().string(), &device));
    std::vector<std::string> report;
    const Intention intention =
        Intention::fromMotion(motion, mapping, device, AxisPosition(6), &report);
    expectPlayable(intention, device, mapping.speed_share);
    EXPECT_CONTAINS(joined(report), "translations scaled by 0.");
    // The fastest finger movement of all recordings, 33 rad/s in trial 22, is 4.2 times the allowed
    // speed.
    EXPECT_LT(intention.duration_s(), 4.2 * motion.time_s.back() + 1.0);
  }
}

TEST(MotionMapping, MotionThatFits_KeepsItsShapeAndTime) {
  // 1 Hz is far below the filter's 14 Hz: gain cos²(π/100)(2 + cos(2π/100))/3 = 0.99836 at the
  // knots.
  const DeviceModel device = onlyAxis(axisOf("x", AxisKind::kTranslation, -1.0, 1.0, 10.0));
  const MotionFile motion =
      sampled("x", 4.0, [](double t_s) { return 0.2 * std::sin(2.0 * kPi * t_s); });
  const Intention intention =
      Intention::fromMotion(motion, {.center = false}, device, AxisPosition(1), nullptr);
  // Easing in shifts time by half of 0.2 s, the spline's lead-in by one knot.
  for (double t_s = 0.5; t_s < 3.5; t_s += 0.0123) {
    ASSERT_NEAR(positionAt(intention, t_s + 0.1 + 0.01), 0.99836 * 0.2 * std::sin(2.0 * kPi * t_s),
                1e-5);
  }
}

TEST(MotionMapping, FastTremor_IsAttenuatedByTheFilter) {
  // -3 dB at 14 Hz: cos²(0.14 π)(2 + cos(0.28 π))/3 = 0.720 (7 periods are 50 knots).
  const DeviceModel device = onlyAxis(axisOf("x", AxisKind::kTranslation, -1.0, 1.0, 1e3));
  const MotionFile motion =
      sampled("x", 4.0, [](double t_s) { return 0.2 * std::sin(2.0 * kPi * 14.0 * t_s); });
  const Intention intention =
      Intention::fromMotion(motion, {.center = false}, device, AxisPosition(1), nullptr);
  double largest = 0.0;
  for (double t_s = 0.5; t_s < 3.5; t_s += 1e-3) {
    largest = std::max(largest, std::abs(positionAt(intention, t_s)));
  }
  EXPECT_NEAR(largest / 0.2, 0.720, 0.01);
}

TEST(MotionMapping, TranslationTooLarge_IsScaledToFitAndCentred) {
  DeviceModel device = sixAxes();
  device.axes.resize(3);
  device.axes[2].lower = 0.1;  // a workspace need not contain zero
  device.axes[2].upper = 0.4;
  MotionFile motion;
  motion.columns = {"x", "y", "z"};
  for (int i = 0; i <= 200; ++i) {
    const double u = 0.5 - 0.5 * std::cos(kPi * i / 200.0);
    motion.time_s.push_back(0.01 * i);
    motion.samples.push_back({0.1 + 0.4 * u, 0.05 * u, 1.0});
  }
  std::vector<std::string> report;
  const Intention intention =
      Intention::fromMotion(motion, {.margin = 0.05}, device, AxisPosition(3), &report);
  // x: 0.9 · 0.17 m for 0.4 m; y has the same scale; z, which does not move, stays in the middle.
  const double scale = 0.9 * 0.17 / 0.4;
  const double end_s = intention.duration_s();
  EXPECT_NEAR(positionAt(intention, 0.0, 0), -0.0765, 1e-12);
  EXPECT_NEAR(positionAt(intention, end_s, 0), 0.0765, 1e-12);
  EXPECT_NEAR(positionAt(intention, end_s, 1) - positionAt(intention, 0.0, 1), scale * 0.05, 1e-12);
  EXPECT_NEAR(positionAt(intention, 1.0, 2), 0.25, 1e-12);
  EXPECT_CONTAINS(joined(report), "translations scaled by 0.383");
  EXPECT_CONTAINS(joined(report), "x -0.077 .. 0.077");
}

TEST(MotionMapping, GivenScaleThatDoesNotFit_IsSmoothlyLimitedAtTheEnds) {
  const DeviceModel device = onlyAxis(axisOf("x", AxisKind::kTranslation, -0.1, 0.1, 10.0));
  const MotionFile motion = sampled("x", 2.0, [](double t_s) { return 0.4 * std::sin(kPi * t_s); });
  std::vector<std::string> report;
  const Intention intention =
      Intention::fromMotion(motion, {.margin = 0.1, .base_scale = 0.5, .center = false}, device,
                            AxisPosition(1), &report);
  expectPlayable(intention, device, 0.8);
  EXPECT_NEAR(positionAt(intention, 0.5 * intention.duration_s() - 0.5), 0.08, 1e-6);  // the margin
  EXPECT_CONTAINS(joined(report), "translations scaled by 0.5");
  EXPECT_CONTAINS(joined(report), "x reached -0.2 .. 0.2 m: bent smoothly into -0.08 .. 0.08");
}

TEST(MotionMapping, FastRotation_IsSlowedByExactlyTheNeededFactor) {
  const DeviceModel device = sixAxes();
  // 1 + sin(2π 2 t): 12.57 rad/s against 0.8 · 10; the filter passes 0.9934 of 2 Hz.
  const MotionFile motion =
      sampled("finger_flexion", 3.0, [](double t_s) { return 1.5 + std::sin(4.0 * kPi * t_s); });
  std::vector<std::string> report;
  const Intention intention =
      Intention::fromMotion(motion, {}, device, AxisPosition(6, 0.5), &report);
  expectPlayable(intention, device, 0.8);
  EXPECT_CONTAINS(joined(report), "times slower: finger_flexion reached 12.");
  EXPECT_NEAR(intention.duration_s() / (3.2 + 0.02), 0.9934 * 4.0 * kPi / 8.0, 0.01);
  double fastest = 0.0;
  AxisPosition q;
  AxisVelocity qd;
  for (double t_s = 0.0; t_s < intention.duration_s(); t_s += 1e-4) {
    intention.evaluate(t_s, q, qd);
    fastest = std::max(fastest, std::abs(qd[3]));
  }
  EXPECT_NEAR(fastest, 8.0, 1e-3);
}

TEST(MotionMapping, AxisOnlyInDeviceOrFile_RestsOrIsIgnoredAndIsReported) {
  const DeviceModel device = onlyAxis(axisOf("yaw", AxisKind::kRotation, -1.0, 1.0, 10.0));
  MotionFile motion = sampled("finger_flexion", 1.0, [](double t_s) { return t_s; });
  std::vector<std::string> report;
  const Intention intention =
      Intention::fromMotion(motion, {}, device, AxisPosition(1, 0.4), &report);
  EXPECT_NEAR(positionAt(intention, 0.7), 0.4, 1e-15);
  EXPECT_CONTAINS(joined(report), "yaw is not in the file: rests at 0.4 rad");
  EXPECT_CONTAINS(joined(report),
                  "column finger_flexion is ignored: the device one-axis has no such");
}

TEST(MotionMapping, MotionThatStartsAndEndsFast_EasesInAndOutAndHolds) {
  const DeviceModel device = onlyAxis(axisOf("yaw", AxisKind::kRotation, -3.0, 3.0, 100.0));
  const MotionFile motion = sampled("yaw", 1.0, [](double t_s) { return 2.0 * t_s - 1.0; });
  const Intention intention = Intention::fromMotion(motion, {}, device, AxisPosition(1), nullptr);
  EXPECT_NEAR(positionAt(intention, -1.0), -1.0, 1e-12);
  EXPECT_NEAR(positionAt(intention, intention.duration_s() + 5.0), 1.0, 1e-12);
  AxisPosition q;
  AxisVelocity qd;
  double before = 0.0, hardest = 0.0;
  for (double t_s = 0.0; t_s < intention.duration_s(); t_s += 1e-3) {
    intention.evaluate(t_s, q, qd);
    hardest = std::max(hardest, std::abs(qd[0] - before) / 1e-3);
    before = qd[0];
  }
  // 2 rad/s gained over 0.2 s by 3u² - 2u³, whose steepest slope is 3/2.
  EXPECT_NEAR(hardest, 2.0 / 0.2 * 1.5, 0.8);
}

TEST(MotionMapping, AnyMotion_IsPlayable) {
  EXPECT_TRUE(rc::check("inside the range, within the speeds", [] {
    const auto real = [](double low, double high) {
      return low + (high - low) * *rc::gen::inRange(0, 100001) / 100000.0;
    };
    MotionFile motion;
    motion.columns = {"x", "thumb_flexion", "z"};
    double time_s = real(-10, 10);
    const int rows = *rc::gen::inRange(2, 40);
    for (int i = 0; i < rows; ++i) {
      motion.time_s.push_back(time_s += real(0.0, 1.0) < 0.5 ? 0.01 : real(1e-6, 0.3));
      motion.samples.push_back({real(-2, 2), real(-4, 4), real(0.1, 0.11)});
    }
    const MotionMapping mapping{.margin = real(0, 0.4),
                                .speed_share = real(0.05, 1.0),
                                .base_scale = real(0, 1) < 0.5 ? 0.0 : real(0.01, 3.0),
                                .center = real(0, 1) < 0.5};
    const DeviceModel device = sixAxes();
    const Intention intention =
        Intention::fromMotion(motion, mapping, device, AxisPosition(6), nullptr);
    AxisPosition q;
    AxisVelocity qd;
    for (int i = 0; i <= 4000; ++i) {
      intention.evaluate(intention.duration_s() * i / 4000.0, q, qd);
      for (int k = 0; k < 6; ++k) {
        const DeviceAxis& axis = device.axes[k];
        RC_ASSERT(q[k] >= axis.lower && q[k] <= axis.upper);
        RC_ASSERT(std::abs(qd[k]) <= mapping.speed_share * axis.speed_limit * (1 + 1e-9));
      }
    }
  }));
}

}  // namespace
}  // namespace wholehand::test
