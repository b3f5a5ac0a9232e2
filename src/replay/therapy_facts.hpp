#pragma once

#include "loop/core/tick_record.hpp"
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
/// Whose a part of a session is (a drink, a level, a band of force, a reach, a grip, a touch): it
/// is the person's if the person moved the hand in the tick in which it began and in every tick
/// until the one in which it finished. If somebody else moved in some of them, it is shared: it is
/// named with the person's share of the time, and no sum counts it. If the person moved in none of
/// them, it is somebody else's. Ticks that are missing in the recording are nobody's word and do
/// not matter. A drink begins when a grasp of a dispenser begins or the first of it flows, a band
/// when the force first enters it, and a level with the first of its drinks or bands.
struct MovedTime {
  std::array<std::uint64_t, kMovers> by{};
  std::array<std::uint64_t, kHelps> helped{};  ///< of the person's time

  void add(Mover mover, Help help, std::uint32_t elapsed_periods);
  [[nodiscard]] std::uint64_t sum() const;
  [[nodiscard]] std::uint64_t persons() const {
    return by[static_cast<std::size_t>(Mover::kPerson)];
  }
  [[nodiscard]] bool isPersons() const { return persons() > 0 && persons() == sum(); }
  [[nodiscard]] bool isShared() const { return persons() > 0 && persons() < sum(); }
  /// The person's share, 0 .. 1.
  [[nodiscard]] double share() const;
  /// Who moved longest.
  [[nodiscard]] Mover mostly() const;
  /// The most help that was given in any tick of the person; kUnsaid where none was named.
  [[nodiscard]] Help mostHelp() const;
  /// "by", "share", "help" as web/src/report/report_data.ts reads them.
  [[nodiscard]] nlohmann::json json() const;
};

/// The time between two moments.
[[nodiscard]] MovedTime operator-(const MovedTime& end, const MovedTime& begin);

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

/// Finds the finished parts of an exercise by its events, and whose they are: therapy_facts.hpp.
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
    double peak_m_s = 0.0;  ///< since then
  };
  /// The sums, and the peak, are over the person's.
  struct Reaches {
    std::uint64_t count = 0, shared = 0, others = 0;
    double sum_s = 0.0, path_m = 0.0, straight_m = 0.0, peak_m_s = 0.0;
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
  std::vector<std::pair<int, double>> steps_;
  std::array<PartSums, kKinds> sums_{};
  Reaches reaches_;
  std::vector<FinishedPart> parts_;
  std::uint64_t left_out_ = 0;
  MovedTime all_;
};

/// A smaller grip force counts as a touch only.
inline constexpr double kLeastGrip_n = 1.0;

/// An interval of at least one second in which the grip force was at least kLeastGrip_n.
struct Grip {
  double from_s = 0.0, to_s = 0.0;
  /// Mean and standard deviation of the grip force, without the first and last quarter of a second,
  /// in which it rises and falls.
  double mean_n = 0.0, deviation_n = 0.0;
  double largest_n = 0.0;
  MovedTime moved;
};

/// Finds the grips in a recording.
class GripLog {
 public:
  /// Adds a tick. @param before time moved before it @param now the same with it
  void add(double time_s, double force_n, const MovedTime& before, const MovedTime& now);
  /// Ends the current grip, where ticks are missing.
  void end();
  /// Grips that have ended; each lasts a second at least, so that a day has 86,400 at most.
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
  double count_ = 0.0, mean_n_ = 0.0, squares_n2_ = 0.0;  ///< of accepted samples (Welford)
};

/// An interval in which the hand touched a body; gaps shorter than 0.2 s are bridged.
struct Touch {
  int body = 0;
  double from_s = 0.0, to_s = 0.0;
  double largest_force_n = 0.0;  ///< sum of the contact forces' magnitudes
  double held_s = 0.0;           ///< time with fingers on one side and thumb or palm on the other
  MovedTime moved;
};

/// One tick of a hand and a body.
struct BodyContact {
  double time_s = 0.0, duration_s = 0.0;
  double force_n = 0.0;  ///< sum of the contact forces' magnitudes
  bool held = false;
};

/// The hand's interaction with one body.
struct BodyStory {
  std::string name;
  std::vector<Touch> touches;
  /// Length of its path while the person moved the hand, steps under 1 mm (solver jitter) left out.
  double travelled_m = 0.0;

  /// The person's touches (therapy_facts.hpp).
  [[nodiscard]] std::vector<Touch> persons() const;
};

/// Follows one body through a recording.
class TouchLog {
 public:
  TouchLog(int body, std::string name) : body_(body) { story_.name = std::move(name); }

  /// Adds a tick in which the hand touches the body. @param before time moved before it @param now
  /// the same with it
  void contact(const BodyContact& contact, const MovedTime& before, const MovedTime& now);
  /// Adds the body's position of a tick. @param person the person moves the hand in it
  void position(const Eigen::Vector3d& position_m, double time_s, bool person);
  /// A slot of a game is empty: where the next body appears is no way.
  void leave() { here_ = false; }
  [[nodiscard]] bool wasThere() const { return seen_; }
  [[nodiscard]] const BodyStory& story() const { return story_; }

 private:
  int body_;
  BodyStory story_;
  MovedTime begin_;  ///< of the last touch
  bool seen_ = false, here_ = false;
  Eigen::Vector3d anchor_m_ = Eigen::Vector3d::Zero();
};

/// The strongest contact: sum of the contact forces' magnitudes in a tick.
struct StrongestContact {
  double force_n = 0.0, time_s = 0.0;
  std::uint64_t row = 0;
  Mover by = Mover::kNobody;
};

/// What the person did (therapy_facts.hpp), what the hand held, how hard and how steadily, and the
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
