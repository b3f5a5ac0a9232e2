#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

namespace wholehand {

/// Why a datagram was ignored.
enum class UdpIgnored {
  kTooShort,
  kTooLong,
  kMagic,
  kVersion,
  kChecksum,
  kHeader,   ///< unknown kind, a rate above 1000 Hz, bits that must be 0
  kKey,      ///< key of no known game
  kStale,    ///< duplicate, or older than one received
  kMessage,  ///< a message that games may not send by datagram
  kRate,     ///< more commands than kMostCommands a second
  kCount
};

/// Counters of the UDP side since it started, for /metrics. Written by its threads, read by any.
struct UdpCounters {
  using Counter = std::atomic<std::uint64_t>;

  Counter received{0};      ///< datagrams
  Counter states_sent{0};   ///< WorldState messages
  Counter dropped_full{0};  ///< datagrams dropped because the socket buffer was full
  Counter send_errors{0};   ///< datagrams dropped by any other error
  Counter stops{0};         ///< emergency stops obeyed
  Counter exceptions{0};    ///< exceptions caught in orders and rounds; the bridge continued
  Counter peers_lost{0};    ///< games silent for more than a second
  std::atomic<std::uint32_t> peers{0};  ///< connected now
  std::array<Counter, static_cast<std::size_t>(UdpIgnored::kCount)> ignored{};

  void ignore(UdpIgnored reason) noexcept { ++ignored[static_cast<std::size_t>(reason)]; }
  [[nodiscard]] std::uint64_t ignoredFor(UdpIgnored reason) const noexcept {
    return ignored[static_cast<std::size_t>(reason)];
  }
};

/// Name of a reason in snake_case: the label of its metric.
[[nodiscard]] const char* udpIgnoredName(UdpIgnored reason) noexcept;

/// All counters as Prometheus text, to follow the server's own.
[[nodiscard]] std::string udpMetricsText(const UdpCounters& counters);

}  // namespace wholehand
