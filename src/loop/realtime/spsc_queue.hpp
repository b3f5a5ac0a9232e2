#pragma once

#include "loop/core/real_time.hpp"
#include "loop/core/record_packing.hpp"
#include "loop/core/tick_record.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace wholehand {

/// Lock-free ring buffer between one producer thread and one consumer thread. Neither side ever
/// waits: a full ring drops the record and counts it. All storage is allocated at construction.
///
/// Memory order: a record is written before the release store of `tail_` that publishes it, and
/// read before the release store of `head_` that gives its slot back; each side acquires the
/// other's index. No fences, so ThreadSanitizer understands it.
template <class Record>
class SpscQueue {
  static_assert(std::is_trivially_copyable_v<Record>);
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

 public:
  /// @param capacity at least this many records fit; rounded up to a power of two (minimum 1).
  explicit SpscQueue(std::size_t capacity)
      : slots_(std::bit_ceil(capacity < 1 ? std::size_t{1} : capacity)), mask_(slots_.size() - 1) {}
  SpscQueue(const SpscQueue&) = delete;
  SpscQueue& operator=(const SpscQueue&) = delete;

  /// Producer only. Real-time safe. False when the ring is full: the record is dropped and counted.
  [[nodiscard]] bool try_push(const Record& record) noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - known_head_ == slots_.size()) {
      known_head_ = head_.load(std::memory_order_acquire);
      if (tail - known_head_ == slots_.size()) {
        // A plain increment would do for the one producer, but any thread may read the counter.
        dropped_.fetch_add(1, std::memory_order_relaxed);
        return false;
      }
    }
    slots_[tail & mask_] = record;
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// Consumer only. Real-time safe. False when the ring is empty; `record` is then unchanged.
  [[nodiscard]] bool try_pop(Record& record) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head == known_tail_) {
      known_tail_ = tail_.load(std::memory_order_acquire);
      if (head == known_tail_) {
        return false;
      }
    }
    record = slots_[head & mask_];
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Records dropped since construction. Any thread.
  [[nodiscard]] std::uint64_t dropped() const noexcept {
    return dropped_.load(std::memory_order_relaxed);
  }
  /// Number of queued records; a snapshot. Any thread.
  [[nodiscard]] std::size_t size() const noexcept {
    // head first: the other order could see a head beyond the tail.
    const std::uint64_t head = head_.load(std::memory_order_acquire);
    const std::uint64_t tail = tail_.load(std::memory_order_acquire);
    return tail - head;
  }
  [[nodiscard]] std::size_t capacity() const noexcept { return slots_.size(); }

 private:
  // Avoids false sharing: the two threads must not write the same cache line.
  static constexpr std::size_t kCacheLine_bytes = 64;

  std::vector<Record> slots_;
  std::uint64_t mask_;
  alignas(kCacheLine_bytes) std::atomic<std::uint64_t> tail_{0};  // written by the producer
  std::uint64_t known_head_ = 0;                                  // the producer's last look
  std::atomic<std::uint64_t> dropped_{0};
  alignas(kCacheLine_bytes) std::atomic<std::uint64_t> head_{0};  // written by the consumer
  std::uint64_t known_tail_ = 0;                                  // the consumer's last look
};

/// Lock-free queue of tick records between one producer and one consumer thread: a ring of packed
/// records of different lengths. Neither side ever waits: a full ring drops the record and counts
/// it. All storage is allocated at construction.
///
/// Memory order: a record is written before the release store of `tail_` that publishes it, and
/// read before the release store of `head_` that gives its room back; each side acquires the
/// other's index. Both count bytes since construction. Both skip the same end of the ring, where
/// the largest record would not fit.
class RecordQueue {
 public:
  /// @param bytes of the ring; at least room for two of the largest records
  explicit RecordQueue(std::size_t bytes) : ring_(std::max(bytes, 2 * kMostBytes)) {}
  RecordQueue(const RecordQueue&) = delete;
  RecordQueue& operator=(const RecordQueue&) = delete;

  /// Producer only. False when the ring is full: the record is dropped and counted.
  [[nodiscard]] WHOLEHAND_RT bool try_push(const TickRecord& record) noexcept {
    const std::uint64_t tail = begin(tail_.load(std::memory_order_relaxed));
    if (tail + kMostBytes - known_head_ > ring_.size()) {
      known_head_ = head_.load(std::memory_order_acquire);
      if (tail + kMostBytes - known_head_ > ring_.size()) {
        dropped_.fetch_add(1, std::memory_order_relaxed);
        return false;
      }
    }
    std::byte* at = ring_.data() + tail % ring_.size();
    const std::uint64_t size = packRecord(record, at + sizeof size);
    std::memcpy(at, &size, sizeof size);
    pushed_.fetch_add(1, std::memory_order_relaxed);
    tail_.store(tail + sizeof size + size, std::memory_order_release);
    return true;
  }

  /// Consumer only. False when the ring is empty; `record` is then unchanged.
  [[nodiscard]] bool try_pop(TickRecord& record) noexcept {
    std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head == known_tail_) {
      known_tail_ = tail_.load(std::memory_order_acquire);
      if (head == known_tail_) return false;
    }
    head = begin(head);
    const std::byte* at = ring_.data() + head % ring_.size();
    std::uint64_t size = 0;
    std::memcpy(&size, at, sizeof size);
    (void)unpackRecord(at + sizeof size, size, record);  // always valid: packRecord() made it
    popped_.fetch_add(1, std::memory_order_relaxed);
    head_.store(head + sizeof size + size, std::memory_order_release);
    return true;
  }

  /// Records dropped since construction. Any thread.
  [[nodiscard]] std::uint64_t dropped() const noexcept {
    return dropped_.load(std::memory_order_relaxed);
  }
  /// Number of queued records; a snapshot. Any thread.
  [[nodiscard]] std::size_t size() const noexcept {
    const std::uint64_t popped = popped_.load(std::memory_order_relaxed);
    const std::uint64_t pushed = pushed_.load(std::memory_order_relaxed);
    return pushed > popped ? pushed - popped : 0;
  }

 private:
  static constexpr std::size_t kMostBytes = kMostPackedBytes + sizeof(std::uint64_t);
  // Avoids false sharing: the two threads must not write the same cache line.
  static constexpr std::size_t kCacheLine_bytes = 64;

  /// Position at which the next record begins: `at`, or the start of the ring when the largest
  /// record would not fit before its end.
  [[nodiscard]] std::uint64_t begin(std::uint64_t at) const noexcept {
    const std::uint64_t left = ring_.size() - at % ring_.size();
    return left < kMostBytes ? at + left : at;
  }

  std::vector<std::byte> ring_;
  alignas(kCacheLine_bytes) std::atomic<std::uint64_t> tail_{0};  // written by the producer
  std::uint64_t known_head_ = 0;                                  // the producer's last look
  std::atomic<std::uint64_t> dropped_{0}, pushed_{0};
  alignas(kCacheLine_bytes) std::atomic<std::uint64_t> head_{0};  // written by the consumer
  std::uint64_t known_tail_ = 0;                                  // the consumer's last look
  std::atomic<std::uint64_t> popped_{0};
};

}  // namespace wholehand
