#pragma once

#include "exercises/player_reach.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/patient/player.hpp"
#include "loop/patient/reach.hpp"

#include <Eigen/Core>

#include <utility>

/// Postures, speeds and movements that virtual patients of all exercises have in common: how a hand
/// goes to a thing, closes around it and draws back.
namespace wholehand::approach {

// Postures [rad]. Stretched fingers pass beside a thing; half-bent ones pass in front of it.
inline constexpr double kStretched = 8.0 * kDeg, kHalfBent = 65.0 * kDeg, kClosed = 155.0 * kDeg;
inline constexpr double kTurnedAside = 5.0 * kDeg, kOpposed = 20.0 * kDeg;
// The thumb presses less than four fingers do. More would tip over a free bottle.
inline constexpr double kThumbClosed = 27.0 * kDeg;
/// Thumb per finger angle while they close.
inline constexpr double kThumbAlong = kThumbClosed / (kClosed - kHalfBent);

// Peak speeds of a person at pace 1.
inline constexpr double kArm_m_s = 0.42, kFingers_rad_s = 4.0;

/// Where the axes are to go, within their ranges; what is not named stays. Each answers at().
/// Real-time safe.
class Goal {
 public:
  Goal(const PlayerReach& hand, const AxisPosition& from) noexcept : reach_(hand), at_(from) {}

  const AxisPosition& put(int axis, double value) noexcept;
  const AxisPosition& hand(double fingers, double turn, double thumb = 0.0) noexcept;
  const AxisPosition& base(const Eigen::Vector3d& at_m) noexcept;
  const AxisPosition& pose(const Eigen::Vector3d& base_m, double fingers, double turn) noexcept;
  const AxisPosition& drawBack() noexcept;  ///< straight, the hand half-bent
  [[nodiscard]] const AxisPosition& at() const noexcept { return at_; }

 private:
  const PlayerReach& reach_;
  AxisPosition at_;
};

/// x of the withdrawn hand [m].
[[nodiscard]] WHOLEHAND_RT double back_m(const PlayerReach& hand) noexcept;

/// A half-bent hand, nearly withdrawn.
[[nodiscard]] AxisPosition start(const PlayerReach& hand);

/// Duration of a movement at pace 1 [s].
[[nodiscard]] WHOLEHAND_RT double durationTo(const PlayerReach& hand, const AxisPosition& from,
                                             const AxisPosition& goal) noexcept;

/// Opens the hand no faster than its reflexes allow. After Reach::during().
WHOLEHAND_RT void limitOpening(const PlayerReach& hand, const AxisPosition& from,
                               double opening_rad_s, Reach& reach) noexcept;

/// Moves fingers and thumb by a speed that is wanted, low-passed, and comes to rest at the ends.
/// @param rate_rad_s speed of the fingers, from call to call
/// @param pace of this person @param lower of the fingers
WHOLEHAND_RT void closeBy(const PlayerReach& hand, double wanted_rad_s, double pace, double lower,
                          double opening_rad_s, double period_s, double& rate_rad_s,
                          AxisPosition& q) noexcept;

/// A virtual patient whose hand reaches from pose to pose. Where someone else steered the hand, it
/// continues from there.
class ReachingPlayer : public Player {
 public:
  [[nodiscard]] AxisPosition start() const override { return start_; }

 protected:
  explicit ReachingPlayer(PlayerReach hand) : hand_(std::move(hand)), start_(hand_.axes) {}

  /// At rest in the start pose.
  void toStart() noexcept;
  /// Begins a movement at a person's pace; limitOpening() holds.
  /// @param palm_first the palm arrives before the fingers bend: they close around the thing
  WHOLEHAND_RT void reachFor(const AxisPosition& goal, double pace, bool palm_first,
                             double opening_rad_s) noexcept;
  /// First in advance(). True where the hand is to be taken over from someone else.
  [[nodiscard]] WHOLEHAND_RT bool takesOver() noexcept {
    advanced_ = true;
    return std::exchange(lost_, false);
  }
  /// First in see(). True where someone else steered the hand; lost_ lasts until takesOver().
  WHOLEHAND_RT bool steeredByOthers(const TickRecord& record) noexcept;

  PlayerReach hand_;
  AxisPosition start_, q_;
  AxisVelocity qd_;
  Reach reach_;
  bool lost_ = false;  ///< someone else steered the hand

 private:
  bool advanced_ = false;  ///< takesOver() was called since the last record
};

}  // namespace wholehand::approach
