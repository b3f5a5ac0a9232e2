#pragma once

#include <cstdint>

namespace wholehand {

/// Why the host of a device ramped its effort to neutral by itself. Same order as protocol LetGo.
enum class ReleaseReason : std::uint32_t {
  kNone = 0,             ///< the loop is alive, or ended at neutral
  kLoopSilent = 1,       ///< no new command for 20 ms
  kSilentAtNeutral = 2,  ///< no new command for 20 ms, at the neutral effort
  kBadCommand = 3,       ///< not finite, or another number of axes
  kLoopEnded = 4,        ///< the loop disabled the device before it was at neutral
  kHostEnds = 5,         ///< the host was asked to end
  kNeverCommanded = 6    ///< enabled, and no command came
};

}  // namespace wholehand
