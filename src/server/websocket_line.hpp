#pragma once

#include "server/clients.hpp"
#include "server/traffic.hpp"
#include "server/websocket_stream.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace wholehand {

/// A client's WebSocket connection. Lives while one of its operations is pending, or while
/// `clients` holds it. Server's thread only.
class WebSocketLine final : public ClientLine, public std::enable_shared_from_this<WebSocketLine> {
 public:
  /// @pre clients and traffic outlive every operation
  WebSocketLine(std::unique_ptr<WebSocketStream> stream, std::string address, Clients& clients,
                Traffic& traffic);

  /// Joins the clients and starts to read.
  void join(Role role);

  void deliver(SharedBytes message) override;
  bool offer(SharedBytes state, std::int64_t arrived_ns) override;
  std::size_t waiting() const override { return queue_.size(); }
  std::int64_t writingSince_ns() const override { return writing_ ? since_ns_ : 0; }
  std::string address() const override { return address_; }
  void close(const std::string& reason) override;
  void cut() override { stream_->cut(); }

 private:
  void read();
  void haveRead(const ReceivedMessage& heard);
  void writeNext();
  void write(SharedBytes message);
  void haveWritten(bool sent);
  void end();

  std::unique_ptr<WebSocketStream> stream_;
  const std::string address_;
  Clients& clients_;
  Traffic& traffic_;
  std::uint32_t number_ = 0;
  std::deque<SharedBytes> queue_;
  std::optional<std::string> closing_;  ///< why the connection ends
  SharedBytes writing_;
  std::int64_t since_ns_ = 0;    ///< start of the current write
  std::int64_t arrived_ns_ = 0;  ///< arrival of the state in writing_; 0: not a state
};

}  // namespace wholehand
