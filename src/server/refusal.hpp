#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace wholehand {

/// Why an order was refused, so that a client can say it in its person's language (protocol
/// Refusal, in its order; new ones at the end).
enum class Refusal : std::uint8_t {
  kNone,          ///< accepted
  kOther,         ///< the reason says it
  kUnreadable,    ///< no message, too large, or nothing that a client says
  kOtherVersion,  ///< of the schema
  kReplayed,      ///< its number did not rise
  kTooMany,       ///< more than the program takes at once
  kControlsHeld,  ///< by another client
  kNotHolder,     ///< this client does not hold the controls
  kWrongToken,
  kNothingArmed,
  kArmedAlready,
  kStillStopping,  ///< on the way to neutral
  kStopCame,       ///< while it was being armed
  kUnknownParameter,
  kOutOfRange,
  kNotAPosture,  ///< an aim with other axes, or no numbers
  kUnknownExercise,
  kUnknownHand,
  kCannotLoad,  ///< a file's faults are in the reason
  kNotStable,   ///< the certificate says no
  kRehearsalFailed,
  kCannotStart,      ///< the device is not ready, or a recording cannot be written
  kFailed,           ///< nobody foresaw it
  kEnding,           ///< the program ends
  kStopNotSeen,      ///< something ended since what an order to arm has seen
  kTherapistOnly,    ///< a player asked for it
  kTherapistPaused,  ///< the exercise, and only the therapist lets it go on
  kOnlyWatches,      ///< a watcher asked for it
  kUnknownProfile,
  kOtherProfile,  ///< for another device or hand
  kNotHere,       ///< a device is commissioned here, or none is
  kNotAsked       ///< an answer to another question than the one that is asked
};

struct OrderReply {
  bool accepted = false;
  std::string reason;  ///< for a person, in English; empty when accepted
  Refusal refusal = accepted ? Refusal::kNone : Refusal::kOther;
};

inline OrderReply refused(Refusal refusal, std::string reason) {
  return {false, std::move(reason), refusal};
}

}  // namespace wholehand
