// Uses Linux's syscall user dispatch: while a selector byte of this thread is set, each of its
// system calls becomes a signal. The signal's handler counts the call, makes it and returns the
// result.
#include "loop/realtime/system_call_counter.hpp"

#include "loop/core/compiler.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#if defined(__linux__) && defined(__x86_64__) && defined(__GLIBC__) && !WHOLEHAND_SANITIZED && \
    defined(PR_SET_SYSCALL_USER_DISPATCH)
#define WHOLEHAND_COUNTS_SYSTEM_CALLS 1
#else
#define WHOLEHAND_COUNTS_SYSTEM_CALLS 0
#endif

namespace wholehand {
namespace {

constexpr std::size_t kNumbers = 512;  // counters, one per system call number

constinit thread_local std::array<std::uint64_t, kNumbers> counts{};
constinit thread_local std::uint64_t total = 0;

#if WHOLEHAND_COUNTS_SYSTEM_CALLS

constinit thread_local bool watched = false;
// Selector byte that the kernel reads at every system call of this thread.
constinit thread_local volatile char selector = SYSCALL_DISPATCH_FILTER_ALLOW;

void onSystemCall(int /*signal*/, siginfo_t* info, void* context) noexcept {
  selector = SYSCALL_DISPATCH_FILTER_ALLOW;
  const int number = info->si_syscall;
  ++total;
  ++counts[number % kNumbers];
  const int errno_before = errno;
  auto& registers = static_cast<ucontext_t*>(context)->uc_mcontext.gregs;
  const long result = syscall(number, registers[REG_RDI], registers[REG_RSI], registers[REG_RDX],
                              registers[REG_R10], registers[REG_R8], registers[REG_R9]);
  registers[REG_RAX] = result == -1 ? -errno : result;
  errno = errno_before;
  selector = SYSCALL_DISPATCH_FILTER_BLOCK;
}

/// Layout of the kernel's sigaction structure, which differs from the C library's.
struct KernelAction {
  void* handler;
  unsigned long flags;
  void* restorer;  ///< return address of a handler; it makes a system call of its own
  unsigned long mask;
};
constexpr std::size_t kRestorer_bytes = 32;  // code from which system calls stay uncounted

#endif

}  // namespace

#if WHOLEHAND_COUNTS_SYSTEM_CALLS

std::string watchSystemCalls() {
  struct sigaction action {};
  action.sa_sigaction = onSystemCall;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGSYS, &action, nullptr);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGSYS);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  KernelAction kept{};
  syscall(SYS_rt_sigaction, SIGSYS, nullptr, &kept, sizeof kept.mask);
  if (prctl(PR_SET_SYSCALL_USER_DISPATCH, PR_SYS_DISPATCH_ON, kept.restorer, kRestorer_bytes,
            &selector) != 0) {
    return std::string("the kernel does not hand them over: ") + std::strerror(errno);
  }
  watched = true;
  return {};
}

void countSystemCalls(bool on) noexcept {
  if (watched) selector = on ? SYSCALL_DISPATCH_FILTER_BLOCK : SYSCALL_DISPATCH_FILTER_ALLOW;
}

#else

std::string watchSystemCalls() {
  return "they are counted on x86-64 Linux only, and not under a sanitizer";
}
void countSystemCalls(bool /*on*/) noexcept {}

#endif

std::uint64_t threadSystemCalls() noexcept {
  return total;
}
std::uint64_t threadSystemCalls(int number) noexcept {
  return number < 0 ? 0 : counts[number % kNumbers];
}

}  // namespace wholehand
