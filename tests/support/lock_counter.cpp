// Linking this file puts counting functions in front of the C library's lock functions. For
// programs that measure and for tests; the library itself does not link it.
#include "support/lock_counter.hpp"

#include "loop/core/compiler.hpp"

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
  /// @param version of the symbol if it has more than one, else null; a machine that never had the
  /// old version does not have that symbol
  constexpr Original(const char* name, const char* version) : name_(name), version_(version) {}
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

// Counts a call of the C library's function of that name, then calls it.
// NOLINTBEGIN(readability-identifier-naming,bugprone-macro-parentheses)
#define WHOLEHAND_COUNTED_1(kind, name, version, A)        \
  int name(A a) {                                          \
    static constinit Original<A> original{#name, version}; \
    ++calls.kind;                                          \
    return original(a);                                    \
  }
#define WHOLEHAND_COUNTED_2(kind, name, version, A, B)        \
  int name(A a, B b) {                                        \
    static constinit Original<A, B> original{#name, version}; \
    ++calls.kind;                                             \
    return original(a, b);                                    \
  }
#define WHOLEHAND_COUNTED_3(kind, name, version, A, B, C)        \
  int name(A a, B b, C c) {                                      \
    static constinit Original<A, B, C> original{#name, version}; \
    ++calls.kind;                                                \
    return original(a, b, c);                                    \
  }
#define WHOLEHAND_COUNTED_4(kind, name, version, A, B, C, D)        \
  int name(A a, B b, C c, D d) {                                    \
    static constinit Original<A, B, C, D> original{#name, version}; \
    ++calls.kind;                                                   \
    return original(a, b, c, d);                                    \
  }
using Mutex = pthread_mutex_t*;
using SpinLock = pthread_spinlock_t*;
using RwLock = pthread_rwlock_t*;
using Condition = pthread_cond_t*;
using Until = const timespec*;
extern "C" {
WHOLEHAND_COUNTED_1(locks, pthread_mutex_lock, nullptr, Mutex)
WHOLEHAND_COUNTED_1(locks, pthread_mutex_trylock, nullptr, Mutex)
WHOLEHAND_COUNTED_2(locks, pthread_mutex_timedlock, nullptr, Mutex, Until)
WHOLEHAND_COUNTED_3(locks, pthread_mutex_clocklock, nullptr, Mutex, clockid_t, Until)
WHOLEHAND_COUNTED_1(locks, pthread_spin_lock, nullptr, SpinLock)
WHOLEHAND_COUNTED_1(locks, pthread_spin_trylock, nullptr, SpinLock)
WHOLEHAND_COUNTED_1(locks, pthread_rwlock_rdlock, nullptr, RwLock)
WHOLEHAND_COUNTED_1(locks, pthread_rwlock_wrlock, nullptr, RwLock)
WHOLEHAND_COUNTED_1(locks, pthread_rwlock_tryrdlock, nullptr, RwLock)
WHOLEHAND_COUNTED_1(locks, pthread_rwlock_trywrlock, nullptr, RwLock)
WHOLEHAND_COUNTED_2(locks, pthread_rwlock_timedrdlock, nullptr, RwLock, Until)
WHOLEHAND_COUNTED_2(locks, pthread_rwlock_timedwrlock, nullptr, RwLock, Until)
WHOLEHAND_COUNTED_2(waits, pthread_cond_wait, kNewConditions, Condition, Mutex)
WHOLEHAND_COUNTED_3(waits, pthread_cond_timedwait, kNewConditions, Condition, Mutex, Until)
WHOLEHAND_COUNTED_4(waits, pthread_cond_clockwait, nullptr, Condition, Mutex, clockid_t, Until)
WHOLEHAND_COUNTED_1(waits, sem_wait, nullptr, sem_t*)
WHOLEHAND_COUNTED_1(waits, sem_trywait, nullptr, sem_t*)
WHOLEHAND_COUNTED_2(waits, sem_timedwait, nullptr, sem_t*, Until)
WHOLEHAND_COUNTED_1(wakes, pthread_cond_signal, kNewConditions, Condition)
WHOLEHAND_COUNTED_1(wakes, pthread_cond_broadcast, kNewConditions, Condition)
WHOLEHAND_COUNTED_1(wakes, sem_post, nullptr, sem_t*)
}
// NOLINTEND(readability-identifier-naming,bugprone-macro-parentheses)

#endif

}  // namespace wholehand
