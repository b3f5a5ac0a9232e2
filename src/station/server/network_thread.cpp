#include "station/server/network_thread.hpp"

#include "station/server/sockets.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <exception>
#include <pthread.h>
#include <thread>
#include <utility>

namespace wholehand {

namespace {

constexpr std::chrono::nanoseconds kFrame{16'666'667};  ///< 60 a second
constexpr std::chrono::milliseconds kRetry{100};
/// Data of a client that the kernel keeps until it is read. It would grow to megabytes by itself.
constexpr int kReceiveBuffer_bytes = 64 * 1024;

}  // namespace

class NetworkThread::Machinery {
 public:
  Machinery() : acceptor_(io_), retry_(io_), frames_(io_) {}
  ~Machinery() { stop(); }
  Machinery(const Machinery&) = delete;
  Machinery& operator=(const Machinery&) = delete;

  std::string listen(const std::string& address, std::uint16_t port) {
    ErrorCode error;
    const auto ip = net::ip::make_address(address, error);
    if (error) return "is no IP address";
    const Tcp::endpoint endpoint(ip, port);
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) {  // connections inherit it
      acceptor_.set_option(net::socket_base::receive_buffer_size(kReceiveBuffer_bytes), error);
    }
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (!error) port_ = acceptor_.local_endpoint(error).port();
    return error ? error.message() : std::string();
  }

  std::uint16_t port() const noexcept { return port_; }

  void start(Calls calls) {
    calls_ = std::move(calls);
    acceptNext();
    frames_.expires_after(kFrame);
    frameNext();
    thread_ = std::thread([this] { run(); });
    pthread_setname_np(thread_.native_handle(), "wholehand-web");
  }

  void post(std::function<void()> task) { net::post(io_, std::move(task)); }

  void stop() {
    io_.stop();
    if (thread_.joinable()) thread_.join();
  }

 private:
  // Catches every exception of a callback: it must end neither the process nor the loop in it. The
  // connection that caused it is closed; all others continue.
  void run() noexcept {
    while (true) {
      try {
        io_.run();
        return;
      } catch (const std::exception& e) {
        report(e);
      }
    }
  }

  void report(const std::exception& e) noexcept {
    try {
      calls_.failed(e.what());
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): no memory to report it
    }
  }

  void acceptNext() {
    acceptor_.async_accept([this](ErrorCode error, Tcp::socket socket) {
      if (error == net::error::operation_aborted) return;
      if (error) {  // no file handles left: accepting is retried later
        retry_.expires_after(kRetry);
        retry_.async_wait([this](ErrorCode) { acceptNext(); });
        return;
      }
      acceptNext();
      calls_.connected(openHttpLine(std::move(socket)));
    });
  }

  void frameNext() {
    frames_.async_wait([this](ErrorCode error) {
      if (error) return;
      // Missed frames are skipped.
      const auto now = net::steady_timer::clock_type::now();
      frames_.expires_at(std::max(frames_.expiry() + kFrame, now));
      frameNext();
      calls_.frame();
    });
  }

  // Declaration order matters: every socket and timer is destroyed before io_.
  Calls calls_;
  std::uint16_t port_ = 0;
  net::io_context io_{1};
  Tcp::acceptor acceptor_;
  net::steady_timer retry_, frames_;
  std::thread thread_;
};

NetworkThread::NetworkThread() : machinery_(std::make_unique<Machinery>()) {}

NetworkThread::~NetworkThread() = default;

std::string NetworkThread::listen(const std::string& address, std::uint16_t port) {
  return machinery_->listen(address, port);
}

std::uint16_t NetworkThread::port() const noexcept {
  return machinery_->port();
}

void NetworkThread::start(Calls calls) {
  machinery_->start(std::move(calls));
}

void NetworkThread::post(std::function<void()> task) {
  machinery_->post(std::move(task));
}

void NetworkThread::stop() {
  machinery_->stop();
}

}  // namespace wholehand
