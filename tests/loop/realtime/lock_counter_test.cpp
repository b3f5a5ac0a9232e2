#include "support/lock_counter.hpp"

#include "loop/realtime/spsc_queue.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <semaphore.h>
#include <shared_mutex>
#include <thread>

namespace wholehand {
namespace {

class LockCounter : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!lockCountingAvailable()) {
      GTEST_SKIP() << "a sanitizer owns the locks";
    }
    before_ = threadLockCalls();
  }
  [[nodiscard]] std::uint64_t locks() const { return threadLockCalls().locks - before_.locks; }
  [[nodiscard]] std::uint64_t waits() const { return threadLockCalls().waits - before_.waits; }
  [[nodiscard]] std::uint64_t wakes() const { return threadLockCalls().wakes - before_.wakes; }

 private:
  LockCalls before_;
};

TEST_F(LockCounter, EveryKindOfLock_IsCountedAndStillLocks) {
  std::timed_mutex mutex;
  mutex.lock();
  EXPECT_EQ(locks(), 1U);
  bool elsewhere = true;
  std::thread other([&] { elsewhere = mutex.try_lock(); });
  const std::uint64_t before_join = locks();  // locks taken by starting the thread
  other.join();
  EXPECT_FALSE(elsewhere) << "it was not locked";
  mutex.unlock();
  ASSERT_TRUE(mutex.try_lock_for(std::chrono::milliseconds(1)));
  EXPECT_EQ(locks(), before_join + 1);
  mutex.unlock();

  std::shared_mutex shared;
  shared.lock_shared();
  EXPECT_EQ(locks(), before_join + 2);
  EXPECT_FALSE(shared.try_lock());
  EXPECT_EQ(locks(), before_join + 3);
  shared.unlock_shared();
  shared.lock();
  EXPECT_EQ(locks(), before_join + 4);
  shared.unlock();

  pthread_spinlock_t spin;
  pthread_spin_init(&spin, PTHREAD_PROCESS_PRIVATE);
  pthread_spin_lock(&spin);
  EXPECT_EQ(locks(), before_join + 5);
  pthread_spin_unlock(&spin);
  pthread_spin_destroy(&spin);
}

TEST_F(LockCounter, WaitsAndWakes_AreCountedAndStillWork) {
  std::mutex mutex;
  std::condition_variable condition;
  std::unique_lock lock(mutex);
  (void)condition.wait_for(lock, std::chrono::milliseconds(1));
  EXPECT_EQ(waits(), 1U);
  condition.notify_one();
  condition.notify_all();
  EXPECT_EQ(wakes(), 2U);

  bool said = false;
  std::thread other([&] {
    const std::lock_guard its(mutex);
    said = true;
    condition.notify_one();
  });
  condition.wait(lock, [&] { return said; });
  EXPECT_GE(waits(), 2U);
  EXPECT_EQ(wakes(), 2U) << "the other thread's";
  lock.unlock();
  other.join();

  const std::uint64_t waits_before = waits();
  sem_t semaphore;
  sem_init(&semaphore, 0, 0);
  sem_post(&semaphore);
  EXPECT_EQ(wakes(), 3U);
  EXPECT_EQ(sem_wait(&semaphore), 0);
  EXPECT_EQ(sem_trywait(&semaphore), -1);
  EXPECT_EQ(waits(), waits_before + 2);
  sem_destroy(&semaphore);
}

TEST_F(LockCounter, Queue_TakesNoLocks) {
  SpscQueue<int> queue(4);
  int out = 0;
  for (int i = 0; i < 10; ++i) {
    (void)queue.try_push(i);
    (void)queue.try_push(i);
    (void)queue.try_pop(out);
  }
  EXPECT_EQ(locks() + waits() + wakes(), 0U);
}

}  // namespace
}  // namespace wholehand
