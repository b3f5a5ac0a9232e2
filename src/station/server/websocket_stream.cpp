#include "station/server/websocket_stream.hpp"

#include "loop/core/printable.hpp"
#include "station/server/sockets.hpp"

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <utility>

namespace wholehand {

namespace {

namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

}  // namespace

/// Wraps Beast's stream. Compression is not offered, because it would double the time to compile
/// this file.
class WebSocketStream::Socket {
 public:
  explicit Socket(Tcp::socket connected);
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  boost::beast::websocket::stream<Tcp::socket, false> stream;
  boost::beast::flat_buffer buffer;  ///< the last message read
};

void acceptWebSocket(Tcp::socket socket, const UpgradeRequest& request, std::string cookie,
                     std::size_t largest_bytes,
                     std::function<void(std::unique_ptr<WebSocketStream>)> then) {
  // The kernel buffer is small, so that a client that does not read is noticed within seconds.
  constexpr int kSendBuffer_bytes = 64 * 1024;
  ErrorCode ignored;
  socket.set_option(net::socket_base::send_buffer_size(kSendBuffer_bytes), ignored);
  socket.set_option(Tcp::no_delay(true), ignored);
  auto accepted = std::make_unique<WebSocketStream::Socket>(std::move(socket));
  auto& stream = accepted->stream;
  websocket::stream_base::timeout limits{};
  limits.handshake_timeout = std::chrono::seconds(10);
  limits.idle_timeout = std::chrono::seconds(20);
  limits.keep_alive_pings = true;
  stream.set_option(limits);
  stream.set_option(websocket::stream_base::decorator(
      [cookie = std::move(cookie)](websocket::response_type& response) {
        response.set(http::field::server, "wholehand");
        if (!cookie.empty()) response.set(http::field::set_cookie, cookie);
      }));
  stream.read_message_max(largest_bytes);
  stream.binary(true);
  stream.auto_fragment(false);
  stream.async_accept(
      request, [accepted = std::move(accepted), then = std::move(then)](ErrorCode error) mutable {
        then(error ? nullptr : std::make_unique<WebSocketStream>(std::move(accepted)));
      });
}

void WebSocketStream::read(std::function<void(const ReceivedMessage&)> then) {
  socket_->buffer.clear();
  socket_->stream.async_read(
      socket_->buffer, [this, then = std::move(then)](ErrorCode error, std::size_t) {
        using Kind = ReceivedMessage::Kind;
        ReceivedMessage heard;
        if (error == boost::beast::websocket::error::message_too_big) {
          heard.what = Kind::kTooLarge;
        } else if (!error) {
          const auto bytes = socket_->buffer.cdata();
          heard.what = Kind::kMessage;
          heard.bytes = {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
          heard.text = socket_->stream.got_text();
        }
        then(heard);
      });
}

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
  constexpr std::size_t kMost_bytes = 123;  // limit of a close frame
  std::string text = printable(reason);
  if (text.size() > kMost_bytes) {
    std::size_t end = kMost_bytes;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
    text.resize(end);  // cut between two UTF-8 characters
  }
  const websocket::close_reason why(websocket::close_code::policy_error, text);
  socket_->stream.async_close(why, [then = std::move(then)](ErrorCode) { then(); });
}

void WebSocketStream::cut() {
  ErrorCode ignored;
  socket_->stream.next_layer().close(ignored);
}

}  // namespace wholehand
