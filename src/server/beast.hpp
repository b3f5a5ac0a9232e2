#pragma once

// Boost.Beast, for server.cpp only: every file that includes it takes long to compile.
#define BOOST_BEAST_FILE_BUFFER_SIZE 65536  // a recording goes out in few pieces

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace wholehand {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using Tcp = boost::asio::ip::tcp;
using ErrorCode = boost::beast::error_code;

}  // namespace wholehand
