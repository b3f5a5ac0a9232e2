#pragma once

#include "loop/core/expected.hpp"

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace wholehand {

/// Keeps `wholehand-clinic serve` running as a separate process, and restarts it when it ends. The
/// loop and its stops do not depend on it (docs/adr/0076-clinic-process.md). The child ends with
/// this process. Its port stays the same.
class ClinicProcess {
 public:
  struct Options {
    std::string folder;                           ///< folder of the records
    std::string recordings_folder;                ///< recordings that it measures
    std::vector<std::string> origins;             ///< origins of pages that may send requests
    std::function<void(const std::string&)> log;  ///< prints a line for the person at the terminal
  };

  /// Path of wholehand-clinic in this program's folder, or why there is none.
  [[nodiscard]] static Expected<std::string> findProgram();

  ClinicProcess(std::string program, Options options);
  ~ClinicProcess();
  ClinicProcess(const ClinicProcess&) = delete;
  ClinicProcess& operator=(const ClinicProcess&) = delete;

  /// Starts the thread. Call once.
  /// @param station_port port of this program's server
  void start(std::uint16_t station_port);
  /// Port on this machine; 0: the process does not run. Any thread.
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }

 private:
  [[nodiscard]] std::vector<std::string> arguments(std::uint16_t station_port) const;
  void keepRunning(std::uint16_t station_port);
  void serveOnce(std::uint16_t station_port);
  [[nodiscard]] bool ending();

  const std::string program_;
  const Options options_;
  std::atomic<std::uint16_t> port_{0};
  std::uint16_t last_port_ = 0;  ///< used by the thread only
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace wholehand
