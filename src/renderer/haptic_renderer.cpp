#include "renderer/haptic_renderer.hpp"

#include "control/bilateral_coupling.hpp"
#include "safety/force_limiter.hpp"
#include "safety/power_limiter.hpp"
#include "safety/slew_limiter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

AxisEffort sum(const AxisEffort& a, const AxisEffort& b) noexcept {
  AxisEffort out(a.size());
  for (int i = 0; i < a.size(); ++i) out[i] = a[i] + b[i];
  return out;
}

AxisEffort difference(const AxisEffort& a, const AxisEffort& b) noexcept {
  AxisEffort out(a.size());
  for (int i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

AxisEffort noted(const LimitedEffort& limited, TickRecord& record) noexcept {
  record.faults |= limited.faults;
  if (record.fault_axis < 0) record.fault_axis = limited.axis;
  return limited.effort;
}

// What is rendered, within the limits that are tighter than the device's.
AxisEffort heldTo(const AxisEffort& limit, const AxisEffort& device_limit,
                  TickRecord& record) noexcept {
  AxisEffort out = record.rendered;
  for (int i = 0; i < out.size(); ++i) {
    if (!(limit[i] < device_limit[i]) || !(std::abs(out[i]) > limit[i])) continue;
    out[i] = std::clamp(out[i], -limit[i], limit[i]);
    record.faults |= Fault::kEffortLimit;
    if (record.fault_axis < 0) record.fault_axis = i;
  }
  return out;
}

// What the walls of an exercise hold: half their effort times the depth in them, with a bounded
// part of the damping's that comes and goes with the motion.
AxisEnergy wallStored(const TickRecord& record) noexcept {
  const ExerciseRecord& exercise = record.exercise;
  AxisEnergy out(exercise.wall_active.size());
  for (int i = 0; i < out.size(); ++i) {
    if (exercise.wall_active[i] == 0.0) continue;
    out[i] = 0.5 * std::abs(exercise.effort[i] * (record.q_m[i] - exercise.wall[i]));
  }
  return out;
}

std::vector<LiveParameter> together(const RendererConfig& config, const Exercise* exercise) {
  std::vector<LiveParameter> all = config.live.parameters();
  if (exercise != nullptr) {
    const std::vector<LiveParameter>& more = exercise->description().parameters;
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

// -Φ K_dm q̇_m,f, the last term of Eq. (3) but one.
AxisEffort dampingEffort(const AxisRatio& phi, const AxisVelocity& qd_mf,
                         const CouplingGains& gains) noexcept {
  AxisEffort out(gains.axes);
  for (int i = 0; i < gains.axes; ++i) out[i] = -phi[i] * gains.k_dm[i] * qd_mf[i];
  return out;
}

}  // namespace

HapticRenderer::HapticRenderer(HapticDevice& device, PhysicsWorld& world, const HandModel& hand,
                               const RendererConfig& config, Exercise* exercise)
    : device_(device),
      world_(world),
      exercise_(exercise),
      config_(config),
      parameters_(together(config, exercise)),
      effort_limit_(config.effort_limit),
      damping_config_(config.damping),
      axis_names_(hand.axis_names),
      dynamics_(hand) {
  ramp_.sent = acknowledged_ = config_.neutral;  // what a device holds that nobody has armed
}

std::vector<LiveParameter> HapticRenderer::liveParameters() const {
  return together(config_, exercise_);
}

void HapticRenderer::startParametersAt(const std::vector<double>& values) noexcept {
  for (std::size_t i = 0; i < values.size(); ++i) {
    parameters_.startAt(static_cast<int>(i), values[i]);
  }
}

std::vector<double> HapticRenderer::parametersAtStart() const {
  return {parameters_.atStart(), parameters_.atStart() + parameters_.count()};
}

void HapticRenderer::tick(std::uint32_t elapsed_periods, TickRecord& record,
                          StageListener* stages) noexcept {
  const auto lap = [stages](Stage stage) noexcept {
    if (stages != nullptr) stages->lap(stage);
  };
  record.elapsed_periods = elapsed_periods;
  record.faults = elapsed_periods > 1 ? Fault::kLateTick : Fault::kNone;
  record.fault_axis = -1;

  takeCommands(elapsed_periods, record);
  readDevice(elapsed_periods, record);
  lap(Stage::kDeviceRead);
  observeWorld(record);
  lap(Stage::kObserve);
  updateDynamics(record);
  lap(Stage::kDynamics);
  control(elapsed_periods, record);
  lap(Stage::kControl);
  exercise(elapsed_periods, record);
  lap(Stage::kExercise);
  makeSafe(elapsed_periods, record);
  lap(Stage::kSafety);
  writeDevice(record);  // the device hears before the solver runs: its time is not a delay (ADR 2)
  lap(Stage::kDeviceWrite);
  stepWorld(record);
  lap(Stage::kPhysicsStep);
  readContacts(record);
  concludeSafety(record);
  lap(Stage::kContacts);
}

void HapticRenderer::takeCommands(std::uint32_t elapsed_periods, TickRecord& record) noexcept {
  for (int i = 0; i < record.command_count; ++i) {
    const Command& command = record.commands[static_cast<std::size_t>(i)];
    if (command.type == CommandType::kParameter) parameters_.ask(command.index, command.value);
    if (command.type == CommandType::kOwner) owner_alive_ = command.value != 0.0;
  }
  parameters_.advance(static_cast<int>(elapsed_periods), config_.period_s);
  config_.live.apply(parameters_.values(), config_.effort_limit, config_.damping, effort_limit_,
                     damping_config_);
  record.effort_limit = effort_limit_;
  record.parameter_count = parameters_.count();
  std::copy_n(parameters_.values(), parameters_.count(), record.parameters.begin());
}

void HapticRenderer::readDevice(std::uint32_t elapsed_periods, TickRecord& record) noexcept {
  const Fault fault = device_.read(reading_, static_cast<int>(elapsed_periods));
  record.faults |= fault;
  if (reading_.q_m.size() != config_.gains.axes) {  // a missing axis would read as 0 and be pulled
    record.faults |= Fault::kDeviceRead;
    reading_.q_m = AxisPosition(config_.gains.axes, std::numeric_limits<double>::quiet_NaN());
  } else if (!any(fault & kStopping) && !allFinite(reading_.q_m)) {
    record.faults |= Fault::kNonFinitePosition;
    for (int i = config_.gains.axes; i-- > 0;) {
      if (!std::isfinite(reading_.q_m[i])) record.fault_axis = i;
    }
  }
  // Once it falls to neutral, motion is not judged: who pressed springs forward when it lets go.
  if (!any(record.faults & kStopping) && ramp_.phase == RampPhase::kRendering) {
    const Finding finding = watchDevice(device_watch_, reading_.q_m, ramp_.sent,
                                        static_cast<int>(elapsed_periods), config_.supervisor);
    record.faults |= finding.faults;
    record.fault_axis = finding.axis;
  }
  record.q_m = reading_.q_m;
  record.intention = reading_.intention;
  record.patient_effort = reading_.patient_effort;
}

void HapticRenderer::observeWorld(TickRecord& record) noexcept {
  record.faults |= world_.observe(query_, state_);
  record.q_s = state_.q_s;
  record.qd_s = state_.qd_s;
  record.theta = state_.theta;
  record.coupling_error_rad = state_.coupling_error_rad;
  record.palm_distance_m = state_.palm_distance_m;
  record.palm_body = state_.palm_body;
  record.palm_target_distance_m = state_.palm_target_distance_m;
  record.closure = state_.closure;
  record.body_count = state_.body_count;
  std::copy_n(state_.bodies.begin(), state_.body_count, record.bodies.begin());
  if (ramp_.phase == RampPhase::kRendering)
    record.faults |= watchWorld(world_watch_, record, config_.supervisor);
}

void HapticRenderer::updateDynamics(TickRecord& record) noexcept {
  if (!dynamics_.update(state_.theta, state_.theta_dot, config_.gravity_m_s2)) {
    record.faults |= Fault::kSingularInertia;
  }
}

void HapticRenderer::control(std::uint32_t elapsed_periods, TickRecord& record) noexcept {
  const CouplingGains& gains = config_.gains;
  const int elapsed = static_cast<int>(elapsed_periods);
  const double period_s = config_.period_s;
  if (any(record.faults & kStopping)) {  // what was read cannot be trusted: nothing new is computed
    record.qd_mf = velocity_.filtered;
    record.f_s = AxisEffort(gains.axes);
    record.coupling = AxisEffort(gains.axes);
    return;
  }
  velocity_ = estimateVelocity(velocity_, record.q_m, gains, elapsed, period_s);
  record.qd_mf = velocity_.filtered;
  record.f_s = avatarEffort(
      record.q_m, record.qd_mf, record.q_s, record.qd_s,
      driveInertia(dynamics_.reducedInertia(), dynamics_.reducedInertiaInverse()), gains);
  record.coupling = couplingEffort(record.q_m, record.qd_mf, record.q_s, record.qd_s, gains);
}

void HapticRenderer::exercise(std::uint32_t elapsed_periods, TickRecord& record) noexcept {
  const CouplingGains& gains = config_.gains;
  record.exercise.effort = AxisEffort(gains.axes);
  record.exercise.event_count = 0;
  record.placements.count = 0;
  record.damping = AxisEffort(gains.axes);
  record.phi = damping_.phi;
  if (any(record.faults & kStopping)) {  // no effort: then no transition and no wall either
    record.exercise.alpha = 0.0;
    record.exercise.wall_active = AxisRatio(gains.axes);
    return;
  }
  if (exercise_ != nullptr) {
    showContacts(record);  // of the last step
    ExerciseInput input;
    input.period_s = config_.period_s;
    input.observed = &record;
    input.parameters = parameters_.values() + config_.live.parameters().size();
    input.may_push = owner_alive_ && ramp_.phase == RampPhase::kRendering;
    exercise_->tick(input, record.exercise, record.placements);
    query_ = exercise_->query();
  }
  damping_ = adaptDamping(damping_, sum(record.coupling, record.exercise.effort), damping_config_,
                          static_cast<int>(elapsed_periods), config_.period_s);
  record.phi = damping_.phi;
  record.damping = dampingEffort(record.phi, record.qd_mf, gains);
}

void HapticRenderer::watchEnergy(std::uint32_t elapsed_periods, TickRecord& record) noexcept {
  record.tank_effort = AxisEffort(config_.gains.axes);
  record.tank = tank_.energy;
  if (config_.tank.axes == 0 || any(record.faults & kStopping)) return;
  const EnergyTankStep step =
      advanceTank(tank_, record.q_m, record.q_s, wallStored(record), config_.gains, config_.tank,
                  effort_limit_, static_cast<int>(elapsed_periods), config_.period_s);
  tank_ = step.state;
  record.tank = tank_.energy;
  // While an effort is blended in, the springs hold what nobody was given yet: nothing to judge.
  if (ramp_.authority < 1.0) return;
  record.tank_effort = step.effort;
  for (double effort : step.effort) {
    if (effort != 0.0) record.faults |= Fault::kTankEmpty;
  }
}

void HapticRenderer::makeSafe(std::uint32_t elapsed_periods, TickRecord& record) noexcept {
  watchEnergy(elapsed_periods, record);
  record.rendered =
      sum(sum(sum(record.coupling, record.exercise.effort), record.damping), record.tank_effort);
  const AxisEffort wanted = withinEffort(record);
  latched_ |= record.faults & kStopping;
  // The emergency first: who presses counts the stop first, so that none is seen without the other.
  const bool emergency = emergencies_.load(std::memory_order_seq_cst) != emergencies_armed_;
  stops_seen_ = stops_.load(std::memory_order_seq_cst);
  const bool asked = emergency || stops_seen_ != stops_armed_;
  if (asked) record.faults |= Fault::kStopRequested;
  if (emergency) record.faults |= Fault::kEmergencyStop;
  if (!owner_alive_) record.faults |= Fault::kOwnerSilent;
  const AxisEffort last = ramp_.sent;
  ramp_ = advanceRamp(ramp_, wanted, config_.neutral, any(latched_) || asked,
                      static_cast<int>(elapsed_periods), config_.period_s, config_.ramp);
  if (ramp_.phase == RampPhase::kRendering) {  // a ramp only ever falls, and knows no good velocity
    ramp_.sent = noted(
        limitPower(ramp_.sent, config_.neutral, record.qd_mf, config_.supervisor.power_limit_w),
        record);
  }
  if (config_.supervisor.axes > 0) {
    ramp_.sent = noted(limitSlew(ramp_.sent, last, config_.supervisor.most_change), record);
  }
  record.authority = ramp_.authority;
  record.sent = ramp_.sent;
  if (config_.tank.axes == 0) return;
  tank_ = noteSent(tank_, difference(record.sent, config_.neutral), record.qd_mf, record.qd_s,
                   config_.gains);
  if (ramp_.authority < 1.0) tank_.energy = config_.tank.capacity;
}

// What may be sent of what is rendered. A therapist's limit is on what is rendered; the device's
// own on all that is sent, the effort that carries its weight with it.
AxisEffort HapticRenderer::withinEffort(TickRecord& record) const noexcept {
  const AxisEffort held = heldTo(effort_limit_, config_.effort_limit, record);
  return noted(limitEffort(sum(held, config_.neutral), config_.effort_limit), record);
}

// Last in the tick: a device that refused the effort or a world that could not step has faulted it.
void HapticRenderer::concludeSafety(TickRecord& record) noexcept {
  safety_state_ = nextSafetyState(safety_state_, latched_, atNeutral(), ramp_.authority);
  record.safety_state = safety_state_;
}

void HapticRenderer::writeDevice(TickRecord& record) noexcept {
  const Fault fault = device_.write(record.sent);
  record.faults |= fault;
  latched_ |= fault & kStopping;
  if (!any(fault & Fault::kDeviceWrite)) {
    acknowledged_ = record.sent;
    return;
  }
  // It goes on with what it holds: the ramp, the slew limit and the record go by that.
  ramp_.sent = record.sent = acknowledged_;
  if (ramp_.phase == RampPhase::kNeutral) unconfirmed_s_ += config_.period_s;
}

void HapticRenderer::stepWorld(TickRecord& record) noexcept {
  if (any(latched_)) return;  // after a fault the world stands still
  if (record.placements.count > 0) {
    world_.placeBodies(record.placements);
    notePlaced(world_watch_, record.placements);
  }
  HandDrive drive;
  dynamics_.distribute(record.f_s, drive.torque);
  drive.reduced_inertia_inverse = &dynamics_.reducedInertiaInverse();
  const Fault fault = world_.step(drive, config_.period_s);
  record.faults |= fault;
  latched_ |= fault & kStopping;
}

void HapticRenderer::readContacts(TickRecord& record) noexcept {
  world_.contacts(contacts_);
  showContacts(record);
  if (contacts_.dropped > 0) record.faults |= Fault::kContactsDropped;
}

void HapticRenderer::showContacts(TickRecord& record) const noexcept {
  record.contact_count = contacts_.count;
  record.contacts_dropped = contacts_.dropped;
  std::copy_n(contacts_.points.begin(), contacts_.count, record.contacts.begin());
}

}  // namespace wholehand
