#include "experiments/exercise_script.hpp"

#include "loop/core/geometry.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <random>
#include <vector>

namespace wholehand {
namespace {

// Vector from the hand's base to the axis of a held dispenser (power grasp, adult median hand) [m].
const Eigen::Vector3d kGrip(0.049, 0.041, 0.004);

struct Posture {
  double fingers = 0.0, circumduction = 0.0, thumb = 0.0;
};
constexpr Posture kStretched{10 * kDeg, 5 * kDeg, 0.0};
constexpr Posture kOpen{65 * kDeg, 5 * kDeg, 0.0};
constexpr Posture kOpposed{65 * kDeg, 20 * kDeg, 0.0};
// Target postures inside the dispenser. A deeper target gives a firmer grip.
constexpr Posture kFirm{150 * kDeg, 20 * kDeg, 44 * kDeg};
constexpr Posture kFirmer{152 * kDeg, 20 * kDeg, 46 * kDeg};
constexpr Posture kGentle{112 * kDeg, 20 * kDeg, 22 * kDeg};
constexpr Posture kGrips{140 * kDeg, 20 * kDeg, 42 * kDeg};
constexpr Posture kFollows{158 * kDeg, 20 * kDeg, 54 * kDeg};
constexpr Posture kHalfOpen{80 * kDeg, 5 * kDeg, 0.0};
// Fingers that are not stretched enough to pass beside the dispenser without contact.
constexpr Posture kGrazing{48 * kDeg, 5 * kDeg, 0.0};

constexpr double kBack_m = -0.077;

/// Builds the waypoints of a device. Missing axes are left out; the others are clamped to their
/// range.
class Way {
 public:
  explicit Way(const DeviceModel& device) : device_(device) {}

  void go(double time_s, const Eigen::Vector3d& base, const Posture& hand) {
    AxisPosition q(device_.axisCount());
    set(q, "x", base.x());
    set(q, "y", base.y());
    set(q, "z", base.z());
    set(q, "finger_flexion", hand.fingers);
    set(q, "thumb_circumduction", hand.circumduction);
    set(q, "thumb_flexion", hand.thumb);
    waypoints_.push_back({time_s, q});
  }
  [[nodiscard]] Intention intention() { return Intention::throughWaypoints(std::move(waypoints_)); }

 private:
  void set(AxisPosition& q, const char* name, double value) const {
    const int a = device_.axisIndex(name);
    if (a < 0) return;
    const DeviceAxis& axis = device_.axes[a];
    q[a] = std::clamp(value, axis.lower, axis.upper);
  }

  const DeviceModel& device_;
  std::vector<Waypoint> waypoints_;
};

/// Base positions beside the dispenser and with the palm pressed against it, for a hand that grips
/// it at `grip`.
Eigen::Vector3d besideOf(const Eigen::Vector3d& grip) {
  return grip - Eigen::Vector3d(0.0, 0.024, 0.0);
}
Eigen::Vector3d touchingOf(const Eigen::Vector3d& grip) {
  return grip + Eigen::Vector3d(0.0, 0.004, 0.0);
}

}  // namespace

Intention exerciseIntention(const DeviceModel& device, const Eigen::Vector3d& home_m,
                            std::uint64_t seed) {
  namespace at = exercise_times;
  std::mt19937_64 random(seed);
  // Avoids std::uniform_real_distribution, whose values differ between standard libraries.
  const auto jitter = [&random](double half_width) {
    return half_width * (2.0 * static_cast<double>(random() >> 11U) * 0x1.0p-53 - 1.0);
  };
  const Eigen::Vector3d off(jitter(0.002), jitter(0.002), jitter(0.003));
  const Eigen::Vector3d start_off(jitter(0.002), jitter(0.01), jitter(0.01));
  const Eigen::Vector3d grip = home_m - kGrip + off;
  Way way(device);
  const auto go = [&way](double time_s, const Eigen::Vector3d& base, const Posture& hand) {
    way.go(time_s, base, hand);
  };
  const auto put = [&](double x, double y) { return Eigen::Vector3d(x, home_m.y() + y, grip.z()); };
  constexpr double kReach_m = 0.0, kLeft_m = 0.078, kBump_m = -0.036;
  const Eigen::Vector3d beside = besideOf(grip);
  const Eigen::Vector3d touching = touchingOf(grip);
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
  go(at::kSqueezes, touching, kGrips);
  go(at::kLetsGo, touching, kFollows);  // follows the shell, which yields
  go(at::kOpened, grip, kHalfOpen);
  go(at::kRetrieves, grip, kHalfOpen);
  go(at::kOff, beside, kGrazing);
  go(at::kAway, {kBack_m, beside.y(), beside.z()}, kOpen);
  return way.intention();
}

Intention squeezeAgainAndAgain(const DeviceModel& device, const Eigen::Vector3d& home_m,
                               double duration_s) {
  constexpr double kCycle_s = 9.0;
  const Eigen::Vector3d grip = home_m - kGrip, beside = besideOf(grip), touching = touchingOf(grip);
  const Eigen::Vector3d away(kBack_m, beside.y(), beside.z());
  Way way(device);
  way.go(0.0, away, kStretched);
  for (double from_s = 0.0; from_s < duration_s; from_s += kCycle_s) {
    way.go(from_s + 0.8, beside, kStretched);
    way.go(from_s + 1.4, touching, kOpposed);
    way.go(from_s + 2.4, touching, kOpposed);  // the exercise's haptics fade in
    way.go(from_s + 3.4, touching, kFirm);
    way.go(from_s + 4.4, touching, kFirmer);
    way.go(from_s + 5.4, touching, kGentle);
    way.go(from_s + 6.2, touching, kFirm);
    way.go(from_s + 7.0, grip, kHalfOpen);
    way.go(from_s + 7.6, beside, kGrazing);
    way.go(from_s + 8.4, away, kOpen);
    way.go(from_s + kCycle_s, away, kStretched);
  }
  return way.intention();
}

}  // namespace wholehand
