#pragma once

#include <atomic>

/// Settings of watched_main.cpp, the main() of programs with real-time tests.
namespace wholehand::test {

inline std::atomic<bool> g_sees_real_time{false};

/// Called at the start by anything on the real clock: a loop, a host, a client that must show that
/// it is alive. From then on a failure of this test may be caused by the machine. Failures of other
/// tests are never excused.
inline void seesRealTime() {
  g_sees_real_time = true;
}

inline std::atomic<bool> g_sees_terminal{false};

/// The same for anything that uses a terminal: a kernel thread carries its bytes and may wait
/// although every sleeper wakes in time. One sleeper passes a byte over a terminal each time.
inline void seesTerminal() {
  g_sees_terminal = true;
  seesRealTime();
}

/// Start of the message of a failure that no machine excuses: EXPECT_LE(force_n, limit_n) <<
/// kAlways. For rules that hold however late a thread is: effort limits, no effort after a stop.
inline constexpr const char* kAlways = "(whatever the machine does) ";

/// A machine that keeps a sleeper waiting longer than this has not let the test run. The shortest
/// time that a test measures is 10 ms (an exchange between two processes), and an idle machine
/// wakes a sleeper within 2 ms.
inline constexpr double kKeptWaiting_ms = 5.0;

}  // namespace wholehand::test
