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

void WebSocketStream::cut() {
  ErrorCode ignored;
  socket_->stream.next_layer().close(ignored);
}

}  // namespace wholehand
