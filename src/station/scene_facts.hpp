#pragma once

#include "rig/models.hpp"
#include "vocabulary/backend.hpp"

namespace wholehand {

/// Makes the facts about the models that clients receive. The caller fills in session, version,
/// choices and recording.
[[nodiscard]] SceneFacts sceneFacts(const Models& models, double period_s);

}  // namespace wholehand
