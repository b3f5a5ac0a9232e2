#include "server/udp_bridge.hpp"

#include "realtime/monotonic_clock.hpp"
#include "server/server.hpp"
#include "server/udp_host.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <mutex>
#include <random>
#include <thread>

namespace wholehand {

namespace {

/// How often repetitions, heartbeats and silence are looked at.
constexpr int kPace_ms = 10;
/// Age at which figures beside the record are asked for again.
constexpr std::int64_t kStatusAge_ns = 20'000'000;
/// Without records for so long, the newest one is sent again.
constexpr std::int64_t kIdle_ns = 100'000'000;

Diagnostic refusal(const char* key, std::string value, std::string problem, std::string remedy) {
  return {"", 0, key, std::move(value), std::move(problem), std::move(remedy)};
}

Diagnostics faultsOf(const UdpOptions& options) {
  Diagnostics faults;
  if (!options.local.isLoopback() && options.token.size() < kShortestToken) {
    faults.push_back(refusal("UDP token", "",
                             "is shorter than " + std::to_string(kShortestToken) + " characters",
                             "games on other machines need one; or bind to 127.0.0.1"));
  }
  if (options.token.size() > udp::kLongestToken) {
    faults.push_back(refusal("UDP token", "", "is too long", "must be at most 256 bytes"));
  }
  for (const UdpEndpoint& peer : options.peers) {
    if (peer.isLoopback() || !options.local.isLoopback()) continue;
    faults.push_back(refusal("UDP peer", format(peer),
                             "cannot be reached from " + format(options.local),
                             "bind to an address of this machine that it can reach"));
  }
  return faults;
}

}  // namespace

struct UdpBridge::Core {
  Core(const UdpOptions& options, ControlsArbiter& controls, UdpCounters& counters)
      : host(
            {options.peers, options.token, options.most_peers}, controls, counters,
            [this](const UdpEndpoint& to, std::span<const std::uint8_t> bytes) {
              return socket.send(to, bytes);
            },
            (std::uint64_t{std::random_device{}()} << 32U) ^ std::random_device{}()),
        tally(counters) {}

  void run(ServerBackend& backend, const std::shared_ptr<Core>& self);
  void goRound(ServerBackend& backend, const std::shared_ptr<Core>& self);
  void receiveAll();
  void sendIdle(ServerBackend& backend);
  void carryOut(ServerBackend& backend, const std::shared_ptr<Core>& self);

  UdpSocket socket;
  std::mutex mutex;  ///< guards host and open; nothing of the backend is called while it is held
  udp::Host host;
  UdpCounters& tally;  ///< while the thread runs
  bool open = true;    ///< false: the bridge is gone, and with it the counters
  std::atomic<bool> stopping{false};
  std::atomic<std::int64_t> published_ns{0};
  std::thread thread;
  // publish() only:
  LoopStatus status;
  std::int64_t status_ns = 0;
};

UdpBridge::UdpBridge(ServerBackend& backend, ControlsArbiter& controls)
    : backend_(backend), controls_(controls) {}

Expected<Done> UdpBridge::start(const UdpOptions& options) {
  if (core_ != nullptr) return refusal("UDP", "", "has been started already", "start it once");
  if (Diagnostics faults = faultsOf(options); !faults.empty()) return faults;
  auto core = std::make_shared<Core>(options, controls_, counters_);
  if (auto opened = core->socket.open(options.local); !opened) return opened.errors();
  core_ = core;
  core_->thread = std::thread([this, core] { core->run(backend_, core); });
  return Done{};
}

void UdpBridge::stop() {
  if (core_ == nullptr || core_->stopping.exchange(true)) return;
  core_->socket.wake();
  core_->thread.join();
  std::vector<udp::PendingOrder> last;
  {
    const std::lock_guard lock(core_->mutex);
    core_->host.sayGoodbye(monotonicNow_ns());
    core_->open = false;
    last = core_->host.takeOrders();
  }
  for (const udp::PendingOrder& pending : last)
    backend_.order(pending.order, [](const OrderReply&) {});
}

UdpEndpoint UdpBridge::local() const noexcept {
  return core_ == nullptr ? UdpEndpoint{} : core_->socket.local();
}

void UdpBridge::publish(const TickRecord& record) {
  if (core_ == nullptr) return;
  Core& core = *core_;
  const std::int64_t now_ns = monotonicNow_ns();
  core.published_ns = now_ns;
  if (counters_.peers == 0) return;
  if (now_ns - core.status_ns >= kStatusAge_ns) {
    core.status = backend_.status();
    core.status_ns = now_ns;
  }
  // The scene is the other thread's to look at: states do not depend on it, and asked for by two
  // threads an old one could come back.
  const std::lock_guard lock(core.mutex);
  if (core.open) core.host.publish(record, core.status, now_ns);
}

// An exception here must end neither the process nor the loop in it: all else goes on.
void UdpBridge::Core::run(ServerBackend& backend, const std::shared_ptr<Core>& self) {
  while (!stopping) {
    socket.wait(kPace_ms);
    try {
      goRound(backend, self);
    } catch (const std::exception&) {
      ++tally.exceptions;
    }
  }
}

void UdpBridge::Core::goRound(ServerBackend& backend, const std::shared_ptr<Core>& self) {
  auto scene = backend.scene();
  {
    const std::lock_guard lock(mutex);
    host.setScene(std::move(scene), monotonicNow_ns());
    receiveAll();
    host.advance(monotonicNow_ns());
  }
  carryOut(backend, self);
  sendIdle(backend);
}

void UdpBridge::Core::receiveAll() {
  // One byte more than is allowed tells what is too long.
  std::array<std::uint8_t, udp::kLargestDatagram + 1> buffer;
  UdpEndpoint from;
  // Whoever floods this socket must not keep publish() out for long.
  for (int i = 0; i < 64; ++i) {
    const long n = socket.receive(from, buffer);
    if (n < 0) return;
    const auto size = std::min(static_cast<std::size_t>(n), buffer.size());
    host.receive(from, {buffer.data(), size}, monotonicNow_ns());
  }
}

void UdpBridge::Core::carryOut(ServerBackend& backend, const std::shared_ptr<Core>& self) {
  std::vector<udp::PendingOrder> orders;
  {
    const std::lock_guard lock(mutex);
    orders = host.takeOrders();
  }
  for (const udp::PendingOrder& pending : orders) {
    const auto answer = [weak = std::weak_ptr<Core>(self), pending](const OrderReply& reply) {
      const auto core = weak.lock();
      if (core == nullptr) return;
      const std::lock_guard lock(core->mutex);
      if (core->open) core->host.answer(pending, reply, monotonicNow_ns());
    };
    try {
      backend.order(pending.order, answer);
    } catch (const std::exception& error) {  // the next one may be an emergency stop
      ++tally.exceptions;
      answer(refused(Refusal::kFailed, std::string("failed: ") + error.what()));
    }
  }
}

void UdpBridge::Core::sendIdle(ServerBackend& backend) {
  const std::int64_t now_ns = monotonicNow_ns();
  if (now_ns - published_ns < kIdle_ns) return;
  published_ns = now_ns;
  TickRecord record;  // before the first one a state says how the loop is, and nothing of the hand
  (void)backend.latest(record);
  const LoopStatus now = backend.status();
  const std::lock_guard lock(mutex);
  host.publishIdle(record, now, now_ns);
}

}  // namespace wholehand
