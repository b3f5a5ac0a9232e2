#include "station/station.hpp"

#include "exercises/load_exercise.hpp"
#include "loop/core/printable.hpp"
#include "loop/patient/steered_player.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "loop/safety/supervisor.hpp"
#include "record/disk_reserve.hpp"
#include "rig/run/run.hpp"
#include "station/basis.hpp"
#include "station/press_permit.hpp"
#include "station/profiles.hpp"
#include "station/reports.hpp"
#include "station/scene_facts.hpp"
#include "station/server/logs.hpp"
#include "station/session_files.hpp"
#include "station/station_bodies.hpp"
#include "station/stop_history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

namespace wholehand {

namespace fs = std::filesystem;

using StationClock = std::chrono::steady_clock;

/// Implementation of Station. Comments above its functions name the threads that may call them.
class Station::Core {
 public:
  explicit Core(StationConfig config)
      : config_(std::move(config)),
        files_(config_.recordings_folder),
        profiles_(config_.profiles_folder),
        log_(config_.log),
        person_(config_.first_parameters) {}

  Expected<Done> load();
  Expected<StationOutcome> run(bool arm_at_once, double duration_s);
  void quit();
  void order(const Order& order, const std::function<void(OrderReply)>& done);
  [[nodiscard]] LoopStatus status() const;
  [[nodiscard]] bool latest(TickRecord& record) const;
  [[nodiscard]] std::string reportFolder(const std::string& name, std::string& why);

  [[nodiscard]] std::shared_ptr<const SceneFacts> scene() const {
    const std::lock_guard lock(mutex_);
    return scene_;
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
  [[nodiscard]] std::string recordingBeingWritten() const {
    const std::lock_guard lock(mutex_);
    return being_written_;
  }
  /// Order number of the arming by run() itself; a stop before run() cancels it.
  static constexpr std::uint64_t kFirstArming = 1;
  /// Limit of queued tasks. It bounds how long a client that floods the station can delay others.
  static constexpr std::size_t kMostTasks = 8;

  class RunningWatch;

  /// Longest time that an order may wait behind others.
  static constexpr std::chrono::seconds kLongestWait{3};

  /// An order that waits for the main thread.
  struct Task {
    Order order;
    std::uint64_t asked = 0;  ///< its number
    StationClock::time_point asked_at;
    std::uint32_t acknowledged_stop =
        0;                        ///< value of LoopStatus::endings that the order is based on
    bool starts = false;          ///< the order starts the device, or is about to
    bool refused_before = false;  ///< while it waited, an earlier order of its client was refused
    std::chrono::duration<double> waited_s{0.0};  ///< time spent behind other orders, set at its
                                                  ///< turn
    Profile profile;                              ///< profile at the time of the order
    std::uint64_t person = 0;                     ///< PersonSettings::person() at that time
    std::function<void(OrderReply)> done;
  };

  // Called on the main thread:
  OrderReply arm(const Task& task, const std::string& record, std::uint64_t duration_ticks,
                 bool for_client);
  OrderReply armForClient(const Task& task);
  OrderReply armUnasked(const Task& task, std::uint64_t duration_ticks);
  [[nodiscard]] std::string newRecording();
  bool renewSession();
  OrderReply startSession(std::unique_ptr<Player> player, const Task& task,
                          const std::string& record, std::uint64_t duration_ticks, bool for_client);
  [[nodiscard]] Expected<std::unique_ptr<Rig>> makeRig(std::unique_ptr<Player> player) const;
  [[nodiscard]] Expected<std::unique_ptr<Run>> prepareRun(std::unique_ptr<Player> player,
                                                          const std::vector<double>& parameters,
                                                          RunPlan plan) const;
  OrderReply adopt(std::unique_ptr<Run>& run, const Task& task,
                   const std::shared_ptr<PressPermit>& permit,
                   const std::vector<double>& parameters, std::optional<double> place);
  [[nodiscard]] std::shared_ptr<PressPermit> permitOf(const Task& task) const;
  OrderReply effortBegins(const PressPermit* permit);
  void restoreStatus(LoopStatus before, const Task& task, bool had_latest,
                     std::unique_ptr<Run> unused);
  OrderReply sessionRuns(OrderReply reply, const std::string& record);
  [[nodiscard]] std::uint64_t ticksLeft() const;
  [[nodiscard]] Expected<Rehearsal> rehearsalOf(const Models& models, const AxisPosition& start,
                                                const Task& task) const;
  OrderReply rehearseNext(const Models& models, Task task, std::optional<Rehearsal>& passed);
  [[nodiscard]] OrderReply filesOf(const orders::LoadExercise& order, ModelFiles& files) const;
  OrderReply loadExercise(const orders::LoadExercise& order, const Task& task);
  /// Loads models.
  /// @param profile its values hold from now on; null: the present values stay unless the hand
  /// changes
  OrderReply load(const Task& task, const ModelFiles& files, const Profile* profile);
  OrderReply carryOutTask(const Task& task);
  OrderReply saveProfile(const orders::SaveProfile& order, const Task& task);
  OrderReply loadProfile(const orders::LoadProfile& order, const Task& task);
  OrderReply openVisit(const orders::OpenVisit& order, const Task& task);
  OrderReply closeVisit(const orders::CloseVisit& order, const Task& task);
  [[nodiscard]] OrderReply fitsVisit(const orders::LoadExercise& order) const;
  [[nodiscard]] OrderReply refuseParameters(const std::string& whose, const Profile& profile,
                                            const Models& models) const;
  OrderReply loadVisit(Task task, const ModelFiles& files, const Profile& settings,
                       const Visit& visit);
  void stopGently(bool goes_on = false);
  /// Ends the session and closes its files.
  /// @param goes_on a load continues the rendering, so nobody has to see this ending
  void finishSession(bool goes_on = false);
  bool discardUnattended(RunOutcome& ended);
  void refreshStatus();
  [[nodiscard]] std::shared_ptr<SceneFacts> sceneOf(const Models& models,
                                                    const std::string& profile) const;
  void publishScene(const std::string& recording);
  void runTask();
  void watchSession();
  void endTasks();
  [[nodiscard]] std::vector<double> parametersAtStart() const;
  [[nodiscard]] std::unique_ptr<Player> makePlayer(const Models& models) const;
  [[nodiscard]] std::string title() const;
  bool forgetLatest();
  /// Position in the level at which the player began to rest; empty: the session starts at the
  /// beginning.
  [[nodiscard]] std::optional<double> placeOfRest() const;
  // Called on any thread:
  [[nodiscard]] OrderReply stillDo(const Task& task) const;  ///< mayStillDo() under the lock
  OrderReply orderBodies(const BodyOrders& bodies, const Order& order);
  // Called on any thread with mutex_ held:
  [[nodiscard]] bool superseded(const Order& order);
  [[nodiscard]] bool lowersLimit(const Order& order) const;
  [[nodiscard]] OrderReply mayStillDo(const Task& task) const;
  OrderReply takeStop(const Order& order, std::uint64_t asked);
  [[nodiscard]] bool arming() const;
  OrderReply enqueue(const Order& order, std::uint64_t asked,
                     const std::function<void(OrderReply)>& done);
  [[nodiscard]] Profile profileNow() const;
  [[nodiscard]] static Profile profileOf(const Models& models);
  void changePerson(const Task& task, const Profile* profile, bool may_raise_limits);
  void show(std::shared_ptr<SceneFacts> facts, Profile loaded, const std::string& recording);
  OrderReply carryOut(const Order& order, std::uint64_t asked);
  OrderReply setHelp(const orders::SetHelp& order, std::uint64_t asked);
  OrderReply aim(const orders::Aim& order);
  OrderReply setHolderAlive(bool alive);
  OrderReply markUnattended(const Order& order, std::uint64_t asked);
  void catchUp(const std::vector<double>& parameters, std::optional<double> place);
  OrderReply steer(Steering by);
  void sendUnsent();
  OrderReply setParameter(const orders::SetParameter& order, std::uint32_t client,
                          std::uint64_t asked);
  [[nodiscard]] Basis::Limits limitsNow() const;
  OrderReply push(const Command& command);
  OrderReply act(Act action);
  void endUnattended(const Order& order);
  void beginStop(bool at_once);
  [[nodiscard]] StationClock::time_point now() const {
    return config_.now ? config_.now() : StationClock::now();
  }
  void showRehearsal();

  void keepLatest(const TickRecord& record);
  void nameSafety(LoopStatus& status) const;
  void nameAnswers(LoopStatus& status) const;
  [[nodiscard]] LoopStatus answers() const;
  void watchAnswers();
  void restartLevel();
  void log(const std::string& line) const { log_.write(line); }

  StationConfig config_;
  Models models_;
  std::vector<std::function<void(const TickRecord&)>> sinks_;
  SessionFiles files_;
  Profiles profiles_;
  std::string profile_;  ///< last profile loaded or saved, while it applies; empty: none
  Visit visit_;          ///< the open visit
  mutable AsyncLog log_;
  std::unique_ptr<SafetyLog> safety_;   ///< set by load()
  std::optional<Rehearsal> rehearsed_;  ///< rehearsal of the loaded rig
  std::uint64_t arming_ = 0;
  mutable std::atomic<std::uint32_t> rehearsed_ticks_{0};   ///< ticks done by the rehearsal under
                                                            ///< way
  std::string record_path_, began_utc_, recorded_profile_;  ///< of the running session
  std::string being_written_;   ///< recording that scene_ names; guarded by mutex_
  bool loss_reported_ = false;  ///< the loss of ticks in this recording was reported
  StationClock::time_point status_at_;
  std::optional<StationClock::time_point> ends_at_;  ///< end of a run with a duration
  StationOutcome outcome_;

  std::atomic<std::uint32_t> shapes_{0};  ///< GameShapes::id of the newest shapes that a game
                                          ///< prepared
  mutable std::mutex mutex_;              ///< guards the members below; held for microseconds
  std::mutex report_mutex_;               ///< held while a report is made
  std::condition_variable wake_;
  std::deque<Task> tasks_;
  /// Order under way that starts the device; none once its session renders.
  std::optional<Task> starting_;
  bool quit_ = false;
  // Orders are numbered as they arrive. A stop that follows an order to arm or to load cancels the
  // start, however far it has got.
  std::uint64_t orders_ = kFirstArming;
  StopHistory stop_history_;
  Basis basis_;
  std::shared_ptr<PressPermit> permit_;  ///< of the newest session; null: the program's own
  bool armed_for_client_ = false;        ///< true: a client armed; false: the program armed by
                                         ///< itself
  bool attended_ = false;                ///< somebody takes part in this session or in the next one
  bool unattended_ = false;              ///< everybody who took part has left
  bool keep_recording_ = false;          ///< somebody took part before the session's end was due
  bool renewing_ = false;                ///< this session ends, and the program arms the next one
  StationClock::time_point began_at_;    ///< of the running session
  std::atomic<std::uint32_t> claim_{0};  ///< newest claim on the controls
  bool over_ = false;                    ///< no more orders are carried out
  bool holder_alive_ = true;             ///< latest value; passed to a session that begins
  /// When the live session was asked to stop, CLOCK_MONOTONIC, and whether at once; empty: not
  /// asked.
  std::optional<std::int64_t> stop_asked_ns_;
  bool stop_at_once_ = false;
  bool left_silent_ = false;  ///< the last session ended without an answer of the device
  std::condition_variable watch_wake_;
  bool watch_ends_ = false;
  std::optional<Command> unsent_steer_;  ///< steering command that waits because the queue was full
  std::shared_ptr<const SceneFacts> scene_;
  LoopStatus status_;
  StationBodies bodies_;  ///< bodies of a game
  PersonSettings person_;
  Profile loaded_;  ///< the loaded models as a profile, without
                    ///< name and values

  TickRecord latest_;
  int level_done_ = -1;  ///< index of the event level_done in the loaded exercise; -1: none
  std::optional<StationClock::time_point> level_done_at_;
  bool has_latest_ = false;  ///< latest_ belongs to this session

  std::unique_ptr<Run> live_;  ///< last member: its threads use the members above
};

namespace {

constexpr auto kPoll = std::chrono::milliseconds(20);

OrderReply visitOpen(std::uint64_t visit) {
  return refused(Refusal::kVisitOpen,
                 fmt::format("visit {} is open: close it in the clinic's records first", visit));
}

OrderReply notCommissioned() {
  return refused(Refusal::kNotHere, "no device is commissioned here");
}

std::string stem(const std::string& path) {
  return std::filesystem::path(path).stem().string();
}

std::string sideName(const HandModel& hand) {
  return hand.side == Side::kLeft ? "left" : "right";
}

constexpr auto kStatusEvery = std::chrono::milliseconds(200);
constexpr auto kWatchEvery = std::chrono::milliseconds(10);

/// Longest silence of the loop or the device, and longest time until a stop is obeyed [ns].
struct Patience {
  std::int64_t silent_ns, obeyed_ns;
};
constexpr Patience kWithRobot{50'000'000, 100'000'000};
/// A simulated device moves nobody, and a busy machine delays its loop.
constexpr Patience kSimulated{1'000'000'000, 1'000'000'000};

double seconds(std::int64_t duration_ns) {
  return 1e-9 * static_cast<double>(duration_ns);
}
constexpr const char* kLevelDone = "level_done";  // event that ends a level (docs/exercises.md)
constexpr auto kStopWithin = std::chrono::seconds(10);
constexpr auto kFirstTickWithin = std::chrono::seconds(1);
constexpr double kLongestRun_s = 1e9;  // bound that keeps durations within the clock's range
constexpr auto kLogWithin = std::chrono::seconds(1);

bool isSameFile(const std::string& a, const std::string& b) {
  std::error_code error;
  return a == b || std::filesystem::equivalent(a, b, error);
}

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

// Orders that wait for the station's main thread, and the conditions that must hold at their turn.

// Decides whether an order that waited, or that takes time, may still take effect. Checked again at
// the moment of starting. The client's permission was checked on arrival; this function checks that
// its conditions still hold.
OrderReply Station::Core::mayStillDo(const Task& task) const {
  const Order& order = task.order;
  if (quit_) return refused(Refusal::kEnding, "the program is ending");
  if (task.refused_before) {
    return refused(Refusal::kRefusedBefore,
                   "what this client asked for before was refused: look why, then ask again");
  }
  if (task.waited_s > kLongestWait) {
    return refused(Refusal::kWaitedTooLong,
                   fmt::format("it waited {:.1f} s behind other orders, at most {} s are allowed: "
                               "look, then ask again",
                               task.waited_s.count(), kLongestWait.count()));
  }
  if (OrderReply may = PressPermit::refuseAbsent(order, claim_); !may.accepted) return may;
  if (!task.starts) return {true, ""};
  if (order.requester) {
    if (OrderReply may = PressPermit::refuseLate(now() - task.asked_at); !may.accepted) return may;
  }
  if (stop_history_.stoppedSince(task.asked) || InterruptScope::interrupted()) {
    return refused(Refusal::kStopCame, "a stop was ordered meanwhile; nothing was armed");
  }
  if (task.person != person_.person()) {
    return refused(Refusal::kOther,
                   "another person or hand was loaded after this was asked: look who, then arm "
                   "again");
  }
  if (OrderReply may = stop_history_.refuseUnacknowledged(task.acknowledged_stop); !may.accepted) {
    return may;
  }
  const auto* arm = order.as<orders::Arm>();
  if (arm == nullptr) return {true, ""};
  return basis_.refuseOutdated(arm->basis_seen, order.client);
}

OrderReply Station::Core::stillDo(const Task& task) const {
  const std::lock_guard lock(mutex_);
  return mayStillDo(task);
}

// Queues an order, unless the present state already requires a refusal.
OrderReply Station::Core::enqueue(const Order& order, std::uint64_t asked,
                                  const std::function<void(OrderReply)>& done) {
  Task task;
  task.order = order;
  task.asked = asked;
  task.asked_at = now();
  const auto* arm = order.as<orders::Arm>();
  task.starts = arm != nullptr;
  task.acknowledged_stop = arm != nullptr ? arm->acknowledged_stop : stop_history_.count();
  if (order.is<orders::SaveProfile>()) task.profile = profileNow();
  task.person = person_.person();
  task.done = done;
  OrderReply may = mayStillDo(task);
  if (!may.accepted) return may;
  if (task.starts) stop_history_.forgetPresses();
  tasks_.push_back(std::move(task));
  wake_.notify_all();
  return may;
}

// Carries out the next order in the queue. If it is refused, the later orders of the same client
// are refused too, because they build on it.
void Station::Core::runTask() {
  Task task;
  {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kPoll, [this] { return quit_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    task = std::move(tasks_.front());
    tasks_.pop_front();
    task.waited_s = now() - task.asked_at;
    if (task.starts && !live_) starting_ = task;
  }
  const bool had_session = live_ != nullptr;
  const std::uint64_t person = person_.person();
  OrderReply reply;
  try {
    reply = carryOutTask(task);
  } catch (const std::exception& error) {  // a running loop continues
    reply = refused(Refusal::kFailed, std::string("failed: ") + error.what());
    log("an order " + reply.reason);
    const std::lock_guard lock(mutex_);
    if (had_session && !live_) stop_history_.keepRestPending();
  }
  {
    const std::lock_guard lock(mutex_);
    starting_.reset();
    // A client that loads a person and then arms means that person. Another client's order to arm
    // does not know of the load, and is refused.
    for (Task& next : tasks_) {
      const bool same = next.order.client == task.order.client && next.person == person;
      if (next.starts && same) next.person = person_.person();
    }
    if (!reply.accepted && task.order.client != 0) {
      // Orders given after the stop that cancelled this one are not refused: their sender knew of
      // the stop.
      const bool cancelled = task.starts && stop_history_.stoppedSince(task.asked);
      const std::uint64_t seen = cancelled ? stop_history_.newestStop() : UINT64_MAX;
      for (Task& next : tasks_) {
        next.refused_before |= next.order.client == task.order.client && next.asked < seen;
      }
    }
  }
  task.done(reply);
}

OrderReply Station::Core::carryOutTask(const Task& task) {
  if (OrderReply may = stillDo(task); !may.accepted) return may;
  return std::visit(
      Overloaded{[&](const orders::Arm&) { return armForClient(task); },
                 [&](const orders::LoadExercise& load) { return loadExercise(load, task); },
                 [&](const orders::SaveProfile& save) { return saveProfile(save, task); },
                 [&](const orders::LoadProfile& load) { return loadProfile(load, task); },
                 [&](const orders::OpenVisit& open) { return openVisit(open, task); },
                 [&](const orders::CloseVisit& close) { return closeVisit(close, task); },
                 [&](const auto&) { return notHere(task.order); }},
      task.order.what);
}

// Answers every waiting task, so that no client waits for ever.
void Station::Core::endTasks() {
  std::deque<Task> tasks;
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
    tasks.swap(tasks_);
  }
  for (const Task& task : tasks) task.done(refused(Refusal::kEnding, "the program is ending"));
}

// Orders and queries of clients; any thread.

void Station::Core::quit() {
  const std::lock_guard lock(mutex_);
  quit_ = true;
  wake_.notify_all();
}

void Station::Core::beginStop(bool at_once) {
  if (!live_) return;
  status_.run_state = RunState::kStopping;
  if (!stop_asked_ns_ || (at_once && !stop_at_once_)) stop_asked_ns_ = monotonicNow_ns();
  stop_at_once_ = stop_at_once_ || at_once;
  if (at_once) {
    live_->requestEmergencyStop();
  } else {
    live_->requestGentleStop();
  }
}

OrderReply Station::Core::push(const Command& command) {
  if (!live_) return refused(Refusal::kNothingArmed, "nothing is armed");
  if (!live_->tryCommand(command)) {
    return refused(Refusal::kTooMany, "too many commands at once; try again");
  }
  return {true, ""};
}

// A restart or a new level clears the mark of a finished level.
OrderReply Station::Core::act(Act action) {
  Command command;
  command.type = CommandType::kAction;
  command.index = static_cast<std::int32_t>(action);
  OrderReply pushed = push(command);
  const bool again = action == Act::kRestart || action == Act::kNext;
  if (pushed.accepted && again) level_done_at_.reset();
  return pushed;
}

// Steering must reach the loop even when its queue is full of aims. The latest request is therefore
// retried with every record.
OrderReply Station::Core::steer(Steering by) {
  if (!live_ && renewing_) {  // takes effect at the first tick of the next session
    status_.steering = by;
    return {true, ""};
  }
  if (!live_) return refused(Refusal::kNothingArmed, "nothing is armed");
  if (config_.make_device)
    return refused(Refusal::kOther, "the person at the device moves the hand");
  Command command;
  command.type = CommandType::kSteer;
  command.index = static_cast<std::int32_t>(by);
  unsent_steer_ = command;
  sendUnsent();
  status_.steering = by;
  return {true, ""};
}

void Station::Core::sendUnsent() {
  if (live_ && unsent_steer_ && live_->tryCommand(*unsent_steer_)) unsent_steer_.reset();
}

OrderReply Station::Core::setParameter(const orders::SetParameter& order, std::uint32_t client,
                                       std::uint64_t asked) {
  const auto& parameters = scene_->parameters;
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const auto& p) { return p.name == order.name; });
  if (found == parameters.end()) {
    return refused(Refusal::kUnknownParameter, "there is no parameter \"" + order.name + "\"");
  }
  if (!(order.value >= found->lower && order.value <= found->upper)) {
    return refused(Refusal::kOutOfRange,
                   fmt::format("{} = {:.6g} is out of range: {:.6g} to {:.6g} {}", order.name,
                               order.value, found->lower, found->upper, found->unit));
  }
  // A sender that raises a limit may still see the values of another person.
  if (isEffortLimit(order.name) && order.value > person_.valueOf(*found)) {
    if (OrderReply may = basis_.refuseOutdated(order.basis_seen, client); !may.accepted) return may;
    basis_.change(client, fmt::format("{} = {:.6g} {}", order.name, order.value, found->unit));
    if (permit_) permit_->noteRaisedLimit(client);
  }
  if (live_) live_->setParameter(static_cast<int>(found - parameters.begin()), order.value);
  person_.set(order.name, order.value, asked);
  return {true, ""};
}

bool Station::Core::lowersLimit(const Order& order) const {
  const auto* set = order.as<orders::SetParameter>();
  if (set == nullptr || !isEffortLimit(set->name)) return false;
  const auto& parameters = scene_->parameters;
  return std::any_of(parameters.begin(), parameters.end(), [&](const auto& p) {
    return p.name == set->name && set->value <= person_.valueOf(p);
  });
}

// An earlier holder's order must not take effect after one of the current holder, unless it stops
// or lowers a limit.
bool Station::Core::superseded(const Order& order) {
  const bool obeyed = order.stops() || lowersLimit(order);
  if (!obeyed && order.claim != 0 && order.claim < claim_) return true;
  claim_ = std::max(claim_.load(), order.claim);
  return false;
}

// True when an order is about to start the device and nothing has cancelled it.
bool Station::Core::arming() const {
  const auto comes = [this](const Task& task) { return task.starts && mayStillDo(task).accepted; };
  if (starting_ && comes(*starting_)) return true;
  return !live_ && std::any_of(tasks_.begin(), tasks_.end(), comes);
}

// A stop takes effect and is published even when nothing renders, because an order to arm may be
// under way.
OrderReply Station::Core::takeStop(const Order& order, std::uint64_t asked) {
  const RunState state = status_.run_state;
  stop_history_.stop(order, asked, now(), state, arming());
  if (!live_ && state == RunState::kDisarmed) status_.run_state = RunState::kStopped;
  beginStop(order.is<orders::EmergencyStop>());
  return {true, ""};
}

void Station::Core::order(const Order& order, const std::function<void(OrderReply)>& done) {
  if (const BodyOrders* bodies = bodiesOf(order)) return done(orderBodies(*bodies, order));
  OrderReply reply{true, ""};
  {
    const std::lock_guard lock(mutex_);
    const std::uint64_t asked = ++orders_;
    if (superseded(order)) {
      reply = refused(Refusal::kNotHolder, "another client holds the controls by now");
    } else if (order.row().thread != orders::Thread::kMain) {
      reply = carryOut(order, asked);
    } else if (over_) {
      reply = refused(Refusal::kEnding, "the program is ending");
    } else if (tasks_.size() >= kMostTasks) {
      reply = refused(Refusal::kTooMany, "too many orders wait already; try again");
    } else {
      reply = enqueue(order, asked, done);
      if (reply.accepted) {
        endUnattended(order);
        return;
      }
    }
    if (reply.accepted) endUnattended(order);
  }
  done(reply);
}

// Records that somebody takes part. Orders of the program itself do not count.
void Station::Core::endUnattended(const Order& order) {
  const auto* steer = order.as<orders::Steer>();
  const bool own = order.is<orders::HolderAlive>() || order.is<orders::Unattended>() ||
                   (steer != nullptr && steer->by != Steering::kPerson);
  if (own) return;
  attended_ = true;
  unattended_ = false;
}

OrderReply Station::Core::carryOut(const Order& order, std::uint64_t asked) {
  return std::visit(
      Overloaded{
          [&](const orders::Stop&) { return takeStop(order, asked); },
          [&](const orders::Rest&) { return takeStop(order, asked); },
          [&](const orders::EmergencyStop&) { return takeStop(order, asked); },
          [&](const orders::SetParameter& set) { return setParameter(set, order.client, asked); },
          [&](const orders::SetHelp& set) { return setHelp(set, asked); },
          [&](const orders::Aim& aim) { return this->aim(aim); },
          [&](const orders::Steer& steer) { return this->steer(steer.by); },
          [&](const orders::Action& action) { return act(action.act); },
          [&](const orders::HolderAlive& holder) { return setHolderAlive(holder.alive); },
          [&](const orders::Unattended&) { return markUnattended(order, asked); },
          [&](const orders::UnattendedEnds&) {
            return OrderReply{true, ""};
          },  // endUnattended() does the rest
          [&](const orders::Answer&) { return notCommissioned(); },
          [&](const orders::HoldToMove&) { return notCommissioned(); },
          [&](const auto&) { return notHere(order); }},
      order.what);
}

OrderReply Station::Core::setHelp(const orders::SetHelp& order, std::uint64_t asked) {
  person_.setHelp(order.help, asked);
  return {true, ""};
}

OrderReply Station::Core::aim(const orders::Aim& order) {
  if (order.q.size() != static_cast<int>(scene_->device.axes.size()) || !allFinite(order.q)) {
    return refused(Refusal::kNotAPosture, fmt::format("an aim has {} finite values, one an axis",
                                                      scene_->device.axes.size()));
  }
  if (const int far = firstFarAim(scene_->device, order.q); far >= 0) {
    return refused(Refusal::kNotAPosture,
                   "an aim of " + farAimText(scene_->device.axes[far], order.q[far]));
  }
  Command command;
  command.type = CommandType::kAim;
  command.aim = order.q;
  command.index = static_cast<std::int32_t>(order.by);
  return push(command);
}

OrderReply Station::Core::setHolderAlive(bool alive) {
  holder_alive_ = alive;
  if (!live_) return refused(Refusal::kNothingArmed, "nothing is armed");
  live_->setHolderAlive(alive);
  return {true, ""};
}

OrderReply Station::Core::markUnattended(const Order& order, std::uint64_t asked) {
  if (!live_ || status_.run_state != RunState::kRendering) return {true, ""};
  if (!armed_for_client_) {
    unattended_ = attended_;
    return {true, ""};
  }
  log("nobody has held the controls or ordered anything for long: the session ends");
  return takeStop(order, asked);
}

LoopStatus Station::Core::status() const {
  LoopStatus status;
  std::optional<DeviceStatus> device;
  if (config_.device_status) device = config_.device_status();
  {
    const std::lock_guard lock(mutex_);
    status = status_;
    status.device = device;
    status.arming = arming();
    status.endings = stop_history_.count();
    status.basis = basis_.number();
    status.rested = stop_history_.rested(status_.run_state);
    status.rest_before_start = status.rested && stop_history_.restBeforeStart();
    status.help = person_.help();
    status.bodies = bodies_.inSlots();
    status.registered = bodies_.registered();
    for (const auto& parameter : scene_->parameters) {
      status.parameters.push_back(person_.valueOf(parameter));
    }
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

// Adds what the loop and the device themselves report: whether they answer, and whether they obey a
// stop. With mutex_ held.
void Station::Core::nameAnswers(LoopStatus& status) const {
  const std::optional<DeviceStatus>& device = status.device;
  status.silent = left_silent_ || (device && device->overdue);
  if (!live_) return;
  const bool robot = config_.make_device != nullptr;
  const Patience& most = robot ? kWithRobot : kSimulated;
  const LoopWord word = live_->word();
  const std::int64_t now_ns = monotonicNow_ns(), age_ns = now_ns - word.ticked_ns;
  if (word.ticked_ns != 0) {
    if (!word.over) status.loop_age_s = seconds(age_ns);
    const bool late = !word.over && age_ns > most.silent_ns;
    // A loop ends without neutral when the device has refused its effort for a second.
    const bool refused_neutral = robot && word.over && !word.at_neutral;
    // The loop reads the age of the host's newest cycle in every tick.
    const bool host_late = device && device->hosted && has_latest_ &&
                           device->host_age_s - seconds(age_ns) > seconds(most.silent_ns);
    status.silent = status.silent || late || refused_neutral || host_late;
  }
  if (!stop_asked_ns_) return;
  const Fault asked = stop_at_once_ ? Fault::kEmergencyStop : Fault::kStopRequested;
  status.stop_pending = !any(word.stops & asked) && !word.at_neutral;
  status.stop_unconfirmed = status.stop_pending && now_ns - *stop_asked_ns_ > most.obeyed_ns;
  status.silent = status.silent || status.stop_unconfirmed;
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
  sendUnsent();
  bodies_.onRecord(record);
  // While the next session is being prepared, movement by a person belongs to the session that
  // ends.
  if (record.moved_by == Mover::kPerson)
    (starting_ && renewing_ ? keep_recording_ : attended_) = true;
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

// Orders of a game to its bodies: checked here, then handed to the loop. Any thread.

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
  ++orders_;
  if (superseded(order)) {
    return refused(Refusal::kNotHolder, "another client holds the controls by now");
  }
  if (!live_) return bodies_.keep(checked, order.claim);
  if (status_.run_state != RunState::kRendering) {
    return refused(Refusal::kStillStopping,
                   "the loop stops: arm again, then prepare shapes and spawn again");
  }
  return bodies_.handOver(checked);
}

// Profiles: a therapist's settings per patient, kept across restarts. On the station's main thread.

Profile Station::Core::profileOf(const Models& models) {
  Profile profile;
  profile.device = models.device.name;
  profile.side = sideName(models.hand);
  profile.hand = stem(models.files.hand);
  profile.exercise = models.exercise ? stem(models.files.exercise) : "";
  profile.level = models.files.level;
  return profile;
}

Profile Station::Core::profileNow() const {
  Profile profile = loaded_;
  profile.help = person_.help();
  for (const PublishedParameter& parameter : scene_->parameters) {
    profile.parameters[parameter.name] = person_.valueOf(parameter);
  }
  return profile;
}

Basis::Limits Station::Core::limitsNow() const {
  Basis::Limits limits;
  for (const PublishedParameter& parameter : scene_->parameters) {
    if (isEffortLimit(parameter.name)) limits[parameter.name] = person_.valueOf(parameter);
  }
  return limits;
}

void Station::Core::changePerson(const Task& task, const Profile* profile, bool may_raise_limits) {
  const bool visit = task.order.is<orders::OpenVisit>() || task.order.is<orders::CloseVisit>();
  person_.changePerson({profile, task.asked, visit, may_raise_limits}, config_.first_parameters,
                       scene_->parameters);
  stop_history_.changePerson();
}

OrderReply Station::Core::saveProfile(const orders::SaveProfile& order, const Task& task) {
  Profile profile = task.profile;
  profile.name = order.name;
  if (profile.exercise.empty()) {
    return refused(Refusal::kOther, "a profile needs an exercise; load one first");
  }
  if (visit_.number != 0) return visitOpen(visit_.number);
  const WaitingFor disk("the disk: a profile");
  if (auto saved = profiles_.save(profile); !saved) {
    return refused(Refusal::kOther, format(saved.errors()));
  }
  log("profile " + profile.name + " is saved");
  if (task.person == person_.person()) profile_ = profile.name;
  publishScene(record_path_);
  return {true, ""};
}

// Refused while armed: a person must not suddenly feel another person's limits.
OrderReply Station::Core::loadProfile(const orders::LoadProfile& order, const Task& task) {
  if (live_) return refused(Refusal::kArmedAlready, "it is armed: stop, then load the profile");
  if (visit_.number != 0) return visitOpen(visit_.number);
  const WaitingFor disk("the disk: a profile");
  const Expected<Profile> profile = profiles_.load(order.name);
  if (!profile) return refused(Refusal::kUnknownProfile, format(profile.errors()));
  if (profile->device != models_.device.name) {
    return refused(Refusal::kOtherProfile,
                   fmt::format("the profile {} is for the device {}, this is {}", profile->name,
                               profile->device, models_.device.name));
  }
  ModelFiles files;
  if (OrderReply known = filesOf({profile->exercise, profile->hand, profile->level}, files);
      !known.accepted) {
    known.reason = fmt::format("the profile {}: {}", profile->name, known.reason);
    return known;
  }
  const Expected<Models> models = loadModels(files);
  if (!models) return refused(Refusal::kCannotLoad, format(models.errors()));
  if (sideName(models->hand) != profile->side) {
    return refused(
        Refusal::kOtherProfile,
        fmt::format("the profile {} is for a {} hand, its hand {} is a {} one", profile->name,
                    profile->side, profile->hand, sideName(models->hand)));
  }
  if (OrderReply fits = refuseParameters("the profile " + profile->name, *profile, *models);
      !fits.accepted) {
    return fits;
  }
  return this->load(task, files, &*profile);
}

// Refuses an order that changes the hand in a visit. Another exercise or level is allowed.
OrderReply Station::Core::fitsVisit(const orders::LoadExercise& order) const {
  if (visit_.number == 0 || order.hand.empty() || order.hand == stem(models_.files.hand)) {
    return {true, ""};
  }
  return visitOpen(visit_.number);
}

// Refused while armed: a person must not suddenly feel another person's limits.
OrderReply Station::Core::openVisit(const orders::OpenVisit& order, const Task& task) {
  if (config_.visit_hands_folder.empty()) {
    return refused(Refusal::kNotHere, "no visits here: the program runs without --clinic");
  }
  if (live_) return refused(Refusal::kArmedAlready, "it is armed: stop, then open the visit");
  if (order.visit == 0) return refused(Refusal::kOther, "a visit has a number other than 0");
  const bool goes_on = visit_.number == order.visit;
  if (visit_.number != 0 && !goes_on) return visitOpen(visit_.number);
  // Resolves the model files; the hand may be a file of the clinic.
  ModelFiles files;
  if (OrderReply known = filesOf({order.exercise, order.hand, order.level}, files);
      !known.accepted) {
    return known;
  }
  if (order.exercise.empty()) return refused(Refusal::kOther, "a visit names its exercise");
  if (order.hand.empty()) {
    const fs::path name(order.hand_file);
    if (name.empty() || name.filename() != name || name.extension() != ".toml") {
      return refused(Refusal::kUnknownHand,
                     fmt::format("\"{}\" is no hand file: a visit names one of the hands, or a "
                                 "file name that ends in .toml",
                                 printable(order.hand_file)));
    }
    files.hand = (fs::path(config_.visit_hands_folder) / name).string();
  }
  const WaitingFor disk("the disk: a visit");
  const Expected<Models> models = loadModels(files);
  if (!models) return refused(Refusal::kCannotLoad, format(models.errors()));
  // Checks the settings of the visit.
  Profile settings = profileOf(*models);
  settings.help = order.help;
  settings.parameters = order.parameters;
  if (OrderReply fits = refuseParameters(fmt::format("visit {}", order.visit), settings, *models);
      !fits.accepted) {
    return fits;
  }
  return loadVisit(task, files, settings, {order.visit, order.item});
}

// Loads the models and settings of a visit from the clinic's records, and removes those of the
// previous person. The next item of the same visit keeps effort limits that a person has lowered.
OrderReply Station::Core::loadVisit(Task task, const ModelFiles& files, const Profile& settings,
                                    const Visit& visit) {
  task.order.may_raise_limits = visit_.number != visit.number || visit.number == 0;
  const Visit before = std::exchange(visit_, visit);
  OrderReply reply;
  try {
    reply = load(task, files, &settings);
  } catch (...) {
    visit_ = before;
    throw;
  }
  if (!reply.accepted) {
    visit_ = before;
    return reply;
  }
  log(visit.number == 0 ? fmt::format("visit {} is closed", before.number)
                        : fmt::format("visit {}, item {}", visit.number, visit.item));
  return reply;
}

OrderReply Station::Core::closeVisit(const orders::CloseVisit& order, const Task& task) {
  if (visit_.number == 0) return {true, ""};  // closed already; the client missed an earlier answer
  if (visit_.number != order.visit) return visitOpen(visit_.number);
  if (live_) return refused(Refusal::kArmedAlready, "it is armed: stop, then close the visit");
  return loadVisit(task, config_.files, {}, {});
}

OrderReply Station::Core::refuseParameters(const std::string& whose, const Profile& profile,
                                           const Models& models) const {
  const SceneFacts facts = sceneFacts(models, config_.rig.period_s);
  for (const auto& parameter : profile.parameters) {
    const std::string& name = parameter.first;  // clang 14 cannot capture structured bindings
    const double value = parameter.second;
    const auto known = std::find_if(facts.parameters.begin(), facts.parameters.end(),
                                    [&](const PublishedParameter& p) { return p.name == name; });
    if (known == facts.parameters.end()) {
      return refused(Refusal::kUnknownParameter,
                     fmt::format("{} sets {}, which the exercise {} does not have", whose, name,
                                 profile.exercise));
    }
    if (!(value >= known->lower && value <= known->upper)) {
      return refused(Refusal::kOutOfRange,
                     fmt::format("{} sets {} = {}, which must be in [{}, {}] {}", whose, name,
                                 value, known->lower, known->upper, known->unit));
    }
  }
  return {true, ""};
}

// Steps from an order to arm to a running loop; all on the station's main thread.

std::vector<double> Station::Core::parametersAtStart() const {
  const std::lock_guard lock(mutex_);
  std::vector<double> values;
  for (const PublishedParameter& parameter : scene_->parameters) {
    values.push_back(person_.valueOf(parameter));
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
  options.fill_pool = config_.make_device != nullptr;  // a simulated device may be late
  options.status = [this](const std::string& what) { log("rehearsal: measuring " + what); };
  auto rehearsal = rehearse(models, start, config_.rig, options);
  rehearsed_ticks_ = 0;
  if (rehearsal) log("rehearsal " + describe(*rehearsal));
  return rehearsal;
}

// Rehearses the next models while the loop renders. A stop cancels the rehearsal; the models are
// then loaded without one.
OrderReply Station::Core::rehearseNext(const Models& models, Task task,
                                       std::optional<Rehearsal>& passed) {
  task.starts = true;
  task.person = person_.person();
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

// Makes the rig around the real device, which a person holds, or around a simulated device, which a
// virtual patient or a client moves.
Expected<std::unique_ptr<Rig>> Station::Core::makeRig(std::unique_ptr<Player> player) const {
  if (!config_.make_device) {
    auto steered = std::make_unique<SteeredPlayer>(std::move(player), models_.device);
    return buildRig(models_, std::move(steered), config_.rig);
  }
  auto device = config_.make_device(models_.device);
  if (!device) return device.errors();
  return buildRig(models_, std::move(*device), config_.rig);
}

// Prepares a run; the device is not enabled yet.
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
    if (!room.empty()) log(room);
  }
  plan.real_time_required = config_.real_time_required;
  if (rehearsed_) plan.rehearsed = rehearsed_->passed;
  return Run::prepare(std::move(*rig), std::move(plan));
}

// Publishes the new session before its first record. Publishes the last session again if the new
// one cannot start.
OrderReply Station::Core::startSession(std::unique_ptr<Player> player, const Task& task,
                                       const std::string& record, std::uint64_t duration_ticks,
                                       bool for_client) {
  RunPlan plan;
  plan.title = title();
  plan.profile = profile_;
  plan.visit = visit_.number;
  plan.visit_item = visit_.item;
  plan.seed = config_.seed + arming_;
  plan.record = record;
  plan.duration_ticks = duration_ticks;
  plan.black_box = blackBoxPath(record);
  plan.interrupts = &InterruptScope::shared();
  plan.sinks.push_back([this](const TickRecord& r) { keepLatest(r); });
  plan.sinks.insert(plan.sinks.end(), sinks_.begin(), sinks_.end());
  const std::shared_ptr<PressPermit> permit = permitOf(task);
  plan.permit = permit;
  const std::optional<double> place = placeOfRest();
  const bool had_latest = forgetLatest();
  LoopStatus before;
  {
    const std::lock_guard lock(mutex_);
    before = status_;
    before.rested = stop_history_.rested(status_.run_state);
    before.endings = stop_history_.count();
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
    reply = adopt(unused, task, permit, parameters, place);
    if (reply.accepted) {
      auto begun = live_->begin();
      if (begun) return sessionRuns(effortBegins(permit.get()), record);
      reply = stillDo(task);  // a stop came while the device was enabled
      if (reply.accepted) reply = refused(Refusal::kCannotStart, format(begun.errors()));
    }
  } else {
    reply = refused(Refusal::kCannotStart, format(prepared.errors()));
  }
  restoreStatus(std::move(before), task, had_latest, std::move(unused));
  return reply;
}

std::shared_ptr<PressPermit> Station::Core::permitOf(const Task& task) const {
  if (!task.order.requester) return nullptr;  // the program itself
  return std::make_shared<PressPermit>(
      task.order, task.asked_at, [this] { return now(); }, claim_);
}

// Waits for the first tick, which judges the permit. A session whose permit no longer holds stays
// at neutral and ends as after a stop.
OrderReply Station::Core::effortBegins(const PressPermit* permit) {
  if (permit == nullptr) return {true, ""};
  const auto until = StationClock::now() + kFirstTickWithin;
  while (permit->verdict() == PressPermit::Verdict::kOpen && live_->running() &&
         StationClock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (permit->verdict() != PressPermit::Verdict::kVoid) return {true, ""};
  const std::lock_guard lock(mutex_);
  status_.run_state = RunState::kStopping;
  return permit->refusal();
}

// Restores the published state after a session that never began, and destroys its run.
void Station::Core::restoreStatus(LoopStatus before, const Task& task, bool had_latest,
                                  std::unique_ptr<Run> unused) {
  {
    const std::lock_guard lock(mutex_);
    if (live_) unused = std::move(live_);
    stop_asked_ns_.reset();
    stop_at_once_ = false;
    stop_history_.restoreRest(before.rested, before.endings);
    if (stop_history_.stoppedSince(task.asked) && before.run_state == RunState::kDisarmed) {
      before.run_state = RunState::kStopped;
    }
    status_ = before;
    bodies_.giveBack();
  }
  unused.reset();  // closes its recording outside the lock, so that no client waits for it
  publishScene("");
  const std::lock_guard lock(mutex_);
  has_latest_ = had_latest;
}

OrderReply Station::Core::sessionRuns(OrderReply reply, const std::string& record) {
  for (const SetupLine& line : live_->setup()) {
    if (!line.granted && arming_ == 1) log(line.what + ": " + line.sentence);
  }
  record_path_ = record;
  began_utc_ = utcNow();
  recorded_profile_ = profile_;
  loss_reported_ = false;
  {
    const std::lock_guard lock(mutex_);
    left_silent_ = false;
    bodies_.begun();
  }
  ++outcome_.sessions;
  return reply;
}

// Makes the run the live session: from here on a stop reaches it, even before its first tick. If
// the order may not be carried out any more, for example after a stop during construction, the run
// is discarded and not published.
OrderReply Station::Core::adopt(std::unique_ptr<Run>& run, const Task& task,
                                const std::shared_ptr<PressPermit>& permit,
                                const std::vector<double>& parameters,
                                std::optional<double> place) {
  const std::lock_guard lock(mutex_);
  if (OrderReply may = mayStillDo(task); !may.accepted) return may;
  if (permit != nullptr) {
    if (OrderReply may = permit->refuseNow(); !may.accepted) return may;
  }
  live_ = std::move(run);
  permit_ = permit;
  status_.latched = Fault::kNone;
  const bool steered = renewing_ && status_.steering == Steering::kPerson;
  status_.steering = Steering::kVirtualPatient;
  unsent_steer_.reset();
  unattended_ = false;
  began_at_ = now();
  status_.run_state = RunState::kRendering;
  starting_.reset();
  stop_history_.beginSession();
  catchUp(parameters, place);
  if (steered) (void)steer(Steering::kPerson);
  bodies_.begin(models_, *live_, claim_);
  return {true, ""};
}

// Sends the session the orders that arrived during its construction.
void Station::Core::catchUp(const std::vector<double>& parameters, std::optional<double> place) {
  live_->setHolderAlive(holder_alive_);
  if (place) {
    Command begin;
    begin.type = CommandType::kAction;
    begin.index = static_cast<std::int32_t>(kBeginAt);
    begin.value = *place;
    (void)push(begin);  // its queue is still empty
  }
  for (std::size_t i = 0; i < std::min(parameters.size(), scene_->parameters.size()); ++i) {
    const double value = person_.valueOf(scene_->parameters[i]);
    if (value != parameters[i]) live_->setParameter(static_cast<int>(i), value);
  }
}

std::optional<double> Station::Core::placeOfRest() const {
  const int value = models_.exercise ? models_.exercise->description().resume_value : -1;
  const std::lock_guard lock(mutex_);
  if (value < 0 || !stop_history_.rested(status_.run_state)) return std::nullopt;
  if (!has_latest_ || value >= latest_.exercise.value_count) return std::nullopt;
  return latest_.exercise.values[value];
}

// Remaining ticks of a run with a duration; 0: no end.
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
  // A session that began and stayed at neutral keeps its recording.
  if (!reply.accepted && record != record_path_) files_.giveBack(record);
  return reply;
}

// Arms without an order of a client: the first session, and the later ones while nobody takes part.
// If the disk fails, the session runs unrecorded, because there is nobody to whom a refusal could
// be reported.
OrderReply Station::Core::armUnasked(const Task& task, std::uint64_t duration_ticks) {
  const std::string record = config_.record.empty() ? newRecording() : config_.record;
  OrderReply reply = arm(task, record, duration_ticks, false);
  if (reply.accepted || !config_.record.empty()) return reply;
  files_.giveBack(record);
  if (record.empty() || reply.refusal != Refusal::kCannotStart) return reply;
  const std::string why = reply.reason;
  reply = arm(task, "", duration_ticks, false);
  if (reply.accepted) log("what follows is not recorded: " + why);
  return reply;
}

// Reserves the name of a new recording; empty when that fails.
std::string Station::Core::newRecording() {
  if (!files_.kept()) return {};
  const std::string whose = visit_.number != 0 ? fmt::format("visit-{}", visit_.number) : profile_;
  auto named = files_.nameNew(whose, scene()->exercise_name, models_.files.level);
  if (!named) {
    log("what follows is not recorded: " + format(named.errors()));
    return {};
  }
  return *named;
}

// Lifecycle of sessions; all on the station's main thread.

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
      [this](const SafetyTransition& transition) { log(describe(transition)); });
  publishScene("");
  return Done{};
}

std::shared_ptr<SceneFacts> Station::Core::sceneOf(const Models& models,
                                                   const std::string& profile) const {
  auto facts = std::make_shared<SceneFacts>(sceneFacts(models, config_.rig.period_s));
  facts->program_version = config_.program_version;
  facts->exercises = {};
  for (const ExerciseFile& file : listExercises(config_.config_folder + "/exercises")) {
    facts->exercises.push_back(file.name);
  }
  facts->hands = stemsIn(config_.config_folder + "/hands");
  facts->profiles = profiles_.list();
  facts->profile = profile;
  facts->visit = visit_;
  return facts;
}

void Station::Core::publishScene(const std::string& recording) {
  auto facts = sceneOf(models_, profile_);
  Profile loaded = profileOf(models_);
  const std::lock_guard lock(mutex_);
  show(std::move(facts), std::move(loaded), recording);
}

void Station::Core::show(std::shared_ptr<SceneFacts> facts, Profile loaded,
                         const std::string& recording) {
  facts->recording = fs::path(recording).filename().string();
  facts->session = status_.session;
  scene_ = std::move(facts);
  loaded_ = std::move(loaded);
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

// Forgets the last record of the previous session; true if there was one.
bool Station::Core::forgetLatest() {
  const auto names =
      models_.exercise ? models_.exercise->description().event_names : std::vector<std::string>{};
  const auto found = std::find(names.begin(), names.end(), kLevelDone);
  const std::lock_guard lock(mutex_);
  level_done_at_.reset();
  level_done_ = found == names.end() ? -1 : static_cast<int>(found - names.begin());
  return std::exchange(has_latest_, false);
}

void Station::Core::finishSession(bool goes_on) {
  std::unique_ptr<Run> over;
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
  const bool discarded = discardUnattended(ended);
  files_.note(record_path_, title(), recorded_profile_, began_utc_,
              static_cast<double>(ended.summary.ticks) * config_.rig.period_s, missing);
  outcome_.faulted = outcome_.faulted || ended.faulted;
  // The scene is published before the end, so that clients find the recording in the list.
  if (discarded || !record_path_.empty()) publishScene("");
  {
    // The session is moved out and destroyed outside the lock, so that no order waits for it.
    LoopStatus answered;
    if (config_.device_status) answered.device = config_.device_status();
    const std::lock_guard lock(mutex_);
    nameAnswers(answered);
    left_silent_ = config_.make_device && answered.silent;
    stop_asked_ns_.reset();
    stop_at_once_ = false;
    status_.run_state = ended.faulted ? RunState::kFaulted : RunState::kStopped;
    status_.latched = ended.counters.latched;
    stop_history_.endSession(ended.faulted, goes_on);
    over = std::move(live_);
    bodies_.end();
  }
  over.reset();
  if (discarded && goes_on) {  // a session that nobody joined has no results
    --outcome_.sessions;
    return;
  }
  outcome_.last = EndedSession{outcome_.sessions, std::move(ended), safety_->transitions(),
                               rehearsed_, record_path_};
  if (config_.ended) config_.ended(*outcome_.last);
  record_path_.clear();
}

// Called after the last tick. Removes a recording that the program started by itself and that
// nobody took part in. A recording that ended by a fault is kept.
bool Station::Core::discardUnattended(RunOutcome& ended) {
  bool joined = false, asked_for = false;
  {
    const std::lock_guard lock(mutex_);
    joined = std::exchange(keep_recording_, false) || attended_;
    attended_ = attended_ && renewing_;  // a client that joins while the session ends also takes
                                         // part in the next one
    asked_for = armed_for_client_ || !config_.record.empty();
  }
  if (joined || asked_for || ended.faulted || record_path_.empty()) return false;
  files_.remove(record_path_);
  record_path_.clear();
  ended.written = 0;
  return true;
}

// Ends a session that the program armed, when nobody has joined it for long or everybody has left,
// and arms the next one. False when it is not yet time.
bool Station::Core::renewSession() {
  Task again;
  {
    const std::lock_guard lock(mutex_);
    const bool alone = !attended_ && now() - began_at_ >= config_.renew_after;
    if (armed_for_client_ || !config_.record.empty() || !(alone || unattended_) ||
        status_.run_state != RunState::kRendering) {
      return false;
    }
    again.acknowledged_stop = stop_history_.count();
    again.person = person_.person();
    again.asked = orders_;
    again.starts = true;
    starting_ = again;
    renewing_ = true;
    keep_recording_ = std::exchange(attended_, false);
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
  starting_.reset();
  if (!reply.accepted) stop_history_.keepRestPending();
  return true;
}

void Station::Core::stopGently(bool goes_on) {
  if (!live_) return;
  {
    const std::lock_guard lock(mutex_);
    beginStop(false);
  }
  const auto until = StationClock::now() + kStopWithin;
  while (live_->running() && StationClock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  finishSession(goes_on);
}

// Resolves the files that an order names, without reading them.
OrderReply Station::Core::filesOf(const orders::LoadExercise& order, ModelFiles& files) const {
  files = models_.files;
  if (!order.exercise.empty()) {
    const auto known = listExercises(config_.config_folder + "/exercises");
    const auto found = std::find_if(known.begin(), known.end(), [&](const ExerciseFile& f) {
      return f.name == order.exercise;
    });
    if (found == known.end()) {
      return refused(Refusal::kUnknownExercise, "there is no exercise \"" + order.exercise + "\"");
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

OrderReply Station::Core::loadExercise(const orders::LoadExercise& order, const Task& task) {
  ModelFiles files;
  if (OrderReply fits = fitsVisit(order); !fits.accepted) return fits;
  if (OrderReply known = filesOf(order, files); !known.accepted) return known;
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
  // A load that cannot be rendered stops no session and opens no visit.
  if (config_.rehearse && (rendered || task.order.is<orders::OpenVisit>())) {
    OrderReply passed = rehearseNext(*models, task, rehearsal);
    if (!passed.accepted) return passed;
  }
  if (OrderReply may = stillDo(task); !may.accepted) return may;
  Task start = task;
  start.starts = true;
  start.person = person_.person();
  if (rendered) {
    const std::lock_guard lock(mutex_);
    starting_ = start;
  }
  // These are computed before anything changes, because the person and the published scene must
  // change together.
  const bool other_person = profile != nullptr || !isSameFile(files.hand, models_.files.hand);
  std::string name = profile != nullptr ? profile->name : other_person ? "" : profile_;
  auto scene = sceneOf(*models, name);
  Profile loaded = profileOf(*models);
  stopGently(true);
  bool again = false;
  {
    // Rendering continues only if it was on until now and nobody stopped it. A stop or a fault
    // remains in force. No limit rises without a press of Start.
    const std::lock_guard lock(mutex_);
    const std::shared_ptr<const SceneFacts> before = scene_;
    const Basis::Limits limits_before = limitsNow();
    if (other_person) changePerson(task, profile, task.order.may_raise_limits && !rendered);
    show(std::move(scene), std::move(loaded), "");
    const std::string what = Basis::differences(*before, limits_before, *scene_, limitsNow());
    if (!what.empty()) basis_.change(task.order.client, what);
    std::swap(models_, *models);
    profile_ = std::move(name);
    rehearsed_ = std::move(rehearsal);
    bodies_.dropKept();  // they were checked against the previous scene
    start.person = person_.person();
    if (starting_) starting_->person = start.person;
    again = rendered && mayStillDo(start).accepted && !any(status_.latched);
    if (had_session && !again) stop_history_.keepRestPending();
  }
  forgetLatest();
  if (!again) return {true, ""};
  OrderReply reply = armForClient(start);
  if (!reply.accepted) {
    const std::lock_guard lock(mutex_);
    stop_history_.keepRestPending();
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
  if (status_.steering != Steering::kVirtualPatient) return;
  (void)act(Act::kRestart);
}

void Station::Core::watchSession() {
  if (!live_) return;
  if (!live_->running()) {
    finishSession();
    return;
  }
  if (renewSession()) return;
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
  const auto duration_ticks = static_cast<std::uint64_t>(
      std::llround(std::clamp(duration_s, 0.0, kLongestRun_s) / config_.rig.period_s));
  // Arms the first session, if requested.
  if (arm_at_once && !InterruptScope::interrupted()) {
    Task first;
    first.acknowledged_stop = 1;
    first.asked = kFirstArming;
    first.starts = true;
    {
      const std::lock_guard lock(mutex_);
      starting_ = first;
    }
    const OrderReply reply = armUnasked(first, duration_ticks);
    {
      const std::lock_guard lock(mutex_);
      starting_.reset();
    }
    // After a stop, run() goes on, so that the client that stopped may arm.
    const bool stopped = reply.refusal == Refusal::kStopCame || reply.refusal == Refusal::kEnding;
    if (!reply.accepted && !stopped && !InterruptScope::interrupted()) {
      return fileFault("", "the loop could not be armed: " + reply.reason, "");
    }
  }
  const std::chrono::duration<double> within(std::clamp(duration_s, 0.0, kLongestRun_s));
  const auto until =
      StationClock::now() + std::chrono::duration_cast<StationClock::duration>(within);
  if (duration_ticks > 0 && arm_at_once) ends_at_ = until;
  bool ending = false;
  // Carries out orders and watches the session until the end.
  while (!ending) {
    runTask();
    watchSession();
    const std::lock_guard lock(mutex_);
    outcome_.interrupted = InterruptScope::interrupted();
    const bool over = duration_ticks > 0 && (arm_at_once ? !live_ : StationClock::now() >= until);
    ending = outcome_.interrupted || quit_ || over;
  }
  stopGently();
  endTasks();
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
