#pragma once

#include <cstddef>

namespace wholehand {

/// Memory whose pages are mapped in advance, so that writing to it in the tick causes no page
/// fault.
class PrefaultedMemory {
 public:
  PrefaultedMemory() = default;
  ~PrefaultedMemory();
  PrefaultedMemory(const PrefaultedMemory&) = delete;
  PrefaultedMemory& operator=(const PrefaultedMemory&) = delete;

  /// Allocates the memory; false with errno on failure. @pre not taken yet; bytes > 0
  [[nodiscard]] bool take(std::size_t bytes) noexcept;
  [[nodiscard]] std::byte* data() const noexcept { return data_; }
  /// The memory as an array; initially zero.
  template <class T>
  [[nodiscard]] T* as() const noexcept {
    return reinterpret_cast<T*>(data_);
  }

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace wholehand
