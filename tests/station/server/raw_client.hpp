#pragma once

#include "station/server/wire.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

// Clients over plain sockets. They send exactly the bytes of the test, valid or not, and do not use
// the server's library to read the answers.
namespace wholehand::test {

using namespace std::chrono_literals;

/// Bounds a hang; a slow machine stays below it.
inline constexpr auto kPatience = 120s;

/// A TCP connection to 127.0.0.1.
class RawSocket {
 public:
  /// @param receive_buffer size of the kernel's receive buffer [bytes]; 0: the default
  explicit RawSocket(std::uint16_t port, int receive_buffer = 0);
  ~RawSocket();
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  void send(const std::string& bytes);
  /// Receives exactly `bytes`; none if the time is over or the other side has closed.
  [[nodiscard]] std::optional<std::string> receive(std::size_t bytes,
                                                   std::chrono::milliseconds within);
  /// Receives up to and including `end`.
  [[nodiscard]] std::optional<std::string> receiveUntil(const std::string& end,
                                                        std::chrono::milliseconds within);
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  bool fill(std::chrono::steady_clock::time_point until);

  int handle_ = -1;
  bool closed_ = false;
  std::string buffer_;
};

struct HttpReply {
  int status = 0;                              ///< 0: no answer
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;
};

/// Sends a request line and headers ("GET / HTTP/1.1\r
/// Host: ...\r
/// \r
/// ") and reads the answer.
HttpReply ask(RawSocket& socket, const std::string& request,
              std::chrono::milliseconds within = kPatience);
/// Sends one GET on its own connection, with the headers of a browser on this machine.
HttpReply get(std::uint16_t port, const std::string& target, const std::string& more_headers = "",
              const std::string& method = "GET");

/// A WebSocket client.
class WebSocket {
 public:
  struct Frame {
    int opcode = 0;  ///< 2 binary, 8 close
    std::string payload;
    [[nodiscard]] std::span<const std::uint8_t> bytes() const {
      return {reinterpret_cast<const std::uint8_t*>(payload.data()), payload.size()};
    }
  };

  explicit WebSocket(std::uint16_t port, const std::string& more_headers = "",
                     const std::string& target = "/ws", int receive_buffer = 0);

  [[nodiscard]] int status() const { return reply_.status; }  ///< 101: accepted
  [[nodiscard]] const HttpReply& reply() const { return reply_; }
  void send(const wire::Bytes& message) { sendFrame(2, {message.begin(), message.end()}); }
  void sendText(const std::string& text) { sendFrame(1, text); }
  void sendFrame(int opcode, const std::string& payload);
  /// The next frame; answers pings meanwhile.
  [[nodiscard]] std::optional<Frame> receive(std::chrono::milliseconds within = kPatience);
  [[nodiscard]] bool closed() const { return socket_.closed(); }

 private:
  RawSocket socket_;
  HttpReply reply_;
};

}  // namespace wholehand::test
