#pragma once

namespace wholehand::bullet_paper {

// Collision groups for Bullet's broad phase. The hand does not collide with itself, and fixed
// bodies do not collide with each other. For a soft body, the digits collide with the core and all
// other bodies with the surface.
inline constexpr int kPalm = 1, kDigit = 2, kFree = 4, kFixed = 8, kSurface = 16, kCore = 32;

[[nodiscard]] constexpr int meets(int group) {
  switch (group) {
    case kPalm:
      return kFree | kFixed | kSurface;
    case kDigit:
      return kFree | kFixed | kCore;
    case kFree:
      return kPalm | kDigit | kFree | kFixed | kSurface;
    case kFixed:
      return kPalm | kDigit | kFree;
    case kSurface:
      return kPalm | kFree;
    default:
      return kDigit;
  }
}

}  // namespace wholehand::bullet_paper
