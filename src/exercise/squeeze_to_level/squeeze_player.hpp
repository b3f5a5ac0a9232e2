#pragma once

#include "exercise/approach.hpp"
#include "exercise/squeeze_to_level/squeeze_task.hpp"

#include <cstdint>

namespace wholehand::squeeze_to_level {

/// A virtual patient who follows what a page shows: approaches the object from beside it, closes
/// until the force is within the goal band, releases when asked, draws back at the end. The seed
/// sets the pace and the aimed part of a band. Deterministic.
class SqueezePlayer final : public approach::ReachingPlayer {
 public:
  SqueezePlayer(const BarLayout& layout, const PlayerTraits& traits);

  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord& record) noexcept override;

 private:
  /// Phases, in order; kSqueeze lasts until the exercise is done.
  enum class Phase { kDrawBack, kAlign, kEnter, kTouch, kSqueeze, kOpen, kLeave, kRest };

  void go(Phase phase) noexcept;
  void press(double period_s) noexcept;
  [[nodiscard]] AxisPosition goalOf(Phase phase) const noexcept;

  double opening_rad_s_;  ///< fastest opening without a reflex
  double pace_, share_;   ///< pace of movements; aimed share of a band
  Phase phase_ = Phase::kDrawBack;
  Eigen::Vector3d grip_m_ = Eigen::Vector3d::Zero();  ///< target of the hand's base
  bool near_ = false;                   ///< someone else steered the hand to the object
  bool done_ = false, let_go_ = false;  ///< as in the last record
  double squeeze_n_ = 0.0, wanted_n_ = 0.0;
  double rate_rad_s_ = 0.0;  ///< speed of the fingers' target while pressing
};

}  // namespace wholehand::squeeze_to_level
