#pragma once

#include "loop/realtime/monotonic_clock.hpp"

namespace wholehand::test {

/// Processor time that the calling thread has used [s].
inline double cpu_s() {
  return 1e-9 * static_cast<double>(threadCpuNow_ns());
}

}  // namespace wholehand::test
