#pragma once

#include "commissioning/bench.hpp"
#include "commissioning/identification/identify_axis.hpp"

#include <cstddef>
#include <vector>

/// Moves of the commissioning steps. Every move holds the other axes in place by soft springs.
namespace wholehand {

/// Natural frequency of those springs, by the mass of the device file.
inline constexpr double kSpring_hz = 2.0;

/// Holds axes by springs about their target positions.
class SoftHold {
 public:
  /// @param offset effort that balances gravity on each axis [N or N·m]
  SoftHold(const Bench& bench, std::vector<double> offset);

  /// Target of each axis [m or rad]; initialised by the first hold() unless set.
  std::vector<double> target;
  /// Sets the effort of every axis.
  void hold(Bench::Now& now);
  [[nodiscard]] double effort(std::size_t axis, double target_speed = 0.0) const;

 private:
  const Bench* bench_;
  std::vector<double> offset_, speed_, last_, position_;
  double last_s_ = 0.0;
};

/// Result of a slow push.
struct Push {
  std::size_t axis = 0;  ///< axis that moved most, relative to its range
  double moved = 0.0;    ///< signed share of its range; 0: nothing moved
  double share = 0.0;    ///< share of the effort limit that was needed
};

/// Raises the effort of one axis in the direction of `sign` until something moves by 2 % of its
/// range; `moved` is 0 where nothing does at kCommissioningShare. No springs hold the axes, because
/// the signs are not known yet.
[[nodiscard]] Expected<Push> pushSlowly(Bench& bench, std::size_t axis, double sign);

/// Effort that balances an axis where it is [N or N·m]: sweeps slowly to and fro and takes the mean
/// of both directions, which cancels dry friction.
[[nodiscard]] Expected<double> carryingEffort(Bench& bench, std::size_t axis,
                                              const std::vector<double>& offset);

/// Drives one axis slowly to a position. Refused: it does not arrive.
[[nodiscard]] Expected<Done> driveTo(Bench& bench, std::size_t axis, double position,
                                     const std::vector<double>& offset);

/// Result of the excitation of one axis (identification/excitation.hpp).
struct Excited {
  AxisTrace trace;
  std::vector<double> taken_s;  ///< actual time of each tick
  /// Response of every axis: acceleration times the root of its mass, relative to the excited axis
  /// (1). Two axes coupled by an inertia c respond with c / √(m₁ m₂).
  std::vector<double> response;
};
[[nodiscard]] Expected<Excited> excite(Bench& bench, std::size_t axis,
                                       const std::vector<double>& offset, double duration_s);

}  // namespace wholehand
