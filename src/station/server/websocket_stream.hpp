#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

namespace wholehand {

/// A received WebSocket message, or why reading ended.
struct ReceivedMessage {
  enum class Kind { kMessage, kTooLarge, kEnd };
  Kind what = Kind::kEnd;
  std::span<const std::uint8_t> bytes = {};  ///< valid until the next read
  bool text = false;
};

/// An accepted WebSocket that reads and writes whole messages. It sends pings, and closes when the
/// client is silent for 20 s. Server's thread only. No call blocks.
///
/// `then` is called later from the same thread, once. One read and one write at a time.
/// @pre `then` keeps the stream alive.
class WebSocketStream {
 public:
  class Socket;  ///< wraps Beast's stream

  explicit WebSocketStream(std::unique_ptr<Socket> socket);
  ~WebSocketStream();
  WebSocketStream(const WebSocketStream&) = delete;
  WebSocketStream& operator=(const WebSocketStream&) = delete;

  void read(std::function<void(const ReceivedMessage&)> then);
  /// @param message must stay valid until `then`
  /// @param then gets true when all was sent; false when the connection has ended
  void write(std::span<const std::uint8_t> message, std::function<void(bool sent)> then);
  /// Closes with code 1008 and a reason, of which at most 123 bytes are sent. Nothing is written
  /// afterwards.
  /// @pre no write is under way
  void close(const std::string& reason, std::function<void()> then);
  /// Closes the connection at once.
  void cut();

 private:
  std::unique_ptr<Socket> socket_;
};

}  // namespace wholehand
