#pragma once

#include <cstddef>

namespace wholehand {

/// Memory whose pages exist from the start: whoever writes to it in the tick meets no page fault.
class PrefaultedMemory {
 public:
  PrefaultedMemory() = default;
  ~PrefaultedMemory();
  PrefaultedMemory(const PrefaultedMemory&) = delete;
  PrefaultedMemory& operator=(const PrefaultedMemory&) = delete;

  /// False, with errno, where the system has none. @pre not taken yet; bytes > 0
  [[nodiscard]] bool take(std::size_t bytes) noexcept;
  [[nodiscard]] std::byte* data() const noexcept { return data_; }
  /// The same as an array; zero at first.
  template <class T>
  [[nodiscard]] T* as() const noexcept {
    return reinterpret_cast<T*>(data_);
  }

 private:
  std::byte* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace wholehand
