#pragma once

namespace wholehand::bullet_paper {

// What collides with what, as Bullet's broad phase asks it. The hand never meets itself, fixed
// bodies never meet each other; of a soft body the digits meet the core, all else the surface.
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
