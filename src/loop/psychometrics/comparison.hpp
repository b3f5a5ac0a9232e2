#pragma once

#include "loop/core/real_time.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

/// Comparisons of two stimuli, one after the other, by a person who says which one was more. A
/// difference is x = ln(second / first). Pure functions; the source of each law stands beside it.
namespace wholehand {

/// One answered comparison.
struct Comparison {
  double x = 0.0;  ///< ln(second / first); > 0: the second was more
  /// Difference of what a person may compare instead, second minus first, in standard deviations
  /// of its variation: the end position, for instance; 0: nothing was varied.
  double other = 0.0;
  bool said_second = false;
  bool is_catch = false;  ///< so large a difference that everybody feels it

  [[nodiscard]] bool right() const noexcept { return said_second == (x > 0.0); }
};

/// Who said an answer. kEarlier: it was said before a rest; the recording before it knows.
enum class SaidBy : std::int32_t { kEarlier = -1, kSqueeze, kPlayer, kTherapist };
inline constexpr int kSayers = 3;

/// SplitMix64 (Steele, Lea, Flood 2014): the number that follows a state. Real-time safe.
[[nodiscard]] constexpr std::uint64_t splitMix64(std::uint64_t state) noexcept {
  state += 0x9E37'79B9'7F4A'7C15ULL;
  state = (state ^ state >> 30) * 0xBF58'476D'1CE4'E5B9ULL;
  state = (state ^ state >> 27) * 0x94D0'49BB'1331'11EBULL;
  return state ^ state >> 31;
}

/// The levels of |x| that are offered, geometric from least to most.
struct LevelScale {
  double least = 0.02;
  double most = 1.0986122886681098;  ///< ln 3
  int count = 24;

  [[nodiscard]] WHOLEHAND_RT double at(int level) const noexcept {
    return least * std::pow(most / least, static_cast<double>(level) / (count - 1));
  }
  /// The level nearest to x in ln x. @pre x > 0
  [[nodiscard]] WHOLEHAND_RT int nearest(double x) const noexcept {
    const double at = (count - 1) * std::log(x / least) / std::log(most / least);
    return static_cast<int>(std::lround(std::clamp(at, 0.0, count - 1.0)));
  }
};

/// The weighted up-down method (Kaernbach 1991, Perception & Psychophysics 49, 227): one level down
/// after a right answer, three up after a wrong one. It settles where p · 1 = (1 − p) · 3, at 75 %
/// right. The step that follows an answer is that answer's.
class UpDown {
 public:
  /// @param most, least the levels that may be offered
  UpDown(int start, int most, int least = 0) noexcept
      : level_(std::clamp(start, least, most)), least_(least), most_(most) {}

  /// Level of the next comparison.
  [[nodiscard]] int level() const noexcept { return level_; }
  WHOLEHAND_RT void answer(bool right) noexcept {
    level_ = right ? std::max(level_ - kDown, least_) : std::min(level_ + kUp, most_);
  }

 private:
  static constexpr int kDown = 1, kUp = 3;
  int level_;
  int least_, most_;
};

}  // namespace wholehand
