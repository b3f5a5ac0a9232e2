#pragma once

#include "commissioning/commissioning.hpp"

namespace wholehand {

/// Leads the person through all steps. True: the passport was written; false: the person ended it.
[[nodiscard]] bool leadCommissioning(Commissioning& commissioning, Operator& person);

/// Runs the daily check, again after each failure while the person wants. True: it was written.
[[nodiscard]] bool leadDailyCheck(Commissioning& commissioning, Operator& person);

}  // namespace wholehand
