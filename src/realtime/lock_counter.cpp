// Linking this file puts counting functions in front of the C library's lock functions. For
// programs that measure and for tests; the library itself does not link it.
#include "realtime/lock_counter.hpp"

#include "core/sanitized.hpp"

#include <atomic>
#include <cstdlib>
#include <dlfcn.h>
#include <pthread.h>
#include <semaphore.h>

#if defined(__GLIBC__) && !WHOLEHAND_SANITIZED
#define WHOLEHAND_COUNTS_LOCKS 1
#else
#define WHOLEHAND_COUNTS_LOCKS 0
#endif

namespace wholehand {
namespace {

// constinit: locks are taken before any initialiser runs.
constinit thread_local LockCalls calls;

#if WHOLEHAND_COUNTS_LOCKS

/// The C library's own function, looked up at the first call. Concurrent look-ups find the same
/// function.
template <class... Arguments>
class Original {
 public:
  /// @param version of the symbol, if it has more than one; a machine that never had the old one
  /// has no such version
  constexpr explicit Original(const char* name, const char* version = nullptr)
      : name_(name), version_(version) {}
  int operator()(Arguments... arguments) {
    void* found = found_.load(std::memory_order_relaxed);
    if (found == nullptr) {
      if (version_ != nullptr) found = dlvsym(RTLD_NEXT, name_, version_);
      if (found == nullptr) found = dlsym(RTLD_NEXT, name_);
      if (found == nullptr) std::abort();
      found_.store(found, std::memory_order_relaxed);
    }
    return reinterpret_cast<int (*)(Arguments...)>(found)(arguments...);
  }

 private:
  const char* name_;
  const char* version_;
  std::atomic<void*> found_{nullptr};
};

// Symbol version since which condition variables have today's layout.
constexpr const char* kNewConditions = "GLIBC_2.3.2";

#endif

}  // namespace

bool lockCountingAvailable() noexcept {
  return WHOLEHAND_COUNTS_LOCKS != 0;
}
LockCalls threadLockCalls() noexcept {
  return calls;
}

#if WHOLEHAND_COUNTS_LOCKS

// The names are the C library's.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" {
int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static constinit Original<pthread_mutex_t*> original{"pthread_mutex_lock"};
  ++calls.locks;
  return original(mutex);
}
int pthread_mutex_trylock(pthread_mutex_t* mutex) {
  static constinit Original<pthread_mutex_t*> original{"pthread_mutex_trylock"};
  ++calls.locks;
  return original(mutex);
}
int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* abstime) {
  static constinit Original<pthread_mutex_t*, const timespec*> original{"pthread_mutex_timedlock"};
  ++calls.locks;
  return original(mutex, abstime);
}
int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clockid, const timespec* abstime) {
  static constinit Original<pthread_mutex_t*, clockid_t, const timespec*> original{
      "pthread_mutex_clocklock"};
  ++calls.locks;
  return original(mutex, clockid, abstime);
}
int pthread_spin_lock(pthread_spinlock_t* lock) {
  static constinit Original<pthread_spinlock_t*> original{"pthread_spin_lock"};
  ++calls.locks;
  return original(lock);
}
int pthread_spin_trylock(pthread_spinlock_t* lock) {
  static constinit Original<pthread_spinlock_t*> original{"pthread_spin_trylock"};
  ++calls.locks;
  return original(lock);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* rwlock) {
  static constinit Original<pthread_rwlock_t*> original{"pthread_rwlock_rdlock"};
  ++calls.locks;
  return original(rwlock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* rwlock) {
  static constinit Original<pthread_rwlock_t*> original{"pthread_rwlock_wrlock"};
  ++calls.locks;
  return original(rwlock);
}
int pthread_rwlock_tryrdlock(pthread_rwlock_t* rwlock) {
  static constinit Original<pthread_rwlock_t*> original{"pthread_rwlock_tryrdlock"};
  ++calls.locks;
  return original(rwlock);
}
int pthread_rwlock_trywrlock(pthread_rwlock_t* rwlock) {
  static constinit Original<pthread_rwlock_t*> original{"pthread_rwlock_trywrlock"};
  ++calls.locks;
  return original(rwlock);
}
int pthread_rwlock_timedrdlock(pthread_rwlock_t* rwlock, const timespec* abstime) {
  static constinit Original<pthread_rwlock_t*, const timespec*> original{
      "pthread_rwlock_timedrdlock"};
  ++calls.locks;
  return original(rwlock, abstime);
}
int pthread_rwlock_timedwrlock(pthread_rwlock_t* rwlock, const timespec* abstime) {
  static constinit Original<pthread_rwlock_t*, const timespec*> original{
      "pthread_rwlock_timedwrlock"};
  ++calls.locks;
  return original(rwlock, abstime);
}
int pthread_cond_wait(pthread_cond_t* cond, pthread_mutex_t* mutex) {
  static constinit Original<pthread_cond_t*, pthread_mutex_t*> original{"pthread_cond_wait",
                                                                        kNewConditions};
  ++calls.waits;
  return original(cond, mutex);
}
int pthread_cond_timedwait(pthread_cond_t* cond, pthread_mutex_t* mutex, const timespec* abstime) {
  static constinit Original<pthread_cond_t*, pthread_mutex_t*, const timespec*> original{
      "pthread_cond_timedwait", kNewConditions};
  ++calls.waits;
  return original(cond, mutex, abstime);
}
int pthread_cond_clockwait(pthread_cond_t* cond, pthread_mutex_t* mutex, clockid_t clock_id,
                           const timespec* abstime) {
  static constinit Original<pthread_cond_t*, pthread_mutex_t*, clockid_t, const timespec*> original{
      "pthread_cond_clockwait"};
  ++calls.waits;
  return original(cond, mutex, clock_id, abstime);
}
int sem_wait(sem_t* sem) {
  static constinit Original<sem_t*> original{"sem_wait"};
  ++calls.waits;
  return original(sem);
}
int sem_trywait(sem_t* sem) {
  static constinit Original<sem_t*> original{"sem_trywait"};
  ++calls.waits;
  return original(sem);
}
int sem_timedwait(sem_t* sem, const timespec* abstime) {
  static constinit Original<sem_t*, const timespec*> original{"sem_timedwait"};
  ++calls.waits;
  return original(sem, abstime);
}
int pthread_cond_signal(pthread_cond_t* cond) {
  static constinit Original<pthread_cond_t*> original{"pthread_cond_signal", kNewConditions};
  ++calls.wakes;
  return original(cond);
}
int pthread_cond_broadcast(pthread_cond_t* cond) {
  static constinit Original<pthread_cond_t*> original{"pthread_cond_broadcast", kNewConditions};
  ++calls.wakes;
  return original(cond);
}
int sem_post(sem_t* sem) {
  static constinit Original<sem_t*> original{"sem_post"};
  ++calls.wakes;
  return original(sem);
}
}
// NOLINTEND(readability-identifier-naming)

#endif

}  // namespace wholehand
