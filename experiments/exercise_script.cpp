#include "experiments/exercise_script.hpp"

#include "core/units.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <random>
#include <vector>

namespace wholehand {
namespace {

// From the hand's base to the axis of a dispenser that it holds (power grasp, adult median hand).
const Eigen::Vector3d kGrip(0.049, 0.041, 0.004);

struct Posture {
  double fingers = 0.0, circumduction = 0.0, thumb = 0.0;
};
constexpr Posture kStretched{10 * kDeg, 5 * kDeg, 0.0};
constexpr Posture kOpen{65 * kDeg, 5 * kDeg, 0.0};
constexpr Posture kOpposed{65 * kDeg, 20 * kDeg, 0.0};
// The aim lies inside the dispenser: how far says how firmly.
constexpr Posture kFirm{122 * kDeg, 20 * kDeg, 34 * kDeg};
constexpr Posture kFirmer{130 * kDeg, 20 * kDeg, 37 * kDeg};
constexpr Posture kGentle{116 * kDeg, 20 * kDeg, 31 * kDeg};
constexpr Posture kHalfOpen{80 * kDeg, 5 * kDeg, 0.0};
// Not stretched enough to pass beside it.
constexpr Posture kGrazing{48 * kDeg, 5 * kDeg, 0.0};

}  // namespace

Intention exerciseIntention(const DeviceModel& device, const Eigen::Vector3d& home_m,
                            std::uint64_t seed) {
  namespace at = exercise_times;
  std::mt19937_64 random(seed);
  // Not std::uniform_real_distribution: its values differ between standard libraries.
  const auto jitter = [&random](double half_width) {
    return half_width * (2.0 * static_cast<double>(random() >> 11U) * 0x1.0p-53 - 1.0);
  };
  const Eigen::Vector3d off(jitter(0.002), jitter(0.002), jitter(0.003));
  const Eigen::Vector3d start_off(jitter(0.002), jitter(0.01), jitter(0.01));
  const Eigen::Vector3d grip = home_m - kGrip + off;
  const auto set = [&](AxisPosition& q, const char* name, double value) {
    const int a = device.axisIndex(name);
    if (a < 0) return;
    const DeviceAxis& axis = device.axes[static_cast<std::size_t>(a)];
    q[a] = std::clamp(value, axis.lower, axis.upper);
  };
  std::vector<Waypoint> way;
  const auto go = [&](double time_s, const Eigen::Vector3d& base, const Posture& hand) {
    AxisPosition q(device.axisCount());
    set(q, "x", base.x());
    set(q, "y", base.y());
    set(q, "z", base.z());
    set(q, "finger_flexion", hand.fingers);
    set(q, "thumb_circumduction", hand.circumduction);
    set(q, "thumb_flexion", hand.thumb);
    way.push_back({time_s, q});
  };
  const auto put = [&](double x, double y) { return Eigen::Vector3d(x, home_m.y() + y, grip.z()); };
  constexpr double kBack_m = -0.077, kReach_m = 0.0, kLeft_m = 0.078, kBump_m = -0.036;
  const Eigen::Vector3d beside = grip - Eigen::Vector3d(0.0, 0.024, 0.0);
  const Eigen::Vector3d touching = grip + Eigen::Vector3d(0.0, 0.004, 0.0);
  const Eigen::Vector3d start = put(kBack_m, kLeft_m) + start_off;
  go(0.0, start, kStretched);
  go(at::kServed, start, kStretched);
  go(at::kBeside, put(kReach_m, kLeft_m), kStretched);
  go(at::kHardBump, put(kReach_m, kBump_m), kStretched);
  go(at::kOffAgain, put(kReach_m, kLeft_m), kStretched);
  go(at::kSoftBump - 0.5, put(kReach_m, kLeft_m), kStretched);
  go(at::kSoftBump, put(kReach_m, 0.034), kStretched);
  go(at::kBumped, put(kReach_m, kLeft_m), kStretched);
  go(at::kDrawnBack, put(kBack_m, kLeft_m), kOpen);
  go(at::kAligned, {kBack_m, beside.y(), beside.z()}, kStretched);
  go(at::kEntered, beside, kStretched);
  go(at::kPositioned, touching, kOpposed);
  go(at::kCloses, touching, kOpposed);
  go(at::kSqueezes, touching, kFirm);
  go(at::kSqueezes + 1.2, touching, kFirmer);
  go(at::kSqueezes + 2.4, touching, kGentle);
  go(at::kLetsGo, touching, kFirm);
  go(at::kOpened, grip, kHalfOpen);
  go(at::kRetrieves, grip, kHalfOpen);
  go(at::kOff, beside, kGrazing);
  go(at::kAway, {kBack_m, beside.y(), beside.z()}, kOpen);
  return Intention::throughWaypoints(std::move(way));
}

}  // namespace wholehand
