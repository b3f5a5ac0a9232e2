#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// The properties of this machine that determine the loop's jitter.
struct MachineFacts {
  std::string kernel;                    ///< release, e.g. "6.1.0-25-rt-amd64"
  bool real_time_kernel = false;         ///< PREEMPT_RT
  int cpus_allowed = 0;                  ///< cores that this program may use
  int cpus_online = 0;                   ///< cores the machine has
  std::vector<int> isolated;             ///< isolated cores (isolcpus)
  std::string governor;                  ///< e.g. "powersave"; empty when the kernel shows none
  std::int64_t rtprio_limit = 0;         ///< largest real-time priority; -1 is unlimited
  std::int64_t memlock_limit_bytes = 0;  ///< memory that may be locked; -1 is unlimited
};

/// @param sys folder in which the kernel shows cores and governors; another one in tests
[[nodiscard]] MachineFacts machineFacts(const std::string& sys = "/sys");

/// True when /sys/kernel/realtime holds 1 (its content; empty without the file) or the kernel's
/// version string names PREEMPT_RT, since some real-time kernels lack that file.
[[nodiscard]] bool isRealTimeKernel(std::string_view sys_kernel_realtime,
                                    std::string_view uname_version);

}  // namespace wholehand
