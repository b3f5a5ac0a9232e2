#pragma once

#include "loop/device/simulated/simulated_device.hpp"
#include "support/rig_tools.hpp"

/// Throws a mechanism that nobody holds into a fixed wall on the simulated clock.
namespace wholehand::test {

/// What is thrown, and how.
struct Throw {
  std::string device = "lambda-pride", hand = "adult-median-right";
  std::string axis = "x";
  bool towards_upper = true;
  bool alone = false;        ///< only the thrown axis; false: all axes with the whole hand
  double fingers_rad = 0.0;  ///< initial flexion; 0: straight
  double circumduction_rad = 0.0;
  double speed_m_s = 0.6;     ///< speed when it is let go
  double effort_share = 0.5;  ///< share of the effort limit for the throw; at 0.5 the simulated
                              ///< hand does not lag behind
  bool adaptive = true;       ///< false: Φ K_dm = 0 on every axis
  bool palm_contact = true;  ///< false: Φ of the arm comes from the fingers' efforts alone, Eq. (5)

  /// Direction of the throw in the world frame.
  [[nodiscard]] Eigen::Vector3d ahead() const;
};

struct Bounce {
  double impact_m_s = 0.0;  ///< speed of the device when the hand touches
  double stretch_m =
      0.0;  ///< stretch of the coupling's spring then: the hand lags behind the device
  double rebound_m_s = 0.0;     ///< largest speed of the device away from the wall
  double peak_n = 0.0;          ///< largest effort sent after the touch
  double phi = 0.0;             ///< largest Φ of the axis after the touch
  double depth_m = 0.0;         ///< largest depth of the hand's surface in the wall
  double tank_n = 0.0;          ///< largest effort of the energy tank on any axis
  Fault faults = Fault::kNone;  ///< stopping faults only
  double face_m = 0.0;          ///< position of the hand's front when it is let go

  [[nodiscard]] double share() const { return rebound_m_s / impact_m_s; }
};

/// The models as shipped, changed only as the throw says.
[[nodiscard]] Models thrown(const Throw& how);
/// The thrown axis of these models.
[[nodiscard]] const DeviceAxis& flungAxis(const Models& m, const Throw& how);

/// Runs the throw into a wall that the hand touches just after it is let go.
[[nodiscard]] Bounce slammed(const Throw& how);

/// The same throw with adaptive damping and without it.
struct Pair {
  Bounce with, without;
  [[nodiscard]] double loweredBy() const { return 1.0 - with.rebound_m_s / without.rebound_m_s; }
};
[[nodiscard]] Pair withAndWithout(Throw how);

}  // namespace wholehand::test
