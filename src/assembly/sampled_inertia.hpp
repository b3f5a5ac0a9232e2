#pragma once

#include "assembly/models.hpp"
#include "control/certificate.hpp"

namespace wholehand {

/// Reduced inertia of the hand at its reference, and at the corners and middles of the ranges of
/// the device's rotations: every combination up to six of them, 729 drawn ones beyond. It does not
/// depend on where the base is: translations stay at rest.
struct SampledInertia {
  AxisMatrix at_reference;
  std::vector<AxisMatrix> samples;
};
[[nodiscard]] SampledInertia sampleInertia(const HandModel& hand, const DeviceModel& device);

/// What `certify` judges: device, hand, rendering and the walls of the exercise.
[[nodiscard]] CertificateInput certificateInput(const Models& models, double period_s);

}  // namespace wholehand
