#include "loop/realtime/machine_facts.hpp"

#include "loop/realtime/thread_setup.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fstream>
#include <sched.h>
#include <string>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace wholehand {
namespace {

std::string firstLine(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

std::int64_t limitOf(__rlimit_resource resource) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) {
    return 0;
  }
  return limit.rlim_cur == RLIM_INFINITY ? -1 : static_cast<std::int64_t>(limit.rlim_cur);
}

int allowedCpus() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  return sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : 1;
}

}  // namespace

bool isRealTimeKernel(std::string_view sys_kernel_realtime, std::string_view uname_version) {
  return sys_kernel_realtime.starts_with('1') ||
         uname_version.find("PREEMPT_RT") != std::string_view::npos ||
         uname_version.find("PREEMPT RT") != std::string_view::npos;
}

MachineFacts machineFacts(const std::string& sys) {
  MachineFacts facts;
  utsname name{};
  uname(&name);
  facts.kernel = name.release;
  facts.real_time_kernel = isRealTimeKernel(firstLine(sys + "/kernel/realtime"), name.version);
  facts.cpus_allowed = allowedCpus();
  facts.cpus_online = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  facts.isolated = isolatedCpus();
  // Governors may differ between cores: reads that of the core on which the loop runs.
  facts.governor = firstLine(sys + "/devices/system/cpu/cpu" +
                             std::to_string(std::max(0, lastCore())) + "/cpufreq/scaling_governor");
  facts.rtprio_limit = limitOf(RLIMIT_RTPRIO);
  facts.memlock_limit_bytes = limitOf(RLIMIT_MEMLOCK);
  return facts;
}

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
  constexpr std::chrono::milliseconds kBetween{100};  // interval of the calls of `progress`
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
