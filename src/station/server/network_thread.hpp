#pragma once

#include "station/server/http_line.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace wholehand {

/// The thread of all input and output with clients. Every line lives on it. It touches no file,
/// since stop orders pass through it.
class NetworkThread {
 public:
  /// Callbacks on the thread. An exception from one is reported to `failed`; then the thread
  /// continues.
  struct Calls {
    std::function<void(std::unique_ptr<HttpLine>)> connected;  ///< a browser connected
    std::function<void()> frame;                               ///< called 60 times a second
    std::function<void(const char* why)> failed;               ///< must not throw
  };

  NetworkThread();
  /// Stops the thread. Destroys every line, and whatever its operations keep alive.
  ~NetworkThread();
  NetworkThread(const NetworkThread&) = delete;
  NetworkThread& operator=(const NetworkThread&) = delete;

  /// Opens the port. Returns the reason if that fails; empty: it listens. Port 0: any free one.
  [[nodiscard]] std::string listen(const std::string& address, std::uint16_t port);
  /// Port on which it listens. Any thread, after listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// Starts the thread. @pre it listens; call once
  void start(Calls calls);
  /// Queues a task for the thread; dropped after it has stopped. Any thread; never waits.
  void post(std::function<void()> task);
  /// Stops the thread after the current callback. Must not be called from the thread.
  void stop();

 private:
  class Machinery;

  std::unique_ptr<Machinery> machinery_;
};

}  // namespace wholehand
