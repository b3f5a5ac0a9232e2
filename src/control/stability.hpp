#pragma once

#include "control/coupling_gains.hpp"
#include "model/device_model.hpp"

namespace wholehand {

/// Contact of the avatar in the linear model of one axis: none, a rigid stop, or the object of
/// AxisLoop.
enum class ContactCase { kFree, kRigid, kObject };

/// A passive impedance that holds the device, in the axis's units.
struct Impedance {
  double mass = 0.0, damping = 0.0, stiffness = 0.0;
};

/// One axis of device and avatar as a linear sampled loop.
struct AxisLoop {
  double mass = 0.0, damping = 0.0;  ///< device
  int delay_ticks = 0;
  double k_pm = 0.0, phi_k_dm = 0.0, gamma = 0.0;
  double k_ps_per_s2 = 0.0, k_ds_per_s = 0.0;
  double filter_tau_s = 0.0;
  double period_s = 1e-3;
  Impedance person;            ///< moves with the device; none by default
  double held_mass = 0.0;      ///< kObject: the object's mass over the avatar's inertia
  double spring_per_s2 = 0.0;  ///< kObject: the object's spring over the avatar's inertia
  /// αk and αd of an exercise's wall, Eq. (15), with the finger in it. Acts on the device only.
  double wall_stiffness = 0.0, wall_damping = 0.0;
};

/// The loop of one axis from the files, at Φ = 1.
[[nodiscard]] AxisLoop axisLoop(const DeviceModel& device, const CouplingGains& gains, int axis,
                                double period_s);

/// Closed-loop matrix over [x_m, v_m, x_m previous, v_f, x_s, v_s, f_1 .. f_n]: exact zero-order
/// hold for device and person, symplectic Euler for the avatar. Built column by column from unit
/// states.
[[nodiscard]] Eigen::MatrixXd closedLoopMatrix(const AxisLoop& loop, ContactCase contact);

/// Eigenvalues of the one-period matrix; empty where it is not finite or they do not converge.
[[nodiscard]] Eigen::VectorXcd poles(const Eigen::MatrixXd& matrix);

/// Largest modulus of the eigenvalues. An eigenvalue of exactly 1 in free motion is the rigid
/// drift.
[[nodiscard]] double spectralRadius(const Eigen::MatrixXd& matrix);

}  // namespace wholehand
