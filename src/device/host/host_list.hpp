#pragma once

#include "device/host/shared_frame.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// What a host says of itself in its shared memory; nobody's loop is touched.
struct HostFacts {
  std::string name;         ///< of --name
  std::string problem;      ///< why nothing below is known; empty: it is
  std::string driver;       ///< what the driver calls itself
  std::int64_t pid = 0;     ///< of the host
  bool lives = false;       ///< its process is there
  bool in_use = false;      ///< a loop has it
  double sample_age_s = 0;  ///< since its last cycle; below 0: no cycle yet
  HostPhase phase = HostPhase::kIdle;
  HostReason reason = HostReason::kNone;
  std::vector<wh_axis> axes;
};

/// The hosts whose memory stands in /dev/shm, by name; also those that are gone. Not for the tick.
[[nodiscard]] std::vector<HostFacts> listHosts(const std::string& folder = "/dev/shm");

/// "rendering": what a person is told of a phase.
[[nodiscard]] const char* describe(HostPhase phase) noexcept;

}  // namespace wholehand
