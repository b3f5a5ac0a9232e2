#pragma once

#include "exercise/cocktail_bar/bar_layout.hpp"
#include "exercise/kitchen/kitchen_task.hpp"
#include "patient/player.hpp"
#include "patient/reach.hpp"

namespace wholehand::kitchen {

/// A virtual patient who does a task step by step: goes beside the thing, closes the hand around
/// its grip, moves it along its joint, lets go, draws back. The seed sets the pace. Deterministic.
class KitchenPlayer final : public Player {
 public:
  KitchenPlayer(const KitchenTask& task, const DeviceModel& device, const HandModel& hand,
                const PlayerTraits& traits);

  [[nodiscard]] AxisPosition start() const override { return start_; }
  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord& record) noexcept override;

 private:
  enum class Phase { kDrawBack, kAlign, kEnter, kTouch, kClose, kCarry, kOpen, kLeave, kRest };

  void go(Phase phase) noexcept;
  void next() noexcept;
  void close(double period_s) noexcept;
  void carry(double period_s) noexcept;
  [[nodiscard]] AxisPosition goalOf(Phase phase) const noexcept;
  [[nodiscard]] Eigen::Vector3d gripAt(double q) const noexcept;
  void moveBaseTo(const Eigen::Vector3d& base_m, double period_s) noexcept;

  KitchenTask task_;
  BarLayout layout_;
  double opening_rad_s_;
  double pace_;
  AxisPosition start_, q_;
  AxisVelocity qd_;
  Reach reach_;
  Phase phase_ = Phase::kDrawBack;
  Eigen::Vector3d grip_m_ = Eigen::Vector3d::Zero();   ///< of the present thing, world
  Eigen::Vector3d aside_m_ = Eigen::Vector3d::Zero();  ///< base from the grip when it was taken
  double joint_q_ = 0.0;                               ///< as in the last record
  double aim_q_ = 0.0;                                 ///< where the person carries it now
  double squeeze_n_ = 0.0, rate_rad_s_ = 0.0;
  int step_ = 0;
  bool done_ = false, advanced_ = false, lost_ = false;
};

}  // namespace wholehand::kitchen
