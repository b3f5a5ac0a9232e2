#include "telemetry/crash_guard.hpp"

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

constexpr std::array kSignals{SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL};

std::array<std::atomic<CrashWitness*>, kMostWitnesses> g_witnesses{};
static_assert(std::atomic<CrashWitness*>::is_always_lock_free, "read in a signal handler");
std::atomic<int> g_crashed_thread{0};

std::mutex g_mutex;  // of the two below, outside handlers
int g_guards = 0;
std::array<struct sigaction, kSignals.size()> g_before{};

void restore() noexcept {
  for (std::size_t i = 0; i < kSignals.size(); ++i) ::sigaction(kSignals[i], &g_before[i], nullptr);
}

// The thread that crashed first ends the process; the others see to it that it can.
void waitForTheEnd() noexcept {
  const timespec a_while{0, 10'000'000};
  for (int i = 0; i < 1000; ++i) ::nanosleep(&a_while, nullptr);
}

void onCrash(int signal, siginfo_t* info, void* /*context*/) {
  const int saved = errno;
  int nobody = 0;
  if (g_crashed_thread.compare_exchange_strong(nobody, callingThread())) {
    for (auto& witness : g_witnesses) {
      if (CrashWitness* w = witness.load()) w->crashed(signal);
    }
  } else if (nobody != callingThread()) {
    waitForTheEnd();
  }
  restore();
  // What the processor raised happens again on return, and a core dump shows the place; what was
  // sent does not.
  if (info->si_code <= 0) ::raise(signal);
  errno = saved;
}

void install() {
  struct sigaction action {};
  action.sa_sigaction = onCrash;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigfillset(&action.sa_mask);  // a crash in the handler then ends the process: no loop
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    ::sigaction(kSignals[i], &action, &g_before[i]);
  }
}

}  // namespace

int callingThread() noexcept {
  return static_cast<int>(::syscall(SYS_gettid));
}

CrashGuard::CrashGuard(CrashWitness& witness) {
  const std::lock_guard lock(g_mutex);
  for (int i = 0; i < kMostWitnesses; ++i) {
    CrashWitness* free = nullptr;
    if (!g_witnesses[static_cast<std::size_t>(i)].compare_exchange_strong(free, &witness)) continue;
    slot_ = i;
    if (g_guards++ == 0) install();
    return;
  }
}

CrashGuard::~CrashGuard() {
  if (slot_ < 0) return;
  g_witnesses[static_cast<std::size_t>(slot_)].store(nullptr);
  const int crashed = g_crashed_thread.load();
  if (crashed != 0 && crashed != callingThread()) waitForTheEnd();  // it may still be told
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
