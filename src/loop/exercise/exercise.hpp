#pragma once

#include "loop/control/corridor.hpp"
#include "loop/core/body_order.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/core/world_query.hpp"
#include "loop/patient/player.hpp"

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

class ArticulatedBody;

/// Description of an exercise, read once. Names end with their unit.
struct ExerciseDescription {
  std::string name;  ///< "cocktail-bar"
  int level = 1;
  int levels = 1;
  double fade_out_s = 0.3;  ///< fade-out time of its effort
  std::vector<LiveParameter> parameters;
  /// Names of ExerciseRecord::values, at most kMaxExerciseValues.
  std::vector<std::string> value_names;
  std::vector<std::string> event_names;  ///< names of ExerciseEvent::type
  /// Index into value_names of the value that tells the place in the level. A session resumes there
  /// after a rest: it sends this value with kBeginAt. -1: every session begins at the start.
  int resume_value = -1;
  /// It measures the person's own movement: no prescription acts in it.
  bool measures_own_movement = false;
  std::string json;  ///< data for its front end: liquids, recipe ...
};

/// Input of an exercise in a tick.
struct ExerciseInput {
  double period_s = 1e-3;
  /// The record of the present tick so far: device, velocities, avatar, bodies, palm, closure,
  /// commands. Contacts are those of the last step.
  const TickRecord* observed = nullptr;
  const ArticulatedBody* hand = nullptr;  ///< link poses at observed->theta; null: not known
  const double* parameters = nullptr;     ///< current values, in the description's order
  /// Bodies of a game; null when the scene has no slots for them.
  const PoolReport* pool = nullptr;
  bool may_push = true;  ///< false: the client with the controls is silent or a stop is requested;
                         ///< f_e must fade out
};

/// A task for the person. It may add an effort to the rendering. It uses no sockets and no clocks.
/// Deterministic: the same inputs give the same bits.
class Exercise {
 public:
  Exercise() = default;
  Exercise(const Exercise&) = delete;
  Exercise& operator=(const Exercise&) = delete;
  virtual ~Exercise() = default;

  [[nodiscard]] const ExerciseDescription& description() const noexcept { return description_; }
  /// Where the movement under way goes; a prescription may have a corridor to it.
  [[nodiscard]] const MovementGoal& goal() const noexcept { return goal_; }

  /// Resets to the start. Called when the loop is armed. Not real-time safe.
  virtual void reset() = 0;

  /// Query to the world for the next tick.
  [[nodiscard]] WHOLEHAND_RT virtual WorldQuery query() const noexcept = 0;

  /// Advances one tick: fills in effort (one value per axis), values, events, and bodies to be
  /// placed.
  WHOLEHAND_RT virtual void tick(const ExerciseInput& input, ExerciseRecord& out,
                                 BodyPlacements& placements) noexcept = 0;

  /// Makes a virtual patient who does this exercise; null when there is none. Not real-time safe.
  [[nodiscard]] virtual std::unique_ptr<Player> makePlayer(const PlayerTraits& traits) const = 0;

 protected:
  /// Names the goal of a movement. It is taken at the movement's begin and stays until another one
  /// begins. @param to what the hand goes to; -1: none
  WHOLEHAND_RT void goFor(int to, const Eigen::Vector3d& at_m) noexcept {
    if (to >= 0 && to != goes_for_) {
      ++goal_.movement;
      goal_.at_m = Vec3::from(at_m);
    }
    goal_.known = to >= 0;
    goes_for_ = to;
  }
  void forgetGoal() noexcept {
    goal_ = MovementGoal{};
    goes_for_ = -1;
  }

  ExerciseDescription description_;  ///< filled in when it is made
  MovementGoal goal_;                ///< set in tick() and reset()

 private:
  int goes_for_ = -1;
};

/// Clears the output of a tick: no effort, no wall, no values, no bodies to place.
WHOLEHAND_RT inline void clear(ExerciseRecord& out, BodyPlacements& placements, int axes) noexcept {
  out = ExerciseRecord{};
  placements.count = 0;
  out.effort = AxisEffort(axes);
  out.wall_active = AxisFlag(axes);
  out.wall = AxisPosition(axes);
}

/// Adds an event; false when the tick already has kMaxExerciseEvents events. Real-time safe.
WHOLEHAND_RT inline bool addEvent(ExerciseRecord& out, std::int32_t type, int index,
                                  double value) noexcept {
  if (out.event_count >= kMaxExerciseEvents) return false;
  out.events[out.event_count++] = {type, index, value};
  return true;
}

/// Applies the tick's actions: pauses, resumes, or restarts `steps`. When all steps are done, any
/// other action restarts them too. A restart is reported as the event `restarted`. Returns true
/// when the steps were restarted. Real-time safe.
template <class Steps>
[[nodiscard]] WHOLEHAND_RT bool takeActions(const TickRecord& seen, Steps& steps, bool& paused,
                                            std::int32_t restarted, ExerciseRecord& out) noexcept {
  bool again = false;
  for (int i = 0; i < seen.command_count; ++i) {
    const Command& c = seen.commands[i];
    if (c.type != CommandType::kAction) continue;
    const auto action = static_cast<Act>(c.index);
    if (action == Act::kPause || action == Act::kResume) {
      paused = action == Act::kPause;
    } else if (action == Act::kRestart || steps.done()) {
      steps.reset();
      paused = false;
      again = true;
      addEvent(out, restarted, -1, 0.0);
    }
  }
  return again;
}

/// Stiffest wall of an exercise on an axis, with its live parameters at their upper ends. Covered
/// by the certificate.
struct ExerciseWall {
  int axis = 0;            ///< index into DeviceModel::axes
  double stiffness = 0.0;  ///< [N/m or N·m/rad]
  double damping = 0.0;    ///< [N·s/m or N·m·s/rad]
  /// Least resistance of a liquid in series; +inf: none [N·s/m or N·m·s/rad]
  double resistance = std::numeric_limits<double>::infinity();
};

}  // namespace wholehand
