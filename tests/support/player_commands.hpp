#pragma once

#include "loop/core/command.hpp"

#include <cstdint>

/// Commands of a person to a player.
namespace wholehand::test {

inline Command steer(Steering who) {
  Command command;
  command.type = CommandType::kSteer;
  command.index = static_cast<std::int32_t>(who);
  return command;
}

inline Command aim(const AxisPosition& at) {
  Command command;
  command.type = CommandType::kAim;
  command.aim = at;
  return command;
}

}  // namespace wholehand::test
