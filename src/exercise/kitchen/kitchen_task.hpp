#pragma once

#include "model/scene/scene_model.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

namespace wholehand::kitchen {

/// What a step asks for; kVerbs are the words of the file.
enum class Verb : std::int32_t { kReach, kTake, kMove, kHold, kPress, kPut, kLetGo };
inline constexpr const char* kVerbs[] = {"reach", "take", "move", "hold", "press", "put", "let_go"};

/// Most things of a task.
inline constexpr std::size_t kMostThings = 8;

/// A thing of the task: a body of the scene and where the hand takes or pushes it.
struct Thing {
  int body = -1;           ///< index in the scene
  Eigen::Vector3d grip_m;  ///< from the centre of mass, body axes
  /// Of what the hand closes around; of a rocker, from its hinge to where it is pushed.
  double radius_m = 0.0;
  Pose start;             ///< of the body frame at q = 0
  Eigen::Vector3d com_m;  ///< body frame
  SceneJoint joint;       ///< of a body on a joint
  bool jointed = false;
};

/// One step of a task.
struct Step {
  Verb verb = Verb::kReach;
  int thing = 0;                          ///< index of Thing
  double within_m = 0.0;                  ///< reach: distance of the palm
  double force_n = 0.0;                   ///< take, press: at least this
  double to = 0.0, tolerance = 0.0;       ///< move, hold: of q [m or rad]
  double for_s = 0.0;                     ///< hold, press: so long in all
  Eigen::Vector3d center_m, half_size_m;  ///< put: box for the centre of mass
};

/// Data of a task, from its file and scene. Immutable during play.
struct KitchenTask {
  std::string name;
  std::vector<Thing> things;
  std::vector<Step> steps;
  double par_s = 20.0;     ///< a step within this time has all points
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

}  // namespace wholehand::kitchen
