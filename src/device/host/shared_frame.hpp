#pragma once

#include "device/host/newest_value.hpp"
#include "schema_enums.hpp"
#include "wholehand/device.h"

#include <atomic>
#include <cstdint>
#include <type_traits>

namespace wholehand {

/// Phase of the host.
enum class HostPhase : std::uint32_t {
  kIdle = 0,       ///< not enabled: nothing is written
  kWaiting = 1,    ///< enabled at the neutral effort, until the loop's first command
  kRendering = 2,  ///< writes what the loop commands
  kRamping = 3,    ///< ramps the effort to neutral by itself
  kLatched = 4     ///< holds neutral until a loop enables again
};

/// Host → loop, once a cycle of the host.
struct HostSample {
  std::uint64_t cycle;        ///< increments every cycle
  std::int64_t monotonic_ns;  ///< time of the cycle, CLOCK_MONOTONIC
  std::uint64_t session;      ///< session that the host serves; 0: none yet
  HostPhase phase;
  ReleaseReason reason;
  std::int32_t read_result;   ///< result of wh_plugin.read
  std::int32_t write_result;  ///< result of the last wh_plugin.write; 0 before
  wh_sample sample;
};

/// Loop → host, once a tick.
struct HostCommand {
  std::uint64_t session;   ///< its session; commands of another session are ignored
  std::uint64_t sequence;  ///< increases with every command of a session
  std::int64_t monotonic_ns;
  std::uint64_t axes;
  double effort[WH_MAX_AXES];  ///< [N or N·m], in the driver's order
};

/// Loop → host: a verb of device.h, outside the tick.
struct HostRequest {
  std::uint64_t number;  ///< increases with every request
  std::int64_t pid;      ///< of the loop
  std::uint64_t verb;
  double argument;
};

/// Host → loop.
struct HostAnswer {
  std::uint64_t number;   ///< of the request
  std::uint64_t session;  ///< session begun by WH_ENABLE
  std::int64_t ok;        ///< 1: done
  char text[232];         ///< reason otherwise
};

inline constexpr std::uint64_t kFrameMagic = 0x57484f4c'45484e44ULL;
/// Layout version of the shared memory.
inline constexpr std::uint32_t kFrameLayout = 3;

/// Memory shared by a host and a loop. The host creates and fills it, then sets `magic`.
struct SharedFrame {
  std::atomic<std::uint64_t> magic;
  std::uint32_t layout;
  std::uint32_t size;  ///< of this structure
  std::int64_t host_pid;
  std::uint32_t axis_count;     ///< 1 .. WH_MAX_AXES
  char driver[64];              ///< name that the driver gives itself
  wh_identity identity;         ///< of the device; empty where unknown
  char driver_sha256[65];       ///< DriverIdentity::driver_sha256
  wh_axis axes[WH_MAX_AXES];    ///< as described by the driver, plus the host's delay
  double neutral[WH_MAX_AXES];  ///< neutral effort that the host ramps to [N or N·m]
  double limit[WH_MAX_AXES];    ///< of the efforts that the host lets through [N or N·m]

  alignas(64) NewestValue<HostSample> sample;
  alignas(64) NewestValue<HostCommand> command;
  alignas(64) NewestValue<HostRequest> request;
  alignas(64) NewestValue<HostAnswer> answer;
};

static_assert(std::is_standard_layout_v<SharedFrame>);
static_assert(std::is_trivially_destructible_v<SharedFrame>);

}  // namespace wholehand
