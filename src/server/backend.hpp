#pragma once

#include "core/axis_array.hpp"
#include "core/command.hpp"
#include "core/tick_record.hpp"
#include "model/device_model.hpp"
#include "model/exercise_panel.hpp"
#include "model/hand_model.hpp"
#include "model/scene_model.hpp"
#include "server/refusal.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Where the loop is in its life, as clients see it (protocol RunState, in its order:
/// kRampingDown is its Stopping).
enum class RunState : std::int8_t { kDisarmed, kRendering, kRampingDown, kStopped, kFaulted };

/// How much a page does for the player, in the order of the schema. kUnsaid: the player chooses.
enum class Help : std::uint8_t { kUnsaid, kFull, kSome, kNone };

enum class LiveParameterGroup : std::int8_t { kPatient, kHand, kExercise };

/// A live parameter as clients see it.
struct PublishedParameter {
  std::string name;
  LiveParameterGroup group = LiveParameterGroup::kExercise;
  std::string unit;
  double lower = 0.0, upper = 0.0, initial = 0.0, rate_per_s = 0.0;
};

/// All that a client needs to draw and name what WorldState says. Immutable once published; a new
/// one with every arming and loading.
struct SceneFacts {
  std::uint32_t session = 0;  ///< that the next states belong to; 0: none yet
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
  std::string profile;                        ///< whose values hold; empty: nobody's
  std::string recording;                      ///< name of the file being written; empty: none
};

/// Why a host let go of its device, in the order of the schema and of device/host.
enum class LetGo : std::uint8_t {
  kNot,
  kLoopSilent,
  kSilentAtNeutral,
  kBadCommand,
  kLoopEnded,
  kHostEnds,
  kNeverCommanded
};

/// What a real device says of itself.
struct DeviceStatus {
  bool enabled = false, homed = false, silenced = false;
  /// Highest of all axes; NaN: not known.
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  double sample_age_s = -1.0;  ///< below 0: no sample yet
  bool hosted = false;         ///< in a process of its own
  double host_age_s = -1.0;    ///< since its last cycle; below 0: none yet
  LetGo let_go = LetGo::kNot;
};

/// What is true of the loop beside its newest record.
struct LoopStatus {
  std::uint32_t session = 0;
  /// Counts stops, emergency stops, faults and ends of sessions, from 1. A load that goes on with
  /// what rendered is none.
  std::uint32_t endings = 1;
  RunState run_state = RunState::kDisarmed;
  Steering steering = Steering::kVirtualPatient;
  Fault latched = Fault::kNone;
  SafetyState safety_state = SafetyState::kDisarmed;  ///< of the supervisor
  int fault_axis = -1;       ///< that a limit was exceeded on, of what stopped the run; -1: none
  double fault_value = 0.0;  ///< what exceeded it, in the axis's unit (of speed, where that was it)
  double fault_limit = 0.0;  ///< 0: none is known
  std::array<std::uint64_t, kFaultBits> fault_ticks{};  ///< of the session, by reason
  double rehearsal_p50_us = 0.0, rehearsal_p999_us = 0.0, rehearsal_max_us = 0.0;  ///< 0: none
  std::uint64_t ticks = 0, missed_deadlines = 0, dropped_records = 0;
  double cpu_p50_us = 0.0, cpu_p99_us = 0.0, cpu_p999_us = 0.0, cpu_max_us = 0.0;
  std::uint64_t recording_bytes = 0;
  std::optional<DeviceStatus> device;  ///< none: simulated
  bool rested = false;                 ///< what ended last is a rest that a player asked for
  Help help = Help::kUnsaid;           ///< as the therapist has set it
  std::vector<double> parameters;      ///< present values, in the order of SceneFacts::parameters
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
  kOwnerAlive,  ///< value 1 or 0: the game that holds the controls is alive, or went silent
  kLeftAlone,   ///< nobody has held the controls for long: what a client armed is to stop
  kSaveProfile,
  kLoadProfile,
  kSetHelp,
  kAnswer,     ///< to a question of a commissioning
  kHoldToMove  ///< the key of a commissioning is held, or let go
};

/// What a client that may command asks for, already verified in form (finite, known enums); the
/// backend checks ranges and names.
struct Order {
  OrderType type = OrderType::kStop;
  std::string name;    ///< parameter, exercise, profile; kAnswer: the answer
  std::string hand;    ///< kLoadExercise; empty: as it is
  int level = 0;       ///< kLoadExercise; 0: as it is
  double value = 0.0;  ///< kSetParameter, kOwnerAlive
  AxisPosition aim;    ///< kAim
  Steering steering = Steering::kVirtualPatient;
  ExerciseAction action = ExerciseAction::kNext;
  Help help = Help::kUnsaid;       ///< kSetHelp
  std::uint32_t number = 0;        ///< kAnswer: of the question; kHoldToMove: of the press
  bool held = false;               ///< kHoldToMove
  bool rest = false;               ///< kStop: a player rests, and may end that again
  std::uint32_t endings_seen = 0;  ///< kArm: LoopStatus::endings as shown; 0: not said
  /// Whose holding of the controls it belongs to (ControlsArbiter::claim): two servers ask side by
  /// side, and what an earlier holder asked for, or its vanishing, may come after what a later one
  /// did. 0: nobody's.
  std::uint32_t claim = 0;
};

/// One recording.
struct RecordingEntry {
  std::string name;  ///< file name without folder
  std::string title;
  std::string created_utc;
  double duration_s = 0.0;
  std::uint64_t bytes = 0;
  std::uint64_t ticks_missing = 0;  ///< for which the disk had no room
  bool being_written = false;       ///< by this program: it can be replayed as far as it goes
};

/// What the server asks of the program. All of it may be called from the server's thread, and none
/// of it waits for the loop: orders that take time (arm, load) answer through `done`, from any
/// thread, exactly once.
class ServerBackend {
 public:
  virtual ~ServerBackend() = default;

  virtual void order(const Order& order, std::function<void(OrderReply)> done) = 0;
  [[nodiscard]] virtual std::shared_ptr<const SceneFacts> scene() const = 0;
  [[nodiscard]] virtual LoopStatus status() const = 0;
  /// The newest record; false where there is none yet.
  [[nodiscard]] virtual bool latest(TickRecord& record) const = 0;
  [[nodiscard]] virtual std::vector<RecordingEntry> recordings() const = 0;
  /// Full path of a recording of that name; empty where there is none. Names with a slash, "..", or
  /// that are not in recordings() have none.
  [[nodiscard]] virtual std::string recordingPath(const std::string& name) const = 0;
  /// Folder of its report page, made where it is missing (may take seconds); empty and a reason
  /// where it cannot be made.
  [[nodiscard]] virtual std::string reportFolder(const std::string& name, std::string& why) = 0;
};

}  // namespace wholehand
