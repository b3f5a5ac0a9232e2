#pragma once

#include "support/constants.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <cmath>

/// Persons who throw a device about, and checks of the effort sent to it.
namespace wholehand::test {

/// A person who slams the device about: every 150 ms another random place, extremes included, as
/// far as `speed_share` of every axis's speed limit allows. The peak speed of minimum jerk is 1.875
/// times its mean.
inline Intention slamming(const DeviceModel& device, std::mt19937_64& random,
                          const AxisPosition& start, double speed_share = 0.6) {
  constexpr double kEvery_s = 0.15;
  std::vector<Waypoint> waypoints{{0.0, start}};
  for (int i = 1; i <= 15; ++i) {
    AxisPosition q(device.axisCount());
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = device.axes[a];
      const double farthest = speed_share * axis.speed_limit * kEvery_s / 1.875;
      const double step = farthest * std::clamp(uniform(random, -1.5, 1.5), -1.0, 1.0);
      q[a] = std::clamp(waypoints.back().q[a] + step, axis.lower, axis.upper);
    }
    waypoints.push_back({kEvery_s * i, q});
  }
  return Intention::throughWaypoints(std::move(waypoints));
}
/// Speed share of a person who exceeds the speed limit.
inline constexpr double kTooFast = 4.0;

/// A hand clear of the shipped scenes' bodies: high, open, fingers away.
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
    ASSERT_LE(std::abs(r.sent[a]), renderer.config().safety.effort_limit[a]) << "tick " << r.tick;
  }
}

/// Checks from tick `from` on: the effort falls from its last value to neutral, with no step
/// steeper than the smoothstep's 1.5 / ramp, is neutral within 100 ms and stays there.
inline void expectRamp(const HapticRenderer& renderer, const std::vector<TickRecord>& records,
                       int from) {
  const RendererConfig& config = renderer.config();
  const AxisEffort& neutral = config.safety.neutral;
  const AxisEffort held = records[from - 1].sent;
  const double steepest = 1.5 / config.safety.ramp.ramp_s * kPeriod_s;
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
