#pragma once

#include "station/server/site.hpp"
#include "station/server/websocket_stream.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

// Text handling of HTTP for the routes of this server.
namespace wholehand {

/// Value of a key in "a=1&b=2", not decoded; empty when the key is missing.
[[nodiscard]] std::string_view queryValue(std::string_view query, std::string_view key);

/// Decodes %XX in a path, once. Empty when the path is malformed or contains something that no
/// served path has: control characters, a backslash, an empty, "." or ".." segment, an encoded
/// slash.
[[nodiscard]] std::optional<std::string> decodedPath(std::string_view path);
/// True when a slash is encoded. An encoded slash belongs to a name, and no served name contains
/// one.
[[nodiscard]] bool hasEncodedSlash(std::string_view path);

/// Encodes a path segment: all but unreserved characters become %XX.
[[nodiscard]] std::string percentEncoded(std::string_view text);

/// A request from a browser.
struct ReceivedRequest {
  enum class Kind { kRequest, kMalformed, kHasBody, kTooLarge };  ///< kTooLarge: its header
  Kind what = Kind::kRequest;
  HttpRequest request;   ///< the part that could be parsed
  bool upgrade = false;  ///< the request asks for a WebSocket
};

/// A browser's connection that carries HTTP requests and answers. It knows neither routes nor
/// access rights. Server's thread only. No call blocks.
///
/// `then` is called later from the same thread, at most once. It is not called when the browser is
/// gone or a timeout expired (30 s for a request, or for a piece of an answer to be taken). One
/// operation at a time, plus one alarm. @pre `then` keeps the line alive.
class HttpLine {
 public:
  using Then = std::function<void()>;

  virtual ~HttpLine() = default;

  /// Reads a request.
  virtual void read(std::function<void(ReceivedRequest)> then) = 0;
  /// Sends a text. A HEAD request gets the header only.
  virtual void send(HttpAnswer answer, Then then) = 0;
  /// Sends the header of a file of `size` bytes.
  virtual void sendHeader(const HttpAnswer& answer, std::uint64_t size, Then then) = 0;
  /// Sends a piece of the file.
  virtual void sendPiece(std::string piece, Then then) = 0;
  /// Accepts the WebSocket request that was read last; passes null when that fails. The line cannot
  /// be used afterwards.
  /// @param largest_bytes limit for a client's message; a larger one ends the connection
  virtual void upgrade(std::string cookie, std::size_t largest_bytes,
                       std::function<void(std::unique_ptr<WebSocketStream>)> then) = 0;

  /// Calls `then` after a time, unless the alarm is cancelled.
  virtual void setTimer(std::chrono::milliseconds after, Then then) = 0;
  virtual void cancelTimer() = 0;

  /// True when the last request was HEAD.
  [[nodiscard]] virtual bool headOnly() const = 0;
  /// True when another request may follow the answer (keep-alive).
  [[nodiscard]] virtual bool keepsAlive() const = 0;
  /// Closes the connection after the next answer, whose header announces it.
  virtual void keepNoLonger() = 0;
  /// Peer's IP address, for the log.
  [[nodiscard]] virtual std::string peer() const = 0;

  /// Shuts down sending.
  virtual void finish() = 0;
  /// Closes the connection at once.
  virtual void close() = 0;
};

}  // namespace wholehand
