#pragma once

// Short names for Boost.Asio. Only sources that hold a socket include this file or Boost.Beast,
// since both are slow to compile.
#include <boost/asio/ip/tcp.hpp>

namespace wholehand {

namespace net = boost::asio;
using Tcp = boost::asio::ip::tcp;
using ErrorCode = boost::system::error_code;

}  // namespace wholehand
