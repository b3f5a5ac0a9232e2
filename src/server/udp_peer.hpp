#pragma once

#include "server/controls_arbiter.hpp"
#include "server/udp_socket.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

// What the program remembers of one game. Pure: no socket, no clock.
namespace wholehand::udp {

/// Which ticks are sent at a rate: evenly spread, exact over any whole second.
class Decimator {
 public:
  Decimator() = default;
  /// 0 Hz: none.
  Decimator(std::uint32_t rate_hz, std::uint32_t tick_rate_hz) noexcept
      : rate_hz_(rate_hz), tick_rate_hz_(tick_rate_hz) {}

  /// True when a state is due at this tick. Skipped ticks are not made up for; a tick that is not
  /// after the last one begins anew (a new session).
  [[nodiscard]] bool due(std::uint64_t tick) noexcept;

 private:
  std::uint32_t rate_hz_ = 0, tick_rate_hz_ = 1000;
  bool any_ = false;
  std::uint64_t last_ = 0;
};

/// A game that has a key.
struct Peer {
  std::uint64_t key = 0;
  ControlsArbiter::Client client = 0;
  bool standalone = false;  ///< it has no WebSocket: the key was given at the start

  // Since its first datagram, until it is silent for a second.
  bool open = false;
  UdpEndpoint endpoint;
  std::uint32_t newest = 0;     ///< sequence number of its newest datagram; it counts from 1
  std::int64_t their_ns = 0;    ///< sent_ns of that one
  std::int64_t heard_ns = 0;    ///< when that one came
  std::uint32_t last_stop = 0;  ///< Command.id of the emergency stop that was obeyed last; 0: none
  std::uint32_t rate_hz = 0;
  Decimator decimator;
  std::int64_t second_ns = 0;  ///< when commands were last counted from 0
  int commands = 0;            ///< since then

  /// Somebody at the endpoint has told a time that was sent there. Until then it gets one header
  /// for each that it sends, and may only stop: a datagram may carry anybody's address, or be one
  /// of an earlier conversation.
  bool proved = false;
  std::array<std::int64_t, 8> told_ns{};  ///< times that were sent there lately; 0: none
  std::size_t told = 0;

  std::uint32_t sequence = 0;  ///< of the program's last datagram
  std::int64_t sent_ns = 0;    ///< of that one
};

}  // namespace wholehand::udp
