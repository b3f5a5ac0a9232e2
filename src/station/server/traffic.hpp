#pragma once

#include "vocabulary/backend.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace wholehand {

/// Statistics of the server. One thread.
struct Traffic {
  std::size_t clients = 0;           ///< WebSocket clients now
  std::uint64_t clients_seen = 0;    ///< WebSocket clients since the start
  std::uint64_t bytes_sent = 0;      ///< bytes sent over WebSocket
  std::uint64_t states_skipped = 0;  ///< states not sent because the client was busy
  std::uint64_t http_requests = 0;
  std::map<std::string, std::uint64_t> dropped;  ///< disconnected clients, by reason
  std::map<std::string, std::uint64_t> refused;  ///< refused messages and requests, by reason

  /// Adds the time from a record's arrival to the end of its write to a client.
  void addAge(std::int64_t age_ns);
  /// Quantile of the last 4096 ages [s]; 0 without any.
  /// @param share quantile as a share, 0 to 1
  [[nodiscard]] double ageQuantile_s(double share) const;

 private:
  std::array<std::int64_t, 4096> ages_ns_{};
  std::uint64_t age_count_ = 0;
};

/// Input of /healthz and /metrics, including the loop's status.
struct LoopHealth {
  LoopStatus status;
  double record_age_s = -1.0;  ///< age of the newest record; negative: none yet
  std::uint64_t events_dropped = 0;
};

/// True when the loop is not faulted, loop and device answer and obey, and records arrive while it
/// renders.
[[nodiscard]] bool healthy(const LoopHealth& pulse);
[[nodiscard]] std::string healthJson(const LoopHealth& pulse);
/// Returns Prometheus text, format 0.0.4.
[[nodiscard]] std::string metricsText(const LoopHealth& pulse, const Traffic& traffic);

/// Reason why a datagram was ignored.
enum class UdpIgnored {
  kTooShort,
  kTooLong,
  kMagic,
  kVersion,
  kChecksum,
  kHeader,   ///< unknown kind, a rate above 1000 Hz, bits that must be 0
  kKey,      ///< the key belongs to no known game
  kStale,    ///< duplicate, or older than one received
  kMessage,  ///< a message that games may not send by datagram
  kRate,     ///< more commands than kMostCommands a second
  kCount
};

/// Counters of the UDP side since it started, for /metrics. Written by its threads, read by any.
struct UdpCounters {
  using Counter = std::atomic<std::uint64_t>;

  Counter received{0};      ///< datagrams received
  Counter states_sent{0};   ///< WorldState messages sent
  Counter dropped_full{0};  ///< datagrams dropped because the socket buffer was full
  Counter send_errors{0};   ///< datagrams dropped by any other error
  Counter stops{0};         ///< emergency stops obeyed
  Counter exceptions{0};    ///< exceptions caught in orders and rounds; the bridge continued
  Counter peers_lost{0};    ///< games silent for more than a second
  std::atomic<std::uint32_t> peers{0};  ///< games connected now
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
