#include "station/server/udp_bridge.hpp"

#include "loop/realtime/monotonic_clock.hpp"
#include "station/server/udp_host.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <exception>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

namespace wholehand {

namespace {

/// Interval of checking for silent games.
constexpr int kPace_ms = 10;
/// Maximum age of the cached loop status.
constexpr std::int64_t kStatusAge_ns = 20'000'000;
/// Interval without records after which the newest one is sent again.
constexpr std::int64_t kIdle_ns = 100'000'000;
constexpr std::size_t kKeyDigits = 16;

/// A new key from the system's random source, so that it cannot be predicted.
std::uint64_t newKey() {
  std::random_device random;
  std::uint64_t key = 0;
  while (key == 0) key = std::uint64_t{random()} << 32U | random();
  return key;
}

}  // namespace

Expected<std::uint64_t> parseUdpKey(const std::string& text) {
  std::uint64_t key = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, key, 16);
  if (error == std::errc() && rest == end && text.size() == kKeyDigits && key != 0) return key;
  return keyFault("", "UDP key", text, "is no key",
                  "must be 16 hexadecimal digits, not all of them 0");
}

struct UdpBridge::Core {
  Core(ServerBackend& program, ControlHolder& controls, UdpCounters& counters)
      : backend(program),
        tally(counters),
        host(controls, counters, [this](const UdpEndpoint& to, std::span<const std::uint8_t> d) {
          return socket.send(to, d);
        }) {}

  void run();
  void goRound();
  void receiveAll();
  void handOver(const udp::ReceivedCommand& said);
  void applyStop(const udp::ReceivedCommand& stop);
  void sendIdle();

  ServerBackend& backend;
  UdpCounters& tally;
  UdpSocket socket;
  std::mutex mutex;  ///< guards host and listener; no other function is called while it is held
  udp::Host host;
  Listener listener;
  std::uint64_t standalone_key = 0;
  std::atomic<bool> stopping{false};
  std::atomic<std::int64_t> published_ns{0};
  std::thread thread;
  // The next two are used by publish() only.
  LoopStatus status;
  std::int64_t status_ns = 0;
};

UdpBridge::UdpBridge(ServerBackend& backend, ControlHolder& controls)
    : backend_(backend), controls_(controls) {}

UdpBridge::~UdpBridge() {
  stop();
}

Expected<Done> UdpBridge::start(const UdpOptions& options) {
  if (core_ != nullptr) {
    return Diagnostic{"", 0, "UDP", "", "has been started already", "start it once"};
  }
  auto core = std::make_unique<Core>(backend_, controls_, counters_);
  if (auto opened = core->socket.open(options.local); !opened) return opened.errors();
  core->standalone_key = options.key;
  core_ = std::move(core);
  core_->thread = std::thread([&core = *core_] { core.run(); });
  return Done{};
}

void UdpBridge::stop() {
  if (core_ == nullptr || core_->stopping.exchange(true)) return;
  core_->socket.wake();
  core_->thread.join();
  setListener({});
}

UdpEndpoint UdpBridge::local() const noexcept {
  return core_ == nullptr ? UdpEndpoint{} : core_->socket.local();
}

UdpBridge::DatagramAccess UdpBridge::admit(Client client) {
  if (core_ == nullptr) return {};
  const DatagramAccess access{core_->socket.local().port, newKey()};
  const std::lock_guard lock(core_->mutex);
  core_->host.admit(access.key, client, false);
  return access;
}

bool UdpBridge::awaitsStandalone() const noexcept {
  return core_ != nullptr && core_->standalone_key != 0;
}

void UdpBridge::admitStandalone(Client client) {
  if (!awaitsStandalone()) return;
  const std::lock_guard lock(core_->mutex);
  core_->host.admit(core_->standalone_key, client, true);
}

void UdpBridge::dismiss(Client client) {
  if (core_ == nullptr) return;
  const std::lock_guard lock(core_->mutex);
  core_->host.dismiss(client);
}

void UdpBridge::setListener(Listener listener) {
  if (core_ == nullptr) return;
  const std::lock_guard lock(core_->mutex);
  core_->listener = std::move(listener);
}

void UdpBridge::publish(const TickRecord& record) {
  if (core_ == nullptr || core_->stopping) return;
  Core& core = *core_;
  const std::int64_t now_ns = monotonicNow_ns();
  core.published_ns = now_ns;
  if (counters_.peers == 0) return;
  if (now_ns - core.status_ns >= kStatusAge_ns) {
    core.status = backend_.status();
    core.status_ns = now_ns;
  }
  // Only the receiving thread updates the scene. States do not depend on it, and with two threads
  // an older scene could overwrite a newer one.
  const std::lock_guard lock(core.mutex);
  core.host.publish(record, core.status, now_ns);
}

// Receives until the bridge stops. An exception must end neither the process nor the loop in it;
// everything else continues.
void UdpBridge::Core::run() {
  while (!stopping) {
    socket.wait(kPace_ms);
    try {
      goRound();
    } catch (const std::exception&) {
      ++tally.exceptions;
    }
  }
}

void UdpBridge::Core::goRound() {
  auto scene = backend.scene();
  std::vector<udp::ReceivedCommand> heard;
  {
    const std::lock_guard lock(mutex);
    host.setScene(std::move(scene));
    receiveAll();
    host.advance(monotonicNow_ns());
    heard = host.takeCommands();
  }
  for (const udp::ReceivedCommand& said : heard) {
    try {
      handOver(said);
    } catch (const std::exception&) {  // continues, because the next datagram may be an emergency
                                       // stop
      ++tally.exceptions;
    }
  }
  sendIdle();
}

void UdpBridge::Core::receiveAll() {
  // The buffer has one byte more than allowed, so that datagrams that are too long are detected.
  std::array<std::uint8_t, udp::kLargestDatagram + 1> buffer;
  UdpEndpoint from;
  // The number of datagrams is bounded, so that a flood of this socket cannot block publish() for
  // long.
  for (int i = 0; i < 64; ++i) {
    const long n = socket.receive(from, buffer);
    if (n < 0) return;
    const auto size = std::min<std::size_t>(n, buffer.size());
    host.receive(from, {buffer.data(), size}, monotonicNow_ns());
  }
}

// Hands a command on. An emergency stop is obeyed at once, on this thread; the server judges all
// other messages.
void UdpBridge::Core::handOver(const udp::ReceivedCommand& said) {
  if (said.order.is<orders::EmergencyStop>()) {
    return applyStop(said);
  }
  Listener hears;
  {
    const std::lock_guard lock(mutex);
    hears = listener;
  }
  if (hears) hears(said.client, said.order);
}

void UdpBridge::Core::applyStop(const udp::ReceivedCommand& stop) {
  const auto finish = [&](bool obeyed) {
    const std::lock_guard lock(mutex);
    host.finishStop(stop, obeyed);
  };
  ++tally.stops;
  try {
    Order order = stop.order;
    order.client = stop.client;
    backend.order(order, [](const OrderReply&) {});
  } catch (const std::exception&) {
    finish(false);
    throw;
  }
  finish(true);
}

void UdpBridge::Core::sendIdle() {
  const std::int64_t now_ns = monotonicNow_ns();
  if (now_ns - published_ns < kIdle_ns) return;
  published_ns = now_ns;
  TickRecord record;  // empty before the first record: states then have the loop's status and no
                      // hand
  (void)backend.latest(record);
  const LoopStatus now = backend.status();
  const std::lock_guard lock(mutex);
  host.publishIdle(record, now, now_ns);
}

}  // namespace wholehand
