#pragma once

#include "core/command.hpp"
#include "model/device_model.hpp"
#include "patient/limited_follower.hpp"
#include "patient/player.hpp"

#include <array>
#include <memory>

namespace wholehand {

struct SteeringConfig {
  double rate_rad_s = 20.0;  ///< of the filter a person's aim goes through: 0.1 s behind
  double speed_share = 0.5;  ///< of the device's speed limits, (0, 1]
  double blend_rad_s = 8.0;  ///< how soon the virtual patient is where it wants to be again
};

/// A virtual patient whose hand a person at a screen may take over, and give back.
///
/// The person's aims go through a critically damped filter of second order, held inside the
/// device's ranges and at a share of its speed limits, so that a mouse that jumps moves nobody's
/// arm faster than that. Position and velocity are continuous when the steering changes hands, in
/// both directions: the person begins where the hand is and as fast as it moves; of the virtual
/// patient's own aim the distance to it fades in the same way. Where aims stop coming, the last one
/// is held.
///
/// A person who pushes against something that gives way holds back: where an axis of the device
/// moves clearly faster than any aim, the intention goes on from where the axis is. Without that a
/// squeezing hand that slips off a bottle would pass the device's speed limit.
class SteeredPlayer final : public Player {
 public:
  /// @pre virtual_patient has the device's axes and is not null
  SteeredPlayer(std::unique_ptr<Player> virtual_patient, const DeviceModel& device,
                const SteeringConfig& config = {});

  [[nodiscard]] AxisPosition start() const override { return virtual_patient_->start(); }
  /// The virtual patient steers again, from the start.
  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord& record) noexcept override;

  /// Takes kSteer and kAim, nothing else. An aim counts while a person steers; one that has not the
  /// device's axes or is not finite is ignored. In the thread that ticks, before the tick.
  WHOLEHAND_RT void command(const Command& command) noexcept override;

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
  bool handed_back_ = false;  // the virtual patient has not advanced since
  Followers person_{};        // where the person steers the hand
  Followers apart_{};         // the hand less the virtual patient's aim
  AxisPosition aim_;          // of the person
  AxisPosition seen_;         // of the device, in the last tick; no axes before the first
  double period_s_ = 0.0;     // the last that advance() was given
  AxisPosition q_;            // the last that advance() gave
  AxisVelocity qd_;
};

}  // namespace wholehand
