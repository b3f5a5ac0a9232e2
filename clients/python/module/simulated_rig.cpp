#include "simulated_rig.hpp"

#include "loop/patient/motion.hpp"
#include "loop/patient/steered_player.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "rig/models.hpp"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <limits>
#include <thread>
#include <utility>

namespace wholehand::python {
namespace {

std::unique_ptr<Player> playerOf(const Models& models, std::uint64_t seed) {
  std::unique_ptr<Player> player = makeExercisePlayer(models, seed);
  if (!player) player = makeMotionPlayer(models);
  return std::make_unique<SteeredPlayer>(std::move(player), models.device);
}

}  // namespace

SimulatedRig::SimulatedRig(Models models, RigOptions options)
    : models_(std::move(models)), options_(std::move(options)) {}

Expected<std::unique_ptr<SimulatedRig>> SimulatedRig::load(const RigFiles& from) {
  Expected<Models> models = loadModels(from.files);
  if (!models) return models.errors();
  return std::unique_ptr<SimulatedRig>(new SimulatedRig(std::move(*models), from.options));
}

Expected<Done> SimulatedRig::reset(std::uint64_t seed, TickRecord& record) {
  rig_.reset();  // before the next one: both would use the same exercise
  auto rig = buildRig(models_, playerOf(models_, seed), options_);
  if (!rig) return rig.errors();
  if (auto armed = (*rig)->renderer->arm(); !armed) return armed.errors();
  rig_ = std::move(*rig);
  record_ = &record;
  next_tick_ = 0;
  steered_ = false;
  command_count_ = 0;
  history_ = {};
  history_.seed = seed;
  history_.whole = keeps_history_;
  describeStart();
  return Done{};
}

Expected<Done> SimulatedRig::runAgain(const RigHistory& history, TickRecord& record) {
  if (auto done = reset(history.seed, record); !done) return done;
  const int axes = models_.device.axisCount();
  const double* next = history.aims.data();
  for (const std::int64_t ticks : history.ticks) {
    AxisPosition aim(axes);
    if (ticks > 0) {
      std::copy_n(next, axes, aim.data());
      next += axes;
    }
    steer(ticks > 0 ? &aim : nullptr);
    for (std::int64_t left = std::abs(ticks); left > 0 && running();) {
      left -= run(static_cast<int>(std::min<std::int64_t>(left, std::numeric_limits<int>::max())));
    }
  }
  return Done{};
}

// Stretches without an aim are one.
void SimulatedRig::keep(const AxisPosition* aim) {
  if (!history_.whole) return;
  std::vector<std::int64_t>& ticks = history_.ticks;
  if (aim == nullptr && !ticks.empty() && ticks.back() <= 0) return;
  if (ticks.size() == kMostSteps) {
    history_.whole = false;
    return;
  }
  ticks.push_back(0);
  if (aim != nullptr)
    history_.aims.insert(history_.aims.end(), aim->data(), aim->data() + aim->size());
}

// The record of a tick that has not been: the hand stands still where it was armed.
void SimulatedRig::describeStart() noexcept {
  const int axes = models_.device.axisCount();
  TickRecord& record = *record_ = TickRecord{};
  record.q_m = record.intention = rig_->renderer->armedPosition();
  record.safety_state = rig_->renderer->safetyState();
  record.palm_distance_m = record.palm_target_distance_m = std::numeric_limits<double>::infinity();
  PhysicsState state;
  record.faults |= rig_->world->observe(state);
  record.q_s = state.q_s;
  record.qd_s = state.qd_s;
  record.theta = state.theta;
  record.body_count = state.body_count;
  std::copy_n(state.bodies.begin(), state.body_count, record.bodies.begin());
  record.qd_mf = AxisVelocity(axes);
  for (AxisEffort* effort : {&record.patient_effort, &record.f_s, &record.coupling, &record.damping,
                             &record.rendered, &record.sent, &record.exercise.effort}) {
    *effort = AxisEffort(axes);
  }
  record.phi = AxisRatio(axes);
  if (models_.exercise) {
    record.exercise.value_count =
        static_cast<std::int32_t>(models_.exercise->description().value_names.size());
  }
}

void SimulatedRig::steer(const AxisPosition* aim) {
  keep(aim);
  command_count_ = 0;
  const bool steered = aim != nullptr;
  if (steered != steered_) {
    Command& steer = commands_[command_count_++] = Command{};
    steer.type = CommandType::kSteer;
    steer.index =
        static_cast<std::int32_t>(steered ? Steering::kPerson : Steering::kVirtualPatient);
  }
  steered_ = steered;
  if (!steered) return;
  Command& command = commands_[command_count_++] = Command{};
  command.type = CommandType::kAim;
  command.aim = *aim;
}

int SimulatedRig::run(int ticks) noexcept {
  const DenormalsFlushed scope;  // as in the program's loop: the same bits
  TickRecord& record = *record_;
  HapticRenderer& renderer = *rig_->renderer;
  int ran = 0;
  while (ran < ticks && !renderer.finished()) {
    record.tick = next_tick_++;
    record.time_s = static_cast<double>(record.tick) * options_.period_s;
    record.command_count = std::exchange(command_count_, 0);
    std::copy_n(commands_, record.command_count, record.commands.begin());
    rig_->listener->beforeTick(record);
    renderer.tick(1, record);
    rig_->listener->afterTick(record);
    ++ran;
  }
  if (history_.whole) history_.ticks.back() += steered_ ? ran : -ran;
  return ran;
}

bool SimulatedRig::running() const noexcept {
  return rig_ != nullptr && !rig_->renderer->finished();
}

Fault SimulatedRig::endedBy() const noexcept {
  return rig_ != nullptr ? rig_->renderer->latched() : Fault::kNone;
}

Expected<std::unique_ptr<RigVector>> RigVector::load(const RigFiles& from, int count, int threads) {
  std::unique_ptr<RigVector> vector(new RigVector);
  vector->threads_ = std::min(threads, count);
  vector->records_.resize(count);
  for (int i = 0; i < count; ++i) {
    auto rig = SimulatedRig::load(from);
    if (!rig) return rig.errors();
    vector->rigs_.push_back(std::move(*rig));
  }
  return Expected<std::unique_ptr<RigVector>>(std::move(vector));
}

// Calls work(i) for every rig; each thread takes the next one that none has.
template <class Work>
void RigVector::onThreads(const Work& work) {
  std::atomic<int> next{0};
  const auto take = [&] {
    for (int i = next++; i < size(); i = next++) work(i);
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < threads_; ++i) others.emplace_back(take);
  take();
}

Expected<Done> RigVector::reset(const std::vector<std::uint64_t>& seeds) {
  std::vector<Diagnostics> refused(rigs_.size());
  onThreads([&](int i) {
    if (auto done = resetOne(i, seeds[i]); !done) refused[i] = done.errors();
  });
  for (const Diagnostics& why : refused) {
    if (!why.empty()) return why;
  }
  return Done{};
}

Expected<Done> RigVector::resetOne(int rig, std::uint64_t seed) {
  return rigs_[rig]->reset(seed, records_[rig]);
}

void RigVector::run(int ticks) {
  onThreads([&](int i) {
    if (rigs_[i]->running()) rigs_[i]->run(ticks);
  });
}

}  // namespace wholehand::python
