#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace wholehand {

/// A message that came over a WebSocket, or why none comes any more.
struct WebSocketHeard {
  enum class What { kMessage, kTooLarge, kEnd };
  What what = What::kEnd;
  std::span<const std::uint8_t> bytes = {};  ///< valid until the next read
  bool text = false;
};

/// One accepted WebSocket: whole messages in, whole messages out; it pings, and ends itself where
/// the client is silent for 20 s. The server's thread only. No call blocks.
///
/// `then` is called later from the same thread, once. One read and one write at a time.
/// @pre `then` keeps the stream alive.
class WebSocketStream {
 public:
  class Socket;  ///< Beast's

  explicit WebSocketStream(std::unique_ptr<Socket> socket);
  ~WebSocketStream();
  WebSocketStream(const WebSocketStream&) = delete;
  WebSocketStream& operator=(const WebSocketStream&) = delete;

  void read(std::function<void(const WebSocketHeard&)> then);
  /// @param message stays as it is until `then`
  /// @param then is told whether all of it was sent; if not, the connection has ended
  void write(std::span<const std::uint8_t> message, std::function<void(bool sent)> then);
  /// Ends the connection at once.
  void cut();

 private:
  std::unique_ptr<Socket> socket_;
};

}  // namespace wholehand
