#pragma once

#include "exercises/approach.hpp"
#include "exercises/kitchen/kitchen_task.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/hand_model.hpp"

#include <Eigen/Core>

#include <array>

namespace wholehand::kitchen {

/// What the hand does to a thing: closes around it and carries it, pushes it with the tips of
/// straight fingers, or closes the fingers so that it comes towards the palm.
enum class Means { kGrasp, kPush, kSqueeze };
inline constexpr const char* kMeans[] = {"grasp", "push", "squeeze"};

/// How a hand without wrist meets the thing of a step.
struct Meeting {
  Means means = Means::kGrasp;
  Eigen::Vector3d toward = Eigen::Vector3d::UnitX();  ///< push: ±x, ±y or ±z of the world
  Eigen::Vector3d side_m = Eigen::Vector3d::Zero();   ///< from the grip to the point, body axes
  double sign = 1.0;                                  ///< of the change of q that is wanted
};

/// Derives it from the verbs up to the next let_go, the thing and its joint: what is to be taken is
/// grasped; else the direction in which the grip is to move decides. A hinge within radius_m of the
/// grip is a rocker, which is pushed away from the person beside the hinge. Real-time safe.
/// @param step index; the last one where it is beyond
/// @param q of the thing's joint
/// @param center_m of its mass, in the world
/// @param beside +1 where the palm faces +y (a right hand), -1 where it faces -y
[[nodiscard]] WHOLEHAND_RT Meeting meetingOf(const KitchenTask& task, int step, double q,
                                             const Eigen::Vector3d& center_m,
                                             double beside) noexcept;

/// Foremost points of the four fingertips along the axes of the world, from the hand's base, as the
/// fingers are more or less bent. Nothing allocates after construction.
class Fingertips {
 public:
  /// @param fingers the axis that flexes all four; -1: none
  Fingertips(const HandModel& hand, int fingers);

  /// @param toward ±x, ±y or ±z @param flexion_rad of the axis; interpolated within 0 .. kMost_rad
  [[nodiscard]] WHOLEHAND_RT Eigen::Vector3d foremost(const Eigen::Vector3d& toward,
                                                      double flexion_rad) const noexcept;

 private:
  static constexpr int kPostures = 9;
  static constexpr double kMost_rad = 2.0;
  /// Along x, y, z, -x, -y, -z.
  using Points = std::array<Eigen::Vector3d, 6>;
  std::array<Points, kPostures> at_{};
};

/// A virtual patient who does a task step by step: goes beside the thing, meets it as meetingOf()
/// says (closes the hand around it, pushes it with straight fingers, or squeezes it), moves it,
/// lets go, draws back. Nothing here is about one task. The seed sets the pace. Deterministic.
class KitchenPlayer final : public approach::ReachingPlayer {
 public:
  KitchenPlayer(const KitchenTask& task, const DeviceModel& device, const HandModel& hand,
                const PlayerTraits& traits);

  /// How a step's thing is met, and the base's place from the point that is met [m], while the hand
  /// is open (grasp, squeeze) or straight (push).
  struct Met {
    Meeting meeting;
    Eigen::Vector3d base_m = Eigen::Vector3d::Zero();
  };
  /// @param q of the thing's joint @param center_m of its mass, in the world
  [[nodiscard]] WHOLEHAND_RT Met metAt(int step, double q,
                                       const Eigen::Vector3d& center_m) const noexcept;

  void reset() override;
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void see(const TickRecord& record) noexcept override;

 private:
  enum class Phase { kDrawBack, kAlign, kEnter, kTouch, kClose, kCarry, kOpen, kLeave, kRest };

  void go(Phase phase) noexcept;
  void next() noexcept;
  void meet() noexcept;
  void close(double period_s) noexcept;
  void carry(double period_s) noexcept;
  [[nodiscard]] double closing() const noexcept;
  [[nodiscard]] double hurry() const noexcept;
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
  double opening_rad_s_;
  double pace_;
  Phase phase_ = Phase::kDrawBack;
  Meeting meeting_;
  int met_ = 0;                                        ///< index of the thing that is met
  Eigen::Vector3d clear_m_ = Eigen::Vector3d::Zero();  ///< from there to where the hand is clear
  Eigen::Vector3d aside_m_ = Eigen::Vector3d::Zero();  ///< base from the point when it was met
  /// Way of a thing without joint: from here, unit.
  Eigen::Vector3d free_from_m_ = Eigen::Vector3d::Zero(), free_way_ = Eigen::Vector3d::UnitX();
  std::array<BodyState, kMostThings> bodies_{};  ///< of the things, as in the last record
  double joint_q_ = 0.0, squeeze_n_ = 0.0, handle_n_ = 0.0;
  double aim_q_ = 0.0;  ///< where the person carries it now; of a thing without joint [m] of way
  double flexion_rad_ = 0.0;  ///< of the fingers, as seen
  double rate_rad_s_ = 0.0, idle_s_ = 0.0;
  int step_ = 0;
  bool done_ = false;
};

}  // namespace wholehand::kitchen
