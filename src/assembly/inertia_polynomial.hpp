#pragma once

#include "core/axis_array.hpp"
#include "model/device_model.hpp"
#include "model/hand/hand_model.hpp"
#include "telemetry/recording.hpp"

namespace wholehand {

/// M_r over the range of the device's rotations, by interpolation along each axis and over each
/// pair of axes; exact but for rounding where no three axes act on one digit. Empty when that takes
/// too many terms. Not for the tick.
[[nodiscard]] RecordedInertia inertiaPolynomial(const HandModel& hand, const DeviceModel& device,
                                                const AxisInertia& armature);

}  // namespace wholehand
