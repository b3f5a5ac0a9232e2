#pragma once

#include "support/tolerance.hpp"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

/// One seed for all random draws of the tests: ./check chooses a new one every time and prints it.
namespace wholehand::test {

/// WHOLEHAND_SEED; if it is unset, a constant, so that a test run by hand is repeatable.
inline std::uint64_t seed() {
  const char* text = std::getenv("WHOLEHAND_SEED");
  return text != nullptr ? std::strtoull(text, nullptr, 10) : 20251120U;
}

/// A generator from the seed, which is printed so that a failure can be repeated. `stream`
/// separates the draws of different tests: it identifies the test, not the seed.
template <class Random = std::mt19937_64>
Random seededRandom(unsigned stream) {
  std::printf("seed: WHOLEHAND_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  std::seed_seq mixed{static_cast<unsigned>(seed()), static_cast<unsigned>(seed() >> 32U), stream};
  return Random(mixed);
}

inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
}

/// True for nine of ten items of a test under a sanitizer, chosen by the seed. ./check --full tests
/// all of them.
inline bool leftOutUnderASanitizer(std::size_t index) {
  return kReducedCounts && (index + seed()) % 10U != 0;
}

/// All of them; under a sanitizer a tenth by the seed, and at least one.
template <class T>
std::vector<T> sampleTenth(const std::vector<T>& all) {
  std::vector<T> out;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!leftOutUnderASanitizer(i)) out.push_back(all[i]);
  }
  if (out.empty() && !all.empty()) out.push_back(all[seed() % all.size()]);
  return out;
}

/// The numbers first .. last; under a sanitizer one of them, by the seed.
inline std::vector<int> sampleOne(int first, int last) {
  std::vector<int> all(static_cast<std::size_t>(last - first + 1));
  std::iota(all.begin(), all.end(), first);
  if (kReducedCounts) all = {all[seed() % all.size()]};
  return all;
}

/// `count` of the numbers 0 .. size - 1 without repetition, in random order. @pre count <= size
template <class Random>
std::vector<std::size_t> sampleOf(std::size_t size, std::size_t count, Random& random) {
  std::vector<std::size_t> out(size);
  std::iota(out.begin(), out.end(), std::size_t{0});
  for (std::size_t i = 0; i < count; ++i) std::swap(out[i], out[i + random() % (size - i)]);
  out.resize(count);
  return out;
}

}  // namespace wholehand::test
