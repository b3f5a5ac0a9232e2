#pragma once

#include "core/tick_record.hpp"
#include "replay/moved_time.hpp"
#include "replay/part_log.hpp"
#include "telemetry/recording.hpp"

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace wholehand {

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

  /// The person's touches (moved_time.hpp).
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
  void position(const Eigen::Vector3d& position_m, bool person);
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
