#include "station/station.hpp"

#include "exercise/load_exercise.hpp"
#include "station/live_session.hpp"
#include "station/scene_facts.hpp"
#include "station/session_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

/// Longer than the exercise's transition takes to fade out.
constexpr auto kFadeOut = std::chrono::milliseconds(350);
constexpr auto kPoll = std::chrono::milliseconds(20);
constexpr auto kStatusEvery = std::chrono::milliseconds(200);
/// How long a level that the virtual patient has finished is shown before it begins again.
constexpr auto kEncoreAfter = std::chrono::seconds(8);
constexpr const char* kLevelDone = "level_done";  // the event that ends a level, docs/exercises.md
constexpr auto kArmTimeout = std::chrono::seconds(5);

std::vector<std::string> stemsIn(const std::string& folder) {
  std::vector<std::string> stems;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() == ".toml") stems.push_back(it->path().stem().string());
  }
  std::sort(stems.begin(), stems.end());
  return stems;
}

OrderReply refused(std::string reason) {
  return {false, std::move(reason)};
}

}  // namespace

class Station::Core {
 public:
  explicit Core(StationConfig config)
      : config_(std::move(config)), files_(config_.recordings_folder) {}

  Expected<Done> load();
  Expected<StationOutcome> run(bool arm_at_once, double duration_s);
  void quit();
  void order(const Order& order, std::function<void(OrderReply)> done);
  [[nodiscard]] LoopStatus status() const;
  [[nodiscard]] bool latest(TickRecord& record) const;
  [[nodiscard]] std::string reportFolder(const std::string& name, std::string& why);

  [[nodiscard]] std::shared_ptr<const SceneFacts> scene() const {
    const std::lock_guard lock(mutex_);
    return scene_;
  }
  [[nodiscard]] std::vector<RecordingEntry> recordings() const {
    return files_.kept() ? files_.list(scene()->recording) : std::vector<RecordingEntry>{};
  }
  [[nodiscard]] std::string recordingPath(const std::string& name) const {
    return name == scene()->recording ? std::string() : files_.path(name);
  }

  StationConfig config_;
  Models models_;  // main thread
  std::vector<std::function<void(const TickRecord&)>> sinks_;

 private:
  // Main thread.
  OrderReply arm(const std::string& record, std::uint64_t duration_ticks);
  OrderReply loadExercise(const Order& order);
  void stopGently();
  void finishSession();
  void refreshStatus();
  void publishScene(const std::string& recording);
  void runTasks();
  std::unique_ptr<Player> makePlayer();
  // Any thread, mutex_ held.
  OrderReply setParameter(const Order& order);
  OrderReply push(const Command& command);
  void beginStop(bool at_once);

  void keepLatest(const TickRecord& record);
  void playAgain();
  void say(const std::string& line) const {
    if (config_.log) config_.log(line);
  }

  SessionFiles files_;
  std::uint64_t arming_ = 0;
  std::string record_path_;
  StationOutcome outcome_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> tasks_;
  bool quit_ = false;
  bool emergency_ = false;   ///< since the last order to arm
  bool owner_alive_ = true;  ///< as last heard; a session that begins is told
  std::shared_ptr<const SceneFacts> scene_;
  LoopStatus status_;
  std::optional<Clock::time_point> stop_at_;  ///< when the exercise has faded out
  std::unique_ptr<LiveSession> live_;

  mutable std::mutex latest_mutex_;
  TickRecord latest_;
  int level_done_ = -1;  ///< index of that event in the loaded exercise; -1: none
  std::optional<Clock::time_point> level_done_at_;
  bool has_latest_ = false;  ///< of this session
};

// ---- main thread ---------------------------------------------------------------------------

Expected<Done> Station::Core::load() {
  Expected<Models> models = loadModels(config_.files);
  if (!models) return models.errors();
  if (auto gains = checkGains(*models, config_.rig.period_s); !gains) {
    return gains.errors();
  } else if (!gains->refused.empty() && !config_.rig.uncertified) {
    return gains->refused;
  }
  models_ = std::move(*models);
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
  facts->recording = fs::path(recording).filename().string();
  const std::lock_guard lock(mutex_);
  facts->session = status_.session;
  scene_ = std::move(facts);
}

std::unique_ptr<Player> Station::Core::makePlayer() {
  std::unique_ptr<Player> player;
  if (models_.exercise) player = models_.exercise->makePlayer(config_.seed + arming_);
  if (!player) player = config_.make_player(models_);
  return player;
}

OrderReply Station::Core::arm(const std::string& record, std::uint64_t duration_ticks) {
  if (live_) return refused("it is armed already");
  LiveSessionPlan plan;
  const std::string exercise =
      models_.exercise ? models_.exercise->description().name : std::string();
  plan.title = exercise.empty() ? models_.scene.name
                                : fmt::format("{}, level {}", exercise, models_.files.level);
  plan.seed = config_.seed + arming_;
  plan.record = record;
  plan.duration_ticks = duration_ticks;
  plan.sinks.push_back([this](const TickRecord& r) { keepLatest(r); });
  plan.sinks.insert(plan.sinks.end(), sinks_.begin(), sinks_.end());
  {
    const std::lock_guard lock(mutex_);
    ++status_.session;
  }
  {
    const std::lock_guard lock(latest_mutex_);
    has_latest_ = false;
    level_done_at_.reset();
    level_done_ = -1;
    const auto names =
        models_.exercise ? models_.exercise->description().event_names : std::vector<std::string>{};
    const auto found = std::find(names.begin(), names.end(), kLevelDone);
    if (found != names.end()) level_done_ = static_cast<int>(found - names.begin());
  }
  publishScene(record);
  auto live = LiveSession::start(models_, makePlayer(), config_.rig, plan);
  ++arming_;
  if (!live) return refused(format(live.errors()));
  for (const SetupLine& line : (*live)->setup()) {
    if (!line.granted && arming_ == 1) say(line.what + ": " + line.sentence);
  }
  record_path_ = record;
  ++outcome_.sessions;
  const std::lock_guard lock(mutex_);
  live_ = std::move(*live);
  status_.run_state = RunState::kRendering;
  status_.latched = Fault::kNone;
  status_.steering = Steering::kVirtualPatient;
  stop_at_.reset();
  if (emergency_) live_->requestStop();  // it came while this was being built
  if (!owner_alive_) {
    Command silent;
    silent.type = CommandType::kOwner;
    (void)live_->tryCommand(silent);
  }
  return {true, ""};
}

void Station::Core::finishSession() {
  live_->finish();
  const SessionCounters counters = live_->counters();
  for (const std::string& failure : live_->failures()) {
    say(failure + "; it was switched off, the loop ran on");
  }
  refreshStatus();
  if (!record_path_.empty() && files_.kept()) {
    const double duration_s =
        static_cast<double>(counters.ticks_run + counters.skipped_periods) * config_.rig.period_s;
    files_.note(record_path_,
                models_.exercise ? fmt::format("{}, level {}", models_.exercise->description().name,
                                               models_.files.level)
                                 : models_.scene.name,
                duration_s);
  }
  outcome_.faulted = any(counters.latched);
  {
    const std::lock_guard lock(mutex_);
    status_.run_state = any(counters.latched) ? RunState::kFaulted : RunState::kStopped;
    status_.latched = counters.latched;
    stop_at_.reset();
    live_.reset();
  }
  if (!record_path_.empty()) publishScene("");
  record_path_.clear();
}

void Station::Core::stopGently() {
  if (!live_) return;
  {
    const std::lock_guard lock(mutex_);
    beginStop(false);
  }
  const auto until = Clock::now() + kArmTimeout;
  while (live_->running() && Clock::now() < until) {
    {
      const std::lock_guard lock(mutex_);
      if (stop_at_ && Clock::now() >= *stop_at_) live_->requestStop();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  finishSession();
}

OrderReply Station::Core::loadExercise(const Order& order) {
  ModelFiles files = models_.files;
  if (!order.name.empty()) {
    const auto known = listExercises(config_.config_folder + "/exercises");
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const ExerciseFile& f) { return f.name == order.name; });
    if (found == known.end()) return refused("there is no exercise \"" + order.name + "\"");
    files.exercise = found->path;
    files.level = 1;
  }
  if (!order.hand.empty()) {
    const auto known = stemsIn(config_.config_folder + "/hands");
    if (std::find(known.begin(), known.end(), order.hand) == known.end()) {
      return refused("there is no hand \"" + order.hand + "\"");
    }
    files.hand = config_.config_folder + "/hands/" + order.hand + ".toml";
  }
  if (order.level > 0) files.level = order.level;
  Expected<Models> models = loadModels(files);
  if (!models) return refused(format(models.errors()));
  auto gains = checkGains(*models, config_.rig.period_s);
  if (!gains) return refused(format(gains.errors()));
  if (!gains->refused.empty() && !config_.rig.uncertified) return refused(format(gains->refused));
  const bool again = live_ != nullptr;
  stopGently();
  models_ = std::move(*models);
  publishScene("");
  bool emergency = false;
  {
    const std::lock_guard lock(mutex_);
    emergency = emergency_;
    if (!again) status_.run_state = RunState::kDisarmed;
  }
  if (!again || emergency) return {true, ""};
  return arm(files_.kept() ? files_.nameNew(scene()->exercise_name, models_.files.level) : "", 0);
}

void Station::Core::refreshStatus() {
  const TickSummary summary = live_->summary();
  const std::uint64_t dropped = live_->droppedRecords();
  std::error_code unknown;
  const std::uintmax_t bytes = record_path_.empty() ? 0 : fs::file_size(record_path_, unknown);
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
    status_.recording_bytes = unknown ? 0 : bytes;
    state = status_.run_state;
  }
  if (config_.status) config_.status(state, summary);
}

void Station::Core::runTasks() {
  std::deque<std::function<void()>> tasks;
  {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kPoll, [this] { return quit_ || !tasks_.empty(); });
    tasks.swap(tasks_);
  }
  for (const auto& task : tasks) task();
}

// Where nobody steers, the virtual patient plays a finished level once more.
void Station::Core::playAgain() {
  {
    const std::lock_guard lock(latest_mutex_);
    if (!level_done_at_ || Clock::now() - *level_done_at_ < kEncoreAfter) return;
    level_done_at_.reset();
  }
  const std::lock_guard lock(mutex_);
  if (status_.steering != Steering::kVirtualPatient) return;
  Command again;
  again.type = CommandType::kAction;
  again.index = static_cast<std::int32_t>(ExerciseAction::kRestart);
  (void)push(again);
}

Expected<StationOutcome> Station::Core::run(bool arm_at_once, double duration_s) {
  const InterruptScope interrupts;
  const auto duration_ticks =
      static_cast<std::uint64_t>(std::llround(std::max(duration_s, 0.0) / config_.rig.period_s));
  if (arm_at_once) {
    if (const OrderReply reply = arm(config_.record, duration_ticks); !reply.accepted) {
      return Diagnostic{"", 0, "", "", reply.reason, "see above"};
    }
  }
  auto status_at = Clock::now();
  while (true) {
    runTasks();
    bool quit = InterruptScope::interrupted();
    outcome_.interrupted = quit;
    {
      const std::lock_guard lock(mutex_);
      quit = quit || quit_;
      if (live_ && stop_at_ && Clock::now() >= *stop_at_) live_->requestStop();
    }
    if (quit) break;
    if (live_ && !live_->running()) {
      finishSession();
      if (duration_ticks > 0) break;
    }
    if (live_) playAgain();
    if (live_ && Clock::now() >= status_at) {
      refreshStatus();
      status_at = Clock::now() + kStatusEvery;
    }
  }
  stopGently();
  return outcome_;
}

// ---- any thread ----------------------------------------------------------------------------

void Station::Core::quit() {
  const std::lock_guard lock(mutex_);
  quit_ = true;
  wake_.notify_all();
}

void Station::Core::beginStop(bool at_once) {
  if (!live_) return;
  status_.run_state = RunState::kRampingDown;
  if (at_once) {
    live_->requestStop();
    return;
  }
  Command silent;
  silent.type = CommandType::kOwner;
  silent.value = 0.0;
  const bool fades = live_->tryCommand(silent);
  if (!stop_at_) stop_at_ = Clock::now() + (fades ? Clock::duration(kFadeOut) : Clock::duration(0));
}

OrderReply Station::Core::push(const Command& command) {
  if (!live_) return refused("nothing is armed");
  if (!live_->tryCommand(command)) return refused("too many commands at once; try again");
  return {true, ""};
}

OrderReply Station::Core::setParameter(const Order& order) {
  const auto& parameters = scene_->parameters;
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const auto& p) { return p.name == order.name; });
  if (found == parameters.end()) return refused("there is no parameter \"" + order.name + "\"");
  if (!(order.value >= found->lower && order.value <= found->upper)) {
    return refused(fmt::format("{} = {:.6g} is out of range: {:.6g} to {:.6g} {}", order.name,
                               order.value, found->lower, found->upper, found->unit));
  }
  Command command;
  command.type = CommandType::kParameter;
  command.index = static_cast<std::int32_t>(found - parameters.begin());
  command.value = order.value;
  return push(command);
}

void Station::Core::order(const Order& order, std::function<void(OrderReply)> done) {
  OrderReply reply{true, ""};
  {
    const std::lock_guard lock(mutex_);
    Command command;
    switch (order.type) {
      case OrderType::kArm:
        emergency_ = false;
        tasks_.push_back([this, done] {
          done(arm(files_.kept() ? files_.nameNew(scene()->exercise_name, models_.files.level) : "",
                   0));
        });
        wake_.notify_all();
        return;
      case OrderType::kLoadExercise:
        tasks_.push_back([this, order, done] { done(loadExercise(order)); });
        wake_.notify_all();
        return;
      case OrderType::kStop:
        beginStop(false);
        break;
      case OrderType::kEmergencyStop:
        emergency_ = true;
        beginStop(true);
        break;
      case OrderType::kSetParameter:
        reply = setParameter(order);
        break;
      case OrderType::kAim:
        command.type = CommandType::kAim;
        command.aim = order.aim;
        reply = order.aim.size() == static_cast<int>(scene_->device.axes.size())
                    ? push(command)
                    : refused(fmt::format("an aim has {} values, one an axis",
                                          scene_->device.axes.size()));
        break;
      case OrderType::kSteer:
        command.type = CommandType::kSteer;
        command.index = static_cast<std::int32_t>(order.steering);
        reply = push(command);
        if (reply.accepted) status_.steering = order.steering;
        break;
      case OrderType::kAction:
        command.type = CommandType::kAction;
        command.index = static_cast<std::int32_t>(order.action);
        reply = push(command);
        break;
      case OrderType::kOwnerAlive:
        command.type = CommandType::kOwner;
        command.value = order.value;
        owner_alive_ = order.value != 0.0;
        if (!stop_at_) reply = push(command);  // a stop under way fades, whoever is alive
        break;
    }
  }
  done(std::move(reply));
}

LoopStatus Station::Core::status() const {
  LoopStatus status;
  {
    const std::lock_guard lock(mutex_);
    status = status_;
    for (const auto& parameter : scene_->parameters) status.parameters.push_back(parameter.initial);
  }
  const std::lock_guard lock(latest_mutex_);
  if (has_latest_) {
    const auto count =
        std::min(static_cast<std::size_t>(latest_.parameter_count), status.parameters.size());
    std::copy_n(latest_.parameters.begin(), count, status.parameters.begin());
  }
  return status;
}

void Station::Core::keepLatest(const TickRecord& record) {
  const std::lock_guard lock(latest_mutex_);
  latest_ = record;
  has_latest_ = true;
  for (int i = 0; i < record.exercise.event_count; ++i) {
    const ExerciseEvent& event = record.exercise.events[static_cast<std::size_t>(i)];
    if (event.type == level_done_) level_done_at_ = Clock::now();
  }
}

bool Station::Core::latest(TickRecord& record) const {
  const std::lock_guard lock(latest_mutex_);
  if (has_latest_) record = latest_;
  return has_latest_;
}

std::string Station::Core::reportFolder(const std::string& name, std::string& why) {
  const std::string recording = recordingPath(name);
  if (recording.empty()) {
    why = "there is no recording of that name";
    return {};
  }
  const std::string folder = recording.substr(0, recording.size() - 3) + "-report";
  if (fs::exists(folder + "/index.html")) return folder;
  if (!config_.make_report) {
    why = "this program makes no reports";
    return {};
  }
  if (auto made = config_.make_report(recording, folder); !made) {
    why = format(made.errors());
    return {};
  }
  return folder;
}

// ---- the public face -----------------------------------------------------------------------

Station::Station(StationConfig config) : core_(std::make_unique<Core>(std::move(config))) {}
Station::~Station() = default;

Expected<Done> Station::load() {
  return core_->load();
}
const Models& Station::models() const {
  return core_->models_;
}
void Station::addSink(std::function<void(const TickRecord&)> sink) {
  core_->sinks_.push_back(std::move(sink));
}
Expected<StationOutcome> Station::run(bool arm_at_once, double duration_s) {
  return core_->run(arm_at_once, duration_s);
}
void Station::quit() {
  core_->quit();
}
void Station::order(const Order& order, std::function<void(OrderReply)> done) {
  core_->order(order, std::move(done));
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
