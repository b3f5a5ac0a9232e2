#pragma once

#include "loop/psychometrics/comparison.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace wholehand {

/// A block of comparisons: which one is next, and what was answered. The seed decides the order of
/// the two stimuli, the other differences, and which comparisons are catches: one among each ten,
/// which does not move the level. Real-time safe; a copy goes on alike.
class ComparisonBlock {
 public:
  static constexpr int kMostAnswers = 80;

  /// @param answers number of comparisons, at most kMostAnswers
  /// @param most largest level that may be offered, < scale.count
  /// @param least smallest one, <= most
  ComparisonBlock(const LevelScale& scale, int answers, int most, std::uint64_t seed,
                  int least = 0) noexcept;

  /// True when every comparison is answered.
  [[nodiscard]] bool over() const noexcept { return answered_ == wanted_; }
  /// The comparison under way, without its answer; it stays the same until answer(). @pre !over()
  [[nodiscard]] const Comparison& current() const noexcept { return answers_[answered_]; }
  /// Level of the comparison under way.
  [[nodiscard]] int level() const noexcept { return level_; }
  /// Answers it. @pre !over()
  WHOLEHAND_RT void answer(bool said_second) noexcept;
  /// What was answered, in order.
  [[nodiscard]] std::span<const Comparison> answers() const noexcept {
    return {answers_.data(), static_cast<std::size_t>(answered_)};
  }

 private:
  [[nodiscard]] std::uint64_t draw() noexcept;
  [[nodiscard]] double uniform() noexcept;
  void prepare() noexcept;

  static constexpr int kCatchAmong = 10;
  static constexpr double kStart = 0.5;  ///< x of the first comparison

  LevelScale scale_;
  UpDown up_down_;
  int wanted_, most_;
  std::uint64_t state_;
  int answered_ = 0, level_ = 0, catch_at_ = 0;
  std::array<Comparison, kMostAnswers> answers_{};
};

}  // namespace wholehand
