#include "loop/runtime/interrupt_scope.hpp"

#include "loop/realtime/monotonic_clock.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <mutex>
#include <pthread.h>
#include <semaphore.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

Interrupts g_interrupts;
sem_t g_signal;  // posted by every signal and at the end of the outermost scope

// Signals that by default would end or freeze the process while the device holds its last effort.
struct Signal {
  enum class Then { kStop, kStopUnlessHandled, kIgnoreUnlessHandled };
  int number;
  Then then;
};
using enum Signal::Then;
constexpr auto kSignals = std::to_array<Signal>(
    {{SIGINT, kStop},
     {SIGTERM, kStop},
     {SIGHUP, kStop},
     {SIGTSTP, kStop},
     {SIGQUIT, kStop},
     {SIGXCPU, kStopUnlessHandled},
     {SIGUSR1, kStopUnlessHandled},
     {SIGUSR2, kStopUnlessHandled},
     {SIGALRM, kStopUnlessHandled},
     {SIGVTALRM, kStopUnlessHandled},
     {SIGPROF, kStopUnlessHandled},
     {SIGPWR, kStopUnlessHandled},
     {SIGPIPE, kIgnoreUnlessHandled},  // the reader of the output is gone
     {SIGXFSZ, kIgnoreUnlessHandled},  // file size limit: the write fails instead
     {SIGTTOU, kIgnoreUnlessHandled},  // output from the background
     {SIGTTIN, kIgnoreUnlessHandled}});
constexpr int kExitInterrupted = 130;  // status that a shell reports after SIGINT: 128 + 2
// Time for the last message to be written before the process ends.
constexpr std::chrono::milliseconds kReportedWithin{100};
constexpr unsigned kEndedWithin_s = 1;  // the kernel ends the process even if the message hangs
// A loop whose newest tick is older than this hangs.
constexpr std::int64_t kHangs_ns = 200'000'000;
// Time that the third request gives a loop that ticks, and the program's own end.
constexpr std::int64_t kEndsWithin_ns = 2'000'000'000;
constexpr std::chrono::milliseconds kLookEvery{5};

std::array<struct sigaction, kSignals.size()> g_before{};
std::array<bool, kSignals.size()> g_taken{};
sigset_t g_mask_before;
int g_scopes = 0;
std::atomic<bool> g_ending{false};
std::thread g_thread;

std::mutex g_waiting_mutex;
std::vector<std::pair<const WaitingFor*, std::string>> g_waiting;

// Async-signal-safe. Repeated key presses count; repeated timer signals do not.
void onInterrupt(int number) {
  const int saved = errno;
  const bool pressed = std::any_of(kSignals.begin(), kSignals.end(), [&](const Signal& s) {
    return s.number == number && s.then == kStop;
  });
  if (pressed) {
    g_interrupts.asked.fetch_add(1);
  } else {
    int never = 0;
    g_interrupts.asked.compare_exchange_strong(never, 1);
  }
  ::sem_post(&g_signal);
  errno = saved;
}

bool isToBeTaken(const Signal& signal, const struct sigaction& before) {
  if ((before.sa_flags & SA_SIGINFO) != 0) return signal.then == kStop;
  if (before.sa_handler == SIG_IGN) return false;
  return signal.then == kStop || before.sa_handler == SIG_DFL;
}

// Writing may block when nobody reads standard error or its disk hangs. Only this thread then
// waits; it has no other task and receives no signal.
void print(const std::string& line) {
  sigset_t all, before;
  sigfillset(&all);
  sigdelset(&all, SIGALRM);  // ends the process where this hangs: endProcess()
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  try {
    std::thread([text = "wholehand: " + line + "\n"] {
      const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
      (void)ignored;
    }).detach();
  } catch (const std::system_error&) {  // NOLINT(bugprone-empty-catch): no thread available
  }
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

std::string whatIsWaitedFor() {
  const std::lock_guard lock(g_waiting_mutex);
  return g_waiting.empty() ? "the end of what is under way" : g_waiting.back().second;
}

bool loopHangs() {
  return g_interrupts.loops.load() > 0 &&
         monotonicNow_ns() - g_interrupts.ticked_ns.load() > kHangs_ns;
}

// Returns true when the process must be ended; false: the program ends by itself. A loop that ticks
// gets the time to reach neutral.
bool mustBeEnded() {
  if (g_interrupts.loops.load() == 0) return true;
  const std::int64_t until_ns = monotonicNow_ns() + kEndsWithin_ns;
  while (!loopHangs() && monotonicNow_ns() < until_ns) {
    if (g_ending.load()) return false;
    std::this_thread::sleep_for(kLookEvery);
  }
  return !g_ending.load();
}

constexpr const char* kHung =
    "the loop does not answer, and the device may keep its effort. Press the emergency stop on the "
    "device now";

[[noreturn]] void endProcess() {
  // Nothing of the message may keep the process alive: neither memory nor a lock that hangs.
  sigset_t timer;
  sigemptyset(&timer);
  sigaddset(&timer, SIGALRM);
  ::signal(SIGALRM, SIG_DFL);
  ::pthread_sigmask(SIG_UNBLOCK, &timer, nullptr);
  ::alarm(kEndedWithin_s);
  if (g_interrupts.loops.load() > 0) {
    print(std::string("ended, although ") + kHung);
  } else {
    print("ended without waiting for " + whatIsWaitedFor());
  }
  std::this_thread::sleep_for(kReportedWithin);
  ::_exit(kExitInterrupted);
}

void answerAgain(int asked) {
  if (asked >= 3 && mustBeEnded()) endProcess();
  if (asked >= 3) return;
  if (loopHangs()) return print(std::string(kHung) + "; once more ends the program");
  if (g_interrupts.loops.load() > 0) return print("the device is on its way to neutral");
  print("waiting for " + whatIsWaitedFor() + "; once more ends without it");
}

// Reports the signals to the person. The loops check the counter themselves, so a stop does not
// depend on this thread.
void serveSignals() {
  for (int reported = 1;;) {
    while (::sem_wait(&g_signal) != 0) {
    }
    if (g_ending.load()) return;
    const int asked = g_interrupts.asked.load();
    if (asked <= reported) continue;
    reported = asked;
    answerAgain(asked);
  }
}

// Unblocks the signals in a forked child, which has no thread that handles them.
void takeSignalsInChild() {
  if (g_scopes > 0) ::pthread_sigmask(SIG_SETMASK, &g_mask_before, nullptr);
}

void begin() {
  // Never destroyed, because a handler may still post.
  static const int kOnce = ::sem_init(&g_signal, 0, 0);
  static const int kForks = ::pthread_atfork(nullptr, nullptr, takeSignalsInChild);
  (void)kOnce;
  (void)kForks;
  while (::sem_trywait(&g_signal) == 0) {
  }
  g_interrupts.asked.store(0);
  g_ending.store(false);
  sigset_t ours;
  sigemptyset(&ours);
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    const Signal& signal = kSignals[i];
    struct sigaction action {};
    action.sa_handler = signal.then == kIgnoreUnlessHandled ? SIG_IGN : onInterrupt;
    action.sa_flags = SA_RESTART;
    sigaction(signal.number, nullptr, &g_before[i]);
    g_taken[i] = isToBeTaken(signal, g_before[i]);
    if (!g_taken[i]) continue;
    sigaction(signal.number, &action, nullptr);
    if (signal.then != kIgnoreUnlessHandled) sigaddset(&ours, signal.number);
  }
  // Unblocked only in the thread that handles them.
  ::pthread_sigmask(SIG_UNBLOCK, &ours, &g_mask_before);
  g_thread = std::thread(serveSignals);
  ::pthread_setname_np(g_thread.native_handle(), "wholehand-stop");
  ::pthread_sigmask(SIG_BLOCK, &ours, nullptr);
}

void end() {
  g_ending.store(true);
  ::sem_post(&g_signal);
  g_thread.join();
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    if (g_taken[i]) sigaction(kSignals[i].number, &g_before[i], nullptr);
  }
  g_interrupts.asked.store(0);  // a later run without a scope must not be stopped by this scope's
                                // signal
  ::pthread_sigmask(SIG_SETMASK, &g_mask_before, nullptr);
}

}  // namespace

InterruptScope::InterruptScope() {
  if (g_scopes++ == 0) begin();
}

InterruptScope::~InterruptScope() {
  if (--g_scopes == 0) end();
}

Interrupts& InterruptScope::shared() noexcept {
  return g_interrupts;
}

WaitingFor::WaitingFor(std::string what) {
  const std::lock_guard lock(g_waiting_mutex);
  g_waiting.emplace_back(this, std::move(what));
}

WaitingFor::~WaitingFor() {
  const std::lock_guard lock(g_waiting_mutex);
  std::erase_if(g_waiting, [this](const auto& entry) { return entry.first == this; });
}

}  // namespace wholehand
