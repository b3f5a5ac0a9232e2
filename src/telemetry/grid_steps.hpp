#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

/// Packing of numbers on a grid, since schema 8 (kStepSchema): the stored number is how many steps
/// a number is away from the expected one. A number beside the grid is stored as how far its bits
/// are from the expected ones. Private to telemetry.
namespace wholehand::recording {

// 0, -1, 1, -2 ... becomes 0, 1, 2, 3 ...: small differences have small bytes.
inline std::uint64_t folded(std::uint64_t difference) noexcept {
  return (difference << 1U) ^ (std::uint64_t{0} - (difference >> 63U));
}
inline std::uint64_t unfolded(std::uint64_t number) noexcept {
  return (number >> 1U) ^ (std::uint64_t{0} - (number & 1U));
}

/// The grid about one expected number. Every bit pattern has one code.
class GridSteps {
 public:
  GridSteps(std::uint64_t expected, double step) noexcept : expected_(expected), step_(step) {
    const double at = std::nearbyint(std::bit_cast<double>(expected) / step);
    usable_ = step >= 0x1p-200 && step <= 0x1p200 && std::abs(at) <= 0x1p50;
    if (usable_) at_ = static_cast<std::int64_t>(at);
  }

  [[nodiscard]] std::uint64_t pack(std::uint64_t bits) const noexcept {
    std::uint64_t code = folded(bits - expected_);
    if (!usable_) return code;
    if (std::uint64_t steps = 0; stepsOf(code, steps)) return steps;
    while (code < kStepCodes) code = codeOf(code);
    return code;
  }
  [[nodiscard]] std::uint64_t unpack(std::uint64_t code) const noexcept {
    if (usable_ && code < kStepCodes) {
      code = codeOf(code);
    } else if (usable_) {
      while (stepsOf(code, code)) continue;
    }
    return unfolded(code) + expected_;
  }

 private:
  /// Codes below count steps. The code of a number beside the grid that would be among them is that
  /// of the grid point which has this number of steps: it is free.
  static constexpr std::uint64_t kStepCodes = std::uint64_t{1} << 32U;

  [[nodiscard]] std::uint64_t bitsAt(std::int64_t k) const noexcept {
    return std::bit_cast<std::uint64_t>(static_cast<double>(k) * step_);
  }
  /// Difference of bits, folded, of the grid point with so many steps, folded.
  [[nodiscard]] std::uint64_t codeOf(std::uint64_t steps) const noexcept {
    return folded(bitsAt(at_ + static_cast<std::int64_t>(unfolded(steps))) - expected_);
  }
  /// The inverse of codeOf(). False beside the grid, and too far away.
  bool stepsOf(std::uint64_t code, std::uint64_t& steps) const noexcept {
    const std::uint64_t bits = unfolded(code) + expected_;
    const double k = std::nearbyint(std::bit_cast<double>(bits) / step_);
    const double away = k - static_cast<double>(at_);
    if (!(away >= -0x1p31 && away < 0x1p31)) return false;
    const auto whole = static_cast<std::int64_t>(k);
    if (bitsAt(whole) != bits) return false;
    steps = folded(static_cast<std::uint64_t>(whole - at_));
    return true;
  }

  std::uint64_t expected_;
  double step_;
  bool usable_ = false;
  std::int64_t at_ = 0;  ///< expected number in steps
};

}  // namespace wholehand::recording
