#include "realtime/wakeup_probe.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace wholehand {

WakeUpStatistics wakeUpStatistics(std::span<std::int64_t> lateness_ns) {
  WakeUpStatistics statistics;
  if (lateness_ns.empty()) {
    return statistics;
  }
  std::sort(lateness_ns.begin(), lateness_ns.end());
  const auto rank = [&](double share) {
    const double position = std::ceil(share * static_cast<double>(lateness_ns.size()));
    return lateness_ns[std::max<std::size_t>(static_cast<std::size_t>(position), 1) - 1];
  };
  statistics.wake_ups = lateness_ns.size();
  statistics.p50_ns = rank(0.5);
  statistics.p99_ns = rank(0.99);
  statistics.p999_ns = rank(0.999);
  statistics.max_ns = lateness_ns.back();
  return statistics;
}

Expected<WakeUpProbe> probeWakeUps(const PeriodicThreadConfig& config, std::size_t wake_ups) {
  std::vector<std::int64_t> lateness_ns;
  lateness_ns.reserve(wake_ups);
  std::uint64_t skipped = 0;
  PeriodicThread thread(config, [&](std::uint32_t elapsed_periods, std::int64_t late_ns) {
    lateness_ns.push_back(late_ns);  // within what is reserved
    skipped += elapsed_periods - 1;
    return lateness_ns.size() < wake_ups;
  });
  auto setup = thread.start();
  if (!setup) {
    return setup.errors();
  }
  thread.join();
  WakeUpProbe probe{wakeUpStatistics(lateness_ns), std::move(setup).value()};
  probe.statistics.skipped_periods = skipped;
  return probe;
}

}  // namespace wholehand
