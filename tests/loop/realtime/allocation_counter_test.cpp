#include "loop/realtime/allocation_counter.hpp"

#include "loop/realtime/spsc_queue.hpp"
#include "loop/realtime/stage_clock.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

namespace wholehand {
namespace {

/// Keeps the optimiser from removing an allocation whose result is unused.
void use(void* p) {
  asm volatile("" : : "g"(p) : "memory");
}

class AllocationCounter : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!allocationCountingAvailable()) {
      GTEST_SKIP() << "a sanitizer owns malloc";
    }
  }
};

TEST_F(AllocationCounter, EveryKindOfAllocation_IsCounted) {
  const AllocationScope scope;
  void* a = std::malloc(10);
  use(a);
  EXPECT_EQ(scope.allocations(), 1U);
  void* b = std::calloc(2, 10);
  use(b);
  EXPECT_EQ(scope.allocations(), 2U);
  b = std::realloc(b, 4000);
  use(b);
  EXPECT_EQ(scope.allocations(), 3U);
  void* c = std::aligned_alloc(64, 128);
  use(c);
  EXPECT_EQ(scope.allocations(), 4U);
  void* d = nullptr;
  ASSERT_EQ(posix_memalign(&d, 64, 100), 0);
  EXPECT_EQ(scope.allocations(), 5U);
  auto e = std::make_unique<int>(3);
  use(e.get());
  EXPECT_EQ(scope.allocations(), 6U);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(c) % 64, 0U);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(d) % 64, 0U);
  for (void* p : {a, b, c, d}) {
    std::free(p);
  }
  EXPECT_EQ(scope.releases(), 4U);
}

TEST_F(AllocationCounter, OtherThreads_AreNotCounted) {
  bool go = false;
  std::vector<int> grown;
  std::thread other([&] {
    grown.resize(1000);
    go = true;
  });
  const AllocationScope scope;  // the thread object itself was made before
  other.join();
  EXPECT_TRUE(go);
  EXPECT_EQ(scope.allocations(), 0U);
}

TEST_F(AllocationCounter, QueueAndStageClock_DoNotAllocateInUse) {
  RecordQueue queue(0);
  StageClock clock;
  TickRecord record;
  bool all = true;
  const AllocationScope scope;
  for (int i = 0; i < 100; ++i) {
    clock.start();
    all = queue.try_push(record) && all;
    clock.lap(Stage::kDeviceRead);
    all = queue.try_pop(record) && all;
    record.stage_cpu_ns = clock.finish().stage_cpu_ns;
  }
  EXPECT_EQ(scope.allocations(), 0U);
  EXPECT_EQ(scope.releases(), 0U);
  EXPECT_TRUE(all);
}

}  // namespace
}  // namespace wholehand
