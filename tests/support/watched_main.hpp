#pragma once

#include <atomic>

/// What watched_main.cpp, the main() of programs whose tests see real time, goes by.
namespace wholehand::test {

inline std::atomic<bool> g_sees_real_time{false};

/// Said by what runs on the real clock, when it begins: a loop, a host, a client that must show
/// that it is alive. From then on a failure of this test may be the machine's. Failures of other
/// tests are never excused.
inline void seesRealTime() {
  g_sees_real_time = true;
}

inline std::atomic<bool> g_sees_terminal{false};

/// The same, by what speaks over a terminal: a thread of the kernel carries its bytes, and may wait
/// where every sleeper wakes in time. One sleeper passes a byte over a terminal each time.
inline void seesTerminal() {
  g_sees_terminal = true;
  seesRealTime();
}

/// Begins the message of a failure that no machine excuses: EXPECT_LE(force_n, limit_n) << kAlways.
/// For what holds however late anybody is: limits of effort, nothing sent after a stop.
inline constexpr const char* kAlways = "(whatever the machine does) ";

/// A machine that keeps a sleeper waiting for longer has not let the test run. The shortest time
/// that a test counts is 10 ms (an exchange of two processes), and an idle machine wakes a sleeper
/// within 2 ms.
inline constexpr double kKeptWaiting_ms = 5.0;

}  // namespace wholehand::test
