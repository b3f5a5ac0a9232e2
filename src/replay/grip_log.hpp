#pragma once

#include <deque>
#include <vector>

namespace wholehand {

/// A hand that grips with less only touches.
inline constexpr double kLeastGrip_n = 1.0;

/// A stretch of time in which the hand gripped with at least kLeastGrip_n, for at least a second.
struct Grip {
  double from_s = 0.0, to_s = 0.0;
  /// Mean and standard deviation of the grip force, without the first and the last quarter of a
  /// second, in which it rises and falls.
  double mean_n = 0.0, deviation_n = 0.0;
  double largest_n = 0.0;
};

/// Finds the grips in a recording.
class GripLog {
 public:
  /// One tick.
  void add(double time_s, double force_n);
  /// Where ticks are missing a grip ends: nothing is known there.
  void end();
  /// Those that have ended.
  [[nodiscard]] const std::vector<Grip>& grips() const { return grips_; }

 private:
  struct Sample {
    double time_s, force_n;
  };
  void count(double force_n);

  std::vector<Grip> grips_;
  std::deque<Sample> waiting_;  ///< of the last quarter of a second
  Grip grip_;
  bool gripping_ = false;
  double count_ = 0.0, mean_n_ = 0.0, squares_n2_ = 0.0;  ///< of the samples that count (Welford)
};

}  // namespace wholehand
