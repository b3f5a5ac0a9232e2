#pragma once

#include "core/tick_record.hpp"
#include "model/device_model.hpp"
#include "model/hand/hand_model.hpp"
#include "model/patient/patient_config.hpp"
#include "model/scene/scene_model.hpp"
#include "patient/player.hpp"
#include "patient/reach.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// One contact of a rehearsal, from free space to full press.
struct RehearsalMove {
  int body = -1;                     ///< index into SceneModel::bodies
  std::vector<AxisPosition> starts;  ///< start poses; the first one without contact is used
  AxisPosition goal;                 ///< arm inside the body, hand closed or straight
};

/// Plans the moves that press a hand against bodies as hard as possible: the palm while all fingers
/// close, and the back of the fingers. Not real-time safe.
class RehearsalPlan {
 public:
  /// @param start initial pose of the session's hand; its base rotations are kept
  RehearsalPlan(const HandModel& hand, const DeviceModel& device, const SceneModel& scene,
                const AxisPosition& start);

  /// Moves that reach the body at its present place; none where it is out of the device's reach.
  /// @param observed the newest record; null: bodies are at their places in the scene
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
  Eigen::Vector3d palmar_;    ///< outward normal of the palm, unit
  Eigen::Vector3d pocket_m_;  ///< centre of the space in a half-closed hand
  Eigen::Vector3d back_m_;    ///< back of the straight fingers
};

/// A strong, compliant person instead of the patient, who makes the worst contacts.
[[nodiscard]] PatientConfig strongPerson(const DeviceModel& device);

/// Player of one move at a time, at a share of the device's speed: the hand takes its posture at
/// the start, then the arm presses.
class Rehearser final : public Player {
 public:
  explicit Rehearser(const DeviceModel& device) : device_(device) {}
  /// Sets the move that begins with the device's open(). Not real-time safe.
  void begin(const AxisPosition& from, const AxisPosition& goal);
  void press() noexcept;
  /// Moves on to another goal, from where the hand is.
  void moveTo(const AxisPosition& goal) noexcept;
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
