#pragma once

#include "assembly/recorded_run.hpp"
#include "assembly/rig.hpp"
#include "patient/steered_player.hpp"
#include "runtime/session.hpp"
#include "telemetry/black_box.hpp"
#include "telemetry/hub.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/statistics.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// How one armed loop is to run.
struct LiveSessionPlan {
  std::string title;
  std::uint64_t seed = 0;
  std::string record;                ///< HDF5 file; empty: none
  std::uint64_t duration_ticks = 0;  ///< 0: until stopped
  std::vector<double> parameters;    ///< live parameters at the start; empty: their own values
  std::vector<std::function<void(const TickRecord&)>> sinks;  ///< on the telemetry thread
};

/// One armed loop in real time, with a virtual patient that a person may steer: rig, session,
/// telemetry and recording, from arming to neutral. Made and ended by one thread.
class LiveSession {
 public:
  /// Builds the rig and arms it. Nothing ticks yet; a stop that is asked for from here on holds.
  /// @pre player has the device's axes
  [[nodiscard]] static Expected<std::unique_ptr<LiveSession>> arm(const Models& models,
                                                                  std::unique_ptr<Player> player,
                                                                  const RigOptions& options,
                                                                  const LiveSessionPlan& plan);
  /// Starts the loop. Once.
  [[nodiscard]] Expected<Done> begin();
  /// Both at once.
  [[nodiscard]] static Expected<std::unique_ptr<LiveSession>> start(const Models& models,
                                                                    std::unique_ptr<Player> player,
                                                                    const RigOptions& options,
                                                                    const LiveSessionPlan& plan);
  /// Where it still runs: ramps to neutral first.
  ~LiveSession();
  LiveSession(const LiveSession&) = delete;
  LiveSession& operator=(const LiveSession&) = delete;

  // Any one thread at a time.
  [[nodiscard]] bool tryCommand(const Command& command) { return session_->tryCommand(command); }
  // Any thread.
  void requestStop() noexcept { session_->requestStop(); }
  void requestGentleStop() noexcept { session_->requestGentleStop(); }
  void setOwnerAlive(bool alive) noexcept { session_->setOwnerAlive(alive); }
  void requestEmergencyStop() noexcept { session_->requestEmergencyStop(); }
  [[nodiscard]] bool running() const { return session_->running(); }
  [[nodiscard]] TickSummary summary() const { return statistics_.snapshot(); }
  /// What the loop or the recorder's thread had no room for.
  [[nodiscard]] std::uint64_t droppedRecords() const {
    return session_->droppedRecords() + hub_->unrecorded();
  }
  /// Of the recording's file, as far as it is written; asks no disk.
  [[nodiscard]] std::uint64_t recordedBytes() const { return writer_ ? writer_->bytes() : 0; }

  /// Waits for the end, closes recording and device. Idempotent.
  void finish();
  /// What came of it. Valid after finish().
  [[nodiscard]] RunOutcome outcome() const;
  [[nodiscard]] const SetupReport& setup() const { return setup_; }
  [[nodiscard]] const Rig& rig() const { return *rig_; }

 private:
  LiveSession() = default;

  /// Shows the players what happens, in the thread that ticks.
  class Watcher final : public TickListener {
   public:
    explicit Watcher(SteeredPlayer& player) : player_(player) {}
    void beforeTick(const TickRecord& record) noexcept override;
    void afterTick(const TickRecord& record) noexcept override;

   private:
    SteeredPlayer& player_;
  };

  std::unique_ptr<Rig> rig_;
  std::unique_ptr<Watcher> watcher_;
  std::unique_ptr<RecordingWriter> writer_;
  std::string record_;                   ///< its file
  std::unique_ptr<BlackBox> black_box_;  ///< outlives the session
  TickStatistics statistics_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<TelemetryHub> hub_;
  SetupReport setup_;
  std::string black_box_said_;
  bool finished_ = false;
};

}  // namespace wholehand
