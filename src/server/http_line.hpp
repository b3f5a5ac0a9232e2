#pragma once

#include "server/site.hpp"
#include "server/websocket_stream.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace wholehand {

/// What a browser sent.
struct HttpHeard {
  enum class What { kRequest, kMalformed, kHasBody };
  What what = What::kRequest;
  HttpRequest request;   ///< as far as it could be read
  bool upgrade = false;  ///< it asks for a WebSocket
};

/// A browser's connection as HTTP: requests come in, answers go out. What is asked, and who may
/// ask, it does not know. The server's thread only. No call blocks.
///
/// `then` is called later from the same thread, at most once: never where the browser is gone or
/// has used up its patience (30 s for a request, or for a piece of an answer to be taken). One
/// operation at a time, and beside it one alarm. @pre `then` keeps the line alive.
class HttpLine {
 public:
  using Then = std::function<void()>;

  virtual ~HttpLine() = default;

  /// Waits for a request.
  virtual void read(std::function<void(HttpHeard)> then) = 0;
  /// Sends a text. A request for a header alone (HEAD) gets no more than that.
  virtual void send(HttpAnswer answer, Then then) = 0;
  /// Sends the header of a file of `size` bytes.
  virtual void sendHeader(const HttpAnswer& answer, std::uint64_t size, Then then) = 0;
  /// Sends a piece of it.
  virtual void sendPiece(std::string piece, Then then) = 0;
  /// Accepts the request for a WebSocket that was read last; null where that fails. Nothing can be
  /// done with the line from then on.
  /// @param largest_bytes of a message of the client; the connection ends where it sends more
  virtual void upgrade(std::string cookie, std::size_t largest_bytes,
                       std::function<void(std::unique_ptr<WebSocketStream>)> then) = 0;

  /// After so long, unless it is called off.
  virtual void setAlarm(std::chrono::milliseconds after, Then then) = 0;
  virtual void callOffAlarm() = 0;

  /// The request that was read last was HEAD.
  [[nodiscard]] virtual bool headOnly() const = 0;
  /// Another request may follow the answer.
  [[nodiscard]] virtual bool keepsAlive() const = 0;
  /// The next answer says that none may.
  virtual void keepNoLonger() = 0;
  /// Its IP address, for the log.
  [[nodiscard]] virtual std::string peer() const = 0;

  /// Nothing more is sent.
  virtual void finish() = 0;
  /// Ends the connection at once.
  virtual void close() = 0;
};

}  // namespace wholehand
