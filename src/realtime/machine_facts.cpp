#include "realtime/machine_facts.hpp"

#include "realtime/thread_setup.hpp"

#include <algorithm>
#include <fstream>
#include <sched.h>
#include <string>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <unistd.h>

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
  // Governors may differ between cores; the loop's core counts.
  facts.governor = firstLine(sys + "/devices/system/cpu/cpu" +
                             std::to_string(std::max(0, lastCore())) + "/cpufreq/scaling_governor");
  facts.rtprio_limit = limitOf(RLIMIT_RTPRIO);
  facts.memlock_limit_bytes = limitOf(RLIMIT_MEMLOCK);
  return facts;
}

}  // namespace wholehand
