#pragma once

#include "exercises/approach.hpp"
#include "exercises/kitchen/kitchen_task.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/hand_model.hpp"

#include <Eigen/Core>

#include <array>

namespace wholehand::kitchen {

/// Means by which the hand moves a thing. kGrasp closes the hand around it and carries it; kPush
/// pushes it with the tips of straight fingers; kSqueeze closes the fingers so that it moves
/// towards the palm.
enum class Means { kGrasp, kPush, kSqueeze };
inline constexpr const char* kMeans[] = {"grasp", "push", "squeeze"};

/// Describes how a hand without a wrist meets the thing of a step.
struct Meeting {
  Means means = Means::kGrasp;
  Eigen::Vector3d toward = Eigen::Vector3d::UnitX();  ///< push: ±x, ±y or ±z of the world
  /// From the grip to the contact point, body axes.
  Eigen::Vector3d side_m = Eigen::Vector3d::Zero();
  double sign = 1.0;  ///< sign of the required change of q
};

/// Derives the meeting from the verbs up to the next let_go, the thing and its joint. A thing with
/// a `take` step is grasped; otherwise the direction in which the grip must move decides. A thing
/// whose hinge is within radius_m of the grip is a rocker: the hand pushes it away from the person
/// at a point beside the hinge. Real-time safe.
/// @param step index of the step; larger values mean the last step
/// @param q joint position of the thing
/// @param center_m centre of mass of the thing [world]
/// @param beside +1 where the palm faces +y (a right hand), -1 where it faces -y
[[nodiscard]] WHOLEHAND_RT Meeting meetingOf(const KitchenTask& task, int step, double q,
                                             const Eigen::Vector3d& center_m,
                                             double beside) noexcept;

/// Table of the foremost points of the four fingertips along the world's axes, relative to the
/// hand's base, for a range of finger flexions. Allocates in the constructor only.
class Fingertips {
 public:
  /// @param fingers device axis that flexes all four fingers; -1: none
  Fingertips(const HandModel& hand, int fingers);

  /// @param toward ±x, ±y or ±z @param flexion_rad position of the axis; interpolated within 0 ..
  /// kMost_rad
  [[nodiscard]] WHOLEHAND_RT Eigen::Vector3d foremost(const Eigen::Vector3d& toward,
                                                      double flexion_rad) const noexcept;

 private:
  static constexpr int kPostures = 9;
  static constexpr double kMost_rad = 2.0;
  /// Foremost points along x, y, z, -x, -y, -z.
  using Points = std::array<Eigen::Vector3d, 6>;
  std::array<Points, kPostures> at_{};
};

/// A virtual patient who performs any task step by step: it goes beside the thing, meets it as
/// meetingOf() decides (grasp, push or squeeze), moves it, lets go and draws back. It has no
/// knowledge of a particular task. The seed sets the pace. Deterministic.
class KitchenPlayer final : public approach::ClosingPlayer {
 public:
  KitchenPlayer(const KitchenTask& task, const DeviceModel& device, const HandModel& hand,
                const PlayerTraits& traits);

  /// Meeting of a step's thing, and the offset of the hand's base from the contact point [m] for an
  /// open hand (grasp, squeeze) or a straight hand (push).
  struct MeetingPose {
    Meeting meeting;
    Eigen::Vector3d base_m = Eigen::Vector3d::Zero();
  };
  /// @param q joint position of the thing @param center_m centre of mass of the thing [world]
  [[nodiscard]] WHOLEHAND_RT MeetingPose metAt(int step, double q,
                                               const Eigen::Vector3d& center_m) const noexcept;

  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void onRecord(const TickRecord& record) noexcept override;

 private:
  enum class Phase { kDrawBack, kAlign, kEnter, kTouch, kClose, kCarry, kOpen, kLeave, kRest };

  void go(Phase phase) noexcept;
  void next() noexcept;
  void meet() noexcept;
  void close(double period_s) noexcept;
  void carry(double period_s) noexcept;
  [[nodiscard]] double closing() const noexcept;
  [[nodiscard]] double speedFactor() const noexcept;
  [[nodiscard]] const Step& now() const noexcept;
  [[nodiscard]] bool isHeld() const noexcept;
  [[nodiscard]] AxisPosition goalOf(Phase phase) const noexcept;
  [[nodiscard]] Eigen::Vector3d pointMet() const noexcept;
  [[nodiscard]] Eigen::Vector3d pointAt(double q) const noexcept;
  [[nodiscard]] Eigen::Vector3d baseFrom(const Meeting& meeting, const Thing& thing,
                                         double flexion_rad) const noexcept;
  [[nodiscard]] Eigen::Vector3d baseFromPoint(double flexion_rad) const noexcept;
  [[nodiscard]] Eigen::Vector3d pointAhead(double q) const noexcept;
  [[nodiscard]] Eigen::Vector3d baseNow() const noexcept;
  void moveBaseTo(const Eigen::Vector3d& base_m, double most_m) noexcept;

  KitchenTask task_;
  Fingertips fingertips_;
  Phase phase_ = Phase::kDrawBack;
  Meeting meeting_;
  int met_ = 0;  ///< index of the thing that the hand meets
  /// Offset from the contact pose to a pose clear of the thing.
  Eigen::Vector3d clear_m_ = Eigen::Vector3d::Zero();
  /// Offset of the base from the contact point at first contact.
  Eigen::Vector3d aside_m_ = Eigen::Vector3d::Zero();
  /// Path of a thing without joint: start point and unit direction.
  Eigen::Vector3d free_from_m_ = Eigen::Vector3d::Zero(), free_way_ = Eigen::Vector3d::UnitX();
  std::array<BodyState, kMostThings> bodies_{};  ///< states of the things in the last record
  double joint_q_ = 0.0, squeeze_n_ = 0.0, handle_n_ = 0.0;
  /// Intended q of the carried thing; without joint: distance along its path [m].
  double aim_q_ = 0.0;
  double flexion_rad_ = 0.0;  ///< observed flexion of the fingers
  double idle_s_ = 0.0;
  int step_ = 0;
  bool done_ = false;
};

}  // namespace wholehand::kitchen
