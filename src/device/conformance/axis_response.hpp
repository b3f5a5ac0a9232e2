#pragma once

#include <functional>
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

}  // namespace wholehand
