#pragma once

#include "loop/core/active_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/psychometrics/answer_log.hpp"
#include "record/recording.hpp"

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Time by who moved the hand [periods].
///
/// A part of a session (a drink, a level, a band of force, a reach, a grip, a touch) is the
/// person's if the person moved the hand in the tick in which it began and in every tick until the
/// one in which it finished. It is shared if somebody else moved the hand in some of these ticks:
/// it is listed with the person's share of the time, and no sum includes it. It is somebody else's
/// if the person moved the hand in none of them. Ticks that are missing in the recording do not
/// matter. A drink begins when a grasp of a dispenser begins or liquid first flows, a band when the
/// force first enters it, and a level with its first drink or band.
struct MovedTime {
  std::array<std::uint64_t, kMovers> by{};
  std::array<std::uint64_t, kHelps> helped{};  ///< part of the person's time, by help

  void add(Mover mover, Help help, std::uint32_t elapsed_periods);
  [[nodiscard]] std::uint64_t sum() const;
  [[nodiscard]] std::uint64_t persons() const {
    return by[static_cast<std::size_t>(Mover::kPerson)];
  }
  [[nodiscard]] bool isPersons() const { return persons() > 0 && persons() == sum(); }
  [[nodiscard]] bool isShared() const { return persons() > 0 && persons() < sum(); }
  /// The person's share of the time, 0 to 1.
  [[nodiscard]] double share() const;
  /// Who moved the hand for the longest time.
  [[nodiscard]] Mover mostly() const;
  /// The greatest help in any tick of the person; kUnspecified where none was recorded.
  [[nodiscard]] Help mostHelp() const;
  /// The fields "by", "share", "help" as web/src/report/report_data.ts reads them.
  [[nodiscard]] nlohmann::json json() const;
};

/// The time between two moments.
[[nodiscard]] MovedTime operator-(const MovedTime& end, const MovedTime& begin);

/// A finished part of an exercise.
struct FinishedPart {
  std::string event;   ///< event that finished it: "drink_done", "band_held", "level_done"
  int index = -1;      ///< index of that event
  double value = 0.0;  ///< value of that event
  double from_s = 0.0, to_s = 0.0;
  MovedTime moved;
  /// Steps of a drink: index and volume [l].
  std::vector<std::pair<int, double>> steps;
  double stars = 0.0;  ///< the exercise's value "stars" at the end; 0 without one
};

/// Sums over the finished parts of one kind. All except `shared` and `others` include only the
/// person's parts.
struct PartSums {
  std::uint64_t count = 0, shared = 0, others = 0;
  std::array<std::uint64_t, kHelps> helps{};  ///< number of parts, by their greatest help
  double values = 0.0, stars = 0.0;
  std::vector<double> gained;  ///< increase of each result of the exercise from begin to end
};

/// Path of the hand in space from the device's axes x, y and z; zero for a device without them.
class HandPath {
 public:
  explicit HandPath(const std::vector<std::string>& axis_names);

  void add(const TickRecord& record);
  [[nodiscard]] const Eigen::Vector3d& place_m() const { return place_m_; }
  /// Path length since the first tick, without steps under 1 mm (resolution, tremor).
  [[nodiscard]] double length_m() const { return length_m_; }
  [[nodiscard]] double speed_m_s() const { return speed_m_s_; }

 private:
  std::array<int, 3> axes_{};  ///< index of x, y, z; -1: no such axis
  bool begun_ = false;
  Eigen::Vector3d place_m_ = Eigen::Vector3d::Zero(), anchor_m_ = Eigen::Vector3d::Zero();
  double length_m_ = 0.0, speed_m_s_ = 0.0;
};

/// Finds the finished parts of an exercise by its events, and whose they are (MovedTime). A level
/// that is restarted, by whomever, is a new part.
///
/// A reach begins when the person lets go or finishes a step, and ends when the hand takes hold or
/// the force enters a band. A pause or an absence ends it without a result, and what the exercise
/// lets go of then, or takes hold of again afterwards, is no reach. Nor is a change that took less
/// than 0.1 s, or taking hold of something without a movement of 1 mm: the hand was there already.
class ExerciseParts {
 public:
  /// @pre meta outlives this object
  explicit ExerciseParts(const RecordingMeta& meta);

  /// Adds a tick. @param before time moved before this tick @param now time moved including it
  /// @param interrupted the tick is in a pause or an absence (ActiveTime::interrupted())
  void add(const TickRecord& record, const MovedTime& before, const MovedTime& now,
           bool interrupted);

  /// Writes "parts", "parts_left_out", "sums", "reaches" and "results".
  void write(nlohmann::json& out) const;

 private:
  enum Kind : int { kDrink, kBand, kLevel, kKinds };
  /// State at the begin of a part or a reach.
  struct Begin {
    bool known = false;
    double time_s = 0.0;
    MovedTime moved;
    std::vector<double> results;
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
    double path_m = 0.0;
    double peak_m_s = 0.0;  ///< peak speed since then
  };
  /// Sums over reaches. All except `shared` and `others` include only the person's reaches.
  struct Reaches {
    std::uint64_t count = 0, shared = 0, others = 0;
    double sum_s = 0.0, path_m = 0.0, straight_m = 0.0, peak_m_s = 0.0;
  };
  /// Handles an event.
  /// @param here this tick as the begin of a part; a restart sets its counts to 0
  /// @param interrupted the event frees no hand
  void addEvent(const ExerciseEvent& event, const TickRecord& record, Begin& here,
                const MovedTime& now, bool interrupted);
  void finish(Kind kind, const ExerciseEvent& event, const TickRecord& record,
              const MovedTime& now);
  void reach(double time_s, const MovedTime& now, bool takes_hold);
  void keepResults(const TickRecord& record);
  [[nodiscard]] nlohmann::json resultsJson() const;

  const RecordingMeta& meta_;
  std::array<int, kKinds> ends_{};  ///< event type that finishes a part; -1: the exercise has none
  std::vector<bool> begins_, frees_, reached_, restarts_;  ///< by event type
  int step_done_ = -1, engaged_ = -1, stars_value_ = -1;
  std::vector<int> result_values_;     ///< index of each result among the values; -1: none
  std::vector<double> results_;        ///< results at the end of the previous tick
  std::array<Begin, kKinds> began_{};  ///< begin of the part under way
  std::array<Begin, kKinds> after_{};  ///< end of the previous part, used for a part without a
                                       ///< begin
  Begin free_;                         ///< since when the hand is free to reach
  HandPath path_;
  std::vector<std::pair<int, double>> steps_;
  std::array<PartSums, kKinds> sums_{};
  Reaches reaches_;
  std::vector<FinishedPart> parts_;
  std::uint64_t left_out_ = 0;
  MovedTime all_;
};

/// An interval of at least one second in which the grip force was at least kLeastGrip_n.
struct Grip {
  double from_s = 0.0, to_s = 0.0;
  /// Mean and standard deviation of the grip force, without the first and last quarter of a second,
  /// in which the force rises and falls.
  double mean_n = 0.0, deviation_n = 0.0;
  double largest_n = 0.0;
  MovedTime moved;
};

/// Finds the grips in a recording.
class GripLog {
 public:
  /// Adds a tick. @param before time moved before this tick @param now time moved including it
  void add(double time_s, double force_n, const MovedTime& before, const MovedTime& now);
  /// Ends the current grip; called where ticks are missing.
  void end();
  /// Grips that have ended. Each lasts at least a second, so a day has at most 86,400.
  [[nodiscard]] const std::vector<Grip>& grips() const { return grips_; }

 private:
  struct Sample {
    double time_s, force_n;
  };
  void count(double force_n);

  std::vector<Grip> grips_;
  std::deque<Sample> waiting_;  ///< samples of the last quarter of a second
  Grip grip_;
  MovedTime begin_;
  bool gripping_ = false;
  double count_ = 0.0, mean_n_ = 0.0, squares_n2_ = 0.0;  ///< statistics of accepted samples
                                                          ///< (Welford)
};

/// An interval in which the hand touched a body; gaps shorter than 0.2 s are bridged.
struct Touch {
  int body = 0;
  double from_s = 0.0, to_s = 0.0;
  double largest_force_n = 0.0;  ///< sum of the contact forces' magnitudes
  double held_s = 0.0;           ///< time with fingers on one side and thumb or palm on the other
  MovedTime moved;
};

/// Contact of the hand with a body in one tick.
struct BodyContact {
  double time_s = 0.0, duration_s = 0.0;
  double force_n = 0.0;  ///< sum of the contact forces' magnitudes
  bool held = false;
};

/// The hand's interaction with one body.
struct BodyTimeline {
  std::string name;
  std::vector<Touch> touches;
  /// Path length of the body while the person moved the hand, without steps under 1 mm (solver
  /// jitter).
  double travelled_m = 0.0;

  /// Touches that are the person's (MovedTime).
  [[nodiscard]] std::vector<Touch> persons() const;
};

/// Follows one body through a recording.
class BodyContacts {
 public:
  BodyContacts(int body, std::string name) : body_(body) { timeline_.name = std::move(name); }

  /// Adds a tick in which the hand touches the body. @param before time moved before this tick
  /// @param now time moved including it
  void contact(const BodyContact& contact, const MovedTime& before, const MovedTime& now);
  /// Adds the body's position in a tick. @param person the person moves the hand in this tick
  void position(const Eigen::Vector3d& position_m, double time_s, bool person);
  /// Records that the game's slot is empty: the jump to the place of the next body is not part of
  /// the path.
  void leave() { here_ = false; }
  [[nodiscard]] bool wasThere() const { return seen_; }
  [[nodiscard]] const BodyTimeline& timeline() const { return timeline_; }

 private:
  int body_;
  BodyTimeline timeline_;
  MovedTime begin_;  ///< time moved at the begin of the last touch
  bool seen_ = false, here_ = false;
  Eigen::Vector3d anchor_m_ = Eigen::Vector3d::Zero();
};

/// The strongest contact: largest sum of the contact forces' magnitudes in a tick.
struct StrongestContact {
  double force_n = 0.0, time_s = 0.0;
  std::uint64_t row = 0;
  Mover by = Mover::kNobody;
};

/// Collects from every tick of a recording what the person did (MovedTime), what the hand held, how
/// strongly and steadily, and the limits in force.
class TherapyFacts {
 public:
  /// @pre meta outlives this object
  explicit TherapyFacts(const RecordingMeta& meta);

  /// Adds a tick.
  /// @param row index in the recording @param follows false when ticks are missing before this one
  void add(const TickRecord& record, bool follows, std::uint64_t row = 0);
  /// The strongest contact while the person moved the hand; without any, the strongest of all
  /// others.
  [[nodiscard]] const StrongestContact& strongest() const {
    return strongest_.force_n > 0.0 ? strongest_ : strongest_of_others_;
  }
  [[nodiscard]] const ActivePeriods& active() const { return active_.periods(); }
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
    double between_s = 0.0;  ///< shortest time between two kept changes
    void add(double time_s, double value);
  };
  /// An interval in which the same one moved the hand.
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
  MovedTime before_, now_;  ///< time moved before the present tick, and including it
  ActiveTime active_;
  std::vector<Run> runs_;
  std::uint64_t runs_left_out_ = 0;
  ExerciseParts parts_;
  AnswerLog answers_;
  std::vector<BodyContacts> bodies_;
  std::vector<int> grip_sides_;  ///< side of each capsule: fingers, thumb or palm
  int squeeze_value_ = -1;       ///< index of the grip force among the exercise's values; -1: none
  GripLog grips_;
  std::vector<Limits> limits_;  ///< per axis [N or N·m]
  StrongestContact strongest_, strongest_of_others_;
};

}  // namespace wholehand
