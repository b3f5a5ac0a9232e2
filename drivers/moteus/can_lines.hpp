#pragma once

#include "can_bus.hpp"

#include <array>
#include <cstddef>
#include <string_view>

/// The two text protocols with which USB adapters carry CAN frames over a tty. Pure functions.
namespace wholehand::moteus {

enum class LineMeaning {
  kFrame,     ///< a frame was received
  kAccepted,  ///< the adapter accepted the sent frame
  kRefused,   ///< the adapter refused it
  kOther      ///< unknown
};

/// Longest line that is written or read, including its end.
inline constexpr std::size_t kLongestLine = 192;
using LineBuffer = std::array<char, kLongestLine>;

/// Writes a frame for fdcanusb: "can send 8001 01000a\n", which is answered by "OK"; a received
/// frame is "rcv 100 2404 E B F". Padded to the next CAN-FD size. Source: mjbots' documentation of
/// fdcanusb.
/// @return bytes of the line, including its end
[[nodiscard]] std::size_t writeFdcanusb(const CanFrame& frame, LineBuffer& line) noexcept;
/// @param line without its end
[[nodiscard]] LineMeaning readFdcanusb(std::string_view line, CanFrame& frame) noexcept;

/// Writes a frame for slcan, with the CAN-FD commands of CANable 2.0: "b1238<16 digits>\r",
/// "B000080018...\r", with bit-rate switching. Source: README of normaldotcom/canable2-fw.
[[nodiscard]] std::size_t writeSlcan(const CanFrame& frame, LineBuffer& line) noexcept;
[[nodiscard]] LineMeaning readSlcan(std::string_view line, CanFrame& frame) noexcept;

/// Splits the bytes of a tty into lines. A line ends with CR, LF or BEL (BEL is a line of its own:
/// slcan's refusal). A line longer than kLongestLine is dropped completely and counted.
class LineSplitter {
 public:
  /// Takes a byte. True when it ends a non-empty line, which line() returns until the next byte.
  [[nodiscard]] bool take(char byte) noexcept;
  [[nodiscard]] std::string_view line() const noexcept { return {text_.data(), length_}; }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  LineBuffer text_{};
  std::size_t length_ = 0;
  bool ended_ = false, too_long_ = false;
  std::uint64_t dropped_ = 0;
};

}  // namespace wholehand::moteus
