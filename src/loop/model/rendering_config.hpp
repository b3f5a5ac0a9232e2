#pragma once

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// The gains of one axis. Units follow the axis: N and m, or N·m and rad.
struct AxisRendering {
  std::string name;
  double k_pm = 0.0;   ///< coupling stiffness felt by the person [N/m or N·m/rad], > 0
  double k_dm = 0.0;   ///< adaptive damping at Φ = 1 [N·s/m or N·m·s/rad], >= 0
  double gamma = 0.3;  ///< γ of Eq. (3), 0 .. 1; 0 is the paper's law
  double velocity_filter_hz = 30.0;  ///< cut-off of the first-order low-pass, > 0
  /// Reflected inertia added to the avatar on this axis [kg or kg·m²], >= 0. When not stated,
  /// ruleArmature() gives it: 0 unless the axis is too light for K_pm.
  std::optional<double> armature;
  double effort_full = 5.0;   ///< f₀: effort at which φ = 1 [N or N·m]
  double effort_dead = 0.5;   ///< f_d: effort below which φ = 0, < f₀
  double decay_s = 0.3;       ///< τ_dec of Algorithm 1
  bool palm_contact = false;  ///< base axes: uses its own φ in addition to the hand's largest (Eq.
                              ///< 5, corrected)
};

/// A rendering file: the gains that go with a device.
struct RenderingConfig {
  std::string path;
  std::string name;
  bool paper = false;               ///< the paper's own law: γ = 0, f_d = 0
  std::vector<AxisRendering> axes;  ///< in the device's order, one for each of its axes
};

}  // namespace wholehand
