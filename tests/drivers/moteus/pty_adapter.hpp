#pragma once

#include "fake_drive.hpp"
#include "moteus/tty_bus.hpp"

#include <atomic>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

/// A CAN adapter that is not there, behind a pseudo terminal, in a thread of the test. Its drives
/// have the test's clock: a machine that stands still is no silence. Its thread has real time,
/// since the driver waits for its answers.
namespace wholehand::test {

class PtyAdapter {
 public:
  explicit PtyAdapter(moteus::TtyBus::Protocol protocol = moteus::TtyBus::Protocol::kFdcanusb);
  ~PtyAdapter();
  PtyAdapter(const PtyAdapter&) = delete;
  PtyAdapter& operator=(const PtyAdapter&) = delete;

  [[nodiscard]] const std::string& port() const { return port_; }
  /// Lets the drives' clock run on.
  void pass(std::int64_t ns);
  /// Runs `look` while no drive moves.
  template <class Look>
  auto with(Look look) {
    const std::lock_guard lock(mutex_);
    return look(drives_);
  }
  /// Pulls the cable, after half a line.
  void unplug();
  /// Lines so far that were no frame.
  [[nodiscard]] std::vector<std::string> others();

  std::atomic<bool> babbles{false};  ///< speaks nonsense between its lines
  std::atomic<int> chunk{4096};      ///< bytes that it writes at a time

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
