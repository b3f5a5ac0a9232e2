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
  kKey,      ///< of no conversation
  kStale,    ///< came already, or after a later one
  kMessage,  ///< nothing that a game may say by datagram
  kRate,     ///< more commands than any game needs
  kCount
};

/// What the UDP side did since it began, for /metrics. Written by its threads, read by anybody.
struct UdpCounters {
  using Counter = std::atomic<std::uint64_t>;

  Counter received{0};      ///< datagrams
  Counter states_sent{0};   ///< WorldState messages
  Counter dropped_full{0};  ///< datagrams not sent: the socket's buffer was full
  Counter send_errors{0};   ///< datagrams not sent: anything else
  Counter stops{0};         ///< emergency stops obeyed
  Counter exceptions{0};    ///< orders and rounds that the program gave up; the bridge went on
  Counter peers_lost{0};    ///< games that were not heard for a second
  std::atomic<std::uint32_t> peers{0};  ///< now
  std::array<Counter, static_cast<std::size_t>(UdpIgnored::kCount)> ignored{};

  void ignore(UdpIgnored reason) noexcept { ++ignored[static_cast<std::size_t>(reason)]; }
  [[nodiscard]] std::uint64_t ignoredFor(UdpIgnored reason) const noexcept {
    return ignored[static_cast<std::size_t>(reason)];
  }
};

/// snake_case name of a reason, the label of its metric.
[[nodiscard]] const char* udpIgnoredName(UdpIgnored reason) noexcept;

/// All of them as Prometheus text, to follow the server's own.
[[nodiscard]] std::string udpMetricsText(const UdpCounters& counters);

}  // namespace wholehand
