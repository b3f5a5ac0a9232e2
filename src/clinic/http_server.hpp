#pragma once

#include "clinic/clinic.hpp"
#include "loop/core/expected.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand::clinic {

/// HTTP server of a clinic on 127.0.0.1, for the station's pages. It checks Host and Origin.
/// Limits: 64 KiB per body, 64 waiting connections, 10 s of waiting. One request per connection.
class HttpServer {
 public:
  /// @param port 0: any free one  @param origins origins of the pages  @param clinic outlives the
  /// server
  [[nodiscard]] static Expected<std::unique_ptr<HttpServer>> start(
      Clinic& clinic, std::uint16_t port, const std::vector<std::string>& origins);
  /// Cancels requests under way and stops the server.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;

 private:
  class Listener;
  explicit HttpServer(std::unique_ptr<Listener> listener);
  std::unique_ptr<Listener> listener_;
};

}  // namespace wholehand::clinic
