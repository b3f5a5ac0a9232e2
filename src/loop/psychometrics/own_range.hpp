#pragma once

#include "loop/core/real_time.hpp"

#include <array>
#include <span>

namespace wholehand {

/// A person's own movement along one direction of an axis, without any effort of ours: the value of
/// a try, and of several (ADR 103).
struct RangeRules {
  double steady = 0.0;  ///< largest spread of a held end: the middle four fifths of its samples
  double least = 0.0;   ///< a shorter way is no try
};
/// Rules for an axis in metres, and in radians.
[[nodiscard]] WHOLEHAND_RT RangeRules rangeRulesOf(bool translation) noexcept;

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

/// Measures one try while it happens. Each sample closes a window of the last kWindow ones, of
/// which only median, spread and change are kept. Pure; real-time safe.
class RangeMeter {
 public:
  static constexpr double kSample_s = 0.02;  ///< between two samples
  static constexpr int kWindow = 25;         ///< samples of a window: half a second
  static constexpr int kMostSamples = 750;   ///< later ones are ignored

  /// Begins at rest. @param direction +1 or -1: towards which end the person moves
  WHOLEHAND_RT void begin(const RangeRules& rules, int direction, double q) noexcept;
  WHOLEHAND_RT void add(double q) noexcept;

  /// The try so far.
  [[nodiscard]] WHOLEHAND_RT RangeTry judge() const noexcept;
  /// Time since the outermost median last moved outward by more than a sixteenth of the allowed
  /// spread, after a way that is a try; 0 before. A person who gets no further has finished.
  [[nodiscard]] double sinceAdvance_s() const noexcept { return kSample_s * since_advance_; }

 private:
  struct Window {
    double middle = 0.0, spread = 0.0;
    double change = 0.0;  ///< slow change, by the medians of both halves: a tremor cancels
  };
  [[nodiscard]] Window closeWindow() const noexcept;
  [[nodiscard]] bool isTry() const noexcept { return furthest_ - start_ >= rules_.least; }

  RangeRules rules_;
  int direction_ = 1;
  double start_ = 0.0, furthest_ = 0.0;  ///< along the direction
  double advanced_to_ = 0.0;             ///< outermost median that counts as an advance
  int samples_ = 0, windows_ = 0, since_advance_ = 0;
  std::array<double, kWindow> last_{};  ///< ring of the last samples, along the direction
  std::array<Window, kMostSamples> window_{};
};

/// The middle one of the held tries; not enough with fewer than two.
struct OwnEnd {
  bool steady = false;
  double value = 0.0;
};
[[nodiscard]] WHOLEHAND_RT OwnEnd ownEnd(std::span<const RangeTry> tries) noexcept;
/// Tries that ownEnd() takes at most.
inline constexpr int kMostTries = 8;

}  // namespace wholehand
