#pragma once

#include "loop/device/simulated/simulated_device.hpp"
#include "support/rig_tools.hpp"

/// A mechanism that nobody holds, flung into a fixed wall on the simulated clock.
namespace wholehand::test {

/// What is flung, and how.
struct Throw {
  std::string device = "lambda-pride", hand = "adult-median-right";
  std::string axis = "x";
  bool towards_upper = true;
  bool alone = false;        ///< the axis by itself; else all of them, with the whole hand
  double fingers_rad = 0.0;  ///< flexion at the beginning; 0: straight
  double circumduction_rad = 0.0;
  double speed_m_s = 0.6;     ///< when it is let go
  double effort_share = 0.5;  ///< pushed gently, the simulated hand is not left behind
  bool adaptive = true;       ///< else Φ K_dm = 0 on every axis
  bool palm_contact = true;   ///< else Φ of the arm is that of the fingers' efforts, Eq. (5)

  /// Of the flung axis, along the world.
  [[nodiscard]] Eigen::Vector3d ahead() const;
};

struct Bounce {
  double impact_m_s = 0.0;      ///< of the device, when the hand touches
  double stretch_m = 0.0;       ///< of the coupling's spring then: the hand lags behind the device
  double rebound_m_s = 0.0;     ///< of the device, fastest away from the wall
  double peak_n = 0.0;          ///< largest effort sent after the touch
  double phi = 0.0;             ///< largest Φ of the axis after the touch
  double depth_m = 0.0;         ///< of the hand's surface in the wall
  double tank_n = 0.0;          ///< largest effort of the energy tank on any axis
  Fault faults = Fault::kNone;  ///< the stopping ones
  double face_m = 0.0;          ///< of the hand, as it was let go

  [[nodiscard]] double share() const { return rebound_m_s / impact_m_s; }
};

/// The shipped device with its gains as shipped, but for what the throw says.
[[nodiscard]] Models thrown(const Throw& how);
/// The flung axis of these models.
[[nodiscard]] const DeviceAxis& flungAxis(const Models& m, const Throw& how);

/// Flung into a wall that the hand meets just after it was let go.
[[nodiscard]] Bounce slammed(const Throw& how);

/// The same throw with the damping and without.
struct Pair {
  Bounce with, without;
  [[nodiscard]] double loweredBy() const { return 1.0 - with.rebound_m_s / without.rebound_m_s; }
};
[[nodiscard]] Pair withAndWithout(Throw how);

}  // namespace wholehand::test
