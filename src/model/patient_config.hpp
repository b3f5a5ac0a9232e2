#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "model/device_model.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace wholehand {

/// A spastic catch of a flexor: the reflex against being opened too fast. It asks the muscle for
/// g (v(t - delay) - v_th)₊ (s - s_th)₊, v and s the speed and amount of opening
/// (docs/patients.md).
struct StretchReflex {
  double gain_nm_s_rad2 = 0.0;    ///< g; 0: none
  double from_speed_rad_s = 1.0;  ///< v_th: an axis opened faster than this is caught
  double below_rad = 0.0;         ///< where: the axis is more open (less flexed) than this
};

/// The person on one axis: an impedance that pulls the device towards the intention, and what they
/// do of their own accord.
struct PatientAxis {
  std::string name;
  double mass = 0.0;       ///< moves with the device [kg or kg·m²], >= 0
  double damping = 0.0;    ///< [N·s/m or N·m·s/rad], >= 0
  double stiffness = 0.0;  ///< [N/m or N·m/rad], >= 0
  double tremor = 0.0;     ///< amplitude of its effort [N or N·m], >= 0
  double fight = 0.0;      ///< pushed against what is felt [N or N·m], >= 0
  StretchReflex reflex{};  ///< rotations only
};

/// An involuntary rhythm, one for all axes. What an axis has of its own has its own phase; what
/// goes along a direction has one phase.
struct TremorRhythm {
  double frequency_hz = 5.0;     ///< 3 .. 12
  std::uint64_t phase_seed = 1;  ///< the phases are drawn by it
  AxisEffort along;  ///< amplitudes along one direction, signed [N or N·m]; no axes: none
};

/// How late a stretch reflex comes, and whose speed triggers it.
struct ReflexTiming {
  double delay_s = 0.04;       ///< of the nerves, 0 .. 0.2
  double muscle_lag_s = 0.03;  ///< first order, (0, 0.5]
  bool together = false;       ///< the axis that is too fast by most triggers every reflex
};

/// The person lets go of the device and takes hold of it no more: whichever comes first.
struct LettingGo {
  double after_s = std::numeric_limits<double>::infinity();  ///< of the run's beginning
  /// The person's effort on any axis, as a share of the device's effort limit there.
  double effort_share = std::numeric_limits<double>::infinity();
};

/// The person flings the device along one axis: draws back, pushes it to a speed, lets go.
struct Slam {
  std::string axis;           ///< empty: none; not every device has it
  bool towards_upper = true;  ///< end of its range
  double after_s = 1.0;       ///< when drawing back begins
  double speed_share = 0.98;  ///< of the device's speed limit
  double effort_share = 2.0;  ///< the most pushed, of the device's effort limit: arms are strong
};

/// How a recorded motion becomes an intention inside the device's workspace.
struct MotionMapping {
  double margin = 0.05;      ///< share of each axis's range kept free at both ends, 0 .. 0.4
  double speed_share = 0.8;  ///< share of each axis's speed limit that may be used, (0, 1]
  double base_scale = 0.0;   ///< translations are multiplied by it; 0: as large as fits, <= 1
  bool center = true;        ///< translations are shifted to the middle of the workspace
};

/// What links a person's axes: the elements off the diagonal of their mass, damping and stiffness,
/// in the axes' own units (kg, kg·m or kg·m², and so on). Symmetric, zero on the diagonal; together
/// with PatientAxis, which holds the diagonal, positive semidefinite. In the device's order; 0 x 0
/// where nothing is linked.
struct PatientLinks {
  AxisMatrix mass, damping, stiffness;
};

/// A patient file: arm and finger impedance, what the person does of their own accord, and how
/// motion is mapped. An axis that Wholehand knows (kKnownAxes) but the device has not is ignored;
/// any other name is a fault. An axis of the device that the file does not name feels no person.
struct PatientConfig {
  std::string path;
  std::string name;
  std::vector<PatientAxis> axes;  ///< in the device's order, one for each of its axes
  PatientLinks links;             ///< what of their impedance one axis gives another
  MotionMapping motion;
  TremorRhythm tremor;
  ReflexTiming reflex;
  double fight_reaction_s = 0.0;  ///< what is fought is what was felt that long ago, 0 .. 1
  LettingGo letting_go;
  Slam slam;
};

[[nodiscard]] Expected<PatientConfig> loadPatientFile(const std::string& path,
                                                      const DeviceModel& device);

}  // namespace wholehand
