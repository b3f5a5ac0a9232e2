#pragma once

#include "core/body_order.hpp"

#include <cstdint>

/// Bodies of a game beyond the slots of the loop (docs/adr/0054-reach.md).
namespace wholehand {

inline constexpr int kMostRegistered = 1000;  ///< bodies at once
/// What stands in place of a slot in an order to a registered body.
inline constexpr int kFirstNumber = 1000, kLastNumber = 32767;
[[nodiscard]] constexpr bool isRegistered(int slot) noexcept {
  return slot >= kFirstNumber && slot <= kLastNumber;
}

/// Where a registered body is.
enum class Whereabouts : std::int32_t {
  kOutOfReach,  ///< stands still, with its velocity; the hand cannot come to it in time
  kLeftOut,     ///< the same, but the hand could: nearer bodies have the slots, or all may move
  kInSlot       ///< in the loop, or on its way there
};

/// A registered body, as others see it.
struct RegisteredBody {
  int number = 0;
  int generation = 0;
  int shape_set = 0;
  int slot = -1;  ///< of kInSlot
  Whereabouts whereabouts = Whereabouts::kOutOfReach;
  BodyPose pose;  ///< newest that is known
};

}  // namespace wholehand
