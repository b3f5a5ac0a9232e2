#include "station/station.hpp"

#include "loop/realtime/monotonic_clock.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "station/station_core.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace wholehand {
namespace {

constexpr const char* kLevelDone = "level_done";  // event that ends a level (docs/exercises.md)

std::shared_ptr<const StationRules> rulesOf(const StationConfig& config) {
  StationRules rules;
  rules.rehearse = config.rehearse;
  rules.robot = config.make_device != nullptr;
  rules.clinic = !config.visit_hands_folder.empty();
  rules.records = !config.recordings_folder.empty();
  rules.record_named = !config.record.empty();
  rules.renew_after = config.renew_after;
  rules.first_parameters = config.first_parameters;
  return std::make_shared<const StationRules>(std::move(rules));
}

}  // namespace

Station::Core::Core(StationConfig config)
    : config_(std::move(config)),
      reader_(config_.config_folder, config_.visit_hands_folder, config_.rig),
      files_(config_.recordings_folder),
      profiles_(config_.profiles_folder),
      reports_(config_.make_report),
      log_(config_.log),
      state_(rulesOf(config_)),
      answers_(config_.make_device != nullptr) {}

// Decisions and their effects; any thread.

// Decides, does the effects under the same lock, and answers and logs outside it.
void Station::Core::feed(const events::Any& event, const std::function<void(OrderReply)>& done) {
  Replies said;
  {
    const std::lock_guard lock(mutex_);
    renewInputs();
    if (done) asking_[state_.orders + 1] = done;  // the number that the order gets
    for (const effects::Any& effect : decide(state_, event, now())) carryOut(effect, said);
    claim_ = state_.claim;
    if (state_.quit || !state_.waiting.empty()) wake_.notify_all();
  }
  for (const std::string& line : said.lines) log(line);
  for (auto& [answer, reply] : said.replies) answer(std::move(reply));
}

void Station::Core::renewInputs() {
  state_.interrupted = InterruptScope::interrupted();
  LoopStatus seen;
  seen.run_state = state_.run_state;
  nameSafety(seen);
  state_.loop_ends = live_ && (seen.run_state != state_.run_state || !live_->running());
}

void Station::Core::reply(std::uint64_t asked, OrderReply reply, Replies& said) {
  const auto found = asking_.find(asked);
  if (found == asking_.end()) return;
  said.replies.emplace_back(std::move(found->second), std::move(reply));
  asking_.erase(found);
}

void Station::Core::carryOut(const effects::Any& effect, Replies& said) {
  std::visit(
      Overloaded{[&](const effects::Reply& e) { reply(e.asked, e.reply, said); },
                 [&](const effects::Command& e) { reply(e.asked, push(e.command), said); },
                 [&](const effects::StopLoop& e) {
                   answers_.noteStop(e.at_once, monotonicNow_ns());
                   e.at_once ? live_->requestEmergencyStop() : live_->requestGentleStop();
                 },
                 [&](const effects::SetLoopParameter& e) { live_->setParameter(e.index, e.value); },
                 [&](const effects::TellHolderAlive& e) { live_->setHolderAlive(e.alive); },
                 [&](const effects::SteerLoop& e) { steer(e.by); },
                 [&](const effects::RaiseLimit& e) {
                   if (permit_) permit_->noteRaisedLimit(e.client);
                 },
                 [&](const effects::AdoptRun&) { adoptRun(); },
                 [&](const effects::DropRun&) {
                   if (live_) prepared_.run = std::move(live_);
                   answers_.dropSession();
                   bodies_.giveBack();
                 },
                 [&](const effects::RetireRun&) {
                   answers_.endSession(ended_silent_);
                   retired_ = std::move(live_);
                   permit_.reset();
                   bodies_.end();
                 },
                 [&](const effects::UseModels&) { useModels(); },
                 [&](const effects::SessionRuns&) {
                   answers_.beginSession();
                   bodies_.begun();
                   ++outcome_.sessions;
                 },
                 [&](const effects::DiscardRecording&) { discard_ = true; },
                 [&](const effects::Log& e) { said.lines.push_back(e.line); }},
      effect);
}

// A restart or a new level clears the mark of a finished level.
OrderReply Station::Core::push(const Command& command) {
  if (!live_->tryCommand(command)) {
    return refused(Refusal::kTooMany, "too many commands at once; try again");
  }
  const auto act = static_cast<Act>(command.index);
  const bool again = act == Act::kRestart || act == Act::kNext;
  if (command.type == CommandType::kAction && again) level_done_at_.reset();
  return {true, ""};
}

// Steering must reach the loop even when its queue is full of aims. The latest request is therefore
// retried with every record.
void Station::Core::steer(Steering by) {
  Command command;
  command.type = CommandType::kSteer;
  command.index = static_cast<std::int32_t>(by);
  unsent_steer_ = command;
  sendUnsent();
}

void Station::Core::sendUnsent() {
  if (live_ && unsent_steer_ && live_->tryCommand(*unsent_steer_)) unsent_steer_.reset();
}

// Makes what was prepared the live session, and sends it what changed during its construction.
void Station::Core::adoptRun() {
  live_ = std::move(prepared_.run);
  permit_ = prepared_.permit;
  unsent_steer_.reset();
  live_->setHolderAlive(state_.holder_alive);
  if (prepared_.place) {
    Command begin;
    begin.type = CommandType::kAction;
    begin.index = static_cast<std::int32_t>(kBeginAt);
    begin.value = *prepared_.place;
    (void)live_->tryCommand(begin);  // its queue is still empty
  }
  const std::vector<double> values = parameterValues(state_);
  for (std::size_t i = 0; i < std::min(values.size(), prepared_.parameters.size()); ++i) {
    if (values[i] != prepared_.parameters[i]) live_->setParameter(static_cast<int>(i), values[i]);
  }
  bodies_.begin(models_, *live_, state_.claim);
}

void Station::Core::useModels() {
  std::swap(models_, next_models_);
  rehearsed_ = std::exchange(next_rehearsed_, std::nullopt);
  being_written_.clear();
  bodies_.dropKept();  // they were checked against the previous scene
  (void)forgetLatest();
}

// Forgets the last record of the previous session; true if there was one.
bool Station::Core::forgetLatest() {
  const auto names =
      models_.exercise ? models_.exercise->description().event_names : std::vector<std::string>{};
  const auto found = std::find(names.begin(), names.end(), kLevelDone);
  level_done_at_.reset();
  level_done_ = found == names.end() ? -1 : static_cast<int>(found - names.begin());
  return std::exchange(has_latest_, false);
}

// Orders and queries of clients; any thread.

void Station::Core::quit() {
  feed(events::Quit{});
}

void Station::Core::order(const Order& order, const std::function<void(OrderReply)>& done) {
  if (const BodyOrders* bodies = bodiesOf(order)) return done(orderBodies(*bodies, order));
  feed(events::Asked{order}, done);
}

// Checks numbers and prepares shapes before it takes any lock.
OrderReply Station::Core::orderBodies(const BodyOrders& bodies, const Order& order) {
  const GameBudget budget = scene()->scene.game;
  if (budget.slots == 0) {
    return refused(
        Refusal::kNoBodies,
        "this scene takes no bodies of a game: load an exercise whose file has [budget], "
        "as game-scene");
  }
  const std::uint32_t shapes_id = bodies.shape_set < 0 ? 0 : ++shapes_;
  CheckedOrders checked = checkOrders(bodies, budget, shapes_id);
  const std::lock_guard lock(mutex_);
  if (OrderReply may = acceptBodies(state_, order); !may.accepted) return may;
  claim_ = state_.claim;
  return live_ ? bodies_.handOver(checked) : bodies_.keep(checked, order.claim);
}

LoopStatus Station::Core::status() const {
  LoopStatus status;
  std::optional<DeviceStatus> device;
  if (config_.device_status) device = config_.device_status();
  {
    const std::lock_guard lock(mutex_);
    status = status_;
    status.device = device;
    describe(state_, now(), status);
    status.bodies = bodies_.inSlots();
    status.registered = bodies_.registered();
    // While no session runs, the published values are those of the next session.
    if (has_latest_ && live_) {
      const auto count = std::min<std::size_t>(latest_.parameter_count, status.parameters.size());
      std::copy_n(latest_.parameters.begin(), count, status.parameters.begin());
    }
    nameSafety(status);
    nameAnswers(status);
  }
  status.rehearsed_ticks = rehearsed_ticks_;
  return status;
}

void Station::Core::nameAnswers(LoopStatus& status) const {
  std::optional<LoopWord> word;
  if (live_) word = live_->word();
  answers_.describe(word, has_latest_, monotonicNow_ns(), status);
}

// Only what nameAnswers() names.
LoopStatus Station::Core::answers() const {
  LoopStatus status;
  if (config_.device_status) status.device = config_.device_status();
  const std::lock_guard lock(mutex_);
  nameAnswers(status);
  return status;
}

// Takes the safety state from the supervisor's log, which knows it earlier than the thread that
// waits for the session's end.
void Station::Core::nameSafety(LoopStatus& status) const {
  if (!safety_) return;
  status.safety_state = safety_->state();
  // After a signal the loop stops by itself, before the run state says so.
  if (InterruptScope::interrupted() && status.run_state == RunState::kRendering) {
    status.run_state = RunState::kStopping;
  }
  // Before the first record of this session, the newest fault belongs to the previous session.
  if (!has_latest_ && status.run_state == RunState::kRendering) return;
  const SafetyTransition fault = safety_->fault();
  if (fault.to != SafetyState::kFaulted) return;
  status.latched = status.latched | fault.faults;
  status.fault_axis = fault.axis;
  status.fault_value = fault.value;
  status.fault_limit = fault.limit;
  if (status.run_state == RunState::kRendering) status.run_state = RunState::kStopping;
}

// Stores the newest record. Telemetry thread.
void Station::Core::keepLatest(const TickRecord& record) {
  safety_->add(record);
  const std::lock_guard lock(mutex_);
  if (record.moved_by == Mover::kPerson) (void)decide(state_, events::PersonMoved{}, now());
  sendUnsent();
  bodies_.onRecord(record);
  latest_ = record;
  has_latest_ = true;
  for (int i = 0; i < record.exercise.event_count; ++i) {
    const ExerciseEvent& event = record.exercise.events[i];
    if (event.type == level_done_) level_done_at_ = StationClock::now();
  }
}

bool Station::Core::latest(TickRecord& record) const {
  const std::lock_guard lock(mutex_);
  if (has_latest_) record = latest_;
  return has_latest_;
}

std::string Station::Core::reportFolder(const std::string& name, std::string& why) {
  const std::string recording = recordingPath(name);
  if (recording.empty()) {
    why = "there is no recording of that name";
  } else if (name == scene()->recording) {
    why = "it is still being recorded";
  } else {
    return reports_.folderOf(recording, why);
  }
  return {};
}

Station::Station(StationConfig config) : core_(std::make_unique<Core>(std::move(config))) {}
Station::~Station() = default;

Expected<Done> Station::load() {
  return core_->load();
}
const Models& Station::models() const {
  return core_->models();
}
void Station::addSink(std::function<void(const TickRecord&)> sink) {
  core_->addSink(std::move(sink));
}
Expected<StationOutcome> Station::run(bool arm_at_once, double duration_s) {
  return core_->run(arm_at_once, duration_s);
}
void Station::quit() {
  core_->quit();
}
void Station::order(const Order& order, std::function<void(OrderReply)> done) {
  core_->order(order, done);
}
std::shared_ptr<const SceneFacts> Station::scene() const {
  return core_->scene();
}
LoopStatus Station::status() const {
  return core_->status();
}
bool Station::latest(TickRecord& record) const {
  return core_->latest(record);
}
std::vector<RecordingEntry> Station::recordings() const {
  return core_->recordings();
}
std::string Station::recordingPath(const std::string& name) const {
  return core_->recordingPath(name);
}
std::string Station::reportFolder(const std::string& name, std::string& why) {
  return core_->reportFolder(name, why);
}

}  // namespace wholehand
