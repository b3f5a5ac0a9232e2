#pragma once

#include "commissioning/bench.hpp"
#include "commissioning/identification/axis_trace.hpp"

#include <cstddef>
#include <vector>

/// What the steps let a device do. Every move holds the other axes where they are by soft springs.
namespace wholehand {

/// Natural frequency of those springs, with the mass of the device file.
inline constexpr double kSpring_hz = 2.0;

/// Where axes are held: their efforts come from springs about these positions.
class SoftHold {
 public:
  /// @param offset effort that carries each axis [N or N·m]
  SoftHold(const Bench& bench, std::vector<double> offset);

  /// Where each axis is to be; taken from the first call where it was not set [m or rad].
  std::vector<double> target;
  /// Sets the effort of every axis.
  void hold(Bench::Now& now);
  [[nodiscard]] double effort(std::size_t axis, double target_speed = 0.0) const;

 private:
  const Bench* bench_;
  std::vector<double> offset_, speed_, last_, position_;
};

/// How a slow push ended.
struct Push {
  std::size_t axis = 0;  ///< that moved most, of its range
  double moved = 0.0;    ///< of its range, with its sign; 0: nothing moved
  double share = 0.0;    ///< of the axis's effort limit that it took
};

/// Raises the effort of one axis, in the direction of `sign`, until something moves by 2 % of its
/// range; `moved` is 0 where nothing does at kCommissioningShare. No spring holds anything:
/// signs are not known.
[[nodiscard]] Expected<Push> pushSlowly(Bench& bench, std::size_t axis, double sign);

/// The effort that carries an axis where it is: sweeps slowly to and fro and takes the middle of
/// both directions, so that dry friction falls out [N or N·m].
[[nodiscard]] Expected<double> carryingEffort(Bench& bench, std::size_t axis,
                                              const std::vector<double>& offset);

/// Drives one axis slowly to a position. Refused: it does not get there.
[[nodiscard]] Expected<Done> driveTo(Bench& bench, std::size_t axis, double position,
                                     const std::vector<double>& offset);

/// Excites one axis (identification/excitation.hpp).
struct Excited {
  AxisTrace trace;
  std::vector<double> taken_s;  ///< when each of its ticks really came
  /// Response of every axis to it: acceleration times the root of its mass, over that of the
  /// excited one; 1 for itself. Two axes that an inertia c links respond with c / √(m₁ m₂).
  std::vector<double> response;
};
[[nodiscard]] Expected<Excited> excite(Bench& bench, std::size_t axis,
                                       const std::vector<double>& offset, double duration_s);

}  // namespace wholehand
