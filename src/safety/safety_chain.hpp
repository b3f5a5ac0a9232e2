#pragma once

#include "control/coupling_gains.hpp"
#include "control/energy_tank.hpp"
#include "core/axis_array.hpp"
#include "core/fault.hpp"
#include "core/real_time.hpp"
#include "core/safety_state.hpp"
#include "core/tick_record.hpp"
#include "safety/neutral_ramp.hpp"
#include "safety/slew_limiter.hpp"
#include "safety/stop_requests.hpp"
#include "safety/supervisor.hpp"

namespace wholehand {

/// What the chain holds a device to.
struct SafetyConfig {
  AxisEffort effort_limit;  ///< of the device file [N or N·m]
  AxisEffort neutral;       ///< carries the device's own weight [N or N·m]
  NeutralRampConfig ramp;
  EnergyTankConfig tank;        ///< none unless given
  SupervisorConfig supervisor;  ///< none unless given
};

/// Everything in a tick that judges, limits and stops, in the order of docs/safety.md. Between the
/// steps the tick computes what is to be felt; the record carries it from one step to the next.
class SafetyChain {
 public:
  /// @param gains the springs that the energy tank counts @param period_s T
  SafetyChain(const SafetyConfig& config, const CouplingGains& gains, double period_s);

  // Outside the tick.

  /// A workspace or number fault of a device at rest there.
  [[nodiscard]] Finding judgeAtRest(const AxisPosition& q_m) const noexcept;
  /// Ready for the first tick. Clears what was latched.
  /// @param q_m where the device is @pre it holds its neutral effort, and StopRequests::arm()
  void arm(const AxisPosition& q_m) noexcept;
  /// Takes an arming back that no tick has followed.
  void disarm() noexcept;
  [[nodiscard]] StopRequests& stops() noexcept { return stops_; }

  // In the tick, each once, in this order; all are real-time safe. record.elapsed_periods and, from
  // the start, record.faults are the tick's.

  /// 1. record.q_m, as it was read: finite, complete, and what watchDevice() says.
  /// @param read what the device said
  WHOLEHAND_RT void judgeReading(Fault read, TickRecord& record) noexcept;
  /// 2. The world's state in the record: watchWorld().
  WHOLEHAND_RT void judgeWorld(TickRecord& record) noexcept;
  /// 3. The energy tank; record.tank_effort is its damping, to be added to what is rendered.
  WHOLEHAND_RT void watchEnergy(TickRecord& record) noexcept;
  /// 4. to 7. From record.rendered to record.sent: the therapist's limits (record.effort_limit) and
  /// the device's, authority, power, slew. A stop that was asked for and every stopping fault of
  /// the tick begin the ramp to neutral here.
  WHOLEHAND_RT void limitEffort(TickRecord& record) noexcept;
  /// 8. What the device said to record.sent. Where it refused, the record says what it holds.
  WHOLEHAND_RT void judgeWrite(Fault written, TickRecord& record) noexcept;
  /// Bodies that are put somewhere before the step: their new velocity is no fault.
  WHOLEHAND_RT void notePlaced(const BodyPlacements& placements) noexcept {
    wholehand::notePlaced(world_watch_, placements);
  }
  /// What the world said to its step.
  WHOLEHAND_RT void judgeStep(Fault stepped, TickRecord& record) noexcept;
  /// Last in the tick: the state, in record.safety_state.
  WHOLEHAND_RT void conclude(TickRecord& record) noexcept;

  // Of the thread that ticks, or after its end; real-time safe.

  /// True until the ramp to neutral begins.
  [[nodiscard]] bool rendering() const noexcept { return ramp_.phase == RampPhase::kRendering; }
  /// True once the device is at its neutral effort after a stop or a fault.
  [[nodiscard]] bool atNeutral() const noexcept;
  /// The same, or the device has taken no effort for a second after it should have been neutral.
  [[nodiscard]] bool finished() const noexcept;
  /// The stopping faults of this run so far; kNone again once armed.
  [[nodiscard]] Fault latched() const noexcept { return latched_; }
  [[nodiscard]] SafetyState state() const noexcept { return state_; }

 private:
  [[nodiscard]] AxisEffort withinLimits(TickRecord& record) const noexcept;
  void noteSentInTank(const TickRecord& record) noexcept;

  const SafetyConfig config_;
  const CouplingGains gains_;
  const double period_s_;
  StopRequests stops_;
  DeviceWatchState device_watch_;
  WorldWatchState world_watch_;
  EnergyTankState tank_;
  NeutralRampState ramp_;
  SlewWindow slew_;  ///< what was sent in the last millisecond
  SafetyState state_ = SafetyState::kDisarmed;
  Fault latched_ = Fault::kNone;  ///< a stopping fault stays until armed again
  AxisEffort acknowledged_;       ///< the last effort that the device took
  double unconfirmed_s_ = 0.0;    ///< since it should have been neutral and would not say so
};

}  // namespace wholehand
