#pragma once

#include "assembly/rig.hpp"
#include "control/impedance.hpp"
#include "impedance/impedance_measurement.hpp"
#include "impedance/impedance_multisine.hpp"

#include <memory>

namespace wholehand {

/// What the impedances of a device are measured on at one share Φ of the adaptive damping, which is
/// held: all of the renderer.
struct ImpedanceBench {
  Models models;
  std::unique_ptr<Rig> rig;  ///< in a world with nothing in it
  AxisPosition rest;         ///< the middle of every axis
  AxisMatrix inertia;        ///< of the avatar there
  LineGrid grid;
  double phi = 0.0;
};

/// A device as in its file, or a linear one: without dry friction and encoder steps.
enum class BenchDevice { kLinear, kAsBuilt };

/// @param phi 0 or 1  @pre device, rendering and hand of the models are loaded
[[nodiscard]] Expected<ImpedanceBench> makeImpedanceBench(const Models& models, double phi,
                                                          const ImpedanceOptions& how,
                                                          BenchDevice device);

/// The middle of every axis's range.
[[nodiscard]] AxisPosition middleOf(const DeviceModel& device);

/// The bench's axis as the prediction sees it, on a spring [N/m or N·m/rad] where there is one.
[[nodiscard]] FeltLoop feltLoop(const ImpedanceBench& bench, int axis, double stiffness);

/// A person who feels one axis through nothing, and holds the others as in a vice.
[[nodiscard]] PatientConfig armFor(const DeviceModel& device, int axis, double lowest_hz);

/// How long until what began with the push has died away [s]; negative: never, or longer than
/// anybody would wait.
[[nodiscard]] double settleTime(const AxisLoop& loop, ContactCase contact);

/// A world in which the axis meets a rigid stop or a spring, where it stands. @pre not kFree
[[nodiscard]] std::unique_ptr<PhysicsWorld> contactWorld(const ImpedanceBench& bench, int axis,
                                                         ContactCase contact, double stiffness);

}  // namespace wholehand
