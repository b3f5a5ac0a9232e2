#pragma once

#include "loop/core/axis_array.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace wholehand {

/// Spastic catch of a flexor: the stretch reflex against fast opening. Muscle excitation is
///   g (v(t - delay) - v_th)₊ (s - s_th)₊,
/// where v is the speed and s the amount of opening (docs/patients.md).
struct StretchReflex {
  double gain_nm_s_rad2 = 0.0;    ///< g; 0: none
  double from_speed_rad_s = 1.0;  ///< v_th: threshold of the opening speed
  double below_rad = 0.0;         ///< threshold position: the reflex acts where the axis is more
                                  ///< open (less flexed)
};

/// The person on one axis: an impedance that pulls the device towards the intended position, and
/// involuntary or voluntary efforts.
struct PatientAxis {
  std::string name;
  double mass = 0.0;       ///< moves with the device [kg or kg·m²], >= 0
  double damping = 0.0;    ///< [N·s/m or N·m·s/rad], >= 0
  double stiffness = 0.0;  ///< [N/m or N·m/rad], >= 0
  /// Largest effort of the impedance [N or N·m], > 0
  double strength = std::numeric_limits<double>::infinity();
  double tremor = 0.0;     ///< amplitude of its effort [N or N·m], >= 0
  double fight = 0.0;      ///< resistance against the felt effort [N or N·m], >= 0
  StretchReflex reflex{};  ///< rotations only
};

/// Tremor, common to all axes. Tremor of single axes has individual phases; tremor along a
/// direction has one phase.
struct TremorRhythm {
  double frequency_hz = 5.0;     ///< 3 .. 12
  std::uint64_t phase_seed = 1;  ///< seed of the phases
  AxisEffort along;  ///< amplitudes along one direction, signed [N or N·m]; no axes: none
};

/// Timing of a stretch reflex, and its trigger.
struct ReflexTiming {
  double delay_s = 0.04;       ///< neural delay, 0 .. 0.2
  double muscle_lag_s = 0.03;  ///< first-order time constant, (0, 0.5]
  /// The axis with the largest excess speed triggers every reflex.
  bool largest_triggers_all = false;
};

/// Conditions on which the person releases the device for good; the first one that is met counts.
struct LettingGo {
  double after_s = std::numeric_limits<double>::infinity();  ///< since the start of the run
  /// The person's effort on any axis, as a fraction of the device's effort limit.
  double effort_share = std::numeric_limits<double>::infinity();
};

/// The person flings the device along one axis: draws back, accelerates it to a speed, releases it.
struct Slam {
  std::string axis;           ///< empty: none; ignored on devices without it
  bool towards_upper = true;  ///< true: towards the upper end of its range
  double after_s = 1.0;       ///< start of drawing back
  double speed_share = 0.98;  ///< fraction of the device's speed limit
  double effort_share = 2.0;  ///< largest push as a fraction of the device's effort limit; arms are
                              ///< stronger than the device
};

/// Mapping of a recorded motion into the device's workspace.
struct MotionMapping {
  double margin = 0.05;      ///< fraction of each axis's range kept free at both ends, 0 .. 0.4
  double speed_share = 0.8;  ///< usable fraction of each axis's speed limit, (0, 1]
  double base_scale = 0.0;   ///< factor of translations; 0: the largest that fits, <= 1
  bool center = true;        ///< shift translations to the middle of the workspace
};

/// Coupling between a person's axes: the off-diagonal elements of mass, damping and stiffness, in
/// the axes' own units (kg, kg·m or kg·m², and so on). Symmetric, zero on the diagonal; positive
/// semidefinite together with the diagonal in PatientAxis. In the device's order; 0 x 0 without
/// coupling.
struct PatientLinks {
  AxisMatrix mass, damping, stiffness;
};

/// A patient file: impedance of arm and fingers, the person's own efforts, and the mapping of
/// motion. A standard axis (kKnownAxes) that the device lacks is ignored; any other unknown name is
/// a fault. On an axis that the file does not name, no person acts.
struct PatientConfig {
  std::string path;
  std::string name;
  std::vector<PatientAxis> axes;  ///< in the device's order, one for each of its axes
  PatientLinks links;             ///< coupling of the axes' impedances
  MotionMapping motion;
  TremorRhythm tremor;
  ReflexTiming reflex;
  double fight_reaction_s = 0.0;  ///< delay between a felt effort and the resistance against it, 0
                                  ///< .. 1
  LettingGo letting_go;
  Slam slam;
};

/// Largest opening speed of the hand that triggers no stretch reflex of the person; +inf: the
/// person has no reflex [rad/s].
[[nodiscard]] double reflexFreeOpeningSpeed(const PatientConfig& patient) noexcept;

}  // namespace wholehand
