#pragma once

#include "rig/models.hpp"
#include "vocabulary/backend.hpp"

namespace wholehand {

/// What is reported to clients of these models; session, version, choices and recording are the
/// caller's.
[[nodiscard]] SceneFacts sceneFacts(const Models& models, double period_s);

}  // namespace wholehand
