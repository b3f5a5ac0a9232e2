#pragma once

#include "loop/control/bilateral_coupling.hpp"
#include "loop/control/energy_tank.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/fault.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/safety/body_energy.hpp"
#include "loop/safety/force_limiter.hpp"
#include "loop/safety/neutral_ramp.hpp"
#include "loop/safety/supervisor.hpp"

#include <atomic>
#include <cstdint>

namespace wholehand {

/// Counts stop requests. A request stays pending until a tick or an arming has seen it. Lock-free.
class StopRequests {
 public:
  /// Requests a gentle stop. Any thread, also a signal handler; real-time safe.
  void requestGentle() noexcept { stops_.fetch_add(1, std::memory_order_seq_cst); }
  /// Requests a plain stop. Counts the plain stop before the stop itself, so that a reader never
  /// mistakes it for a gentle stop.
  void request() noexcept {
    plain_.fetch_add(1, std::memory_order_seq_cst);
    requestGentle();
  }
  /// Requests an emergency stop. Counts as a stop first, so that a reader never sees an emergency
  /// without a stop.
  void requestEmergency() noexcept {
    request();
    emergencies_.fetch_add(1, std::memory_order_seq_cst);
  }

  /// Called before arming. Returns true, once, if a stop was requested that neither a tick nor an
  /// arming has seen.
  [[nodiscard]] bool consumeUnseen() noexcept {
    const std::uint32_t now = stops_.load(std::memory_order_seq_cst);
    const bool unseen = seen_ != now;
    seen_ = now;
    return unseen;
  }
  /// Last step of arming: from now on a request stops the ticks. Returns false, once, if a stop was
  /// requested since consumeUnseen(); then nothing is armed.
  [[nodiscard]] bool arm() noexcept {
    // Reads the kinds first, so that a new stop is not mistaken for an old one.
    const std::uint32_t emergencies = emergencies_.load(std::memory_order_seq_cst);
    const std::uint32_t plain = plain_.load(std::memory_order_seq_cst);
    if (consumeUnseen()) return false;
    armed_at_ = seen_;
    plain_armed_at_ = plain;
    emergencies_armed_at_ = emergencies;
    return true;
  }
  /// Called in a tick. Returns kStopRequested if a stop was requested since arm(); with
  /// kEmergencyStop after an emergency stop, and with kGentleStop if all requests were gentle.
  /// Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Fault pending() noexcept {
    const bool emergency = emergencies_.load(std::memory_order_seq_cst) != emergencies_armed_at_;
    seen_ = stops_.load(std::memory_order_seq_cst);
    if (emergency) return Fault::kStopRequested | Fault::kEmergencyStop;
    if (plain_.load(std::memory_order_seq_cst) != plain_armed_at_) return Fault::kStopRequested;
    return seen_ != armed_at_ ? Fault::kStopRequested | Fault::kGentleStop : Fault::kNone;
  }

 private:
  std::atomic<std::uint32_t> stops_{0}, plain_{0}, emergencies_{0};
  std::uint32_t seen_ = 0;  ///< this and the members below: only the arming and ticking thread
  std::uint32_t armed_at_ = 0, plain_armed_at_ = 0, emergencies_armed_at_ = 0;
};

/// Adds faults to those of the tick. fault_axis becomes the axis of the first fault that stops the
/// run, -1 if that fault has no axis. Without such a fault it is the first axis that was limited.
/// @param axis axis of the faults; -1: none. Real-time safe.
WHOLEHAND_RT inline void noteFault(Fault faults, int axis, TickRecord& record) noexcept {
  const bool stopped = any(record.faults & kStoppingFaults);
  const bool stops = any(faults & kStoppingFaults);
  if (!stopped && (stops || record.fault_axis < 0)) record.fault_axis = axis;
  record.faults |= faults;
}

/// Energy that the bodies of a world may gain in one step without a source, because an engine that
/// pushes overlapping bodies apart gives some energy [J].
inline constexpr double kMostGain_j = 1.0;

/// Configuration of the safety chain.
struct SafetyConfig {
  AxisEffort effort_limit;  ///< limit from the device file [N or N·m]
  AxisEffort neutral;       ///< carries the device's own weight [N or N·m]
  NeutralRampConfig ramp;
  EnergyTankConfig tank;        ///< default: no energy tank
  SupervisorConfig supervisor;  ///< default: nothing is supervised
};

/// All checks, limits and stops of a tick, in the order of docs/safety.md. Between these steps the
/// tick computes the rendered effort; the record carries the data from step to step.
class SafetyChain {
 public:
  /// @param gains springs whose energy the energy tank counts @param period_s T
  SafetyChain(const SafetyConfig& config, const CouplingGains& gains, const SceneModel& scene,
              double period_s);

  // Outside the tick.

  /// Checks a device at rest at this position: reports a position outside the workspace or not
  /// finite.
  [[nodiscard]] Finding checkAtRest(const AxisPosition& q_m) const noexcept;
  /// Prepares the first tick. Clears latched faults.
  /// @param q_m position of the device @pre the device holds its neutral effort, and
  /// StopRequests::arm() returned true
  void arm(const AxisPosition& q_m) noexcept;
  /// Cancels an arming before its first tick.
  void disarm() noexcept;
  [[nodiscard]] StopRequests& stops() noexcept { return stops_; }

  // Called in the tick, each once, in this order; all are real-time safe. record.elapsed_periods
  // and, from the beginning, record.faults belong to this tick.

  /// First step of the tick: records the requested stops in record.faults.
  WHOLEHAND_RT void takeStops(TickRecord& record) noexcept;
  /// 1. Checks the position that was read, record.q_m: finite, complete, and watchDevice().
  /// @param read faults that the device returned from its read
  WHOLEHAND_RT void checkReading(Fault read, TickRecord& record) noexcept;
  /// 2. Checks the world's state in the record: watchAvatar(), and kBodiesExploded when the bodies
  /// gained more than kMostGain_j in one step without a source (BodyEnergy).
  /// @param contacts contacts of the last step @param pool energy of a game's bodies
  WHOLEHAND_RT void checkWorld(const Contact* contacts, int contact_count, const PoolEnergy& pool,
                               TickRecord& record) noexcept;
  /// 3. Advances the energy tank. record.tank_effort becomes its damping, to be added to the
  /// rendered effort.
  /// @param avatar_j kinetic energy of the avatar
  WHOLEHAND_RT void watchEnergy(double avatar_j, const AxisEnergy* guides_j,
                                TickRecord& record) noexcept;
  /// 4. to 7. Computes record.sent from record.rendered: the therapist's limits
  /// (record.effort_limit) and those of the device, authority, power, slew. A requested stop, and
  /// every stopping fault of the tick, starts the ramp to neutral here (advanceRamp()).
  WHOLEHAND_RT void limitEffort(TickRecord& record) noexcept;
  /// 8. Checks the device's answer to record.sent. If it refused, record.sent becomes the effort
  /// that the device holds.
  WHOLEHAND_RT void checkWrite(Fault written, TickRecord& record) noexcept;
  /// Notes the bodies that the exercise places before the step: the energy that they gain thereby
  /// is not a fault.
  WHOLEHAND_RT void notePlaced(const TickRecord& record) noexcept {
    bodies_.notePlaced(record.placements, record);
  }
  /// Checks the faults that the world returned from its step.
  WHOLEHAND_RT void checkStep(Fault stepped, TickRecord& record) noexcept;
  /// Last step of the tick: updates record.safety_state.
  WHOLEHAND_RT void conclude(TickRecord& record) noexcept;

  // Called in the thread that ticks, or after its end; real-time safe.

  /// True until the ramp to neutral begins.
  [[nodiscard]] bool rendering() const noexcept { return ramp_.phase == RampPhase::kRendering; }
  /// True when the device is at its neutral effort after a stop or a fault.
  [[nodiscard]] bool atNeutral() const noexcept;
  /// True when atNeutral(), or when the device has accepted no effort for a second after it should
  /// have been neutral.
  [[nodiscard]] bool finished() const noexcept;
  /// Stopping faults of this run, latched until the next arming.
  [[nodiscard]] Fault latched() const noexcept { return latched_; }
  [[nodiscard]] SafetyState state() const noexcept { return state_; }

 private:
  [[nodiscard]] double blendTime_s(const TickRecord& record) const noexcept;
  [[nodiscard]] AxisEffort withinLimits(TickRecord& record) const noexcept;
  void noteSentInTank(const TickRecord& record) noexcept;

  const SafetyConfig config_;
  const CouplingGains gains_;
  const double period_s_;
  StopRequests stops_;
  DeviceWatchState device_watch_;
  AvatarWatchState avatar_watch_;
  BodyEnergy bodies_;
  EnergyTankState tank_;
  NeutralRampState ramp_;
  SlewWindow slew_;  ///< efforts sent in the last millisecond
  SafetyState state_ = SafetyState::kDisarmed;
  Fault latched_ = Fault::kNone;  ///< stopping faults, kept until armed again
  AxisEffort acknowledged_;       ///< last effort that the device accepted
  double reengage_s_ = 0.0;       ///< duration of the engagement after a gap before this tick
  /// Time for which the device should be neutral and has not accepted it.
  double unconfirmed_s_ = 0.0;
};

}  // namespace wholehand
