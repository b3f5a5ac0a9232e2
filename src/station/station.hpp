#pragma once

#include "assembly/models.hpp"
#include "assembly/rehearsal.hpp"
#include "assembly/rig.hpp"
#include "assembly/run.hpp"
#include "assembly/safety_log.hpp"
#include "server/backend.hpp"
#include "telemetry/statistics.hpp"

#include <cstdint>
#include <functional>
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
  std::optional<Rehearsal> rehearsal;  ///< of what was armed
  std::string record;                  ///< empty: not recorded
};

/// File of a session where `path` is that of the first: "a.h5", "a-2.h5", "a-3.h5".
[[nodiscard]] std::string pathOfSession(const std::string& path, std::uint64_t number);

/// What a station works with.
struct StationConfig {
  ModelFiles files;  ///< what is loaded first
  RigOptions rig;
  bool rehearse = true;           ///< what is loaded, before its first force
  RehearsalOptions rehearsal;     ///< the station cancels it itself
  std::uint64_t seed = 1;         ///< of the virtual patient; counts up with every arming
  std::string config_folder;      ///< holds exercises/ and hands/, what clients may load
  std::string profiles_folder;    ///< of patients (station/profiles.hpp); empty: none are kept
  std::string recordings_folder;  ///< sessions that a client arms are recorded here; empty: not
  /// File of the first session, whoever arms it; the others' are numbered (pathOfSession). Empty:
  /// recordings_folder.
  std::string record;
  std::string program_version;
  /// Makes the device of each session, which a person holds: nothing plays, nobody at a screen
  /// steers, and nothing is armed at once. Null: a simulated one, whom a virtual patient moves.
  std::function<Expected<std::unique_ptr<HapticDevice>>(const DeviceModel&)> make_device;
  /// What the real device says of itself, for clients. Any thread; null: nothing is told.
  std::function<DeviceStatus()> device_status;
  /// Makes the player of a simulated device where the exercise has none of its own. Required.
  std::function<std::unique_ptr<Player>(const Models&)> make_player;
  /// Makes a report page of a recording, in a process of its own: HDF5 may be writing in this one.
  std::function<Expected<Done>(const std::string& recording, const std::string& folder)>
      make_report;
  /// A line for the person who runs the program. From any thread; may be null.
  std::function<void(const std::string&)> log;
  std::function<void(RunState, const TickSummary&)> status;  ///< told how it goes; may be null
  std::function<void(const EndedSession&)> ended;  ///< told of each, on run()'s thread; may be null
};

/// What came of a station's run.
struct StationOutcome {
  std::uint64_t sessions = 0;
  bool faulted = false;      ///< a session ended by a fault, whichever
  bool interrupted = false;  ///< by Ctrl-C
  std::optional<EndedSession> last;
};

/// Loads, arms, stops and records the loop on behalf of people: the program's main thread runs it,
/// clients ask it for things. Each arming is one session, with a world, an exercise and, where
/// asked for, a recording of its own; what was loaded is rehearsed before it is armed first. A stop
/// fades the exercise's effort out before the ramp to neutral; an emergency stop ramps at once.
/// After either, and after a fault, nothing pushes until somebody arms. An order to arm that is
/// refused leaves everything as it was.
class Station final : public ServerBackend {
 public:
  explicit Station(StationConfig config);
  ~Station() override;
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  /// Loads the first models. Before run(); not thread-safe.
  [[nodiscard]] Expected<Done> load();
  [[nodiscard]] const Models& models() const;

  /// Sees every record, on the telemetry thread. Before run().
  void addSink(std::function<void(const TickRecord&)> sink);

  /// Serves orders on the calling thread until Ctrl-C, quit(), or the end of the time.
  /// @param arm_at_once the first session begins without an order
  /// @param duration_s of the first session, after which the station ends; 0: endless
  [[nodiscard]] Expected<StationOutcome> run(bool arm_at_once, double duration_s);
  /// Lets run() stop gently and end. Any thread.
  void quit();

  // ServerBackend: any thread.
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
