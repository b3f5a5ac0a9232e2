#include "server/server.hpp"

#include "realtime/monotonic_clock.hpp"
#include "server/aside_log.hpp"
#include "server/http_connection.hpp"

#include <fmt/format.h>

#include <exception>
#include <pthread.h>
#include <thread>

namespace wholehand {

namespace {

constexpr std::chrono::nanoseconds kFrame{16'666'667};  ///< 60 states a second
constexpr std::size_t kMostConnections = 128;           ///< over plain HTTP
constexpr unsigned kPageWorkers = 1, kRecordingWorkers = 2;
/// That wait for a worker, or for a disk that hangs. Of pages: those of every connection.
constexpr std::size_t kMostPages = kMostConnections, kMostRecordings = 16;

}  // namespace

class Server::Machinery : public std::enable_shared_from_this<Server::Machinery> {
 public:
  Machinery(ServerBackend& backend, ServerOptions options, ControlsArbiter& controls)
      : backend_(backend),
        options_(std::move(options)),
        controls_(controls),
        acceptor_(io_),
        retry_(io_),
        frames_(io_),
        aside_(options_.log),
        log_([this](const std::string& line) { aside_.write(line); }) {}

  /// Why the port cannot be had; empty: it listens.
  std::string listen() {
    ErrorCode error;
    const auto address = net::ip::make_address(options_.address, error);
    if (error) return "is no IP address";
    const Tcp::endpoint endpoint(address, options_.port);
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(net::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (!error) port_ = acceptor_.local_endpoint(error).port();
    return error ? error.message() : std::string();
  }

  void start() {
    const Access access(options_, port_);
    clients_ = std::make_shared<Clients>(backend_, mailbox_, traffic_, log_, controls_, access,
                                         [weak = weak_from_this()](std::function<void()> task) {
                                           if (const auto self = weak.lock())
                                             net::post(self->io_, std::move(task));
                                         });
    Site::Figures figures;
    figures.health = [this] {
      const Pulse p = pulse();
      return std::make_pair(healthy(p), healthJson(p));
    };
    figures.metrics = [this] {
      const auto& more = options_.more_metrics;
      return metricsText(pulse(), traffic_) + (more ? more() : std::string());
    };
    site_ = std::make_unique<Site>(backend_, options_.web_folder, access, std::move(figures));
    premises_.emplace(Premises{*site_, *clients_, traffic_, log_, pages_, recordings_,
                               static_cast<std::size_t>(options_.max_clients),
                               options_.disk_patience, options_.report_patience});
    acceptNext();
    frames_.expires_after(kFrame);
    frameNext();
    thread_ = std::thread([this] { run(); });
    pthread_setname_np(thread_.native_handle(), "wholehand-web");
  }

  void stop() {
    io_.stop();
    if (thread_.joinable()) thread_.join();
    pages_.stop();
    recordings_.stop();
  }

  void publish(const TickRecord& record) { mailbox_.put(record, monotonicNow_ns()); }
  std::uint16_t port() const noexcept { return port_; }
  std::string url() const {
    // "Every address" is none that a browser can go to.
    const bool every = options_.address == "0.0.0.0" || options_.address == "::";
    const std::string address = !every                     ? options_.address
                                : options_.address == "::" ? "::1"
                                                           : "127.0.0.1";
    return fmt::format("http://{}:{}/", bracketed(address), port_);
  }

 private:
  // An exception here must end neither the process nor the loop in it: whoever caused it has lost
  // its connection, all others go on.
  void run() noexcept {
    while (true) {
      try {
        io_.run();
        return;
      } catch (const std::exception& e) {
        ++traffic_.dropped["exception"];
        log_.write(fmt::format("the server went on after: {}", e.what()), monotonicNow_ns());
      }
    }
  }

  void acceptNext() {
    acceptor_.async_accept([this](ErrorCode error, Tcp::socket socket) {
      if (error == net::error::operation_aborted) return;
      if (error) {  // no file handles left: later perhaps
        retry_.expires_after(std::chrono::milliseconds(100));
        retry_.async_wait([this](ErrorCode) { acceptNext(); });
        return;
      }
      acceptNext();
      if (premises_->connections >= kMostConnections) {
        ++traffic_.refused["connections"];
        if (premises_->idle.empty()) return;
        // Whoever holds connections open and asks for nothing keeps nobody out.
        premises_->idle.front()->hangUpIdle();
      }
      std::make_shared<HttpConnection>(std::move(socket), *premises_)->read();
    });
  }

  void frameNext() {
    frames_.async_wait([this](ErrorCode error) {
      if (error) return;
      // Frames that were missed are not made up for.
      const auto now = net::steady_timer::clock_type::now();
      frames_.expires_at(std::max(frames_.expiry() + kFrame, now));
      frameNext();
      clients_->tick(monotonicNow_ns());
    });
  }

  Pulse pulse() const {
    Pulse p;
    p.status = backend_.status();
    const std::int64_t newest_ns = mailbox_.newest_ns();
    if (newest_ns != 0) {
      p.record_age_s = 1e-9 * static_cast<double>(monotonicNow_ns() - newest_ns);
    }
    p.events_dropped = mailbox_.dropped();
    return p;
  }

  // The order matters: what was made last goes first, and every socket before io_.
  ServerBackend& backend_;
  ServerOptions options_;
  ControlsArbiter& controls_;
  std::uint16_t port_ = 0;
  Traffic traffic_;
  EventMailbox mailbox_;
  std::optional<Premises> premises_;  ///< connections count themselves out there at their end
  FileWorkers pages_{kPageWorkers, kMostPages};
  FileWorkers recordings_{kRecordingWorkers, kMostRecordings};
  net::io_context io_{1};
  Tcp::acceptor acceptor_;
  net::steady_timer retry_, frames_;
  AsideLog aside_;
  PoliteLog log_;
  std::shared_ptr<Clients> clients_;
  std::unique_ptr<Site> site_;
  std::thread thread_;
};

Server::Server(std::shared_ptr<Machinery> machinery) : machinery_(std::move(machinery)) {}

Expected<std::unique_ptr<Server>> Server::open(ServerBackend& backend, ServerOptions options,
                                               ControlsArbiter& controls) {
  if (options.address == "localhost") options.address = "127.0.0.1";
  if (Diagnostics faults = validate(options); !faults.empty()) return faults;
  const std::string address = options.address;
  const std::uint16_t port = options.port;
  auto machinery = std::make_shared<Machinery>(backend, std::move(options), controls);
  if (const std::string why = machinery->listen(); !why.empty()) {
    return Diagnostic{"",
                      0,
                      "port",
                      fmt::format("{}:{}", bracketed(address), port),
                      "cannot be listened at: " + why,
                      "take another one; 0 takes any that is free"};
  }
  machinery->start();
  return std::unique_ptr<Server>(new Server(std::move(machinery)));
}

Server::~Server() {
  machinery_->stop();
}

std::uint16_t Server::port() const noexcept {
  return machinery_->port();
}

std::string Server::url() const {
  return machinery_->url();
}

void Server::publish(const TickRecord& record) {
  machinery_->publish(record);
}

}  // namespace wholehand
