#pragma once

#include "clinic/clinic.hpp"
#include "loop/core/expected.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand::clinic {

/// A clinic's HTTP on 127.0.0.1, for the station's pages: Host and Origin are checked, bodies have
/// at most 64 KiB, at most 64 connections wait, none longer than 10 s. One request a connection.
class HttpServer {
 public:
  /// @param port 0: any free one  @param origins of the pages  @param clinic outlives the server
  [[nodiscard]] static Expected<std::unique_ptr<HttpServer>> start(
      Clinic& clinic, std::uint16_t port, const std::vector<std::string>& origins);
  /// Ends what is under way.
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
