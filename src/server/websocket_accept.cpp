#include "server/websocket_accept.hpp"

#include "server/websocket_socket.hpp"

#include <chrono>
#include <utility>

namespace wholehand {

namespace {

namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

}  // namespace

void acceptWebSocket(Tcp::socket socket, const UpgradeRequest& request, std::string cookie,
                     std::size_t largest_bytes,
                     std::function<void(std::unique_ptr<WebSocketStream>)> then) {
  // A small kernel buffer, so that a client that does not read is noticed within seconds.
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

}  // namespace wholehand
