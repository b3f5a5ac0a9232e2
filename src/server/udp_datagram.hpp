#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

// Datagrams between the program and a game: docs/udp.md. Pure: no socket, no clock.
namespace wholehand::udp {

/// Largest datagram with its header [bytes]; below the MTU of every common network.
inline constexpr std::size_t kLargestDatagram = 1200;
inline constexpr std::size_t kHeaderSize = 48;
inline constexpr std::size_t kLargestPayload = kLargestDatagram - kHeaderSize;
/// "WHUD" as a little-endian number.
inline constexpr std::uint32_t kMagic = 0x44554857;
/// Version of the header and its rules; counts incompatible changes.
inline constexpr std::uint16_t kVersion = 2;
/// Highest state rate that a game may request.
inline constexpr std::uint32_t kHighestRate_hz = 1000;

enum class Kind : std::uint8_t {
  kCommand = 1,  ///< from a game; payload: Message with a Command
  kAlive = 2,    ///< from a game; no payload
  kState = 16,   ///< from the program; payload: Message with a WorldState
  kPresent = 17  ///< from the program; no payload
};

/// The header of every datagram, little-endian, in this order; a checksum follows it.
struct Header {
  // magic u32, version u16
  Kind kind = Kind::kAlive;
  bool holds_controls = false;  ///< from the program: the receiving game holds the controls
  std::uint64_t key = 0;        ///< of the conversation, from the Welcome message or --udp-key
  std::uint32_t sequence = 0;   ///< increases with every datagram of the sender
  /// From a game: requested state rate [Hz], 0 to 1000. From the program: Command.id of the last
  /// emergency stop that it obeyed; a game repeats a stop until its id appears here.
  std::uint32_t rate_or_stop = 0;
  std::int64_t sent_ns = 0;       ///< sender's CLOCK_MONOTONIC
  std::int64_t echo_ns = 0;       ///< sent_ns of the newest datagram of the other side; 0: none
  std::uint32_t echo_age_us = 0;  ///< time since that datagram arrived
};

/// Why a datagram is invalid.
enum class Flaw {
  kNone,
  kTooShort,
  kTooLong,
  kWrongMagic,
  kWrongVersion,
  kWrongChecksum,
  kBadHeader
};

using Datagram = std::array<std::uint8_t, kLargestDatagram>;

/// Writes header and payload; returns the datagram's size. Does not allocate.
/// @pre payload.size() <= kLargestPayload
std::size_t write(Datagram& datagram, const Header& header,
                  std::span<const std::uint8_t> payload) noexcept;

struct Received {
  Flaw flaw = Flaw::kNone;
  Header header;
  std::span<const std::uint8_t> payload;  ///< view into the given bytes; empty with a flaw
};

/// Parses a datagram. Checks in the order of Flaw and reports the first failure. Accepts any bytes.
/// Does not allocate.
[[nodiscard]] Received read(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace wholehand::udp
