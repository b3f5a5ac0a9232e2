#pragma once

#include "assembly/models.hpp"
#include "control/certificate/certificate.hpp"

namespace wholehand {

/// Reduced inertia of the hand at its reference, and at lower end, middle and upper end of the
/// device's rotations: every combination of up to six of them, 729 random ones beyond. Translations
/// stay at rest; the inertia does not depend on them.
struct SampledInertia {
  AxisMatrix at_reference;
  std::vector<AxisMatrix> samples;
};
[[nodiscard]] SampledInertia sampleInertia(const HandModel& hand, const DeviceModel& device);

/// Input of certify(): device, hand, rendering and the walls of the exercise.
[[nodiscard]] CertificateInput certificateInput(const Models& models, double period_s);

}  // namespace wholehand
