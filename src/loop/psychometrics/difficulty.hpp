#pragma once

#include <array>

namespace wholehand {

/// Difficulty that adapts to a person (weighted up-down, as UpDown): d in [0, 1] rises by Δ (1 −
/// p*) after a success and falls by Δ p* after a failure, within the therapist's bounds, so that it
/// settles where the share of successes is p*. Pure; not part of the tick.
struct DifficultyRules {
  double aim = 0.7;  ///< p*
  double step = 0.06;
  double lower = 0.0, upper = 1.0;  ///< bounds of d
};

[[nodiscard]] double nextDifficulty(double d, bool success, const DifficultyRules& rules) noexcept;

/// What stands against the bounds.
enum class BoundsFinding {
  kFit,
  kTooEasy,  ///< at the upper bound the person succeeds too often
  kTooHard   ///< at the lower bound the person fails too often
};

/// Difficulty of a person, with the last trials that a card shows.
class AdaptiveDifficulty {
 public:
  static constexpr int kShown = 20;

  AdaptiveDifficulty(const DifficultyRules& rules, double start) noexcept;

  /// After one movement.
  void answer(bool success) noexcept;
  /// What a therapist sets wins; the trials before it count no more.
  void set(double d) noexcept;

  [[nodiscard]] double value() const noexcept { return d_; }
  /// Number of trials since set(), at most kShown, and successes among them.
  [[nodiscard]] int shown() const noexcept { return shown_; }
  [[nodiscard]] int successes() const noexcept;
  [[nodiscard]] BoundsFinding finding() const noexcept;

 private:
  struct Trial {
    double d = 0.0;
    bool success = false;
  };

  DifficultyRules rules_;
  double d_;
  int shown_ = 0, next_ = 0;
  std::array<Trial, kShown> trials_{};
};

}  // namespace wholehand
