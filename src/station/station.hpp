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

/// What a station works with.
struct StationConfig {
  ModelFiles files;  ///< what is loaded first
  RigOptions rig;
  bool rehearse = true;           ///< what is loaded, before its first force
  RehearsalOptions rehearsal;     ///< the station cancels it itself
  std::uint64_t seed = 1;         ///< of the virtual patient; counts up with every arming
  std::string config_folder;      ///< holds exercises/ and hands/, what clients may load
  std::string recordings_folder;  ///< sessions that a client arms are recorded here; empty: not
  std::string record;             ///< file of the first session; empty: none
  std::string program_version;
  /// Makes the device of each session, which a person holds: nothing plays, nobody at a screen
  /// steers, and nothing is armed at once. Null: a simulated one, whom a virtual patient moves.
  std::function<Expected<std::unique_ptr<HapticDevice>>(const DeviceModel&)> make_device;
  /// Who plays where the exercise brings nobody. Needed.
  std::function<std::unique_ptr<Player>(const Models&)> make_player;
  /// Makes a report page of a recording, in a process of its own: HDF5 may be writing in this one.
  std::function<Expected<Done>(const std::string& recording, const std::string& folder)>
      make_report;
  /// A line for the person who runs the program. From any thread; may be null.
  std::function<void(const std::string&)> log;
  std::function<void(RunState, const TickSummary&)> status;  ///< told how it goes; may be null
};

/// What came of a station's run.
struct StationOutcome {
  std::uint64_t sessions = 0;
  bool faulted = false;                       ///< the last session ended by a fault
  bool interrupted = false;                   ///< by Ctrl-C
  std::optional<RunOutcome> last;             ///< what came of the last session
  std::vector<SafetyTransition> transitions;  ///< of the last session
  std::optional<Rehearsal> rehearsal;         ///< of what was armed last
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
