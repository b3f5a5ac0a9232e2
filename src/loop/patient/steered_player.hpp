#pragma once

#include "loop/core/command.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/device_model.hpp"
#include "loop/patient/player.hpp"

#include <array>
#include <memory>
#include <string>

namespace wholehand {

/// Limits of an axis that follows a moving point.
struct FollowerLimits {
  double lower = 0.0, upper = 0.0;  ///< the point is clamped to this range [m or rad]
  double speed = 1.0;               ///< largest speed of the goal [m/s or rad/s], > 0
  double rate_rad_s = 20.0;         ///< bandwidth of the filter; lag 2 / rate, > 0
};

/// State of the follower. `goal` approaches the point at the speed limit; position and velocity
/// follow it.
struct FollowerState {
  double position = 0.0, velocity = 0.0, goal = 0.0;
};

/// State that continues at this speed. The goal lies ahead such that the acceleration begins at
/// zero. Real-time safe.
[[nodiscard]] WHOLEHAND_RT FollowerState movingFollower(double position, double velocity,
                                                        const FollowerLimits& limits) noexcept;

/// One period of q̈ = ω² (goal − q) − 2 ω q̇, exact for a goal constant over the period. The
/// impulse response is non-negative and sums to one: it never overshoots a goal and is never faster
/// than the goal, or than itself at the start. Real-time safe.
[[nodiscard]] WHOLEHAND_RT FollowerState follow(FollowerState state, double point,
                                                const FollowerLimits& limits,
                                                double period_s) noexcept;

/// The first axis that is aimed farther beyond its range than ten times that: a value of another
/// unit, which no arm means. -1: none. @pre one value for each axis
[[nodiscard]] int firstFarAim(const DeviceModel& device, const AxisPosition& aim) noexcept;

/// Why such an aim is refused: "x = 1e+09 m: ...".
[[nodiscard]] std::string farAimText(const DeviceAxis& axis, double aim);

struct SteeringConfig {
  double rate_rad_s = 20.0;  ///< bandwidth of the filter on a person's target: lag 0.1 s
  double speed_share = 0.5;  ///< share of the device's speed limits, (0, 1]
  double blend_rad_s = 8.0;  ///< rate of return to the virtual patient's own target
  /// Fingers and thumb may be aimed this far beyond the closed end of their range [rad]: a hand
  /// that holds something firmly wants to close further than it can.
  double grip_past_rad = 30.0 * kDeg;
};

/// A virtual patient whose hand a person at a screen may steer and return.
///
/// The person's targets pass a critically damped second-order filter, clamped to the device's
/// ranges (of fingers and thumb a little more) and to a share of its speed limits. A mouse that
/// jumps therefore moves no arm faster than that. Position and velocity are continuous when the
/// steering changes, in both directions: the person begins at the hand's position and velocity;
/// afterwards the offset to the virtual patient's own target fades in the same way. When targets
/// stop coming, the last one is held.
///
/// A person who pushes against something that yields holds back. Where an axis of the device moves
/// clearly faster than any target, the intention continues from the axis's position. Otherwise a
/// squeezing hand that slips off a bottle would exceed the device's speed limit.
class SteeredPlayer final : public Player {
 public:
  /// @pre virtual_patient has the device's axes and is not null
  SteeredPlayer(std::unique_ptr<Player> virtual_patient, const DeviceModel& device,
                const SteeringConfig& config = {});

  [[nodiscard]] AxisPosition start() const override { return virtual_patient_->start(); }
  /// Returns the steering to the virtual patient, from the start.
  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord& record) noexcept override;

  /// Handles kSteer and kAim, nothing else. A target counts while a person steers; a non-finite
  /// one, or one without the device's axes, is ignored. In the thread that ticks, before the tick.
  WHOLEHAND_RT void command(const Command& command) noexcept override;

  [[nodiscard]] WHOLEHAND_RT Mover mover() const noexcept override {
    return steering_ == Steering::kPerson ? Mover::kPerson : virtual_patient_->mover();
  }
  [[nodiscard]] WHOLEHAND_RT Help help() const noexcept override {
    return steering_ == Steering::kPerson ? help_ : Help::kUnsaid;
  }

  [[nodiscard]] Steering steering() const noexcept { return steering_; }

 private:
  using Followers = std::array<FollowerState, kMaxAxes>;
  using Limits = std::array<FollowerLimits, kMaxAxes>;
  void takeOver() noexcept;
  void holdBack(const AxisPosition& q_m, double elapsed_s) noexcept;

  std::unique_ptr<Player> virtual_patient_;
  int axes_;
  Limits person_limits_{}, blend_limits_{};
  Steering steering_ = Steering::kVirtualPatient;
  bool handed_back_ = false;   // the virtual patient has not advanced since the return
  Followers person_{};         // hand steered by the person
  Followers offset_{};         // offset of the hand from the virtual patient's target
  AxisPosition aim_;           // target of the person
  Help help_ = Help::kUnsaid;  // as the last target says
  AxisPosition seen_;          // device position of the last tick; no axes before the first
  double period_s_ = 0.0;      // last argument of advance()
  AxisPosition q_;             // last result of advance()
  AxisVelocity qd_;
};

}  // namespace wholehand
