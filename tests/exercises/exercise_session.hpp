#pragma once

#include "support/rig_tools.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::test {

/// A session of an exercise with its virtual patient, with commands before a tick.
struct ExerciseSession {
  std::unique_ptr<Rig> rig;
  std::vector<std::string> values, events;
  std::unique_ptr<TickRecord> record = std::make_unique<TickRecord>();
  std::function<void(const TickRecord&)> on_record;  ///< after each tick; empty: nothing

  explicit ExerciseSession(const ModelFiles& files, std::uint64_t seed = 7) {
    Models models = load(files);
    values = models.exercise->description().value_names;
    events = models.exercise->description().event_names;
    std::unique_ptr<Player> player = models.exercise->makePlayer({seed});
    rig = orThrow(buildRig(std::move(models), std::move(player), RigOptions{}));
    orThrow(rig->renderer->arm());
    record->tick = ~std::uint64_t{0};
  }

  void tick(Act act, double value, bool sends = true) {
    ++record->tick;
    record->time_s = 1e-3 * static_cast<double>(record->tick);
    record->command_count = sends ? 1 : 0;
    record->commands[0] = {};
    record->commands[0].type = CommandType::kAction;
    record->commands[0].index = static_cast<std::int32_t>(act);
    record->commands[0].value = value;
    rig->renderer->tick(1, *record);
    rig->listener->afterTick(*record);
    if (on_record) on_record(*record);
  }
  void run(int ticks) {
    for (int k = 0; k < ticks; ++k) tick(Act::kNext, 0.0, false);
  }
  void runUntil(const std::string& name, double value) {
    for (int k = 0; k < 60'000 && this->value(name) != value; ++k) run(1);
    ASSERT_EQ(this->value(name), value) << name;
  }
  [[nodiscard]] double value(const std::string& name) const {
    const auto at = std::find(values.begin(), values.end(), name) - values.begin();
    return record->exercise.values[at];
  }
  /// Number of these events in the last tick.
  [[nodiscard]] int told(const std::string& event) const {
    int count = 0;
    for (int i = 0; i < record->exercise.event_count; ++i) {
      count += events[record->exercise.events[i].type] == event ? 1 : 0;
    }
    return count;
  }
};

}  // namespace wholehand::test
