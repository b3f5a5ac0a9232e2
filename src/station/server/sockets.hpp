#pragma once

#include "station/server/http_line.hpp"
#include "station/server/websocket_stream.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/fields.hpp>
#include <boost/beast/http/message.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

// Shared by the source files that hold a socket. Only they include this file, Boost.Asio or
// Boost.Beast, since both are slow to compile.
namespace wholehand {

namespace net = boost::asio;
using Tcp = boost::asio::ip::tcp;
using ErrorCode = boost::system::error_code;

/// Opens an HTTP line over a connected socket, on the socket's thread.
[[nodiscard]] std::unique_ptr<HttpLine> openHttpLine(Tcp::socket socket);

using UpgradeRequest = boost::beast::http::request<boost::beast::http::empty_body>;

/// Performs the WebSocket handshake on a socket, on the socket's thread; does not block.
/// @param request may be destroyed after the call
/// @param cookie to set; empty: none
/// @param largest_bytes limit for a client's message; a larger one ends the connection
/// @param then called later, once; with null on failure
void acceptWebSocket(Tcp::socket socket, const UpgradeRequest& request, std::string cookie,
                     std::size_t largest_bytes,
                     std::function<void(std::unique_ptr<WebSocketStream>)> then);

}  // namespace wholehand
