// Linking this file replaces the program's malloc family by functions that count the call and then
// call the C library's own function. For programs that measure and for tests; the library itself
// does not link it.
#include "loop/realtime/allocation_counter.hpp"

#include "loop/core/compiler.hpp"

#include <cerrno>
#include <cstddef>

#if defined(__GLIBC__) && !WHOLEHAND_SANITIZED
#define WHOLEHAND_COUNTS_ALLOCATIONS 1
#else
#define WHOLEHAND_COUNTS_ALLOCATIONS 0
#endif

namespace wholehand {
namespace {
// constinit: malloc runs before any initialiser.
constinit thread_local std::uint64_t allocation_count = 0;
constinit thread_local std::uint64_t release_count = 0;
}  // namespace

bool allocationCountingAvailable() noexcept {
  return WHOLEHAND_COUNTS_ALLOCATIONS != 0;
}
std::uint64_t threadAllocations() noexcept {
  return allocation_count;
}
std::uint64_t threadReleases() noexcept {
  return release_count;
}

}  // namespace wholehand

#if WHOLEHAND_COUNTS_ALLOCATIONS

// The C library prescribes these names; its internal functions are undocumented.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) {
  ++wholehand::allocation_count;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++wholehand::allocation_count;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  ++wholehand::allocation_count;
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  ++wholehand::allocation_count;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++wholehand::allocation_count;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  const bool power_of_two = alignment != 0 && (alignment & (alignment - 1)) == 0;
  if (!power_of_two || alignment % sizeof(void*) != 0) {
    return EINVAL;
  }
  ++wholehand::allocation_count;
  // Unlike the others, this function returns its error and leaves errno unchanged.
  const int errno_before = errno;
  void* given = __libc_memalign(alignment, size);
  errno = errno_before;
  if (given == nullptr) {
    return ENOMEM;
  }
  *block = given;
  return 0;
}
void free(void* block) {
  if (block != nullptr) {
    ++wholehand::release_count;
  }
  __libc_free(block);
}
}
// NOLINTEND(readability-identifier-naming)

#endif
