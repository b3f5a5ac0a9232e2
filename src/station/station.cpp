#include "station/station.hpp"

#include "exercises/load_exercise.hpp"
#include "loop/patient/steered_player.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "loop/safety/supervisor.hpp"
#include "record/disk_reserve.hpp"
#include "rig/run/run.hpp"
#include "station/decide.hpp"
#include "station/loop_answers.hpp"
#include "station/model_reader.hpp"
#include "station/press_permit.hpp"
#include "station/reports.hpp"
#include "station/scene_facts.hpp"
#include "station/server/logs.hpp"
#include "station/session_files.hpp"
#include "station/station_bodies.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

namespace wholehand {

namespace fs = std::filesystem;

using StationClock = std::chrono::steady_clock;

/// Runs what decide() decides: does its effects and its work, and reports what came of them.
/// Comments above its functions name the threads that may call them.
class Station::Core {
 public:
  explicit Core(StationConfig config);

  Expected<Done> load();
  Expected<StationOutcome> run(bool arm_at_once, double duration_s);
  void quit();
  void order(const Order& order, const std::function<void(OrderReply)>& done);
  [[nodiscard]] LoopStatus status() const;
  [[nodiscard]] bool latest(TickRecord& record) const;
  [[nodiscard]] std::string reportFolder(const std::string& name, std::string& why);

  [[nodiscard]] std::shared_ptr<const SceneFacts> scene() const {
    const std::lock_guard lock(mutex_);
    return state_.scene;
  }
  [[nodiscard]] std::vector<RecordingEntry> recordings() const {
    return files_.kept() ? files_.list(recordingBeingWritten()) : std::vector<RecordingEntry>{};
  }
  [[nodiscard]] std::string recordingPath(const std::string& name) const {
    return files_.path(name, recordingBeingWritten());
  }

  [[nodiscard]] const Models& models() const { return models_; }  // main thread
  void addSink(std::function<void(const TickRecord&)> sink) { sinks_.push_back(std::move(sink)); }

 private:
  class RunningWatch;

  // Called on any thread:
  void feed(const events::Any& event, const std::function<void(OrderReply)>& done = nullptr);
  OrderReply orderBodies(const BodyOrders& bodies, const Order& order);
  [[nodiscard]] std::string recordingBeingWritten() const {
    const std::lock_guard lock(mutex_);
    return being_written_;
  }
  [[nodiscard]] LoopStatus answers() const;
  void watchAnswers();
  void keepLatest(const TickRecord& record);  // telemetry thread
  [[nodiscard]] OrderReply mayStart() const;
  void log(const std::string& line) const { log_.write(line); }

  // Called on any thread with mutex_ held:
  struct Replies {
    std::vector<std::pair<std::function<void(OrderReply)>, OrderReply>> replies;
    std::vector<std::string> lines;
  };
  void renewInputs();
  void carryOut(const effects::Any& effect, Replies& said);
  void reply(std::uint64_t asked, OrderReply reply, Replies& said);
  [[nodiscard]] OrderReply push(const Command& command);
  void steer(Steering by);
  void sendUnsent();
  void adoptRun();
  void useModels();
  bool forgetLatest();
  void nameSafety(LoopStatus& status) const;
  void nameAnswers(LoopStatus& status) const;
  void showRehearsal();
  [[nodiscard]] StationClock::time_point now() const {
    return config_.now ? config_.now() : StationClock::now();
  }

  // Work of the main thread; each returns what came of it:
  [[nodiscard]] events::Any perform(const work::Any& work);
  events::Any perform(const work::None&) { return events::Turn{}; }
  events::Any perform(const work::ReadProfile& work);
  events::Any perform(const work::SaveProfile& work);
  events::Any perform(const work::PublishScene& work);
  events::Any perform(const work::ReadModels& work);
  events::Any perform(const work::Rehearse& work);
  events::Any perform(const work::EndSession& work);
  events::Any perform(const work::Prepare& work);
  events::Any perform(const work::Begin& work);
  events::Any perform(const work::AwaitFirstTick& work);
  events::Any perform(const work::CloseUnused& work);

  // Called on the main thread:
  void doWork();
  void takeTurn();
  void watchSession();
  void refreshStatus();
  void restartLevel();
  void tidyUp();
  [[nodiscard]] std::string newRecording();
  [[nodiscard]] std::unique_ptr<Player> makePlayer(const Models& models) const;
  [[nodiscard]] Expected<std::unique_ptr<Rig>> makeRig() const;
  [[nodiscard]] RunPlan planRun() const;
  [[nodiscard]] std::optional<double> placeOfRest() const;
  [[nodiscard]] std::string title() const;
  [[nodiscard]] std::uint64_t ticksLeft() const;
  [[nodiscard]] std::shared_ptr<SceneFacts> sceneOf(const Models& models) const;
  void publishScene(const std::string& recording);

  StationConfig config_;
  Models models_, next_models_;  ///< in use, and read last
  ModelReader reader_;
  std::vector<std::function<void(const TickRecord&)>> sinks_;
  SessionFiles files_;
  Profiles profiles_;
  mutable AsyncLog log_;
  std::unique_ptr<SafetyLog> safety_;                    ///< set by load()
  std::optional<Rehearsal> rehearsed_, next_rehearsed_;  ///< of the models in use and read last
  std::uint64_t arming_ = 0;
  mutable std::atomic<std::uint32_t> rehearsed_ticks_{0};   ///< ticks done by the rehearsal under
                                                            ///< way
  std::string record_path_, began_utc_, recorded_profile_;  ///< of the running session
  bool loss_reported_ = false;  ///< the loss of ticks in this recording was reported
  StationClock::time_point status_at_;
  std::uint64_t first_ticks_ = 0;  ///< duration of a run whose first session run() starts; 0: none
  std::optional<StationClock::time_point> ends_at_;  ///< end of that run
  StationOutcome outcome_;

  /// What was prepared and is not live: its run, recording and values.
  struct Prepared {
    std::unique_ptr<Run> run;
    std::shared_ptr<PressPermit> permit;
    std::string record;
    std::vector<double> parameters;
    std::optional<double> place;  ///< in the level, where the player began to rest
    bool had_latest = false;
  } prepared_;
  std::unique_ptr<Run> retired_;       ///< of the session that ended
  std::optional<EndedSession> ended_;  ///< not reported yet
  bool ended_silent_ = false;          ///< it ended without an answer of the device

  std::atomic<std::uint32_t> shapes_{0};  ///< GameShapes::id of the newest shapes that a game
                                          ///< prepared
  std::atomic<std::uint32_t> claim_{0};   ///< StationState::claim, which permits read in the loop
  mutable std::mutex mutex_;              ///< guards the members below; held for microseconds
  std::mutex report_mutex_;               ///< held while a report is made
  std::condition_variable wake_, watch_wake_;
  StationState state_;
  std::map<std::uint64_t, std::function<void(OrderReply)>> asking_;  ///< by order number
  std::string being_written_;                                        ///< recording in the scene
  LoopStatus status_;  ///< the figures; describe() adds the rest
  LoopAnswers answers_;
  bool discard_ = false;  ///< the recording of the session that ended is discarded
  bool watch_ends_ = false;
  std::shared_ptr<PressPermit> permit_;  ///< of the live session; null: the program's own
  std::optional<Command> unsent_steer_;  ///< steering command that waits because the queue was full
  StationBodies bodies_;                 ///< bodies of a game
  TickRecord latest_;
  int level_done_ = -1;  ///< index of the event level_done in the loaded exercise; -1: none
  std::optional<StationClock::time_point> level_done_at_;
  bool has_latest_ = false;  ///< latest_ belongs to this session

  std::unique_ptr<Run> live_;  ///< last member: its threads use the members above
};

namespace {

constexpr auto kPoll = std::chrono::milliseconds(20);
constexpr auto kStatusEvery = std::chrono::milliseconds(200);
constexpr auto kWatchEvery = std::chrono::milliseconds(10);
constexpr const char* kLevelDone = "level_done";  // event that ends a level (docs/exercises.md)
constexpr auto kStopWithin = std::chrono::seconds(10);
/// The first tick of a robot's loop follows its enabling at once; a busy machine delays a simulated
/// one.
constexpr auto kFirstTickWithin = std::chrono::seconds(1);
constexpr auto kSimulatedTickWithin = std::chrono::seconds(30);
constexpr double kLongestRun_s = 1e9;  // bound that keeps durations within the clock's range
constexpr auto kLogWithin = std::chrono::seconds(1);

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code error;
  return a == b || std::filesystem::equivalent(a, b, error);
}

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

template <class T>
OrderReply replyOf(const Expected<T>& result, Refusal refusal) {
  return result ? OrderReply{true, ""} : refused(refusal, format(result.errors()));
}

}  // namespace

Station::Core::Core(StationConfig config)
    : config_(std::move(config)),
      reader_(config_.config_folder, config_.visit_hands_folder, config_.rig),
      files_(config_.recordings_folder),
      profiles_(config_.profiles_folder),
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

// Tells the person at the terminal that the loop or the device does not answer. Runs in its own
// thread, because the main thread may be the one that waits for them.
void Station::Core::watchAnswers() {
  bool silent = false;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      if (watch_wake_.wait_for(lock, kWatchEvery, [this] { return watch_ends_; })) return;
    }
    const LoopStatus now = answers();
    if (now.silent == silent) continue;
    silent = now.silent;
    const char* again = now.device ? "The robot answers again." : "The simulation answers again.";
    log(silent ? alarmOf(now) : again);
  }
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
  const std::lock_guard lock(report_mutex_);  // two concurrent requests share one result
  const std::string recording = recordingPath(name);
  if (recording.empty()) {
    why = "there is no recording of that name";
    return {};
  }
  if (name == scene()->recording) {
    why = "it is still being recorded";
    return {};
  }
  std::string folder = recording.substr(0, recording.size() - 3) + "-report";
  const std::string identity = identityOf(recording);
  if (isReportOf(folder, identity)) return folder;
  if (!config_.make_report) {
    why = "this program makes no reports";
    return {};
  }
  unmarkReport(folder);
  if (auto made = config_.make_report(recording, folder); !made) {
    why = format(made.errors());
    return {};
  }
  // The report is not marked when the recording was replaced meanwhile; the next request makes it
  // again.
  if (identityOf(recording) == identity) markReport(folder, identity);
  return folder;
}

// Work of the main thread. What comes of it is judged by decide().

events::Any Station::Core::perform(const work::Any& work) {
  try {
    return std::visit([this](const auto& kind) { return perform(kind); }, work);
  } catch (const std::exception& error) {  // a running loop continues
    return events::WorkFailed{error.what()};
  }
}

void Station::Core::doWork() {
  while (true) {
    work::Any next;
    {
      const std::lock_guard lock(mutex_);
      next = state_.work;
    }
    if (std::holds_alternative<work::None>(next)) return;
    feed(perform(next));
    tidyUp();
  }
}

void Station::Core::takeTurn() {
  {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kPoll, [this] { return state_.quit || !state_.waiting.empty(); });
  }
  feed(events::Turn{});
  doWork();
}

events::Any Station::Core::perform(const work::ReadProfile& work) {
  const WaitingFor disk("the disk: a profile");
  const Expected<Profile> profile = profiles_.load(work.name);
  events::ProfileRead read{replyOf(profile, Refusal::kUnknownProfile), {}};
  if (profile) read.profile = *profile;
  return read;
}

events::Any Station::Core::perform(const work::SaveProfile& work) {
  const WaitingFor disk("the disk: a profile");
  return events::ProfileSaved{replyOf(profiles_.save(work.profile), Refusal::kOther)};
}

events::Any Station::Core::perform(const work::PublishScene&) {
  publishScene(record_path_);
  return events::ScenePublished{};
}

events::Any Station::Core::perform(const work::ReadModels& work) {
  ModelFiles files = work.first ? config_.files : models_.files;
  events::ModelsRead read;
  read.reply = reader_.find({work.exercise, work.hand, work.hand_file, work.level}, files);
  if (read.reply.accepted) read.reply = reader_.read(files, next_models_);
  if (!read.reply.accepted) return read;
  read.facts = sceneOf(next_models_);
  read.loaded = profileOf(next_models_);
  read.other_hand = !isSameFile(files.hand, models_.files.hand);
  next_rehearsed_.reset();
  return read;
}

OrderReply Station::Core::mayStart() const {
  const std::lock_guard lock(mutex_);
  return mayStillStart(state_, now());
}

// Rehearses models before their first force, as long as the order may start the device.
events::Any Station::Core::perform(const work::Rehearse& work) {
  const Models& models = work.next ? next_models_ : models_;
  RehearsalOptions options = config_.rehearsal;
  options.cancelled = [this] {
    ++rehearsed_ticks_;
    return InterruptScope::interrupted() || !mayStart().accepted;
  };
  options.fill_pool = config_.make_device != nullptr;  // a simulated device may be late
  options.status = [this](const std::string& what) { log("rehearsal: measuring " + what); };
  auto rehearsal = rehearse(models, makePlayer(models)->start(), config_.rig, options);
  rehearsed_ticks_ = 0;
  events::Rehearsed done{replyOf(rehearsal, Refusal::kRehearsalFailed)};
  if (!rehearsal) return done;
  log("rehearsal " + describe(*rehearsal));
  (work.next ? next_rehearsed_ : rehearsed_) = std::move(*rehearsal);
  return done;
}

// Makes the rig around the real device, which a person holds, or around a simulated device, which a
// virtual patient or a client moves.
Expected<std::unique_ptr<Rig>> Station::Core::makeRig() const {
  std::unique_ptr<Player> player = makePlayer(models_);
  if (!config_.make_device) {
    auto steered = std::make_unique<SteeredPlayer>(std::move(player), models_.device);
    return buildRig(models_, std::move(steered), config_.rig);
  }
  auto device = config_.make_device(models_.device);
  if (!device) return device.errors();
  return buildRig(models_, std::move(*device), config_.rig);
}

RunPlan Station::Core::planRun() const {
  RunPlan plan;
  plan.title = title();
  plan.profile = state_.profile;
  plan.visit = state_.visit.number;
  plan.visit_item = state_.visit.item;
  plan.seed = config_.seed + arming_;
  plan.record = prepared_.record;
  plan.duration_ticks = ticksLeft();
  plan.black_box = blackBoxPath(plan.record);
  plan.interrupts = &InterruptScope::shared();
  plan.permit = prepared_.permit;
  plan.real_time_required = config_.real_time_required;
  if (rehearsed_) plan.rehearsed = rehearsed_->passed;
  return plan;
}

// Publishes the new session before its first record.
events::Any Station::Core::perform(const work::Prepare& work) {
  UnderWay start;
  {
    const std::lock_guard lock(mutex_);
    start = *state_.under_way;
    prepared_ = {};
    if (work.resumed) prepared_.place = placeOfRest();
    prepared_.had_latest = forgetLatest();
  }
  if (start.start.order.requester) {
    prepared_.permit = std::make_shared<PressPermit>(
        start.start.order, start.start.asked_at, [this] { return now(); }, claim_);
  }
  const bool named = !config_.record.empty();
  const std::uint64_t number = start.for_client ? outcome_.sessions + 1 : 1;
  prepared_.record = named           ? pathOfSession(config_.record, number)
                     : work.recorded ? newRecording()
                                     : "";
  publishScene(prepared_.record);
  RunPlan plan;
  {
    const std::lock_guard lock(mutex_);
    prepared_.parameters = parameterValues(state_);
    plan = planRun();
  }
  plan.sinks.push_back([this](const TickRecord& r) { keepLatest(r); });
  plan.sinks.insert(plan.sinks.end(), sinks_.begin(), sinks_.end());
  auto rig = makeRig();
  ++arming_;
  if (!rig) return events::Prepared{replyOf(rig, Refusal::kCannotStart)};
  (*rig)->renderer->startParametersAt(prepared_.parameters);
  if (!plan.record.empty()) {
    const double period_s = config_.rig.period_s;
    const std::string room =
        roomNotice(plan.record, period_s, static_cast<double>(plan.duration_ticks) * period_s);
    if (!room.empty()) log(room);
  }
  auto run = Run::prepare(std::move(*rig), std::move(plan));
  if (run) prepared_.run = std::move(*run);
  return events::Prepared{replyOf(run, Refusal::kCannotStart)};
}

events::Any Station::Core::perform(const work::Begin&) {
  events::Begun begun{replyOf(live_->begin(), Refusal::kCannotStart)};
  if (!begun.reply.accepted) return begun;
  for (const SetupLine& line : live_->setup()) {
    if (!line.granted && arming_ == 1) log(line.what + ": " + line.sentence);
  }
  record_path_ = prepared_.record;
  began_utc_ = utcNow();
  recorded_profile_ = state_.profile;  // only this thread changes it
  loss_reported_ = false;
  return begun;
}

// Waits for the first tick, which judges the permit.
events::Any Station::Core::perform(const work::AwaitFirstTick&) {
  using Verdict = PressPermit::Verdict;
  const auto until =
      StationClock::now() + (config_.make_device ? kFirstTickWithin : kSimulatedTickWithin);
  while (permit_->verdict() == Verdict::kOpen && live_->running() && StationClock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (permit_->verdict() == Verdict::kBegun) return events::FirstTick{{true, ""}};
  if (permit_->verdict() == Verdict::kVoid) return events::FirstTick{permit_->refusal()};
  return events::FirstTick{refused(Refusal::kCannotStart, "the loop did not begin to tick")};
}

// Closes a run outside the lock, so that no client waits for its recording.
events::Any Station::Core::perform(const work::CloseUnused&) {
  prepared_.run.reset();
  publishScene("");
  if (config_.record.empty()) files_.giveBack(prepared_.record);
  const std::lock_guard lock(mutex_);
  has_latest_ = prepared_.had_latest;
  return events::UnusedClosed{};
}

// Waits for the end of the session, and closes its files.
events::Any Station::Core::perform(const work::EndSession& work) {
  const auto until = StationClock::now() + kStopWithin;
  while (live_->running() && StationClock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  live_->finish();
  RunOutcome ended = live_->outcome();
  for (const std::string& failure : ended.failures) {
    log(failure + "; it was switched off, the loop ran on");
  }
  if (!ended.black_box.empty()) log("black box: " + ended.black_box);
  ended.black_box.clear();  // already reported
  refreshStatus();
  const std::uint64_t missing =
      record_path_.empty() ? 0 : ended.dropped_records + ended.dropped_writes;
  if (missing > 0) {
    log(fmt::format("the recording holds {} of {} ticks: {}", ended.written,
                    ended.written + missing, record_path_));
  }
  feed(events::LoopFinished{ended.faulted, !record_path_.empty()});
  const bool discarded = std::exchange(discard_, false);
  if (discarded) {
    files_.remove(record_path_);
    record_path_.clear();
    ended.written = 0;
  }
  files_.note(record_path_, title(), recorded_profile_, began_utc_,
              static_cast<double>(ended.summary.ticks) * config_.rig.period_s, missing);
  outcome_.faulted = outcome_.faulted || ended.faulted;
  // The scene is published before the end, so that clients find the recording in the list.
  if (discarded || !record_path_.empty()) publishScene("");
  ended_silent_ = answers().silent;
  const events::SessionEnded event{ended.faulted, ended.counters.latched};
  if (discarded && work.goes_on) {  // a session that nobody joined has no results
    --outcome_.sessions;
    return event;
  }
  ended_ = EndedSession{outcome_.sessions, std::move(ended), safety_->transitions(), rehearsed_,
                        record_path_};
  record_path_.clear();
  return event;
}

// Destroys outside the lock what is not used any more, so that no order waits for it.
void Station::Core::tidyUp() {
  retired_.reset();
  if (ended_) {
    outcome_.last = std::exchange(ended_, std::nullopt);
    if (config_.ended) config_.ended(*outcome_.last);
  }
  if (!state_.under_way) next_models_ = {};  // only this thread changes both
}

// What the work is made of; main thread.

// Position in the level at which the player began to rest; empty: the session starts at the
// beginning. With mutex_ held.
std::optional<double> Station::Core::placeOfRest() const {
  const int value = models_.exercise ? models_.exercise->description().resume_value : -1;
  if (value < 0 || !has_latest_ || value >= latest_.exercise.value_count) return std::nullopt;
  return latest_.exercise.values[value];
}

// Remaining ticks of a run with a duration; 0: no end.
std::uint64_t Station::Core::ticksLeft() const {
  if (!ends_at_) return first_ticks_;
  const double left_s = std::chrono::duration<double>(*ends_at_ - StationClock::now()).count();
  return static_cast<std::uint64_t>(std::max(1.0, std::round(left_s / config_.rig.period_s)));
}

// Reserves the name of a new recording; empty when that fails.
std::string Station::Core::newRecording() {
  if (!files_.kept()) return {};
  const std::string whose = state_.visit.number != 0
                                ? fmt::format("visit-{}", state_.visit.number)
                                : state_.profile;  // only this thread changes both
  auto named = files_.nameNew(whose, scene()->exercise_name, models_.files.level);
  if (!named) {
    log("what follows is not recorded: " + format(named.errors()));
    return {};
  }
  return *named;
}

Expected<Done> Station::Core::load() {
  Expected<Models> models = loadModels(config_.files);
  if (!models) return models.errors();
  const auto gains = checkGains(*models, config_.rig.period_s, config_.rig.measured);
  if (!gains) return gains.errors();
  if (Diagnostics no = refuseToRender(*gains, config_.rig); !no.empty()) return no;
  models_ = std::move(*models);
  state_.loaded = profileOf(models_);
  DeviceModel watched = models_.device;
  watched.watch = watchLimits(watched, config_.make_device == nullptr);
  safety_ = std::make_unique<SafetyLog>(
      std::move(watched), config_.rig.period_s,
      [this](const SafetyTransition& transition) { log(describe(transition)); });
  publishScene("");
  return Done{};
}

std::shared_ptr<SceneFacts> Station::Core::sceneOf(const Models& models) const {
  auto facts = std::make_shared<SceneFacts>(sceneFacts(models, config_.rig.period_s));
  facts->program_version = config_.program_version;
  for (const ExerciseFile& file : listExercises(config_.config_folder + "/exercises")) {
    facts->exercises.push_back(file.name);
  }
  facts->hands = stemsIn(config_.config_folder + "/hands");
  facts->profiles = profiles_.list();
  return facts;
}

void Station::Core::publishScene(const std::string& recording) {
  auto facts = sceneOf(models_);
  facts->recording = fs::path(recording).filename().string();
  const std::lock_guard lock(mutex_);
  facts->profile = state_.profile;
  facts->visit = state_.visit;
  facts->session = state_.session;
  state_.scene = std::move(facts);
  being_written_ = recording;
}

std::unique_ptr<Player> Station::Core::makePlayer(const Models& models) const {
  std::unique_ptr<Player> player = makeExercisePlayer(models, config_.seed + arming_);
  if (!player) player = config_.make_player(models);
  return player;
}

std::string Station::Core::title() const {
  if (!models_.exercise) return models_.scene.name;
  return fmt::format("{}, level {}", models_.exercise->description().name, models_.files.level);
}

void Station::Core::showRehearsal() {
  if (!rehearsed_) return;
  const Percentiles& cpu =
      rehearsed_->pool ? rehearsed_->pool->summary.cpu : rehearsed_->summary.cpu;
  status_.rehearsal_p50_us = cpu.p50_ns * 1e-3;
  status_.rehearsal_p999_us = cpu.p999_ns * 1e-3;
  status_.rehearsal_max_us = cpu.max_ns * 1e-3;
}

void Station::Core::refreshStatus() {
  const TickSummary summary = live_->summary();
  const std::uint64_t dropped = live_->droppedRecords();
  const std::uint64_t bytes = live_->recordedBytes();
  RunState state;
  {
    const std::lock_guard lock(mutex_);
    status_.ticks = summary.ticks;
    status_.missed_deadlines = summary.missed_deadlines;
    status_.dropped_records = dropped;
    status_.cpu_p50_us = summary.cpu.p50_ns * 1e-3;
    status_.cpu_p99_us = summary.cpu.p99_ns * 1e-3;
    status_.cpu_p999_us = summary.cpu.p999_ns * 1e-3;
    status_.cpu_max_us = summary.cpu.max_ns * 1e-3;
    status_.fault_ticks = summary.faults;
    showRehearsal();
    status_.recording_bytes = bytes;
    state = state_.run_state;
  }
  if (dropped > 0 && !std::exchange(loss_reported_, true) && !record_path_.empty()) {
    log(lossNotice(summary.time_s, record_path_));
  }
  if (config_.status && !answers().silent) config_.status(state, summary);
}

// Restarts a finished level while the virtual patient steers, also a level that a person finished
// and left.
void Station::Core::restartLevel() {
  if (config_.make_device) return;
  const std::lock_guard lock(mutex_);
  if (!level_done_at_ || StationClock::now() - *level_done_at_ < config_.repeat_after) return;
  if (state_.steering != Steering::kVirtualPatient) return;
  Command restart;
  restart.type = CommandType::kAction;
  restart.index = static_cast<std::int32_t>(Act::kRestart);
  (void)push(restart);
}

void Station::Core::watchSession() {
  if (!live_) return;
  if (!live_->running()) {
    feed(events::EndDue{true});
    return doWork();
  }
  feed(events::RenewalDue{});
  doWork();
  if (!live_) return;
  restartLevel();
  if (StationClock::now() < status_at_) return;
  refreshStatus();
  status_at_ = StationClock::now() + kStatusEvery;
}

/// Runs watchAnswers() during its lifetime.
class Station::Core::RunningWatch {
 public:
  explicit RunningWatch(Core& core) : core_(core), thread_([&core] { core.watchAnswers(); }) {}
  ~RunningWatch() {
    {
      const std::lock_guard lock(core_.mutex_);
      core_.watch_ends_ = true;
    }
    core_.watch_wake_.notify_all();
    thread_.join();
  }
  RunningWatch(const RunningWatch&) = delete;
  RunningWatch& operator=(const RunningWatch&) = delete;

 private:
  Core& core_;
  std::thread thread_;
};

Expected<StationOutcome> Station::Core::run(bool arm_at_once, double duration_s) {
  const InterruptScope interrupts;
  const RunningWatch watch(*this);
  const std::chrono::duration<double> within(std::clamp(duration_s, 0.0, kLongestRun_s));
  const bool endless = within.count() == 0.0;
  if (arm_at_once && !InterruptScope::interrupted()) {
    first_ticks_ = static_cast<std::uint64_t>(std::llround(within.count() / config_.rig.period_s));
    OrderReply started;
    {
      const std::lock_guard lock(mutex_);
      asking_[kFirstStart] = [&started](const OrderReply& reply) { started = reply; };
    }
    feed(events::FirstStart{});
    doWork();
    // After a stop, run() goes on, so that the client that stopped may arm.
    const bool stopped =
        started.refusal == Refusal::kStopCame || started.refusal == Refusal::kEnding;
    if (!started.accepted && !stopped && !InterruptScope::interrupted()) {
      return fileFault("", "the loop could not be armed: " + started.reason, "");
    }
  }
  const auto until =
      StationClock::now() + std::chrono::duration_cast<StationClock::duration>(within);
  if (!endless && arm_at_once) ends_at_ = until;
  bool ending = false;
  // Carries out orders and watches the session until the end.
  while (!ending) {
    takeTurn();
    watchSession();
    const std::lock_guard lock(mutex_);
    outcome_.interrupted = InterruptScope::interrupted();
    const bool over = !endless && (arm_at_once ? !live_ : StationClock::now() >= until);
    ending = outcome_.interrupted || state_.quit || over;
  }
  feed(events::EndDue{});
  doWork();
  feed(events::Over{});
  log_.flush(kLogWithin);
  return outcome_;
}

std::string pathOfSession(const std::string& path, std::uint64_t number) {
  if (number < 2 || path.empty()) return path;
  const std::filesystem::path first(path);
  const std::string name =
      first.stem().string() + "-" + std::to_string(number) + first.extension().string();
  return (first.parent_path() / name).string();
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
