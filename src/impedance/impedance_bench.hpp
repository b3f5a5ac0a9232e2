#pragma once

#include "assembly/rig.hpp"
#include "control/impedance.hpp"
#include "impedance/impedance_measurement.hpp"
#include "impedance/impedance_multisine.hpp"

#include <memory>

namespace wholehand {

/// Test bench of a device's impedance at one constant share Φ of the adaptive damping: the complete
/// renderer.
struct ImpedanceBench {
  Models models;
  std::unique_ptr<Rig> rig;  ///< in an empty world
  AxisPosition rest;         ///< the middle of every axis
  AxisMatrix inertia;        ///< inertia of the avatar there
  LineGrid grid;
  double phi = 0.0;
};

/// Device as in its file, or linearised: without dry friction and encoder steps.
enum class BenchDevice { kLinear, kAsBuilt };

/// @param phi 0 or 1  @pre device, rendering and hand of the models are loaded
[[nodiscard]] Expected<ImpedanceBench> makeImpedanceBench(const Models& models, double phi,
                                                          const ImpedanceOptions& how,
                                                          BenchDevice device);

/// The middle of every axis's range.
[[nodiscard]] AxisPosition middleOf(const DeviceModel& device);

/// Model of the bench's axis for the prediction, with a spring [N/m or N·m/rad] if not 0.
[[nodiscard]] FeltLoop feltLoop(const ImpedanceBench& bench, int axis, double stiffness);

/// A person with negligible impedance on one axis, who clamps the others.
[[nodiscard]] PatientConfig armFor(const DeviceModel& device, int axis, double lowest_hz);

/// Time until the transient of the push has decayed [s]; negative: never, or too long to wait.
[[nodiscard]] double settleTime(const AxisLoop& loop, ContactCase contact);

/// A world with a rigid stop or a spring at the axis's position. @pre not kFree
[[nodiscard]] std::unique_ptr<PhysicsWorld> contactWorld(const ImpedanceBench& bench, int axis,
                                                         ContactCase contact, double stiffness);

}  // namespace wholehand
