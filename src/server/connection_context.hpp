#pragma once

#include "server/clients.hpp"
#include "server/file_workers.hpp"
#include "server/rate_limited_log.hpp"
#include "server/site.hpp"
#include "server/traffic.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <list>

namespace wholehand {

class HttpConnection;

/// State shared by all connections; outlives all their operations.
struct ConnectionContext {
  Site& site;
  Clients& clients;
  Traffic& traffic;
  RateLimitedLog& log;
  FileWorkers& pages;       ///< separate from recordings: the page with the stop button
  FileWorkers& recordings;  ///< must not wait for their disk
  FileWorkers& replays;     ///< separate from recordings: a replay must not wait for a download
  /// Runs a task on the server's thread; called from any thread.
  std::function<void(std::function<void()>)> post;
  std::size_t max_clients = 16;
  std::chrono::milliseconds disk_patience{};
  std::chrono::milliseconds report_patience{};
  std::size_t connections = 0;           ///< open plain HTTP connections
  std::size_t upgrading = 0;             ///< being upgraded to a WebSocket
  std::list<HttpConnection*> idle = {};  ///< waiting for a request, longest first
};

}  // namespace wholehand
