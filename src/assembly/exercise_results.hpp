#pragma once

#include "assembly/models.hpp"
#include "telemetry/statistics.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A result of the exercise.
struct ResultValue {
  std::string name;    ///< name of the value, with its unit
  double value = 0.0;  ///< in that unit, from the exercise's last tick
  std::string shown;   ///< for a person: "Spilt 2 ml"
};

/// Results named by the exercise's panel; empty where no tick had values. Not real-time safe.
[[nodiscard]] std::vector<ResultValue> exerciseResults(const Models& models,
                                                       const TickSummary& summary);

}  // namespace wholehand
