#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/psychometrics/own_range.hpp"

#include <array>
#include <vector>

namespace wholehand::own_range {

inline constexpr int kMostDirections = 12;

/// A direction in which the person's own movement is measured.
struct Direction {
  int axis = -1;  ///< index into DeviceModel::axes; -1: the device lacks it, and it is not asked
  int sign = 1;   ///< +1: towards the upper end of the axis
  RangeRules rules;
};

struct MeasuringRules {
  std::vector<Direction> directions;  ///< at most kMostDirections
  int tries = 3;                      ///< in each direction, at most kMostTries
  double rest_s = 1.0;                ///< so long the hand rests before a try
  double return_s = 8.0;              ///< so long a hand is waited for that does not come back
  double try_s = 10.0;                ///< a try ends then ...
  double held_s = 1.0;                ///< ... or when it got no further for so long
};

/// Index of [[panel.instructions]]; direction i is kDirections + i.
enum Instruction { kRelax, kHold, kFinished, kFirstDirection };

/// What is known of a direction.
struct Measured {
  OwnEnd end;
  bool asked = false;  ///< all its tries were made, or it was skipped
};

/// Changes in one tick.
struct MeasuringChange {
  int tried = -1;  ///< direction of a try that ended in this tick; -1: none
  RangeTry result;
  int direction_done = -1;
  bool done = false;
};

/// State machine of the measurement: relax, move as far as possible, hold; some times in each
/// direction. A new try begins when the hand has come back by the least way of a try and rests.
/// Pure; real-time safe.
class Measuring {
 public:
  /// @pre rules outlives this
  explicit Measuring(const MeasuringRules& rules) noexcept : rules_(rules) { beginAt(0); }

  /// Begins at a direction, with nothing measured.
  WHOLEHAND_RT void beginAt(int direction) noexcept;
  WHOLEHAND_RT MeasuringChange tick(const AxisPosition& q, double elapsed_s) noexcept;
  /// Ends the direction under way with the tries that it has.
  WHOLEHAND_RT void skip() noexcept;
  /// Drops the try under way; it is made again.
  WHOLEHAND_RT void dropTry() noexcept;

  [[nodiscard]] bool done() const noexcept { return direction_ >= count(); }
  [[nodiscard]] int direction() const noexcept { return direction_; }
  [[nodiscard]] int tries() const noexcept { return tries_; }
  [[nodiscard]] WHOLEHAND_RT int instruction() const noexcept;
  [[nodiscard]] const Measured& measured(int direction) const noexcept {
    return measured_[direction];
  }

 private:
  [[nodiscard]] int count() const noexcept { return static_cast<int>(rules_.directions.size()); }
  [[nodiscard]] const Direction& now() const noexcept { return rules_.directions[direction_]; }
  void relax() noexcept;
  void endDirection() noexcept;
  void toAskedDirection() noexcept;
  [[nodiscard]] bool rests(const AxisPosition& q, double elapsed_s) noexcept;

  const MeasuringRules& rules_;
  int direction_ = 0, tries_ = 0;
  bool moving_ = false;
  double waited_s_ = 0.0, since_sample_s_ = 0.0;
  double rest_at_ = 0.0, rested_s_ = 0.0;  ///< where and for how long the hand rests
  Direction left_;                         ///< of the last try; no axis: there was none
  double left_at_ = 0.0;                   ///< position at its end
  RangeMeter meter_;
  std::array<RangeTry, kMostTries> try_{};
  std::array<Measured, kMostDirections> measured_{};
};

}  // namespace wholehand::own_range
