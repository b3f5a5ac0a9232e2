#include "realtime/wakeup_probe.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>
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
  for (const std::int64_t late_ns : lateness_ns) {
    const auto* above =
        std::upper_bound(kLatenessClass_ns.begin(), kLatenessClass_ns.end(), late_ns);
    ++statistics.classes[above - kLatenessClass_ns.begin()];
  }
  return statistics;
}

Expected<WakeUpProbe> probeWakeUps(const PeriodicThreadConfig& config, std::size_t wake_ups,
                                   const std::function<void(std::size_t done)>& progress) {
  constexpr std::chrono::milliseconds kBetween{100};
  std::vector<std::int64_t> lateness_ns;
  lateness_ns.reserve(wake_ups);
  std::uint64_t skipped = 0;
  std::atomic<std::size_t> done{0};
  PeriodicThread thread(config, [&](std::uint32_t elapsed_periods, std::int64_t late_ns) {
    lateness_ns.push_back(late_ns);  // within the reserved capacity
    skipped += elapsed_periods - 1;
    return done.fetch_add(1, std::memory_order_relaxed) + 1 < wake_ups;
  });
  auto setup = thread.start();
  if (!setup) {
    return setup.errors();
  }
  while (progress && thread.running()) {
    progress(done.load(std::memory_order_relaxed));
    std::this_thread::sleep_for(kBetween);
  }
  thread.join();
  WakeUpProbe probe{wakeUpStatistics(lateness_ns), std::move(setup).value()};
  probe.statistics.skipped_periods = skipped;
  return probe;
}

}  // namespace wholehand
