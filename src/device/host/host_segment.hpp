#pragma once

#include "core/expected.hpp"
#include "device/host/shared_frame.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand {

/// Why shared memory is not that of a host of this version; empty: it is.
[[nodiscard]] std::string whyForeign(const SharedFrame& frame);

/// False also for a process that has ended and that its parent has not waited for.
[[nodiscard]] bool processLives(std::int64_t pid);

/// One host per name: held from construction to destruction, and never longer than this process
/// lives. A process that a driver forks does not hold it.
class HostLock {
 public:
  /// Refused: a name that is not 1 to 32 of a-z, 0-9 and -, and one whose host runs, by its
  /// process.
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

/// The memory that a host and a loop share, of this user alone (mode 0600). Not for the tick.
class HostSegment {
 public:
  /// The host's: new and empty. What a host of the same name left when it died is removed; a loop
  /// that still has it mapped reaches nobody. A process that a driver forks does not have it.
  /// @pre lock outlives the segment
  [[nodiscard]] static Expected<std::unique_ptr<HostSegment>> create(const HostLock& lock);
  /// The loop's. Refused, by name: no such host, one of another user, another version or size of
  /// the memory, impossible axes, a host that is gone or stands still, one that another loop uses.
  [[nodiscard]] static Expected<std::unique_ptr<HostSegment>> attach(const std::string& name);
  /// The host's is removed.
  ~HostSegment();
  HostSegment(const HostSegment&) = delete;
  HostSegment& operator=(const HostSegment&) = delete;

  [[nodiscard]] SharedFrame& frame() noexcept { return *frame_; }
  /// The process of the host is there. It may be stopped.
  [[nodiscard]] bool hostLives() const;
  /// The host's samples go on: seen within a second, usually in a millisecond.
  [[nodiscard]] bool hasPulse() const;

 private:
  HostSegment(std::string path, int fd, SharedFrame* frame, bool owned)
      : path_(std::move(path)), fd_(fd), frame_(frame), owned_(owned) {}
  std::string path_;
  int fd_;
  SharedFrame* frame_;
  bool owned_;  ///< by the host
};

}  // namespace wholehand
