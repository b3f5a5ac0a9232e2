#pragma once

#include "device/host/newest_value.hpp"
#include "wholehand/device.h"

#include <atomic>
#include <cstdint>
#include <type_traits>

namespace wholehand {

/// What the host does with the device.
enum class HostPhase : std::uint32_t {
  kIdle = 0,       ///< not enabled: nothing is written
  kWaiting = 1,    ///< enabled at the neutral effort, until the loop's first command
  kRendering = 2,  ///< writes what the loop commands
  kRamping = 3,    ///< takes the effort to neutral by itself
  kLatched = 4     ///< holds neutral until a loop enables anew
};

/// Why the host took the effort to neutral by itself.
enum class HostReason : std::uint32_t {
  kNone = 0,             ///< the loop is heard, or ended at neutral
  kLoopSilent = 1,       ///< no new command for 20 ms
  kSilentAtNeutral = 2,  ///< the same, but the effort was neutral already
  kBadCommand = 3,       ///< not finite, or not of as many axes
  kLoopEnded = 4,        ///< the loop disabled the device before it was at neutral
  kHostEnds = 5,         ///< the host was told to end
  kNeverCommanded = 6    ///< enabled, and no command came
};

/// Host → loop, once a cycle of the host.
struct HostSample {
  std::uint64_t cycle;        ///< rises by one a cycle
  std::int64_t monotonic_ns;  ///< when the cycle was; CLOCK_MONOTONIC
  std::uint64_t session;      ///< that the host serves; 0: none yet
  HostPhase phase;
  HostReason reason;
  std::int32_t read_result;   ///< of wh_plugin.read
  std::int32_t write_result;  ///< of the last wh_plugin.write; 0 before
  wh_sample sample;
};

/// Loop → host, once a tick.
struct HostCommand {
  std::uint64_t session;   ///< that it belongs to; a command of another one is passed over
  std::uint64_t sequence;  ///< rises with every command of a session
  std::int64_t monotonic_ns;
  std::uint64_t axes;
  double effort[WH_MAX_AXES];  ///< [N or N·m], in the driver's order
};

/// Loop → host: a verb of device.h, not in a tick.
struct HostRequest {
  std::uint64_t number;  ///< rises with every request
  std::int64_t pid;      ///< of the loop
  std::uint64_t verb;
  double argument;
};

/// Host → loop.
struct HostAnswer {
  std::uint64_t number;   ///< of the request
  std::uint64_t session;  ///< that WH_ENABLE has begun
  std::int64_t ok;        ///< 1: done
  char text[232];         ///< else why not
};

inline constexpr std::uint64_t kFrameMagic = 0x57484f4c'45484e44ULL;
/// Changes with every change of what lies in shared memory.
inline constexpr std::uint32_t kFrameLayout = 2;

/// What a host and a loop share; the host makes it, and fills it before it sets `magic`.
struct SharedFrame {
  std::atomic<std::uint64_t> magic;
  std::uint32_t layout;
  std::uint32_t size;  ///< of this structure
  std::int64_t host_pid;
  std::uint32_t axis_count;     ///< 1 .. WH_MAX_AXES
  char driver[64];              ///< what it calls itself
  wh_identity identity;         ///< of the device; empty where it is not known
  wh_axis axes[WH_MAX_AXES];    ///< as the driver says, the delay of the host added
  double neutral[WH_MAX_AXES];  ///< to which the host ramps [N or N·m]

  alignas(64) NewestValue<HostSample> sample;
  alignas(64) NewestValue<HostCommand> command;
  alignas(64) NewestValue<HostRequest> request;
  alignas(64) NewestValue<HostAnswer> answer;
};

static_assert(std::is_standard_layout_v<SharedFrame>);
static_assert(std::is_trivially_destructible_v<SharedFrame>);

}  // namespace wholehand
