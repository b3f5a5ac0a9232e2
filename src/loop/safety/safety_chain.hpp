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
  /// Requests a plain stop, which counts as such first: a reader never takes it for a gentle one.
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

  /// Before arming: true, once, if a stop was requested that neither a tick nor an arming has seen.
  [[nodiscard]] bool consumeUnseen() noexcept {
    const std::uint32_t now = stops_.load(std::memory_order_seq_cst);
    const bool unseen = seen_ != now;
    seen_ = now;
    return unseen;
  }
  /// Last step of arming: later requests stop the ticks. False, once, if a stop was requested since
  /// consumeUnseen(); then nothing is armed.
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
  /// In a tick: kStopRequested if a stop was requested since arm(), with kEmergencyStop after an
  /// emergency stop and kGentleStop while only gentle ones were. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Fault pending() noexcept {
    const bool emergency = emergencies_.load(std::memory_order_seq_cst) != emergencies_armed_at_;
    seen_ = stops_.load(std::memory_order_seq_cst);
    if (emergency) return Fault::kStopRequested | Fault::kEmergencyStop;
    if (plain_.load(std::memory_order_seq_cst) != plain_armed_at_) return Fault::kStopRequested;
    return seen_ != armed_at_ ? Fault::kStopRequested | Fault::kGentleStop : Fault::kNone;
  }

 private:
  std::atomic<std::uint32_t> stops_{0}, plain_{0}, emergencies_{0};
  std::uint32_t seen_ = 0;  ///< as the three below: arming and ticking thread
  std::uint32_t armed_at_ = 0, plain_armed_at_ = 0, emergencies_armed_at_ = 0;
};

/// Adds faults to the tick's. fault_axis becomes the axis of the first fault that stops the run, -1
/// if that fault has no axis; without such a fault, the first axis that was limited.
/// @param axis of the faults; -1: none. Real-time safe.
WHOLEHAND_RT inline void noteFault(Fault faults, int axis, TickRecord& record) noexcept {
  const bool stopped = any(record.faults & kStoppingFaults);
  const bool stops = any(faults & kStoppingFaults);
  if (!stopped && (stops || record.fault_axis < 0)) record.fault_axis = axis;
  record.faults |= faults;
}

/// Energy that the bodies of a world may gain in one step without a source: an engine that pushes
/// overlapping bodies apart gives some [J].
inline constexpr double kMostGain_j = 1.0;

/// Configuration of the safety chain.
struct SafetyConfig {
  AxisEffort effort_limit;  ///< of the device file [N or N·m]
  AxisEffort neutral;       ///< carries the device's own weight [N or N·m]
  NeutralRampConfig ramp;
  EnergyTankConfig tank;        ///< default: no energy tank
  SupervisorConfig supervisor;  ///< default: nothing is supervised
};

/// All checks, limits and stops of a tick, in the order of docs/safety.md. The tick computes the
/// rendered effort between the steps; the record carries the data from step to step.
class SafetyChain {
 public:
  /// @param gains the springs that the energy tank counts @param period_s T
  SafetyChain(const SafetyConfig& config, const CouplingGains& gains, const SceneModel& scene,
              double period_s);

  // Outside the tick.

  /// Workspace or number fault of a device at rest at this position.
  [[nodiscard]] Finding judgeAtRest(const AxisPosition& q_m) const noexcept;
  /// Prepares the first tick. Clears latched faults.
  /// @param q_m position of the device @pre it holds its neutral effort, and StopRequests::arm()
  void arm(const AxisPosition& q_m) noexcept;
  /// Takes back an arming before its first tick.
  void disarm() noexcept;
  [[nodiscard]] StopRequests& stops() noexcept { return stops_; }

  // In the tick: each once, in this order; all are real-time safe. record.elapsed_periods and, from
  // the start, record.faults are the tick's.

  /// First in the tick: notes the stops that were requested in record.faults.
  WHOLEHAND_RT void takeStops(TickRecord& record) noexcept;
  /// 1. Checks record.q_m as it was read: finite, complete, and watchDevice().
  /// @param read the device's status of the read
  WHOLEHAND_RT void judgeReading(Fault read, TickRecord& record) noexcept;
  /// 2. Checks the world's state in the record: watchAvatar(), and kBodiesExploded when the bodies
  /// gained more than kMostGain_j in one step that nobody put in (BodyEnergy).
  /// @param contacts of the last step @param pool of a game's bodies
  WHOLEHAND_RT void judgeWorld(const Contact* contacts, int contact_count, const PoolEnergy& pool,
                               TickRecord& record) noexcept;
  /// 3. The energy tank; record.tank_effort is its damping, to be added to the rendered effort.
  /// @param avatar_j kinetic energy of the avatar
  WHOLEHAND_RT void watchEnergy(double avatar_j, TickRecord& record) noexcept;
  /// 4. to 7. From record.rendered to record.sent: the therapist's limits (record.effort_limit) and
  /// the device's, authority, power, slew. A requested stop, and every stopping fault of the tick,
  /// lets go here (advanceRamp()).
  WHOLEHAND_RT void limitEffort(TickRecord& record) noexcept;
  /// 8. Checks the device's answer to record.sent. If it refused, record.sent becomes the effort
  /// that the device holds.
  WHOLEHAND_RT void judgeWrite(Fault written, TickRecord& record) noexcept;
  /// Notes bodies that the exercise places before the step: what they gain is not a fault.
  WHOLEHAND_RT void notePlaced(const TickRecord& record) noexcept {
    bodies_.notePlaced(record.placements, record);
  }
  /// Checks the world's status of the step.
  WHOLEHAND_RT void judgeStep(Fault stepped, TickRecord& record) noexcept;
  /// Last in the tick: updates record.safety_state.
  WHOLEHAND_RT void conclude(TickRecord& record) noexcept;

  // For the thread that ticks, or after its end; real-time safe.

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
  double reengage_s_ = 0.0;       ///< for a gap before this tick
  double unconfirmed_s_ = 0.0;    ///< time since it should have been neutral without confirming it
};

}  // namespace wholehand
