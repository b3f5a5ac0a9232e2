#pragma once

#include "server/asio.hpp"
#include "server/websocket_stream.hpp"

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

namespace wholehand {

/// For websocket_*.cpp only. Accepting, reading and writing are separate sources, since each takes
/// seconds to compile. Compression is not offered; it would double that time.
class WebSocketStream::Socket {
 public:
  explicit Socket(Tcp::socket connected);
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  boost::beast::websocket::stream<Tcp::socket, false> stream;
  boost::beast::flat_buffer buffer;  ///< the last message read
};

}  // namespace wholehand
