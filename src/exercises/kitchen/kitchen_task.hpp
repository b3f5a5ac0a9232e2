#pragma once

#include "loop/core/real_time.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

namespace wholehand::kitchen {

/// Action that a step requires; kVerbs are the words in the file.
enum class Verb : std::int32_t { kReach, kTake, kMove, kHold, kPress, kPut, kLetGo };
inline constexpr const char* kVerbs[] = {"reach", "take", "move", "hold", "press", "put", "let_go"};

/// Maximum number of things of a task.
inline constexpr std::size_t kMostThings = 8;

/// A thing of the task: a body of the scene and the point where the hand takes or pushes it.
struct Thing {
  int body = -1;           ///< index in the scene
  Eigen::Vector3d grip_m;  ///< from the centre of mass, body axes
  /// Radius of the part that the hand closes around; for a rocker the distance from its hinge to
  /// the pushed point.
  double radius_m = 0.0;
  Pose start;             ///< pose of the body frame at q = 0
  Eigen::Vector3d com_m;  ///< body frame
  SceneJoint joint;       ///< valid for a body on a joint
  bool jointed = false;
};

/// One step of a task.
struct Step {
  Verb verb = Verb::kReach;
  int thing = 0;                          ///< index of Thing
  double within_m = 0.0;                  ///< reach: largest distance of the palm
  double force_n = 0.0;                   ///< take, press: least force
  double to = 0.0, tolerance = 0.0;       ///< move, hold: goal of q [m or rad]
  double for_s = 0.0;                     ///< hold, press: total time
  Eigen::Vector3d center_m, half_size_m;  ///< put: box for the centre of mass
};

/// Data of a task, from its file and scene. Immutable during play.
struct KitchenTask {
  std::string name;
  std::vector<Thing> things;
  std::vector<Step> steps;
  double par_s = 20.0;     ///< a step within this time gets all points
  double filter_hz = 5.0;  ///< low-pass of forces
};

/// Indices of ExerciseRecord::values; kValueNames are their names.
enum Value : std::int32_t {
  kInstruction,
  kScore,
  kDone,
  kStep,
  kSteps,
  kJoint,
  kGoalLow,
  kGoalHigh,
  kHandle,
  kSqueeze,
  kHeld,
  kTime,
  kPaused,
  kValues
};
inline constexpr const char* kValueNames[] = {
    "instruction", "score",    "done",      "step",   "steps",  "joint_q", "goal_low",
    "goal_high",   "handle_n", "squeeze_n", "held_s", "time_s", "paused"};
static_assert(std::size(kValueNames) == kValues);

/// Observation of the current step's thing in a tick.
struct ThingObservation {
  double palm_m = 0.0;     ///< distance of the palm
  double squeeze_n = 0.0;  ///< grip force
  double handle_n = 0.0;   ///< force of the hand
  double q = 0.0;          ///< joint position [m or rad]
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
};

/// State machine of a task: current step, time held in it, score. Pure; real-time safe.
class TaskSteps {
 public:
  /// @pre task outlives this and has a step
  explicit TaskSteps(const KitchenTask& task) : task_(task) {}

  void reset() noexcept;
  /// @return true when the current step ended
  WHOLEHAND_RT bool tick(const ThingObservation& seen, double elapsed_s) noexcept;

  [[nodiscard]] bool done() const noexcept { return step_ == static_cast<int>(task_.steps.size()); }
  /// Index of the current step; the number of steps when done.
  [[nodiscard]] int step() const noexcept { return step_; }
  /// The current step; the last one when done.
  [[nodiscard]] const Step& now() const noexcept;
  [[nodiscard]] double held_s() const noexcept { return held_s_; }
  /// Time since the start without pauses; stops when done.
  [[nodiscard]] double time_s() const noexcept { return time_s_; }
  /// Score, 0 .. 100: mean over all steps. A step counts fully within par_s and 0 from 3 par_s on.
  /// Steps not reached count 0.
  [[nodiscard]] double score() const noexcept;

 private:
  [[nodiscard]] bool holds(const Step& step, const ThingObservation& seen) const noexcept;

  const KitchenTask& task_;
  int step_ = 0;
  double held_s_ = 0.0, step_s_ = 0.0, time_s_ = 0.0;
  double earned_ = 0.0;  ///< sum over the steps, each 0 .. 1
};

}  // namespace wholehand::kitchen
