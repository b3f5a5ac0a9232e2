#pragma once

#include "server/backend.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace wholehand {

/// What the server counts of itself. One thread.
struct Traffic {
  std::size_t clients = 0;           ///< WebSocket clients now
  std::uint64_t clients_seen = 0;    ///< since the start
  std::uint64_t bytes_sent = 0;      ///< over WebSocket
  std::uint64_t states_skipped = 0;  ///< states that a busy client did not get
  std::uint64_t http_requests = 0;
  std::map<std::string, std::uint64_t> dropped;  ///< clients cut off, by reason
  std::map<std::string, std::uint64_t> refused;  ///< messages and requests, by reason

  /// Time from a record's arrival to the end of its write to a client.
  void addAge(std::int64_t age_ns);
  /// Of the last 4096 ages [s]; 0 without any.
  [[nodiscard]] double ageQuantile_s(double share) const;

 private:
  std::array<std::int64_t, 4096> ages_ns_{};
  std::uint64_t age_count_ = 0;
};

/// "rendering", "faulted", ...
[[nodiscard]] const char* runStateName(RunState state);

/// What /healthz and /metrics say beside the loop's status.
struct Pulse {
  LoopStatus status;
  double record_age_s = -1.0;  ///< of the newest record; negative: none yet
  std::uint64_t events_dropped = 0;
};

/// Whether the loop does what it says it does: not faulted, and while it renders its records come.
[[nodiscard]] bool healthy(const Pulse& pulse);
[[nodiscard]] std::string healthJson(const Pulse& pulse);
/// Prometheus text format 0.0.4.
[[nodiscard]] std::string metricsText(const Pulse& pulse, const Traffic& traffic);

}  // namespace wholehand
