#pragma once

#include "core/axis_array.hpp"
#include "core/command.hpp"
#include "core/tick_record.hpp"
#include "model/device_model.hpp"
#include "model/exercise_panel.hpp"
#include "model/hand/hand_model.hpp"
#include "model/scene/scene_model.hpp"
#include "server/game_orders.hpp"
#include "server/refusal.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// State of the loop as clients see it. Same order as protocol RunState; kRampingDown is its
/// Stopping.
enum class RunState : std::int8_t { kDisarmed, kRendering, kRampingDown, kStopped, kFaulted };

enum class LiveParameterGroup : std::int8_t { kPatient, kHand, kExercise };

/// A live parameter as clients see it.
struct PublishedParameter {
  std::string name;
  LiveParameterGroup group = LiveParameterGroup::kExercise;
  std::string unit;
  double lower = 0.0, upper = 0.0, initial = 0.0, rate_per_s = 0.0;
};

/// Everything that a client needs to draw and label a WorldState. Immutable once published; every
/// arming and loading publishes a new one.
struct SceneFacts {
  std::uint32_t session = 0;  ///< session of the states that follow; 0: none yet
  std::string program_version;
  HandModel hand;
  DeviceModel device;
  SceneModel scene;
  std::string patient_name;
  std::string exercise_name, exercise_json;
  int level = 1, levels = 1;
  double period_s = 1e-3;
  std::vector<std::string> value_names, event_names;
  ExercisePanel panel;
  std::vector<PublishedParameter> parameters;
  std::vector<std::string> exercises, hands;  ///< what LoadExercise accepts
  std::vector<std::string> profiles;          ///< what LoadProfile accepts
  std::string profile;                        ///< profile in force; empty: none
  std::string recording;                      ///< name of the file being written; empty: none
};

/// Why the host process released its device. Same order as in the schema and in device/host.
enum class ReleaseReason : std::uint8_t {
  kNot,
  kLoopSilent,
  kSilentAtNeutral,
  kBadCommand,
  kLoopEnded,
  kHostEnds,
  kNeverCommanded
};

/// Status that a real device reports.
struct DeviceStatus {
  bool enabled = false, homed = false, silenced = false;
  /// highest of all axes; NaN: unknown
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  double sample_age_s = -1.0;  ///< below 0: no sample yet
  bool hosted = false;         ///< runs in its own process
  double host_age_s = -1.0;    ///< time since the host's last cycle; below 0: none yet
  ReleaseReason let_go = ReleaseReason::kNot;
};

/// State of the loop that its newest record does not hold.
struct LoopStatus {
  std::uint32_t session = 0;
  /// Number of stops, emergency stops, faults and session ends, from 1. Loading an exercise while
  /// rendering continues does not count.
  std::uint32_t endings = 1;
  RunState run_state = RunState::kDisarmed;
  Steering steering = Steering::kVirtualPatient;
  Fault latched = Fault::kNone;
  SafetyState safety_state = SafetyState::kDisarmed;  ///< of the supervisor
  int fault_axis = -1;       ///< axis of the limit violation that stopped the run; -1: none
  double fault_value = 0.0;  ///< value that exceeded the limit, in the axis's unit (per second for
                             ///< a speed)
  double fault_limit = 0.0;  ///< limit that was exceeded; 0: unknown
  std::array<std::uint64_t, kFaultBits> fault_ticks{};  ///< of this session, by fault bit
  double rehearsal_p50_us = 0.0, rehearsal_p999_us = 0.0, rehearsal_max_us = 0.0;  ///< 0: none
  std::uint64_t ticks = 0, missed_deadlines = 0, dropped_records = 0;
  std::uint32_t rehearsed_ticks = 0;  ///< of a rehearsal under way; 0: none
  double cpu_p50_us = 0.0, cpu_p99_us = 0.0, cpu_p999_us = 0.0, cpu_max_us = 0.0;
  std::uint64_t recording_bytes = 0;
  std::optional<DeviceStatus> device;  ///< none: simulated
  bool rested = false;                 ///< the last session ended in a rest that a player asked for
  Help help = Help::kUnsaid;           ///< as set by the therapist; kUnsaid: the player chooses
  std::vector<double> parameters;      ///< current values, in the order of SceneFacts::parameters
  std::shared_ptr<const GameBodies> bodies;  ///< of a game; null: none. A change is a new object
  std::shared_ptr<const RegisteredBodies> registered;  ///< likewise
};

enum class OrderType {
  kArm,
  kStop,
  kEmergencyStop,
  kLoadExercise,
  kSetParameter,
  kAim,
  kSteer,
  kAction,
  kOwnerAlive,  ///< value 1: the game that holds the controls is alive; 0: it went silent
  kUnattended,  ///< nobody has held the controls or ordered anything for long; a loop armed by a
                ///< client is to stop, another one that somebody joined is to begin anew
  kAttended,    ///< somebody has taken the controls
  kSaveProfile,
  kLoadProfile,
  kSetHelp,
  kAnswer,         ///< answers a question of a commissioning
  kHoldToMove,     ///< the hold-to-move key of a commissioning is pressed or released
  kPrepareShapes,  ///< a game gives the shapes of bodies
  kOrderBodies     ///< a game spawns, removes, teleports, hands over or moves bodies
};

/// A client, as its orders that wait see it. Any thread.
struct Asker {
  std::atomic<bool> connected{true};
  std::atomic<std::uint32_t> claim{0};  ///< claim on the controls that it has now; 0: none
};

/// An order from a client. Its form is verified (finite numbers, known enums); the backend checks
/// ranges and names.
struct Order {
  OrderType type = OrderType::kStop;
  std::string name;    ///< parameter, exercise, profile; kAnswer: the answer
  std::string hand;    ///< kLoadExercise; empty: unchanged
  int level = 0;       ///< kLoadExercise; 0: unchanged
  double value = 0.0;  ///< kSetParameter, kOwnerAlive
  AxisPosition aim;    ///< kAim
  Steering steering = Steering::kVirtualPatient;
  ExerciseAction action = ExerciseAction::kNext;
  Help help = Help::kUnsaid;  ///< kSetHelp, kAim
  /// kAnswer: number of the question; kHoldToMove: number of the press; else Command.id: a stop
  /// that a client repeats until it is answered keeps it.
  std::uint32_t number = 0;
  bool held = false;               ///< kHoldToMove
  bool rest = false;               ///< kStop: the player rests, and may end the rest again
  std::uint32_t endings_seen = 0;  ///< kArm: LoopStatus::endings as the client saw it; 0: unknown
  std::shared_ptr<const BodyOrders> bodies;  ///< kPrepareShapes, kOrderBodies; never null there
  /// Claim on the controls that the order belongs to (ControlsArbiter::claim). Two servers send
  /// orders independently, so an order or a loss of an earlier holder may arrive after an order of
  /// a later one. 0: no claim.
  std::uint32_t claim = 0;
  std::uint32_t client = 0;  ///< who asks (ControlsArbiter::Client); 0: the program itself
  std::shared_ptr<const Asker> asker;  ///< of an order that waits; null: the program itself
  bool may_raise_limits = false;       ///< who asks may set values
};

/// One recording.
struct RecordingEntry {
  std::string name;  ///< file name without folder
  std::string title;
  std::string profile;  ///< code of the person whose profile was open; empty: none, or not known
  std::string created_utc;
  double duration_s = 0.0;
  std::uint64_t bytes = 0;
  std::uint64_t ticks_missing = 0;  ///< ticks lost because the disk was full
  bool being_written = false;       ///< this program is still writing it; the part on disk can be
                                    ///< replayed
};

/// What the server asks of the program. The server's thread may call every function, and none of
/// them waits for the loop. Slow orders (arm, load) answer through `done`, exactly once, from any
/// thread.
class ServerBackend {
 public:
  virtual ~ServerBackend() = default;

  virtual void order(const Order& order, std::function<void(OrderReply)> done) = 0;
  [[nodiscard]] virtual std::shared_ptr<const SceneFacts> scene() const = 0;
  [[nodiscard]] virtual LoopStatus status() const = 0;
  /// Copies the newest record; false when there is none yet.
  [[nodiscard]] virtual bool latest(TickRecord& record) const = 0;
  [[nodiscard]] virtual std::vector<RecordingEntry> recordings() const = 0;
  /// Full path of the recording; empty when there is none. A name with a slash or "..", or one that
  /// is not in recordings(), has none.
  [[nodiscard]] virtual std::string recordingPath(const std::string& name) const = 0;
  /// Folder of the recording's report page, which is made if missing; this may take seconds. Empty
  /// with a reason in `why` when it cannot be made.
  [[nodiscard]] virtual std::string reportFolder(const std::string& name, std::string& why) = 0;
};

}  // namespace wholehand
