#include "loop/psychometrics/comparison_block.hpp"

#include <numbers>

namespace wholehand {

ComparisonBlock::ComparisonBlock(const LevelScale& scale, int answers, int most, std::uint64_t seed,
                                 int least) noexcept
    : scale_(scale),
      up_down_(scale.nearest(kStart), most, least),
      wanted_(std::clamp(answers, 0, kMostAnswers)),
      most_(most),
      state_(seed) {
  prepare();
}

void ComparisonBlock::answer(bool said_second) noexcept {
  Comparison& now = answers_[answered_];
  now.said_second = said_second;
  if (!now.is_catch) up_down_.answer(now.right());
  ++answered_;
  prepare();
}

std::uint64_t ComparisonBlock::draw() noexcept {
  const std::uint64_t drawn = splitMix64(state_);
  state_ += 0x9E37'79B9'7F4A'7C15ULL;
  return drawn;
}

/// In (0, 1).
double ComparisonBlock::uniform() noexcept {
  return (static_cast<double>(draw() >> 11) + 0.5) * 0x1p-53;
}

void ComparisonBlock::prepare() noexcept {
  if (over()) return;
  // The first of ten is no catch: a person begins with a difference like all others.
  if (answered_ % kCatchAmong == 0) catch_at_ = 1 + static_cast<int>(draw() % (kCatchAmong - 1));
  Comparison& next = answers_[answered_];
  next.is_catch = answered_ % kCatchAmong == catch_at_;
  level_ = next.is_catch ? most_ : up_down_.level();
  next.x = draw() % 2 == 0 ? scale_.at(level_) : -scale_.at(level_);
  // Normal, by Box and Muller.
  const double radius = std::sqrt(-2.0 * std::log(uniform()));
  next.other = radius * std::cos(2.0 * std::numbers::pi * uniform());
}

}  // namespace wholehand
