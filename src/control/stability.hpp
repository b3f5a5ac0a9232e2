#pragma once

#include "control/coupling_gains.hpp"
#include "core/expected.hpp"
#include "model/device_model.hpp"
#include "model/rendering_config.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// What the avatar touches in the linear model of one axis.
enum class ContactCase { kFree, kRigid };

/// One axis of device and avatar as a linear sampled loop (no person attached).
struct AxisLoop {
  double mass = 0.0, damping = 0.0;  ///< device
  int delay_ticks = 0;
  double k_pm = 0.0, phi_k_dm = 0.0, gamma = 0.0;
  double k_ps_per_s2 = 0.0, k_ds_per_s = 0.0;
  double filter_tau_s = 0.0;
  double period_s = 1e-3;
};

/// The loop of one axis as the files have it, at Φ = 1.
[[nodiscard]] AxisLoop axisLoop(const DeviceModel& device, const CouplingGains& gains, int axis,
                                double period_s);

/// Closed-loop matrix over [x_m, v_m, x_m previous, v_f, x_s, v_s, f_1 .. f_n]: exact zero-order
/// hold for the device, symplectic Euler for the avatar, built column by column from unit states.
[[nodiscard]] Eigen::MatrixXd closedLoopMatrix(const AxisLoop& loop, ContactCase contact);

/// Largest modulus of its eigenvalues. In free motion an eigenvalue of exactly 1 (rigid drift) is
/// structural.
[[nodiscard]] double spectralRadius(const Eigen::MatrixXd& matrix);

/// The avatar alone, all axes coupled by its inertia, target at rest: matrix over [q_s, q̇_s] of
/// q̈_s = −M_r⁻¹ M̃_r (K_ps q_s + K_ds q̇_s) under symplectic Euler, K_ds by Eq. (14).
[[nodiscard]] Eigen::MatrixXd avatarLoopMatrix(const AxisMatrix& reduced_inertia,
                                               const Eigen::VectorXd& k_ps_per_s2, double period_s);

/// Checks every axis free and against a rigid stop at Φ = 0, ¼ .. 1: spectral radius > 1 (+1e-7) is
/// refused with the reason and the nearest allowed stiffness (and damping, where less of it would
/// do), found by bisection; and the avatar's multi-axis loop over the given reduced inertias
/// (several postures), which must be < 1.
[[nodiscard]] Diagnostics checkStability(const DeviceModel& device,
                                         const RenderingConfig& rendering,
                                         const CouplingGains& gains,
                                         const std::vector<AxisMatrix>& reduced_inertias,
                                         double period_s);

}  // namespace wholehand
