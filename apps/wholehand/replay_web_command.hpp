#pragma once

#include "replay_command.hpp"

namespace wholehand {

/// Shows one recording, or two side by side, in the browser until Ctrl-C: pages without a loop or a
/// device. Returns the program's exit code.
int replayWebCommand(const ReplayOptions& options);

}  // namespace wholehand
