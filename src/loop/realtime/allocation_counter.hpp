#pragma once

#include <cstdint>

namespace wholehand {

/// False when a sanitizer owns malloc. Every count is then 0 and proves nothing.
[[nodiscard]] bool allocationCountingAvailable() noexcept;

/// Calls of malloc, calloc, realloc and their aligned variants by this thread since it started,
/// including those of operator new, the physics engine and libraries. Real-time safe.
[[nodiscard]] std::uint64_t threadAllocations() noexcept;
/// Calls of free with a non-null pointer by this thread since it started. Real-time safe.
[[nodiscard]] std::uint64_t threadReleases() noexcept;

/// Counts this thread's allocations and releases during the scope's lifetime.
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
