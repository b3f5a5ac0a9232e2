#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/body_order.hpp"
#include "loop/core/command.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/exercise_panel.hpp"
#include "loop/model/game_shapes.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"
#include "schema_enums.hpp"
#include "vocabulary/operator.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace wholehand {

/// A refused item of an order to bodies.
struct RefusedItem {
  int item = 0;   ///< index in the message
  int slot = -1;  ///< slot of the item; -1: the item has none
  BodyRefusal refusal = BodyRefusal::kNone;
  std::string reason;  ///< for people, in English
};

struct OrderReply {
  bool accepted = false;
  std::string reason;  ///< for people, in English; empty when accepted and carried out
  Refusal refusal = accepted ? Refusal::kNone : Refusal::kOther;
  std::vector<RefusedItem> items = {};  ///< the refused items; filled for kBodiesRefused
};

inline OrderReply refused(Refusal refusal, std::string reason) {
  return {false, std::move(reason), refusal, {}};
}

// Bodies of a game: the orders of clients and the reports to clients
// (docs/adr/0043-bodies-of-a-game.md). SI units; positions are those of the centre of mass.

/// Largest number of items in one message: one for each slot.
inline constexpr int kMostBodyItems = kMaxSlots;
/// Largest generation. The value of an event is a float, which holds it exactly.
inline constexpr int kMostGeneration = (1 << 24) - 1;

/// The body orders of one message. The counts are checked; the numbers are not checked yet.
struct BodyOrders {
  int shape_set = -1;             ///< shape set that `pieces` define; -1: the message has no shapes
  std::vector<Shape> pieces;      ///< as sent by the game
  std::vector<Command> commands;  ///< one per item, in the order of the message
  std::vector<RefusedItem> faults;  ///< items refused while the message was read
};

/// A live parameter as clients see it.
struct PublishedParameter {
  std::string name;
  ParameterGroup group = ParameterGroup::kExercise;
  std::string unit;
  double lower = 0.0, upper = 0.0, initial = 0.0, rate_per_s = 0.0;
  bool bounds_effort = false;
};

/// A visit in the clinic's records, and the item of its plan.
struct Visit {
  std::uint64_t number = 0;  ///< 0: none is open
  std::uint32_t item = 0;
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
  Visit visit;                                ///< the open visit
};

/// Status that a real device reports.
struct DeviceStatus {
  bool enabled = false, homed = false, silenced = false;
  /// Highest temperature of all axes; NaN: unknown.
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  double sample_age_s = -1.0;  ///< below 0: no sample yet
  bool hosted = false;         ///< the driver runs in its own process, the host
  double host_age_s = -1.0;    ///< time since the host's last cycle; below 0: none yet
  ReleaseReason let_go = ReleaseReason::kNone;
  bool overdue = false;  ///< a call of the driver lasts longer than it may
};

/// State of the loop that its newest record does not hold.
struct LoopStatus {
  std::uint32_t session = 0;
  /// Number of stops, emergency stops, faults and session ends, from 1. Loading an exercise while
  /// rendering continues does not count.
  std::uint32_t endings = 1;
  /// Number of what a start is based on (station/basis.hpp), from 1. It belongs to `parameters`,
  /// and to a scene that was read after this status or to an older one.
  std::uint32_t basis = 1;
  RunState run_state = RunState::kDisarmed;
  Steering steering = Steering::kVirtualPatient;
  Fault latched = Fault::kNone;
  SafetyState safety_state = SafetyState::kDisarmed;  ///< state of the supervisor
  int fault_axis = -1;       ///< axis of the limit violation that stopped the run; -1: none
  double fault_value = 0.0;  ///< value that exceeded the limit, in the axis's unit (per second for
                             ///< a speed)
  double fault_limit = 0.0;  ///< limit that was exceeded; 0: unknown
  /// Ticks of this session with each fault bit.
  std::array<std::uint64_t, kFaultBits> fault_ticks{};
  /// Durations of the rehearsal's ticks; 0: no rehearsal.
  double rehearsal_p50_us = 0.0, rehearsal_p999_us = 0.0, rehearsal_max_us = 0.0;
  std::uint64_t ticks = 0, missed_deadlines = 0, dropped_records = 0;
  std::uint32_t rehearsed_ticks = 0;  ///< ticks done by a rehearsal under way; 0: none under way
  double cpu_p50_us = 0.0, cpu_p99_us = 0.0, cpu_p999_us = 0.0, cpu_max_us = 0.0;
  double work_j = 0.0;  ///< TickSummary::work_j of this session
  std::uint64_t recording_bytes = 0;
  std::optional<DeviceStatus> device;  ///< empty: the device is simulated
  double loop_age_s = -1.0;  ///< since the loop's newest tick; below 0: no loop ticks in real time
  /// The loop or the device has not answered for too long, or has not obeyed a stop in time. The
  /// device may hold its last effort.
  bool silent = false;
  bool stop_pending = false;  ///< a stop was asked for, and the loop has not reported that it obeys
  bool stop_unconfirmed = false;  ///< the same for longer than a stop may take to be obeyed
  bool arming = false;            ///< an order is starting the device and was not cancelled
  bool rested = false;            ///< the last ending is a rest that a player requested
  /// True when that rest came before anything was armed or being armed. It then gives its player no
  /// right to arm that the player did not have before.
  bool rest_before_start = false;
  Help help = Help::kUnspecified;  ///< as set by the therapist; kUnspecified: the player chooses
  std::vector<double> parameters;  ///< current values, in the order of SceneFacts::parameters
  std::vector<double> settings;    ///< what they go to: the values set for the person
  /// Bodies of a game; null: none. Every change makes a new object.
  std::shared_ptr<const GameBodies> bodies;
  /// Registered bodies; null: none. Every change makes a new object.
  std::shared_ptr<const RegisteredBodies> registered;
};

/// What people are told while LoopStatus::silent; null: nothing.
[[nodiscard]] inline const char* alarmOf(const LoopStatus& status) noexcept {
  if (!status.silent) return nullptr;
  return status.device ? "The robot does not answer. Press the emergency stop on the device now."
                       : "The simulation does not answer.";
}

/// State of a client that its waiting orders can look up. Any thread.
struct Requester {
  std::atomic<bool> connected{true};
  std::atomic<std::uint32_t> claim{0};  ///< the client's current claim on the controls; 0: none
  /// Time of its newest message [ns, monotonic]; 0: none yet. An order starts the device only while
  /// its client is heard.
  std::atomic<std::int64_t> heard_ns{0};
};

/// The kinds of orders, each with its own fields; the names are those of the schema. Their form is
/// checked on receipt (finite numbers, known enums). The code that carries an order out checks
/// ranges and names.
namespace orders {

struct Arm {
  std::uint32_t acknowledged_stop = 0;  ///< LoopStatus::endings as the client saw it; 0: unknown
  std::uint32_t basis_seen = 0;         ///< LoopStatus::basis as the client saw it; 0: unknown
};
struct Stop {};
struct EmergencyStop {};
struct LoadExercise {
  std::string exercise, hand;  ///< empty: unchanged
  int level = 0;               ///< 0: unchanged
};
struct SetParameter {
  std::string name;
  double value = 0.0;
  std::uint32_t basis_seen = 0;  ///< LoopStatus::basis as the client saw it; 0: unknown
};
struct Aim {
  AxisPosition q;
  Help by = Help::kUnspecified;
};
struct Steer {
  Steering by = Steering::kVirtualPatient;
};
struct Action {
  Act act = Act::kNext;
  std::uint32_t basis_seen = 0;   ///< as in Arm; a pause needs none
  Choice chosen = Choice::kNone;  ///< answer in an exercise that compares
  bool by_therapist = false;      ///< the server says so, never the client
};
struct TakeControls {
  std::string token;
};
struct ReleaseControls {};
struct Heartbeat {
  bool busy = false;  ///< the page draws and does not answer, says another of its threads
};
struct Rest {};  ///< a pause requested by the player, who may also end it; cancels an arming
struct SaveProfile {
  std::string name;
};
struct LoadProfile {
  std::string name;
};
struct SetHelp {
  Help help = Help::kUnspecified;
};
struct Answer {
  std::uint32_t question = 0;
  std::string text;
};
struct HoldToMove {
  std::uint32_t press = 0;
  bool held = false;
};
/// Opens a visit and says what it renders. Only the clinic's records give this order.
struct OpenVisit {
  std::uint64_t visit = 0;
  std::uint32_t item = 0;
  std::string exercise, hand;
  std::string hand_file;  ///< file in StationConfig::visit_hands_folder; used when `hand` is empty
  int level = 1;
  Help help = Help::kUnspecified;
  std::map<std::string, double> parameters;  ///< by name, in their own units
  std::string prescription_file;  ///< file in the same folder; empty: the person has no limits
};
struct CloseVisit {
  std::uint64_t visit = 0;
};
/// Orders of a game to its bodies.
struct OfBodies {
  std::shared_ptr<const BodyOrders> bodies;  ///< never null in an order
};
struct PrepareShapes : OfBodies {};
struct Spawn : OfBodies {};
struct Remove : OfBodies {};
struct Teleport : OfBodies {};
struct SetOwner : OfBodies {};
struct BodyTargets : OfBodies {};
// Orders that the program itself gives.
struct HolderAlive {
  bool alive = false;  ///< the game that holds the controls is alive; false: it is silent
};
/// Nobody has held the controls or given an order for a long time. A loop that a client armed
/// stops; another loop that a client has joined restarts from the beginning.
struct Unattended {};
struct UnattendedEnds {};  ///< a client has taken the controls

using Any =
    std::variant<Arm, Stop, EmergencyStop, LoadExercise, SetParameter, Aim, Steer, Action,
                 TakeControls, ReleaseControls, Heartbeat, Rest, SaveProfile, LoadProfile, SetHelp,
                 Answer, HoldToMove, PrepareShapes, Spawn, Remove, Teleport, SetOwner, BodyTargets,
                 OpenVisit, CloseVisit, HolderAlive, Unattended, UnattendedEnds>;

/// Index of a kind in Any.
template <class Kind, class... Kinds>
constexpr std::size_t indexIn(std::type_identity<std::variant<Kinds...>>) {
  std::size_t index = 0;
  (void)((std::is_same_v<Kind, Kinds> || (++index, false)) || ...);
  return index;
}
template <class Kind>
inline constexpr std::size_t kIndexOf = indexIn<Kind>(std::type_identity<Any>{});

/// The clients that may give an order; mayOrder() decides by it.
enum class Permission : std::uint8_t {
  kAnyone,
  kNotWatchers,
  kHolder,            ///< the client that holds the controls
  kHolderOrLeader,    ///< the holder of the controls, or a therapist; no player while a therapist
                      ///< pauses
  kBeginner,          ///< the same as kHolderOrLeader; a player only where players may begin
  kTherapist,         ///< a therapist; a client without a role needs the controls
  kHoldingTherapist,  ///< a therapist who holds the controls
  kProgram            ///< no client
};

/// Thread that carries an order out.
enum class Thread : std::uint8_t {
  kServer,  ///< the server's thread, which knows who holds the controls
  kCaller,  ///< the calling thread, at once
  kMain,    ///< the station's main thread, in turn: the order takes time
  kLoop,    ///< the loop's thread, as commands
  kConsole  ///< the thread of a commissioning
};

enum class Pace : std::uint8_t {
  kAnswered,  ///< the rate is limited and order numbers must rise
  kStreams,   ///< the same at a high rate; nobody waits for the reply
  kStops      ///< a stop: accepted at any rate and with numbers in any order
};

/// Whether an order may arrive by datagram, which may be lost: the next order supersedes it, or a
/// game repeats it until the state shows its effect.
enum class Datagram : std::uint8_t { kNever, kStandalone, kAlways };

/// Rules for all orders of one kind.
struct Row {
  std::size_t kind;   ///< index in Any
  std::uint8_t wire;  ///< number in the schema's union Order; 0: only the program gives it
  const char* name;   ///< name in the schema
  Permission permission;
  Thread thread;
  Pace pace = Pace::kAnswered;
  Datagram datagram = Datagram::kNever;
  const char* doing = "";  ///< what the order does, as told to a player who is refused because only
                           ///< a therapist may do it
};

inline constexpr auto kTable = [] {
  using enum Permission;
  using enum Thread;
  using enum Pace;
  using enum Datagram;
  constexpr const char* kLeading = "leading a commissioning";
  return std::array<Row, std::variant_size_v<Any>>{{
      {kIndexOf<Arm>, 1, "Arm", kBeginner, kMain, kAnswered, kNever, "starting"},
      {kIndexOf<Stop>, 2, "Stop", kNotWatchers, kCaller, kStops, kAlways},
      {kIndexOf<EmergencyStop>, 3, "EmergencyStop", kAnyone, kCaller, kStops, kAlways},
      {kIndexOf<LoadExercise>, 4, "LoadExercise", kBeginner, kMain, kAnswered, kNever, "loading"},
      {kIndexOf<SetParameter>, 5, "SetParameter", kTherapist, kLoop, kAnswered, kNever,
       "setting a value"},
      {kIndexOf<Aim>, 6, "Aim", kHolder, kLoop, kStreams, kAlways},
      {kIndexOf<Steer>, 7, "Steer", kHolder, kLoop, kAnswered, kStandalone},
      {kIndexOf<Action>, 8, "Action", kHolderOrLeader, kLoop},
      {kIndexOf<TakeControls>, 9, "TakeControls", kNotWatchers, kServer, kAnswered, kStandalone},
      {kIndexOf<ReleaseControls>, 10, "ReleaseControls", kNotWatchers, kServer, kAnswered,
       kStandalone},
      {kIndexOf<Heartbeat>, 11, "Heartbeat", kAnyone, kServer, kStreams, kAlways},
      {kIndexOf<Rest>, 12, "Rest", kNotWatchers, kCaller, kStops, kAlways},
      {kIndexOf<SaveProfile>, 13, "SaveProfile", kTherapist, kMain, kAnswered, kNever, "a profile"},
      {kIndexOf<LoadProfile>, 14, "LoadProfile", kTherapist, kMain, kAnswered, kNever, "a profile"},
      {kIndexOf<SetHelp>, 15, "SetHelp", kTherapist, kCaller, kAnswered, kNever, "setting a value"},
      {kIndexOf<Answer>, 16, "Answer", kHoldingTherapist, kConsole, kAnswered, kNever, kLeading},
      {kIndexOf<HoldToMove>, 17, "HoldToMove", kHoldingTherapist, kConsole, kStreams, kNever,
       kLeading},
      {kIndexOf<PrepareShapes>, 18, "PrepareShapes", kHolder, kLoop},
      {kIndexOf<Spawn>, 19, "Spawn", kHolder, kLoop},
      {kIndexOf<Remove>, 20, "Remove", kHolder, kLoop},
      {kIndexOf<Teleport>, 21, "Teleport", kHolder, kLoop},
      {kIndexOf<SetOwner>, 22, "SetOwner", kHolder, kLoop},
      {kIndexOf<BodyTargets>, 23, "BodyTargets", kHolder, kLoop, kStreams},
      {kIndexOf<OpenVisit>, 24, "OpenVisit", kTherapist, kMain, kAnswered, kNever, "a visit"},
      {kIndexOf<CloseVisit>, 25, "CloseVisit", kTherapist, kMain, kAnswered, kNever, "a visit"},
      {kIndexOf<HolderAlive>, 0, "HolderAlive", kProgram, kCaller},
      {kIndexOf<Unattended>, 0, "Unattended", kProgram, kCaller},
      {kIndexOf<UnattendedEnds>, 0, "Attended", kProgram, kCaller},
  }};
}();
static_assert(std::all_of(kTable.begin(), kTable.end(),
                          [](const Row& row) { return &row == &kTable[row.kind]; }));

}  // namespace orders

struct Order {
  orders::Any what = orders::Heartbeat{};
  /// Command.id of the client's message. A client that repeats a stop until it is answered keeps
  /// the id. 0: not numbered; a client's stop without a number within a second of its last one is a
  /// repetition.
  std::uint32_t id = 0;
  /// Claim on the controls that the order belongs to (ControlHolder::claim). Two servers send
  /// orders independently, so an order or a loss of the controls of an earlier holder may arrive
  /// after an order of a later one. 0: no claim.
  std::uint32_t claim = 0;
  /// The client that gives the order (ControlHolder::Client); 0: the program itself.
  std::uint32_t client = 0;
  /// The client's state while the order waits; null: the program itself gives the order.
  std::shared_ptr<const Requester> requester = nullptr;
  bool may_raise_limits = false;  ///< the client may set values

  template <class Kind>
  [[nodiscard]] bool is() const noexcept {
    return std::holds_alternative<Kind>(what);
  }
  /// The order as this kind; null when it is of another kind.
  template <class Kind>
  [[nodiscard]] const Kind* as() const noexcept {
    return std::get_if<Kind>(&what);
  }
  [[nodiscard]] const orders::Row& row() const noexcept { return orders::kTable[what.index()]; }
  /// A stop of any kind is accepted from every client at any time.
  [[nodiscard]] bool stops() const noexcept { return row().pace == orders::Pace::kStops; }
  [[nodiscard]] bool streams() const noexcept { return row().pace == orders::Pace::kStreams; }
};

/// Refuses an order that reached a thread which does not carry out this kind.
inline OrderReply notHere(const Order& order) {
  return refused(Refusal::kNotHere, std::string(order.row().name) + " is not carried out here");
}

/// Overload set for std::visit.
template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

/// The body orders that an order carries; null when it is of another kind.
[[nodiscard]] inline const BodyOrders* bodiesOf(const Order& order) {
  return std::visit(
      [](const auto& kind) -> const BodyOrders* {
        if constexpr (requires { kind.bodies; }) return kind.bodies.get();
        return nullptr;
      },
      order.what);
}

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

/// Interface of the program to its servers. The server's thread may call every function, and none
/// of them waits for the loop. Slow orders (arm, load) answer through `done`, exactly once, from
/// any thread.
class ServerBackend {
 public:
  virtual ~ServerBackend() = default;

  virtual void order(const Order& order, std::function<void(OrderReply)> done) = 0;
  [[nodiscard]] virtual std::shared_ptr<const SceneFacts> scene() const = 0;
  [[nodiscard]] virtual LoopStatus status() const = 0;
  /// Copies the newest record; false when there is none yet.
  [[nodiscard]] virtual bool latest(TickRecord& record) const = 0;
  [[nodiscard]] virtual std::vector<RecordingEntry> recordings() const = 0;
  /// Full path of the recording; empty when there is none: the name has a slash or "..", or is not
  /// in recordings().
  [[nodiscard]] virtual std::string recordingPath(const std::string& name) const = 0;
  /// Folder of the recording's report page, which is made if missing; this may take seconds. Empty
  /// with a reason in `why` when it cannot be made.
  [[nodiscard]] virtual std::string reportFolder(const std::string& name, std::string& why) = 0;
};

/// State of a device's commissioning as clients see it (message Commissioning of the protocol).
/// Immutable once published; every change publishes a new object.
struct CommissioningFacts {
  struct Finding {
    std::string axis, quantity, unit;
    double lower = 0.0, upper = 0.0;
  };
  struct Step {
    std::string name;
    StepState state = StepState::kWaiting;
    std::vector<Finding> findings;
    std::string problem, remedy;  ///< filled when the state is kFailed
  };

  std::string device, driver, serial, firmware, operator_name;
  std::vector<Step> steps;

  std::uint32_t question = 0;  ///< number of the question, from 1
  QuestionKind asked = QuestionKind::kNothing;
  std::string axis, unit;  ///< axis and unit of the question or of the motion
  double lower = 0.0, upper = 0.0;
  std::string next;  ///< step that follows kNextStep
  std::string note;  ///< why the last answer was refused

  MotionKind motion = MotionKind::kHoming;
  MotionState motion_state = MotionState::kOver;
  double motion_s = 0.0;  ///< 0: unknown

  std::string passport;   ///< file; empty: none yet
  std::string recording;  ///< file; empty: none
  bool daily = false;     ///< a daily check
};

/// Answer to a page that replays a recording.
struct ReplayAnswer {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
};

/// Answers a question ("about", "scene", "states?tick=0&count=1&step=1", "series?...") about the
/// recording at a path. Waits for the disk. Called from several threads at a time; must not throw.
using ReplayService =
    std::function<ReplayAnswer(const std::string& path, const std::string& question)>;

}  // namespace wholehand
