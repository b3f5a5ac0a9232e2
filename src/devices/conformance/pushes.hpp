#pragma once

#include "devices/conformance/bench.hpp"

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Commands to an axis and its positions, each with its own time.
struct PushTrace {
  struct EffortChange {
    double at_s = 0.0;
    double share = 0.0;  ///< share of the effort limit, in force until the next
  };
  struct Observation {
    double at_s = 0.0;
    double position = 0.0;  ///< [m or rad]
  };
  std::vector<EffortChange> given;
  std::vector<Observation> seen;
  double resolution = 0.0;  ///< resolution of a position [m or rad]
};

/// Response of an axis that nobody holds: q̈ = gain · (share(t − delay) − friction · sign q̇ + own)
/// − damping · q̇.
struct AxisResponse {
  double gain = 0.0;         ///< acceleration caused by the whole limit [m/s² or rad/s²]
  double delay_s = 0.0;      ///< from a command to its effect
  double damping = 0.0;      ///< viscous [1/s]
  double friction = 0.0;     ///< dry friction, share of the limit
  double own = 0.0;          ///< effort that nobody commanded: the weight, or an effort of the
                             ///< drive
  double unexplained = 0.0;  ///< RMS of the residual over RMS of the motion
};

/// Finds the response with the smallest residual, by least squares on the law integrated twice.
/// This is exact for efforts held between commands, at any sample times. Not real-time safe.
/// @param longest_delay_s delays from 0 to this one are tried
[[nodiscard]] AxisResponse findResponse(const PushTrace& trace, double longest_delay_s);

/// Fits the trace with one gain for each kind of push, at a given delay.
/// @param kind returns the kind of a share of the limit: 0 to kinds − 1; −1: none
[[nodiscard]] std::vector<double> gainsByKind(const PushTrace& trace, double delay_s, int kinds,
                                              const std::function<int(double share)>& kind);

/// Acceleration and mean speed of a parabola through the positions of a time span.
struct Parabola {
  double acceleration = 0.0, speed = 0.0;
  std::size_t places = 0;
};
[[nodiscard]] Parabola parabolaThrough(const PushTrace& trace, double from_s, double until_s);

/// Largest step between two positions beyond the motion just before and after it [m or rad]; 0: no
/// step above three steps of the resolution.
[[nodiscard]] double largestJump(const PushTrace& trace);

/// Shares of the effort limits, one per axis.
using Shares = std::array<double, WH_MAX_AXES>;

/// Commands to all axes, and the samples in the same time. Positions count by the samples' own
/// times, so that a late machine changes nothing. One thread. Not real-time safe.
class PushSequence {
 public:
  explicit PushSequence(DriverBench& bench);

  /// Writes the shares and reads, once a millisecond, for that time or until `done` returns true.
  void push(const Shares& shares, double seconds, const std::function<bool()>& done = {});
  /// Reads without writing.
  void watch(double seconds, const std::function<bool()>& done = {});
  /// Continues after the device was closed or disabled: no effort is commanded from now on.
  void askNothing();

  /// Time since the course began [s].
  [[nodiscard]] double now_s() const;
  /// Trace with the commands to the axis `pushed` and the positions of the axis `seen`.
  [[nodiscard]] PushTrace trace(std::size_t pushed, std::size_t seen) const;
  [[nodiscard]] const std::vector<SampleRead>& samples() const noexcept { return samples_; }
  [[nodiscard]] double timeOf(const SampleRead& sampled) const;
  /// Share in force at a time.
  [[nodiscard]] double shareAt(std::size_t axis, double at_s) const;
  /// Newest position [m or rad]; 0 before the first sample.
  [[nodiscard]] double position(std::size_t axis) const;
  /// Mean speed over the last milliseconds.
  [[nodiscard]] double speed(std::size_t axis) const;
  /// Longest time without a sample since `from_s` [s].
  [[nodiscard]] double longestGap_s(double from_s) const;
  /// True when this machine let more than half the watchdog's timeout pass between two commands, or
  /// 10 ms between two samples. Nothing is judged then.
  [[nodiscard]] bool late() const;

 private:
  void take();

  DriverBench& bench_;
  std::int64_t from_ns_;
  std::vector<std::pair<double, Shares>> given_;
  std::vector<SampleRead> samples_;
  double written_s_ = -1.0, longest_write_gap_s_ = 0.0;
};

/// Result of pushing one axis to and fro, by up to kEffortShare of its limit.
struct PushedAxis {
  bool asked = false;    ///< the axis takes efforts; otherwise the other members are unused
  bool late = false;     ///< this machine stalled in every attempt; the other members are unused
  bool moved = false;    ///< the axis itself moved
  bool within = true;    ///< no axis left its travel
  double tried_s = 0.0;  ///< duration of one push
  AxisResponse response;
  double half_forth = 0.0, half_back = 0.0, back = 0.0;  ///< gains of smaller pushes and of −
                                                         ///< pushes, relative to that of whole +
                                                         ///< pushes
  std::vector<double> along;     ///< response of each axis relative to its own, per share; 1 for
                                 ///< this axis
  double jump = 0.0;             ///< largest jump of its position [m or rad]
  double measured = 0.0;         ///< measured effort relative to the commanded one; NaN: not
                                 ///< measured
  double measured_late_s = 0.0;  ///< lag at which the two agree best
  std::vector<double> measured_elsewhere;  ///< RMS on other axes relative to the limit, over the
                                           ///< commanded share
};

/// Pushes one axis after the other to and fro. @pre the device is enabled
[[nodiscard]] std::vector<PushedAxis> pushEveryAxis(DriverBench& bench);

/// Moves every axis whose response is known near the middle of its travel, and lets it rest there.
void bringToMiddle(DriverBench& bench, const std::vector<PushedAxis>& axes);

/// Waits until no axis moves. Returns an axis that still moves after a second; −1: none.
[[nodiscard]] int awaitRest(DriverBench& bench);

/// Effort that remains after a push should have ended, one element per axis.
struct LeftOver {
  std::string not_judged;      ///< reason; empty: the other members are valid
  std::vector<double> share;   ///< remaining effort of the push, relative to the push
  std::vector<double> pushed;  ///< effort of the push, share of the limit
  std::vector<double> own;     ///< effort independent of the direction of the push, share of the
                               ///< limit
};

/// Pushes all axes at once, forth and then back, ends the push by `stop`, and measures from the
/// motion after `allow_s` which effort remains. An effort that does not change sign with the push,
/// such as a weight or friction, cancels out.
/// @param stop ends the push; returns why it cannot
/// @param writes neutral is still written after `stop`
[[nodiscard]] LeftOver leftAfter(DriverBench& bench, const std::vector<PushedAxis>& axes,
                                 double allow_s, bool writes,
                                 const std::function<std::string(PushSequence&)>& stop);

}  // namespace wholehand
