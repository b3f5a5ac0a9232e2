#include "core/printable.hpp"
#include "server/websocket_socket.hpp"

#include <utility>

namespace wholehand {

// Defined here: inline in the class, every operation that holds a socket would compile the
// destructor again.
WebSocketStream::Socket::Socket(Tcp::socket connected) : stream(std::move(connected)) {}

WebSocketStream::Socket::~Socket() = default;

WebSocketStream::WebSocketStream(std::unique_ptr<Socket> socket) : socket_(std::move(socket)) {}

WebSocketStream::~WebSocketStream() = default;

void WebSocketStream::write(std::span<const std::uint8_t> message,
                            std::function<void(bool sent)> then) {
  socket_->stream.async_write(
      net::const_buffer(message.data(), message.size()),
      [then = std::move(then)](ErrorCode error, std::size_t) { then(!error); });
}

void WebSocketStream::close(const std::string& reason, std::function<void()> then) {
  namespace websocket = boost::beast::websocket;
  constexpr std::size_t kMost_bytes = 123;  // of a close frame
  std::string text = printable(reason);
  if (text.size() > kMost_bytes) {
    std::size_t end = kMost_bytes;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
    text.resize(end);  // between two characters
  }
  const websocket::close_reason why(websocket::close_code::policy_error, text);
  socket_->stream.async_close(why, [then = std::move(then)](ErrorCode) { then(); });
}

void WebSocketStream::cut() {
  ErrorCode ignored;
  socket_->stream.next_layer().close(ignored);
}

}  // namespace wholehand
