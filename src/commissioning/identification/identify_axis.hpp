#pragma once

#include "commissioning/identification/axis_trace.hpp"
#include "commissioning/identification/interval.hpp"
#include "core/expected.hpp"

#include <string>

namespace wholehand {

/// m q̈ + b q̇ + f_c sign(q̇) + k q = f(t − d) + g of one axis. SI; per radian for a rotation.
struct AxisFigures {
  double mass = 0.0;     ///< [kg or kg·m²]
  double damping = 0.0;  ///< viscous [N·s/m or N·m·s/rad]
  double coulomb = 0.0;  ///< dry friction [N or N·m]
  double gravity = 0.0;  ///< effort that holds the axis in the middle of what it moved [N or N·m]
  double delay_s = 0.0;  ///< from a command to its effect, whole and broken periods
};

/// What was measured of one axis: the figures of all the data, and where the truth lies.
struct IdentifiedAxis {
  AxisFigures figures;
  Interval mass, damping, coulomb, gravity, delay_s;
  double resolution = 0.0;  ///< smallest change of position that was read [m or rad]
};

/// Least squares on equally filtered signals: both sides of the equation, as differences of the
/// samples that are exact for efforts held over a period, go through the same low-pass; the delay
/// is scanned. Where the axis is about to stand still its dry friction is not known: there both
/// sides are faded out before the filter.
///
/// The intervals are the hull of what parts of the data say - each posture, slow and fast motion,
/// low and high frequencies - each widened by its own scatter, from fits that leave out one block
/// of time after another (jackknife). Parts agree where the equation above is true; where it is not
/// (Stribeck, cogging, play) they disagree, and the intervals say by how much.
/// docs/adr/0026-measured-intervals.md.
///
/// Refused, by the name of the axis: too short, did not move, friction that leaves too little of
/// the effort, or a model whose parts disagree by more than what a certificate can use.
[[nodiscard]] Expected<IdentifiedAxis> identifyAxis(const AxisTrace& trace,
                                                    const std::string& axis);

}  // namespace wholehand
