#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

// Datagrams between the program and a game: docs/udp.md. Pure: no socket, no clock.
namespace wholehand::udp {

/// The largest datagram, header included [bytes]: below what every network carries unfragmented.
inline constexpr std::size_t kLargestDatagram = 1200;
inline constexpr std::size_t kHeaderSize = 48;
inline constexpr std::size_t kLargestPayload = kLargestDatagram - kHeaderSize;
/// "WHUD" as a little-endian number.
inline constexpr std::uint32_t kMagic = 0x44554857;
/// Counts changes of the header and of the rules that older clients cannot follow.
inline constexpr std::uint16_t kVersion = 2;
/// States a second that a game may ask for.
inline constexpr std::uint32_t kHighestRate_hz = 1000;

enum class Kind : std::uint8_t {
  kCommand = 1,  ///< a game; payload: Message with a Command
  kAlive = 2,    ///< a game; no payload
  kState = 16,   ///< the program; payload: Message with a WorldState
  kPresent = 17  ///< the program; no payload
};

/// The header of every datagram, little-endian, in this order; a checksum follows it.
struct Header {
  // magic u32, version u16
  Kind kind = Kind::kAlive;
  bool holds_controls = false;  ///< the program: the game that this goes to holds the controls
  std::uint64_t key = 0;        ///< of the conversation, from the Welcome or from --udp-key
  std::uint32_t sequence = 0;   ///< rises with every datagram of the sender
  /// A game: states a second that it asks for, 0 to 1000. The program: Command.id of the last
  /// emergency stop that it obeyed; the game repeats one until it is here.
  std::uint32_t rate_or_stop = 0;
  std::int64_t sent_ns = 0;       ///< sender's CLOCK_MONOTONIC
  std::int64_t echo_ns = 0;       ///< sent_ns of the newest datagram of the other side; 0: none
  std::uint32_t echo_age_us = 0;  ///< since that one came
};

/// Why a datagram is no good.
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

/// Writes header and payload; the size of the datagram. Does not allocate.
/// @pre payload.size() <= kLargestPayload
std::size_t write(Datagram& datagram, const Header& header,
                  std::span<const std::uint8_t> payload) noexcept;

struct Received {
  Flaw flaw = Flaw::kNone;
  Header header;
  std::span<const std::uint8_t> payload;  ///< of the bytes given; empty with a flaw
};

/// Checks in the order of Flaw: what fails first is told. Any bytes. Does not allocate.
[[nodiscard]] Received read(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace wholehand::udp
