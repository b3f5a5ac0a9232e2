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

/// State of the follower. `goal` approaches the target point at the speed limit; position and
/// velocity follow the goal.
struct FollowerState {
  double position = 0.0, velocity = 0.0, goal = 0.0;
};

/// Makes a state that continues at this position and velocity. The goal lies so far ahead that the
/// acceleration begins at zero. Real-time safe.
[[nodiscard]] WHOLEHAND_RT FollowerState movingFollower(double position, double velocity,
                                                        const FollowerLimits& limits) noexcept;

/// Advances the follower by one period of q̈ = ω² (goal − q) − 2 ω q̇, exact for a goal that is
/// constant over the period. The impulse response is non-negative and sums to one. The position
/// therefore never overshoots a goal, and it is never faster than the goal or than its own initial
/// speed. Real-time safe.
[[nodiscard]] WHOLEHAND_RT FollowerState follow(FollowerState state, double point,
                                                const FollowerLimits& limits,
                                                double period_s) noexcept;

/// The first axis whose aim lies beyond its range by more than ten times the range: probably a
/// value in another unit, since no arm reaches it. -1: none. @pre one value for each axis
[[nodiscard]] int firstFarAim(const DeviceModel& device, const AxisPosition& aim) noexcept;

/// Reason for refusing such an aim: "x = 1e+09 m: ...".
[[nodiscard]] std::string farAimText(const DeviceAxis& axis, double aim);

struct SteeringConfig {
  double rate_rad_s = 20.0;  ///< bandwidth of the filter on a person's target: lag 0.1 s
  double speed_share = 0.5;  ///< share of the device's speed limits, (0, 1]
  double blend_rad_s = 8.0;  ///< rate of return to the virtual patient's own target
  /// Fingers and thumb may be aimed this far beyond the closed end of their range [rad]: a hand
  /// that holds something firmly wants to close further than it can.
  double grip_past_rad = 30.0 * kDeg;
};

/// A virtual patient whose hand a person at a screen may steer for a time.
///
/// The person's targets pass a critically damped second-order filter. They are clamped to the
/// device's ranges (a little more for fingers and thumb) and to a share of its speed limits. A
/// mouse that jumps therefore moves no arm faster than that. Position and velocity are continuous
/// when the steering changes, in both directions: the person begins at the hand's position and
/// velocity; afterwards the offset to the virtual patient's own target fades in the same way. When
/// no new targets arrive, the last one is held.
///
/// A person who pushes against something that suddenly yields holds back. The same is done here:
/// where an axis of the device moves clearly faster than any target, the intention continues from
/// the axis's position. Otherwise a squeezing hand that slips off a bottle would exceed the
/// device's speed limit.
class SteeredPlayer final : public Player {
 public:
  /// @pre virtual_patient has the device's axes and is not null
  SteeredPlayer(std::unique_ptr<Player> virtual_patient, const DeviceModel& device,
                const SteeringConfig& config = {});

  [[nodiscard]] AxisPosition start() const override { return virtual_patient_->start(); }
  /// Returns the steering to the virtual patient, from the start.
  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void onRecord(const TickRecord& record) noexcept override;

  /// Handles the commands kSteer and kAim and ignores all others. A target counts while a person
  /// steers; a non-finite target, or one without the device's axes, is ignored. Called in the
  /// thread that ticks, before the tick.
  WHOLEHAND_RT void command(const Command& command) noexcept override;

  [[nodiscard]] WHOLEHAND_RT Mover mover() const noexcept override {
    return steering_ == Steering::kPerson ? Mover::kPerson : virtual_patient_->mover();
  }
  [[nodiscard]] WHOLEHAND_RT Help help() const noexcept override {
    return steering_ == Steering::kPerson ? help_ : Help::kUnspecified;
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
  // The steering was returned and the virtual patient has not advanced since.
  bool handed_back_ = false;
  Followers person_{};              // hand steered by the person
  Followers offset_{};              // offset of the hand from the virtual patient's target
  AxisPosition aim_;                // target of the person
  Help help_ = Help::kUnspecified;  // help stated with the last target
  AxisPosition seen_;               // device position of the last tick; no axes before the first
  double period_s_ = 0.0;           // last argument of advance()
  AxisPosition q_;                  // last result of advance()
  AxisVelocity qd_;
};

}  // namespace wholehand
