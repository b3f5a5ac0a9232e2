#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"

namespace wholehand {

/// Called before and after every tick, in the thread that ticks: by the virtual patient who plays
/// an exercise and by the black box. Real-time safe.
class TickListener {
 public:
  virtual ~TickListener() = default;
  /// Called before the tick, with its commands.
  WHOLEHAND_RT virtual void beforeTick(const TickRecord& record) noexcept = 0;
  /// Called after the tick, with the complete record.
  WHOLEHAND_RT virtual void afterTick(const TickRecord& record) noexcept = 0;
};

}  // namespace wholehand
