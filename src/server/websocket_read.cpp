#include "server/websocket_socket.hpp"

#include <utility>

namespace wholehand {

void WebSocketStream::read(std::function<void(const ReceivedMessage&)> then) {
  socket_->buffer.clear();
  socket_->stream.async_read(
      socket_->buffer, [this, then = std::move(then)](ErrorCode error, std::size_t) {
        using What = ReceivedMessage::What;
        ReceivedMessage heard;
        if (error == boost::beast::websocket::error::message_too_big) {
          heard.what = What::kTooLarge;
        } else if (!error) {
          const auto bytes = socket_->buffer.cdata();
          heard.what = What::kMessage;
          heard.bytes = {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
          heard.text = socket_->stream.got_text();
        }
        then(heard);
      });
}

}  // namespace wholehand
