#include "fault_text.hpp"

namespace wholehand::moteus {

const char* faultText(int code) noexcept {
  switch (code) {
    case 32:
      return "calibration";
    case 33:
      return "motor driver, most often too little voltage";
    case 34:
      return "over voltage";
    case 35:
      return "encoder";
    case 36:
      return "motor not calibrated";
    case 37:
      return "PWM cycle overrun";
    case 38:
      return "over temperature";
    case 39:
      return "outside its position limits";
    case 40:
      return "under voltage";
    case 41:
      return "configuration changed in operation";
    case 42:
      return "no valid commutation encoder";
    case 43:
      return "no valid output encoder";
    case 44:
      return "driver could not be enabled";
    case 45:
      return "stop position is deprecated";
    case 46:
      return "timing violation";
    case 47:
      return "bemf feed-forward without an acceleration limit";
    case 48:
      return "position limits are invalid";
    case 49:
      return "position error beyond its threshold";
    case 50:
      return "velocity error beyond its threshold";
    case 96:
      return "limited by its velocity";
    case 97:
      return "limited by its power";
    case 98:
      return "limited by its voltage";
    case 99:
      return "limited by its current";
    case 100:
      return "limited by its temperature";
    case 101:
      return "limited by the motor's temperature";
    case 102:
      return "limited by the maximum torque";
    case 103:
      return "limited by its position limits";
    case 104:
      return "limited by flux braking";
    case 105:
      return "limited by field weakening";
    default:
      return "a code that is not known";
  }
}

}  // namespace wholehand::moteus
