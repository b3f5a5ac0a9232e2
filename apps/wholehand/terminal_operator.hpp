#pragma once

#include "commissioning/operator.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <termios.h>
#include <vector>

namespace wholehand {

/// The operator at this terminal. The hold-to-move key is the space bar. A terminal reports no key
/// release, but a held key repeats: it counts as held from its first repetition on, and as released
/// after kRelease_ns without one. Ctrl-C releases and cancels; needs an InterruptScope.
/// At a terminal, a question accepts only what is typed after it is shown; from a pipe, also
/// earlier input.
class TerminalOperator final : public Operator {
 public:
  static constexpr std::int64_t kFirstRepeat_ns = 700'000'000;
  static constexpr std::int64_t kRelease_ns = 120'000'000;
  /// After a longer pause between two polls, the age of waiting input is unknown.
  static constexpr std::int64_t kLookedAway_ns = 100'000'000;

  TerminalOperator();
  ~TerminalOperator() override;
  TerminalOperator(const TerminalOperator&) = delete;
  TerminalOperator& operator=(const TerminalOperator&) = delete;

  void tell(const std::string& line, const std::vector<FoundFigure>& findings) override;
  void tellStep(const StepNews& news) override;
  void tellMotion(const Motion& motion, MotionState state) override;
  [[nodiscard]] std::optional<std::string> ask(const Question& question,
                                               const std::function<void()>& meanwhile) override;
  [[nodiscard]] bool holdsKey() override;
  [[nodiscard]] bool gaveUp() override;

 private:
  void setRaw(bool raw);
  termios former_{};
  std::string typed_;  ///< input not yet used as an answer
  bool is_terminal_ = false, raw_ = false, repeats_ = false, closed_ = false;
  std::int64_t last_space_ns_ = 0, last_look_ns_ = 0;
};

/// Ticks 1,000 times a second by CLOCK_MONOTONIC. After a missed tick the next one follows at once.
class RealTicks final : public TickClock {
 public:
  explicit RealTicks(double period_s);
  void waitForTick() override;
  [[nodiscard]] std::int64_t now_ns() const override;

 private:
  std::int64_t period_ns_, next_ns_ = 0;
};

}  // namespace wholehand
