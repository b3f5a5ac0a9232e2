#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"

namespace wholehand {

/// Told of every tick, in the thread that ticks: the virtual patient who plays an exercise, the
/// black box. Real-time safe.
class TickListener {
 public:
  virtual ~TickListener() = default;
  /// Before the tick, with the commands it takes.
  WHOLEHAND_RT virtual void beforeTick(const TickRecord& record) noexcept = 0;
  /// After it, with all that came of it.
  WHOLEHAND_RT virtual void afterTick(const TickRecord& record) noexcept = 0;
};

}  // namespace wholehand
