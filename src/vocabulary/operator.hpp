#pragma once

#include "loop/core/expected.hpp"
#include "schema_enums.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// A question to the person. A terminal prints the text; a page uses its own words and language.
struct Question {
  QuestionKind about = QuestionKind::kNextStep;
  std::string text;  ///< in English, with the answers that a terminal accepts
  std::string axis, unit;
  double lower = 0.0, upper = 0.0;  ///< plausible range in `unit`; both 0: unknown
};

/// A measured figure to show to people. It belongs to one axis or, without an axis, to the device.
struct FoundFigure {
  std::string axis;
  std::string quantity;  ///< "mass", "delay", "travel", ...
  std::string unit;
  double lower = 0.0, upper = 0.0;  ///< range of the figure; equal for a single number
};

/// A motion of the device, or of the person, during which the person must hold the dead-man key.
struct Motion {
  MotionKind what = MotionKind::kPush;
  std::string text;  ///< in English: "axis x is pushed in + direction"
  std::string axis;
  double duration_s = 0.0;  ///< 0: unknown
};

/// Progress of a step.
struct StepNews {
  int step = 0;                            ///< number of a CommissioningStep
  StepState state = StepState::kUnderWay;  ///< never kWaiting
  Diagnostics why;                         ///< for kFailed
};

/// Interface to the person who commissions a device: at a terminal, at a page, or a script in
/// tests.
class Operator {
 public:
  virtual ~Operator() = default;
  /// Shows one line of text; `findings` holds its figures as numbers.
  virtual void reportLine(const std::string& line, const std::vector<FoundFigure>& findings) = 0;
  virtual void reportStep(const StepNews& news) = 0;
  /// Reports the state of a motion. kAwaitsKey: the person is asked to hold the key. kMoves follows
  /// if the key was held. kOver comes last.
  virtual void reportMotion(const Motion& motion, MotionState state) = 0;
  /// Asks a question and waits for the answer. Returns nothing when the person gave up.
  /// @param meanwhile called about 100 times a second until there is an answer
  [[nodiscard]] virtual std::optional<std::string> ask(const Question& question,
                                                       const std::function<void()>& meanwhile) = 0;
  /// True while the dead-man key is held. Does not block. Key presses during a pause between calls
  /// do not count; after a pause it takes a moment until a held key is seen again.
  [[nodiscard]] virtual bool holdsKey() = 0;
  /// True once the person has ended the commissioning or the terminal is gone. No key or answer
  /// will follow.
  [[nodiscard]] virtual bool gaveUp() = 0;
};

/// Clock of the commissioning: real or simulated.
class TickClock {
 public:
  virtual ~TickClock() = default;
  /// Waits for the next tick; the first call begins the first one.
  virtual void waitForTick() = 0;
  /// Time, CLOCK_MONOTONIC or simulated [ns].
  [[nodiscard]] virtual std::int64_t now_ns() const = 0;
};

}  // namespace wholehand
