// Lifecycle of sessions: all on the station's main thread.
#include "exercise/load_exercise.hpp"
#include "runtime/interrupt_scope.hpp"
#include "safety/supervisor.hpp"
#include "station/scene_facts.hpp"
#include "station/station_core.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <thread>
#include <utility>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

constexpr auto kStatusEvery = std::chrono::milliseconds(200);
constexpr const char* kLevelDone = "level_done";  // event that ends a level (docs/exercises.md)
constexpr auto kStopWithin = std::chrono::seconds(10);
constexpr double kLongestRun_s = 1e9;  // limit of the clock's range
constexpr auto kLogWithin = std::chrono::seconds(1);

using Clock = StationClock;

std::vector<std::string> stemsIn(const std::string& folder) {
  std::vector<std::string> stems;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() == ".toml") stems.push_back(it->path().stem().string());
  }
  std::sort(stems.begin(), stems.end());
  return stems;
}

}  // namespace

Expected<Done> Station::Core::load() {
  Expected<Models> models = loadModels(config_.files);
  if (!models) return models.errors();
  const auto gains = checkGains(*models, config_.rig.period_s, config_.rig.measured);
  if (!gains) return gains.errors();
  if (Diagnostics no = refuseToRender(*gains, config_.rig); !no.empty()) return no;
  models_ = std::move(*models);
  DeviceModel watched = models_.device;
  watched.watch = watchLimits(watched, config_.make_device == nullptr);
  safety_ = std::make_unique<SafetyLog>(
      std::move(watched), config_.rig.period_s,
      [this](const SafetyTransition& transition) { say(describe(transition)); });
  publishScene("");
  return Done{};
}

void Station::Core::publishScene(const std::string& recording) {
  auto facts = std::make_shared<SceneFacts>(sceneFacts(models_, config_.rig.period_s));
  facts->program_version = config_.program_version;
  facts->exercises = {};
  for (const ExerciseFile& file : listExercises(config_.config_folder + "/exercises")) {
    facts->exercises.push_back(file.name);
  }
  facts->hands = stemsIn(config_.config_folder + "/hands");
  facts->profiles = profiles_.list();
  facts->profile = profile_;
  facts->recording = fs::path(recording).filename().string();
  Profile loaded = profileOf(models_);
  const std::lock_guard lock(mutex_);
  facts->session = status_.session;
  scene_ = std::move(facts);
  loaded_ = std::move(loaded);
  being_written_ = recording;
}

std::unique_ptr<Player> Station::Core::makePlayer(const Models& models) const {
  std::unique_ptr<Player> player;
  if (models.exercise) player = models.exercise->makePlayer(config_.seed + arming_);
  if (!player) player = config_.make_player(models);
  return player;
}

std::string Station::Core::title() const {
  if (!models_.exercise) return models_.scene.name;
  return fmt::format("{}, level {}", models_.exercise->description().name, models_.files.level);
}

// Forgets the record of the previous session; true if there was one.
bool Station::Core::forgetLatest() {
  const auto names =
      models_.exercise ? models_.exercise->description().event_names : std::vector<std::string>{};
  const auto found = std::find(names.begin(), names.end(), kLevelDone);
  const std::lock_guard lock(latest_mutex_);
  level_done_at_.reset();
  level_done_ = found == names.end() ? -1 : static_cast<int>(found - names.begin());
  return std::exchange(has_latest_, false);
}

void Station::Core::finishSession(bool goes_on) {
  std::unique_ptr<Run> over;
  live_->finish();
  RunOutcome ended = live_->outcome();
  for (const std::string& failure : ended.failures) {
    say(failure + "; it was switched off, the loop ran on");
  }
  if (!ended.black_box.empty()) say("black box: " + ended.black_box);
  ended.black_box.clear();  // already reported
  refreshStatus();
  const std::uint64_t missing =
      record_path_.empty() ? 0 : ended.dropped_records + ended.dropped_writes;
  if (missing > 0) {
    say(fmt::format("the recording holds {} of {} ticks: {}", ended.written,
                    ended.written + missing, record_path_));
  }
  const bool discarded = discardUnjoined(ended);
  files_.note(record_path_, title(), recorded_profile_, began_utc_,
              static_cast<double>(ended.summary.ticks) * config_.rig.period_s, missing);
  outcome_.faulted = outcome_.faulted || ended.faulted;
  // Clients that are told of the end find the recording in the list.
  if (discarded || !record_path_.empty()) publishScene("");
  {
    // Its world is destroyed outside the lock, so that no order waits for it.
    const std::lock_guard lock(mutex_);
    status_.run_state = ended.faulted ? RunState::kFaulted : RunState::kStopped;
    status_.latched = ended.counters.latched;
    const bool rest = status_.endings == rest_ending_ && !ended.faulted;
    if (!goes_on) ++status_.endings;
    rest_ending_ = rest ? status_.endings : 0;  // ending of a session that rests
    over = std::move(live_);
    registry_.end();
    registry_.clear();
    publishRegistered();
    tracker_.reset();
  }
  over.reset();
  if (discarded && goes_on) {  // nobody's session has no results
    --outcome_.sessions;
    return;
  }
  outcome_.last = EndedSession{outcome_.sessions, std::move(ended), safety_->transitions(),
                               rehearsed_, record_path_};
  if (config_.ended) config_.ended(*outcome_.last);
  record_path_.clear();
}

// After the last tick. Removes the recording that the program made of its own accord and that
// nobody took part in. What faulted is kept.
bool Station::Core::discardUnjoined(RunOutcome& ended) {
  bool joined = false, asked_for = false;
  {
    const std::lock_guard lock(mutex_);
    joined = std::exchange(keep_recording_, false) || joined_;
    joined_ = joined_ && renewing_;  // whoever joins while it ends is in the next one, too
    asked_for = armed_for_client_ || !config_.record.empty();
  }
  if (joined || asked_for || ended.faulted || record_path_.empty()) return false;
  files_.remove(record_path_);
  record_path_.clear();
  ended.written = 0;
  return true;
}

// Ends a session that the program armed and that nobody has joined for long, or that everybody has
// left, and arms the next one. False when it is not yet time.
bool Station::Core::renewSession() {
  Task again;
  {
    const std::lock_guard lock(mutex_);
    const bool alone = !joined_ && now() - began_at_ >= config_.renew_after;
    if (armed_for_client_ || !config_.record.empty() || !(alone || left_alone_) ||
        status_.run_state != RunState::kRendering) {
      return false;
    }
    again.order.type = OrderType::kArm;
    again.order.endings_seen = status_.endings;
    again.asked = orders_;
    again.starts = true;
    renewing_ = true;
    keep_recording_ = std::exchange(joined_, false);
  }
  stopGently(true);
  OrderReply reply;
  {
    const std::lock_guard lock(mutex_);
    reply = any(status_.latched) ? refused(Refusal::kStopCame, "it ended by a fault")
                                 : mayStillDo(again);
  }
  if (reply.accepted) reply = armUnasked(again, ticksLeft());
  const std::lock_guard lock(mutex_);
  renewing_ = false;
  if (!reply.accepted) ++status_.endings;
  return true;
}

void Station::Core::stopGently(bool goes_on) {
  if (!live_) return;
  {
    const std::lock_guard lock(mutex_);
    beginStop(false);
  }
  const auto until = Clock::now() + kStopWithin;
  while (live_->running() && Clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  finishSession(goes_on);
}

// Resolves the files that an order names, without reading them.
OrderReply Station::Core::filesOf(const Order& order, ModelFiles& files) const {
  files = models_.files;
  if (!order.name.empty()) {
    const auto known = listExercises(config_.config_folder + "/exercises");
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const ExerciseFile& f) { return f.name == order.name; });
    if (found == known.end()) {
      return refused(Refusal::kUnknownExercise, "there is no exercise \"" + order.name + "\"");
    }
    files.exercise = found->path;
    files.level = 1;
  }
  if (!order.hand.empty()) {
    const auto known = stemsIn(config_.config_folder + "/hands");
    if (std::find(known.begin(), known.end(), order.hand) == known.end()) {
      return refused(Refusal::kUnknownHand, "there is no hand \"" + order.hand + "\"");
    }
    files.hand = config_.config_folder + "/hands/" + order.hand + ".toml";
  }
  if (order.level > 0) files.level = order.level;
  return {true, ""};
}

OrderReply Station::Core::loadExercise(const Task& task) {
  ModelFiles files;
  if (OrderReply known = filesOf(task.order, files); !known.accepted) return known;
  return load(task, files, nullptr);
}

OrderReply Station::Core::load(const Task& task, const ModelFiles& files, const Profile* profile) {
  const WaitingFor disk("the disk: what is to be loaded");
  Expected<Models> models = loadModels(files);
  if (!models) return refused(Refusal::kCannotLoad, format(models.errors()));
  const auto gains = checkGains(*models, config_.rig.period_s, config_.rig.measured);
  if (!gains) return refused(Refusal::kCannotLoad, format(gains.errors()));
  if (Diagnostics no = refuseToRender(*gains, config_.rig); !no.empty()) {
    return refused(Refusal::kNotStable, format(no));
  }
  const bool had_session = live_ != nullptr;
  const bool rendered =
      had_session && live_->running() && status().run_state == RunState::kRendering;
  std::optional<Rehearsal> rehearsal;
  if (config_.rehearse && rendered) {  // a load that cannot be rendered stops nothing
    OrderReply passed = rehearseNext(*models, task, rehearsal);
    if (!passed.accepted) return passed;
  }
  if (OrderReply may = stillDo(task); !may.accepted) return may;
  stopGently(true);
  const bool other_person = profile != nullptr || files.hand != models_.files.hand;
  if (other_person) profile_ = profile != nullptr ? profile->name : "";
  models_ = std::move(*models);
  rehearsed_ = std::move(rehearsal);
  forgetLatest();
  Task start = task;
  start.starts = true;
  bool again = false;
  {
    // Rendering continues only if it was on until now and nobody stopped it; a stop or a fault
    // remains.
    const std::lock_guard lock(mutex_);
    if (other_person) changePerson(task, profile);
    dropKept();  // checked against the scene of before
    again = rendered && mayStillDo(start).accepted && !any(status_.latched);
    if (had_session && !again) ++status_.endings;
  }
  publishScene("");
  if (!again) return {true, ""};
  OrderReply reply = armForClient(start);
  if (!reply.accepted) {
    const std::lock_guard lock(mutex_);
    ++status_.endings;
  }
  return reply;
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
    state = status_.run_state;
  }
  if (dropped > 0 && !std::exchange(told_of_loss_, true) && !record_path_.empty()) {
    say(lossNotice(summary.time_s, record_path_));
  }
  if (config_.status) config_.status(state, summary);
}

// Where nobody steers, the virtual patient plays a finished level again, also one that a person
// finished and left.
void Station::Core::restartLevel() {
  if (config_.make_device) return;
  {
    const std::lock_guard lock(latest_mutex_);
    if (!level_done_at_ || Clock::now() - *level_done_at_ < config_.repeat_after) return;
  }
  const std::lock_guard lock(mutex_);
  if (status_.steering != Steering::kVirtualPatient) return;
  Command again;
  again.type = CommandType::kAction;
  again.index = static_cast<std::int32_t>(ExerciseAction::kRestart);
  (void)act(again);
}

void Station::Core::watchSession() {
  if (!live_) return;
  if (!live_->running()) {
    finishSession();
    return;
  }
  if (renewSession()) return;
  restartLevel();
  if (Clock::now() < status_at_) return;
  refreshStatus();
  status_at_ = Clock::now() + kStatusEvery;
}

Expected<StationOutcome> Station::Core::run(bool arm_at_once, double duration_s) {
  const InterruptScope interrupts;
  const auto duration_ticks = static_cast<std::uint64_t>(
      std::llround(std::clamp(duration_s, 0.0, kLongestRun_s) / config_.rig.period_s));
  if (arm_at_once && !InterruptScope::interrupted()) {
    Task first;
    first.order.type = OrderType::kArm;
    first.order.endings_seen = 1;
    first.asked = kFirstArming;
    first.starts = true;
    const OrderReply reply = armUnasked(first, duration_ticks);
    // Whoever stopped may arm.
    const bool stopped = reply.refusal == Refusal::kStopCame || reply.refusal == Refusal::kEnding;
    if (!reply.accepted && !stopped && !InterruptScope::interrupted()) {
      return Diagnostic{"", 0, "", "", "the loop could not be armed: " + reply.reason, ""};
    }
  }
  const std::chrono::duration<double> within(std::clamp(duration_s, 0.0, kLongestRun_s));
  const auto until = Clock::now() + std::chrono::duration_cast<Clock::duration>(within);
  if (duration_ticks > 0 && arm_at_once) ends_at_ = until;
  bool ending = false;
  while (!ending) {
    runTask();
    watchSession();
    const std::lock_guard lock(mutex_);
    outcome_.interrupted = InterruptScope::interrupted();
    const bool over = duration_ticks > 0 && (arm_at_once ? !live_ : Clock::now() >= until);
    ending = outcome_.interrupted || quit_ || over;
  }
  stopGently();
  endTasks();
  log_.flush(kLogWithin);
  return outcome_;
}

}  // namespace wholehand
