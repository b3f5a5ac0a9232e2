#include "record/crash_guard.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <mutex>
#include <sys/syscall.h>
#include <unistd.h>

namespace wholehand {
namespace {

constexpr std::array kSignals = kCrashSignals;

std::array<std::atomic<CrashHandler*>, kMostWitnesses> g_witnesses{};
static_assert(std::atomic<CrashHandler*>::is_always_lock_free, "read in a signal handler");
std::atomic<int> g_crashed_thread{0};

std::mutex g_mutex;  // guards the next two variables outside handlers
int g_guards = 0;
std::array<struct sigaction, kSignals.size()> g_before{};

void restore() noexcept {
  for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &g_before[i], nullptr);
}

// Waits until the thread that crashed first has ended the process.
void waitForTheEnd() noexcept {
  const timespec a_while{0, 10'000'000};
  for (int i = 0; i < 1000; ++i) ::nanosleep(&a_while, nullptr);
}

void onCrash(int signal, siginfo_t* info, void* /*context*/) {
  const int saved = errno;
  int nobody = 0;
  if (g_crashed_thread.compare_exchange_strong(nobody, callingThread())) {
    for (auto& witness : g_witnesses) {
      if (CrashHandler* w = witness.load()) w->crashed(signal);
    }
  } else if (nobody != callingThread()) {
    waitForTheEnd();
  }
  restore();
  // A processor exception occurs again on return, so that a core dump shows its place. A sent
  // signal, a breakpoint and a refused system call must be raised again.
  if (info->si_code <= 0 || signal == SIGTRAP || signal == SIGSYS) ::raise(signal);
  errno = saved;
}

void install() {
  struct sigaction action {};
  action.sa_sigaction = onCrash;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigfillset(&action.sa_mask);  // a crash in the handler ends the process instead of recursing
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals[i], nullptr, &g_before[i]);
    // An existing SIGSYS handler counts system calls (system_call_counter.hpp) and is kept: SIGSYS
    // is then not a crash.
    if (kSignals[i] == SIGSYS && g_before[i].sa_handler != SIG_DFL) continue;
    ::sigaction(kSignals[i], &action, nullptr);
  }
}

}  // namespace

int callingThread() noexcept {
  return static_cast<int>(::syscall(SYS_gettid));
}

CrashGuard::CrashGuard(CrashHandler& witness) {
  const std::lock_guard lock(g_mutex);
  for (int i = 0; i < kMostWitnesses; ++i) {
    CrashHandler* free = nullptr;
    if (!g_witnesses[i].compare_exchange_strong(free, &witness)) continue;
    slot_ = i;
    if (g_guards++ == 0) install();
    return;
  }
}

CrashGuard::~CrashGuard() {
  if (slot_ < 0) return;
  g_witnesses[slot_].store(nullptr);
  const int crashed = g_crashed_thread.load();
  if (crashed != 0 && crashed != callingThread()) waitForTheEnd();  // the witness is in use
  const std::lock_guard lock(g_mutex);
  if (--g_guards == 0) restore();
}

void useSignalStack(void* memory) noexcept {
  stack_t now{};
  if (::sigaltstack(nullptr, &now) != 0 || (now.ss_flags & SS_DISABLE) == 0) return;
  stack_t ours{};
  ours.ss_sp = memory;
  ours.ss_size = kSignalStackBytes;
  ::sigaltstack(&ours, nullptr);
}

void leaveSignalStack(void* memory) noexcept {
  stack_t now{};
  if (::sigaltstack(nullptr, &now) != 0 || now.ss_sp != memory) return;
  stack_t none{};
  none.ss_flags = SS_DISABLE;
  ::sigaltstack(&none, nullptr);
}

}  // namespace wholehand
