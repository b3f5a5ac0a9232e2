#pragma once

#include "assembly/run.hpp"
#include "registry/body_registry.hpp"
#include "server/async_log.hpp"
#include "station/game_body_tracker.hpp"
#include "station/profiles.hpp"
#include "station/session_files.hpp"
#include "station/station.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace wholehand {

using StationClock = std::chrono::steady_clock;

/// Implementation of Station. Says which thread may call what.
class Station::Core {
 public:
  explicit Core(StationConfig config)
      : config_(std::move(config)),
        files_(config_.recordings_folder),
        profiles_(config_.profiles_folder),
        log_(config_.log) {}

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
  /// Number of the order by which run() arms at once; a stop before run() cancels it.
  static constexpr std::uint64_t kFirstArming = 1;
  /// Limit of queued tasks. It bounds how long a client that floods the station can delay others.
  static constexpr std::size_t kMostTasks = 8;

  /// Longest time that an order may wait behind others.
  static constexpr std::chrono::seconds kLongestWait{3};

  /// An order that waits for the main thread.
  struct Task {
    Order order;
    std::uint64_t asked = 0;  ///< its number
    StationClock::time_point asked_at;
    bool starts = false;          ///< it is about to start the device, or goes on to that
    bool refused_before = false;  ///< while it waited, an earlier order of its client was refused
    std::chrono::duration<double> waited_s{0.0};  ///< behind others, once its turn has come
    Profile profile;                              ///< of the moment when it was asked
    std::uint64_t person = 0;                     ///< likewise, person_
    std::function<void(OrderReply)> done;
  };

  /// What a person set, and by which order.
  struct Setting {
    double value = 0.0;
    std::uint64_t asked = 0;
  };

  // Main thread.
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
                   const std::vector<double>& parameters, std::optional<double> place);
  void restoreStatus(LoopStatus before, const Task& task, bool had_latest,
                     std::unique_ptr<Run> unused);
  OrderReply sessionRuns(OrderReply reply, const std::string& record);
  [[nodiscard]] std::uint64_t ticksLeft() const;
  [[nodiscard]] Expected<Rehearsal> rehearsalOf(const Models& models, const AxisPosition& start,
                                                const Task& task) const;
  OrderReply rehearseNext(const Models& models, Task task, std::optional<Rehearsal>& passed);
  [[nodiscard]] OrderReply filesOf(const Order& order, ModelFiles& files) const;
  OrderReply loadExercise(const Task& task);
  /// @param profile whose values hold from then on; null: those that hold, unless the hand changes
  OrderReply load(const Task& task, const ModelFiles& files, const Profile* profile);
  OrderReply carryOutTask(Task& task);
  OrderReply saveProfile(const Task& task);
  OrderReply loadProfile(const Task& task);
  [[nodiscard]] OrderReply refuseParameters(const Profile& profile, const Models& models) const;
  void stopGently(bool goes_on = false);
  /// @param goes_on a load continues the rendering: no ending that a person must see
  void finishSession(bool goes_on = false);
  bool discardUnjoined(RunOutcome& ended);
  void refreshStatus();
  void publishScene(const std::string& recording);
  void runTask();
  void watchSession();
  void endTasks();
  [[nodiscard]] std::vector<double> parametersAtStart() const;
  [[nodiscard]] std::unique_ptr<Player> makePlayer(const Models& models) const;
  [[nodiscard]] std::string title() const;
  bool forgetLatest();
  /// Position in the level at which the player began to rest; empty: start at the beginning.
  [[nodiscard]] std::optional<double> placeOfRest() const;
  // Any thread.
  [[nodiscard]] OrderReply stillDo(const Task& task) const;  ///< mayStillDo(), which it locks for
  OrderReply orderBodies(const Order& order);
  // Any thread, mutex_ held.
  [[nodiscard]] bool superseded(const Order& order);
  [[nodiscard]] OrderReply mayStillDo(const Task& task) const;
  [[nodiscard]] OrderReply refuseUnseen(std::uint32_t seen) const;
  void takeStop(const Order& order, std::uint64_t asked);
  [[nodiscard]] bool rested() const;
  OrderReply enqueue(const Order& order, std::uint64_t asked,
                     const std::function<void(OrderReply)>& done);
  [[nodiscard]] double valueOf(const PublishedParameter& parameter) const;
  [[nodiscard]] Profile profileNow() const;
  [[nodiscard]] static Profile profileOf(const Models& models);
  void changePerson(const Task& task, const Profile* profile);
  OrderReply carryOut(const Order& order, std::uint64_t asked);
  void catchUp(const std::vector<double>& parameters, std::optional<double> place);
  OrderReply steer(Steering by);
  void sendUnsent();
  OrderReply setParameter(const Order& order);
  OrderReply push(const Command& command);
  OrderReply act(const Command& command);
  OrderReply handOver(CheckedOrders& checked);
  OrderReply keep(CheckedOrders& checked, std::uint32_t claim);
  bool takeBack(const Command& removal);
  void noteJoined(const Order& order);
  void dropKept();
  void handOverKept();
  void beginRegistry();
  void orderRegistered(CheckedOrders& orders);
  void keepSlotsApart(CheckedOrders& orders);
  void followRegistry(const TickRecord& record);
  void publishRegistered();
  void beginStop(bool at_once);
  [[nodiscard]] StationClock::time_point now() const {
    return config_.now ? config_.now() : StationClock::now();
  }
  void showRehearsal();

  void keepLatest(const TickRecord& record);
  void nameSafety(LoopStatus& status) const;
  void restartLevel();
  void say(const std::string& line) const { log_.write(line); }

  StationConfig config_;
  Models models_;
  std::vector<std::function<void(const TickRecord&)>> sinks_;
  SessionFiles files_;
  Profiles profiles_;
  std::string profile_;  ///< last profile loaded or saved, while it applies; empty: none
  mutable AsyncLog log_;
  std::unique_ptr<SafetyLog> safety_;   ///< set by load()
  std::optional<Rehearsal> rehearsed_;  ///< rehearsal of the loaded rig
  std::uint64_t arming_ = 0;
  mutable std::atomic<std::uint32_t> rehearsed_ticks_{0};   ///< of a rehearsal under way
  std::string record_path_, began_utc_, recorded_profile_;  ///< of the running session
  std::string being_written_;  ///< recording that scene_ names; guarded by mutex_
  bool told_of_loss_ = false;  ///< its loss of ticks was reported
  StationClock::time_point status_at_;
  std::optional<StationClock::time_point> ends_at_;  ///< end of a run with a duration
  StationOutcome outcome_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Task> tasks_;
  bool quit_ = false;
  // Orders are numbered as they arrive. A stop that follows an order to arm or to load cancels the
  // start, however far it has got.
  std::uint64_t orders_ = kFirstArming;
  std::uint64_t stop_asked_ = 0;
  std::uint32_t rest_ending_ = 0;  ///< ending of the newest rest; 0: none since the last arming
  /// Order::number of the newest stop since somebody asked to arm, by client and kind: the same
  /// again is a repetition.
  std::map<std::tuple<std::uint32_t, OrderType, bool>, std::uint32_t> stops_;
  bool armed_for_client_ = false;        ///< else armed by the program itself
  bool joined_ = false;                  ///< somebody takes part in the session, or in the next one
  bool left_alone_ = false;              ///< whoever took part has left
  bool keep_recording_ = false;          ///< somebody took part before the session was to end
  bool renewing_ = false;                ///< the session ends, and the program arms the next one
  StationClock::time_point began_at_;    ///< of the running session
  std::uint32_t claim_ = 0;              ///< newest claim on the controls
  bool over_ = false;                    ///< no more orders are carried out
  bool owner_alive_ = true;              ///< latest value; passed to a session that begins
  std::optional<Command> unsent_steer_;  ///< the command queue was full
  std::shared_ptr<const SceneFacts> scene_;
  LoopStatus status_;
  GameBodyTracker tracker_;
  BodyRegistry registry_;
  std::shared_ptr<const RegisteredBodies> registered_;  ///< as published; null: none
  std::uint64_t registered_version_ = 0, registered_moves_ = 0;
  StationClock::time_point registered_at_;
  std::vector<CheckedOrders> kept_;                  ///< shapes and spawns for the next arming
  std::uint32_t kept_claim_ = 0;                     ///< of the client that ordered them
  Help help_ = Help::kUnsaid;                        ///< help that pages give the player
  std::uint64_t help_asked_ = 0;                     ///< order that set it
  std::map<std::string, Setting> asked_parameters_;  ///< persist as long as the person
  std::uint64_t person_ = 0;                         ///< counts persons and hands that were loaded
  Profile loaded_;                                   ///< what is loaded, without name and values

  std::mutex report_mutex_;
  mutable std::mutex latest_mutex_;
  TickRecord latest_;
  int level_done_ = -1;  ///< index of that event in the loaded exercise; -1: none
  std::optional<StationClock::time_point> level_done_at_;
  bool has_latest_ = false;  ///< latest_ is of this session

  std::unique_ptr<Run> live_;  ///< last member: its threads use the members above
};

}  // namespace wholehand
