#pragma once

#include "devices/host/newest_value.hpp"
#include "loop/core/expected.hpp"
#include "schema_enums.hpp"
#include "wholehand/device.h"

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace wholehand {

/// Phase of the host.
enum class HostPhase : std::uint32_t {
  kIdle = 0,       ///< not enabled; nothing is written
  kWaiting = 1,    ///< enabled at the neutral effort until the loop's first command
  kRendering = 2,  ///< writes the loop's commands
  kRamping = 3,    ///< ramps the effort to neutral by itself
  kLatched = 4     ///< holds neutral until a loop enables again
};

/// What the drive said last, by its samples and by its answers to commands.
enum class DriveState : std::uint32_t {
  kUnheard = 0,     ///< it has given no sample yet
  kOn = 1,          ///< efforts reach the motors
  kOff = 2,         ///< they do not, for example after its stop button
  kSilenced = 3,    ///< its watchdog released the effort
  kFault = 4,       ///< it has stopped itself
  kUnreadable = 5,  ///< its read fails
  kStill = 6,       ///< it gives nothing new
  kRefuses = 7      ///< it refused the last command
};

/// Message from host to loop, once per cycle of the host.
struct HostSample {
  std::uint64_t cycle;        ///< increments every cycle
  std::int64_t monotonic_ns;  ///< time of the cycle, CLOCK_MONOTONIC
  std::uint64_t session;      ///< session that the host serves; 0: none yet
  HostPhase phase;
  ReleaseReason reason;
  std::int32_t read_result;   ///< result of wh_plugin.read
  std::int32_t write_result;  ///< result of the last wh_plugin.write; 0 before
  DriveState drive;
  std::uint32_t held;               ///< 1: enabled at the neutral effort between two sessions
  std::int64_t drive_heard_ns;      ///< time at which the drive last said anything new; 0: never
  std::int64_t drive_since_ns;      ///< time since which it has been in this state
  std::uint64_t command;            ///< number of the newest command taken, whatever became of it
  std::int64_t command_sent_ns;     ///< HostCommand::monotonic_ns of that command
  std::int64_t command_arrived_ns;  ///< end of the cycle's write to the driver with that command
  wh_sample sample;
};

/// Session of messages that only measure the way of the commands.
inline constexpr std::uint64_t kNoSession = ~std::uint64_t{0};

/// Message from loop to host, once per tick.
struct HostCommand {
  std::uint64_t session;   ///< its session; commands of another session are ignored
  std::uint64_t sequence;  ///< increases with every command of a session
  std::int64_t monotonic_ns;
  std::uint64_t axes;
  double effort[WH_MAX_AXES];  ///< [N or N·m], in the driver's order
};

/// Request from loop to host: a verb of device.h, outside the tick.
struct HostRequest {
  std::uint64_t number;  ///< increases with every request
  std::int64_t pid;      ///< process id of the loop
  std::uint64_t verb;
  double argument;
};

/// Answer from host to loop.
struct HostAnswer {
  std::uint64_t number;   ///< number of the request
  std::uint64_t session;  ///< session begun by WH_ENABLE
  std::int64_t ok;        ///< 1: success
  char text[232];         ///< reason of a failure
};

inline constexpr std::uint64_t kFrameMagic = 0x57484f4c'45484e44ULL;
/// Layout version of the shared memory.
inline constexpr std::uint32_t kFrameLayout = 5;

/// Memory shared by a host and a loop. The host creates and fills it, then sets `magic`.
struct SharedFrame {
  std::atomic<std::uint64_t> magic;
  std::uint32_t layout;
  std::uint32_t size;  ///< of this structure
  std::int64_t host_pid;
  std::uint32_t axis_count;     ///< 1 .. WH_MAX_AXES
  char driver[64];              ///< name that the driver gives itself
  wh_identity identity;         ///< identity of the device; fields are empty where unknown
  char driver_sha256[65];       ///< DriverIdentity::driver_sha256
  wh_axis axes[WH_MAX_AXES];    ///< as described by the driver, plus the host's delay
  double neutral[WH_MAX_AXES];  ///< neutral effort that the host ramps to [N or N·m]
  double switches_within_s;     ///< DeviceDriver::switchesWithin_s() of the driver
  double limit[WH_MAX_AXES];    ///< limits of the efforts that the host allows [N or N·m]

  alignas(64) NewestValue<HostSample> sample;
  alignas(64) NewestValue<HostCommand> command;
  alignas(64) NewestValue<HostRequest> request;
  alignas(64) NewestValue<HostAnswer> answer;
};

static_assert(std::is_standard_layout_v<SharedFrame>);
static_assert(std::is_trivially_destructible_v<SharedFrame>);

/// Reason why shared memory does not belong to a host of this version; empty: it does.
[[nodiscard]] std::string incompatibility(const SharedFrame& frame);

/// True when the process exists and is not a zombie.
[[nodiscard]] bool processLives(std::int64_t pid);

/// Lock that allows one host per name, held until destruction or until the process ends. Child
/// processes forked by a driver do not inherit it.
class HostLock {
 public:
  /// Takes the lock. Refused: a name that is not 1 to 32 of a-z, 0-9 and -, and a name whose host
  /// runs, with its process id.
  [[nodiscard]] static Expected<std::unique_ptr<HostLock>> take(const std::string& name);
  ~HostLock();
  HostLock(const HostLock&) = delete;
  HostLock& operator=(const HostLock&) = delete;
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  HostLock(std::string name, int fd) : name_(std::move(name)), fd_(fd) {}
  std::string name_;
  int fd_;
};

/// Shared memory of a host and a loop, accessible to this user only (mode 0600). Not real-time
/// safe.
class HostSegment {
 public:
  /// Creates the host's segment, empty. Removes the segment of a dead host of the same name; a loop
  /// that still maps it reaches nobody. Child processes forked by a driver do not inherit the
  /// mapping.
  /// @pre lock outlives the segment
  [[nodiscard]] static Expected<std::unique_ptr<HostSegment>> create(const HostLock& lock);
  /// Attaches a loop to a host's segment. Refused, each with its own message: no such host, a host
  /// of another user, another version or size of the memory, impossible axes, a host that is gone
  /// or stalled, one that another loop uses.
  [[nodiscard]] static Expected<std::unique_ptr<HostSegment>> attach(const std::string& name);
  /// Removes the segment if the host owns it.
  ~HostSegment();
  HostSegment(const HostSegment&) = delete;
  HostSegment& operator=(const HostSegment&) = delete;

  [[nodiscard]] SharedFrame& frame() noexcept { return *frame_; }
  /// True when the process of the host exists. It may be stopped.
  [[nodiscard]] bool hostLives() const;
  /// True when another host of the name has replaced this memory.
  [[nodiscard]] bool replaced() const;
  /// True when the host publishes samples. Waits up to a second, usually a millisecond.
  [[nodiscard]] bool publishesSamples() const;

 private:
  HostSegment(std::string path, int fd, SharedFrame* frame, bool owned)
      : path_(std::move(path)), fd_(fd), frame_(frame), owned_(owned) {}
  std::string path_;
  int fd_;
  SharedFrame* frame_;
  bool owned_;  ///< true in the host
};

/// State that a host publishes in its shared memory. Reading it does not disturb a loop.
struct HostFacts {
  std::string name;         ///< the host's --name
  std::string problem;      ///< why the other members are unknown; empty: they are known
  std::string driver;       ///< name that the driver gives itself
  std::int64_t pid = 0;     ///< process id of the host
  bool lives = false;       ///< its process exists
  bool in_use = false;      ///< a loop is connected
  double sample_age_s = 0;  ///< time since its last cycle; < 0: no cycle yet
  HostPhase phase = HostPhase::kIdle;
  ReleaseReason reason = ReleaseReason::kNone;
  DriveState drive = DriveState::kUnheard;
  std::uint32_t status = 0;  ///< bits of the drive's newest sample
  bool held = false;         ///< enabled at the neutral effort between two sessions
  double drive_heard_s = 0;  ///< age of what the drive said last; < 0: it said nothing yet
  double drive_since_s = 0;  ///< time for which it has been in this state
  std::vector<wh_axis> axes;
};

/// What a host says in its shared memory; `problem`, `lives` and `in_use` are left out. Any thread.
[[nodiscard]] HostFacts factsOf(const SharedFrame& frame, const std::string& name);

/// True when the host has enabled the drive, so that the drive should be on.
[[nodiscard]] constexpr bool shouldBeOn(HostPhase phase, bool held) noexcept {
  return held || phase != HostPhase::kIdle;
}

/// Hosts whose shared memory is in /dev/shm, sorted by name, including ended processes. Not
/// real-time safe.
[[nodiscard]] std::vector<HostFacts> listHosts(const std::string& folder = "/dev/shm");

/// Name of a phase for people: "rendering".
[[nodiscard]] const char* describe(HostPhase phase) noexcept;

/// State of a drive for people, after "the drive ": "is off".
[[nodiscard]] const char* describe(DriveState drive) noexcept;

/// State of a host for people: its phase, or its drive's state if that should be on and is not.
[[nodiscard]] std::string stateOf(const HostFacts& host);

}  // namespace wholehand
