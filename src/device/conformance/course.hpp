#pragma once

#include "device/conformance/axis_response.hpp"
#include "device/conformance/bench.hpp"

#include <array>
#include <functional>
#include <utility>
#include <vector>

namespace wholehand {

/// Shares of the effort limits, one an axis.
using Shares = std::array<double, WH_MAX_AXES>;

/// Commands to all axes and the samples meanwhile. Places count by the samples' own times, so that
/// a machine that is late changes nothing. One thread. Not real-time safe.
class Course {
 public:
  explicit Course(DriverBench& bench);

  /// Writes the shares and reads, once a millisecond, for that long or until `done`.
  void push(const Shares& shares, double seconds, const std::function<bool()>& done = {});
  /// Only reads.
  void watch(double seconds, const std::function<bool()>& done = {});
  /// Carries on after the device was closed or disabled: no effort is asked from now on.
  void askNothing();

  /// Since the course began.
  [[nodiscard]] double now_s() const;
  /// What `pushed` was given, and where `seen` was.
  [[nodiscard]] PushTrace trace(std::size_t pushed, std::size_t seen) const;
  [[nodiscard]] const std::vector<Sampled>& samples() const noexcept { return samples_; }
  [[nodiscard]] double timeOf(const Sampled& sampled) const;
  /// Share that was in force at a time.
  [[nodiscard]] double shareAt(std::size_t axis, double at_s) const;
  /// Newest position [m or rad]; 0 before the first sample.
  [[nodiscard]] double position(std::size_t axis) const;
  /// Mean speed over the last milliseconds.
  [[nodiscard]] double speed(std::size_t axis) const;
  /// Longest time without a sample from then on [s].
  [[nodiscard]] double longestGap_s(double from_s) const;
  /// Whether this machine left half the watchdog's time between two commands, or 10 ms between two
  /// samples: nothing is judged.
  [[nodiscard]] bool late() const;

 private:
  void take();

  DriverBench& bench_;
  std::int64_t from_ns_;
  std::vector<std::pair<double, Shares>> given_;
  std::vector<Sampled> samples_;
  double written_s_ = -1.0, longest_write_gap_s_ = 0.0;
};

}  // namespace wholehand
