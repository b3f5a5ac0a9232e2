#pragma once

#include "control/stability.hpp"
#include "model/device_model.hpp"
#include "model/rendering_config.hpp"

#include <array>
#include <limits>
#include <string>
#include <vector>

/// The stability certificate of a device, its gains and a hand (docs/certificate.md): pure
/// computation, not for the tick.
namespace wholehand {

/// What a certificate asks of one axis, and (the last two) of all axes together.
enum class Criterion {
  kFree,
  kRigid,
  kMass,
  kSpring,
  kDamping,
  kQuantisation,
  kWall,
  kSlew,
  kAvatar,
  kCoupled
};
inline constexpr int kCertificatePhiSteps = 8;  ///< Φ = 0, ⅛ .. 1
inline constexpr int kContactCriteria = 4;      ///< kFree .. kSpring, judged by eigenvalues
/// "free", "rigid_contact", "mass", "spring", "damping", "quantisation", "wall", "slew", "avatar",
/// "coupled"
[[nodiscard]] const char* criterionKey(Criterion criterion);

/// A wall that an exercise may put on an axis, Eq. (15), at α = 1.
struct WallCase {
  double stiffness = 0.0;  ///< [N/m or N·m/rad]
  double damping = 0.0;    ///< [N·s/m or N·m·s/rad]
};

/// One axis with all that its certificate depends on.
struct AxisCase {
  DeviceAxis axis;
  int delay_ticks = 0;
  double period_s = 1e-3;
  AxisRendering gains;   ///< armature as in the file: not stated, it follows K_pm by the rule
  double inertia = 0.0;  ///< of the avatar along the axis at its reference, without armature
  std::vector<WallCase> walls = {};  ///< of the exercise; none without one

  /// As stated, or by the rule [kg or kg·m²].
  [[nodiscard]] double armature() const;
  /// k_p: K_pm over the avatar's inertia, armature included [1/s²].
  [[nodiscard]] double avatarStiffness() const;
  /// The loop at a share Φ of the adaptive damping, nobody attached.
  [[nodiscard]] AxisLoop loop(double phi) const;
  /// The same while the finger is in a wall at a share α of it.
  [[nodiscard]] AxisLoop loopIn(const WallCase& wall, double alpha, double phi) const;
};

/// The worst spectral radius of a kind of contact, and where it was found.
struct WorstRadius {
  double radius = 0.0;
  double phi = 0.0;               ///< Φ
  const char* person = "no arm";  ///< "no arm", "relaxed arm" or "stiff arm"
  double alpha = 0.0;             ///< α of the wall, 0 outside
  double object = 0.0;  ///< kMass: μ, times the avatar; kSpring: times the avatar's own stiffness
  /// Rounding of the eigenvalue 1 of a rigid drift stays well below 1e-7.
  [[nodiscard]] bool stable() const { return radius <= 1.0 + 1e-7; }
};

/// The wall that leaves an axis the least margin.
struct WallCertificate {
  WallCase wall;
  double damping_required = 0.0;      ///< b_min at α = 1, the largest over Φ; it is less below
  double damping_required_phi = 0.0;  ///< where it is the largest
  WorstRadius worst;                  ///< of every contact and person, α = ¼ .. 1
  /// Allowed over present; +inf where the exercise has no wall on the axis.
  double margin = std::numeric_limits<double>::infinity();
};

/// One axis, judged. Stiffness in [N/m or N·m/rad], damping in [N·s/m or N·m·s/rad].
struct AxisCertificate {
  AxisCase of;
  double rigid_formula = 0.0;  ///< b / (T (½ + n)): γ = Φ = 0
  double rigid_limit = 0.0;  ///< largest K_pm held against a rigid stop at every Φ, by eigenvalues
  std::array<WorstRadius, kContactCriteria> contacts;  ///< by Criterion
  double damping_required = 0.0;                       ///< b_min, the largest over Φ
  double damping_required_phi = 0.0;                   ///< where it is the largest
  double viscous_limit = 0.0;                          ///< 2 b / T
  double coulomb_limit = 0.0;  ///< 2 f_c / Δ; +inf where the encoder is ideal or f_c not stated
  WallCertificate wall;
  double slew_required = 0.0;               ///< of the fastest spring [N/s or N·m/s]
  Criterion binding = Criterion::kDamping;  ///< of the smallest margin
  double margin = 0.0;  ///< of the binding criterion: allowed over present; >= 1 passes
  bool passes = false;

  [[nodiscard]] double quantisationLimit() const;
  [[nodiscard]] bool meets(Criterion criterion) const;
};

/// The avatar's loop with all axes coupled, over the sampled postures.
struct AvatarCertificate {
  double radius = 0.0;       ///< < 1: stable
  double slowest_s = 0.0;    ///< time constant of its slowest motion
  std::size_t posture = 0;   ///< the worst one, from 0
  std::size_t postures = 0;  ///< how many were looked at
  double margin = 0.0;       ///< largest common factor on K_pm, at most 100
  /// The simulated hand must follow: what it lags behind is felt in free air.
  static constexpr double kSlowest_s = 0.5;
  [[nodiscard]] bool passes() const { return radius < 1.0 && slowest_s <= kSlowest_s; }
};

/// The device's damping with persons and objects that link the axes
/// (control/coupled_passivity.hpp).
struct CoupledCertificate {
  double margin = 0.0;        ///< damping there is over what is needed, alike on all axes
  double frequency_hz = 0.0;  ///< where that is the least
  std::size_t posture = 0;    ///< 0: the reference; then the sampled ones, from 1
};

struct Certificate {
  double period_s = 1e-3;
  std::vector<AxisCertificate> axes;
  AvatarCertificate avatar;
  CoupledCertificate coupled;
  /// Whose margin is the smallest; kAvatar and kCoupled where it is all axes' together. The coupled
  /// criterion holds the damping of every axis in itself: it is named where it says more.
  Criterion binding_criterion = Criterion::kAvatar;
  int binding_axis = -1;  ///< -1: all axes together
  bool certified = false;

  [[nodiscard]] double margin() const;
  /// "finger_flexion.damping", "avatar" or "coupled".
  [[nodiscard]] std::string binding() const;
};

/// What is judged. Inertias of the avatar: the reduced inertia at the hand's reference and in
/// sampled postures.
struct CertificateInput {
  /// A wall of the exercise and the axis it is on.
  struct Wall {
    int axis = 0;
    WallCase wall;
  };

  DeviceModel device;
  RenderingConfig rendering;
  AxisMatrix inertia_at_reference;
  std::vector<AxisMatrix> inertias;
  double period_s = 1e-3;
  std::vector<Wall> walls = {};  ///< the stiffest ones of the exercise, if there is one
  std::string hand = {};         ///< its name
  std::string exercise = {};     ///< its name; empty without one
  int level = 0;                 ///< of the exercise; 0 where it has only one
};

/// @pre device and rendering have the same axes, the inertias as many rows; period_s > 0
[[nodiscard]] Certificate certify(const CertificateInput& input);

/// The parts of it, for searches.
[[nodiscard]] AxisCase axisCase(const CertificateInput& input, int axis);
[[nodiscard]] AxisCertificate certifyAxis(const AxisCase& c);
/// The worst over Φ = 0, ⅛ .. 1, no, a relaxed and a stiff arm, and the objects of the criterion;
/// in a share α of a wall, if one is given.
[[nodiscard]] WorstRadius worstContact(const AxisCase& c, Criterion contact,
                                       const WallCase& wall = {}, double alpha = 0.0);
/// b_min, the largest over the same Φ, and where that is.
struct LargestDamping {
  double damping = 0.0, phi = 0.0;
};
[[nodiscard]] LargestDamping largestRequiredDamping(const AxisCase& c, const WallCase& wall,
                                                    double alpha);
/// 2 b / T, or 2 f_c / Δ where that is less and known.
[[nodiscard]] double quantisationLimit(const AxisCase& c);
[[nodiscard]] WallCertificate certifyWall(const AxisCase& c, const WallCase& wall);
/// The slew that the effort needs where the device, nobody attached, flies at its speed limit v
/// against an avatar that a stop holds: the spring changes by (K_pm + k) v, and the damping
/// D = γB + K_dm + d as fast as the device slows down, in v at most ω + (D + b)/m,
/// ω = √((K_pm + k)/m). Together v (K_pm + k + D (ω + (D + b)/m)).
[[nodiscard]] double requiredSlew(const AxisCase& c);
/// The arm of that name at the axis: on a rotation times the square of its lever arm.
[[nodiscard]] Impedance armAt(const DeviceAxis& axis, const std::string& person);

}  // namespace wholehand
