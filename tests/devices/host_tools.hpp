#pragma once

#include "devices/host/device_host.hpp"
#include "devices/host/host_segment.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/realtime/periodic_thread.hpp"
#include "loop/realtime/thread_setup.hpp"
#include "support/figure.hpp"
#include "support/watched_main.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <memory>
#include <pthread.h>
#include <sched.h>
#include <spawn.h>
#include <string>
#include <sys/mman.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

/// Hosts in a thread of the test, and processes that act as loops or hosts (host_partner.cpp).
namespace wholehand::test {

/// Where host_partner writes the longest gap between two of its commands [ms].
inline constexpr std::size_t kGapAt = WH_MAX_AXES - 1;

/// A host name that is unique to this test process.
inline std::string hostName(const std::string& what) {
  return "test-" + what + "-" + std::to_string(::getpid());
}

/// Runs a host in a thread of this process, as `wholehand device-host` does.
class HostThread {
 public:
  HostThread(const std::string& name, std::shared_ptr<DeviceDriver> driver,
             const DeviceModel& model, double rate_hz = 4000.0)
      : driver_(std::move(driver)),
        lock_(orThrow(HostLock::take(name))),
        segment_(orThrow(HostSegment::create(*lock_))),
        config_(guardConfig(*driver_, model, 1.0 / rate_hz)),
        host_(*driver_, segment_->frame(), config_, &monotonicNow_ns),
        thread_(threadConfig(rate_hz), [this](std::uint32_t elapsed_periods, std::int64_t) {
          return host_.cycle(static_cast<int>(elapsed_periods));
        }) {
    seesRealTime();
    describeDevice(segment_->frame(), *driver_, config_, ::getpid());
    (void)orThrow(thread_.start());
  }
  ~HostThread() {
    end();
    ::shm_unlink(("/wholehand-" + lock_->name() + ".lock").c_str());
  }
  HostThread(const HostThread&) = delete;
  HostThread& operator=(const HostThread&) = delete;

  void end() {
    host_.requestEnd();
    thread_.join();
  }
  [[nodiscard]] DeviceHost& host() { return host_; }
  [[nodiscard]] SharedFrame& frame() { return segment_->frame(); }
  [[nodiscard]] HostSample sample() {
    HostSample sample{};
    (void)frame().sample.take(sample);
    return sample;
  }
  /// Waits for the phase; false if the host hangs.
  [[nodiscard]] bool awaits(HostPhase phase) {
    for (int i = 0; i < 300'000; ++i) {
      if (sample().phase == phase) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  /// Waits until the loop of the session has sent a command, whatever became of it since; false if
  /// it hangs.
  [[nodiscard]] bool awaitsLoopOf(std::uint64_t session) {
    for (int i = 0; i < 300'000; ++i) {
      const HostSample now = sample();
      const bool commanded = now.phase != HostPhase::kIdle && now.phase != HostPhase::kWaiting;
      if (now.session >= session && commanded) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }
  [[nodiscard]] std::vector<HostEvent> events() {
    std::vector<HostEvent> out;
    HostEvent event;
    while (host_.nextEvent(event)) out.push_back(event);
    return out;
  }

 private:
  static PeriodicThreadConfig threadConfig(double rate_hz) {
    PeriodicThreadConfig config;
    config.period_ns = static_cast<std::int64_t>(1e9 / rate_hz);
    config.setup.fifo_priority = 85;
    config.setup.cores_before_last = 1;
    config.setup.lock_memory = false;
    return config;
  }

  std::shared_ptr<DeviceDriver> driver_;
  std::unique_ptr<HostLock> lock_;
  std::unique_ptr<HostSegment> segment_;
  GuardConfig config_;
  DeviceHost host_;
  PeriodicThread thread_;
};

/// While it exists, the calling thread has the priority of a loop, if the machine grants it: a test
/// that stalls for 20 ms counts as a lost loop. Threads started meanwhile inherit the priority.
class AsUrgentAsALoop {
 public:
  AsUrgentAsALoop() { (void)requestFifoPriority(80); }
  ~AsUrgentAsALoop() {
    const sched_param ordinary{};
    ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &ordinary);
  }
  AsUrgentAsALoop(const AsUrgentAsALoop&) = delete;
  AsUrgentAsALoop& operator=(const AsUrgentAsALoop&) = delete;
};

/// Longest time between two calls of note() [ms], which shows how long the machine stalled a test.
class LongestGap {
 public:
  void note() {
    const std::int64_t now_ns = monotonicNow_ns();
    if (last_ns_ != 0) {
      longest_ms_ = std::max(longest_ms_, static_cast<double>(now_ns - last_ns_) * 1e-6);
    }
    last_ns_ = now_ns;
  }
  [[nodiscard]] double longest_ms() const { return longest_ms_; }

 private:
  std::int64_t last_ns_ = 0;
  double longest_ms_ = 0.0;
};

/// A process beside the test; it is killed in the destructor at the latest.
class Partner {
 public:
  explicit Partner(std::vector<std::string> arguments) {
    seesRealTime();
    arguments.insert(arguments.begin(), std::string(WHOLEHAND_BINARY_DIR) + "/host_partner");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    if (::posix_spawn(&pid_, argv[0], nullptr, nullptr, argv.data(), environ) != 0) pid_ = 0;
  }
  ~Partner() {
    if (pid_ <= 0) return;
    send(SIGKILL);
    wait();
  }
  Partner(const Partner&) = delete;
  Partner& operator=(const Partner&) = delete;

  void send(int signal) const {
    if (pid_ > 0) ::kill(pid_, signal);
  }
  void wait() {
    if (pid_ > 0) ::waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }
  [[nodiscard]] pid_t pid() const { return pid_; }

 private:
  pid_t pid_ = 0;
};

}  // namespace wholehand::test
