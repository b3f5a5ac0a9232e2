#include "station/server/server.hpp"

#include "loop/realtime/monotonic_clock.hpp"
#include "station/server/clients.hpp"
#include "station/server/http_connection.hpp"
#include "station/server/logs.hpp"
#include "station/server/network_thread.hpp"
#include "station/server/site.hpp"
#include "station/server/udp_bridge.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

namespace wholehand {

namespace {

constexpr std::size_t kMostConnections = 128;  ///< over plain HTTP
constexpr unsigned kPageWorkers = 1, kRecordingWorkers = 2;
/// Enough for two recordings at the same time: one plot request and one state request of each.
constexpr unsigned kReplayWorkers = 4;
/// Limits of jobs that wait for a worker or a hanging disk. The limit for pages allows one job per
/// connection.
constexpr std::size_t kMostPages = kMostConnections, kMostRecordings = 16, kMostReplays = 64;

}  // namespace

class Server::Machinery : public std::enable_shared_from_this<Server::Machinery> {
 public:
  Machinery(ServerBackend& backend, ServerOptions options, ControlHolder& controls)
      : backend_(backend),
        options_(std::move(options)),
        controls_(controls),
        async_log_(options_.log),
        log_([this](const std::string& line) { async_log_.write(line); }) {}

  /// Opens the port. Returns the reason if that fails; empty: it listens.
  std::string listen() { return network_.listen(options_.address, options_.port); }

  void start() {
    const Access access(options_, port());
    clients_ = std::make_shared<Clients>(
        backend_, mailbox_, traffic_, log_, controls_, access,
        [weak = weak_from_this()](std::function<void()> task) {
          if (const auto self = weak.lock()) self->network_.post(std::move(task));
        },
        options_.commissioning, options_.udp);
    if (options_.udp != nullptr) receiveDatagrams(*options_.udp);
    Site::LoopReports loop;
    loop.health = [this] {
      const LoopHealth p = pulse();
      return std::make_pair(healthy(p), healthJson(p));
    };
    loop.metrics = [this] {
      const auto& more = options_.more_metrics;
      return metricsText(pulse(), traffic_) + (more ? more() : std::string());
    };
    loop.clinic_port = options_.clinic_port;
    site_ = std::make_unique<Site>(backend_, options_.web_folder, access, std::move(loop),
                                   options_.replay);
    context_.emplace(
        ConnectionContext{*site_, *clients_, traffic_, log_, pages_, recordings_, replays_,
                          [this](std::function<void()> task) { network_.post(std::move(task)); },
                          static_cast<std::size_t>(options_.max_clients), options_.disk_patience,
                          options_.report_patience});
    NetworkThread::Calls calls;
    calls.connected = [this](std::unique_ptr<HttpLine> line) { welcome(std::move(line)); };
    calls.frame = [this] { clients_->tick(monotonicNow_ns()); };
    calls.failed = [this](const char* why) {
      ++traffic_.dropped["exception"];
      log_.write(fmt::format("the server went on after: {}", why), monotonicNow_ns());
    };
    network_.start(std::move(calls));
  }

  void stop() {
    if (options_.udp != nullptr) options_.udp->setListener({});
    network_.stop();
    pages_.stop();
    recordings_.stop();
    replays_.stop();
  }

  void publish(const TickRecord& record) { mailbox_.put(record, monotonicNow_ns()); }
  std::uint16_t port() const noexcept { return network_.port(); }
  std::string url() const {
    // A browser cannot open the wildcard address.
    const bool every = options_.address == "0.0.0.0" || options_.address == "::";
    const std::string address = !every                     ? options_.address
                                : options_.address == "::" ? "::1"
                                                           : "127.0.0.1";
    return fmt::format("http://{}:{}/", bracketed(address), port());
  }

 private:
  void receiveDatagrams(UdpBridge& udp) {
    clients_->joinStandalone();
    udp.setListener([weak = weak_from_this()](UdpBridge::Client client, const Order& m) {
      const auto self = weak.lock();
      if (!self) return;
      self->network_.post([weak_clients = std::weak_ptr<Clients>(self->clients_), client, m] {
        const auto clients = weak_clients.lock();
        if (clients) clients->receiveDatagram(client, m, monotonicNow_ns());
      });
    });
  }

  void welcome(std::unique_ptr<HttpLine> line) {
    if (context_->connections >= kMostConnections) {
      ++traffic_.refused["connections"];
      if (context_->idle.empty()) return;
      // Closes the longest idle connection, so that idle connections keep nobody out.
      context_->idle.front()->hangUpIdle();
    }
    std::make_shared<HttpConnection>(std::move(line), *context_)->read();
  }

  LoopHealth pulse() const {
    LoopHealth p;
    p.status = backend_.status();
    const std::int64_t newest_ns = mailbox_.newest_ns();
    if (newest_ns != 0) {
      p.record_age_s = 1e-9 * static_cast<double>(monotonicNow_ns() - newest_ns);
    }
    p.events_dropped = mailbox_.dropped();
    return p;
  }

  // Declaration order matters: members are destroyed in reverse order. Connections end with
  // network_.
  ServerBackend& backend_;
  ServerOptions options_;
  ControlHolder& controls_;
  Traffic traffic_;
  EventMailbox mailbox_;
  std::optional<ConnectionContext> context_;  ///< connections deregister from it when they end
  FileWorkers pages_{kPageWorkers, kMostPages};
  FileWorkers recordings_{kRecordingWorkers, kMostRecordings};
  FileWorkers replays_{kReplayWorkers, kMostReplays};
  NetworkThread network_;
  AsyncLog async_log_;
  RateLimitedLog log_;
  std::shared_ptr<Clients> clients_;
  std::unique_ptr<Site> site_;
};

Server::Server(std::shared_ptr<Machinery> machinery) : machinery_(std::move(machinery)) {}

Expected<std::unique_ptr<Server>> Server::open(ServerBackend& backend, ServerOptions options,
                                               ControlHolder& controls) {
  if (options.address == "localhost") options.address = "127.0.0.1";
  if (Diagnostics faults = validate(options); !faults.empty()) return faults;
  const std::string address = options.address;
  const std::uint16_t port = options.port;
  auto machinery = std::make_shared<Machinery>(backend, std::move(options), controls);
  if (const std::string why = machinery->listen(); !why.empty()) {
    return keyFault("", "port", fmt::format("{}:{}", bracketed(address), port),
                    "cannot be listened at: " + why, "take another one; 0 takes any that is free");
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
