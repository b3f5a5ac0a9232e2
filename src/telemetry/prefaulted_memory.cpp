#include "telemetry/prefaulted_memory.hpp"

#include <sys/mman.h>

namespace wholehand {

bool PrefaultedMemory::take(std::size_t bytes) noexcept {
  void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  if (memory == MAP_FAILED) return false;
  data_ = static_cast<std::byte*>(memory);
  bytes_ = bytes;
  return true;
}

PrefaultedMemory::~PrefaultedMemory() {
  if (data_ != nullptr) ::munmap(data_, bytes_);
}

}  // namespace wholehand
