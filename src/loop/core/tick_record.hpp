#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/command.hpp"
#include "loop/core/fault.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/world_query.hpp"
#include "schema_enums.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <type_traits>

namespace wholehand {

/// Who moves the device in a tick.
enum class Mover : std::int32_t {
  kNobody,          ///< nobody: a simulated hand that rests
  kPerson,          ///< a person in the device, or at the screen of a simulated one
  kVirtualPatient,  ///< a simulated person who does the exercise
  kMotion           ///< a recorded motion is replayed
};
inline constexpr int kMovers = 4;

/// A setting that may change while the loop runs. Every change is a ramp.
struct LiveParameter {
  std::string name;    ///< with its unit at the end: "wall_stiffness_ratio", "lead_in_m"
  std::string unit;    ///< for people, SI: "N", "m", "s", "1"
  double lower = 0.0;  ///< allowed range, lower .. upper
  double upper = 0.0;
  double value = 0.0;          ///< initial value
  double rate_per_s = 0.0;     ///< slope of the ramp, > 0
  bool bounds_effort = false;  ///< limits the device's efforts; such a value falls at once and
                               ///< never rises by itself
};

/// Largest number of live parameters, renderer and exercise together.
inline constexpr int kMaxLiveParameters = 24;

/// Largest number of values that an exercise reports per tick.
inline constexpr int kMaxExerciseValues = 48;
/// Largest number of events in one tick; further ones are dropped.
inline constexpr int kMaxExerciseEvents = 8;

/// Something that happened in the exercise.
struct ExerciseEvent {
  std::int32_t type = 0;    ///< index into ExerciseDescription::event_names
  std::int32_t index = -1;  ///< number of the dispenser, liquid ...; -1: not applicable
  double value = 0.0;       ///< in the event's own unit
};

/// Effort, values and events of the exercise in one tick. Its ExerciseDescription names them.
struct ExerciseRecord {
  AxisEffort effort;     ///< f_e [N or N·m]; 0 without an exercise
  double alpha = 0.0;    ///< α of the transition, Eq. (16), 0 .. 1
  AxisFlag wall_active;  ///< the axis has a wall
  AxisPosition wall;     ///< θ_wall [m or rad]; valid where wall_active is set
  std::int32_t value_count = 0;
  std::int32_t event_count = 0;
  std::array<double, kMaxExerciseValues> values{};  ///< NaN: not known yet
  std::array<ExerciseEvent, kMaxExerciseEvents> events{};
};

static_assert(std::is_trivially_copyable_v<ExerciseRecord>);

/// Largest number of contact points in a record. Further ones act on the hand but are only counted
/// (Fault::kContactsDropped).
inline constexpr int kMaxContacts = 128;

/// Contact point of the hand with a body, after the step. World frame.
struct Contact {
  std::int32_t capsule = -1;  ///< index into HandModel::capsules
  std::int32_t link = -1;     ///< index into HandModel::links
  std::int32_t body = -1;     ///< index into SceneModel::bodies
  std::int32_t reserved = 0;
  Vec3 point_m;             ///< on the hand's surface
  Vec3 normal;              ///< unit, from the body to the hand
  Vec3 force_n;             ///< on the hand, normal force plus friction
  Vec3 torque_nm;           ///< on the hand, torsional friction about the normal
  double distance_m = 0.0;  ///< negative when the surfaces overlap
};

/// State of a body of the scene (centre of mass, world frame).
struct BodyState {
  Vec3 position_m;
  QuatXyzw orientation_xyzw;
  Vec3 velocity_m_s;
  Vec3 angular_velocity_rad_s;
};

/// The stages of a tick, in order; each is timed.
enum class Stage : std::int32_t {
  kDeviceRead,
  kObserve,
  kDynamics,
  kControl,
  kExercise,  ///< the exercise and the adaptive damping, which depends on its effort
  kSafety,
  kDeviceWrite,
  kPhysicsStep,
  kContacts,
  kCount
};
inline constexpr int kStages = static_cast<int>(Stage::kCount);
/// snake_case name of a stage, as written to JSON and recordings.
[[nodiscard]] const char* stageName(Stage s) noexcept;

/// Everything that one tick read, computed and sent, grouped by writer. Records are the only output
/// of the real-time side. Efforts are power-conjugate to their coordinate: N on m, N·m on rad.
struct TickRecord {
  // written by: session
  std::uint64_t tick = 0;             ///< periods since rendering started, skipped ones included
  double time_s = 0.0;                ///< tick * period
  std::uint32_t elapsed_periods = 1;  ///< 1 + periods skipped before this tick
  Fault faults = Fault::kNone;
  std::int64_t lateness_ns = 0;  ///< wake-up after the scheduled instant; not re-simulated
  std::int64_t wall_ns = 0;      ///< duration of the tick on the wall clock; not re-simulated
  std::int64_t cpu_ns = 0;       ///< CPU time of the tick; not re-simulated
  std::array<std::int32_t, kStages> stage_cpu_ns{};  ///< CPU time per stage; not re-simulated

  // written by: device.read; an input, not re-simulated
  Mover moved_by = Mover::kNobody;
  Help help = Help::kUnspecified;  ///< with a person who moves a simulated hand

  std::int32_t command_count = 0;
  std::int32_t parameter_count = 0;                   ///< number of live parameters
  SafetyState safety_state = SafetyState::kDisarmed;  ///< at the end of the tick
  std::int32_t fault_axis = -1;                  ///< first axis that exceeded a limit; -1: none
  std::array<Command, kMaxCommands> commands{};  ///< taken before this tick

  // written by: live settings
  std::array<double, kMaxLiveParameters> parameters{};  ///< in force: renderer's, then exercise's

  // written by: device.read
  AxisPosition q_m;           ///< device position
  AxisPosition intention;     ///< target position of the virtual patient (simulated device only)
  AxisEffort patient_effort;  ///< effort of the virtual patient (simulated device only)

  // written by: velocity_estimator
  AxisVelocity qd_mf;  ///< filtered device velocity

  // written by: world.observe, the state BEFORE this tick's step
  AxisPosition q_s;     ///< avatar position
  AxisVelocity qd_s;    ///< avatar velocity
  JointPosition theta;  ///< joint positions of the avatar
  /// Largest |θ - (θ₀ + G q_s)| after the last step, before correction
  double coupling_error_rad = 0.0;
  double palm_distance_m = 0.0;  ///< palm surface to the nearest body [m]; +inf without bodies
  double palm_target_distance_m = 0.0;  ///< to palm_body; < 0: not in front of the palm; +inf: none
  /// Position of each hand axis at its first touch of the exercise's closure body, closing
  /// kinematically from the open hand. NaN: no touch, a base axis, or no query. −inf: overlap with
  /// the open hand.
  AxisPosition closure;
  std::int32_t body_count = 0;
  std::int32_t palm_body = -1;  ///< nearest target of the exercise; -1: none
  std::array<BodyState, kMaxBodies> bodies{};
  std::int32_t body_joint_count = 0;         ///< recorded bodies on joints, by ascending body
  std::array<double, kMaxBodies> body_q{};   ///< position of the joint [m or rad]
  std::array<double, kMaxBodies> body_qd{};  ///< its rate [m/s or rad/s]

  // written by: bilateral_coupling
  AxisEffort f_s;       ///< drives the avatar, Eq. (2)
  AxisEffort coupling;  ///< spring and γ term felt by the person, Eq. (3)

  // written by: exercise
  ExerciseRecord exercise;
  BodyPlacements placements;  ///< bodies placed by the exercise before the step

  // written by: adaptive_damping
  AxisRatio phi;       ///< Φ, Eq. (5)
  AxisEffort damping;  ///< -Φ K_dm q̇_mf

  // written by: energy tank
  AxisEnergy tank;         ///< energy left in the tank of each axis [J]
  AxisEffort tank_effort;  ///< damping of an empty tank, included in rendered

  // written by: safety
  AxisEffort rendered;      ///< f_m before limits: coupling + exercise + damping + tank
  double authority = 1.0;   ///< 1 while rendering, falls to 0 while ramping to neutral
  AxisEffort sent;          ///< what the device received
  AxisEffort effort_limit;  ///< in force: the device's limit, or a lower one set by a therapist

  // written by: world.step
  std::int32_t contact_count = 0;
  std::int32_t contacts_dropped = 0;
  std::array<Contact, kMaxContacts> contacts{};
};

static_assert(std::is_trivially_copyable_v<TickRecord>);

/// Called before and after every tick in the thread that ticks. The virtual patient who does an
/// exercise and the black box implement it. Real-time safe.
class TickListener {
 public:
  virtual ~TickListener() = default;
  /// Called before the tick, with its commands.
  WHOLEHAND_RT virtual void beforeTick(const TickRecord& record) noexcept = 0;
  /// Called after the tick, with the complete record.
  WHOLEHAND_RT virtual void afterTick(const TickRecord& record) noexcept = 0;
};

}  // namespace wholehand
