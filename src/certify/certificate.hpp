#pragma once

#include "certify/stability.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/rendering_config.hpp"

#include <array>
#include <limits>
#include <string>
#include <vector>

/// Stability certificate of a device, its gains and a hand (docs/certificate.md). Pure computation;
/// not real-time safe.
namespace wholehand {

/// Criteria of a certificate. The last two concern all axes together, the others a single axis.
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
/// Passive persons and objects that a certificate must hold for.
enum class Persons {
  kLinear,  ///< linear and time-invariant, Φ constant: exact, gains that can oscillate are refused
  kAny,     ///< also nonlinear and time-varying, and a Φ that changes with every tick
};
inline constexpr int kCertificatePhiSteps = 8;  ///< Φ = 0, ⅛ .. 1
inline constexpr int kContactCriteria = 4;      ///< kFree .. kSpring, checked by eigenvalues
/// "free", "rigid_contact", "mass", "spring", "damping", "quantisation", "wall", "slew", "avatar",
/// "coupled"
[[nodiscard]] const char* criterionKey(Criterion criterion);

/// A wall of an exercise on an axis, Eq. (15), at α = 1.
struct WallCase {
  double stiffness = 0.0;  ///< [N/m or N·m/rad]
  double damping = 0.0;    ///< [N·s/m or N·m·s/rad]
  /// For a cushion, the least resistance of liquid and air; +inf: no cushion [N·s/m or N·m·s/rad].
  double resistance = std::numeric_limits<double>::infinity();

  bool operator==(const WallCase&) const = default;
};

/// One axis with everything its certificate depends on.
struct AxisCase {
  DeviceAxis axis;
  int delay_ticks = 0;
  double period_s = 1e-3;
  AxisRendering gains;   ///< armature as in the file; empty: by the rule from K_pm
  double inertia = 0.0;  ///< inertia of the avatar at its reference without armature [kg or kg·m²]
  std::vector<WallCase> walls = {};  ///< walls of the exercise; empty without one

  /// The armature of the file, else by the rule [kg or kg·m²].
  [[nodiscard]] double armature() const;
  /// k_p: K_pm divided by the avatar's inertia with armature [1/s²].
  [[nodiscard]] double avatarStiffness() const;
  /// The loop at a share Φ of the adaptive damping, without a person.
  [[nodiscard]] AxisLoop loop(double phi) const;
  /// The same loop with the finger in a wall at a share α.
  [[nodiscard]] AxisLoop loopIn(const WallCase& wall, double alpha, double phi) const;
};

/// The worst spectral radius of one kind of contact and the case in which it occurs.
struct WorstRadius {
  double radius = 0.0;
  double phi = 0.0;               ///< Φ
  const char* person = "no arm";  ///< "no arm", "relaxed arm" or "stiff arm"
  double alpha = 0.0;             ///< α of the wall; 0 without one
  /// Object size. kMass: mass relative to the avatar's; kSpring: stiffness relative to the
  /// avatar's.
  double object = 0.0;
  /// The tolerance covers rounding of the eigenvalue 1 of a rigid drift, which stays well below
  /// 1e-7.
  [[nodiscard]] bool stable() const { return radius <= 1.0 + 1e-7; }
};

/// The wall with the smallest margin on an axis.
struct WallCertificate {
  WallCase wall;
  double damping_required = 0.0;      ///< b_min at α = 1, largest over Φ; smaller for α < 1
  double damping_required_phi = 0.0;  ///< Φ of that maximum
  WorstRadius worst;                  ///< over every contact and person, α = ¼ .. 1
  /// Allowed over present value; +inf without a wall on the axis.
  double margin = std::numeric_limits<double>::infinity();
};

/// Certificate of one axis. Stiffness in [N/m or N·m/rad], damping in [N·s/m or N·m·s/rad].
struct AxisCertificate {
  AxisCase axis_case;
  double rigid_formula = 0.0;  ///< b / (T (½ + n)): γ = Φ = 0
  double rigid_limit = 0.0;    ///< largest K_pm against a rigid stop at every Φ, by eigenvalues
  std::array<WorstRadius, kContactCriteria> contacts;  ///< index: Criterion
  double damping_required = 0.0;                       ///< b_min, largest over Φ
  double damping_required_phi = 0.0;                   ///< Φ of that maximum
  double viscous_limit = 0.0;                          ///< 2 b / T
  double coulomb_limit = 0.0;  ///< 2 f_c / Δ; +inf with an ideal encoder or no f_c stated
  WallCertificate wall;
  double slew_required = 0.0;               ///< slew of the stiffest case [N/s or N·m/s]
  Criterion binding = Criterion::kDamping;  ///< criterion with the smallest margin
  /// Margin of the binding criterion, allowed over present value; >= 1 passes.
  double margin = 0.0;
  bool passes = false;

  [[nodiscard]] double quantisationLimit() const;
  [[nodiscard]] bool meets(Criterion criterion) const;
};

/// Result for the avatar's loop with coupled axes over the sampled postures.
struct AvatarCertificate {
  double radius = 0.0;       ///< < 1: stable
  double slowest_s = 0.0;    ///< time constant of the slowest mode
  std::size_t posture = 0;   ///< index of the worst posture, from 0
  std::size_t postures = 0;  ///< number of postures
  double margin = 0.0;       ///< largest common factor on K_pm, at most 100
  /// Largest allowed time constant. A larger lag of the avatar is perceptible in free motion.
  static constexpr double kSlowest_s = 0.5;
  [[nodiscard]] bool passes() const { return radius < 1.0 && slowest_s <= kSlowest_s; }
};

/// Result for the device's damping against persons and objects that link the axes
/// (certify/passivity.hpp).
struct CoupledCertificate {
  double margin = 0.0;        ///< present over required damping, the same share on all axes
  double frequency_hz = 0.0;  ///< frequency of the smallest margin
  std::size_t posture = 0;    ///< 0: the reference; sampled postures from 1
};

struct Certificate {
  double period_s = 1e-3;
  std::vector<AxisCertificate> axes;
  AvatarCertificate avatar;
  CoupledCertificate coupled;     ///< against the persons of the input
  CoupledCertificate any_person;  ///< result against Persons::kAny
  /// Criterion with the smallest margin; kAvatar and kCoupled concern all axes together. The
  /// coupled criterion includes the damping of every axis, so it binds only where it is stricter.
  Criterion binding_criterion = Criterion::kAvatar;
  int binding_axis = -1;  ///< -1: all axes together
  bool certified = false;

  [[nodiscard]] double margin() const;
  /// "finger_flexion.damping", "avatar" or "coupled".
  [[nodiscard]] std::string binding() const;
};

/// Input of a certificate. Its inertias are the avatar's reduced inertia at the hand's reference
/// and in sampled postures.
struct CertificateInput {
  /// A wall of the exercise and its axis.
  struct Wall {
    int axis = 0;
    WallCase wall;
  };

  DeviceModel device;
  RenderingConfig rendering;
  AxisMatrix inertia_at_reference;
  std::vector<AxisMatrix> inertias;
  double period_s = 1e-3;  ///< tick period
  Persons persons = Persons::kLinear;
  std::vector<Wall> walls = {};  ///< stiffest walls of the exercise; empty without one
  std::string hand = {};         ///< name of the hand
  std::string exercise = {};     ///< name of the exercise; empty: none
  int level = 0;                 ///< level of the exercise; 0 if it has one level only
};

/// @pre device and rendering have the same axes, the inertias as many rows; period_s > 0
[[nodiscard]] Certificate certify(const CertificateInput& input);

/// Steps of certify(), which a search for gains calls one by one.
[[nodiscard]] AxisCase axisCase(const CertificateInput& input, int axis);
[[nodiscard]] AxisCertificate certifyAxis(const AxisCase& c);
/// Worst spectral radius over Φ = 0, ⅛ .. 1, persons (no arm, relaxed arm, stiff arm) and the
/// objects of the criterion; in a share α of a wall if one is given.
[[nodiscard]] WorstRadius worstContact(const AxisCase& c, Criterion contact,
                                       const WallCase& wall = {}, double alpha = 0.0);
/// Largest b_min over the same Φ, and the Φ of that maximum.
struct LargestDamping {
  double damping = 0.0, phi = 0.0;
};
[[nodiscard]] LargestDamping largestRequiredDamping(const AxisCase& c, const WallCase& wall,
                                                    double alpha);
/// 2 b / T, or 2 f_c / Δ if that is known and smaller.
[[nodiscard]] double quantisationLimit(const AxisCase& c);
[[nodiscard]] WallCertificate certifyWall(const AxisCase& c, const WallCase& wall);
/// Slew rate of the effort that is required when the device without a person moves at its speed
/// limit v against an avatar held by a stop. The spring effort changes at (K_pm + k) v. The damping
/// effort, with D = γB + K_dm + d, changes with the deceleration of the device, which is at most v
/// (ω + (D + b)/m), ω = √((K_pm + k)/m). The sum is v (K_pm + k + D (ω + (D + b)/m)).
[[nodiscard]] double requiredSlew(const AxisCase& c);
/// Impedance of the named arm at the axis; for a rotation multiplied by the square of the lever
/// arm.
[[nodiscard]] Impedance armAt(const DeviceAxis& axis, const std::string& person);

/// Version of the criteria; it is increased when they change.
inline constexpr int kCertificateVersion = 1;

/// Name of one input of a certificate, and a hash of all its numbers.
struct FingerprintPart {
  std::string name;  ///< name of the device, gains, hand or exercise; may be empty
  std::string hash;  ///< 16 hexadecimal digits
};

/// Everything a certificate depends on. Equal fingerprints mean equal certificates.
struct CertificateFingerprint {
  int version = kCertificateVersion;
  double rate_hz = 0.0;
  /// "device", "rendering", "hand", "exercise", in this order.
  std::array<FingerprintPart, 4> parts;
};
inline constexpr std::array<const char*, 4> kFingerprintParts = {"device", "rendering", "hand",
                                                                 "exercise"};

/// Fingerprint of the numbers only; comments, names and key order of the files do not matter. The
/// hand is represented by its inertias to nine digits, because compilers differ in the last digits.
[[nodiscard]] CertificateFingerprint fingerprintOf(const CertificateInput& input);

/// 64-bit FNV-1a as 16 hexadecimal digits. Detects accidental changes, not forgery.
[[nodiscard]] std::string hashOf(const std::string& text);

/// Describes the differences ("is for the device lambda-pride, this run uses wrist-9axis; ...");
/// empty when there are none. Hand and exercise are compared only on the same device.
[[nodiscard]] std::string differenceOf(const CertificateFingerprint& certificate,
                                       const CertificateFingerprint& run);

}  // namespace wholehand
