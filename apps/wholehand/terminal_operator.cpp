#include "terminal_operator.hpp"

#include "commissioning/commissioning.hpp"
#include "core/printable.hpp"
#include "realtime/monotonic_clock.hpp"
#include "runtime/interrupt_scope.hpp"

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <poll.h>
#include <unistd.h>
#include <utility>

namespace wholehand {
namespace {

constexpr int kLook_ms = 5;

// Reads what arrives within that time; empty optional: end of the input.
std::optional<std::string> readWithin(int milliseconds) {
  pollfd in{STDIN_FILENO, POLLIN, 0};
  if (::poll(&in, 1, milliseconds) <= 0) return std::string();
  std::array<char, 256> bytes{};
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return std::string();
  if (count <= 0) return std::nullopt;
  return std::string(bytes.data(), static_cast<std::size_t>(count));
}

std::string trimmed(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return line.substr(first, line.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

TerminalOperator::TerminalOperator() : is_terminal_(::isatty(STDIN_FILENO) == 1) {
  if (is_terminal_) ::tcgetattr(STDIN_FILENO, &former_);
}

TerminalOperator::~TerminalOperator() {
  setRaw(false);
}

void TerminalOperator::setRaw(bool raw) {
  if (!is_terminal_ || raw == raw_) return;
  termios wanted = former_;
  if (raw) wanted.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  ::tcsetattr(STDIN_FILENO, raw ? TCSANOW : TCSAFLUSH, &wanted);
  raw_ = raw;
}

void TerminalOperator::tell(const std::string& line, const std::vector<FoundFigure>&) {
  std::printf("%s\n", printable(line, 1000).c_str());
}

void TerminalOperator::tellStep(const StepNews& news) {
  if (news.what == StepNews::What::kBegins) {
    std::printf("Step %d of %d: %s\n", news.step + 1, kCommissioningSteps,
                stepName(static_cast<CommissioningStep>(news.step)));
  }
  if (news.what == StepNews::What::kFailed) {
    std::fprintf(stderr, "%s\n", format(news.why).c_str());
  }
}

void TerminalOperator::tellMotion(const Motion& motion, MotionState state) {
  if (state == MotionState::kAwaitsKey) {
    std::printf("Hold the space bar: %s.\n", motion.text.c_str());
  }
}

std::optional<std::string> TerminalOperator::ask(const Question& question,
                                                 const std::function<void()>& meanwhile) {
  setRaw(false);
  if (is_terminal_) {
    typed_.clear();
    ::tcflush(STDIN_FILENO, TCIFLUSH);
  }
  std::printf("%s ", question.text.c_str());
  std::fflush(stdout);
  while (!InterruptScope::interrupted()) {
    meanwhile();
    if (const std::size_t end = typed_.find('\n'); end != std::string::npos) {
      const std::string line = trimmed(typed_.substr(0, end));  // the key adds leading spaces
      typed_.erase(0, end + 1);
      return line;
    }
    const auto more = readWithin(kLook_ms);
    if (!more) {
      closed_ = true;
      return std::nullopt;
    }
    typed_ += *more;
  }
  return std::nullopt;
}

bool TerminalOperator::gaveUp() {
  return !is_terminal_ || closed_ || InterruptScope::interrupted();
}

bool TerminalOperator::holdsKey() {
  if (gaveUp()) return false;
  setRaw(true);
  typed_.clear();
  const std::int64_t now_ns = monotonicNow_ns();
  if (now_ns - std::exchange(last_look_ns_, now_ns) > kLookedAway_ns) {
    ::tcflush(STDIN_FILENO, TCIFLUSH);
    // A key that was held before is held again with its next repetition.
    last_space_ns_ = std::exchange(repeats_, false) ? now_ns - kRelease_ns : 0;
  }
  const auto typed = readWithin(0);
  closed_ = !typed;
  if (closed_) return false;
  if (typed->find(' ') != std::string::npos) {
    repeats_ = last_space_ns_ != 0 && now_ns - last_space_ns_ < kFirstRepeat_ns;
    last_space_ns_ = now_ns;
  }
  if (repeats_ && now_ns - last_space_ns_ >= kRelease_ns) {
    repeats_ = false;
    last_space_ns_ = 0;
  }
  return repeats_;
}

RealTicks::RealTicks(double period_s) : period_ns_(std::llround(1e9 * period_s)) {}

std::int64_t RealTicks::now_ns() const {
  return monotonicNow_ns();
}

void RealTicks::waitForTick() {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t now = now_ns();
  next_ns_ = next_ns_ + period_ns_ > now - period_ns_ ? next_ns_ + period_ns_ : now + period_ns_;
  const timespec until{next_ns_ / kSecond_ns, next_ns_ % kSecond_ns};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace wholehand
