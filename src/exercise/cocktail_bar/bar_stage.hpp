#pragma once

#include <cstdint>

namespace wholehand {

/// What the person is to do now; the numbers are those of the value "stage".
enum class BarStage : std::int32_t {
  kReach,
  kSqueeze,
  kPouring,
  kLetGo,
  kDrinkDone,
  kLevelDone,
  kDrawBack
};

}  // namespace wholehand
