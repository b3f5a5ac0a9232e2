#pragma once

#include "station/station_state.hpp"

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace wholehand {

/// Limit of waiting orders. It bounds how long a client that floods the station can delay others.
inline constexpr std::size_t kMostWaitingOrders = 8;
/// Longest time that an order may wait behind others.
inline constexpr std::chrono::seconds kLongestWait{3};

/// What happens to a station.
namespace events {

struct Asked {
  Order order;  ///< none to bodies (acceptBodies)
};
struct Turn {};        ///< the main thread is free
struct FirstStart {};  ///< run() starts the first session
struct EndDue {        ///< the session has ended by itself, or the program ends
  bool by_itself = false;
};
struct RenewalDue {};  ///< asked regularly; the state says whether it is
struct PersonMoved {};
struct Quit {};
struct Over {};
// What came of the work:
struct ProfileRead {
  OrderReply reply;
  Profile profile;
};
struct ProfileSaved {
  OrderReply reply;
};
struct ScenePublished {};
struct ModelsRead {
  OrderReply reply;
  std::shared_ptr<const SceneFacts> facts;  ///< without profile, visit, session and recording
  Profile loaded;                           ///< the models as a profile, without name and values
  bool other_hand = false;
};
struct Rehearsed {
  OrderReply reply;
};
struct LoopFinished {  ///< the loop is over; its files are closed next
  bool faulted = false, recorded = false;
};
struct SessionEnded {
  bool faulted = false;
  Fault latched = Fault::kNone;
};
struct Prepared {
  OrderReply reply;
};
struct Begun {
  OrderReply reply;
};
struct FirstTick {
  OrderReply reply;
};
struct UnusedClosed {};
struct WorkFailed {
  std::string why;
};

using Any =
    std::variant<Asked, Turn, FirstStart, EndDue, RenewalDue, PersonMoved, Quit, Over, ProfileRead,
                 ProfileSaved, ScenePublished, ModelsRead, Rehearsed, LoopFinished, SessionEnded,
                 Prepared, Begun, FirstTick, UnusedClosed, WorkFailed>;

}  // namespace events

/// What is done at once, in this order, before anybody else decides. Nothing here waits.
namespace effects {

struct Reply {
  std::uint64_t asked = 0;  ///< number of the order
  OrderReply reply;
};
/// Hands a command to the loop, and answers the order by whether it fits the loop's queue.
struct Command {
  std::uint64_t asked = 0;
  wholehand::Command command;
};
struct StopLoop {
  bool at_once = false;
};
struct SetLoopParameter {
  int index = 0;
  double value = 0.0;
};
struct TellHolderAlive {
  bool alive = false;
};
struct SteerLoop {
  Steering by = Steering::kVirtualPatient;
};
/// Voids the permit of a start that has not ticked, unless this client pressed.
struct RaiseLimit {
  std::uint32_t client = 0;
};
struct AdoptRun {};   ///< what was prepared becomes the live session
struct DropRun {};    ///< what was prepared is not used, whether it is live yet or not
struct RetireRun {};  ///< the live session is over
struct UseModels {};  ///< the models read last are in use from now on
struct SessionRuns {};
struct DiscardRecording {};  ///< nobody took part in what it holds
struct Log {
  std::string line;
};

using Any =
    std::variant<Reply, Command, StopLoop, SetLoopParameter, TellHolderAlive, SteerLoop, RaiseLimit,
                 AdoptRun, DropRun, RetireRun, UseModels, SessionRuns, DiscardRecording, Log>;

}  // namespace effects

using Effects = std::vector<effects::Any>;

/// Decides what follows from an event. It changes the state, and returns what is to be done at
/// once. What takes time is StationState::work; its result is a later event and is judged anew:
/// a stop, another person or the loss of a client between them voids it. Reads no clock, file or
/// lock; of a Requester it reads the atomics.
[[nodiscard]] Effects decide(StationState& state, const events::Any& event,
                             std::chrono::steady_clock::time_point now);

/// Refuses orders to bodies that the loop must not get. Accepted orders are kept for the next
/// session if none is live.
[[nodiscard]] OrderReply acceptBodies(StationState& state, const Order& order);

/// Whether an order that waited, or that takes time, may still take effect. The client's permission
/// was checked on arrival; this checks that its conditions still hold.
[[nodiscard]] OrderReply mayStillDo(const StationState& state, const WaitingOrder& task,
                                    std::chrono::steady_clock::time_point now);
/// The same for what is under way, with the conditions of a start.
[[nodiscard]] OrderReply mayStillStart(const StationState& state,
                                       std::chrono::steady_clock::time_point now);

/// Sets the fields of the status that follow from the state alone.
void describe(const StationState& state, std::chrono::steady_clock::time_point now,
              LoopStatus& status);

/// Value of each published parameter for the person at the device.
[[nodiscard]] std::vector<double> parameterValues(const StationState& state);

}  // namespace wholehand
