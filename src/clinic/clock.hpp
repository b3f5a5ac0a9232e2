#pragma once

#include <cstdint>

namespace wholehand::clinic {

inline constexpr std::int64_t kSecond_us = 1'000'000, kDay_us = 86'400 * kSecond_us;

/// The time of day, which may be set back, and a clock that only goes on. Any thread.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual std::int64_t now_us() const = 0;     ///< UTC since 1970
  [[nodiscard]] virtual std::int64_t steady_us() const = 0;  ///< since any moment
  /// Local time minus UTC at a moment [min].
  [[nodiscard]] virtual int offset_min(std::int64_t at_us) const = 0;
};

/// The system's clocks.
class SystemClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_us() const override;
  [[nodiscard]] std::int64_t steady_us() const override;
  [[nodiscard]] int offset_min(std::int64_t at_us) const override;
};

}  // namespace wholehand::clinic
