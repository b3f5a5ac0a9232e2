#pragma once

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
  std::vector<std::string> value_names;  ///< of ExerciseRecord::values, at most kMaxExerciseValues
  std::vector<std::string> event_names;  ///< names of ExerciseEvent::type
  /// Index into value_names of the place in the level from which a session resumes after a rest:
  /// the value of kBeginAt. -1: every session begins at the start.
  int resume_value = -1;
  std::string json;  ///< data for its front end: liquids, recipe ...
};

/// Input of an exercise in a tick.
struct ExerciseInput {
  double period_s = 1e-3;
  /// The present tick so far: device, velocities, avatar, bodies, palm, closure, commands. Contacts
  /// are those of the last step.
  const TickRecord* observed = nullptr;
  const ArticulatedBody* hand = nullptr;  ///< link poses at observed->theta; null: not known
  const double* parameters = nullptr;     ///< current values, in the description's order
  const PoolReport* pool = nullptr;       ///< bodies of a game; null without slots for them
  bool may_push = true;  ///< false: holder silent or stop requested; f_e must fade out
};

/// A task for the person, which may add an effort to the rendering. It uses no sockets and no
/// clocks. Deterministic: the same inputs give the same bits.
class Exercise {
 public:
  Exercise() = default;
  Exercise(const Exercise&) = delete;
  Exercise& operator=(const Exercise&) = delete;
  virtual ~Exercise() = default;

  [[nodiscard]] const ExerciseDescription& description() const noexcept { return description_; }

  /// Resets to the start. Called when the loop is armed. Not real-time safe.
  virtual void reset() = 0;

  /// Query to the world for the next tick.
  [[nodiscard]] WHOLEHAND_RT virtual WorldQuery query() const noexcept = 0;

  /// Advances one tick: fills in effort (one value per axis), values, events, and bodies to be
  /// placed.
  WHOLEHAND_RT virtual void tick(const ExerciseInput& input, ExerciseRecord& out,
                                 BodyPlacements& placements) noexcept = 0;

  /// Makes a virtual patient who does this exercise; null where there is none. Not real-time safe.
  [[nodiscard]] virtual std::unique_ptr<Player> makePlayer(const PlayerTraits& traits) const = 0;

 protected:
  ExerciseDescription description_;  ///< filled in when it is made
};

/// Clears what a tick fills in: no effort, no wall, no values, nothing to be placed.
WHOLEHAND_RT inline void clear(ExerciseRecord& out, BodyPlacements& placements, int axes) noexcept {
  out = ExerciseRecord{};
  placements.count = 0;
  out.effort = AxisEffort(axes);
  out.wall_active = AxisFlag(axes);
  out.wall = AxisPosition(axes);
}

/// Adds an event; false where the tick's events are full. Real-time safe.
WHOLEHAND_RT inline bool tell(ExerciseRecord& out, std::int32_t type, int index,
                              double value) noexcept {
  if (out.event_count >= kMaxExerciseEvents) return false;
  out.events[out.event_count++] = {type, index, value};
  return true;
}

/// Obeys the tick's actions: pauses, goes on, begins `steps` again (once they are done, by any
/// action), which it tells as the event `restarted`. True where they began again. Real-time safe.
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
      tell(out, restarted, -1, 0.0);
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
