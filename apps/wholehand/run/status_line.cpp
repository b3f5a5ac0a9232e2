#include "apps/wholehand/run/status_line.hpp"

#include "loop/core/printable.hpp"
#include "loop/realtime/monotonic_clock.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <poll.h>
#include <unistd.h>

namespace wholehand {
namespace {

constexpr double kTerminalPeriod_s = 0.2;
constexpr double kLogPeriod_s = 5.0;
constexpr std::size_t kLongestMessage = 1000;
constexpr double kFirst_s = 0.5;  // time of the run before which rate and percentiles are
                                  // meaningless

constexpr int kPatience_ms = 1000;  // for a slow reader

// True when a write would not block. It blocks on a stopped terminal (Ctrl-S) or a full pipe.
bool takesOutput(int wait_ms = 0) {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return ::poll(&out, 1, wait_ms) == 1 && (out.revents & POLLOUT) != 0;
}

}  // namespace

std::string largestEffort(const DeviceModel& device, const AxisEffort& effort) {
  int largest = -1;
  double share = 0.0;
  for (int a = 0; a < effort.size(); ++a) {
    const double s = std::abs(effort[a]) / device.axes[a].effort_limit;
    if (s > share) {
      share = s;
      largest = a;
    }
  }
  if (largest < 0) return "none";
  const DeviceAxis& axis = device.axes[largest];
  if (axis.lever_arm_m > 0.0) {
    return fmt::format("{} {:.2f} N at the tip", axis.name,
                       std::abs(effort[largest]) / axis.lever_arm_m);
  }
  return fmt::format("{} {:.2f} {}", axis.name, std::abs(effort[largest]), axis.effortUnit());
}

StatusLine::StatusLine(const DeviceModel& device)
    : device_(device), terminal_(isatty(STDOUT_FILENO) == 1) {}

std::string StatusLine::text(const TickSummary& s, double rate_hz) const {
  return fmt::format(
      "{:7.2f} s  {:5.0f} Hz  tick {:.0f}/{:.0f}/{:.0f} µs  missed {}  {} contact{}  largest "
      "force {}",
      s.time_s, rate_hz, s.cpu.p50_ns / 1e3, s.cpu.p99_ns / 1e3, s.cpu.p999_ns / 1e3,
      s.missed_deadlines, s.contacts, plural(s.contacts), largestEffort(device_, s.max_effort));
}

void StatusLine::update(const TickSummary& summary, double rate_hz) {
  if (summary.time_s < last_run_s_) next_run_s_ = 0.0;  // a new session began
  last_run_s_ = summary.time_s;
  if (summary.time_s < kFirst_s) return;
  const double now_s = static_cast<double>(monotonicNow_ns()) * 1e-9;
  if (terminal_) {
    if (now_s < next_wall_s_) return;
    next_wall_s_ = now_s + kTerminalPeriod_s;
    std::printf("\r\033[K%s", text(summary, rate_hz).c_str());
  } else {
    if (summary.time_s < next_run_s_) return;
    next_run_s_ = summary.time_s + kLogPeriod_s;
    std::printf("%s\n", text(summary, rate_hz).c_str());
  }
  drawn_ = true;
  std::fflush(stdout);
}

void StatusLine::finish() {
  if (terminal_ && drawn_) std::printf("\n");
  drawn_ = false;
}

void Terminal::begin(const DeviceModel& device) {
  const std::lock_guard lock(mutex_);
  line_ = std::make_unique<StatusLine>(device);
}

void Terminal::end() {
  const std::lock_guard lock(mutex_);
  if (line_ && takesOutput()) line_->finish();
  line_.reset();
}

void Terminal::print(const std::string& text) {
  (void)takesOutput(kPatience_ms);
  const std::lock_guard lock(mutex_);
  // A blocking write would hold this mutex, and delay the end of every session.
  if (!takesOutput()) {
    ++unread_;
    return;
  }
  if (line_) line_->finish();
  if (unread_ > 0) std::printf("  %d lines are left out: nobody read them\n", unread_);
  unread_ = 0;
  std::printf("  %s\n", printable(text, kLongestMessage).c_str());
}

void Terminal::update(const TickSummary& now, double rate_hz) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock && line_ && takesOutput()) line_->update(now, rate_hz);
}

}  // namespace wholehand
