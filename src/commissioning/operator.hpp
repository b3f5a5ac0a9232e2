#pragma once

#include "core/expected.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// What the person is asked. A terminal prints the text; a page words it in its own language.
struct Question {
  enum class About : std::uint8_t {
    kThisDevice,      ///< yes or no
    kNobodyAttached,  ///< yes or no
    kPushAway,        ///< an axis, by hand; answered when it is done
    kTravel,          ///< of an axis between its stops: a number in `unit`
    kKnownForce,      ///< that pulls an axis: a number in `unit`
    kEmergencyStop,   ///< is to be pressed; answered when it is done
    kNextStep         ///< empty: go on; the name of a step; "quit"
  };
  About about = About::kNextStep;
  std::string text;  ///< in English, with how a terminal takes the answer
  std::string axis, unit;
  double lower = 0.0, upper = 0.0;  ///< where a good answer lies, in `unit`; both 0: not known
};

/// What was found of an axis (of the device: no axis), for a person to read.
struct FoundFigure {
  std::string axis;
  std::string quantity;  ///< "mass", "delay", "travel", ...
  std::string unit;
  double lower = 0.0, upper = 0.0;  ///< equal: a number, not an interval
};

/// A move for which the key has to be held.
struct Motion {
  enum class What : std::uint8_t { kHoming, kPush, kCarry, kDrive, kMeasure, kWatchdog };
  What what = What::kPush;
  std::string text;  ///< in English: "axis x is pushed in + direction"
  std::string axis;
  double duration_s = 0.0;  ///< 0: not known
};
enum class MotionState : std::uint8_t { kAwaitsKey, kMoves, kOver };

/// What became of a step.
struct StepNews {
  enum class What : std::uint8_t { kBegins, kDone, kFailed };
  int step = 0;  ///< of CommissioningStep
  What what = What::kBegins;
  Diagnostics why;  ///< kFailed
};

/// The person who commissions a device: at a terminal, at a page, or a script in tests.
class Operator {
 public:
  virtual ~Operator() = default;
  /// One line, for reading, and what it says of the device in numbers.
  virtual void tell(const std::string& line, const std::vector<FoundFigure>& findings) = 0;
  virtual void tellStep(const StepNews& news) = 0;
  /// kAwaitsKey: the person is to hold the key. Then kMoves, where the key was held; at last kOver.
  virtual void tellMotion(const Motion& motion, MotionState state) = 0;
  /// Asks and waits; nothing: the person gave up.
  /// @param meanwhile is called again and again until there is an answer, some 100 times a second
  [[nodiscard]] virtual std::optional<std::string> ask(const Question& question,
                                                       const std::function<void()>& meanwhile) = 0;
  /// Whether the key is held without which nothing moves. Does not wait. What was pressed while
  /// nobody looked does not count: after a pause it takes a moment until a held key is seen again.
  [[nodiscard]] virtual bool holdsKey() = 0;
  /// The person has ended it, or the terminal is gone: neither a key nor an answer will come.
  [[nodiscard]] virtual bool gaveUp() = 0;
};

/// The time of commissioning: real, or simulated.
class TickClock {
 public:
  virtual ~TickClock() = default;
  /// Until the next tick begins; the first call begins the first one.
  virtual void waitForTick() = 0;
  /// CLOCK_MONOTONIC, or simulated [ns].
  [[nodiscard]] virtual std::int64_t now_ns() const = 0;
};

}  // namespace wholehand
