#pragma once

#include "server/asio.hpp"
#include "server/websocket_stream.hpp"

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

namespace wholehand {

/// For the websocket_*.cpp only. Accepting, reading and writing are sources of their own: each
/// takes seconds to compile. Without compression: it was never offered, and takes as long again.
class WebSocketStream::Socket {
 public:
  explicit Socket(Tcp::socket connected);
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  boost::beast::websocket::stream<Tcp::socket, false> stream;
  boost::beast::flat_buffer buffer;  ///< the message that was read last
};

}  // namespace wholehand
