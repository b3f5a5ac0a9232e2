#pragma once

#include "loop/control/bilateral_coupling.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/model/device_model.hpp"

#include <cstddef>
#include <functional>
#include <vector>

namespace wholehand {

/// Contact of the avatar in the linear model of one axis: no contact, a rigid stop, or the object
/// of AxisLoop.
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
  Impedance person;            ///< attached to the device; none by default
  double held_mass = 0.0;      ///< kObject: the object's mass relative to the avatar's inertia
  double spring_per_s2 = 0.0;  ///< kObject: the object's spring divided by the avatar's inertia
  /// αk and αd of an exercise's wall that the finger is in, Eq. (15). It acts on the device only.
  double wall_stiffness = 0.0, wall_damping = 0.0;
  /// α times the damping that a cushion's liquid requires under delay, lateDamping().
  double wall_late = 0.0;
};

/// The loop of one axis from the files, at Φ = 1.
[[nodiscard]] AxisLoop axisLoop(const DeviceModel& device, const CouplingGains& gains, int axis,
                                double period_s);

/// Closed-loop matrix over [x_m, v_m, x_m previous, v_f, x_s, v_s, f_1 .. f_n]: exact zero-order
/// hold for device and person, symplectic Euler for the avatar. Built column by column from unit
/// states.
[[nodiscard]] Eigen::MatrixXd closedLoopMatrix(const AxisLoop& loop, ContactCase contact);

/// Eigenvalues of the one-period matrix; empty if the matrix is not finite or the computation does
/// not converge.
[[nodiscard]] Eigen::VectorXcd poles(const Eigen::MatrixXd& matrix);

/// Largest modulus of the eigenvalues. In free motion an eigenvalue of exactly 1 is the rigid
/// drift.
[[nodiscard]] double spectralRadius(const Eigen::MatrixXd& matrix);

/// Closed-loop matrix over [q_s, q̇_s] of the avatar alone, its axes coupled by inertia, target at
/// rest: q̈_s = −M_r⁻¹ (K_pm q_s + D q̇_s) under symplectic Euler, D by avatarDamping(). The loop
/// is stable if 4 M_r − 2 T D − T² K_pm is positive definite. The matrix is infinite if the inertia
/// is not positive definite.
/// @param reduced_inertia M_r including armature
[[nodiscard]] Eigen::MatrixXd avatarLoopMatrix(const AxisMatrix& reduced_inertia,
                                               const AxisStiffness& k_pm, double period_s);

/// The posture with the largest spectral radius of the avatar's loop.
struct WorstPosture {
  double radius = 0.0;  ///< spectral radius of the loop
  std::size_t posture = 0;
};
[[nodiscard]] WorstPosture worstPosture(const std::vector<AxisMatrix>& inertias,
                                        const AxisStiffness& k_pm, double period_s);

/// Largest common factor on K_pm, at most `most`, that is stable (radius < 1) in every posture; 0
/// when there is none. Rounded down to three digits unless it is `most` itself.
[[nodiscard]] double largestStableFactor(const std::vector<AxisMatrix>& inertias,
                                         const AxisStiffness& k_pm, double period_s,
                                         double most = 1.0);

/// Largest value <= `start` that passes; 0 when none above start / 1e5 does. Steps down until a
/// value passes, then bisects to the boundary above it. The set of passing values need not include
/// zero.
[[nodiscard]] double largestAllowed(double start, const std::function<bool(double)>& passes);

/// The value rounded down to three digits, so that the printed number passes too; 0 for values that
/// are not positive.
[[nodiscard]] double roundedDown(double value);

}  // namespace wholehand
