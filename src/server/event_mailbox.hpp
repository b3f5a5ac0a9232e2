#pragma once

#include "core/tick_record.hpp"
#include "server/wire.hpp"

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

namespace wholehand {

/// Carries the events of every record from the telemetry thread to the server's, and when the
/// newest records came. Bounded: events that nobody fetches are dropped and counted.
class EventMailbox {
 public:
  static constexpr std::size_t kCapacity = 4096;  ///< events that wait

  EventMailbox() { waiting_.reserve(kCapacity); }

  /// From the telemetry thread; allocates nothing.
  void put(const TickRecord& record, std::int64_t now_ns);
  /// All that wait, into `events` (emptied first).
  void fetch(std::vector<wire::NumberedEvent>& events);

  /// When the record of that tick came; when it is not known, the newest record's time.
  [[nodiscard]] std::int64_t arrivalOf(std::uint64_t tick) const;
  /// When the newest record came; 0: none yet.
  [[nodiscard]] std::int64_t newest_ns() const;
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  struct Arrival {
    std::uint64_t tick = ~std::uint64_t{0};
    std::int64_t at_ns = 0;
  };

  mutable std::mutex mutex_;
  std::vector<wire::NumberedEvent> waiting_;
  std::array<Arrival, 256> arrivals_{};  ///< at tick mod 256
  std::int64_t newest_ns_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace wholehand
