#pragma once

#include "can_bus.hpp"

#include <array>
#include <cstddef>
#include <string_view>

/// The two text protocols by which USB adapters carry CAN frames over a tty. Pure functions.
namespace wholehand::moteus {

enum class LineSays {
  kFrame,     ///< a frame was received
  kAccepted,  ///< the adapter took what was sent
  kRefused,   ///< it did not
  kOther      ///< nothing that is known
};

/// Longest line that is written or read, with its end.
inline constexpr std::size_t kLongestLine = 192;
using LineBuffer = std::array<char, kLongestLine>;

/// fdcanusb: "can send 8001 01000a\n", answered by "OK"; "rcv 100 2404 E B F".
/// Source: mjbots' documentation of fdcanusb. Padded to the next CAN-FD size.
/// @return bytes of the line, its end included
[[nodiscard]] std::size_t writeFdcanusb(const CanFrame& frame, LineBuffer& line) noexcept;
/// @param line without its end
[[nodiscard]] LineSays readFdcanusb(std::string_view line, CanFrame& frame) noexcept;

/// slcan with the CAN-FD commands of CANable 2.0: "b1238<16 digits>\r", "B000080018...\r", with
/// bit-rate switching. Source: README of normaldotcom/canable2-fw.
[[nodiscard]] std::size_t writeSlcan(const CanFrame& frame, LineBuffer& line) noexcept;
[[nodiscard]] LineSays readSlcan(std::string_view line, CanFrame& frame) noexcept;

/// Splits what a tty gives into lines. A line ends with CR, LF or BEL (which is a line of its own:
/// slcan's refusal); one that is longer than kLongestLine is dropped whole and counted.
class LineSplitter {
 public:
  /// Takes a byte; true when it ends a line that is not empty: line() until the next byte.
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
