#pragma once

#include "commissioning/commissioning.hpp"

namespace wholehand {

/// Leads the person through all steps. True: the passport is written; false: the person ended it.
[[nodiscard]] bool leadCommissioning(Commissioning& commissioning, Operator& person);

/// The daily check, again after each failure for as long as the person wants. True: it is written.
[[nodiscard]] bool leadDailyCheck(Commissioning& commissioning, Operator& person);

}  // namespace wholehand
