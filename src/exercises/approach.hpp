#pragma once

#include "exercises/player_reach.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/patient/player.hpp"
#include "loop/patient/reach.hpp"

#include <Eigen/Core>

#include <optional>
#include <utility>

/// Postures, speeds and movements shared by the virtual patients of all exercises: the hand
/// approaches an object, closes around it and withdraws.
namespace wholehand::approach {

// Postures [rad]. Stretched fingers pass beside an object; half-bent fingers pass in front of it.
inline constexpr double kStretched = 8.0 * kDeg, kHalfBent = 65.0 * kDeg, kClosed = 155.0 * kDeg;
inline constexpr double kTurnedAside = 5.0 * kDeg, kOpposed = 20.0 * kDeg;
// The thumb presses less than the four fingers. A stronger thumb would tip over a free bottle.
inline constexpr double kThumbClosed = 27.0 * kDeg;
/// Thumb angle per finger angle while closing.
inline constexpr double kThumbAlong = kThumbClosed / (kClosed - kHalfBent);

// Peak speeds of a virtual patient at pace 1.
inline constexpr double kArm_m_s = 0.42, kFingers_rad_s = 4.0;

/// Builder of a target posture within the axes' ranges. Axes that no call sets keep their position.
/// Every call returns at(). Real-time safe.
class Goal {
 public:
  Goal(const PlayerReach& hand, const AxisPosition& from) noexcept : reach_(hand), at_(from) {}

  const AxisPosition& put(int axis, double value) noexcept;
  const AxisPosition& hand(double fingers, double turn, double thumb = 0.0) noexcept;
  const AxisPosition& base(const Eigen::Vector3d& at_m) noexcept;
  const AxisPosition& pose(const Eigen::Vector3d& base_m, double fingers, double turn) noexcept;
  /// Straight back with a half-bent hand; with a stretched one where isNarrow().
  const AxisPosition& drawBack() noexcept;
  [[nodiscard]] const AxisPosition& at() const noexcept { return at_; }

 private:
  const PlayerReach& reach_;
  AxisPosition at_;
};

/// x of the withdrawn hand [m].
[[nodiscard]] WHOLEHAND_RT double back_m(const PlayerReach& hand) noexcept;

/// Lateral distance from the palm's contact with an object of a hand that passes beside it.
inline constexpr double kBeside_m = 0.024;

/// True where the hand cannot draw back until its half-bent fingers are clear of an object: a
/// person's limits may be narrower. It then stays beside the object with stretched fingers.
[[nodiscard]] WHOLEHAND_RT bool isNarrow(const PlayerReach& hand) noexcept;

/// Start posture: a half-bent hand, nearly withdrawn.
[[nodiscard]] AxisPosition start(const PlayerReach& hand);
/// The same in front of an object; beside it where isNarrow(). @param base_m of the hand that
/// grips it
[[nodiscard]] AxisPosition startAt(const PlayerReach& hand, const Eigen::Vector3d& base_m);

/// Duration of a movement at pace 1 [s].
[[nodiscard]] WHOLEHAND_RT double durationTo(const PlayerReach& hand, const AxisPosition& from,
                                             const AxisPosition& goal) noexcept;

/// Limits the speed at which the reach opens the hand to `opening_rad_s`. Call it after
/// Reach::during().
WHOLEHAND_RT void limitOpening(const PlayerReach& hand, const AxisPosition& from,
                               double opening_rad_s, Reach& reach) noexcept;

/// A virtual patient whose hand reaches from pose to pose. After someone else has steered the hand,
/// the player continues from the hand's position.
class ReachingPlayer : public Player {
 public:
  [[nodiscard]] AxisPosition start() const override { return start_; }

 protected:
  explicit ReachingPlayer(PlayerReach hand) : hand_(std::move(hand)), start_(hand_.axes) {}

  /// Sets the hand to rest in the start pose.
  void toStart() noexcept;
  /// Begins a movement at `pace`; limitOpening() applies.
  /// @param palm_first the palm arrives before the fingers bend, so that they close around the
  /// object
  WHOLEHAND_RT void reachFor(const AxisPosition& goal, double pace, bool palm_first,
                             double opening_rad_s) noexcept;
  /// Call it first in advance(). True when the player takes the hand over from someone else.
  [[nodiscard]] WHOLEHAND_RT bool takesOver() noexcept {
    advanced_ = true;
    return std::exchange(lost_, false);
  }
  /// Call it first in onRecord(). True when someone else steered the hand; lost_ stays set until
  /// takesOver().
  WHOLEHAND_RT bool steeredByOthers(const TickRecord& record) noexcept;

  PlayerReach hand_;
  AxisPosition start_, q_;
  AxisVelocity qd_;
  Reach reach_;
  bool lost_ = false;  ///< someone else steered the hand

 private:
  bool advanced_ = false;  ///< takesOver() was called since the last record
};

/// A reaching player that also closes and opens the hand with a rate, while the arm rests.
class ClosingPlayer : public ReachingPlayer {
 protected:
  /// @param opening_rad_s fastest opening without a reflex @param pace of all movements
  ClosingPlayer(PlayerReach hand, double opening_rad_s, double pace)
      : ReachingPlayer(std::move(hand)), opening_rad_s_(opening_rad_s), pace_(pace) {}

  /// Begins a movement as ReachingPlayer does, with resting fingers.
  WHOLEHAND_RT void moveTo(const AxisPosition& goal, bool palm_first) noexcept;
  /// Advances the movement, or the hand with a wanted rate if there is one.
  WHOLEHAND_RT void moveOn(std::optional<double> wanted_rad_s, double period_s, AxisPosition& q,
                           AxisVelocity& qd) noexcept;
  /// Moves fingers and thumb with a low-passed wanted speed that goes to zero at the ends of the
  /// range. @param lower lower end for the fingers [rad]
  WHOLEHAND_RT void closeBy(double wanted_rad_s, double lower, double period_s) noexcept;

  const double opening_rad_s_, pace_;

 private:
  double rate_rad_s_ = 0.0;  ///< current speed of the fingers
};

}  // namespace wholehand::approach
