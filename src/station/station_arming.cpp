// From an order to arm to a running loop: all on the station's main thread.
#include "assembly/run_files.hpp"
#include "patient/steered_player.hpp"
#include "runtime/interrupt_scope.hpp"
#include "station/station_core.hpp"
#include "telemetry/disk_room.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {

std::vector<double> Station::Core::parametersAtStart() const {
  const std::lock_guard lock(mutex_);
  std::vector<double> values;
  for (const PublishedParameter& parameter : scene_->parameters) {
    values.push_back(valueOf(parameter));
  }
  return values;
}

// Rehearses the loaded models before their first force, as long as the order may start the device.
Expected<Rehearsal> Station::Core::rehearsalOf(const Models& models, const AxisPosition& start,
                                               const Task& task) const {
  RehearsalOptions options = config_.rehearsal;
  options.cancelled = [this, &task] {
    ++rehearsed_ticks_;
    return !stillDo(task).accepted;
  };
  options.fill_pool = config_.make_device != nullptr;  // a simulated one may be late
  options.status = [this](const std::string& what) { say("rehearsal: measuring " + what); };
  auto rehearsal = rehearse(models, start, config_.rig, options);
  rehearsed_ticks_ = 0;
  if (rehearsal) say("rehearsal " + describe(*rehearsal));
  return rehearsal;
}

// Rehearses the next models while the loop renders; a stop cancels it, and they are loaded
// unrehearsed.
OrderReply Station::Core::rehearseNext(const Models& models, Task task,
                                       std::optional<Rehearsal>& passed) {
  task.starts = true;
  auto rehearsal = rehearsalOf(models, makePlayer(models)->start(), task);
  if (!rehearsal && stillDo(task).accepted) {
    return refused(Refusal::kRehearsalFailed, format(rehearsal.errors()));
  }
  if (rehearsal) passed = std::move(*rehearsal);
  return {true, ""};
}

OrderReply Station::Core::arm(const Task& task, const std::string& record,
                              std::uint64_t duration_ticks, bool for_client) {
  if (live_) {
    const bool ends = status().run_state != RunState::kRendering;
    return ends ? refused(Refusal::kStillStopping,
                          "it is still going to neutral; arm again when it is there")
                : refused(Refusal::kArmedAlready, "it is armed already");
  }
  std::unique_ptr<Player> player = makePlayer(models_);
  std::optional<Expected<Rehearsal>> rehearsal;
  if (config_.rehearse && !rehearsed_) rehearsal = rehearsalOf(models_, player->start(), task);
  if (OrderReply may = stillDo(task); !may.accepted) return may;
  if (rehearsal && !*rehearsal) {
    return refused(Refusal::kRehearsalFailed, format(rehearsal->errors()));
  }
  if (rehearsal) rehearsed_ = std::move(**rehearsal);  // valid until something else is loaded
  return startSession(std::move(player), task, record, duration_ticks, for_client);
}

// A real device, which a person holds, or a simulated one, moved by a virtual patient or a client.
Expected<std::unique_ptr<Rig>> Station::Core::makeRig(std::unique_ptr<Player> player) const {
  if (!config_.make_device) {
    auto steered = std::make_unique<SteeredPlayer>(std::move(player), models_.device);
    return buildRig(models_, std::move(steered), config_.rig);
  }
  auto device = config_.make_device(models_.device);
  if (!device) return device.errors();
  return buildRig(models_, std::move(*device), config_.rig);
}

// All but enabled.
Expected<std::unique_ptr<Run>> Station::Core::prepareRun(std::unique_ptr<Player> player,
                                                         const std::vector<double>& parameters,
                                                         RunPlan plan) const {
  auto rig = makeRig(std::move(player));
  if (!rig) return rig.errors();
  (*rig)->renderer->startParametersAt(parameters);
  if (!plan.record.empty()) {
    const double period_s = config_.rig.period_s;
    const std::string room =
        roomNotice(plan.record, period_s, static_cast<double>(plan.duration_ticks) * period_s);
    if (!room.empty()) say(room);
  }
  plan.real_time_required = config_.real_time_required;
  if (rehearsed_) plan.rehearsed = rehearsed_->passed;
  return Run::prepare(std::move(*rig), std::move(plan));
}

// Publishes the new session before its first record; if it cannot start, publishes the last one
// again.
OrderReply Station::Core::startSession(std::unique_ptr<Player> player, const Task& task,
                                       const std::string& record, std::uint64_t duration_ticks,
                                       bool for_client) {
  RunPlan plan;
  plan.title = title();
  plan.profile = profile_;
  plan.seed = config_.seed + arming_;
  plan.record = record;
  plan.duration_ticks = duration_ticks;
  plan.black_box = blackBoxPath(record);
  plan.interrupts = &InterruptScope::shared();
  plan.sinks.push_back([this](const TickRecord& r) { keepLatest(r); });
  plan.sinks.insert(plan.sinks.end(), sinks_.begin(), sinks_.end());
  const std::optional<double> place = placeOfRest();
  const bool had_latest = forgetLatest();
  LoopStatus before;
  {
    const std::lock_guard lock(mutex_);
    before = status_;
    ++status_.session;
    armed_for_client_ = for_client;
  }
  publishScene(record);
  const std::vector<double> parameters = parametersAtStart();
  auto prepared = prepareRun(std::move(player), parameters, std::move(plan));
  ++arming_;
  std::unique_ptr<Run> unused;
  OrderReply reply;
  if (prepared) {
    unused = std::move(*prepared);
    reply = adopt(unused, task, parameters, place);
    if (reply.accepted) {
      auto begun = live_->begin();
      if (begun) return sessionRuns(std::move(reply), record);
      reply = stillDo(task);  // a stop came while the device was enabled
      if (reply.accepted) reply = refused(Refusal::kCannotStart, format(begun.errors()));
    }
  } else {
    reply = refused(Refusal::kCannotStart, format(prepared.errors()));
  }
  restoreStatus(std::move(before), task, had_latest, std::move(unused));
  return reply;
}

// Restores the published state after a session that never began, and destroys its run.
void Station::Core::restoreStatus(LoopStatus before, const Task& task, bool had_latest,
                                  std::unique_ptr<Run> unused) {
  {
    const std::lock_guard lock(mutex_);
    if (live_) unused = std::move(live_);
    before.endings = status_.endings;
    if (stop_asked_ > task.asked && before.run_state == RunState::kDisarmed) {
      before.run_state = RunState::kStopped;
    }
    status_ = before;
    tracker_.reset();
    for (const CheckedOrders& kept : kept_) tracker_.note(kept);  // they wait for the next one
    registry_.end();
  }
  unused.reset();  // closes its recording outside the lock, so that no client waits for it
  publishScene("");
  const std::lock_guard lock(latest_mutex_);
  has_latest_ = had_latest;
}

OrderReply Station::Core::sessionRuns(OrderReply reply, const std::string& record) {
  for (const SetupLine& line : live_->setup()) {
    if (!line.granted && arming_ == 1) say(line.what + ": " + line.sentence);
  }
  record_path_ = record;
  began_utc_ = utcNow();
  recorded_profile_ = profile_;
  told_of_loss_ = false;
  {
    const std::lock_guard lock(mutex_);
    kept_.clear();
  }
  ++outcome_.sessions;
  return reply;
}

// From here on, a stop reaches the session, also before its first tick. One whose order may not be
// carried out any more, as after a stop during its construction, is discarded and not published.
OrderReply Station::Core::adopt(std::unique_ptr<Run>& run, const Task& task,
                                const std::vector<double>& parameters,
                                std::optional<double> place) {
  const std::lock_guard lock(mutex_);
  if (OrderReply may = mayStillDo(task); !may.accepted) return may;
  live_ = std::move(run);
  const bool takes_bodies = models_.scene.game.slots > 0;
  tracker_.reset(takes_bodies ? models_.exercise->description().event_names
                              : std::vector<std::string>{});
  stops_.clear();
  status_.latched = Fault::kNone;
  const bool steered = renewing_ && status_.steering == Steering::kPerson;
  status_.steering = Steering::kVirtualPatient;
  unsent_steer_.reset();
  left_alone_ = false;
  began_at_ = now();
  status_.run_state = RunState::kRendering;
  rest_ending_ = 0;
  catchUp(parameters, place);
  if (steered) (void)steer(Steering::kPerson);
  if (takes_bodies) {
    beginRegistry();
    handOverKept();
  }
  return {true, ""};
}

// Sends the session what was ordered during its construction.
void Station::Core::catchUp(const std::vector<double>& parameters, std::optional<double> place) {
  live_->setOwnerAlive(owner_alive_);
  if (place) {
    Command begin;
    begin.type = CommandType::kAction;
    begin.index = static_cast<std::int32_t>(ExerciseAction::kBeginAt);
    begin.value = *place;
    (void)push(begin);  // its queue is still empty
  }
  for (std::size_t i = 0; i < std::min(parameters.size(), scene_->parameters.size()); ++i) {
    const double value = valueOf(scene_->parameters[i]);
    if (value == parameters[i]) continue;
    Command command;
    command.type = CommandType::kParameter;
    command.index = static_cast<std::int32_t>(i);
    command.value = value;
    (void)push(command);
  }
}

std::optional<double> Station::Core::placeOfRest() const {
  const int value = models_.exercise ? models_.exercise->description().resume_value : -1;
  {
    const std::lock_guard lock(mutex_);
    if (value < 0 || !rested()) return std::nullopt;
  }
  const std::lock_guard lock(latest_mutex_);
  if (!has_latest_ || value >= latest_.exercise.value_count) return std::nullopt;
  return latest_.exercise.values[value];
}

// Remaining ticks of a run with an end; 0: no end.
std::uint64_t Station::Core::ticksLeft() const {
  if (!ends_at_) return 0;
  const double left_s = std::chrono::duration<double>(*ends_at_ - StationClock::now()).count();
  return static_cast<std::uint64_t>(std::max(1.0, std::round(left_s / config_.rig.period_s)));
}

OrderReply Station::Core::armForClient(const Task& task) {
  if (!config_.record.empty()) {
    return arm(task, pathOfSession(config_.record, outcome_.sessions + 1), ticksLeft(), true);
  }
  const std::string record = newRecording();
  OrderReply reply = arm(task, record, ticksLeft(), true);
  if (!reply.accepted) files_.giveBack(record);
  return reply;
}

// The first session, which no client asked for, and those that follow it while nobody takes part.
// Without a disk it runs unrecorded: there is nobody who could be told that it cannot be armed.
OrderReply Station::Core::armUnasked(const Task& task, std::uint64_t duration_ticks) {
  const std::string record = config_.record.empty() ? newRecording() : config_.record;
  OrderReply reply = arm(task, record, duration_ticks, false);
  if (reply.accepted || !config_.record.empty()) return reply;
  files_.giveBack(record);
  if (record.empty() || reply.refusal != Refusal::kCannotStart) return reply;
  const std::string why = reply.reason;
  reply = arm(task, "", duration_ticks, false);
  if (reply.accepted) say("what follows is not recorded: " + why);
  return reply;
}

// Takes the name of a new recording; empty when none can be made.
std::string Station::Core::newRecording() {
  if (!files_.kept()) return {};
  auto named = files_.nameNew(profile_, scene()->exercise_name, models_.files.level);
  if (!named) {
    say("what follows is not recorded: " + format(named.errors()));
    return {};
  }
  return *named;
}

}  // namespace wholehand
