#pragma once

#include "station/basis.hpp"
#include "station/person_settings.hpp"
#include "station/stop_history.hpp"
#include "vocabulary/backend.hpp"

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace wholehand {

/// Settings of a station that its decisions depend on.
struct StationRules {
  bool rehearse = true;       ///< models are rehearsed before their first force
  bool robot = false;         ///< a real device, which a person holds; no steering from a screen
  bool clinic = false;        ///< visits are opened here
  bool records = false;       ///< recordings are kept
  bool record_named = false;  ///< the recording's file was named; such a session is not renewed
  std::chrono::seconds renew_after{600};
  std::map<std::string, double> first_parameters;
};

/// An order that waits for the main thread, or that is under way.
struct WaitingOrder {
  Order order;
  std::uint64_t asked = 0;  ///< its number
  std::chrono::steady_clock::time_point asked_at;
  std::uint32_t acknowledged_stop = 0;  ///< LoopStatus::endings that the order is based on
  bool starts = false;                  ///< the order starts the device, or is about to
  bool refused_before = false;  ///< while it waited, an earlier order of its client was refused
  std::chrono::duration<double> waited_s{0.0};  ///< time behind other orders, set at its turn
  Profile profile;                              ///< profile at the time of the order
  std::uint64_t person = 0;                     ///< PersonSettings::person() at that time
};

/// What takes time and is done by the main thread without a lock, one at a time. What came of it is
/// judged again before anything follows from it (decide.hpp).
namespace work {

struct None {};
struct ReadProfile {
  std::string name;
};
struct SaveProfile {
  Profile profile;
};
struct PublishScene {};
/// Reads and checks models; those in use stay.
struct ReadModels {
  std::string exercise, hand;  ///< names; empty: as in use
  std::string hand_file;       ///< file among the visits' hands; used when not empty
  int level = 0;               ///< 0: as in use
  bool first = false;          ///< the station's first models instead
  /// File among the visits' hands; empty: no prescription; nullopt: as in use.
  std::optional<std::string> prescription_file = {};
};
struct Rehearse {
  bool next = false;  ///< the models read last; else those in use
};
/// Waits until the session has ended, and closes its files.
struct EndSession {
  bool goes_on = false;  ///< the rendering continues with another session
};
/// Builds the rig and creates the recording; the device is not enabled.
struct Prepare {
  bool recorded = true;
  bool resumed = false;  ///< the player rested, and begins where the rest began
};
/// Enables the device and starts the loop.
struct Begin {};
/// Waits for the first tick, which judges the permit of the client that pressed.
struct AwaitFirstTick {};
/// Closes what was prepared and is not used.
struct CloseUnused {};

using Any = std::variant<None, ReadProfile, SaveProfile, PublishScene, ReadModels, Rehearse,
                         EndSession, Prepare, Begin, AwaitFirstTick, CloseUnused>;

}  // namespace work

/// What the main thread does at present, across several pieces of work.
struct UnderWay {
  enum class Kind : std::uint8_t { kOrder, kFirstStart, kRenewal, kEnd };
  Kind kind = Kind::kOrder;
  WaitingOrder task;                ///< the order
  WaitingOrder start;               ///< what a start is judged by; the order itself for an arming
  std::uint64_t person_before = 0;  ///< PersonSettings::person() at its turn
  bool had_session = false;         ///< a session was live at its turn
  bool loads = false;               ///< models were read
  bool rendered = false;            ///< the rendering goes on after the load
  bool other_hand = false;
  bool rehearsed = false;                   ///< the models read have passed
  std::optional<Profile> profile;           ///< its values hold after the load
  std::optional<Visit> visit;               ///< visit that is open after the load
  std::shared_ptr<const SceneFacts> facts;  ///< of the models read
  Profile loaded;                           ///< the models read as a profile, without name
  bool for_client = false;                  ///< a client starts the device
  bool recorded = true;
  bool preparing = false;  ///< from Prepare until the session runs: `before` can be restored
  /// State before a start, restored when it fails.
  struct Before {
    RunState run_state = RunState::kDisarmed;
    Steering steering = Steering::kVirtualPatient;
    Fault latched = Fault::kNone;
    std::uint32_t session = 0, endings = 1;
    bool rested = false;
  } before;
  OrderReply reply;  ///< given when what was prepared is closed
};

/// Order number of the start by Station::run() itself; a stop before run() cancels it.
inline constexpr std::uint64_t kFirstStart = 1;

/// What a station's decisions are made of: a value without thread, lock, clock or file.
struct StationState {
  explicit StationState(std::shared_ptr<const StationRules> with)
      : rules(std::move(with)), person(rules->first_parameters) {}

  std::shared_ptr<const StationRules> rules;
  std::shared_ptr<const SceneFacts> scene;  ///< as published
  Profile loaded;       ///< the models in use as a profile, without name and values
  std::string profile;  ///< last profile loaded or saved, while it applies; empty: none
  Visit visit;          ///< the open visit
  PersonSettings person;
  StopHistory stops;
  Basis basis;

  // Orders are numbered as they arrive. A stop that follows an order to arm or to load cancels the
  // start, however far it has got.
  std::uint64_t orders = kFirstStart;
  std::uint32_t claim = 0;  ///< newest claim on the controls
  std::deque<WaitingOrder> waiting;
  std::optional<UnderWay> under_way;
  work::Any work;  ///< what the main thread has to do next
  /// Order under way that starts the device; none once its session is live.
  std::optional<WaitingOrder> starting;
  bool quit = false;
  bool over = false;  ///< no more orders are carried out

  bool live = false;   ///< a session takes commands and stops, from before its device is enabled
  bool began = false;  ///< the live session has ticked, and its start was permitted
  RunState run_state = RunState::kDisarmed;
  Steering steering = Steering::kVirtualPatient;
  Fault latched = Fault::kNone;
  std::uint32_t session = 0;
  bool rehearsed = false;         ///< the models in use have passed
  bool armed_for_client = false;  ///< a client armed; else the program armed by itself
  bool attended = false;          ///< somebody takes part in this session or in the next one
  bool unattended = false;        ///< everybody who took part has left
  bool keep_recording = false;    ///< somebody took part before the session's end was due
  bool renewing = false;          ///< this session ends, and the program arms the next one
  bool holder_alive = true;       ///< latest value; passed to a session that begins
  std::chrono::steady_clock::time_point began_at;  ///< of the live session

  // Inputs that the runner renews before every decision:
  bool interrupted = false;  ///< a signal ends the program
  bool loop_ends = false;    ///< the loop is known to end before the run state says so
};

}  // namespace wholehand
