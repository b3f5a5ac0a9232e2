// fake_hand: three moteus drives behind a pseudo terminal, as a program with its own clock.
// Prints the port, then a line whenever a drive changes its mode:
//   <ms> drive <id> mode <mode> torque <N.m commanded before> silent <ms since its last command>
//   gap <ms>
// where gap is the longest time that the machine did not run it. Ends when its input does.
#include "pty_adapter.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <poll.h>
#include <sched.h>
#include <unistd.h>

int main() {
  using Clock = std::chrono::steady_clock;
  const sched_param urgent{85};
  (void)::sched_setscheduler(0, SCHED_FIFO,
                             &urgent);  // if the machine permits it; threads inherit it
  wholehand::test::PtyAdapter adapter;
  std::printf("%s\n", adapter.port().c_str());
  std::fflush(stdout);
  std::array<int, 3> mode{}, commands{};
  std::array<double, 3> torque_nm{}, last_ms{};
  const auto begin = Clock::now();
  double now_ms = 0.0, gap_ms = 0.0;
  for (pollfd input{STDIN_FILENO, POLLIN, 0}; ::poll(&input, 1, 0) == 0; ::usleep(200)) {
    const double before_ms = now_ms;
    now_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    gap_ms = std::max(gap_ms, now_ms - before_ms);
    // The machine's delays do not count: commands that arrived while this program was stalled count
    // as in time.
    const double passed_ms = std::min(now_ms - before_ms, 5.0);
    adapter.pass(static_cast<std::int64_t>(passed_ms * 1e6));
    adapter.with([&](auto& drives) {
      for (std::size_t i = 0; i < drives.size(); ++i) {
        if (drives[i].commands != commands[i]) last_ms[i] = now_ms;
        commands[i] = drives[i].commands;
        if (drives[i].mode != mode[i]) {
          std::printf("%.1f drive %d mode %d torque %.4f silent %.1f gap %.1f\n", now_ms,
                      drives[i].id(), drives[i].mode, torque_nm[i], now_ms - last_ms[i], gap_ms);
          std::fflush(stdout);
          mode[i] = drives[i].mode;
        }
        torque_nm[i] = drives[i].torque_nm();
      }
      return 0;
    });
  }
  return 0;
}
