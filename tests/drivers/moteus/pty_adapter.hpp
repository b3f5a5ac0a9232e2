#pragma once

#include "fake_drive.hpp"
#include "moteus/tty_bus.hpp"

#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

/// A fake CAN adapter behind a pseudo terminal, in a thread of the test. Its drives use the test's
/// clock, so that a stall of the machine is no silence. Its thread runs in real time, since the
/// driver waits for its answers.
namespace wholehand::test {

class PtyAdapter {
 public:
  explicit PtyAdapter(moteus::TtyBus::Protocol protocol = moteus::TtyBus::Protocol::kFdcanusb);
  ~PtyAdapter();
  PtyAdapter(const PtyAdapter&) = delete;
  PtyAdapter& operator=(const PtyAdapter&) = delete;

  [[nodiscard]] const std::string& port() const { return port_; }
  /// Advances the drives' clock.
  void pass(std::int64_t ns);
  /// Calls `look` with the drives locked.
  template <class Look>
  auto with(Look look) {
    const std::lock_guard lock(mutex_);
    return look(drives_);
  }
  /// Unplugs the adapter after half a line.
  void unplug();
  /// The lines received so far that were no frame.
  [[nodiscard]] std::vector<std::string> others();

  std::atomic<bool> babbles{false};  ///< sends invalid bytes between its lines
  std::atomic<int> chunk{4096};      ///< bytes per write

 private:
  void run();
  void answer(const std::string& line);
  void write(const std::string& text);

  moteus::TtyBus::Protocol protocol_;
  int master_ = -1;
  std::string port_;
  std::mutex mutex_;
  std::vector<FakeDrive> drives_;
  std::vector<std::string> others_;
  std::int64_t now_ns_ = 0;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace wholehand::test
