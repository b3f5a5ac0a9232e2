#pragma once

#include "core/tick_record.hpp"
#include "realtime/stage_clock.hpp"
#include "renderer/stage_listener.hpp"

namespace wholehand {

/// Times one tick after the other: the whole of it by wall and CPU clock, its stages by CPU clock.
class TickTimer final : public StageListener {
 public:
  WHOLEHAND_RT void start() noexcept { clock_.start(); }
  WHOLEHAND_RT void lap(Stage stage) noexcept override { clock_.lap(stage); }
  /// Ends the tick and writes its times into the record.
  WHOLEHAND_RT void finish(TickRecord& record) noexcept {
    const StageTimes times = clock_.finish();
    record.wall_ns = times.wall_ns;
    record.cpu_ns = times.cpu_ns;
    record.stage_cpu_ns = times.stage_cpu_ns;
  }

 private:
  StageClock clock_;
};

}  // namespace wholehand
