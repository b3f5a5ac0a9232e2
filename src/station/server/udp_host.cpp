#include "station/server/udp_host.hpp"

#include "loop/core/crc32.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

namespace wholehand::udp {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

namespace {

// Byte offsets in the header.
constexpr std::size_t kVersionAt = 4, kKindAt = 6, kFlagsAt = 7, kKeyAt = 8, kSequenceAt = 16,
                      kNumberAt = 20, kSentAt = 24, kEchoAt = 32, kEchoAgeAt = 40, kChecksumAt = 44;

template <class T>
void put(std::uint8_t* at, T value) noexcept {
  std::memcpy(at, &value, sizeof value);
}

template <class T>
T get(const std::uint8_t* at) noexcept {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// CRC-32 of everything except the checksum itself.
std::uint32_t checksum(std::span<const std::uint8_t> datagram) noexcept {
  const auto bytes = std::as_bytes(datagram), payload = bytes.subspan(kHeaderSize);
  return crc32(crc32(0, bytes.data(), kChecksumAt), payload.data(), payload.size());
}

bool isSound(const Header& h, std::uint8_t flags, std::size_t payload) noexcept {
  switch (h.kind) {
    case Kind::kCommand:
      return flags == 0 && h.rate_or_stop <= kHighestRate_hz && payload > 0;
    case Kind::kAlive:
      return flags == 0 && h.rate_or_stop <= kHighestRate_hz && payload == 0;
    case Kind::kState:
      return flags <= 1 && payload > 0;
    case Kind::kPresent:
      return flags <= 1 && payload == 0;
  }
  return false;
}

}  // namespace

std::size_t write(Datagram& datagram, const Header& header,
                  std::span<const std::uint8_t> payload) noexcept {
  std::uint8_t* d = datagram.data();
  const std::size_t size = kHeaderSize + payload.size();
  put(d, kMagic);
  put(d + kVersionAt, kVersion);
  put(d + kKindAt, static_cast<std::uint8_t>(header.kind));
  put(d + kFlagsAt, static_cast<std::uint8_t>(header.holds_controls ? 1 : 0));
  put(d + kKeyAt, header.key);
  put(d + kSequenceAt, header.sequence);
  put(d + kNumberAt, header.rate_or_stop);
  put(d + kSentAt, header.sent_ns);
  put(d + kEchoAt, header.echo_ns);
  put(d + kEchoAgeAt, header.echo_age_us);
  if (!payload.empty()) std::memcpy(d + kHeaderSize, payload.data(), payload.size());
  put(d + kChecksumAt, checksum({d, size}));
  return size;
}

Received read(std::span<const std::uint8_t> bytes) noexcept {
  const std::uint8_t* d = bytes.data();
  Received r;
  const auto flawed = [&](Flaw flaw) {
    r.flaw = flaw;
    return r;
  };
  if (bytes.size() < kHeaderSize) return flawed(Flaw::kTooShort);
  if (bytes.size() > kLargestDatagram) return flawed(Flaw::kTooLong);
  if (get<std::uint32_t>(d) != kMagic) return flawed(Flaw::kWrongMagic);
  if (get<std::uint16_t>(d + kVersionAt) != kVersion) return flawed(Flaw::kWrongVersion);
  if (get<std::uint32_t>(d + kChecksumAt) != checksum(bytes)) return flawed(Flaw::kWrongChecksum);
  const auto flags = d[kFlagsAt];
  r.header.kind = static_cast<Kind>(d[kKindAt]);
  r.header.holds_controls = flags == 1;
  r.header.key = get<std::uint64_t>(d + kKeyAt);
  r.header.sequence = get<std::uint32_t>(d + kSequenceAt);
  r.header.rate_or_stop = get<std::uint32_t>(d + kNumberAt);
  r.header.sent_ns = get<std::int64_t>(d + kSentAt);
  r.header.echo_ns = get<std::int64_t>(d + kEchoAt);
  r.header.echo_age_us = get<std::uint32_t>(d + kEchoAgeAt);
  if (!isSound(r.header, flags, bytes.size() - kHeaderSize)) return flawed(Flaw::kBadHeader);
  r.payload = bytes.subspan(kHeaderSize);
  return r;
}

namespace {

UdpIgnored reasonOf(Flaw flaw) noexcept {
  switch (flaw) {
    case Flaw::kTooShort:
      return UdpIgnored::kTooShort;
    case Flaw::kTooLong:
      return UdpIgnored::kTooLong;
    case Flaw::kWrongMagic:
      return UdpIgnored::kMagic;
    case Flaw::kWrongVersion:
      return UdpIgnored::kVersion;
    case Flaw::kWrongChecksum:
      return UdpIgnored::kChecksum;
    case Flaw::kBadHeader:
    case Flaw::kNone:
      break;
  }
  return UdpIgnored::kHeader;
}

/// True when a game may send this order by datagram. A game without a WebSocket may send more
/// kinds.
bool mayBeDatagram(const Order& order, bool standalone) noexcept {
  const orders::Datagram may = order.row().datagram;
  return may == orders::Datagram::kAlways || (standalone && may == orders::Datagram::kStandalone);
}

bool isNewer(std::uint32_t sequence, std::uint32_t newest) noexcept {
  return static_cast<std::int32_t>(sequence - newest) > 0;  // numbers may wrap
}

}  // namespace

bool Decimator::due(std::uint64_t tick) noexcept {
  if (rate_hz_ == 0 || (any_ && tick == last_)) return false;
  const auto slot = [&](std::uint64_t t) { return t * rate_hz_ / tick_rate_hz_; };
  const bool now = !any_ || tick < last_ || rate_hz_ >= tick_rate_hz_ || slot(tick) != slot(last_);
  any_ = true;
  last_ = tick;
  return now;
}

Host::Host(ControlHolder& controls, UdpCounters& counters, Send send)
    : controls_(controls), counters_(counters), send_(std::move(send)) {}

void Host::admit(std::uint64_t key, ControlHolder::Client client, bool standalone) {
  Peer& peer = peers_.emplace_back();
  peer.key = key;
  peer.client = client;
  peer.standalone = standalone;
}

void Host::dismiss(ControlHolder::Client client) {
  std::erase_if(peers_, [client](const Peer& p) { return p.client == client; });
  countGames();
}

std::vector<ReceivedCommand> Host::takeCommands() {
  return std::exchange(said_, {});
}

Peer* Host::find(std::uint64_t key) {
  const auto it =
      std::find_if(peers_.begin(), peers_.end(), [key](const Peer& p) { return p.key == key; });
  return it == peers_.end() ? nullptr : &*it;
}

void Host::receive(const UdpEndpoint& from, std::span<const std::uint8_t> bytes,
                   std::int64_t now_ns) {
  ++counters_.received;
  const Received datagram = read(bytes);
  if (datagram.flaw != Flaw::kNone) return counters_.ignore(reasonOf(datagram.flaw));
  const Header& header = datagram.header;
  if (header.kind > Kind::kAlive) return counters_.ignore(UdpIgnored::kHeader);
  Peer* peer = find(header.key);
  if (peer == nullptr) return counters_.ignore(UdpIgnored::kKey);

  Order message;
  if (header.kind == Kind::kCommand) {
    auto decoded = wire::decode(datagram.payload);
    if (!decoded || !mayBeDatagram(*decoded, peer->standalone)) {
      return counters_.ignore(UdpIgnored::kMessage);
    }
    message = std::move(*decoded);
  }
  // A game without a WebSocket may restart its sequence numbers from 1 after a silence.
  const bool stale = (peer->open || !peer->standalone) && !isNewer(header.sequence, peer->newest);
  // A late stop from any address is obeyed: an unnecessary stop does no harm.
  if (message.is<orders::EmergencyStop>()) {
    stop(*peer, message);
  } else if (message.stops() && !(stale && message.id == peer->gentle_stop && message.id != 0)) {
    peer->gentle_stop = message.id;
    said_.push_back({peer->client, message});
  }
  if (stale) {
    return counters_.ignore(UdpIgnored::kStale);
  }
  if (!peer->open || peer->endpoint != from) begin(*peer, from);
  follow(*peer, header, now_ns);
  if (!message.stops()) apply(*peer, message, now_ns);
  // Until the address is verified, each datagram gets at most one answer, which is no longer than
  // it.
  if (!peer->address_verified) send(*peer, Kind::kPresent, {}, now_ns);
}

void Host::begin(Peer& peer, const UdpEndpoint& from) {
  peer.open = true;
  peer.endpoint = from;
  peer.address_verified = false;
  peer.sent_times_ns.fill(0);
  countGames();
}

void Host::follow(Peer& peer, const Header& header, std::int64_t now_ns) {
  peer.newest = header.sequence;
  peer.their_ns = header.sent_ns;
  peer.received_ns = now_ns;
  const auto& reported = peer.sent_times_ns;
  if (header.echo_ns != 0 &&
      std::find(reported.begin(), reported.end(), header.echo_ns) != reported.end()) {
    peer.address_verified = true;
  }
  if (header.rate_or_stop == peer.rate_hz) return;
  peer.rate_hz = header.rate_or_stop;
  peer.decimator = Decimator(peer.rate_hz, tick_rate_hz_);
}

void Host::stop(Peer& peer, const Order& message) {
  if (message.id == peer.taken_stop && peer.taken_stop != 0)
    return;  // games repeat a stop until it
             // is acknowledged
  said_.push_back({peer.client, message});
  peer.taken_stop = message.id;
}

void Host::finishStop(const ReceivedCommand& stop, bool obeyed) {
  for (Peer& peer : peers_) {
    if (peer.client != stop.client) continue;
    if (obeyed) peer.applied_stop = stop.order.id;
    if (!obeyed && peer.taken_stop == stop.order.id) peer.taken_stop = 0;
  }
}

void Host::apply(Peer& peer, const Order& message, std::int64_t now_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  if (!peer.address_verified) return;
  if (now_ns - peer.second_ns >= kSecond_ns) {
    peer.second_ns = now_ns;
    peer.commands = 0;
  }
  if (++peer.commands > kMostCommands) {
    return counters_.ignore(UdpIgnored::kRate);
  }
  said_.push_back({peer.client, message});
}

void Host::setScene(std::shared_ptr<const SceneFacts> scene) {
  if (scene == scene_ || scene == nullptr) return;
  scene_ = std::move(scene);
  encoder_ = std::make_unique<wire::StateEncoder>(scene_);
  tick_rate_hz_ = scene_->period_s > 0.0
                      ? static_cast<std::uint32_t>(std::lround(1.0 / scene_->period_s))
                      : 1000U;
  for (Peer& peer : peers_) peer.decimator = Decimator(peer.rate_hz, tick_rate_hz_);
}

void Host::publish(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns) {
  if (encoder_ == nullptr) return;
  std::span<const std::uint8_t> state;
  for (Peer& peer : peers_) {
    if (!peer.address_verified || now_ns - peer.received_ns > kGone_ns) continue;
    if (!peer.decimator.due(record.tick)) continue;
    if (state.empty()) {
      state = encoder_->encode(record, status, wire::Detail::kCompact, now_ns);
    }
    ++counters_.states_sent;
    send(peer, Kind::kState, state, now_ns);
  }
}

void Host::publishIdle(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns) {
  if (encoder_ == nullptr || counters_.peers == 0) return;
  const auto state = encoder_->encode(record, status, wire::Detail::kCompact, now_ns);
  for (Peer& peer : peers_) {
    if (!peer.address_verified || peer.rate_hz == 0 || now_ns - peer.received_ns > kGone_ns)
      continue;
    ++counters_.states_sent;
    send(peer, Kind::kState, state, now_ns);
  }
}

void Host::advance(std::int64_t now_ns) {
  for (Peer& peer : peers_) {
    if (!peer.open) continue;
    if (now_ns - peer.received_ns > kGone_ns) {
      peer.open = peer.address_verified = false;
      // A game without a WebSocket may restart its command numbers from 1.
      if (peer.standalone) peer.taken_stop = peer.gentle_stop = peer.applied_stop = 0;
      ++counters_.peers_lost;
      countGames();
    } else if (peer.address_verified && now_ns - peer.sent_ns >= kPresent_ns) {
      send(peer, Kind::kPresent, {}, now_ns);
    }
  }
}

void Host::countGames() {
  counters_.peers = static_cast<std::uint32_t>(
      std::count_if(peers_.begin(), peers_.end(), [](const Peer& p) { return p.open; }));
}

void Host::send(Peer& peer, Kind kind, std::span<const std::uint8_t> message, std::int64_t now_ns) {
  if (message.size() > kLargestPayload) return void(++counters_.send_errors);
  Header header;
  header.kind = kind;
  header.holds_controls = controls_.heldBy(peer.client);
  header.key = peer.key;
  header.sequence = ++peer.sequence;
  header.rate_or_stop = peer.applied_stop;
  header.sent_ns = peer.sent_ns = now_ns;
  header.echo_ns = peer.their_ns;
  header.echo_age_us = static_cast<std::uint32_t>((now_ns - peer.received_ns) / 1000);
  if (!peer.address_verified)
    peer.sent_times_ns[peer.reported++ % peer.sent_times_ns.size()] = now_ns;
  Datagram datagram;
  const std::size_t size = write(datagram, header, message);
  const UdpSent sent = send_(peer.endpoint, {datagram.data(), size});
  if (sent == UdpSent::kFull) ++counters_.dropped_full;
  if (sent == UdpSent::kFailed) ++counters_.send_errors;
}

}  // namespace wholehand::udp
