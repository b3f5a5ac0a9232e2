#pragma once

#include "devices/conformance/bench.hpp"

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// What an axis was given and where it was, each at its own time.
struct PushTrace {
  struct Given {
    double at_s = 0.0;
    double share = 0.0;  ///< of the effort limit, from then until the next
  };
  struct Seen {
    double at_s = 0.0;
    double position = 0.0;  ///< [m or rad]
  };
  std::vector<Given> given;
  std::vector<Seen> seen;
  double resolution = 0.0;  ///< of a position [m or rad]
};

/// q̈ = gain · (share(t − delay) − friction · sign q̇ + own) − damping · q̇ of an axis that nobody
/// holds.
struct AxisResponse {
  double gain = 0.0;         ///< acceleration that the whole limit gives [m/s² or rad/s²]
  double delay_s = 0.0;      ///< from a command to its effect
  double damping = 0.0;      ///< viscous [1/s]
  double friction = 0.0;     ///< dry, share of the limit
  double own = 0.0;          ///< what nobody asked for: its weight, or an effort of the drive
  double unexplained = 0.0;  ///< RMS of what this law leaves over RMS of the motion
};

/// Finds the response with the least residual, by least squares on the law integrated twice: exact
/// for efforts that hold between commands, whenever samples come. Not real-time safe.
/// @param longest_delay_s delays are tried from 0 to this
[[nodiscard]] AxisResponse findResponse(const PushTrace& trace, double longest_delay_s);

/// The same trace with one gain for each kind of push, at the delay that was found.
/// @param kind of a share of the limit: 0 to kinds − 1; −1: none
[[nodiscard]] std::vector<double> gainsByKind(const PushTrace& trace, double delay_s, int kinds,
                                              const std::function<int(double share)>& kind);

/// Acceleration and mean speed of a parabola through the places of a time span.
struct Parabola {
  double acceleration = 0.0, speed = 0.0;
  std::size_t places = 0;
};
[[nodiscard]] Parabola parabolaThrough(const PushTrace& trace, double from_s, double until_s);

/// The largest step between two places, beyond what the motion just before and after it explains
/// [m or rad]; 0: none above three steps of the resolution.
[[nodiscard]] double largestJump(const PushTrace& trace);

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

/// What was found by pushing one axis to and fro, by up to kEffortShare of its limit.
struct PushedAxis {
  bool asked = false;    ///< takes efforts; nothing else here counts otherwise
  bool late = false;     ///< this machine stood still every time: nothing counts either
  bool moved = false;    ///< the axis itself
  bool within = true;    ///< no axis left its travel
  double tried_s = 0.0;  ///< how long one push lasted
  AxisResponse response;
  double half_forth = 0.0, half_back = 0.0, back = 0.0;  ///< gains of smaller and of − pushes, over
                                                         ///< that of whole + pushes
  std::vector<double> along;     ///< response of each axis over its own, per share; 1 of itself
  double jump = 0.0;             ///< largest jump of its position [m or rad]
  double measured = 0.0;         ///< effort measured over the effort asked for; NaN: not measured
  double measured_late_s = 0.0;  ///< lag at which the two agree best
  std::vector<double> measured_elsewhere;  ///< RMS on other axes over the limit, over that asked
};

/// Pushes one axis after the other to and fro. @pre the device is enabled
[[nodiscard]] std::vector<PushedAxis> pushEveryAxis(DriverBench& bench);

/// Brings every axis whose response is known near the middle of its travel, and lets it rest there.
void bringToMiddle(DriverBench& bench, const std::vector<PushedAxis>& axes);

/// Waits until no axis moves. Returns the one that still does after a second; −1: none.
[[nodiscard]] int awaitRest(DriverBench& bench);

/// What is left of a push after it should be over, one an axis.
struct LeftOver {
  std::string not_judged;      ///< why; empty: the rest counts
  std::vector<double> share;   ///< effort of the push that is left over the effort of the push
  std::vector<double> pushed;  ///< effort of the push, share of the limit
  std::vector<double> own;     ///< effort whichever way the push went, share of the limit
};

/// Pushes all axes at once, forth and then back, ends the push by `stop`, and measures from the
/// motion after `allow_s` which effort is still there. What does not turn with the push, as a
/// weight or friction, cancels out.
/// @param stop ends the push; returns why it cannot
/// @param writes neutral goes on being written
[[nodiscard]] LeftOver leftAfter(DriverBench& bench, const std::vector<PushedAxis>& axes,
                                 double allow_s, bool writes,
                                 const std::function<std::string(Course&)>& stop);

}  // namespace wholehand
