#pragma once

#include "drivers/frame/firmware/frame.h"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <numeric>
#include <vector>

namespace wholehand::test {

using Bytes = std::vector<std::uint8_t>;

inline Bytes encoded(const Bytes& plain) {
  Bytes out(plain.size() + plain.size() / 254 + 1);
  out.resize(wf_cobs_encode(plain.data(), plain.size(), out.data()));
  return out;
}

// Uses a buffer of exactly the required size, so that a sanitizer detects accesses beyond it.
inline bool decoded(const Bytes& coded, Bytes& plain) {
  Bytes out(coded.size());
  std::size_t length = 0;
  if (wf_cobs_decode(coded.data(), coded.size(), out.data(), &length) == 0) return false;
  out.resize(length);
  plain = out;
  return true;
}

/// The bytes from, from + 1, ..., to.
inline Bytes run(int from, int to) {
  Bytes bytes(static_cast<std::size_t>(to - from + 1));
  std::iota(bytes.begin(), bytes.end(), static_cast<std::uint8_t>(from));
  return bytes;
}

inline Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace wholehand::test
