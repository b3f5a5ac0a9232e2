#pragma once

#include "core/tick_record.hpp"
#include "server/wire.hpp"

#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

namespace wholehand {

/// Carries the events of every record, and the arrival times of the newest records, from the
/// telemetry thread to the server's. Bounded: when it is full, events are dropped and counted.
class EventMailbox {
 public:
  static constexpr std::size_t kCapacity = 4096;  ///< most events that wait

  EventMailbox() { waiting_.reserve(kCapacity); }

  /// Adds a record's events. Telemetry thread; does not allocate.
  void put(const TickRecord& record, std::int64_t now_ns);
  /// Moves all waiting events into `events`, which is emptied first.
  void fetch(std::vector<wire::NumberedEvent>& events);

  /// Arrival time of the record of a tick; of the newest record when that time is no longer known.
  [[nodiscard]] std::int64_t arrivalOf(std::uint64_t tick) const;
  /// Arrival time of the newest record; 0: none yet.
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
