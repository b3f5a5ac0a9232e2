#pragma once

#include "loop/runtime/statistics.hpp"
#include "rig/models.hpp"
#include "rig/rehearsal.hpp"
#include "rig/rig.hpp"
#include "rig/run/run.hpp"
#include "rig/safety_log.hpp"
#include "vocabulary/backend.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// One session of a station, from arming to closed files.
struct EndedSession {
  std::uint64_t number = 0;  ///< 1 for the first
  RunOutcome outcome;
  std::vector<SafetyTransition> transitions;
  std::optional<Rehearsal> rehearsal;  ///< rehearsal of the armed rig
  std::string record;                  ///< recording; empty: none
};

/// Configuration of a station.
struct StationConfig {
  ModelFiles files;  ///< models to load first
  RigOptions rig;
  bool rehearse = true;        ///< rehearse loaded models before their first force
  RehearsalOptions rehearsal;  ///< the station itself sets the cancellation
  std::uint64_t seed = 1;      ///< seed of the virtual patient; each arming adds 1
  std::string config_folder;   ///< holds exercises/ and hands/, which clients may load
  /// Live parameters that replace the files' values while neither a profile nor a visit names them,
  /// for example a clinic's low limits. Names that an exercise does not have are ignored.
  std::map<std::string, double> first_parameters;
  /// Folder of the hand files that visits may name. Empty: there is no clinic, and visits are
  /// refused.
  std::string visit_hands_folder;
  std::string profiles_folder;    ///< patient profiles (station/profiles.hpp); empty: none
  std::string recordings_folder;  ///< recordings of all sessions; empty: none are made
  /// File of the first session, whichever client arms it; later ones are numbered (pathOfSession).
  /// Empty: recordings_folder.
  std::string record;
  /// How long a session that run() armed lasts while nobody takes part in it (Station).
  std::chrono::seconds renew_after{600};
  /// How long a finished level is shown before the virtual patient plays it again.
  std::chrono::milliseconds repeat_after{8000};
  std::string program_version;
  /// Makes each session's real device, which a person holds. There is then no virtual patient, no
  /// steering from a screen and no arming at start. Null: a simulated device that a virtual patient
  /// moves.
  std::function<Expected<std::unique_ptr<HapticDevice>>(const DeviceModel&)> make_device;
  /// Refuse to arm where the machine grants no real-time priority or locked memory. For a device
  /// that moves a person.
  bool real_time_required = false;
  /// Status of the real device, for clients. Any thread; null: none.
  std::function<DeviceStatus()> device_status;
  /// Makes the player of a simulated device when the exercise has none of its own. Required.
  std::function<std::unique_ptr<Player>(const Models&)> make_player;
  /// Clock for the waiting times; null: std::chrono::steady_clock.
  std::function<std::chrono::steady_clock::time_point()> now;
  /// Makes a report page of a recording in a child process: HDF5 may be writing in this one.
  std::function<Expected<Done>(const std::string& recording, const std::string& folder)>
      make_report;
  /// Prints a line for the person who runs the program. Any thread; may be null.
  std::function<void(const std::string&)> log;
  std::function<void(RunState, const TickSummary&)> status;  ///< progress callback; may be null
  std::function<void(const EndedSession&)> ended;  ///< called after each session, on run()'s
                                                   ///< thread; may be null
};

/// Result of a station's run.
struct StationOutcome {
  std::uint64_t sessions = 0;
  bool faulted = false;      ///< a session ended by a fault
  bool interrupted = false;  ///< ended by Ctrl-C
  std::optional<EndedSession> last;
};

/// Loads, arms, stops and records the loop on behalf of people. The program's main thread runs it;
/// clients send it orders. Each arming is one session with its own world, exercise and, on request,
/// recording; a rig is rehearsed before its first arming. A stop fades the exercise's effort out
/// before the ramp to neutral; an emergency stop ramps at once. After either, and after a fault,
/// nothing pushes until somebody arms. A refused order to arm changes nothing.
///
/// Every session is recorded from its first tick, or clients are told that it is not (an empty
/// SceneFacts::recording). A session that run() armed is a demonstration until somebody takes part:
/// takes the controls, steers, or orders anything. A demonstration that nobody joined within
/// renew_after ends, its recording is removed, and the program arms again: an endless recording
/// would write 14 GB a day. The session itself ends, not only its recording, because a recording
/// that begins in the middle cannot be re-simulated. Whether anybody has joined is decided after
/// the last tick. A person who joins while the session ends therefore keeps its recording, and
/// steers the next session from its first tick. A session that somebody joined and left
/// (orders::Unattended) ends in the same way, and its recording stays. A session whose file was
/// named (StationConfig::record) is not renewed.
class Station final : public ServerBackend {
 public:
  explicit Station(StationConfig config);
  ~Station() override;
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  /// Loads the first models. Before run(); not thread-safe.
  [[nodiscard]] Expected<Done> load();
  [[nodiscard]] const Models& models() const;

  /// Adds a receiver of every record, on the telemetry thread. Before run().
  void addSink(std::function<void(const TickRecord&)> sink);

  /// Serves orders on the calling thread until Ctrl-C, quit(), or the end of the duration.
  /// @param arm_at_once the first session begins without an order
  /// @param duration_s duration of the first session [s]; the station ends after it; 0: endless
  [[nodiscard]] Expected<StationOutcome> run(bool arm_at_once, double duration_s);
  /// Makes run() stop gently and return. Any thread.
  void quit();

  // Overrides of ServerBackend; any thread.
  void order(const Order& order, std::function<void(OrderReply)> done) override;
  [[nodiscard]] std::shared_ptr<const SceneFacts> scene() const override;
  [[nodiscard]] LoopStatus status() const override;
  [[nodiscard]] bool latest(TickRecord& record) const override;
  [[nodiscard]] std::vector<RecordingEntry> recordings() const override;
  [[nodiscard]] std::string recordingPath(const std::string& name) const override;
  [[nodiscard]] std::string reportFolder(const std::string& name, std::string& why) override;

 private:
  class Core;
  std::unique_ptr<Core> core_;
};

}  // namespace wholehand
