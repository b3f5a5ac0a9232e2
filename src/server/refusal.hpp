#pragma once

#include "core/body_order.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Why an order was refused, for clients to translate. Same order as protocol Refusal; new ones go
/// at the end.
enum class Refusal : std::uint8_t {
  kNone,          ///< accepted
  kOther,         ///< see the reason
  kUnreadable,    ///< not a message, too large, or not one that a client may send
  kOtherVersion,  ///< another schema version
  kReplayed,      ///< command number did not increase
  kTooMany,       ///< rate or queue limit exceeded
  kControlsHeld,  ///< another client holds the controls
  kNotHolder,     ///< this client does not hold the controls
  kWrongToken,
  kNothingArmed,
  kArmedAlready,
  kStillStopping,  ///< still ramping to neutral
  kStopCame,       ///< a stop came during arming
  kUnknownParameter,
  kOutOfRange,
  kNotAPosture,  ///< an aim with other axes, or with NaN
  kUnknownExercise,
  kUnknownHand,
  kCannotLoad,  ///< the reason lists the faults of the file
  kNotStable,   ///< the stability certificate fails
  kRehearsalFailed,
  kCannotStart,      ///< device not ready, or recording cannot be written
  kFailed,           ///< unexpected failure
  kEnding,           ///< the program is ending
  kStopNotSeen,      ///< a stop or fault followed the state that the order to arm was based on
  kTherapistOnly,    ///< a player asked
  kTherapistPaused,  ///< a therapist paused the exercise and must resume it
  kOnlyWatches,      ///< a watcher asked
  kUnknownProfile,
  kOtherProfile,   ///< made for another device or hand
  kNotHere,        ///< commissioning order without a commissioning, or the reverse
  kNotAsked,       ///< answers a question that is not the current one
  kBodiesRefused,  ///< OrderReply::items names what was refused; the rest was handed to the loop
  kBusy,           ///< no room in the loop's queue; nothing of the message was handed over
  kNoBodies,       ///< the scene takes no bodies of a game
  kWaitedTooLong,  ///< the order waited too long behind other orders
  kRefusedBefore   ///< an earlier order of this client, on which this one builds, was refused
};

/// An item of an order to bodies that was refused.
struct RefusedItem {
  int item = 0;   ///< index in the message
  int slot = -1;  ///< -1: an item without one
  OrderRefusal refusal = OrderRefusal::kNone;
  std::string reason;  ///< for people, in English
};

struct OrderReply {
  bool accepted = false;
  std::string reason;  ///< for people, in English; empty when accepted
  Refusal refusal = accepted ? Refusal::kNone : Refusal::kOther;
  std::vector<RefusedItem> items = {};  ///< of kBodiesRefused
};

inline OrderReply refused(Refusal refusal, std::string reason) {
  return {false, std::move(reason), refusal, {}};
}

}  // namespace wholehand
