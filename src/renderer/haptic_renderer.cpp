#include "renderer/haptic_renderer.hpp"

#include "control/bilateral_coupling.hpp"
#include "renderer/effort_sum.hpp"
#include "renderer/note_fault.hpp"

#include <climits>

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

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
      dynamics_(hand, config.gains.armature),
      slew_(config.supervisor.slew_ticks) {
  avatar_damping_ = AxisRatio(config_.gains.axes);
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

void HapticRenderer::tick(std::uint32_t periods, TickRecord& record,
                          StageListener* stages) noexcept {
  // The laws count in int: a machine that was asleep for days must not come back in the past.
  const std::uint32_t elapsed_periods = std::clamp<std::uint32_t>(periods, 1, INT_MAX);
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
  avatar_damping_ = avatarDamping(dynamics_.reducedInertia(), gains.k_pm, period_s);
  record.f_s =
      avatarEffort(record.q_m, record.qd_mf, record.q_s, record.qd_s, avatar_damping_, gains);
  record.coupling =
      couplingEffort(record.q_m, record.qd_mf, record.q_s, record.qd_s, avatar_damping_, gains);
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

void HapticRenderer::stepWorld(TickRecord& record) noexcept {
  if (any(latched_)) return;  // after a fault the world stands still
  if (record.placements.count > 0) {
    world_.placeBodies(record.placements);
    notePlaced(world_watch_, record.placements);
  }
  HandDrive drive;
  dynamics_.distribute(record.f_s, drive.torque);
  drive.armature = config_.gains.armature;
  drive.armature_effort = dynamics_.armatureEffort(record.f_s);
  drive.reduced_inertia_inverse = &dynamics_.reducedInertiaInverse();
  const Fault fault = world_.step(drive, config_.period_s);
  noteFault(fault, -1, record);
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
