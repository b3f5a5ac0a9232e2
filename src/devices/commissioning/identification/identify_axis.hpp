#pragma once

#include "loop/core/expected.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace wholehand {

/// Prior knowledge of an axis before its measurement. SI; per radian for a rotation.
struct ExcitationPlan {
  double period_s = 1e-3;
  double lower = 0.0, upper = 0.0;  ///< usable travel [m or rad]
  double mass = 1.0;          ///< approximate moving mass, from the device file [kg or kg·m²]
  double effort_limit = 1.0;  ///< never exceeded [N or N·m]
  double offset = 0.0;        ///< effort that balances gravity [N or N·m]
  double duration_s = 20.0;
};

/// Excites one axis so that its mass, friction and delay become identifiable. In each of three
/// postures it makes a slow sweep to and fro. Then a soft spring follows a multisine of 0.3 to 5
/// Hz, with an added multisine of efforts of 6 to 40 Hz. The frequencies do not depend on the axis;
/// the amplitudes follow from its travel and effort limit.
class Excitation {
 public:
  explicit Excitation(const ExcitationPlan& plan);

  /// Effort of this tick, within ± effort_limit [N or N·m].
  /// @param position as read in this tick [m or rad]
  [[nodiscard]] double next(double position);
  [[nodiscard]] bool done() const { return tick_ >= ticks_; }
  [[nodiscard]] std::size_t ticks() const { return ticks_; }
  /// Posture of the tick that next() returns next: 0, 1, 2.
  [[nodiscard]] int posture() const;
  static constexpr int kPostures = 3;

 private:
  struct Target {
    double position = 0.0, velocity = 0.0;
  };
  [[nodiscard]] Target reference(double time_s, double centre) const;

  ExcitationPlan plan_;
  std::size_t ticks_ = 0, tick_ = 0;
  double stiffness_ = 0.0, damping_ = 0.0;
  double amplitude_ = 0.0;  ///< amplitude of the reference [m or rad]
  double effort_ = 0.0;     ///< amplitude of the multisine of efforts, its RMS times √2
  double last_ = 0.0, velocity_ = 0.0, wanted_ = 0.0;
};

/// Interval of a measured figure, in its own unit.
struct Interval {
  double lower = 0.0, upper = 0.0;

  [[nodiscard]] bool contains(double value) const { return value >= lower && value <= upper; }
  [[nodiscard]] double middle() const { return 0.5 * (lower + upper); }
  [[nodiscard]] double halfWidth() const { return 0.5 * (upper - lower); }
};

/// The smallest interval that contains both.
[[nodiscard]] inline Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.lower, b.lower), std::max(a.upper, b.upper)};
}

/// Commands to one axis and its positions, tick by tick. SI; per radian for a rotation.
struct AxisTrace {
  double period_s = 1e-3;
  /// Effort sent in tick k after position k was read; held until the next tick [N or N·m].
  std::vector<double> effort;
  std::vector<double> position;  ///< as read [m or rad]
  std::vector<int> posture;      ///< posture of each tick: 0, 1, 2 .. in the order visited
};

/// Resamples a trace to even periods. Positions are interpolated linearly between readings; each
/// effort is the mean of the efforts held over the period. A trace without delays is returned bit
/// by bit.
///
/// Refused, with the name of the axis: two ticks more than five periods apart, or more than a
/// twentieth of the ticks half a period off. Interpolation is then too inaccurate.
/// @param taken_s time at which each position was read and its effort sent, from 0 on, increasing
[[nodiscard]] Expected<AxisTrace> evenTrace(const AxisTrace& ticks,
                                            const std::vector<double>& taken_s,
                                            const std::string& axis);

/// Figures of one axis: m q̈ + b q̇ + f_c sign(q̇) + k q = f(t − d) + g. SI; per radian for a
/// rotation.
struct AxisFigures {
  double mass = 0.0;     ///< [kg or kg·m²]
  double damping = 0.0;  ///< viscous [N·s/m or N·m·s/rad]
  double coulomb = 0.0;  ///< dry friction [N or N·m]
  double gravity = 0.0;  ///< effort that holds the axis in mid-range [N or N·m]
  double delay_s = 0.0;  ///< from a command to its effect; any fraction of a period
};

/// Result of an identification: best estimate from all data, and intervals.
struct IdentifiedAxis {
  AxisFigures figures;
  Interval mass, damping, coulomb, gravity, delay_s;
  double resolution = 0.0;  ///< smallest change of position read [m or rad]
};

/// Identifies one axis by least squares on equally filtered signals. Both sides of the equation are
/// differences of samples that are exact for efforts held over a period; both pass the same
/// low-pass. The delay is scanned. Near standstill the dry friction is unknown, so both sides are
/// faded out there before the filter.
///
/// An interval is the hull of two sets. The first is the fit to all data, widened by its scatter
/// over fits that each omit one block of time (jackknife). The second contains fits to parts of the
/// data (each posture, slow and fast motion, low and high frequencies) and fits with Stribeck
/// friction, extrapolated by a factor of two. The parts agree where the equation above holds. Where
/// it does not (Stribeck friction, cogging, play), the intervals show by how much the parts
/// disagree. docs/adr/0026-commissioning-by-intervals.md.
///
/// Refused, with the name of the axis: a measurement that is too short, no motion, friction that
/// falls with speed, or intervals too wide for a certificate.
[[nodiscard]] Expected<IdentifiedAxis> identifyAxis(const AxisTrace& trace,
                                                    const std::string& axis);

}  // namespace wholehand
