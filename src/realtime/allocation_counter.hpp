#pragma once

#include <cstdint>

namespace wholehand {

/// False where a sanitizer owns malloc: every count is then 0 and proves nothing.
[[nodiscard]] bool allocationCountingAvailable() noexcept;

/// Calls of malloc, calloc, realloc and their aligned kin by this thread since it began, whoever
/// made them (operator new, the physics engine, a library). Real-time safe.
[[nodiscard]] std::uint64_t threadAllocations() noexcept;
/// Calls of free with a block by this thread since it began. Real-time safe.
[[nodiscard]] std::uint64_t threadReleases() noexcept;

/// Counts what this thread allocates and releases while the scope lives.
class AllocationScope {
 public:
  AllocationScope() noexcept
      : allocations_before_(threadAllocations()), releases_before_(threadReleases()) {}
  [[nodiscard]] std::uint64_t allocations() const noexcept {
    return threadAllocations() - allocations_before_;
  }
  [[nodiscard]] std::uint64_t releases() const noexcept {
    return threadReleases() - releases_before_;
  }

 private:
  std::uint64_t allocations_before_;
  std::uint64_t releases_before_;
};

}  // namespace wholehand
