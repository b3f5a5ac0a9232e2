#include "server/udp_host.hpp"

#include <algorithm>
#include <utility>

namespace wholehand::udp {

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
    case Flaw::kWrongLength:
      return UdpIgnored::kLength;
    case Flaw::kWrongChecksum:
      return UdpIgnored::kChecksum;
    case Flaw::kBadHeader:
    case Flaw::kNone:
      break;
  }
  return UdpIgnored::kHeader;
}

}  // namespace

Host::Host(Admission admission, ControlsArbiter& controls, UdpCounters& counters, Send send,
           std::uint64_t seed)
    : admission_(std::move(admission)),
      controls_(controls),
      counters_(counters),
      send_(std::move(send)),
      random_(seed) {}

std::vector<PendingOrder> Host::takeOrders() {
  return std::exchange(orders_, {});
}

Peer* Host::find(const UdpEndpoint& endpoint) {
  const auto it = std::find_if(peers_.begin(), peers_.end(),
                               [&](const Peer& p) { return p.endpoint == endpoint; });
  return it == peers_.end() ? nullptr : &*it;
}

void Host::receive(const UdpEndpoint& from, std::span<const std::uint8_t> bytes,
                   std::int64_t now_ns) {
  ++counters_.received;
  const Received datagram = read(bytes);
  if (datagram.flaw != Flaw::kNone) return counters_.ignore(reasonOf(datagram.flaw));
  if (datagram.header.kind == Kind::kHello) return receiveHello(from, datagram.payload, now_ns);
  Peer* peer = find(from);
  if (peer == nullptr) return counters_.ignore(UdpIgnored::kUnknownPeer);
  receiveFrom(*peer, datagram, now_ns);
}

void Host::receiveFrom(Peer& peer, const Received& datagram, std::int64_t now_ns) {
  const Header& header = datagram.header;
  if (header.session != peer.session) return counters_.ignore(UdpIgnored::kSession);
  if (header.kind > Kind::kGoodbye) return counters_.ignore(UdpIgnored::kHeader);
  if (!peer.answered && !begin(peer, now_ns)) return;
  if (!peer.window.isNew(header.sequence)) return counters_.ignore(UdpIgnored::kReplayed);
  const Reassembler::Result result = peer.reassembler.add(header, datagram.payload);
  if (result == Reassembler::Result::kRefused) return counters_.ignore(UdpIgnored::kFragment);
  if (result == Reassembler::Result::kRepeated) return counters_.ignore(UdpIgnored::kReplayed);
  peer.heard_ns = now_ns;
  if (result == Reassembler::Result::kIncomplete) return;
  peer.window.accept(header.sequence);
  if (header.kind == Kind::kHeartbeat) return void(peer.alive_ns = now_ns);
  if (header.kind == Kind::kMessage)
    return receiveMessage(peer, peer.reassembler.message(), now_ns);
  if (header.kind == Kind::kGoodbye) {
    const std::uint32_t session = peer.session;
    remove([&](const Peer& p) { return p.session == session; }, now_ns);
  }
}

void Host::receiveMessage(Peer& peer, std::span<const std::uint8_t> message, std::int64_t now_ns) {
  const Expected<wire::ClientMessage> decoded = wire::decode(message);
  if (!decoded) {
    counters_.ignore(UdpIgnored::kMessage);
    return reply(peer, 0, refused(wire::refusalOf(decoded.errors()), format(decoded.errors())),
                 now_ns);
  }
  if (decoded->type == wire::ClientMessageType::kAcknowledge) {
    return peer.outbox.acknowledge(decoded->id);
  }
  peer.alive_ns = now_ns;
  receiveCommand(peer, *decoded, now_ns);
}

void Host::receiveCommand(Peer& peer, const wire::ClientMessage& message, std::int64_t now_ns) {
  const bool order = message.type == wire::ClientMessageType::kOrder;
  const bool aim = order && message.order.type == OrderType::kAim;
  const bool emergency = order && message.order.type == OrderType::kEmergencyStop;
  std::uint32_t& last = aim ? peer.last_aim : emergency ? peer.last_emergency : peer.last_order;
  // A late Arm must not undo the stop that overtook it; the stop itself never comes too late, under
  // whatever number: it is passed over only where it is the very one that was carried out.
  const bool over = emergency ? message.id == last && last != 0 : message.id <= last;
  if (over) return counters_.ignore(UdpIgnored::kCommand);
  if (!message.stops() && tooMany(peer, now_ns)) return refuseForRate(peer, message, now_ns);
  last = message.id;
  if (emergency) peer.last_order = std::max(peer.last_order, message.id);
  switch (message.type) {
    case wire::ClientMessageType::kOrder:
      return receiveOrder(peer, message, now_ns);
    case wire::ClientMessageType::kTakeControls:
      return takeControls(peer, message.id, now_ns);
    case wire::ClientMessageType::kReleaseControls:
      return releaseControls(peer, message.id, now_ns);
    case wire::ClientMessageType::kHeartbeat:
    case wire::ClientMessageType::kAcknowledge:
      return;  // to have been heard is all
  }
}

bool Host::tooMany(Peer& peer, std::int64_t now_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  if (now_ns - peer.second_ns >= kSecond_ns) {
    peer.second_ns = now_ns;
    peer.commands = 0;
  }
  return ++peer.commands > kMostCommands;
}

void Host::receiveOrder(Peer& peer, const wire::ClientMessage& message, std::int64_t now_ns) {
  const bool aim = message.order.type == OrderType::kAim;
  if (message.order.type != OrderType::kEmergencyStop && !controls_.heldBy(peer.client)) {
    if (aim && std::exchange(peer.aim_refused, true)) return void(++counters_.commands_refused);
    return reply(
        peer, message.id,
        refused(Refusal::kNotHolder, controls_.holder() == 0 ? "take the controls first"
                                                             : "another client holds the controls"),
        now_ns);
  }
  PendingOrder& pending =
      orders_.emplace_back(PendingOrder{peer.session, message.id, message.order});
  if (controls_.heldBy(peer.client)) pending.order.claim = peer.claim;
}

void Host::takeControls(Peer& peer, std::uint32_t command, std::int64_t now_ns) {
  const ControlsArbiter::Taken taken = controls_.take(peer.client);
  if (!taken) {
    return reply(peer, command,
                 refused(Refusal::kControlsHeld, "another client holds the controls"), now_ns);
  }
  // Whoever takes over says anew who steers: the aim of the one who is gone must not go on.
  lost_ns_.reset();
  peer.claim = taken.claim;
  if (taken.orphaned) giveBack(peer.claim);
  peer.aim_refused = false;
  order(OrderType::kOwnerAlive, 1.0, peer.claim);
  reply(peer, command, {true, ""}, now_ns);
  tellControls(peer, now_ns);
}

void Host::releaseControls(Peer& peer, std::uint32_t command, std::int64_t now_ns) {
  if (!controls_.release(peer.client, true)) {
    return reply(peer, command, refused(Refusal::kNotHolder, "the game does not hold the controls"),
                 now_ns);
  }
  giveBack(peer.claim);
  reply(peer, command, {true, ""}, now_ns);
  tellControls(peer, now_ns);
}

void Host::answer(const PendingOrder& pending, const OrderReply& given, std::int64_t now_ns) {
  if (pending.command == 0) return;
  const auto it = std::find_if(peers_.begin(), peers_.end(),
                               [&](const Peer& p) { return p.session == pending.session; });
  if (it == peers_.end()) return;
  if (pending.order.type == OrderType::kAim) {
    // Aims come by the hundred: only the first that is refused is answered.
    if (given.accepted) {
      it->aim_refused = false;
      return void(++counters_.commands_accepted);
    }
    if (std::exchange(it->aim_refused, true)) return void(++counters_.commands_refused);
  }
  reply(*it, pending.command, given, now_ns);
}

void Host::order(OrderType type, double value, std::uint32_t claim) {
  PendingOrder pending;
  pending.order.type = type;
  pending.order.value = value;
  pending.order.claim = claim;
  orders_.push_back(std::move(pending));
}

void Host::giveBack(std::uint32_t claim) {
  order(OrderType::kSteer, 0.0, claim);  // to the virtual patient
}

void Host::leave(Peer& peer, std::int64_t now_ns) {
  if (!controls_.release(peer.client)) return;
  // Nobody shows the exercise any more: its effort fades out until somebody takes the controls.
  order(OrderType::kOwnerAlive, 0.0, peer.claim);
  lost_ns_ = now_ns;
  lost_claim_ = peer.claim;
}

std::size_t Host::remove(const std::function<bool(const Peer&)>& which, std::int64_t now_ns) {
  for (Peer& peer : peers_) {
    if (which(peer)) leave(peer, now_ns);
  }
  const std::size_t removed = std::erase_if(peers_, which);
  counters_.peers = static_cast<std::uint32_t>(games());
  return removed;
}

}  // namespace wholehand::udp
