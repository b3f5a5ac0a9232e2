#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// State of a device's commissioning as clients see it (protocol Commissioning, enums in its
/// order). Immutable once published; every change publishes a new one.
struct CommissioningFacts {
  enum class StepState : std::uint8_t { kWaiting, kUnderWay, kDone, kFailed };
  enum class Asked : std::uint8_t {
    kNothing,
    kThisDevice,
    kNobodyAttached,
    kPushAway,
    kTravel,
    kKnownForce,
    kEmergencyStop,
    kNextStep
  };
  enum class Motion : std::uint8_t {
    kHoming,
    kPush,
    kCarry,
    kDrive,
    kMeasure,
    kWatchdog,
    kEmergencyStop
  };
  enum class MotionState : std::uint8_t { kAwaitsKey, kMoves, kOver };

  struct Finding {
    std::string axis, quantity, unit;
    double lower = 0.0, upper = 0.0;
  };
  struct Step {
    std::string name;
    StepState state = StepState::kWaiting;
    std::vector<Finding> findings;
    std::string problem, remedy;  ///< kFailed
  };

  std::string device, driver, serial, firmware, operator_name;
  std::vector<Step> steps;

  std::uint32_t question = 0;  ///< number of the question, from 1
  Asked asked = Asked::kNothing;
  std::string axis, unit;  ///< of the question or of the motion
  double lower = 0.0, upper = 0.0;
  std::string next;  ///< step that follows kNextStep
  std::string note;  ///< why the last answer was refused

  Motion motion = Motion::kHoming;
  MotionState motion_state = MotionState::kOver;
  double motion_s = 0.0;  ///< 0: unknown

  std::string passport;   ///< file; empty: none yet
  std::string recording;  ///< file; empty: none
  bool daily = false;     ///< a daily check
};

}  // namespace wholehand
