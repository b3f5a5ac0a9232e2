#pragma once

#include "wholehand/device.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace wholehand {

/// Reads into a sample that may come from an older header; members that the older one lacks are
/// omitted.
/// @param read fills in a whole sample and returns its result
template <class Read>
[[nodiscard]] int readSized(wh_sample& sample, Read read) {
  wh_sample newest{};
  const std::uint32_t size = sample.size;
  const int result = read(newest);
  if (result < 0) return result;
  std::memcpy(&sample, &newest, std::min<std::size_t>(size, sizeof(newest)));
  sample.size = size;
  return result;
}

}  // namespace wholehand
