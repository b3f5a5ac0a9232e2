#pragma once

#include "server/http_line.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace wholehand {

/// The thread of all input and output with clients. It touches no file: orders to stop come through
/// it. Every line lives on it.
class NetworkThread {
 public:
  /// Called from the thread. What one of them throws is told to `failed`; then the thread goes on.
  struct Calls {
    std::function<void(std::unique_ptr<HttpLine>)> connected;  ///< a browser
    std::function<void()> frame;                               ///< 60 times a second
    std::function<void(const char* why)> failed;               ///< must not throw
  };

  NetworkThread();
  /// Stops. Drops every line, and so whatever their operations keep alive.
  ~NetworkThread();
  NetworkThread(const NetworkThread&) = delete;
  NetworkThread& operator=(const NetworkThread&) = delete;

  /// Why the port cannot be had; empty: it listens. Port 0: any that is free.
  [[nodiscard]] std::string listen(const std::string& address, std::uint16_t port);
  /// The port it listens at; any thread after listen().
  [[nodiscard]] std::uint16_t port() const noexcept;
  /// @pre it listens; once
  void start(Calls calls);
  /// Runs a task on the thread, later; dropped where it has stopped. Any thread, never waits.
  void post(std::function<void()> task);
  /// Ends the thread: waits for the call under way. Not from the thread.
  void stop();

 private:
  class Machinery;

  std::unique_ptr<Machinery> machinery_;
};

}  // namespace wholehand
