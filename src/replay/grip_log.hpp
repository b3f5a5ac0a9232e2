#pragma once

#include "replay/moved_time.hpp"

#include <deque>
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

}  // namespace wholehand
