#include "loop/realtime/spsc_queue.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace wholehand {
namespace {

struct Numbered {
  std::uint64_t number = 0;
  std::array<std::uint64_t, 15> copies{};
};

Numbered numbered(std::uint64_t n) {
  Numbered r;
  r.number = n;
  r.copies.fill(n);
  return r;
}

TEST(SpscQueue, FilledAndEmptied_GivesTheRecordsInOrder) {
  SpscQueue<int> queue(4);
  for (int round = 0; round < 5; ++round) {  // the indices wrap around the ring
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(queue.try_push(10 * round + i));
    }
    for (int i = 0; i < 3; ++i) {
      int out = -1;
      ASSERT_TRUE(queue.try_pop(out));
      EXPECT_EQ(out, 10 * round + i);
    }
  }
}

TEST(SpscQueue, FullQueue_RefusesCountsAndKeepsTheOldest) {
  SpscQueue<int> queue(3);
  ASSERT_EQ(queue.capacity(), 4U);  // the next power of two
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(queue.try_push(i));
  }
  EXPECT_FALSE(queue.try_push(4));
  EXPECT_FALSE(queue.try_push(5));
  EXPECT_EQ(queue.dropped(), 2U);
  EXPECT_EQ(queue.size(), 4U);
  int out = -1;
  ASSERT_TRUE(queue.try_pop(out));
  EXPECT_EQ(out, 0);
  EXPECT_TRUE(queue.try_push(6));
}

TEST(SpscQueue, EmptyQueue_PopsNothingAndKeepsTheOutput) {
  SpscQueue<int> queue(2);
  int out = 42;
  EXPECT_FALSE(queue.try_pop(out));
  EXPECT_EQ(out, 42);
}

// Also run under ThreadSanitizer, which checks the memory order.
TEST(SpscQueue, TwoThreads_LoseOnlyWhatIsCounted) {
  constexpr std::uint64_t kRecords = 200'000;
  SpscQueue<Numbered> queue(64);
  std::uint64_t accepted = 0;
  std::uint64_t refused = 0;
  std::thread producer([&] {
    // The last record is offered until it fits, so that the consumer knows the end.
    for (std::uint64_t n = 1; n <= kRecords;) {
      const bool fits = queue.try_push(numbered(n));
      (fits ? accepted : refused) += 1;
      n += fits || n < kRecords ? 1 : 0;
      if (!fits) {
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t received = 0;
  std::uint64_t last = 0;
  bool torn = false;
  bool disordered = false;
  while (last != kRecords) {
    Numbered r;
    if (!queue.try_pop(r)) {
      std::this_thread::yield();
      continue;
    }
    ++received;
    disordered = disordered || r.number <= last;
    last = r.number;
    for (const std::uint64_t copy : r.copies) {
      torn = torn || copy != r.number;
    }
  }
  producer.join();
  EXPECT_FALSE(torn);
  EXPECT_FALSE(disordered);
  EXPECT_EQ(queue.dropped(), refused);
  EXPECT_EQ(received, accepted);
}

}  // namespace
}  // namespace wholehand
