#pragma once

#include "core/expected.hpp"
#include "device/host/shared_frame.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Why shared memory does not belong to a host of this version; empty: it does.
[[nodiscard]] std::string whyForeign(const SharedFrame& frame);

/// Whether a process lives. False for a zombie.
[[nodiscard]] bool processLives(std::int64_t pid);

/// Lock that allows one host per name, held until destruction or until the process ends. Child
/// processes forked by a driver do not inherit it.
class HostLock {
 public:
  /// Refused: a name that is not 1 to 32 of a-z, 0-9 and -, and a name whose host runs, with its
  /// process id.
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
  /// Whether the process of the host exists. It may be stopped.
  [[nodiscard]] bool hostLives() const;
  /// Whether another host of the name has replaced this memory.
  [[nodiscard]] bool replaced() const;
  /// Whether the host publishes samples. Waits up to a second, usually a millisecond.
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
  std::string problem;      ///< why the rest is unknown; empty: it is known
  std::string driver;       ///< name that the driver gives itself
  std::int64_t pid = 0;     ///< of the host
  bool lives = false;       ///< its process exists
  bool in_use = false;      ///< a loop is connected
  double sample_age_s = 0;  ///< time since its last cycle; < 0: no cycle yet
  HostPhase phase = HostPhase::kIdle;
  ReleaseReason reason = ReleaseReason::kNone;
  std::vector<wh_axis> axes;
};

/// Hosts whose shared memory is in /dev/shm, sorted by name; also of ended processes. Not real-time
/// safe.
[[nodiscard]] std::vector<HostFacts> listHosts(const std::string& folder = "/dev/shm");

/// Name of a phase for people: "rendering".
[[nodiscard]] const char* describe(HostPhase phase) noexcept;

}  // namespace wholehand
