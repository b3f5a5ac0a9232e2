#pragma once

#include "server/asio.hpp"
#include "server/http_line.hpp"

#include <memory>

namespace wholehand {

/// Opens an HTTP line over a connected socket, on the socket's thread.
[[nodiscard]] std::unique_ptr<HttpLine> openHttpLine(Tcp::socket socket);

}  // namespace wholehand
