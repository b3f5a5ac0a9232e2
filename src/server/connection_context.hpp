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

/// What every connection shares; outlives all their operations.
struct ConnectionContext {
  Site& site;
  Clients& clients;
  Traffic& traffic;
  RateLimitedLog& log;
  FileWorkers& pages;       ///< the pages' disk is another than the recordings', and must not wait
  FileWorkers& recordings;  ///< for it: a page has the button that stops
  FileWorkers& replays;     ///< a moment that somebody looks at again waits for no download
  /// Runs a task on the server's thread; called from any thread.
  std::function<void(std::function<void()>)> post;
  std::size_t max_clients = 16;
  std::chrono::milliseconds disk_patience{};
  std::chrono::milliseconds report_patience{};
  std::size_t connections = 0;           ///< over plain HTTP, now
  std::size_t upgrading = 0;             ///< on the way to a WebSocket
  std::list<HttpConnection*> idle = {};  ///< that wait for a request, the longest first
};

}  // namespace wholehand
