#include "devices/host/newest_value.hpp"

#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <memory>
#include <new>
#include <random>
#include <sys/mman.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace wholehand::test {
namespace {

struct Whole {
  std::uint64_t number;
  std::uint64_t copies[40];
};

Whole wholeOf(std::uint64_t number) {
  Whole value{};
  value.number = number;
  for (std::uint64_t& copy : value.copies) copy = number;
  return value;
}

bool isWhole(const Whole& value) {
  for (const std::uint64_t copy : value.copies) {
    if (copy != value.number) return false;
  }
  return true;
}

TEST(NewestValue, ValueBeforeTheFirstWrite_IsAbsent) {
  const auto slot = std::make_unique<NewestValue<Whole>>();
  Whole value = wholeOf(9);
  EXPECT_FALSE(slot->take(value));
  EXPECT_EQ(value.number, 9U) << "untouched";
  slot->publish(wholeOf(1));
  slot->publish(wholeOf(2));
  ASSERT_TRUE(slot->take(value));
  EXPECT_EQ(value.number, 2U) << "the newest, not the next";
  ASSERT_TRUE(slot->take(value));
  EXPECT_EQ(value.number, 2U) << "taken twice";
}

TEST(NewestValue, ReadsBesideAFastWriter_AreWholeAndNeverOlder) {
  const auto slot = std::make_unique<NewestValue<Whole>>();
  std::atomic<bool> end{false};
  std::thread writer([&] {
    for (std::uint64_t n = 1; !end.load(); ++n) slot->publish(wholeOf(n));
  });
  std::uint64_t last = 0;
  int taken = 0;
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(300);
  while (taken < 20'000 && std::chrono::steady_clock::now() < until) {
    Whole value{};
    if (!slot->take(value)) continue;
    ++taken;
    ASSERT_TRUE(isWhole(value));
    ASSERT_GE(value.number, last);
    last = value.number;
  }
  end.store(true);
  writer.join();
  EXPECT_GT(taken, 100);
  EXPECT_GT(last, 100U);
}

// A loop may be killed in the middle of writing a command.
TEST(NewestValue, WriterKilledAnywhere_LeavesAWholeValue) {
  using Slot = NewestValue<Whole>;
  auto random = seededRandom(902);
  for (int trial = 0; trial < 50; ++trial) {
    void* const memory =
        ::mmap(nullptr, sizeof(Slot), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(memory, MAP_FAILED);
    Slot* const slot = new (memory) Slot;
    const pid_t writer = ::fork();
    ASSERT_GE(writer, 0);
    if (writer == 0) {
      for (std::uint64_t n = 1;; ++n) slot->publish(wholeOf(n));
    }
    Whole value{};
    while (!slot->take(value)) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 2000));
    ::kill(writer, SIGKILL);
    ::waitpid(writer, nullptr, 0);
    ASSERT_TRUE(slot->take(value)) << "nothing retries for ever";
    EXPECT_TRUE(isWhole(value));
    ::munmap(memory, sizeof(Slot));
  }
}

}  // namespace
}  // namespace wholehand::test
