#pragma once

#include "loop/core/real_time.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace wholehand {

/// Latest value of one writer for one reader, which may be processes that share the memory.
/// Wait-free on both sides. A writer that is killed or stopped while writing leaves the previous
/// value readable.
///
/// Double buffer: value n is in buffer n mod 2. The writer fills the buffer of n + 2 only after it
/// has published n + 1. A reader that sees n as the newest before and after its copy has therefore
/// copied value n. Memory order: a reader that acquires a word of n + 2 sees that n + 1 is
/// published, because the writer released the word after that. No locks and no fences; every word
/// is atomic.
template <class Value>
class NewestValue {
  static_assert(std::is_trivially_copyable_v<Value>);
  static_assert(sizeof(Value) % sizeof(std::uint64_t) == 0);
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

 public:
  /// Publishes a value. Writer only. Real-time safe.
  WHOLEHAND_RT void publish(const Value& value) noexcept {
    Words words;
    std::memcpy(words.data(), &value, sizeof(Value));
    const std::uint64_t number = published_.load(std::memory_order_relaxed) + 1;
    Buffer& buffer = buffers_[number % 2];
    for (std::size_t i = 0; i < kWords; ++i) buffer[i].store(words[i], std::memory_order_release);
    published_.store(number, std::memory_order_release);
  }

  /// Copies the latest value. Reader only. False when nothing was published yet, or when the writer
  /// overtook several attempts; `value` is then unchanged. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT bool take(Value& value) const noexcept {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const std::uint64_t number = published_.load(std::memory_order_acquire);
      if (number == 0) return false;
      const Buffer& buffer = buffers_[number % 2];
      Words words;
      for (std::size_t i = 0; i < kWords; ++i) words[i] = buffer[i].load(std::memory_order_acquire);
      if (published_.load(std::memory_order_relaxed) != number) continue;
      std::memcpy(&value, words.data(), sizeof(Value));
      return true;
    }
    return false;
  }

 private:
  static constexpr int kAttempts = 4;
  static constexpr std::size_t kWords = sizeof(Value) / sizeof(std::uint64_t);
  using Words = std::array<std::uint64_t, kWords>;
  using Buffer = std::array<std::atomic<std::uint64_t>, kWords>;

  std::atomic<std::uint64_t> published_{0};  ///< number of published values
  std::array<Buffer, 2> buffers_{};
};

}  // namespace wholehand
