#pragma once

#include "core/tick_record.hpp"
#include "model/device_model.hpp"
#include "model/hand_model.hpp"
#include "model/scene_model.hpp"
#include "patient/player.hpp"
#include "patient/reach.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// One contact of a rehearsal: from where the hand touches nothing to where it cannot go further.
struct RehearsalMove {
  int body = -1;                     ///< index into SceneModel::bodies
  std::vector<AxisPosition> starts;  ///< the first that the hand fits at is taken
  AxisPosition goal;                 ///< the arm's inside the body, the hand closed or straight
};

/// Where a hand must go to touch bodies as hard as it can: the palm against them while all fingers
/// close, and the back of the fingers. Plans only; not real-time safe.
class RehearsalPlan {
 public:
  /// @param start where the session's hand begins: its base rotations are kept
  RehearsalPlan(const HandModel& hand, const DeviceModel& device, const SceneModel& scene,
                const AxisPosition& start);

  /// The moves that reach the body of that index where it is now; none where the device cannot
  /// bring the hand to it. @param observed the newest record; null: bodies are where the scene has
  /// them
  [[nodiscard]] std::vector<RehearsalMove> movesFor(int index, const TickRecord* observed) const;

 private:
  [[nodiscard]] AxisPosition posture(double closed) const;
  [[nodiscard]] AxisPosition moved(const AxisPosition& q, const Eigen::Vector3d& by_m) const;
  [[nodiscard]] Eigen::Vector3d moveBy(const AxisPosition& q) const;
  [[nodiscard]] RehearsalMove move(int body, const Eigen::Vector3d& target_m,
                                   const Eigen::Vector3d& point_m, const Eigen::Vector3d& push,
                                   double closed) const;

  const DeviceModel& device_;
  const SceneModel& scene_;
  AxisPosition start_;
  // In the world, with the base translations at 0.
  Eigen::Vector3d palmar_;    ///< out of the palm, unit
  Eigen::Vector3d pocket_m_;  ///< what a half closed hand holds is here
  Eigen::Vector3d back_m_;    ///< of the fingers, straight
};

/// Does one move at a time, at a part of the device's speed: the hand takes its posture where it
/// starts, then the arm presses.
class Rehearser final : public Player {
 public:
  explicit Rehearser(const DeviceModel& device) : device_(device) {}
  /// What open() of the device begins. Not real-time safe.
  void begin(const AxisPosition& from, const AxisPosition& goal);
  void press() noexcept;
  [[nodiscard]] bool pressing() const noexcept { return pressing_; }
  [[nodiscard]] bool arrived() const noexcept { return reach_.done(); }

  [[nodiscard]] AxisPosition start() const override { return from_; }
  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord&) noexcept override {}

 private:
  void reachFor(const AxisPosition& goal) noexcept;

  const DeviceModel& device_;
  AxisPosition from_, goal_, q_;
  AxisVelocity qd_;
  bool pressing_ = false;
  Reach reach_;
};

}  // namespace wholehand
