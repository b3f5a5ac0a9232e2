#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

// Datagrams between the program and a game: docs/udp.md. Pure: no socket, no clock.
namespace wholehand::udp {

/// The largest datagram, header included [bytes]: below what every network carries unfragmented.
inline constexpr std::size_t kLargestDatagram = 1200;
inline constexpr std::size_t kHeaderSize = 36;
inline constexpr std::size_t kLargestPayload = kLargestDatagram - kHeaderSize;
/// The most fragments of one message: 1.1 MB, more than the largest scene.
inline constexpr std::uint16_t kMostFragments = 1024;
/// "WHUD" as a little-endian number.
inline constexpr std::uint32_t kMagic = 0x44554857;
/// Counts changes of the header and of the rules that older clients cannot follow.
inline constexpr std::uint16_t kVersion = 1;

enum class Kind : std::uint8_t {
  // A client says:
  kHello = 1,      ///< payload: HelloPayload; session 0
  kMessage = 2,    ///< payload: Message with a Command or an Acknowledge
  kHeartbeat = 3,  ///< both ways; no payload
  kGoodbye = 4,    ///< both ways; no payload
  // The program says:
  kWelcome = 16,   ///< payload: Message with Welcome; the header carries the new session
  kState = 17,     ///< payload: Message with WorldState, sent once
  kReliable = 18,  ///< any other Message, sent again until acknowledged
  kRefused = 19    ///< payload: why a Hello was refused, UTF-8
};

/// The header of every datagram, little-endian, in this order; a checksum of all follows it.
struct Header {
  // magic u32, version u16
  Kind kind = Kind::kHeartbeat;  // u8, then u8 flags (0)
  std::uint32_t session = 0;     ///< of this conversation, chosen by the program; 0 in a Hello
  /// Of the message; all its fragments carry it. A client numbers all that it sends; the program
  /// numbers states, reliable messages and the rest each by themselves.
  std::uint32_t sequence = 0;
  std::int64_t monotonic_ns = 0;     ///< sender's CLOCK_MONOTONIC
  std::uint16_t fragment_index = 0;  ///< 0 .. fragment_count - 1
  std::uint16_t fragment_count = 1;
  std::uint16_t payload_length = 0;  // then u16 reserved (0), u32 CRC-32
};

/// Why a datagram is no good.
enum class Flaw {
  kNone,
  kTooShort,
  kTooLong,
  kWrongMagic,
  kWrongVersion,
  kWrongLength,
  kWrongChecksum,
  kBadHeader
};

using Datagram = std::array<std::uint8_t, kLargestDatagram>;

/// Writes header and payload; the size of the datagram. Does not allocate.
/// @pre payload.size() <= kLargestPayload; header.payload_length is set from it
std::size_t write(Datagram& datagram, Header header,
                  std::span<const std::uint8_t> payload) noexcept;

struct Received {
  Flaw flaw = Flaw::kNone;
  Header header;
  std::span<const std::uint8_t> payload;  ///< of the bytes given; empty with a flaw
};

/// Checks in the order of Flaw: what fails first is told. Any bytes. Does not allocate.
[[nodiscard]] Received read(std::span<const std::uint8_t> bytes) noexcept;

/// Cuts a message into datagrams and hands each over; how many there were. 0 where it is too large.
std::uint16_t forEachFragment(
    const Header& header, std::span<const std::uint8_t> message,
    const std::function<void(std::span<const std::uint8_t> datagram)>& send);

/// What a Hello carries, little-endian: rate u16, schema version u16, nonce u64, token (the rest).
struct Hello {
  std::uint16_t rate_hz = 0;         ///< of states; 0: none, at most 1000
  std::uint16_t schema_version = 0;  ///< of protocol/wholehand.fbs that the client was built with
  std::uint64_t nonce = 0;           ///< random; a repeated Hello repeats it, a new one does not
  std::span<const std::uint8_t> token;
};
inline constexpr std::size_t kHelloSize = 12;
inline constexpr std::size_t kLongestToken = 256;
inline constexpr std::uint16_t kHighestRate_hz = 1000;

/// False where it is malformed: too short, rate above 1000 Hz, token too long.
[[nodiscard]] bool readHello(std::span<const std::uint8_t> payload, Hello& hello) noexcept;
[[nodiscard]] std::vector<std::uint8_t> writeHello(const Hello& hello);

/// Which sequence numbers came already, of the last 64: each passes once.
class ReplayWindow {
 public:
  /// False for one that came already or is older than the window.
  [[nodiscard]] bool isNew(std::uint32_t sequence) const noexcept;
  /// It came. @pre isNew(sequence)
  void accept(std::uint32_t sequence) noexcept;

 private:
  bool any_ = false;
  std::uint32_t newest_ = 0;
  std::uint64_t seen_ = 0;  ///< bit i: newest_ - i came
};

/// Puts fragments of one message at a time together again: a later message drops what is left of
/// an earlier one.
class Reassembler {
 public:
  explicit Reassembler(std::size_t largest_message) : largest_(largest_message) {}

  enum class Result { kIncomplete, kComplete, kRepeated, kRefused };
  /// kComplete: message() is whole. kRefused: fragments contradict each other, or the message
  /// would be larger than allowed.
  [[nodiscard]] Result add(const Header& header, std::span<const std::uint8_t> payload);
  [[nodiscard]] std::span<const std::uint8_t> message() const noexcept { return message_; }

 private:
  std::size_t largest_;
  bool open_ = false;
  std::uint32_t sequence_ = 0;
  std::uint16_t count_ = 0, received_ = 0;
  std::vector<bool> have_;
  std::vector<std::uint8_t> message_;
};

}  // namespace wholehand::udp
