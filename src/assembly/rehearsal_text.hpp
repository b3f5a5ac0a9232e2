#pragma once

#include "assembly/rehearsal.hpp"

namespace wholehand {

/// Diagnostic of a scene whose ticks take too long: the time, the stage, and what to remove.
[[nodiscard]] Diagnostic tooSlow(const Rehearsal& rehearsal, const Models& models);

}  // namespace wholehand
