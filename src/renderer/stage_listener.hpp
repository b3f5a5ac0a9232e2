#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"

namespace wholehand {

/// Notified when a stage of the tick ends. The renderer knows no clock; the listener brings its
/// own.
class StageListener {
 public:
  virtual ~StageListener() = default;
  WHOLEHAND_RT virtual void lap(Stage stage) noexcept = 0;
};

}  // namespace wholehand
