#pragma once

#include <cstddef>
#include <span>

namespace wholehand {

/// A person's own movement along one direction of an axis, without any effort of ours: the value of
/// a try, and of several. Pure; not part of the tick.
struct RangeRules {
  double steady = 0.0;  ///< largest spread of a held end: the middle four fifths of its samples
  double least = 0.0;   ///< a shorter way is no try
  static constexpr double kWindow_s = 0.5;
};
/// Rules for an axis in metres, and in radians.
[[nodiscard]] RangeRules rangeRulesOf(bool translation) noexcept;

enum class TryKind {
  kHeld,
  kNoMovement,  ///< the way is too short
  kJerk,        ///< the end was passed, but nowhere held
  kDrift        ///< no end was held: there it moved nearly as fast as on the way
};

struct RangeTry {
  TryKind kind = TryKind::kNoMovement;
  /// Median of the outermost of the steadiest windows in the outer part of the way; never the peak.
  double value = 0.0;
};

/// Judges one try. @param q positions in time order, from rest on
/// @param direction +1 or -1: towards which end the person moves
[[nodiscard]] RangeTry judgeTry(std::span<const double> q, double period_s, int direction,
                                const RangeRules& rules);

/// The middle one of the held tries; not enough with fewer than two.
struct OwnEnd {
  bool steady = false;
  double value = 0.0;
};
[[nodiscard]] OwnEnd ownEnd(std::span<const RangeTry> tries);

}  // namespace wholehand
