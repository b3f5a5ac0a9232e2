#pragma once

#include "device/host/shared_frame.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// State that a host publishes in its shared memory. Reading it does not disturb a loop.
struct HostFacts {
  std::string name;         ///< the host's --name
  std::string problem;      ///< why the rest is unknown; empty: it is known
  std::string driver;       ///< name that the driver gives itself
  std::int64_t pid = 0;     ///< of the host
  bool lives = false;       ///< its process exists
  bool in_use = false;      ///< a loop is connected
  double sample_age_s = 0;  ///< time since its last cycle; < 0: no cycle yet
  HostPhase phase = HostPhase::kIdle;
  HostReason reason = HostReason::kNone;
  std::vector<wh_axis> axes;
};

/// Hosts whose shared memory is in /dev/shm, sorted by name; also of ended processes. Not real-time
/// safe.
[[nodiscard]] std::vector<HostFacts> listHosts(const std::string& folder = "/dev/shm");

/// Name of a phase for people: "rendering".
[[nodiscard]] const char* describe(HostPhase phase) noexcept;

}  // namespace wholehand
