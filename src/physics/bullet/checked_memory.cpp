#include "physics/bullet/checked_memory.hpp"

#include <LinearMath/btAlignedAllocator.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace wholehand::bullet {
namespace {

void* allocate(std::size_t bytes) {
  void* memory = std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void useCheckedMemory() {
  // Once: Bullet keeps the two functions in plain variables, and another thread may be using them.
  static const bool kOnce = (btAlignedAllocSetCustom(allocate, std::free), true);
  (void)kOnce;
}

}  // namespace wholehand::bullet
