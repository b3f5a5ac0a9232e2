#pragma once

#include "loop/control/adaptive_damping.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/body_order.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/device/haptic_device.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/exercise/exercise.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/physics_world.hpp"
#include "loop/renderer/live_settings.hpp"
#include "loop/renderer/person_guides.hpp"
#include "loop/safety/safety_chain.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

struct Models;
struct Rehearsal;
struct RehearsalOptions;
struct RigOptions;

/// Proof that the worst contacts of a rig were rehearsed on this machine, in this process, and
/// passed. Arming a device that moves a person requires it. Only rehearse() creates one.
class RehearsalPassed {
 public:
  /// Fingerprint of the rehearsed rig: device, hand, gains, scene, exercise and rate.
  [[nodiscard]] const std::string& of() const noexcept { return of_; }

 private:
  friend Expected<Rehearsal> rehearse(const Models& models, const AxisPosition& start,
                                      const RigOptions& rig, const RehearsalOptions& options);
  explicit RehearsalPassed(std::string of) : of_(std::move(of)) {}

  std::string of_;
};

/// Receives a call when a stage of the tick ends. The renderer has no clock of its own; the
/// listener brings one.
class StageListener {
 public:
  virtual ~StageListener() = default;
  WHOLEHAND_RT virtual void lap(Stage stage) noexcept = 0;
};

class BodyPool;
class HandProbe;

/// Configuration of the tick; resolved before arming and immutable afterwards.
struct RendererConfig {
  double period_s = 1e-3;  ///< T
  CouplingGains gains;
  AdaptiveDampingConfig damping;
  SafetyConfig safety;
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};
  std::optional<PersonGuidesConfig> guides;  ///< of a prescription; empty: none
  LiveSettings live;          ///< parameters that may change while it runs; default: none
  std::string rehearsal;      ///< fingerprint that a rehearsal of this rig carries
                              ///< (RehearsalPassed::of())
  bool moves_nobody = false;  ///< no person feels the effort; arming needs no rehearsal
};

/// Whole-hand haptic rendering. A tick reads the device, lets the simulated hand (the avatar)
/// follow it in the physics world, and sends the coupling's reaction back. Uses no threads, sockets
/// or clocks.
class HapticRenderer {
 public:
  /// @param scene the bodies of the world, in its order @param exercise adds its effort to the
  /// coupling's; may be null @param person reports to the record; null: nothing is known about the
  /// person
  /// @pre device, world, hand, exercise and person outlive this
  HapticRenderer(HapticDevice& device, PhysicsWorld& world, const HandModel& hand,
                 const SceneModel& scene, const RendererConfig& config,
                 Exercise* exercise = nullptr, const KnownPerson* person = nullptr);
  ~HapticRenderer();
  HapticRenderer(const HapticRenderer&) = delete;
  HapticRenderer& operator=(const HapticRenderer&) = delete;

  /// First step of arming: opens the device, reads it and places the simulated hand there. The
  /// device gives no effort yet. Work that waits for a disk or for memory therefore belongs between
  /// this call and arm(). Refused when the device is not ready (uncalibrated or moving), is outside
  /// its workspace, still ramps to neutral or is armed already (unless simulated); when the hand
  /// would be inside a body; and when a stop is requested meanwhile. A refusal closes the device
  /// again and changes nothing else. Idempotent until arm(). Not real-time safe.
  /// @param rehearsed Rehearsal::passed of this very rig; without it a device that moves a person
  /// (neither simulated() nor moves_nobody) is refused
  [[nodiscard]] Expected<Done> prepare(
      const std::optional<RehearsalPassed>& rehearsed = std::nullopt);
  /// Last step of arming: enables the device, directly before its first tick, which checks the
  /// position again. Calls prepare() if that was not done. Refused for the reasons of prepare(),
  /// when the device cannot be enabled, and when a stop was requested since. Clears latched faults:
  /// call it only on a person's request. Not real-time safe.
  [[nodiscard]] Expected<Done> arm(const std::optional<RehearsalPassed>& rehearsed = std::nullopt);

  /// Runs one tick. Fills the record except the fields that the session writes, and carries out the
  /// record's commands. Real-time safe.
  /// @param periods 1 + periods skipped since the last tick; 0 counts as 1
  /// @param stages notified when each stage ends; may be null
  WHOLEHAND_RT void tick(std::uint32_t periods, TickRecord& record,
                         StageListener* stages = nullptr) noexcept;

  /// Cancels an arming before its first tick. The device stays open. Not real-time safe.
  void disarm() noexcept;

  /// Requests a stop: the next tick begins the ramp to neutral. If nothing is armed, the next arm()
  /// refuses, once. Any thread, also a signal handler; real-time safe.
  void requestStop() noexcept { safety_.stops().request(); }
  /// Requests a gentle stop: like requestStop(), but the effort falls over the exercise's fade-out
  /// time plus the ramp's time (NeutralRampConfig::fade_out_s).
  void requestGentleStop() noexcept { safety_.stops().requestGentle(); }
  /// Requests an emergency stop: like requestStop(), but the records mark it as an emergency stop.
  void requestEmergencyStop() noexcept { safety_.stops().requestEmergency(); }

  /// True when the device is at its neutral effort after a stop or a fault.
  [[nodiscard]] bool atNeutral() const noexcept { return safety_.atNeutral(); }
  /// True when atNeutral(), or when the device has accepted no effort for a second after it should
  /// have been neutral, so that this program can do nothing more. Real-time safe.
  [[nodiscard]] bool finished() const noexcept { return safety_.finished(); }

  /// Stopping faults of this run, latched until the next arming. Call in the thread that ticks, or
  /// after its end. Real-time safe.
  [[nodiscard]] Fault latched() const noexcept { return safety_.latched(); }
  /// Present safety state. Call in the thread that ticks, or after its end. Real-time safe.
  [[nodiscard]] SafetyState safetyState() const noexcept { return safety_.state(); }

  [[nodiscard]] const RendererConfig& config() const noexcept { return config_; }
  /// The live parameters in the order of TickRecord::parameters: the renderer's, then the
  /// exercise's.
  [[nodiscard]] std::vector<LiveParameter> liveParameters() const;
  /// Sets the values that the live parameters have at arming, in the order of liveParameters(),
  /// instead of their defaults, so that a therapist's settings persist. Call before arm(); values
  /// out of range are ignored.
  void startParametersAt(const std::vector<double>& values) noexcept;
  /// Values of the live parameters at the next arming.
  [[nodiscard]] std::vector<double> parametersAtStart() const;
  /// Device position at which prepare() placed the hand.
  [[nodiscard]] const AxisPosition& armedPosition() const noexcept { return armed_position_; }

 private:
  [[nodiscard]] bool mayPush(const TickRecord& record) const noexcept;
  void takeCommands(TickRecord& record) noexcept;
  void readDevice(TickRecord& record) noexcept;
  void observeWorld(TickRecord& record) noexcept;
  void updateDynamics(TickRecord& record) noexcept;
  void probeHand(TickRecord& record) noexcept;
  void couple(TickRecord& record) noexcept;
  void exercise(TickRecord& record) noexcept;
  void guide(TickRecord& record) noexcept;
  void damp(TickRecord& record) noexcept;
  [[nodiscard]] double avatarEnergy(const TickRecord& record) const noexcept;
  void writeDevice(TickRecord& record) noexcept;
  void stepWorld(TickRecord& record) noexcept;
  void orderBodies(const TickRecord& record) noexcept;
  void readContacts(TickRecord& record) noexcept;
  void showContacts(TickRecord& record) const noexcept;
  [[nodiscard]] Expected<Done> mayArm(const std::optional<RehearsalPassed>& rehearsed) const;
  [[nodiscard]] Expected<Done> withinWorkspace() const;
  [[nodiscard]] Expected<Done> refuseArming(Diagnostics why);

  HapticDevice& device_;
  PhysicsWorld& world_;
  BodyPool* const pool_;  ///< bodies of a game in world_; null when the engine has none
  Exercise* exercise_;
  const KnownPerson* const person_;
  const RendererConfig config_;
  SafetyChain safety_;
  ParameterRamps parameters_;
  AxisEffort effort_limit_;               ///< in force now
  AdaptiveDampingConfig damping_config_;  ///< in force now
  WorldQuery query_;
  bool holder_alive_ = true;  ///< the client that holds the controls is alive
  std::vector<std::string> axis_names_;
  ArticulatedBody dynamics_;
  std::unique_ptr<HandProbe> probe_;
  AxisPosition armed_position_;
  DeviceReading reading_;
  PersonReading person_reading_;
  PhysicsState state_;
  PoolReport pool_report_;
  ContactList contacts_;
  VelocityState velocity_;
  AxisDamping avatar_damping_;  ///< D in the current posture
  AdaptiveDampingState damping_;
  std::optional<PersonGuides> guides_;
  bool device_open_ = false, was_open_ = false;  ///< now, and before prepare()
  bool prepared_ = false;
  bool first_tick_ = false;  ///< the next tick is the first one after arm()
};

}  // namespace wholehand
