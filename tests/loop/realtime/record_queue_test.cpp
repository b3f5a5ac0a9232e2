#include "loop/core/tick_digest.hpp"
#include "loop/realtime/spsc_queue.hpp"
#include "record/synthetic_recording.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <thread>

namespace wholehand {
namespace {

// Compared with a queue of the standard library: for any lengths, each tick comes out once, in
// order and complete, except those counted as dropped.
TEST(RecordQueue, RandomPushesAndPops_GiveTheTicksInOrder) {
  std::mt19937_64 random(test::seed());
  for (int run = 0; run < test::cases(40); ++run) {
    RecordQueue queue(random() % 200'000);
    std::deque<std::uint64_t> expected;
    std::uint64_t dropped = 0;
    TickRecord out;
    for (std::uint64_t tick = 0; tick < 400; ++tick) {
      const TickRecord in = synthetic::noisy(tick, random);
      if (queue.try_push(in)) {
        expected.push_back(digestOf(in));
      } else {
        ++dropped;
      }
      ASSERT_EQ(queue.size(), expected.size());
      ASSERT_EQ(queue.dropped(), dropped);
      for (auto n = random() % (tick % 100 < 60 ? 2 : 4); n > 0 && !expected.empty(); --n) {
        ASSERT_TRUE(queue.try_pop(out));
        ASSERT_EQ(digestOf(out), expected.front());
        expected.pop_front();
      }
    }
    for (; !expected.empty(); expected.pop_front()) {
      ASSERT_TRUE(queue.try_pop(out));
      ASSERT_EQ(digestOf(out), expected.front());
    }
    EXPECT_FALSE(queue.try_pop(out));
  }
}

// The largest record fits twice for any requested size and any position of the ring.
TEST(RecordQueue, LargestTick_FitsAfterAnyOther) {
  TickRecord largest;
  largest.body_count = kMaxBodies;
  largest.contact_count = kMaxContacts;
  largest.contacts.back().distance_m = -0.25;
  std::mt19937_64 random(test::seed());
  RecordQueue queue(0);
  TickRecord out;
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(queue.try_push(synthetic::noisy(i, random)));
    ASSERT_TRUE(queue.try_pop(out));
    ASSERT_TRUE(queue.try_push(largest));
    ASSERT_TRUE(queue.try_pop(out));
    EXPECT_EQ(digestOf(out), digestOf(largest));
  }
}

// Also run under ThreadSanitizer, which checks the memory order.
TEST(RecordQueue, TwoThreads_LoseOnlyWhatIsCounted) {
  const std::uint64_t ticks = test::kReducedCounts ? 2'000 : 20'000;
  RecordQueue queue(100'000);
  std::uint64_t accepted = 0;
  std::thread producer([&] {
    std::mt19937_64 random(1);
    TickRecord record = synthetic::noisy(1, random);
    for (record.tick = 1; record.tick <= ticks;) {
      record.contact_count = static_cast<std::int32_t>(record.tick % 9);
      record.time_s = static_cast<double>(record.tick);
      record.authority = record.time_s;  // near the end of the record
      if (queue.try_push(record)) {
        ++accepted;
        ++record.tick;
      } else {
        std::this_thread::yield();
        record.tick += record.tick < ticks ? 1 : 0;  // the last record is offered until it fits
      }
    }
  });
  std::uint64_t received = 0, last = 0;
  bool whole = true, ordered = true;
  TickRecord out;
  while (last != ticks) {
    if (!queue.try_pop(out)) {
      std::this_thread::yield();
      continue;
    }
    ++received;
    ordered = ordered && out.tick > last;
    last = out.tick;
    whole = whole && out.time_s == static_cast<double>(last) && out.authority == out.time_s &&
            out.contact_count == static_cast<std::int32_t>(last % 9);
  }
  producer.join();
  EXPECT_TRUE(whole);
  EXPECT_TRUE(ordered);
  EXPECT_EQ(received, accepted);
}

}  // namespace
}  // namespace wholehand
