#pragma once

#include "station/live_session.hpp"
#include "station/session_files.hpp"
#include "station/station.hpp"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

using StationClock = std::chrono::steady_clock;

/// What a Station is inside: who may call what from which thread is said here.
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
  std::optional<StationClock::time_point> stop_at_;  ///< when the exercise has faded out
  std::unique_ptr<LiveSession> live_;

  mutable std::mutex latest_mutex_;
  TickRecord latest_;
  int level_done_ = -1;  ///< index of that event in the loaded exercise; -1: none
  std::optional<StationClock::time_point> level_done_at_;
  bool has_latest_ = false;  ///< of this session
};

}  // namespace wholehand
