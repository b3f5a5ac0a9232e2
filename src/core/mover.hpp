#pragma once

#include <cstdint>

namespace wholehand {

/// Who moves the device in a tick.
enum class Mover : std::int32_t {
  kNobody,          ///< a simulated hand that rests
  kPerson,          ///< in the device, or at the screen of a simulated one
  kVirtualPatient,  ///< the program plays
  kMotion           ///< a recorded motion is replayed
};
inline constexpr int kMovers = 4;

/// How much of the hand's motion a page does for the player, by its own word.
enum class Help : std::int32_t { kUnsaid, kFull, kSome, kNone };
inline constexpr int kHelps = 4;

}  // namespace wholehand
