#pragma once

#include "control/adaptive_damping.hpp"
#include "control/coupling_gains.hpp"
#include "control/velocity_estimator.hpp"
#include "core/expected.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "device/haptic_device.hpp"
#include "dynamics/articulated_body.hpp"
#include "exercise/exercise.hpp"
#include "model/hand_model.hpp"
#include "model/scene_model.hpp"
#include "physics/physics_world.hpp"
#include "renderer/live_settings.hpp"
#include "renderer/parameter_ramps.hpp"
#include "renderer/rehearsal_passed.hpp"
#include "renderer/stage_listener.hpp"
#include "safety/safety_chain.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

class HandProbe;

/// What the tick needs to know, resolved before arming and immutable from then on.
struct RendererConfig {
  double period_s = 1e-3;  ///< T
  CouplingGains gains;
  AdaptiveDampingConfig damping;
  SafetyConfig safety;
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};
  LiveSettings live;          ///< what may be changed while it runs; nothing unless given
  std::string rehearsal;      ///< what a rehearsal of this is of (RehearsalPassed::of())
  bool moves_nobody = false;  ///< whatever is sent, no person feels it: needs no rehearsal
};

/// Whole-hand haptic rendering: one tick reads the device, lets the simulated hand follow it in the
/// physics world, and sends back what holds it. Knows neither threads nor sockets nor clocks.
class HapticRenderer {
 public:
  /// @param scene the bodies of the world, in its order @param exercise adds its effort to the
  /// coupling's; may be null
  /// @pre device, world, hand and exercise outlive this
  HapticRenderer(HapticDevice& device, PhysicsWorld& world, const HandModel& hand,
                 const SceneModel& scene, const RendererConfig& config,
                 Exercise* exercise = nullptr);
  ~HapticRenderer();
  HapticRenderer(const HapticRenderer&) = delete;
  HapticRenderer& operator=(const HapticRenderer&) = delete;

  /// Opens the device, reads it and puts the simulated hand there. Refused where the device is not
  /// ready (not calibrated, or moving), outside its workspace, still on its way to neutral, armed
  /// already (unless simulated), or the hand would be inside a body; and where a stop is asked for
  /// meanwhile. The device is closed again then and nothing else has changed. Clears what was
  /// latched: a person must have asked for it. Not real-time safe.
  /// @param rehearsed Rehearsal::passed, of this very rig: without it a device that moves a person
  /// (neither simulated() nor moves_nobody) is refused
  [[nodiscard]] Expected<Done> arm(const std::optional<RehearsalPassed>& rehearsed = std::nullopt);

  /// One tick; fills the record but for what the session writes, and takes the record's commands.
  /// Real-time safe.
  /// @param periods 1 + those skipped since the last tick; 0 counts as 1
  /// @param stages told when each stage ends; may be null
  WHOLEHAND_RT void tick(std::uint32_t periods, TickRecord& record,
                         StageListener* stages = nullptr) noexcept;

  /// Takes an arming back that no tick has followed. The device stays open. Not real-time safe.
  void disarm() noexcept { safety_.disarm(); }

  /// Lets the next tick begin the ramp to neutral. Before that, an arm() is refused once. Any
  /// thread, also a signal handler; real-time safe.
  void requestStop() noexcept { safety_.stops().ask(); }
  /// The same, and the records say that it was an emergency stop.
  void requestEmergencyStop() noexcept { safety_.stops().askInEmergency(); }

  /// True once the device is at its neutral effort after a stop or a fault.
  [[nodiscard]] bool atNeutral() const noexcept { return safety_.atNeutral(); }
  /// The same, or the device has taken no effort for a second after it should have been neutral:
  /// nothing more can be done for it from here. Real-time safe.
  [[nodiscard]] bool finished() const noexcept { return safety_.finished(); }

  /// The stopping faults of this run so far; kNone again once armed. For the thread that ticks, or
  /// after its end. Real-time safe.
  [[nodiscard]] Fault latched() const noexcept { return safety_.latched(); }
  /// For the thread that ticks, or after its end. Real-time safe.
  [[nodiscard]] SafetyState safetyState() const noexcept { return safety_.state(); }

  [[nodiscard]] const RendererConfig& config() const noexcept { return config_; }
  /// The live parameters, in the order of TickRecord::parameters: the renderer's, then the
  /// exercise's.
  [[nodiscard]] std::vector<LiveParameter> liveParameters() const;
  /// Where the live parameters are when the loop is armed, in the same order, instead of their own
  /// values: what a therapist has set stays. Before arm(); values out of range change nothing.
  void startParametersAt(const std::vector<double>& values) noexcept;
  /// Where they are at the next arming.
  [[nodiscard]] std::vector<double> parametersAtStart() const;
  /// The device's position at which arm() put the hand.
  [[nodiscard]] const AxisPosition& armedPosition() const noexcept { return armed_position_; }

 private:
  void takeCommands(TickRecord& record) noexcept;
  void readDevice(TickRecord& record) noexcept;
  void observeWorld(TickRecord& record) noexcept;
  void updateDynamics(TickRecord& record) noexcept;
  void probeHand(TickRecord& record) noexcept;
  void couple(TickRecord& record) noexcept;
  void exercise(TickRecord& record) noexcept;
  void damp(TickRecord& record) noexcept;
  void writeDevice(TickRecord& record) noexcept;
  void stepWorld(TickRecord& record) noexcept;
  void readContacts(TickRecord& record) noexcept;
  void showContacts(TickRecord& record) const noexcept;
  [[nodiscard]] Expected<Done> mayArm(const std::optional<RehearsalPassed>& rehearsed) const;
  [[nodiscard]] Expected<Done> withinWorkspace() const;

  HapticDevice& device_;
  PhysicsWorld& world_;
  Exercise* exercise_;
  const RendererConfig config_;
  SafetyChain safety_;
  ParameterRamps parameters_;
  AxisEffort effort_limit_;               ///< in force now
  AdaptiveDampingConfig damping_config_;  ///< in force now
  WorldQuery query_;
  bool owner_alive_ = true;  ///< whoever shows the exercise is there
  std::vector<std::string> axis_names_;
  ArticulatedBody dynamics_;
  std::unique_ptr<HandProbe> probe_;
  AxisPosition armed_position_;
  DeviceReading reading_;
  WorldState state_;
  ContactList contacts_;
  VelocityState velocity_;
  AxisRatio avatar_damping_;  ///< D in the present posture
  AdaptiveDampingState damping_;
  bool device_open_ = false;
};

}  // namespace wholehand
