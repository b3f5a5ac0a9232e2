#pragma once

#include "realtime/monotonic_clock.hpp"
#include "server/beast.hpp"
#include "server/clients.hpp"
#include "server/traffic.hpp"

#include <chrono>
#include <deque>
#include <memory>
#include <string>

namespace wholehand {

/// A client over WebSocket. Part of server.cpp; lives while one of its operations does, or while
/// `clients` knows it.
class WebSocketLine final : public ClientLine, public std::enable_shared_from_this<WebSocketLine> {
 public:
  /// @pre clients and traffic outlive every operation
  WebSocketLine(Tcp::socket socket, Clients& clients, Traffic& traffic)
      : socket_(std::move(socket)), clients_(clients), traffic_(traffic) {}

  /// Answers the request and goes on from there.
  /// @param upgrading counts those that are not clients yet
  template <class Request>
  void accept(const Request& request, std::string cookie, std::size_t& upgrading) {
    // A small buffer of the kernel: a client that does not read is noticed within seconds.
    constexpr int kSendBuffer = 64 * 1024;
    ErrorCode ignored;
    lowest().set_option(net::socket_base::send_buffer_size(kSendBuffer), ignored);
    lowest().set_option(Tcp::no_delay(true), ignored);
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = std::chrono::seconds(10);
    limits.idle_timeout = std::chrono::seconds(20);
    limits.keep_alive_pings = true;
    socket_.set_option(limits);
    socket_.set_option(websocket::stream_base::decorator(
        [cookie = std::move(cookie)](websocket::response_type& response) {
          response.set(http::field::server, "wholehand");
          if (!cookie.empty()) response.set(http::field::set_cookie, cookie);
        }));
    socket_.read_message_max(wire::kLargestClientMessage);
    socket_.binary(true);
    socket_.auto_fragment(false);
    ++upgrading;
    socket_.async_accept(request, [self = shared_from_this(), &upgrading](ErrorCode error) {
      --upgrading;
      if (error) return;
      self->number_ = self->clients_.join(self, monotonicNow_ns());
      self->read();
    });
  }

  void deliver(SharedBytes message) override {
    queue_.push_back(std::move(message));
    if (!writing_) writeNext();
  }

  bool offer(SharedBytes state, std::int64_t arrived_ns) override {
    if (writing_) return false;
    arrived_ns_ = arrived_ns;
    write(std::move(state));
    return true;
  }

  std::size_t waiting() const override { return queue_.size(); }
  std::int64_t writingSince_ns() const override { return writing_ ? since_ns_ : 0; }

  void cut() override {
    ErrorCode ignored;
    lowest().close(ignored);
  }

 private:
  Tcp::socket& lowest() { return beast::get_lowest_layer(socket_).socket(); }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](ErrorCode error, std::size_t) {
      self->haveRead(error);
    });
  }

  void haveRead(ErrorCode error) {
    const std::int64_t now_ns = monotonicNow_ns();
    if (error == websocket::error::message_too_big) clients_.saidTooMuch(number_, now_ns);
    if (error) {
      clients_.leave(number_, now_ns);
      return;
    }
    const auto bytes = buffer_.cdata();
    clients_.heard(number_, {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                   socket_.got_text(), now_ns);
    buffer_.consume(bytes.size());
    read();
  }

  void writeNext() {
    SharedBytes next = std::move(queue_.front());
    queue_.pop_front();
    arrived_ns_ = 0;
    write(std::move(next));
  }

  void write(SharedBytes message) {
    writing_ = std::move(message);
    since_ns_ = monotonicNow_ns();
    socket_.async_write(net::buffer(*writing_),
                        [self = shared_from_this()](ErrorCode error, std::size_t bytes) {
                          self->haveWritten(error, bytes);
                        });
  }

  void haveWritten(ErrorCode error, std::size_t bytes) {
    const std::int64_t now_ns = monotonicNow_ns();
    if (error) {
      clients_.leave(number_, now_ns);
      return;
    }
    traffic_.bytes_sent += bytes;
    if (arrived_ns_ != 0) traffic_.addAge(now_ns - arrived_ns_);
    writing_.reset();
    if (!queue_.empty()) writeNext();
  }

  websocket::stream<beast::tcp_stream> socket_;
  Clients& clients_;
  Traffic& traffic_;
  beast::flat_buffer buffer_;
  std::uint32_t number_ = 0;
  std::deque<SharedBytes> queue_;
  SharedBytes writing_;
  std::int64_t since_ns_ = 0;    ///< when writing_ was begun
  std::int64_t arrived_ns_ = 0;  ///< of the state in writing_; 0: it is something else
};

}  // namespace wholehand
