#pragma once

#include "core/tick_record.hpp"
#include "replay/moved_time.hpp"
#include "telemetry/recording.hpp"

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// A part of an exercise that was finished.
struct FinishedPart {
  std::string event;   ///< that finished it: "drink_done", "band_held", "level_done"
  int index = -1;      ///< of the event
  double value = 0.0;  ///< of the event
  double from_s = 0.0, to_s = 0.0;
  MovedTime moved;
  /// Steps of a drink: index and litres.
  std::vector<std::pair<int, double>> steps;
  double stars = 0.0;  ///< the exercise's value at the end; 0 without one
};

/// Sums over the finished parts of one kind; all but `shared` and `others` are over the person's.
struct PartSums {
  std::uint64_t count = 0, shared = 0, others = 0;
  std::array<std::uint64_t, kHelps> helps{};  ///< parts by their most help
  double values = 0.0, stars = 0.0;
  std::vector<double> gained;  ///< rise of each result of the exercise from begin to end
};

/// Path of the hand in the room by the device's axes x, y and z; a device without them has none.
class HandPath {
 public:
  explicit HandPath(const std::vector<std::string>& axis_names);

  void add(const TickRecord& record);
  [[nodiscard]] const Eigen::Vector3d& place_m() const { return place_m_; }
  /// Length since the first tick, steps under 1 mm (resolution, tremor) left out.
  [[nodiscard]] double length_m() const { return length_m_; }
  [[nodiscard]] double speed_m_s() const { return speed_m_s_; }

 private:
  std::array<int, 3> axes_{};  ///< -1: no such axis
  bool begun_ = false;
  Eigen::Vector3d place_m_ = Eigen::Vector3d::Zero(), anchor_m_ = Eigen::Vector3d::Zero();
  double length_m_ = 0.0, speed_m_s_ = 0.0;
};

/// Finds the finished parts of an exercise by its events, and whose they are: moved_time.hpp.
/// Levels that begin again, or whose exercise the virtual patient begins again, are parts of their
/// own.
class PartLog {
 public:
  /// @pre meta outlives it
  explicit PartLog(const RecordingMeta& meta);

  /// Adds a tick. @param before time moved before it @param now the same with it
  void add(const TickRecord& record, const MovedTime& before, const MovedTime& now);

  /// "parts", "parts_left_out", "sums", "reaches" and "results".
  void write(nlohmann::json& out) const;

 private:
  enum Kind : int { kDrink, kBand, kLevel, kKinds };
  /// Where a part or a reach began.
  struct Begin {
    bool known = false;
    double time_s = 0.0;
    MovedTime moved;
    std::vector<double> results;
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
    double path_m = 0.0;
  };
  /// The sums are over the person's.
  struct Reaches {
    std::uint64_t count = 0, shared = 0, others = 0;
    double sum_s = 0.0, path_m = 0.0, straight_m = 0.0;
  };
  /// @param here the tick, as something that begins in it; a restart takes its counts to 0
  void addEvent(const ExerciseEvent& event, const TickRecord& record, Begin& here,
                const MovedTime& now);
  void finish(Kind kind, const ExerciseEvent& event, const TickRecord& record,
              const MovedTime& now);
  void reach(double time_s, const MovedTime& now);
  void keepResults(const TickRecord& record);
  [[nodiscard]] nlohmann::json resultsJson() const;

  const RecordingMeta& meta_;
  std::array<int, kKinds> ends_{};  ///< event that finishes a part; -1: the exercise has none
  std::vector<bool> begins_, frees_, reached_, restarts_;  ///< per event
  int step_done_ = -1, stars_value_ = -1;
  std::vector<int> result_values_;     ///< index of each result among the values; -1: none
  std::vector<double> results_;        ///< at the end of the tick before
  std::array<Begin, kKinds> began_{};  ///< of the part that is being done
  std::array<Begin, kKinds> after_{};  ///< end of the part before, for one that never began
  Begin free_;                         ///< since the hand is free to reach
  HandPath path_;
  double peak_m_s_ = 0.0;  ///< while the person moved the hand
  std::vector<std::pair<int, double>> steps_;
  std::array<PartSums, kKinds> sums_{};
  Reaches reaches_;
  std::vector<FinishedPart> parts_;
  std::uint64_t left_out_ = 0;
  MovedTime all_;
};

}  // namespace wholehand
