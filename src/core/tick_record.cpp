#include "core/tick_record.hpp"

namespace wholehand {

const char* stageName(Stage s) noexcept {
  switch (s) {
    case Stage::kDeviceRead:
      return "device_read";
    case Stage::kObserve:
      return "observe";
    case Stage::kDynamics:
      return "dynamics";
    case Stage::kControl:
      return "control";
    case Stage::kExercise:
      return "exercise";
    case Stage::kSafety:
      return "safety";
    case Stage::kDeviceWrite:
      return "device_write";
    case Stage::kPhysicsStep:
      return "physics_step";
    case Stage::kContacts:
      return "contacts";
    case Stage::kCount:
      break;
  }
  return "unknown";
}

}  // namespace wholehand
