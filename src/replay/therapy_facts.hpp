#pragma once

#include "core/tick_record.hpp"
#include "replay/grip_log.hpp"
#include "replay/touch_log.hpp"
#include "telemetry/recording.hpp"

#include <nlohmann/json.hpp>

#include <vector>

namespace wholehand {

/// What the hand held, how hard and how steadily, and the limits in force, from every tick of a
/// recording.
class TherapyFacts {
 public:
  /// @pre meta outlives it
  explicit TherapyFacts(const RecordingMeta& meta);

  /// @param follows false when ticks are missing before this one
  void add(const TickRecord& record, bool follows);
  /// The facts as web/src/report/report_data.ts reads them. Ends grips and touches in progress.
  [[nodiscard]] nlohmann::json json();

 private:
  /// A value and the time of its change.
  struct Change {
    double time_s, value;
  };
  void addContacts(const TickRecord& record, bool grips);
  void addLimits(const TickRecord& record);
  [[nodiscard]] bool ofGame(std::size_t body) const;
  [[nodiscard]] nlohmann::json bodiesJson() const;
  [[nodiscard]] nlohmann::json touchesJson() const;
  [[nodiscard]] nlohmann::json limitsJson() const;

  const RecordingMeta& meta_;
  std::vector<TouchLog> bodies_;
  std::vector<int> grip_sides_;  ///< side of each capsule: fingers, thumb or palm
  int squeeze_value_ = -1;       ///< index among the exercise's values; -1: no grip force
  GripLog grips_;
  std::vector<std::vector<Change>> limits_;  ///< limits in force, per axis [N or N·m]
  double largest_force_n_ = 0.0, largest_force_s_ = 0.0;
};

}  // namespace wholehand
