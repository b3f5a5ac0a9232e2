#pragma once

#include "core/live_parameter.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "core/world_query.hpp"
#include "patient/player.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// What an exercise says of itself, once. Names end with their unit.
struct ExerciseDescription {
  std::string name;  ///< "cocktail-bar"
  int level = 1;
  int levels = 1;
  double fade_out_s = 0.3;  ///< how long its effort takes to fade out
  std::vector<LiveParameter> parameters;
  std::vector<std::string> value_names;  ///< of ExerciseRecord::values, at most kMaxExerciseValues
  std::vector<std::string> event_names;  ///< of ExerciseEvent::type
  /// Index into value_names of the place in its level from which a session goes on after a rest:
  /// the value of ExerciseAction::kBeginAt. -1: every session begins at the start.
  int resume_value = -1;
  std::string json;  ///< what its front end needs to know: liquids, recipe ...
};

/// What the exercise sees in a tick.
struct ExerciseInput {
  double period_s = 1e-3;
  /// The tick so far: device, velocities, avatar, bodies, palm, closure, commands. Contacts are
  /// those of the last step.
  const TickRecord* observed = nullptr;
  const double* parameters = nullptr;  ///< present values, in the description's order
  bool may_push = true;  ///< false: the owner is silent or a stop began, f_e is to fade out
};

/// A task that the person does with the hand, and what it adds to what is felt. Knows neither
/// sockets nor clocks; deterministic: the same inputs give the same bits.
class Exercise {
 public:
  virtual ~Exercise() = default;

  [[nodiscard]] virtual const ExerciseDescription& description() const noexcept = 0;

  /// Back to the start. Called when the loop is armed. Not real-time safe.
  virtual void reset() = 0;

  /// What the next tick is to find out about the world.
  [[nodiscard]] WHOLEHAND_RT virtual WorldQuery query() const noexcept = 0;

  /// One tick: fills in effort (one value per axis), figures, events, and bodies to be placed.
  WHOLEHAND_RT virtual void tick(const ExerciseInput& input, ExerciseRecord& out,
                                 BodyPlacements& placements) noexcept = 0;

  /// A virtual patient who does this exercise; null where there is none. Not real-time safe.
  [[nodiscard]] virtual std::unique_ptr<Player> makePlayer(std::uint64_t seed) const = 0;
};

}  // namespace wholehand
