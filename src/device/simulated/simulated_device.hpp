#pragma once

#include <vector>

#include "device/haptic_device.hpp"
#include "model/device_model.hpp"
#include "model/patient_config.hpp"
#include "patient/motion.hpp"

namespace wholehand {

/// A device that exists only as its file: per axis mass, viscous and Coulomb friction, encoder step,
/// output delay in samples, saturation at the effort limit, stops at the ends of the range; with a
/// virtual patient strapped to it. Right at any rate: the linear part is advanced by its exact
/// zero-order-hold solution, Coulomb friction with true sticking.
class SimulatedDevice final : public HapticDevice {
 public:
  /// The device starts at rest at the intention's start. @param period_s the loop's period
  SimulatedDevice(const DeviceModel& device, const PatientConfig& patient, Intention intention,
                  double period_s);

  [[nodiscard]] Expected<Done> open() override;
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override;
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override;
  void close() noexcept override;

  /// True (unquantised) state, for tests.
  [[nodiscard]] const AxisPosition& position() const noexcept;
  [[nodiscard]] const AxisVelocity& velocity() const noexcept;
};

}  // namespace wholehand
