#pragma once

#include "support/rig_tools.hpp"

#include <cmath>
#include <random>

/// Persons who throw a device about, and what must hold of the effort that is sent to it.
namespace wholehand::test {

inline constexpr double kPeriod_s = 1e-3;
inline constexpr int kNeutralWithin = 100;  // ticks; 100 ms is the longest ramp allowed

inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

/// A person who throws the device about: every 150 ms another random place, extremes included.
inline Intention slamming(const DeviceModel& device, std::mt19937_64& random,
                          const AxisPosition& start) {
  std::vector<Waypoint> waypoints{{0.0, start}};
  for (int i = 1; i <= 15; ++i) {
    AxisPosition q(device.axisCount());
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = device.axes[a];
      q[a] =
          std::clamp(uniform(random, -0.2, 1.2), 0.0, 1.0) * (axis.upper - axis.lower) + axis.lower;
    }
    waypoints.push_back({0.15 * i, q});
  }
  return Intention::throughWaypoints(std::move(waypoints));
}

/// A hand that stands clear of the shipped scenes' bodies: high, open, fingers away.
inline AxisPosition clear(const DeviceModel& device) {
  AxisPosition q(device.axisCount());
  for (int a = 0; a < q.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    if (axis.name == "z") q[a] = 0.95 * axis.upper;
    if (axis.name == "x") q[a] = 0.95 * axis.lower;
  }
  return q;
}

/// A device whose own weight must be carried, so that neutral is not zero.
inline Models withWeight(Models m) {
  for (DeviceAxis& axis : m.device.axes) axis.neutral_effort = 0.05 * axis.effort_limit;
  return m;
}

inline void expectWithinLimits(const HapticRenderer& renderer, const TickRecord& r) {
  for (int a = 0; a < r.sent.size(); ++a) {
    ASSERT_LE(std::abs(r.sent[a]), renderer.config().effort_limit[a]) << "tick " << r.tick;
  }
}

/// From `from` on: away from what was sent before to neutral, no step steeper than the smoothstep's
/// 1.5 / ramp, arrived within 100 ms and there to stay.
inline void expectRamp(const HapticRenderer& renderer, const std::vector<TickRecord>& records,
                       int from) {
  const RendererConfig& config = renderer.config();
  const AxisEffort& neutral = config.neutral;
  const AxisEffort held = records[from - 1].sent;
  const double steepest = 1.5 / config.ramp.ramp_s * kPeriod_s;
  for (int k = from; k < static_cast<int>(records.size()); ++k) {
    for (int a = 0; a < held.size(); ++a) {
      const double before = records[k - 1].sent[a] - neutral[a];
      const double now = records[k].sent[a] - neutral[a];
      const double span = std::abs(held[a] - neutral[a]);
      ASSERT_LE(std::abs(now), std::abs(before) + 1e-15) << "tick " << k;
      ASSERT_LE(std::abs(now - before), steepest * span + 1e-12) << "tick " << k;
      if (k == from && span > 1e-6) {
        ASSERT_LT(std::abs(now), span);
      }
      if (k >= from + kNeutralWithin) {
        ASSERT_EQ(records[k].sent[a], neutral[a]) << "tick " << k;
      }
    }
    ASSERT_LT(records[k].authority, records[from - 1].authority);
  }
  EXPECT_TRUE(renderer.atNeutral());
  EXPECT_EQ(records.back().authority, 0.0);
}

}  // namespace wholehand::test
