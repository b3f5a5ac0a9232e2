#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// What of this machine decides how punctual a loop can be.
struct MachineFacts {
  std::string kernel;                    ///< release, e.g. "6.1.0-25-rt-amd64"
  bool real_time_kernel = false;         ///< PREEMPT_RT
  int cpus_allowed = 0;                  ///< cores this program may use
  int cpus_online = 0;                   ///< cores the machine has
  std::vector<int> isolated;             ///< cores kept free of other work
  std::string governor;                  ///< e.g. "powersave"; empty where the kernel shows none
  std::int64_t rtprio_limit = 0;         ///< largest real-time priority; -1 is unlimited
  std::int64_t memlock_limit_bytes = 0;  ///< memory that may be locked; -1 is unlimited
};

/// @param sys where the kernel shows cores and governors; another folder for tests
[[nodiscard]] MachineFacts machineFacts(const std::string& sys = "/sys");

/// True where /sys/kernel/realtime says 1 (its content; empty without the file) or, since some
/// real-time kernels lack that file, the kernel's version string names PREEMPT_RT.
[[nodiscard]] bool isRealTimeKernel(std::string_view sys_kernel_realtime,
                                    std::string_view uname_version);

}  // namespace wholehand
