#include "loop/safety/safety_chain.hpp"

#include "loop/core/axis_array.hpp"
#include "loop/safety/force_limiter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

// A device that accepts no effort is asked for this time to take its neutral effort.
constexpr double kNeutralWithin_s = 1.0;
// Speed assumed for blending in after a gap, as a fraction of the speed limit.
constexpr double kBlendSpeed = 0.1;
constexpr double kLongestBlend_s = 0.5;  // longest blend after a gap

AxisEffort noteLimit(const LimitedEffort& limited, TickRecord& record) noexcept {
  noteFault(limited.faults, limited.axis, record);
  return limited.effort;
}

// Clamps the rendered effort to limits tighter than the device's.
AxisEffort clampRendered(const AxisEffort& limit, const AxisEffort& device_limit,
                         TickRecord& record) noexcept {
  AxisEffort out = record.rendered;
  for (int i = 0; i < out.size(); ++i) {
    if (!(limit[i] < device_limit[i]) || !(std::abs(out[i]) > limit[i])) continue;
    out[i] = std::clamp(out[i], -limit[i], limit[i]);
    noteFault(Fault::kEffortLimit, i, record);
  }
  return out;
}

// Energy stored in an exercise's walls: half their effort times the penetration. The energy of the
// spring that restores a shell is not counted, as if it were lost. Walls and corridor of a
// prescription add what they say they store.
AxisEnergy wallStored(const TickRecord& record, const AxisEnergy* guides_j) noexcept {
  const ExerciseRecord& exercise = record.exercise;
  AxisEnergy out(exercise.wall_active.size());
  for (int i = 0; i < out.size(); ++i) {
    if (!exercise.wall_active[i]) continue;
    out[i] = 0.5 * std::abs(exercise.effort[i] * (record.q_m[i] - exercise.wall[i]));
  }
  if (guides_j == nullptr) return out;
  if (out.size() < guides_j->size()) out = AxisEnergy(guides_j->size());
  for (int i = 0; i < guides_j->size(); ++i) out[i] += (*guides_j)[i];
  return out;
}

// The effort by which an exercise pushes: the effort sent minus the effort that would have been
// sent without the exercise. Walls are excluded: they are springs, and the loop counts their energy
// as stored.
AxisEffort pushedByExercise(const TickRecord& record, const AxisEffort& sent) noexcept {
  const ExerciseRecord& exercise = record.exercise;
  AxisEffort out(sent.size());
  for (int i = 0; i < out.size(); ++i) {
    const double push = i < exercise.effort.size() ? exercise.effort[i] : 0.0;
    const bool wall = i < exercise.wall_active.size() && exercise.wall_active[i];
    if (push == 0.0 || wall || !std::isfinite(record.rendered[i])) continue;
    const double limit = record.effort_limit[i];
    const double without = std::clamp(record.rendered[i] - push, -limit, limit);
    out[i] = std::clamp(sent[i] - without, std::min(push, 0.0), std::max(push, 0.0));
  }
  return out;
}

StopAsked stopOf(Fault faults, Fault latched) noexcept {
  if (any(latched)) return StopAsked::kPlain;
  if (!any(faults & Fault::kStopRequested)) return StopAsked::kNone;
  return any(faults & Fault::kGentleStop) ? StopAsked::kGentle : StopAsked::kPlain;
}

int elapsedOf(const TickRecord& record) noexcept {
  return static_cast<int>(record.elapsed_periods);
}

}  // namespace

SafetyChain::SafetyChain(const SafetyConfig& config, const CouplingGains& gains,
                         const SceneModel& scene, double period_s)
    : config_(config),
      gains_(gains),
      period_s_(period_s),
      bodies_(scene, period_s),
      slew_(config.supervisor.slew_ticks) {
  ramp_.sent = acknowledged_ = config.neutral;  // an unarmed device holds its neutral effort
}

Finding SafetyChain::checkAtRest(const AxisPosition& q_m) const noexcept {
  DeviceWatchState nothing_known;
  return watchDevice(nothing_known, q_m, config_.neutral, 1, config_.supervisor);
}

void SafetyChain::arm(const AxisPosition& q_m) noexcept {
  tank_ = fullTank(config_.tank);
  ramp_ = engageFrom(config_.neutral);
  slew_.clear();
  device_watch_ = DeviceWatchState{};
  device_watch_.q = q_m;
  avatar_watch_ = AvatarWatchState{};
  bodies_.clear();
  state_ = SafetyState::kArmed;
  latched_ = Fault::kNone;
  acknowledged_ = config_.neutral;  // the device holds it since open()
  unconfirmed_s_ = 0.0;
}

void SafetyChain::disarm() noexcept {
  ramp_.phase = RampPhase::kNeutral;
  ramp_.sent = acknowledged_;  // neutral; if ticks have run, they ramp down to it
  state_ = any(latched_) ? SafetyState::kFaulted : SafetyState::kDisarmed;
}

void SafetyChain::takeStops(TickRecord& record) noexcept {
  record.faults |= stops_.pending();
}

void SafetyChain::checkReading(Fault read, TickRecord& record) noexcept {
  record.faults |= read;
  // A missing axis would read as 0, and the coupling would pull it there.
  if (record.q_m.size() != gains_.axes) {
    record.faults |= Fault::kDeviceRead;
    record.q_m = AxisPosition(gains_.axes, std::numeric_limits<double>::quiet_NaN());
  } else if (!any(read & kStoppingFaults) && !allFinite(record.q_m)) {
    record.faults |= Fault::kNonFinitePosition;
    for (int i = gains_.axes; i-- > 0;) {
      if (!std::isfinite(record.q_m[i])) record.fault_axis = i;
    }
  }
  // During the ramp to neutral the motion is not checked, because compressed springs push a device
  // that is being released.
  if (any(record.faults & kStoppingFaults) || !rendering()) return;
  reengage_s_ = blendTime_s(record);
  const Finding finding =
      watchDevice(device_watch_, record.q_m, ramp_.sent, elapsedOf(record), config_.supervisor);
  record.faults |= finding.faults;
  record.fault_axis = finding.axis;
}

// Duration of blending in after this gap: the time in which the device would cover its path in the
// gap at a tenth of its speed limits.
double SafetyChain::blendTime_s(const TickRecord& record) const noexcept {
  double time_s = config_.ramp.reengage_s;
  if (device_watch_.fresh) return time_s;
  for (int i = 0; i < config_.supervisor.axes; ++i) {
    const double way = std::abs(record.q_m[i] - device_watch_.q[i]);
    time_s = std::max(time_s, way / (kBlendSpeed * config_.supervisor.speed_limit[i]));
  }
  return std::min(time_s, kLongestBlend_s);
}

void SafetyChain::checkWorld(const Contact* contacts, int contact_count, const PoolEnergy& pool,
                             TickRecord& record) noexcept {
  if (!rendering()) return;
  record.faults |= watchAvatar(avatar_watch_, record, config_.supervisor);
  bodies_.advance(record, contacts, contact_count, pool);
  if (config_.supervisor.axes > 0 && !(bodies_.gained_j() <= kMostGain_j)) {
    record.faults |= Fault::kBodiesExploded;
  }
}

void SafetyChain::watchEnergy(double avatar_j, const AxisEnergy* guides_j,
                              TickRecord& record) noexcept {
  record.tank_effort = AxisEffort(gains_.axes);
  record.tank = tank_.energy;
  if (config_.tank.axes == 0 || any(record.faults & kStoppingFaults)) return;
  WorldEnergy world = bodies_.energy();
  world.held_j += avatar_j;
  const EnergyTankStep step =
      advanceTank(tank_, record.q_m, record.q_s, wallStored(record, guides_j), world, gains_,
                  config_.tank, record.effort_limit, elapsedOf(record), period_s_);
  tank_ = step.state;
  record.tank = tank_.energy;
  // While the effort is blended in, the springs hold energy that the person has not received yet.
  // The tank's damping is not used then; after a gap the blending starts again.
  const bool gap = elapsedOf(record) > 1 && elapsedOf(record) * period_s_ > config_.ramp.gap_s;
  if (ramp_.authority < 1.0 || gap) return;
  record.tank_effort = step.effort;
  for (int i = 0; i < step.effort.size(); ++i) {
    if (step.effort[i] != 0.0) noteFault(Fault::kTankEmpty, i, record);
  }
  if (tank_.hand <= -config_.tank.hand_capacity) record.faults |= Fault::kWorldGivesEnergy;
}

void SafetyChain::limitEffort(TickRecord& record) noexcept {
  const AxisEffort wanted = withinLimits(record);
  latched_ |= record.faults & kStoppingFaults;
  slew_.note(ramp_.sent);
  NeutralRampConfig ramp = config_.ramp;
  ramp.reengage_s = reengage_s_;
  ramp_ = advanceRamp(ramp_, wanted, config_.neutral, stopOf(record.faults, latched_),
                      elapsedOf(record), period_s_, ramp);
  const SupervisorConfig& supervisor = config_.supervisor;
  if (rendering()) {  // during the ramp the effort only falls, and the velocity may be invalid
    ramp_.sent = noteLimit(
        limitPower(ramp_.sent, config_.neutral, record.qd_mf, supervisor.power_limit_w), record);
  }
  if (supervisor.axes > 0) {
    ramp_.sent = noteLimit(limitSlew(ramp_.sent, slew_, supervisor.most_change), record);
  }
  record.authority = ramp_.authority;
  record.sent = ramp_.sent;
  if (config_.tank.axes > 0) noteSentInTank(record);
}

// A therapist's limit applies to the rendered effort. The device's own limit applies to the sent
// effort, which includes the effort that carries the device's weight.
AxisEffort SafetyChain::withinLimits(TickRecord& record) const noexcept {
  const AxisEffort held = clampRendered(record.effort_limit, config_.effort_limit, record);
  return noteLimit(wholehand::limitEffort(sum(held, config_.neutral), config_.effort_limit),
                   record);
}

void SafetyChain::noteSentInTank(const TickRecord& record) noexcept {
  const AxisEffort sent = difference(record.sent, config_.neutral);
  tank_ = recordSent(tank_, sent, record.f_s, record.effort_limit, pushedByExercise(record, sent));
  if (ramp_.authority < 1.0) {
    tank_.energy = config_.tank.capacity;
    tank_.hand = config_.tank.hand_capacity + bodies_.energy().held_j;
  }
}

void SafetyChain::checkWrite(Fault written, TickRecord& record) noexcept {
  noteFault(written, -1, record);
  latched_ |= written & kStoppingFaults;
  if (!any(written & Fault::kDeviceWrite)) {
    acknowledged_ = record.sent;
    return;
  }
  // The device keeps its effort: ramp, slew limit and record continue from there.
  ramp_.sent = record.sent = acknowledged_;
  if (ramp_.phase == RampPhase::kNeutral) unconfirmed_s_ += period_s_;
}

void SafetyChain::checkStep(Fault stepped, TickRecord& record) noexcept {
  noteFault(stepped, -1, record);
  latched_ |= stepped & kStoppingFaults;
}

void SafetyChain::conclude(TickRecord& record) noexcept {
  state_ = nextSafetyState(state_, latched_, atNeutral(), ramp_.authority);
  record.safety_state = state_;
}

bool SafetyChain::finished() const noexcept {
  return atNeutral() || unconfirmed_s_ > kNeutralWithin_s;
}

bool SafetyChain::atNeutral() const noexcept {
  if (ramp_.phase != RampPhase::kNeutral) return false;
  for (int i = 0; i < gains_.axes; ++i) {
    if (ramp_.sent[i] != config_.neutral[i]) return false;  // still held back by the slew limit
  }
  return true;
}

}  // namespace wholehand
