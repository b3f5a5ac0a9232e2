#pragma once

#include "station/server/wire.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

// Clients from bare sockets: what is sent is what stands in the test, however wrong it is, and
// nothing of the server's own library is trusted to read what comes back.
namespace wholehand::test {

using namespace std::chrono_literals;

/// Ends what hangs, not what is slow.
inline constexpr auto kPatience = 120s;

/// A TCP connection to 127.0.0.1.
class RawSocket {
 public:
  /// @param receive_buffer of the kernel [bytes]; 0: as it is
  explicit RawSocket(std::uint16_t port, int receive_buffer = 0);
  ~RawSocket();
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  void send(const std::string& bytes);
  /// Exactly that many; nothing when the time is over or the other side has closed.
  [[nodiscard]] std::optional<std::string> receive(std::size_t bytes,
                                                   std::chrono::milliseconds within);
  /// Up to and with `end`.
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
  int status = 0;                              ///< 0: none came
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;
};

/// Sends a request line and headers ("GET / HTTP/1.1\r\nHost: ...\r\n\r\n"), reads the answer.
HttpReply ask(RawSocket& socket, const std::string& request,
              std::chrono::milliseconds within = kPatience);
/// One GET on a connection of its own, as a browser of this machine asks.
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

  [[nodiscard]] int status() const { return reply_.status; }  ///< 101: connected
  [[nodiscard]] const HttpReply& reply() const { return reply_; }
  void say(const wire::Bytes& message) { sendFrame(2, {message.begin(), message.end()}); }
  void sayText(const std::string& text) { sendFrame(1, text); }
  void sendFrame(int opcode, const std::string& payload);
  /// The next frame; pings are answered on the way.
  [[nodiscard]] std::optional<Frame> hear(std::chrono::milliseconds within = kPatience);
  [[nodiscard]] bool closed() const { return socket_.closed(); }

 private:
  RawSocket socket_;
  HttpReply reply_;
};

}  // namespace wholehand::test
