#pragma once

#include "replay_command.hpp"

namespace wholehand {

/// Serves pages with one recording, or two side by side, until Ctrl-C, without a loop or a device.
/// Returns the exit code.
int replayWebCommand(const ReplayOptions& options);

}  // namespace wholehand
