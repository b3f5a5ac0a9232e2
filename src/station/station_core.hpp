#pragma once

#include "rig/run/run.hpp"
#include "station/decide.hpp"
#include "station/loop_answers.hpp"
#include "station/model_reader.hpp"
#include "station/press_permit.hpp"
#include "station/reports.hpp"
#include "station/server/logs.hpp"
#include "station/session_files.hpp"
#include "station/station.hpp"
#include "station/station_bodies.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

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
  // Called on any thread:
  void feed(const events::Any& event, const std::function<void(OrderReply)>& done = nullptr);
  OrderReply orderBodies(const BodyOrders& bodies, const Order& order);
  [[nodiscard]] std::string recordingBeingWritten() const {
    const std::lock_guard lock(mutex_);
    return being_written_;
  }
  [[nodiscard]] LoopStatus answers() const;
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
  Reports reports_;
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
  std::condition_variable wake_;
  StationState state_;
  std::map<std::uint64_t, std::function<void(OrderReply)>> asking_;  ///< by order number
  std::string being_written_;                                        ///< recording in the scene
  LoopStatus status_;  ///< the figures; describe() adds the rest
  LoopAnswers answers_;
  bool discard_ = false;                 ///< the recording of the session that ended is discarded
  std::shared_ptr<PressPermit> permit_;  ///< of the live session; null: the program's own
  std::optional<Command> unsent_steer_;  ///< steering command that waits because the queue was full
  StationBodies bodies_;                 ///< bodies of a game
  TickRecord latest_;
  int level_done_ = -1;  ///< index of the event level_done in the loaded exercise; -1: none
  std::optional<StationClock::time_point> level_done_at_;
  bool has_latest_ = false;  ///< latest_ belongs to this session

  std::unique_ptr<Run> live_;  ///< last member: its threads use the members above
};

}  // namespace wholehand
