#pragma once

#include "run_options.hpp"

namespace wholehand {

/// `wholehand run` with pages: serves the game and the console, and lets a virtual patient play
/// until somebody takes over. Returns the exit code.
int playCommand(RunOptions options);

}  // namespace wholehand
