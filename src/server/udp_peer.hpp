#pragma once

#include "server/controls_arbiter.hpp"
#include "server/udp_socket.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

// State that the program keeps for each game. No socket, no clock.
namespace wholehand::udp {

/// Selects the ticks to send at a given rate: evenly spaced, exact over any whole second.
class Decimator {
 public:
  Decimator() = default;
  /// Rate 0: no ticks.
  Decimator(std::uint32_t rate_hz, std::uint32_t tick_rate_hz) noexcept
      : rate_hz_(rate_hz), tick_rate_hz_(tick_rate_hz) {}

  /// True when a state is due at this tick. Skipped ticks are not made up for. A tick that is not
  /// later than the last one starts afresh (a new session).
  [[nodiscard]] bool due(std::uint64_t tick) noexcept;

 private:
  std::uint32_t rate_hz_ = 0, tick_rate_hz_ = 1000;
  bool any_ = false;
  std::uint64_t last_ = 0;
};

/// A game with a key.
struct Peer {
  std::uint64_t key = 0;
  ControlsArbiter::Client client = 0;
  bool standalone = false;  ///< no WebSocket: its key was given at program start

  // Valid from its first datagram until it is silent for a second.
  bool open = false;
  UdpEndpoint endpoint;
  std::uint32_t newest = 0;       ///< sequence number of its newest datagram, from 1
  std::int64_t their_ns = 0;      ///< sent_ns of that datagram
  std::int64_t heard_ns = 0;      ///< arrival time of that datagram
  std::uint32_t taken_stop = 0;   ///< Command.id of the last emergency stop handed on; 0: none
  std::uint32_t gentle_stop = 0;  ///< Command.id of the last stop or rest handed on; 0: none
  std::uint32_t obeyed_stop = 0;  ///< Command.id of the last emergency stop obeyed; 0: none
  std::uint32_t rate_hz = 0;
  Decimator decimator;
  std::int64_t second_ns = 0;  ///< start of the current second of counting commands
  int commands = 0;            ///< commands in that second

  /// The endpoint has echoed a time that was sent to it, so its address is verified. Before that,
  /// the program answers each of its datagrams with one header only, and the game may only stop: an
  /// address can be forged, and a datagram can be a replay of an earlier conversation.
  bool address_verified = false;
  std::array<std::int64_t, 8> sent_times_ns{};  ///< sent_ns of recent datagrams to it; 0: none
  std::size_t told = 0;

  std::uint32_t sequence = 0;  ///< of the program's last datagram to it
  std::int64_t sent_ns = 0;    ///< sent_ns of that datagram
};

}  // namespace wholehand::udp
