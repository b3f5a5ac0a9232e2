#pragma once

#include "server/clients.hpp"
#include "server/traffic.hpp"
#include "server/websocket_stream.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>

namespace wholehand {

/// A client over WebSocket. Lives while one of its operations does, or while `clients` knows it.
/// The server's thread only.
class WebSocketLine final : public ClientLine, public std::enable_shared_from_this<WebSocketLine> {
 public:
  /// @pre clients and traffic outlive every operation
  WebSocketLine(std::unique_ptr<WebSocketStream> stream, std::string address, Clients& clients,
                Traffic& traffic);

  /// Joins the clients, and listens.
  void join(Role role);

  void deliver(SharedBytes message) override;
  bool offer(SharedBytes state, std::int64_t arrived_ns) override;
  std::size_t waiting() const override { return queue_.size(); }
  std::int64_t writingSince_ns() const override { return writing_ ? since_ns_ : 0; }
  std::string address() const override { return address_; }
  void cut() override { stream_->cut(); }

 private:
  void read();
  void haveRead(const WebSocketHeard& heard);
  void writeNext();
  void write(SharedBytes message);
  void haveWritten(bool sent);

  std::unique_ptr<WebSocketStream> stream_;
  const std::string address_;
  Clients& clients_;
  Traffic& traffic_;
  std::uint32_t number_ = 0;
  std::deque<SharedBytes> queue_;
  SharedBytes writing_;
  std::int64_t since_ns_ = 0;    ///< when writing_ was begun
  std::int64_t arrived_ns_ = 0;  ///< of the state in writing_; 0: it is something else
};

}  // namespace wholehand
