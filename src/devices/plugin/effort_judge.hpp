#pragma once

#include <array>
#include <cstdint>

namespace wholehand {

/// Least value of a signal that is held between changes, over a moving window. Keeps only the
/// values that can still become the least. When it is full, it keeps the last one longer instead of
/// a new one, so that the least is never too large.
class RecentLeast {
 public:
  static constexpr int kCapacity = 64;

  void clear() noexcept { count_ = 0; }
  /// Adds a value that was held until then.
  void add(double value, std::int64_t until_ns) noexcept;
  /// Returns the least of `held_now` and the values held at or after `since_ns`; forgets the
  /// others.
  [[nodiscard]] double since(std::int64_t since_ns, double held_now) noexcept;

 private:
  struct HeldValue {
    double value;
    std::int64_t until_ns;
  };
  HeldValue& at(int i) noexcept {
    return held_[static_cast<std::size_t>((first_ + i) % kCapacity)];
  }

  std::array<HeldValue, kCapacity> held_{};  ///< a ring; values and times rise
  int first_ = 0, count_ = 0;
};

/// Allowed difference of a measured effort from the efforts that may cause it.
struct EffortTolerance {
  double effort = 0.0;  ///< [N or N·m]
  double share = 0.0;   ///< of the effort sent: the gain of the drive
};

/// Judges the measured effort of one axis against the efforts that were sent.
///
/// A drive delays an effort u by d and follows it with a time constant τ and a gain g:
///   y(t) = g ∫ e^(-s/τ) / τ u(t - d - s) ds,  s = 0 .. ∞.
/// The weights are positive and their sum is 1, of which s > 5 τ has e^-5. So y lies between g
/// times the least and g times the largest effort sent in [t - d - 5 τ, t], but for e^-5 of the
/// span of the efforts, 2 effort limits. That holds for every smaller d and τ, too. An effort is
/// astray when three of the last seven samples were beyond this hull by more than the tolerance:
/// three in a row, or every third one, as of an oscillation at a third of the sample rate. Two bad
/// samples are not.
///
/// Fixed size; real-time safe.
class EffortJudge {
 public:
  /// Begins with an effort that is held from now on. `before` was held until now.
  void begin(double before, double effort, std::int64_t now_ns,
             const EffortTolerance& tolerance) noexcept;
  /// Another effort is held from now on.
  void send(double effort, std::int64_t now_ns) noexcept;
  /// Returns true if a measured effort is within the hull. NaN, an unknown effort, is.
  /// @param since_ns beginning of the window: time of the sample minus delay minus 5 time constants
  /// @param may_be_less the drive may give less than was sent (never more, nor the other way)
  [[nodiscard]] bool allows(double measured, std::int64_t since_ns, bool may_be_less) noexcept;
  /// Judges a new sample; returns true if the measured effort is astray.
  [[nodiscard]] bool isAstray(double measured, std::int64_t since_ns, bool may_be_less) noexcept;

 private:
  EffortTolerance tolerance_;
  double effort_ = 0.0;  ///< held now
  RecentLeast least_, least_of_negative_;
  unsigned beyond_ = 0;  ///< a bit for each of the last samples, the newest first
};

}  // namespace wholehand
