#pragma once

// Boost.Asio under short names. Only sources that hold a socket include it, or Boost.Beast: every
// file that does takes long to compile.
#include <boost/asio/ip/tcp.hpp>

namespace wholehand {

namespace net = boost::asio;
using Tcp = boost::asio::ip::tcp;
using ErrorCode = boost::system::error_code;

}  // namespace wholehand
