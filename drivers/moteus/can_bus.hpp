#pragma once

#include "loop/core/expected.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>

namespace wholehand::moteus {

/// A CAN-FD frame: 11-bit identifiers up to 0x7ff, 29-bit ones above.
struct CanFrame {
  static constexpr std::size_t kMostBytes = 64;
  std::uint32_t id = 0;
  std::uint8_t size = 0;  ///< number of bytes in data
  std::array<std::uint8_t, kMostBytes> data{};
};

enum class BusResult {
  kDone,
  kNothing,  ///< receive(): no frame has arrived
  kFailed    ///< the adapter is gone or accepts nothing more; permanent
};

/// Carries CAN frames. No function waits.
class CanBus {
 public:
  virtual ~CanBus() = default;
  [[nodiscard]] virtual BusResult send(const CanFrame& frame) noexcept = 0;
  [[nodiscard]] virtual BusResult receive(CanFrame& frame) noexcept = 0;
  /// Number of received lines and frames that were invalid, or that the adapter refused.
  [[nodiscard]] virtual std::uint64_t errors() const noexcept = 0;
};

/// Opens `fdcanusb:/dev/ttyACM0`, `slcan:/dev/ttyACM0` or `socketcan:can0`. Refused, each by name:
/// another kind, a port that cannot be opened, a kernel without CAN. May wait; allocates.
[[nodiscard]] Expected<std::unique_ptr<CanBus>> openCanBus(const std::string& locator);

/// Smallest size of a CAN-FD frame for a number of bytes: 0 to 8, 12, 16, 20, 24, 32, 48, 64.
[[nodiscard]] std::size_t frameBytes(std::size_t bytes) noexcept;

/// Padding byte of moteus (NOP).
inline constexpr std::uint8_t kPadding = 0x50;

}  // namespace wholehand::moteus
