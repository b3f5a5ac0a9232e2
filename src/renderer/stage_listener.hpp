#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"

namespace wholehand {

/// Told when a stage of the tick ends. The renderer knows no clock; whoever times it brings one.
class StageListener {
 public:
  virtual ~StageListener() = default;
  WHOLEHAND_RT virtual void lap(Stage stage) noexcept = 0;
};

}  // namespace wholehand
