#include "exercises/load_exercise.hpp"
#include "loop/patient/steered_player.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "loop/safety/supervisor.hpp"
#include "record/disk_reserve.hpp"
#include "station/scene_facts.hpp"
#include "station/station_core.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <thread>
#include <utility>
#include <variant>

namespace wholehand {
namespace {

namespace fs = std::filesystem;

constexpr auto kPoll = std::chrono::milliseconds(20);
constexpr auto kStatusEvery = std::chrono::milliseconds(200);
constexpr auto kStopWithin = std::chrono::seconds(10);
/// The first tick of a robot's loop follows its enabling at once; a busy machine delays a simulated
/// one.
constexpr auto kFirstTickWithin = std::chrono::seconds(1);
constexpr auto kSimulatedTickWithin = std::chrono::seconds(30);
constexpr double kLongestRun_s = 1e9;  // bound that keeps durations within the clock's range
constexpr auto kLogWithin = std::chrono::seconds(1);

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code error;
  return a == b || fs::equivalent(a, b, error);
}

template <class T>
OrderReply replyOf(const Expected<T>& result, Refusal refusal) {
  return result ? OrderReply{true, ""} : refused(refusal, format(result.errors()));
}

}  // namespace

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
  read.reply = reader_.find(
      {work.exercise, work.hand, work.hand_file, work.level, work.prescription_file}, files);
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
    status_.work_j = summary.work_j;
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

Expected<StationOutcome> Station::Core::run(bool arm_at_once, double duration_s) {
  const InterruptScope interrupts;
  const AnswerWatch watch([this] { return answers(); },
                          [this](const std::string& line) { log(line); });
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

}  // namespace wholehand
