#pragma once

#include "assembly/rehearsal.hpp"

namespace wholehand {

/// Why a scene is refused whose ticks take too long: how long, which stage, and what to remove.
[[nodiscard]] Diagnostic tooSlow(const Rehearsal& rehearsal, const Models& models);

}  // namespace wholehand
