#include "loop/renderer/haptic_renderer.hpp"

// Arming, stopping and one tick of the renderer.

#include "loop/control/bilateral_coupling.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/physics/hand_probe.hpp"
#include "loop/physics/physics_world.hpp"

#include <climits>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace wholehand {
namespace {

std::vector<LiveParameter> allLiveParameters(const RendererConfig& config,
                                             const Exercise* exercise) {
  std::vector<LiveParameter> all = config.live.parameters();
  if (exercise != nullptr) {
    const std::vector<LiveParameter>& more = exercise->description().parameters;
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

}  // namespace

HapticRenderer::HapticRenderer(HapticDevice& device, PhysicsWorld& world, const HandModel& hand,
                               const SceneModel& scene, const RendererConfig& config,
                               Exercise* exercise, const KnownPerson* person)
    : device_(device),
      world_(world),
      pool_(scene.game.slots > 0 ? world.bodyPool() : nullptr),
      exercise_(exercise),
      person_(person),
      config_(config),
      safety_(config.safety, config.gains, scene, config.period_s),
      parameters_(allLiveParameters(config, exercise)),
      effort_limit_(config.safety.effort_limit),
      damping_config_(config.damping),
      axis_names_(hand.axis_names),
      dynamics_(hand, config.gains.armature),
      probe_(std::make_unique<HandProbe>(hand, scene)),
      avatar_damping_(config.gains.axes) {
  if (config.guides) guides_.emplace(*config.guides);
  // An engine that does not report the joints of bodies leaves them unknown.
  state_.body_joint_count = static_cast<int>(scene.recordedJoints().size());
  state_.body_q.fill(std::numeric_limits<double>::quiet_NaN());
  state_.body_qd = state_.body_q;
}

HapticRenderer::~HapticRenderer() = default;

std::vector<LiveParameter> HapticRenderer::liveParameters() const {
  return allLiveParameters(config_, exercise_);
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
  const auto lap = [stages](Stage stage) noexcept {
    if (stages != nullptr) stages->lap(stage);
  };
  // The control laws count periods in an int: after a suspension of days the number must not
  // overflow.
  record.elapsed_periods = std::clamp<std::uint32_t>(periods, 1, INT_MAX);
  record.faults = record.elapsed_periods > 1 ? Fault::kLateTick : Fault::kNone;
  record.fault_axis = -1;

  safety_.takeStops(record);
  takeCommands(record);
  readDevice(record);
  lap(Stage::kDeviceRead);
  observeWorld(record);
  lap(Stage::kObserve);
  updateDynamics(record);
  probeHand(record);
  lap(Stage::kDynamics);
  couple(record);
  lap(Stage::kControl);
  exercise(record);
  if (guides_) guide(record);
  damp(record);
  lap(Stage::kExercise);
  safety_.watchEnergy(avatarEnergy(record), guides_ ? &guides_->stored_j() : nullptr, record);
  record.rendered =
      sum(sum(sum(record.coupling, record.exercise.effort), record.damping), record.tank_effort);
  if (guides_) record.rendered = sum(record.rendered, guides_->effort());
  safety_.limitEffort(record);
  lap(Stage::kSafety);
  writeDevice(record);  // before the solver, whose computing time would delay the effort (ADR 2)
  lap(Stage::kDeviceWrite);
  stepWorld(record);
  lap(Stage::kPhysicsStep);
  readContacts(record);
  safety_.conclude(record);
  lap(Stage::kContacts);
}

// True while the client that holds the controls is alive and no stop is requested.
bool HapticRenderer::mayPush(const TickRecord& record) const noexcept {
  return holder_alive_ && !any(record.faults & Fault::kStopRequested);
}

void HapticRenderer::takeCommands(TickRecord& record) noexcept {
  for (int i = 0; i < record.command_count; ++i) {
    const Command& command = record.commands[i];
    if (command.type == CommandType::kParameter) {
      // No effort was sent before the first tick, so there is nothing to ramp from.
      if (first_tick_) {
        parameters_.set(command.index, command.value);
      } else {
        parameters_.ask(command.index, command.value);
      }
    }
    if (command.type == CommandType::kHolderAlive) holder_alive_ = command.value != 0.0;
  }
  first_tick_ = false;
  if (!holder_alive_) record.faults |= Fault::kHolderSilent;
  parameters_.advance(static_cast<int>(record.elapsed_periods), config_.period_s);
  config_.live.apply(parameters_.values(), config_.safety.effort_limit, config_.damping,
                     effort_limit_, damping_config_);
  record.effort_limit = effort_limit_;
  record.parameter_count = parameters_.count();
  std::copy_n(parameters_.values(), parameters_.count(), record.parameters.begin());
}

void HapticRenderer::readDevice(TickRecord& record) noexcept {
  const Fault fault = device_.read(reading_, static_cast<int>(record.elapsed_periods));
  record.q_m = reading_.q_m;
  if (person_ != nullptr) person_->report(person_reading_);
  record.intention = person_reading_.intention;
  record.patient_effort = person_reading_.effort;
  record.moved_by = person_reading_.moved_by;
  record.help = person_reading_.help;
  safety_.checkReading(fault, record);
}

void HapticRenderer::observeWorld(TickRecord& record) noexcept {
  record.faults |= world_.observe(state_);
  record.q_s = state_.q_s;
  record.qd_s = state_.qd_s;
  record.theta = state_.theta;
  record.coupling_error_rad = state_.coupling_error_rad;
  record.body_count = state_.body_count;
  std::copy_n(state_.bodies.begin(), state_.body_count, record.bodies.begin());
  record.body_joint_count = state_.body_joint_count;
  std::copy_n(state_.body_q.begin(), state_.body_joint_count, record.body_q.begin());
  std::copy_n(state_.body_qd.begin(), state_.body_joint_count, record.body_qd.begin());
  PoolEnergy pool;
  if (pool_ != nullptr) {
    pool_->report(pool_report_);
    pool = {pool_report_.held_j, pool_report_.received_j};
  }
  safety_.checkWorld(contacts_.points.data(), contacts_.count, pool, record);
}

void HapticRenderer::updateDynamics(TickRecord& record) noexcept {
  const Eigen::Vector3d& gravity_m_s2 = config_.gravity_m_s2;
  const bool definite =
      state_.kinematics != nullptr
          ? dynamics_.updateFrom(*state_.kinematics, state_.theta_dot, gravity_m_s2)
          : dynamics_.update(state_.theta, state_.theta_dot, gravity_m_s2);
  if (!definite) record.faults |= Fault::kSingularInertia;
}

void HapticRenderer::probeHand(TickRecord& record) noexcept {
  if (any(record.faults & kStoppingFaults)) {
    probe_->clearMeasurements(record);
  } else {
    probe_->look(&dynamics_.linkPose(0), query_, record);
  }
}

void HapticRenderer::couple(TickRecord& record) noexcept {
  const CouplingGains& gains = config_.gains;
  // After a stopping fault the reading cannot be trusted: nothing new is computed.
  if (any(record.faults & kStoppingFaults)) {
    record.qd_mf = velocity_.filtered;
    record.f_s = AxisEffort(gains.axes);
    record.coupling = AxisEffort(gains.axes);
    return;
  }
  const int elapsed = static_cast<int>(record.elapsed_periods);
  velocity_ = estimateVelocity(velocity_, record.q_m, gains, elapsed, config_.period_s);
  record.qd_mf = velocity_.filtered;
  avatar_damping_ = avatarDamping(dynamics_.reducedInertia(), gains.k_pm, config_.period_s);
  record.f_s =
      avatarEffort(record.q_m, record.qd_mf, record.q_s, record.qd_s, avatar_damping_, gains);
  record.coupling =
      couplingEffort(record.q_m, record.qd_mf, record.q_s, record.qd_s, avatar_damping_, gains);
}

void HapticRenderer::exercise(TickRecord& record) noexcept {
  const int axes = config_.gains.axes;
  record.exercise.effort = AxisEffort(axes);
  record.exercise.event_count = 0;
  record.placements.count = 0;
  // Without effort there is no transition and no wall either.
  if (any(record.faults & kStoppingFaults)) {
    record.exercise.alpha = 0.0;
    record.exercise.wall_active = AxisFlag(axes);
    return;
  }
  if (exercise_ == nullptr) return;
  showContacts(record);  // contacts of the last step
  ExerciseInput input;
  input.period_s = config_.period_s;
  input.observed = &record;
  input.hand = &dynamics_;
  input.parameters = parameters_.values() + config_.live.parameters().size();
  input.pool = pool_ != nullptr ? &pool_report_ : nullptr;
  input.may_push = mayPush(record) && safety_.rendering();
  exercise_->tick(input, record.exercise, record.placements);
  query_ = exercise_->query();
}

// Computes the efforts of the prescription.
void HapticRenderer::guide(TickRecord& record) noexcept {
  if (any(record.faults & kStoppingFaults)) {
    guides_->clear();
    return;
  }
  guides_->boundExercise(record.q_m, record.exercise);
  guides_->advance(record.q_m, exercise_ != nullptr ? exercise_->goal() : MovementGoal{},
                   mayPush(record) && safety_.rendering(),
                   record.elapsed_periods * config_.period_s);
}

// Computes the adaptive damping by Algorithm 1, and its effort -Φ K_dm q̇_m,f, the last term of Eq.
// (3) but one.
void HapticRenderer::damp(TickRecord& record) noexcept {
  const CouplingGains& gains = config_.gains;
  record.damping = AxisEffort(gains.axes);
  record.phi = damping_.phi;
  if (any(record.faults & kStoppingFaults)) return;
  AxisEffort pushed = sum(record.coupling, record.exercise.effort);
  if (guides_) pushed = sum(pushed, guides_->effort());
  damping_ = adaptDamping(damping_, pushed, damping_config_,
                          static_cast<int>(record.elapsed_periods), config_.period_s);
  record.phi = damping_.phi;
  for (int i = 0; i < gains.axes; ++i) {
    record.damping[i] = -record.phi[i] * gains.k_dm[i] * record.qd_mf[i];
  }
}

/// ½ q̇ᵀ M_r q̇
double HapticRenderer::avatarEnergy(const TickRecord& record) const noexcept {
  const AxisMatrix& inertia = dynamics_.reducedInertia();
  double energy_j = 0.0;
  for (int a = 0; a < record.qd_s.size(); ++a) {
    for (int b = 0; b < record.qd_s.size(); ++b) {
      energy_j += 0.5 * record.qd_s[a] * inertia(a, b) * record.qd_s[b];
    }
  }
  return energy_j;
}

void HapticRenderer::writeDevice(TickRecord& record) noexcept {
  safety_.checkWrite(device_.write(record.sent), record);
}

void HapticRenderer::orderBodies(const TickRecord& record) noexcept {
  if (pool_ == nullptr) return;
  pool_->setGameAlive(mayPush(record));
  for (int i = 0; i < record.command_count; ++i) pool_->apply(record.commands[i]);
}

void HapticRenderer::stepWorld(TickRecord& record) noexcept {
  if (any(safety_.latched())) return;  // the world stops after a fault
  orderBodies(record);
  if (record.placements.count > 0) {
    world_.placeBodies(record.placements);
    safety_.notePlaced(record);
  }
  HandDrive drive;
  drive.effort = record.f_s;
  dynamics_.distribute(record.f_s, drive.torque);
  drive.armature = config_.gains.armature;
  drive.armature_effort = dynamics_.armatureEffort(record.f_s);
  drive.reduced_inertia_inverse = &dynamics_.reducedInertiaInverse();
  safety_.checkStep(world_.step(drive, config_.period_s), record);
  world_.contacts(contacts_);
}

void HapticRenderer::readContacts(TickRecord& record) noexcept {
  showContacts(record);
  if (contacts_.dropped > 0) record.faults |= Fault::kContactsDropped;
}

void HapticRenderer::showContacts(TickRecord& record) const noexcept {
  record.contact_count = contacts_.count;
  record.contacts_dropped = contacts_.dropped;
  std::copy_n(contacts_.points.begin(), contacts_.count, record.contacts.begin());
}

namespace {

// Diagnostic of a refusal that concerns no file and no value.
Diagnostic armingProblem(const char* problem, const char* remedy) {
  return fileFault("", problem, remedy);
}

}  // namespace

// Checks before the device is opened.
Expected<Done> HapticRenderer::mayArm(const std::optional<RehearsalPassed>& rehearsed) const {
  if (!safety_.rendering() && !finished()) {
    return armingProblem("the device is still on its way to neutral", "arm again then");
  }
  if (device_.simulated()) return Done{};
  if (safety_.rendering()) {
    return armingProblem("the device is armed already", "stop it first");
  }
  if (config_.moves_nobody) return Done{};
  if (Expected<Done> cleared = device_.cleared(); !cleared) return cleared;
  if (!rehearsed) {
    return armingProblem("the device may move a person, and nothing was rehearsed",
                         "call rehearse() and arm with what it says has passed");
  }
  if (rehearsed->of() != config_.rehearsal) {
    return armingProblem("what was rehearsed is not what is to be rendered",
                         "rehearse these models, with these options");
  }
  return Done{};
}

// Checks that the reading is within the workspace.
Expected<Done> HapticRenderer::withinWorkspace() const {
  const SupervisorConfig& limits = config_.safety.supervisor;
  const Finding finding = safety_.checkAtRest(reading_.q_m);
  if (!any(finding.faults)) return Done{};
  const int a = finding.axis;
  const std::string range =
      "[" + std::to_string(limits.lower[a]) + ", " + std::to_string(limits.upper[a]) + "]";
  return keyFault("", axis_names_[a], std::to_string(reading_.q_m[a]),
                  "is outside the device's workspace " + range,
                  "move it back by hand, or calibrate the device");
}

// Closes the device after a refusal, because nobody will tick it. A device that was open before
// stays open and keeps carrying its weight.
Expected<Done> HapticRenderer::refuseArming(Diagnostics why) {
  prepared_ = false;
  if (!was_open_) device_.close();
  device_open_ = was_open_;
  return why;
}

Expected<Done> HapticRenderer::prepare(const std::optional<RehearsalPassed>& rehearsed) {
  if (prepared_) return Done{};
  // A person requested this stop, so it must not be lost.
  if (safety_.stops().consumeUnseen()) {
    return armingProblem("a stop was asked for", "arm again if it is over");
  }
  if (Expected<Done> may = mayArm(rehearsed); !may) return may;
  if (Expected<Done> opened = device_.open(); !opened) return opened;
  was_open_ = std::exchange(device_open_, true);
  if (Expected<Done> ready = device_.ready(); !ready) return refuseArming(ready.errors());
  if (any(device_.read(reading_, 1)) || !allFinite(reading_.q_m) ||
      reading_.q_m.size() != config_.gains.axes) {
    return refuseArming(
        {armingProblem("the device gives no position", "check that it is connected")});
  }
  if (Expected<Done> within = withinWorkspace(); !within) return refuseArming(within.errors());
  if (Expected<Done> placed = world_.placeHand(reading_.q_m); !placed) {
    return refuseArming(placed.errors());
  }
  armed_position_ = reading_.q_m;
  prepared_ = true;
  return Done{};
}

Expected<Done> HapticRenderer::arm(const std::optional<RehearsalPassed>& rehearsed) {
  if (!prepared_) {
    if (Expected<Done> prepared = prepare(rehearsed); !prepared) return prepared;
  }
  const auto stopped = [this] {
    return refuseArming(
        {armingProblem("a stop was asked for while the device was being armed", "")});
  };
  if (safety_.stops().consumeUnseen()) return stopped();
  if (Expected<Done> enabled = device_.enable(); !enabled) return refuseArming(enabled.errors());
  if (!safety_.stops().arm()) return stopped();
  prepared_ = false;
  const int axes = config_.gains.axes;
  velocity_ = VelocityState{};
  damping_ = AdaptiveDampingState{AxisRatio(axes), AxisRatio(axes)};
  parameters_.reset();
  first_tick_ = true;
  contacts_ = ContactList{};
  query_ = WorldQuery{};
  probe_->reset();
  holder_alive_ = true;
  if (guides_) guides_->begin(armed_position_);
  if (exercise_ != nullptr) {
    exercise_->reset();
    query_ = exercise_->query();
  }
  safety_.arm(armed_position_);
  return Done{};
}

void HapticRenderer::disarm() noexcept {
  prepared_ = false;
  safety_.disarm();
}

}  // namespace wholehand
