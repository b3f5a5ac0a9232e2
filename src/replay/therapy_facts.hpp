#pragma once

#include "core/tick_record.hpp"
#include "replay/grip_log.hpp"
#include "replay/moved_time.hpp"
#include "replay/part_log.hpp"
#include "replay/touch_log.hpp"
#include "telemetry/recording.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <vector>

namespace wholehand {

/// The strongest contact: sum of the contact forces' magnitudes in a tick.
struct StrongestContact {
  double force_n = 0.0, time_s = 0.0;
  std::uint64_t row = 0;
  Mover by = Mover::kNobody;
};

/// What the person did (moved_time.hpp), what the hand held, how hard and how steadily, and the
/// limits in force, from every tick of a recording.
class TherapyFacts {
 public:
  /// @pre meta outlives it
  explicit TherapyFacts(const RecordingMeta& meta);

  /// @param row of the recording @param follows false when ticks are missing before this one
  void add(const TickRecord& record, bool follows, std::uint64_t row = 0);
  /// The strongest contact while the person moved the hand; where there is none, of all others.
  [[nodiscard]] const StrongestContact& strongest() const {
    return strongest_.force_n > 0.0 ? strongest_ : strongest_of_others_;
  }
  /// The facts as web/src/report/report_data.ts reads them. Ends grips and touches in progress.
  [[nodiscard]] nlohmann::json json();

 private:
  /// A value and the time of its change.
  struct Change {
    double time_s, value;
  };
  /// Limits of an axis in force.
  struct Limits {
    std::vector<Change> changes;
    double between_s = 0.0;  ///< changes closer than this are one
    void add(double time_s, double value);
  };
  /// An interval in which the same one moved.
  struct Run {
    double from_s, to_s;
    Mover by;
  };
  void addMover(const TickRecord& record);
  void addContacts(const TickRecord& record, bool grips, std::uint64_t row);
  void addLimits(const TickRecord& record);
  [[nodiscard]] bool ofGame(std::size_t body) const;
  [[nodiscard]] nlohmann::json movedJson() const;
  [[nodiscard]] nlohmann::json bodiesJson() const;
  void writeTouches(nlohmann::json& out) const;
  void writeLimits(nlohmann::json& out) const;
  [[nodiscard]] nlohmann::json gripsJson() const;

  const RecordingMeta& meta_;
  MovedTime before_, now_;  ///< time moved before the present tick, and with it
  std::vector<Run> runs_;
  std::uint64_t runs_left_out_ = 0;
  PartLog parts_;
  std::vector<TouchLog> bodies_;
  std::vector<int> grip_sides_;  ///< side of each capsule: fingers, thumb or palm
  int squeeze_value_ = -1;       ///< index among the exercise's values; -1: no grip force
  GripLog grips_;
  std::vector<Limits> limits_;  ///< per axis [N or N·m]
  StrongestContact strongest_, strongest_of_others_;
};

}  // namespace wholehand
