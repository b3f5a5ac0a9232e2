#pragma once

#include "loop/core/tick_record.hpp"
#include "station/server/control_holder.hpp"
#include "station/server/traffic.hpp"
#include "station/server/udp_socket.hpp"
#include "station/server/wire.hpp"
#include "vocabulary/backend.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

// Datagrams between the program and a game: docs/udp.md. No sockets and no clock.
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
  std::uint64_t key = 0;        ///< key of the conversation, from the Welcome message or --udp-key
  std::uint32_t sequence = 0;   ///< increases with every datagram of the sender
  /// From a game: requested state rate [Hz], 0 to 1000. From the program: Command.id of the last
  /// emergency stop that it obeyed; a game repeats a stop until its id appears here.
  std::uint32_t rate_or_stop = 0;
  std::int64_t sent_ns = 0;       ///< sender's CLOCK_MONOTONIC
  std::int64_t echo_ns = 0;       ///< sent_ns of the newest datagram of the other side; 0: none
  std::uint32_t echo_age_us = 0;  ///< time since that datagram arrived
};

/// Reason why a datagram is invalid.
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

/// Writes header and payload; returns the datagram's size [bytes]. Does not allocate.
/// @pre payload.size() <= kLargestPayload
std::size_t write(Datagram& datagram, const Header& header,
                  std::span<const std::uint8_t> payload) noexcept;

struct Received {
  Flaw flaw = Flaw::kNone;
  Header header;
  std::span<const std::uint8_t> payload;  ///< view into the given bytes; empty with a flaw
};

/// Parses a datagram of any bytes. Checks in the order of Flaw and reports the first failure. Does
/// not allocate.
[[nodiscard]] Received read(std::span<const std::uint8_t> bytes) noexcept;

/// Selects the ticks to send at a given rate: evenly spaced, exact over any whole second.
class Decimator {
 public:
  Decimator() = default;
  /// Rate 0: no ticks.
  Decimator(std::uint32_t rate_hz, std::uint32_t tick_rate_hz) noexcept
      : rate_hz_(rate_hz), tick_rate_hz_(tick_rate_hz) {}

  /// True when a state is due at this tick. Skipped ticks are not sent later. A tick that is not
  /// later than the last one begins a new session.
  [[nodiscard]] bool due(std::uint64_t tick) noexcept;

 private:
  std::uint32_t rate_hz_ = 0, tick_rate_hz_ = 1000;
  bool any_ = false;
  std::uint64_t last_ = 0;
};

/// A game with a key.
struct Peer {
  std::uint64_t key = 0;
  ControlHolder::Client client = 0;
  bool standalone = false;  ///< no WebSocket: its key was given at program start

  // The fields below are valid from the game's first datagram until it is silent for a second.
  bool open = false;
  UdpEndpoint endpoint;
  std::uint32_t newest = 0;        ///< sequence number of its newest datagram, from 1
  std::int64_t their_ns = 0;       ///< sent_ns of that datagram
  std::int64_t received_ns = 0;    ///< arrival time of that datagram
  std::uint32_t taken_stop = 0;    ///< Command.id of the last emergency stop handed on; 0: none
  std::uint32_t gentle_stop = 0;   ///< Command.id of the last stop or rest handed on; 0: none
  std::uint32_t applied_stop = 0;  ///< Command.id of the last emergency stop obeyed; 0: none
  std::uint32_t rate_hz = 0;
  Decimator decimator;
  std::int64_t second_ns = 0;  ///< start of the current second of counting commands
  int commands = 0;            ///< commands in that second

  /// The endpoint has echoed a time that was sent to it, so its address is verified. Before that,
  /// the program answers each of its datagrams with one header only, and the game may only stop: an
  /// address can be forged, and a datagram can be a replay of an earlier conversation.
  bool address_verified = false;
  std::array<std::int64_t, 8> sent_times_ns{};  ///< sent_ns of recent datagrams to it; 0: unused
  std::size_t reported = 0;

  std::uint32_t sequence = 0;  ///< sequence number of the program's last datagram to it
  std::int64_t sent_ns = 0;    ///< sent_ns of that datagram
};

/// A message from a game.
struct ReceivedCommand {
  ControlHolder::Client client = 0;
  Order order;
};

/// The program's side of the conversation with all games: docs/udp.md. It has no sockets, clocks or
/// threads: time is an argument, datagrams leave through a function, and the games' messages wait
/// for takeCommands(). One thread at a time.
class Host {
 public:
  using Send = std::function<UdpSent(const UdpEndpoint&, std::span<const std::uint8_t>)>;

  /// A game that is silent for longer is removed [ns].
  static constexpr std::int64_t kGone_ns = 1'000'000'000;
  /// Limit of a game's commands per second: one aim per tick at 1 kHz and a reserve. Stops are
  /// exempt.
  static constexpr int kMostCommands = 1200;
  /// Longest interval between two datagrams of the program.
  static constexpr std::int64_t kPresent_ns = 100'000'000;

  Host(ControlHolder& controls, UdpCounters& counters, Send send);

  /// Assigns a key to a client.
  /// @param standalone the client has no WebSocket
  void admit(std::uint64_t key, ControlHolder::Client client, bool standalone);
  /// Invalidates the client's key.
  void dismiss(ControlHolder::Client client);

  /// Sets the scene for the following states.
  void setScene(std::shared_ptr<const SceneFacts> scene);
  /// Sends a record's state to every game that is due for one.
  void publish(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns);
  /// Repeats the newest record while no new ones arrive, so that games see the run state.
  void publishIdle(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns);
  /// Handles a datagram: any bytes from any sender.
  void receive(const UdpEndpoint& from, std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  /// Removes silent games and sends the keep-alives that are due. Call at least every 10 ms.
  void advance(std::int64_t now_ns);
  /// Messages since the last call, in order: emergency stops, and orders that the server judges.
  [[nodiscard]] std::vector<ReceivedCommand> takeCommands();
  /// Reports the outcome of an emergency stop that takeCommands() returned. Only a stop that was
  /// obeyed is acknowledged to the game; one that failed is handed on again when it is repeated.
  void finishStop(const ReceivedCommand& stop, bool obeyed);

  [[nodiscard]] const std::vector<Peer>& peers() const noexcept { return peers_; }

 private:
  [[nodiscard]] Peer* find(std::uint64_t key);
  void begin(Peer& peer, const UdpEndpoint& from);
  void follow(Peer& peer, const Header& header, std::int64_t now_ns);
  void apply(Peer& peer, const Order& message, std::int64_t now_ns);
  void stop(Peer& peer, const Order& message);
  void send(Peer& peer, Kind kind, std::span<const std::uint8_t> message, std::int64_t now_ns);
  void countGames();

  ControlHolder& controls_;
  UdpCounters& counters_;
  Send send_;
  std::vector<Peer> peers_;
  std::vector<ReceivedCommand> said_;
  std::shared_ptr<const SceneFacts> scene_;
  std::unique_ptr<wire::StateEncoder> encoder_;
  std::uint32_t tick_rate_hz_ = 1000;
};

}  // namespace wholehand::udp
