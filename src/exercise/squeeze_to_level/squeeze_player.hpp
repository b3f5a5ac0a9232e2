#pragma once

#include "exercise/cocktail_bar/bar_view.hpp"
#include "exercise/squeeze_to_level/squeeze_task.hpp"
#include "patient/player.hpp"
#include "patient/reach.hpp"

#include <cstdint>

namespace wholehand::squeeze_to_level {

/// A virtual patient who does the exercise by what a page shows: comes to the object from beside
/// it, closes until the force is within the goal band, lets go when told, draws back at the end.
/// The seed says how fast, and which part of a band is aimed for. Deterministic.
class SqueezePlayer final : public Player {
 public:
  SqueezePlayer(const BarView& view, std::uint64_t seed);

  [[nodiscard]] AxisPosition start() const override { return start_; }
  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord& record) noexcept override;

 private:
  /// In the order in which they are done; kSqueeze lasts until the exercise is done.
  enum class Doing { kDrawBack, kAlign, kEnter, kTouch, kSqueeze, kOpen, kLeave, kRest };

  void go(Doing doing) noexcept;
  void press(double period_s) noexcept;
  [[nodiscard]] AxisPosition goalOf(Doing doing) const noexcept;

  BarView view_;
  double pace_, share_;  ///< of every movement; of the band that is aimed for
  AxisPosition start_, q_;
  AxisVelocity qd_;
  Reach reach_;
  Doing doing_ = Doing::kDrawBack;
  Eigen::Vector3d grip_m_ = Eigen::Vector3d::Zero();  ///< where the hand's base is to be
  bool advanced_ = false;                             ///< since the last record
  bool lost_ = false, near_ = false;    ///< somebody else moved the hand; at the object
  bool done_ = false, let_go_ = false;  ///< as the last record said
  double squeeze_n_ = 0.0, wanted_n_ = 0.0;
  double rate_rad_s_ = 0.0;  ///< of the fingers' aim while they press
};

}  // namespace wholehand::squeeze_to_level
