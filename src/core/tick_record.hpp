#pragma once

#include "core/axis_array.hpp"
#include "core/command.hpp"
#include "core/exercise_record.hpp"
#include "core/fault.hpp"
#include "core/geometry.hpp"
#include "core/live_parameter.hpp"
#include "core/safety_state.hpp"
#include "core/world_query.hpp"

#include <array>
#include <cstdint>
#include <type_traits>

namespace wholehand {

/// The most contact points one record holds; further ones act but are only counted
/// (Fault::kContactsDropped).
inline constexpr int kMaxContacts = 64;
/// The most bodies (fixed ones included) a scene may have.
inline constexpr int kMaxBodies = 32;

/// One point where the hand touches a body, after the step. World frame.
struct Contact {
  std::int32_t capsule = -1;  ///< index into HandModel::capsules
  std::int32_t link = -1;     ///< index into HandModel::links
  std::int32_t body = -1;     ///< index into SceneModel::bodies
  std::int32_t reserved = 0;
  Vec3 point_m;             ///< on the hand's surface
  Vec3 normal;              ///< unit, from the body to the hand
  Vec3 force_n;             ///< on the hand, normal and friction together
  Vec3 torque_nm;           ///< on the hand, spinning friction about the normal
  double distance_m = 0.0;  ///< negative when the surfaces overlap
};

/// Where a body of the scene is and how it moves (centre of mass, world frame).
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
  kExercise,  ///< the exercise, and the damping that counts its effort
  kSafety,
  kDeviceWrite,
  kPhysicsStep,
  kContacts,
  kCount
};
inline constexpr int kStages = static_cast<int>(Stage::kCount);
/// snake_case name of a stage, as written to JSON and recordings.
[[nodiscard]] const char* stageName(Stage s) noexcept;

/// All that one tick read, computed and sent, grouped by writer. The only thing that leaves the
/// real-time side. Efforts are power-conjugate to their coordinate: N on m, N·m on rad.
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

  std::int32_t command_count = 0;
  std::int32_t parameter_count = 0;                   ///< of the live settings
  SafetyState safety_state = SafetyState::kDisarmed;  ///< at the end of the tick
  std::int32_t fault_axis = -1;  ///< the first axis that a limit was exceeded on; -1: none
  std::array<Command, kMaxCommands> commands{};  ///< taken before this tick

  // written by: live settings
  std::array<double, kMaxLiveParameters> parameters{};  ///< in force now: the renderer's, then
                                                        ///< the exercise's

  // written by: device.read
  AxisPosition q_m;           ///< device position
  AxisPosition intention;     ///< where the virtual patient wants to be (simulated device only)
  AxisEffort patient_effort;  ///< what the virtual patient applies (simulated device only)

  // written by: velocity_estimator
  AxisVelocity qd_mf;  ///< filtered device velocity

  // written by: world.observe, the state BEFORE this tick's step
  AxisPosition q_s;     ///< avatar position
  AxisVelocity qd_s;    ///< avatar velocity
  JointPosition theta;  ///< joint positions of the avatar
  double coupling_error_rad =
      0.0;  ///< largest |θ - (θ₀ + G q_s)| the last step left, before correction
  double palm_distance_m = 0.0;         ///< palm surface to the nearest body; +inf without bodies
  double palm_target_distance_m = 0.0;  ///< to palm_body, < 0 unless before the palm; +inf without
  /// Where each hand axis, closed kinematically from where it is open, first touches the exercise's
  /// closure body; NaN where it never does, on base axes, and where nothing was asked; −inf where
  /// they overlap when it is open.
  AxisPosition closure;
  std::int32_t body_count = 0;
  std::int32_t palm_body = -1;  ///< nearest of the exercise's targets; -1: none
  std::array<BodyState, kMaxBodies> bodies{};

  // written by: bilateral_coupling
  AxisEffort f_s;       ///< drives the avatar, Eq. (2)
  AxisEffort coupling;  ///< spring and γ term felt by the person, Eq. (3)

  // written by: exercise
  ExerciseRecord exercise;
  BodyPlacements placements;  ///< bodies that the exercise puts somewhere before the step

  // written by: adaptive_damping
  AxisRatio phi;       ///< Φ, Eq. (5)
  AxisEffort damping;  ///< -Φ K_dm q̇_mf

  // written by: energy tank
  AxisEnergy tank;         ///< what each axis may still give [J]
  AxisEffort tank_effort;  ///< damping of an empty tank, part of rendered

  // written by: safety
  AxisEffort rendered;      ///< f_m before limits: coupling + exercise + damping + tank
  double authority = 1.0;   ///< 1 while rendering, falls to 0 while ramping to neutral
  AxisEffort sent;          ///< what the device received
  AxisEffort effort_limit;  ///< in force: the device's, or less where a therapist set less

  // written by: world.step
  std::int32_t contact_count = 0;
  std::int32_t contacts_dropped = 0;
  std::array<Contact, kMaxContacts> contacts{};
};

static_assert(std::is_trivially_copyable_v<TickRecord>);

}  // namespace wholehand
